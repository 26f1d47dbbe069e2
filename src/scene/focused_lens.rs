//! The camera's lens at its focus: plane of focus, magnification and image distance of a thin lens.
//!
//! A thin lens of focal length f forms the image of a plane at distance d at the distance s' behind it, 1/f = 1/d + 1/s'
//! (Hecht, Optics, 5th edition, section 5.2.3). The magnification is m = s'/d = f / (d - f), so that s' = f (1 + m). With
//! [`Camera::focus_breathing`] the sensor is at s': the field of view is narrower by 1 + m ("focus breathing"), and the
//! effective f-number is N (1 + m) (the "bellows factor"; Ray, Applied Photographic Optics, 3rd edition).
//! Without it the sensor is at f, as for a lens focused at infinity.
//!
//! All distances are measured from the centre of the lens. The scale of a real lens counts from the sensor: d + s'.

use super::{Aim, Camera, CameraFrame, Focus, Scene};
use glam::Vec3;

/// The largest magnification: nearer than 1.1 focal lengths, no lens of the studio focuses.
const MAX_MAGNIFICATION: f32 = 10.0;

/// A camera's lens at its focus.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct FocusedLens {
    /// Vector along the optical axis, from the lens to what the camera aims at, metres; a unit vector for fixed angles.
    pub ahead: Vec3,
    /// Distance from the lens to the plane of focus along the optical axis, metres; none if that is behind the camera.
    pub focus_m: Option<f32>,
    /// Magnification m that the image distance f (1 + m) follows; 0 without focus breathing.
    pub magnification: f32,
    focal_length_m: f32,
    has_breathing: bool,
}

impl FocusedLens {
    /// Returns the lens of a camera in a scene, which may be another than the scene's own camera.
    pub fn new(scene: &Scene, camera: &Camera) -> Self {
        let ahead = scene.aim_vector(&camera.aim, camera.position);
        let back: Vec3 = crate::math::look_along(camera.position, ahead, 0.0).matrix3.z_axis.into();
        let distance_m = match camera.focus {
            Focus::OnAim => -ahead.dot(back),
            Focus::OnObject { object, offset } => {
                -scene.aim_vector(&Aim::Object { object, offset }, camera.position).dot(back)
            }
            Focus::Distance(distance_m) => distance_m,
        };
        let lens = FocusedLens {
            ahead,
            focus_m: Some(distance_m).filter(|distance_m| *distance_m > 0.0),
            magnification: 0.0,
            focal_length_m: camera.focal_length_mm * 1e-3,
            has_breathing: camera.focus_breathing,
        };
        if camera.focus_breathing { lens.with_breathing() } else { lens }
    }

    /// Moves a plane of focus that is too near to the nearest one, and sets the magnification.
    fn with_breathing(self) -> Self {
        let focus_m = self.focus_m.map(|focus_m| focus_m.max(self.nearest_focus_m()));
        let magnification = focus_m.map_or(0.0, |focus_m| self.focal_length_m / (focus_m - self.focal_length_m));
        FocusedLens { focus_m, magnification: if magnification > 0.0 { magnification } else { 0.0 }, ..self }
    }

    /// Returns the nearest plane of focus with focus breathing, metres.
    fn nearest_focus_m(&self) -> f32 {
        self.focal_length_m * (1.0 + 1.0 / MAX_MAGNIFICATION)
    }

    /// Returns true if the plane of focus is the nearest that the lens reaches.
    pub fn is_at_nearest_focus(&self) -> bool {
        self.has_breathing && self.focus_m == Some(self.nearest_focus_m())
    }

    /// Returns the frame of the lens's camera for a picture of `aspect` (width / height).
    pub fn frame(&self, camera: &Camera, aspect: f32) -> CameraFrame {
        camera.frame(self.ahead, self.magnification, aspect)
    }

    /// Returns the distance from the lens to the sensor, metres.
    pub fn image_distance_m(&self) -> f32 {
        self.focal_length_m * (1.0 + self.magnification)
    }

    /// Returns the light on the sensor relative to the same lens focused at infinity: 1 / (1 + m)^2.
    pub fn bellows_transmission(&self) -> f32 {
        (1.0 + self.magnification).powi(2).recip()
    }

    /// Returns the near and far limit of the depth of field for a circle of confusion, metres; none without a plane of
    /// focus. The far limit is infinite from the hyperfocal distance on.
    ///
    /// A point at s is blurred on the sensor to a circle of A s' |s - d| / (s d) by the aperture A = f / N.
    pub fn depth_of_field_m(&self, f_number: f32, circle_m: f32) -> Option<(f32, f32)> {
        let focus_m = self.focus_m?;
        let aperture_m = self.focal_length_m / f_number;
        let blur = circle_m * focus_m / (aperture_m * self.image_distance_m());
        Some((focus_m / (1.0 + blur), if blur < 1.0 { focus_m / (1.0 - blur) } else { f32::INFINITY }))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scene::{Object, ObjectId, Sensor, Shape};

    fn lens(focal_length_mm: f32, distance_m: f32, focus_breathing: bool) -> FocusedLens {
        let focus = Focus::Distance(distance_m);
        let camera = Camera { focal_length_mm, focus, focus_breathing, ..Camera::default() };
        FocusedLens::new(&Scene::default(), &camera)
    }

    #[test]
    fn image_distance_and_magnification_satisfy_the_thin_lens_equation() {
        for (focal_length_mm, distance_m) in [(50.0, 0.45), (85.0, 3.0), (100.0, 0.2), (100.0, 0.15), (35.0, 1e4)] {
            let lens = lens(focal_length_mm, distance_m, true);
            let inverse = 1.0 / distance_m + 1.0 / lens.image_distance_m();
            assert!((inverse * focal_length_mm * 1e-3 - 1.0).abs() < 1e-5, "{focal_length_mm} mm at {distance_m} m");
            assert!((lens.magnification - lens.image_distance_m() / distance_m).abs() < 1e-5 * lens.magnification);
        }
        // A macro lens of 100 mm at 1:1 has the subject and the sensor 0.2 m from it, and a quarter of the light.
        let macro_lens = lens(100.0, 0.2, true);
        assert!((macro_lens.magnification - 1.0).abs() < 1e-6 && (macro_lens.image_distance_m() - 0.2).abs() < 1e-7);
        assert!((macro_lens.bellows_transmission() - 0.25).abs() < 1e-6);
    }

    #[test]
    fn without_breathing_the_lens_has_the_field_and_exposure_of_infinity() {
        let lens = lens(100.0, 0.2, false);
        assert_eq!((lens.magnification, lens.bellows_transmission(), lens.focus_m), (0.0, 1.0, Some(0.2)));
        assert_eq!(lens.image_distance_m(), 0.1);
    }

    #[test]
    fn a_lens_with_breathing_stops_at_ten_to_one() {
        for distance_m in [0.11, 0.1, 0.05, 1e-3] {
            let lens = lens(100.0, distance_m, true);
            assert!((lens.magnification - 10.0).abs() < 1e-3 && lens.is_at_nearest_focus(), "{distance_m} m: {lens:?}");
        }
        assert!(!lens(100.0, 0.12, true).is_at_nearest_focus() && !lens(100.0, 0.05, false).is_at_nearest_focus());
        assert_eq!(lens(100.0, f32::NAN, true).magnification, 0.0);
        assert_eq!(lens(f32::NAN, 1.0, true).magnification, 0.0);
    }

    #[test]
    fn focus_on_an_object_is_its_distance_along_the_axis_and_none_behind_the_camera() {
        let ball = Object {
            id: ObjectId(5),
            transform: crate::scene::Transform::at(Vec3::new(0.3, 0.0, -2.0)),
            ..Object::new("Ball", Shape::Sphere { radius_m: 0.1 })
        };
        let camera = Camera {
            position: Vec3::ZERO,
            aim: Aim::Point(Vec3::NEG_Z * 7.0),
            roll_deg: 30.0,
            focus: Focus::OnObject { object: ObjectId(5), offset: Vec3::ZERO },
            ..Camera::default()
        };
        let mut scene = Scene { camera, objects: vec![ball], ..Scene::default() };
        assert!((scene.focused_lens().focus_m.unwrap() - 2.0).abs() < 1e-6);
        scene.camera.focus = Focus::OnAim;
        assert!((scene.focused_lens().focus_m.unwrap() - 7.0).abs() < 1e-6);
        scene.camera.focus = Focus::OnObject { object: ObjectId(5), offset: Vec3::Z * 4.0 };
        scene.camera.focus_breathing = true;
        let behind = scene.focused_lens();
        assert_eq!((behind.focus_m, behind.magnification), (None, 0.0));
    }

    #[test]
    fn depth_of_field_matches_lens_tables() {
        // 85 mm f/5.6 at 3 m on full frame, c = 43.27 mm / 1500: 2.81 to 3.21 m.
        let circle_m = Sensor::FullFrame.size_mm().length() / 1500.0 * 1e-3;
        for breathing in [false, true] {
            let (near, far) = lens(85.0, 3.0, breathing).depth_of_field_m(5.6, circle_m).unwrap();
            assert!((near - 2.81).abs() < 0.02 && (far - 3.21).abs() < 0.02, "{near} {far}");
        }
        let wide = lens(20.0, 3.0, false).depth_of_field_m(16.0, circle_m).unwrap();
        assert_eq!(wide.1, f32::INFINITY);
        // A close-up has 2 N c (1 + m) / m^2 on both sides together: 0.92 mm at 1:1 and f/8.
        let (near, far) = lens(100.0, 0.2, true).depth_of_field_m(8.0, circle_m).unwrap();
        let table = 2.0 * 8.0 * circle_m * 2.0;
        assert!(((far - near) / table - 1.0).abs() < 1e-3, "{} for {table}", far - near);
    }
}

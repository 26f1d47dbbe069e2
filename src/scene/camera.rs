//! The camera: sensor, lens, exposure settings, and the frame that all renderers share.

use super::{Aim, ObjectId};
use crate::math;
use glam::{Affine3A, Mat4, Vec2, Vec3};

/// A sensor format.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Sensor {
    /// 36 x 24 mm.
    FullFrame,
    /// 23.5 x 15.6 mm.
    ApsC,
    /// 17.3 x 13 mm.
    MicroFourThirds,
    /// 44 x 33 mm.
    Medium44x33,
    /// 54 x 40 mm.
    Medium54x40,
    /// Any other size, millimetres.
    Custom {
        /// Long side in landscape.
        width_mm: f32,
        /// Short side in landscape.
        height_mm: f32,
    },
}

impl Sensor {
    /// The standard sensor formats with their names.
    pub const NAMED: [(&'static str, Sensor); 5] = [
        ("Full frame 36x24", Sensor::FullFrame),
        ("APS-C 23.5x15.6", Sensor::ApsC),
        ("Micro Four Thirds 17.3x13", Sensor::MicroFourThirds),
        ("Medium format 44x33", Sensor::Medium44x33),
        ("Medium format 54x40", Sensor::Medium54x40),
    ];

    /// Returns width and height in landscape, millimetres.
    pub fn size_mm(self) -> Vec2 {
        match self {
            Sensor::FullFrame => Vec2::new(36.0, 24.0),
            Sensor::ApsC => Vec2::new(23.5, 15.6),
            Sensor::MicroFourThirds => Vec2::new(17.3, 13.0),
            Sensor::Medium44x33 => Vec2::new(44.0, 33.0),
            Sensor::Medium54x40 => Vec2::new(54.0, 40.0),
            Sensor::Custom { width_mm, height_mm } => Vec2::new(width_mm, height_mm),
        }
    }
}

impl Sensor {
    /// Returns the crop factor: the diagonal of full frame over that of the sensor.
    pub fn crop_factor(self) -> f32 {
        Sensor::FullFrame.size_mm().length() / self.size_mm().length()
    }

    /// Returns the diameter of the largest circle of blur that counts as sharp in tables of depth of field, metres: 1/1500
    /// of the diagonal.
    pub fn sharp_circle_m(self) -> f32 {
        self.size_mm().length() / 1500.0 * 1e-3
    }
}

/// The orientation of the camera.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Default)]
pub enum Orientation {
    /// Long side horizontal.
    #[default]
    Landscape,
    /// Long side vertical.
    Portrait,
}

/// The focus of the lens.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Focus {
    /// The point that the camera aims at.
    OnAim,
    /// A point of an object; follows the object when it moves.
    OnObject {
        /// The object in focus.
        object: ObjectId,
        /// Point of the object in its own space, metres before its scale.
        offset: Vec3,
    },
    /// A plane at this distance along the optical axis, metres.
    Distance(f32),
}

/// The camera: position, lens and exposure settings.
#[derive(Clone, Debug, PartialEq)]
pub struct Camera {
    /// Centre of the lens, metres.
    pub position: Vec3,
    /// Aim.
    pub aim: Aim,
    /// Roll about the optical axis, degrees, clockwise as seen from behind.
    pub roll_deg: f32,
    /// Sensor format.
    pub sensor: Sensor,
    /// Landscape or portrait.
    pub orientation: Orientation,
    /// Focal length, millimetres.
    pub focal_length_mm: f32,
    /// Aperture as the f-number N, exact value.
    pub f_number: f32,
    /// Exposure time, seconds.
    pub shutter_s: f32,
    /// ISO speed.
    pub iso: f32,
    /// White balance, kelvin.
    pub white_balance_k: f32,
    /// Neutral density filter before the lens, stops; 0 is none.
    pub nd_stops: f32,
    /// Focus, used only with `depth_of_field` and `focus_breathing`.
    pub focus: Focus,
    /// Depth of field of a thin lens; false is a pinhole.
    pub depth_of_field: bool,
    /// The image distance follows the focus, as in a lens that moves as a whole: focused near, the field of view is
    /// narrower and less light reaches the sensor; see `FocusedLens`.
    pub focus_breathing: bool,
    /// Calibration constant of the incident meter, lux seconds (ISO 2720): 250 for a flat receptor.
    pub meter_constant: f32,
}

impl Default for Camera {
    fn default() -> Self {
        Camera {
            position: Vec3::new(0.0, 1.5, 3.0),
            aim: Aim::Point(Vec3::new(0.0, 1.4, 0.0)),
            roll_deg: 0.0,
            sensor: Sensor::FullFrame,
            orientation: Orientation::Landscape,
            focal_length_mm: 85.0,
            f_number: 5.6,
            shutter_s: 1.0 / 125.0,
            iso: 100.0,
            white_balance_k: 5500.0,
            nd_stops: 0.0,
            focus: Focus::OnAim,
            depth_of_field: false,
            focus_breathing: false,
            meter_constant: 250.0,
        }
    }
}

impl Camera {
    /// Returns width and height of the sensor in the camera's orientation, millimetres.
    pub fn film_size_mm(&self) -> Vec2 {
        let size = self.sensor.size_mm();
        match self.orientation {
            Orientation::Landscape => size,
            Orientation::Portrait => Vec2::new(size.y, size.x),
        }
    }

    /// Returns width over height of the uncropped picture.
    pub fn aspect(&self) -> f32 {
        let size = self.film_size_mm();
        size.x / size.y
    }

    /// Returns the picture size in pixels with the sensor's aspect and this longer side.
    pub fn picture_size(&self, long_edge: u32) -> (u32, u32) {
        let aspect = self.aspect();
        let short = |ratio: f32| ((long_edge as f32 * ratio).round() as u32).max(1);
        if aspect >= 1.0 { (long_edge, short(1.0 / aspect)) } else { (short(aspect), long_edge) }
    }

    /// Returns the frame of a camera that looks along `ahead`, a vector of any length, for a picture of `aspect` (width /
    /// height). The sensor is 1 + `magnification` focal lengths behind the lens. A picture of another aspect than the sensor's is a crop of the
    /// sensor: the field of view stays the same along the side that fits.
    pub fn frame(&self, ahead: Vec3, magnification: f32, aspect: f32) -> CameraFrame {
        let film = self.film_size_mm();
        let (width_mm, height_mm) =
            if aspect >= film.x / film.y { (film.x, film.x / aspect) } else { (film.y * aspect, film.y) };
        let image_distance_mm = self.focal_length_mm * (1.0 + magnification);
        CameraFrame {
            world_from_camera: math::look_along(self.position, ahead, -self.roll_deg.to_radians()),
            half_extent: Vec2::new(width_mm, height_mm) / (2.0 * image_distance_mm),
        }
    }
}

/// The pinhole projection of one picture, shared by path tracer, rasteriser and preview.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct CameraFrame {
    /// Columns right, up, back and the lens centre; looks along -Z.
    pub world_from_camera: Affine3A,
    /// Half width and half height of the image plane at 1 m, metres.
    pub half_extent: Vec2,
}

impl CameraFrame {
    /// Returns the unnormalised world-space direction through a picture point: (0, 0) is the top left corner, (1, 1)
    /// the bottom right. Its component along the optical axis is 1 m.
    pub fn direction(&self, picture_point: Vec2) -> Vec3 {
        let x = (2.0 * picture_point.x - 1.0) * self.half_extent.x;
        let y = (1.0 - 2.0 * picture_point.y) * self.half_extent.y;
        self.world_from_camera.transform_vector3(Vec3::new(x, y, -1.0))
    }

    /// Returns the lens centre, world space.
    pub fn position(&self) -> Vec3 {
        self.world_from_camera.translation.into()
    }

    /// Returns the unit optical axis, world space.
    pub fn forward(&self) -> Vec3 {
        -Vec3::from(self.world_from_camera.matrix3.z_axis)
    }

    /// Returns the clip-from-world matrix with reversed, infinite depth: 1 at `near_m`, 0 at infinity.
    pub fn clip_from_world(&self, near_m: f32) -> Mat4 {
        let projection = Mat4::from_cols_array(&[
            1.0 / self.half_extent.x,
            0.0,
            0.0,
            0.0, //
            0.0,
            1.0 / self.half_extent.y,
            0.0,
            0.0, //
            0.0,
            0.0,
            0.0,
            -1.0, //
            0.0,
            0.0,
            near_m,
            0.0,
        ]);
        projection * Mat4::from(self.world_from_camera.inverse())
    }

    /// Projects a world-space point to the picture (0..1 from the top left); `None` behind the camera.
    pub fn project(&self, point: Vec3) -> Option<Vec2> {
        let local = self.world_from_camera.inverse().transform_point3(point);
        (local.z < -1e-6).then(|| {
            let x = local.x / -local.z / self.half_extent.x;
            let y = local.y / -local.z / self.half_extent.y;
            Vec2::new(0.5 * (x + 1.0), 0.5 * (1.0 - y))
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scene::Scene;

    fn looking_at(target: Vec3, focal_length_mm: f32) -> CameraFrame {
        let camera = Camera { aim: Aim::Point(target), focal_length_mm, ..Camera::default() };
        Scene { camera, ..Scene::default() }.camera_frame(1.5)
    }

    #[test]
    fn project_inverts_direction() {
        let frame = looking_at(Vec3::new(0.3, 1.2, -1.0), 85.0);
        for point in [Vec2::new(0.0, 0.0), Vec2::new(0.25, 0.8), Vec2::new(1.0, 1.0)] {
            let projected = frame.project(frame.position() + 3.0 * frame.direction(point));
            assert!((projected.unwrap() - point).length() < 1e-5);
        }
    }

    #[test]
    fn clip_matches_project_and_reverses_depth() {
        let frame = looking_at(Vec3::ZERO, 85.0);
        let world = frame.position() + 2.0 * frame.direction(Vec2::new(0.75, 0.25));
        let clip = frame.clip_from_world(0.01) * world.extend(1.0);
        assert!((clip.x / clip.w - 0.5).abs() < 1e-5 && (clip.y / clip.w - 0.5).abs() < 1e-5);
        assert!((clip.z / clip.w - 0.005).abs() < 1e-6, "depth is near / distance");
    }

    #[test]
    fn a_camera_with_fixed_angles_looks_the_same_way_a_million_metres_away() {
        let aim = Aim::Angles { yaw_deg: 31.0, pitch_deg: -12.0 };
        let frame = |position: Vec3| {
            let camera = Camera { position, aim, ..Camera::default() };
            Scene { camera, ..Scene::default() }.camera_frame(1.5)
        };
        let far = Vec3::new(1e6, 1e5, -1e6);
        assert_eq!(frame(far).world_from_camera.matrix3, frame(Vec3::ZERO).world_from_camera.matrix3);
        assert_eq!(frame(far).position(), far);
    }

    #[test]
    fn a_standing_figure_fills_the_frame_at_the_tabulated_distances() {
        // light_and_camera.md: a 1.9 m figure fills 24 mm of height from 2.8 m at 35 mm, 4.0 at 50, 6.7 at 85.
        for (focal_length_mm, distance_m) in [(35.0, 2.8), (50.0, 4.0), (85.0, 6.7)] {
            let height_m = 2.0 * looking_at(Vec3::ZERO, focal_length_mm).half_extent.y * distance_m;
            assert!((height_m - 1.9).abs() < 0.03, "{focal_length_mm} mm: {height_m} m");
        }
    }
}

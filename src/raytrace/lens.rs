//! Camera rays: of a pinhole, or of a thin lens with depth of field.

use super::sampler::{self, Dimensions, SampleId, Sampler};
use crate::math::warp;
use crate::photo::exposure;
use crate::scene::{Camera, CameraFrame, FocusedLens, Scene};
use glam::{UVec2, Vec2, Vec3};

/// The aperture of a thin lens and its plane of focus.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Aperture {
    /// Radius, metres; 0 for a pinhole.
    radius_m: f32,
    /// Distance of the plane of focus along the optical axis, metres.
    focus_m: f32,
}

impl Aperture {
    /// The aperture of a pinhole camera.
    pub const PINHOLE: Aperture = Aperture { radius_m: 0.0, focus_m: 0.0 };

    /// Origin, relative to the lens centre, and unit direction of the ray through a picture point (0..1, from the top
    /// left); `u` samples the lens.
    pub fn ray(&self, frame: &CameraFrame, picture_point: Vec2, u: Vec2) -> (Vec3, Vec3) {
        let direction = frame.direction(picture_point);
        if self.radius_m <= 0.0 {
            return (Vec3::ZERO, direction.normalize());
        }
        let disc = warp::concentric_disc(u) * self.radius_m;
        let origin = frame.world_from_camera.transform_vector3(disc.extend(0.0));
        (origin, (direction * self.focus_m - origin).normalize())
    }
}

/// A source of camera rays.
pub trait PixelCamera {
    /// Origin and unit direction of the ray through a point of the picture, in pixels from the top left; `u` samples
    /// the lens.
    fn ray(&self, point_px: Vec2, u: Vec2) -> (Vec3, Vec3);

    /// Returns the number of pixels across and down.
    fn size(&self) -> (u32, u32);

    /// Returns the width of a pixel at 1 m, metres.
    fn pixel_m(&self) -> f32;
}

/// The scene's camera at a picture size. The lens centre is the origin of the tracer's space.
#[derive(Clone, Debug)]
pub struct FilmCamera {
    aperture: Aperture,
    frame: CameraFrame,
    size: (u32, u32),
}

impl FilmCamera {
    /// Unit optical axis, world space.
    pub fn forward(&self) -> Vec3 {
        self.frame.forward()
    }
}

impl PixelCamera for FilmCamera {
    fn ray(&self, point_px: Vec2, u: Vec2) -> (Vec3, Vec3) {
        self.aperture.ray(&self.frame, point_px / UVec2::from(self.size).as_vec2(), u)
    }

    fn size(&self) -> (u32, u32) {
        self.size
    }

    fn pixel_m(&self) -> f32 {
        2.0 * self.frame.half_extent.x / self.size.0 as f32
    }
}

/// The lens of a scene's camera, for pictures of any size.
#[derive(Clone, Debug)]
pub struct Lens {
    camera: Camera,
    focused: FocusedLens,
    aperture: Aperture,
}

impl Lens {
    /// The lens of a scene's camera. A focus behind the camera makes it a pinhole.
    pub fn new(scene: &Scene) -> Self {
        let camera = &scene.camera;
        let focused = scene.focused_lens();
        let aperture = focused.focus_m.filter(|_| camera.depth_of_field).map_or(Aperture::PINHOLE, |focus_m| {
            Aperture { radius_m: camera.focal_length_mm * 1e-3 / (2.0 * camera.f_number), focus_m }
        });
        Lens { camera: camera.clone(), focused, aperture }
    }

    /// Returns true if the lens is not a pinhole.
    pub fn has_aperture(&self) -> bool {
        self.aperture != Aperture::PINHOLE
    }

    /// The effect of focus breathing in words; none without it.
    pub fn breathing(&self) -> Option<String> {
        let m = self.focused.magnification;
        let focus_m = self.focused.focus_m.filter(|_| m > 0.0)?;
        let stops = exposure::bellows_stops(&self.focused);
        Some(format!(
            "focus breathing: focused at {focus_m:.3} m, magnification {m:.3}, field {:.3} times narrower, {stops:.2} \
             stops lost",
            1.0 + m
        ))
    }

    /// Aperture and focus.
    pub fn aperture(&self) -> Aperture {
        self.aperture
    }

    /// The frame for a picture of this aspect ratio.
    pub fn frame(&self, aspect: f32) -> CameraFrame {
        self.focused.frame(&self.camera, aspect)
    }

    /// The camera for a picture of so many pixels.
    pub fn film_camera(&self, width: u32, height: u32) -> FilmCamera {
        FilmCamera { aperture: self.aperture, frame: self.frame(width as f32 / height as f32), size: (width, height) }
    }
}

/// Origin and unit direction of the camera ray of a sample.
pub fn camera_ray(camera: &impl PixelCamera, sampler: &Sampler) -> (Vec3, Vec3) {
    let SampleId { x, y, .. } = sampler.id();
    let set = sampler.set(Dimensions::Camera);
    camera.ray(Vec2::new(x as f32, y as f32) + sampler::first_pair(&set), sampler::last_pair(&set).into())
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scene::{Aim, Focus};
    use crate::statistics::{ChiSquare, TestRng, sidak_level};

    fn scene(focus: Focus) -> Scene {
        let aim = Aim::Point(Vec3::NEG_Z * 3.0);
        let camera = Camera { position: Vec3::ZERO, aim, focal_length_mm: 85.0, f_number: 1.4, ..Camera::default() };
        Scene { camera: Camera { depth_of_field: true, focus, ..camera }, ..Scene::default() }
    }

    #[test]
    fn lens_samples_are_uniform_and_their_rays_meet_in_the_plane_of_focus() {
        let lens = Lens::new(&scene(Focus::Distance(2.0)));
        let frame = lens.frame(1.5);
        let radius = 0.085 / (2.0 * 1.4);
        let mut rng = TestRng::new(31);
        const CELLS: usize = 12;
        const SAMPLES: usize = 40_000;
        let mut counts = vec![0.0; CELLS * CELLS];
        let picture_point = Vec2::new(0.2, 0.7);
        for _ in 0..SAMPLES {
            let (origin, direction) = lens.aperture().ray(&frame, picture_point, rng.unit_square());
            assert!(origin.z.abs() < 1e-7 && (direction.length() - 1.0).abs() < 1e-5);
            let focus = origin + direction * ((-2.0 - origin.z) / direction.z);
            assert!((focus - frame.direction(picture_point) * 2.0).length() < 2e-6);
            let turn = origin.y.atan2(origin.x) / std::f32::consts::TAU;
            let index = |x: f32| ((x * CELLS as f32) as usize).min(CELLS - 1);
            counts[index(origin.length_squared() / (radius * radius)) * CELLS + index(turn - turn.floor())] += 1.0;
        }
        let mut test = ChiSquare::default();
        counts.iter().for_each(|&c| test.add_bin(c, SAMPLES as f64 / (CELLS * CELLS) as f64));
        assert!(test.p_value() > sidak_level(1), "p = {}", test.p_value());
    }

    #[test]
    fn focus_behind_the_camera_is_a_pinhole() {
        let mut behind = scene(Focus::OnObject { object: crate::scene::ObjectId(9), offset: Vec3::ZERO });
        behind.camera.position = Vec3::NEG_Z * 5.0;
        behind.camera.aim = Aim::Point(Vec3::NEG_Z * 9.0);
        // A missing object counts as the origin, which is behind the camera.
        assert!(!Lens::new(&behind).has_aperture());
    }
}

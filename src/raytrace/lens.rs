//! Camera rays: a pinhole, or a thin lens where depth of field is on.

use crate::math::warp;
use crate::scene::{CameraFrame, Focus, Scene};
use glam::{Vec2, Vec3};

/// Where camera rays start and go. The camera sits at the origin of the tracer's space.
#[derive(Clone, Debug)]
pub struct Lens {
    scene_camera: crate::scene::Camera,
    target: Vec3,
    /// Radius of the aperture, metres; 0 for a pinhole.
    radius_m: f32,
    /// Distance of the plane in focus, along the axis, metres.
    focus_m: f32,
}

impl Lens {
    /// The lens of a scene's camera.
    pub fn new(scene: &Scene) -> Self {
        let camera = &scene.camera;
        let target = scene.aim_point(&camera.aim, camera.position);
        let frame = camera.frame(target, camera.aspect());
        let along = |point: Vec3| (point - camera.position).dot(frame.forward());
        let focus_m = match camera.focus {
            Focus::OnAim => along(target),
            Focus::OnObject { object, offset } => {
                along(scene.aim_point(&crate::scene::Aim::Object { object, offset }, camera.position))
            }
            Focus::Distance(distance) => distance,
        };
        let radius_m = if camera.depth_of_field && focus_m > 0.0 {
            camera.focal_length_mm * 1e-3 / (2.0 * camera.f_number)
        } else {
            0.0
        };
        Lens { scene_camera: camera.clone(), target, radius_m, focus_m }
    }

    /// Whether lens samples are used.
    pub fn has_aperture(&self) -> bool {
        self.radius_m > 0.0
    }

    /// The frame for a picture of this aspect.
    pub fn frame(&self, aspect: f32) -> CameraFrame {
        self.scene_camera.frame(self.target, aspect)
    }

    /// Origin and unit direction of the ray through a picture point (0..1, from the top left), relative to the camera.
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

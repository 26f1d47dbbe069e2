//! Small scenes for tests, readings from their renders, and statistics.
#![allow(dead_code)]
#![allow(clippy::unwrap_used)]

pub use catchlight::truth::closed_forms;
pub mod measure;
pub mod replay;
pub mod statistics;

use catchlight::scene::{
    Aim, Camera, Emitter, Light, Material, Object, ObjectId, Output, Scene, Sensor, Shape, Transform,
};
use glam::Vec3;

/// Reflectance of the card.
pub const REFLECTANCE: f32 = 0.18;

/// Returns a camera with a square sensor close to `target`, on the side of `normal`, that frames less than a
/// centimetre.
pub fn looking_at_card(target: Vec3, normal: Vec3) -> Camera {
    // Look from the side: the light comes along the normal.
    let side = if normal.x.abs() < 0.5 { Vec3::X } else { Vec3::Y };
    Camera {
        position: target + normal * 0.08 + side * 0.02,
        aim: Aim::Point(target),
        sensor: Sensor::Custom { width_mm: 24.0, height_mm: 24.0 },
        focal_length_mm: 300.0,
        ..Camera::default()
    }
}

/// Returns an object with a grey matte surface.
pub fn object(name: &str, shape: Shape, position: Vec3) -> Object {
    let material = Material { base_color: [REFLECTANCE; 3], ior: 1.0, roughness: 1.0, ..Material::default() };
    Object { id: ObjectId(name.len() as u32), transform: Transform::at(position), material, ..Object::new(name, shape) }
}

/// Returns a scene with a square card that faces +Z, and a camera that sees nothing else.
pub fn card_at(position: Vec3, size_m: f32) -> Scene {
    let mut card = object("Card", Shape::Plane { width_m: size_m, depth_m: size_m }, position);
    card.transform.rotation_deg = Vec3::X * 90.0;
    Scene { objects: vec![card], camera: looking_at_card(position, Vec3::Z), ..Scene::default() }
}

/// Returns a light that points at the origin, in the camera's white.
pub fn light(emitter: Emitter, output: Output, position: Vec3) -> Light {
    Light { position, aim: Aim::Point(Vec3::ZERO), ..Light::new(emitter, output) }
}

/// Returns a scene with a ball of a material in a white furnace: a uniform surround that the camera sees.
pub fn ball_in_even_light(material: Material) -> Scene {
    let mut ball = object("Ball", Shape::Sphere { radius_m: 0.5 }, Vec3::ZERO);
    ball.material = material;
    let mut surround = light(Emitter::Surround, Output::Lux(1000.0), Vec3::ZERO);
    surround.aim = Aim::Point(Vec3::NEG_Z);
    surround.visible_to_camera = true;
    let camera = Camera {
        position: Vec3::Z * 3.0,
        aim: Aim::Point(Vec3::ZERO),
        sensor: Sensor::Custom { width_mm: 24.0, height_mm: 24.0 },
        focal_length_mm: 50.0,
        ..Camera::default()
    };
    Scene { objects: vec![ball], lights: vec![surround], camera, ..Scene::default() }
}

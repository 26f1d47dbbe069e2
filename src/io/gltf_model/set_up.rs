//! Lamps (`KHR_lights_punctual`) and the camera of a model.

use super::nodes::Nodes;
use crate::io::model::ModelSetUp;
use crate::scene::{Aim, Camera, ColorSource, Emitter, Light, LightColor, Orientation, Output, Sensor};
use glam::{Mat4, Vec3};
use gltf::camera::Projection;
use gltf::khr_lights_punctual::Kind;

/// Most lights that are taken over.
const MOST_LIGHTS: usize = 256;
/// Distance of the point that lights and camera aim at where nothing better is known, the file's unit.
const AIM_DISTANCE: f32 = 1.0;
/// Focal lengths of lenses, millimetres.
const FOCAL_LENGTHS_MM: [f32; 2] = [8.0, 1200.0];
/// Greatest intensity or illuminance, cd or lx.
const MOST_INTENSE: f32 = 1e9;

/// Reads the lamps and the camera of the default scene.
pub fn read(nodes: &Nodes<'_>) -> ModelSetUp {
    let lights = nodes.placed().filter_map(|(node, world)| light_of(&node.light()?, node.name(), world));
    let camera = nodes.placed().find_map(|(node, world)| camera_of(&node.camera()?, world));
    ModelSetUp { lights: lights.take(MOST_LIGHTS).collect(), camera }
}

/// The position, forward and up direction of a node.
fn pose(world: Mat4) -> Option<(Vec3, Vec3, Vec3)> {
    let position = world.transform_point3(Vec3::ZERO);
    let forward = world.transform_vector3(Vec3::NEG_Z).try_normalize()?;
    let up = world.transform_vector3(Vec3::Y).try_normalize()?;
    (position.is_finite() && position.abs().max_element() < 1e5).then_some((position, forward, up))
}

fn light_of(light: &gltf::khr_lights_punctual::Light<'_>, node: Option<&str>, world: Mat4) -> Option<Light> {
    let (position, forward, _) = pose(world)?;
    let color = light.color();
    let is_color = color.iter().all(|value| value.is_finite() && *value >= 0.0);
    // Intensities are those of white: a colour passes a part of it
    let intensity = light.intensity() * crate::color::luminance(Vec3::from(color));
    if !is_color || !(0.0..=MOST_INTENSE).contains(&intensity) || intensity == 0.0 {
        return None;
    }
    let degrees = |half_angle: f32| (2.0 * half_angle.to_degrees()).clamp(0.0, 180.0);
    let (emitter, output) = match light.kind() {
        Kind::Directional => (Emitter::Sun { angular_diameter_deg: 0.0 }, Output::Lux(intensity)),
        Kind::Point => (Emitter::Point, Output::Candela(intensity)),
        Kind::Spot { inner_cone_angle, outer_cone_angle } => {
            let outer_deg = degrees(outer_cone_angle);
            let inner_deg = degrees(inner_cone_angle).min(outer_deg);
            (Emitter::Spot { inner_deg, outer_deg }, Output::Candela(intensity))
        }
    };
    let name = light.name().or(node).unwrap_or("Lamp").to_owned();
    let source = ColorSource::Rgb(color);
    let color = LightColor { source, ..LightColor::default() };
    Some(Light {
        name,
        position,
        aim: Aim::Point(position + forward * AIM_DISTANCE),
        color,
        ..Light::new(emitter, output)
    })
}

fn camera_of(camera: &gltf::Camera<'_>, world: Mat4) -> Option<Camera> {
    let Projection::Perspective(perspective) = camera.projection() else { return None };
    let (position, forward, up) = pose(world)?;
    let (half_height, aspect) = ((0.5 * perspective.yfov()).tan(), perspective.aspect_ratio().unwrap_or(1.5));
    // The picture's height is the sensor's short side in landscape, its long side in portrait
    let orientation = if aspect < 1.0 { Orientation::Portrait } else { Orientation::Landscape };
    let size = Sensor::FullFrame.size_mm();
    let height_mm = if orientation == Orientation::Portrait { size.x } else { size.y };
    let focal_length_mm = 0.5 * height_mm / half_height;
    if !focal_length_mm.is_finite() || focal_length_mm <= 0.0 {
        return None;
    }
    // Roll turns the camera clockwise as seen from behind: its up direction leans to the right
    let right = forward.cross(Vec3::Y).try_normalize().unwrap_or(Vec3::X);
    let roll_deg = up.dot(right).atan2(up.dot(right.cross(forward))).to_degrees();
    Some(Camera {
        position,
        aim: Aim::Point(position + forward * AIM_DISTANCE),
        roll_deg,
        orientation,
        focal_length_mm: focal_length_mm.clamp(FOCAL_LENGTHS_MM[0], FOCAL_LENGTHS_MM[1]),
        ..Camera::default()
    })
}

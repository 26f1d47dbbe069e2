//! What is wrong or odd with a scene, in words a photographer understands.
//!
//! Errors are what no renderer should have to cope with: numbers that are none, sizes of zero, names that clash.
//! Warnings are what can be rendered but was hardly meant. Places are named as in the scene file, so that `io` can
//! find their line.

mod check;
mod light;
mod material;
mod oddities;
mod placement;

pub use placement::placement;

use super::{Aim, Facing, Focus, Meter, Object, Room, Scene, Sensor, Shape};
use check::{Allowed, Check};
use glam::Vec3;
use std::collections::HashSet;

/// How bad a finding is.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Severity {
    /// The scene can be rendered but probably is not what was meant.
    Warning,
    /// The scene cannot be used.
    Error,
}

/// One thing that is wrong or odd.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Finding {
    /// How bad it is.
    pub severity: Severity,
    /// Where, as in the file: `lights[2] "Key" power.dial_stops`; empty for the scene as a whole.
    pub place: String,
    /// What, with the value.
    pub message: String,
}

/// The words with which [`Finding::is_name_clash`] knows its own.
const NAME_CLASH: &str = "another object or light has this name, too";

impl Finding {
    /// A warning.
    pub fn warning(place: impl Into<String>, message: impl Into<String>) -> Self {
        Finding { severity: Severity::Warning, place: place.into(), message: message.into() }
    }

    /// An error.
    pub fn error(place: impl Into<String>, message: impl Into<String>) -> Self {
        Finding { severity: Severity::Error, place: place.into(), message: message.into() }
    }

    /// Whether this is about two equal names, which loading and saving mend by themselves.
    pub fn is_name_clash(&self) -> bool {
        self.message == NAME_CLASH
    }
}

impl std::fmt::Display for Finding {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        if !self.place.is_empty() {
            write!(f, "{}: ", self.place)?;
        }
        f.write_str(&self.message)
    }
}

/// Most objects, and most lights, of a scene.
pub const LIST_LIMIT: usize = 10_000;
/// Most characters of a name.
const NAME_LIMIT: usize = 200;
/// Most characters of a description.
const DESCRIPTION_LIMIT: usize = 10_000;

/// Places and aims, metres from the origin.
const PLACE: Allowed = Allowed::between(-1e6, 1e6, "m");
/// Sizes, metres.
const SIZE: Allowed = Allowed::between(1e-5, 1e5, "m");
/// Turns, degrees.
const TURN: Allowed = Allowed::between(-1e5, 1e5, "degrees");

/// Every error and warning of a scene, in file order. No errors means that every renderer can take it.
/// Warnings about where things stand, which need the meshes, come from [`placement`].
pub fn validate(scene: &Scene) -> Vec<Finding> {
    let mut check = Check::default();
    check.text("name", &scene.name, NAME_LIMIT);
    check.text("description", &scene.description, DESCRIPTION_LIMIT);
    for (list, length) in [("objects", scene.objects.len()), ("lights", scene.lights.len())] {
        if length > LIST_LIMIT {
            check.error(list, format!("{length} are too many; at most {LIST_LIMIT} fit in a scene"));
        }
    }
    if check.has_findings() {
        return check.finish();
    }
    check_camera(scene, &mut check);
    if let Some(room) = &scene.room {
        check_room(room, &mut check);
    }
    let mut names = HashSet::new();
    for (index, object) in scene.objects.iter().enumerate() {
        check.enter(format!("objects[{index}] {:?} ", object.name));
        check_name(&object.name, &mut names, &mut check);
        check_object(object, &mut check);
    }
    for (index, l) in scene.lights.iter().enumerate() {
        check.enter(format!("lights[{index}] {:?} ", l.name));
        check_name(&l.name, &mut names, &mut check);
        light::check_light(scene, l, &mut check);
    }
    if let Some(meter) = &scene.meter {
        check_meter(meter, &mut check);
    }
    check.enter(String::new());
    oddities::warn_of_lights(scene, &mut check);
    check.finish()
}

fn check_name<'a>(name: &'a str, names: &mut HashSet<&'a str>, check: &mut Check) {
    check.text("name", name, NAME_LIMIT);
    if name.trim().is_empty() {
        check.error("name", "a name is needed".to_owned());
    }
    if !names.insert(name) {
        check.error("name", NAME_CLASH.to_owned());
    }
}

fn check_camera(scene: &Scene, check: &mut Check) {
    let camera = &scene.camera;
    check.enter("camera.".to_owned());
    check.vector("position", camera.position, PLACE);
    check_aim(scene, &camera.aim, camera.position, true, check);
    check.number("roll_deg", camera.roll_deg, TURN);
    if let Sensor::Custom { width_mm, height_mm } = camera.sensor {
        check.number("sensor.width_mm", width_mm, Allowed::between(1.0, 1000.0, "mm"));
        check.number("sensor.height_mm", height_mm, Allowed::between(1.0, 1000.0, "mm"));
    }
    check.number("focal_length_mm", camera.focal_length_mm, Allowed::between(1.0, 5000.0, "mm"));
    check.number("f_number", camera.f_number, Allowed::between(0.5, 1000.0, ""));
    check.number("shutter_s", camera.shutter_s, Allowed::between(1e-6, 1e5, "s"));
    check.number("iso", camera.iso, Allowed::between(1.0, 1e7, ""));
    check.number("white_balance_k", camera.white_balance_k, Allowed::between(1000.0, 25_000.0, "K"));
    match camera.focus {
        Focus::OnAim => {}
        Focus::OnObject { object, offset } => {
            check.vector("focus.offset", offset, PLACE);
            if scene.object(object).is_none() {
                check.error("focus", "the object in focus is not in the scene".to_owned());
            }
        }
        Focus::Distance(distance) => check.number("focus[0]", distance, Allowed::between(1e-3, 1e6, "m")),
    }
    check.number("meter_constant", camera.meter_constant, Allowed::between(1.0, 1e4, "lux s"));
}

/// Checks an aim; `has_direction` says that aiming at one's own place is a mistake.
fn check_aim(scene: &Scene, aim: &Aim, position: Vec3, has_direction: bool, check: &mut Check) {
    match *aim {
        Aim::Point(point) => check.vector("aim", point, PLACE),
        Aim::Object { object, offset } => {
            check.vector("aim.offset", offset, PLACE);
            if scene.object(object).is_none() {
                return check.error("aim", "the object aimed at is not in the scene".to_owned());
            }
        }
        Aim::Angles { yaw_deg, pitch_deg } => {
            check.number("aim.yaw_deg", yaw_deg, TURN);
            check.number("aim.pitch_deg", pitch_deg, Allowed::between(-90.0, 90.0, "degrees"));
        }
    }
    let offset = scene.aim_point(aim, position) - position;
    if has_direction && position.is_finite() && offset.is_finite() && offset.length() < 1e-5 {
        check.error("aim", format!("it aims at its own place {position}, which is no direction"));
    }
}

fn check_meter(meter: &Meter, check: &mut Check) {
    check.enter("meter.".to_owned());
    check.vector("position", meter.position, PLACE);
    if let Facing::Angles { yaw_deg, pitch_deg } = meter.facing {
        check.number("facing.yaw_deg", yaw_deg, TURN);
        check.number("facing.pitch_deg", pitch_deg, Allowed::between(-90.0, 90.0, "degrees"));
    }
}

fn check_room(room: &Room, check: &mut Check) {
    check.enter("room.".to_owned());
    check.vector("size_m", room.size_m, Allowed::between(0.1, 1e4, "m"));
    for (field, m) in [("floor", &room.floor), ("walls", &room.walls), ("ceiling", &room.ceiling)] {
        material::check_material(field, m, check);
    }
}

fn check_object(object: &Object, check: &mut Check) {
    check_shape(&object.shape, check);
    check.vector("position", object.transform.position, PLACE);
    check.vector("rotation_deg", object.transform.rotation_deg, TURN);
    check.vector("scale", object.transform.scale, Allowed::between(1e-5, 1e5, ""));
    material::check_material("material", &object.material, check);
    let mut parts = HashSet::new();
    for (index, (part, m)) in object.part_materials.iter().enumerate() {
        if !parts.insert(part) {
            check.error(&format!("part_materials[{index}].part"), format!("{part:?} has a material already"));
        }
        material::check_material(&format!("part_materials[{index}].material"), m, check);
    }
}

fn check_shape(shape: &Shape, check: &mut Check) {
    match *shape {
        Shape::MeshFile { ref path } => check.asset_path("shape.path", path),
        Shape::Mannequin(_) => {}
        Shape::Plane { width_m, depth_m } => {
            check.number("shape.width_m", width_m, SIZE);
            check.number("shape.depth_m", depth_m, SIZE);
        }
        Shape::Box { size_m } => check.vector("shape.size_m", size_m, SIZE),
        Shape::Sphere { radius_m } => check.number("shape.radius_m", radius_m, SIZE),
        Shape::Cylinder { radius_m, height_m } => {
            check.number("shape.radius_m", radius_m, SIZE);
            check.number("shape.height_m", height_m, SIZE);
        }
        Shape::Sweep { width_m, height_m, depth_m, radius_m } => {
            check.number("shape.width_m", width_m, SIZE);
            check.number("shape.height_m", height_m, SIZE);
            check.number("shape.depth_m", depth_m, SIZE);
            check.number("shape.radius_m", radius_m, Allowed::between(0.0, 1e5, "m"));
        }
    }
}

#[cfg(test)]
mod tests;

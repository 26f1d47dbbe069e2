//! Checks the room and the objects.

use super::check::{Allowed, Check, POSITION, SIZE, TURN};
use super::{figure, material, tank};
use crate::scene::{Object, Room, Shape};
use std::collections::HashSet;

pub(super) fn check_room(room: &Room, check: &mut Check) {
    check.enter("room.".to_owned());
    check.vector("size_m", room.size_m, Allowed::between(0.1, 1e4, "m"));
    for (field, m) in [("floor", &room.floor), ("walls", &room.walls), ("ceiling", &room.ceiling)] {
        material::check_material(field, m, check);
    }
}

pub(super) fn check_object(object: &Object, check: &mut Check) {
    check_shape(&object.shape, check);
    check.vector("position", object.transform.position, POSITION);
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
        Shape::Figure(ref figure) => figure::check_figure(figure, check),
        Shape::Tank(ref tank) => tank::check_tank(tank, check),
        Shape::Plane { width_m, depth_m } => {
            check.number("shape.width_m", width_m, SIZE);
            check.number("shape.depth_m", depth_m, SIZE);
        }
        // Its size is that of its object's scale
        Shape::Prop(_) => {}
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
        Shape::VFlat { wing_m, height_m, angle_deg } => {
            check.number("shape.wing_m", wing_m, SIZE);
            check.number("shape.height_m", height_m, SIZE);
            check.number("shape.angle_deg", angle_deg, Allowed::between(5.0, 180.0, "degrees"));
        }
    }
}

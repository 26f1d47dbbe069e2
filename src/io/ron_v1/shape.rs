//! Shapes of objects in format 1.

use super::defaults::Triple;
use super::figure::PersonV1;
use super::mannequin::{self, MannequinPoseV1, MannequinV1};
use super::prop::PropV1;
use super::tank::TankV1;
use crate::scene::Shape;
use glam::Vec3;
use serde::{Deserialize, Serialize};

#[derive(Clone, Debug, Serialize, Deserialize)]
#[serde(rename = "Shape", deny_unknown_fields)]
pub(super) enum ShapeV1 {
    MeshFile {
        path: String,
    },
    Figure(Box<PersonV1>),
    /// Read as a figure; written no more.
    Mannequin {
        figure: MannequinV1,
        pose: MannequinPoseV1,
    },
    Plane {
        width_m: f32,
        depth_m: f32,
    },
    Box {
        size_m: Triple,
    },
    Sphere {
        radius_m: f32,
    },
    Cylinder {
        radius_m: f32,
        height_m: f32,
    },
    Sweep {
        width_m: f32,
        height_m: f32,
        depth_m: f32,
        radius_m: f32,
    },
    VFlat {
        wing_m: f32,
        height_m: f32,
        angle_deg: f32,
    },
    Prop(PropV1),
    Tank(Box<TankV1>),
}

impl From<ShapeV1> for Shape {
    fn from(file: ShapeV1) -> Self {
        match file {
            ShapeV1::MeshFile { path } => Shape::MeshFile { path },
            ShapeV1::Figure(person) => Shape::Figure(Box::new((*person).into())),
            ShapeV1::Mannequin { figure, pose } => Shape::Figure(Box::new(mannequin::person(figure, pose))),
            ShapeV1::Plane { width_m, depth_m } => Shape::Plane { width_m, depth_m },
            ShapeV1::Box { size_m } => Shape::Box { size_m: Vec3::from(size_m) },
            ShapeV1::Sphere { radius_m } => Shape::Sphere { radius_m },
            ShapeV1::Cylinder { radius_m, height_m } => Shape::Cylinder { radius_m, height_m },
            ShapeV1::Sweep { width_m, height_m, depth_m, radius_m } => {
                Shape::Sweep { width_m, height_m, depth_m, radius_m }
            }
            ShapeV1::VFlat { wing_m, height_m, angle_deg } => Shape::VFlat { wing_m, height_m, angle_deg },
            ShapeV1::Prop(model) => Shape::Prop(model.into()),
            ShapeV1::Tank(tank) => Shape::Tank(Box::new((*tank).into())),
        }
    }
}

impl From<&Shape> for ShapeV1 {
    fn from(shape: &Shape) -> Self {
        match shape.clone() {
            Shape::MeshFile { path } => ShapeV1::MeshFile { path },
            Shape::Figure(figure) => ShapeV1::Figure(Box::new(PersonV1::from(&*figure))),
            Shape::Plane { width_m, depth_m } => ShapeV1::Plane { width_m, depth_m },
            Shape::Box { size_m } => ShapeV1::Box { size_m: size_m.to_array() },
            Shape::Sphere { radius_m } => ShapeV1::Sphere { radius_m },
            Shape::Cylinder { radius_m, height_m } => ShapeV1::Cylinder { radius_m, height_m },
            Shape::Sweep { width_m, height_m, depth_m, radius_m } => {
                ShapeV1::Sweep { width_m, height_m, depth_m, radius_m }
            }
            Shape::VFlat { wing_m, height_m, angle_deg } => ShapeV1::VFlat { wing_m, height_m, angle_deg },
            Shape::Prop(model) => ShapeV1::Prop(model.into()),
            Shape::Tank(tank) => ShapeV1::Tank(Box::new((*tank).into())),
        }
    }
}

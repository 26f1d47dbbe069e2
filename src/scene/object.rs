//! Things that are lit: mannequins, props, backdrops.

use super::{Material, ObjectId};
use glam::{Affine3A, EulerRot, Quat, Vec3};

/// A figure of the wardrobe.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub enum Figure {
    /// A grown woman, 1.68 m.
    Woman,
    /// A grown man, 1.80 m.
    Man,
    /// A child of eight, 1.28 m.
    Child,
    /// Head and shoulders, for portraits.
    Bust,
}

/// How a figure holds itself.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub enum Pose {
    /// Upright, arms at the sides.
    Standing,
    /// Weight on one leg, hand on the hip.
    Contrapposto,
    /// On a seat of 45 cm (child 32 cm), which is not part of the figure.
    Seated,
    /// Head turned 30 degrees to its left.
    HeadTurned,
}

/// A mannequin: its origin is the floor between its feet (for a bust the base's centre); it looks along +Z.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub struct Mannequin {
    /// Who.
    pub figure: Figure,
    /// How.
    pub pose: Pose,
}

/// Geometry of an object in its own space, metres.
#[derive(Clone, Debug, PartialEq)]
pub enum Shape {
    /// An OBJ file; relative to the scene file, `/` between folders.
    MeshFile {
        /// Relative path.
        path: String,
    },
    /// A figure of the wardrobe.
    Mannequin(Mannequin),
    /// A rectangle in the XZ plane about the origin, facing +Y.
    Plane {
        /// Along X.
        width_m: f32,
        /// Along Z.
        depth_m: f32,
    },
    /// A box about the origin.
    Box {
        /// Edge lengths.
        size_m: Vec3,
    },
    /// A sphere about the origin.
    Sphere {
        /// Radius.
        radius_m: f32,
    },
    /// A closed cylinder about the origin, axis along Y.
    Cylinder {
        /// Radius.
        radius_m: f32,
        /// Height.
        height_m: f32,
    },
    /// A paper roll hung up and pulled forward: wall, curve and floor in one smooth piece. Its origin is on the floor
    /// below the front of the wall; the floor runs to +Z.
    Sweep {
        /// Along X.
        width_m: f32,
        /// Of the wall.
        height_m: f32,
        /// Of the floor, from the wall.
        depth_m: f32,
        /// Of the curve between them.
        radius_m: f32,
    },
}

impl Shape {
    /// Label in lists.
    pub fn label(&self) -> &'static str {
        match self {
            Shape::MeshFile { .. } => "Model",
            Shape::Mannequin(_) => "Mannequin",
            Shape::Plane { .. } => "Plane",
            Shape::Box { .. } => "Box",
            Shape::Sphere { .. } => "Sphere",
            Shape::Cylinder { .. } => "Cylinder",
            Shape::Sweep { .. } => "Backdrop",
        }
    }
}

/// Place, turn and size of an object.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Transform {
    /// Of the object's origin, metres.
    pub position: Vec3,
    /// Pitch (about X), yaw (about Y), roll (about Z), degrees; applied roll first, yaw last.
    pub rotation_deg: Vec3,
    /// Scale along the object's own axes.
    pub scale: Vec3,
}

impl Default for Transform {
    fn default() -> Self {
        Transform { position: Vec3::ZERO, rotation_deg: Vec3::ZERO, scale: Vec3::ONE }
    }
}

impl Transform {
    /// The rotation alone.
    pub fn rotation(&self) -> Quat {
        let [pitch, yaw, roll] = self.rotation_deg.to_array().map(f32::to_radians);
        Quat::from_euler(EulerRot::YXZ, yaw, pitch, roll)
    }

    /// Sets the rotation, as pitch, yaw and roll in degrees.
    pub fn set_rotation(&mut self, rotation: Quat) {
        let (yaw, pitch, roll) = rotation.to_euler(EulerRot::YXZ);
        self.rotation_deg = Vec3::new(pitch, yaw, roll).map(f32::to_degrees);
    }

    /// World from object.
    pub fn world_from_object(&self) -> Affine3A {
        Affine3A::from_scale_rotation_translation(self.scale, self.rotation(), self.position)
    }
}

/// One thing in the studio.
#[derive(Clone, Debug, PartialEq)]
pub struct Object {
    /// Stable while the scene is open.
    pub id: ObjectId,
    /// Unique among objects and lights.
    pub name: String,
    /// Where it stands.
    pub transform: Transform,
    /// What it is.
    pub shape: Shape,
    /// Its surface.
    pub material: Material,
    /// Other surfaces for named parts of its mesh: a mannequin's `eyes`, a group of an OBJ file.
    pub part_materials: Vec<(String, Material)>,
    /// Hidden things are neither seen nor do they cast shadows.
    pub visible: bool,
    /// Stays where it is: the editor neither moves nor deletes it, and a click in a view goes past it.
    pub locked: bool,
}

impl Object {
    /// The surface of a part of the mesh.
    pub fn material_of(&self, part: &str) -> &Material {
        self.part_materials.iter().find(|(name, _)| name == part).map_or(&self.material, |(_, material)| material)
    }
}

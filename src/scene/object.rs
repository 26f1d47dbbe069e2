//! Objects: figures, props, backdrops.

use super::{Figure, Material, ObjectId, PropModel, Tank};
use glam::{Affine3A, EulerRot, Quat, Vec3};
use std::borrow::Cow;

/// Geometry of an object in its own space, metres.
#[derive(Clone, Debug, PartialEq)]
pub enum Shape {
    /// An OBJ file; relative to the scene file, `/` between folders.
    MeshFile {
        /// Relative path.
        path: String,
    },
    /// A person.
    Figure(Box<Figure>),
    /// A rectangle in the XZ plane about the origin, facing +Y.
    Plane {
        /// Size along X.
        width_m: f32,
        /// Size along Z.
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
    /// Seamless paper: wall, curve and floor in one smooth surface. Its origin is on the floor below the front of the
    /// wall; the floor extends to +Z.
    Sweep {
        /// Size along X.
        width_m: f32,
        /// Height of the wall.
        height_m: f32,
        /// Depth of the floor, from the wall.
        depth_m: f32,
        /// Radius of the curve between them.
        radius_m: f32,
    },
    /// Two boards that meet in a vertical edge through the origin and open to +Z.
    VFlat {
        /// Width of each board.
        wing_m: f32,
        /// Height of the boards, half of it below the origin.
        height_m: f32,
        /// Angle between the boards, degrees: 180 is one flat board.
        angle_deg: f32,
    },
    /// A block of ground and water in cells. Its origin is the centre of its underside.
    Tank(Box<Tank>),
    /// A prop of a fixed form, on the floor.
    Prop(PropModel),
}

impl Shape {
    /// Returns true for paper, cloth and boards, which stand behind or beside a subject and are none.
    pub fn is_sheet(&self) -> bool {
        match self {
            Shape::Plane { .. } | Shape::Sweep { .. } | Shape::VFlat { .. } => true,
            Shape::Prop(model) => model.is_backdrop(),
            Shape::MeshFile { .. }
            | Shape::Figure(_)
            | Shape::Box { .. }
            | Shape::Sphere { .. }
            | Shape::Cylinder { .. }
            | Shape::Tank(_) => false,
        }
    }

    /// Returns the label in lists.
    pub fn label(&self) -> &'static str {
        match self {
            Shape::MeshFile { .. } => "Model",
            Shape::Figure(_) => "Figure",
            Shape::Plane { .. } => "Plane",
            Shape::Box { .. } => "Box",
            Shape::Sphere { .. } => "Sphere",
            Shape::Cylinder { .. } => "Cylinder",
            Shape::Sweep { .. } => "Backdrop",
            Shape::VFlat { .. } => "V-flat",
            Shape::Tank(_) => "Water tank",
            Shape::Prop(model) => model.label(),
        }
    }
}

/// Position, rotation and scale of an object.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Transform {
    /// Position of the object's origin, metres.
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
    /// Returns the transform that moves the origin to `position`, metres.
    pub fn at(position: Vec3) -> Self {
        Transform { position, ..Transform::default() }
    }

    /// Returns the rotation.
    pub fn rotation(&self) -> Quat {
        let [pitch, yaw, roll] = self.rotation_deg.to_array().map(f32::to_radians);
        Quat::from_euler(EulerRot::YXZ, yaw, pitch, roll)
    }

    /// Sets the rotation, as pitch, yaw and roll in degrees.
    pub fn set_rotation(&mut self, rotation: Quat) {
        let (yaw, pitch, roll) = rotation.to_euler(EulerRot::YXZ);
        self.rotation_deg = Vec3::new(pitch, yaw, roll).map(f32::to_degrees);
    }

    /// Returns the world-from-object transform.
    pub fn world_from_object(&self) -> Affine3A {
        Affine3A::from_scale_rotation_translation(self.scale, self.rotation(), self.position)
    }
}

/// An object of the studio.
#[derive(Clone, Debug, PartialEq)]
pub struct Object {
    /// Stable while the scene is open.
    pub id: ObjectId,
    /// Unique among objects and lights.
    pub name: String,
    /// World-from-object transform.
    pub transform: Transform,
    /// Geometry.
    pub shape: Shape,
    /// Material.
    pub material: Material,
    /// Materials of named parts of its mesh: a figure's `eyes`, a group of an OBJ file.
    pub part_materials: Vec<(String, Material)>,
    /// False hides the object and its shadow.
    pub visible: bool,
    /// Locked: the editor neither moves nor deletes it, and clicks in a view ignore it.
    pub locked: bool,
}

impl Object {
    /// Returns a visible object at the origin with the default material. A scene gives it its id.
    pub fn new(name: impl Into<String>, shape: Shape) -> Self {
        Object {
            id: ObjectId(0),
            name: name.into(),
            transform: Transform::default(),
            shape,
            material: Material::default(),
            part_materials: Vec::new(),
            visible: true,
            locked: false,
        }
    }

    /// Returns the material of a part of the mesh.
    pub fn material_of(&self, part: &str) -> &Material {
        self.part_materials.iter().find(|(name, _)| name == part).map_or(&self.material, |(_, material)| material)
    }

    /// Returns the material of a part for views that trace no rays through it: the water of a tank has the colour that a
    /// layer of it has, of a quarter of the tank's height.
    pub fn untraced_material_of(&self, part: &str) -> Cow<'_, Material> {
        let material = self.material_of(part);
        let Shape::Tank(tank) = &self.shape else { return Cow::Borrowed(material) };
        if material.transmission == 0.0 || material.absorption_per_m == [0.0; 3] {
            return Cow::Borrowed(material);
        }
        let depth_m = 0.25 * tank.size_m().y * self.transform.scale.y.abs();
        let color = |i: usize| material.base_color[i] * (-material.absorption_per_m[i] * depth_m).exp();
        Cow::Owned(Material { base_color: [0, 1, 2].map(color), ..material.clone() })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn water_that_is_not_traced_has_the_colour_of_a_layer_of_it() {
        let tank = Tank { cells: [8, 20, 8], cell_m: 0.02, ..Tank::default() };
        let mut object = Object::new("Tank", Shape::Tank(Box::new(tank)));
        let water = Material {
            absorption_per_m: [10.0, 0.0, 1.0],
            transmission: 1.0,
            base_color: [1.0; 3],
            ..Material::default()
        };
        object.part_materials.push(("water".to_owned(), water.clone()));
        // A quarter of 40 cm
        let shown = object.untraced_material_of("water").base_color;
        let expected = [(-1.0_f32).exp(), 1.0, (-0.1_f32).exp()];
        assert!(shown.iter().zip(expected).all(|(a, b)| (a - b).abs() < 1e-6), "{shown:?}");
        assert_eq!(*object.untraced_material_of("ground"), object.material);
        object.shape = Shape::Sphere { radius_m: 0.1 };
        assert_eq!(*object.untraced_material_of("water"), water, "other bodies are as they were");
    }
}

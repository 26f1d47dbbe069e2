//! The studio as plain data: what the user edits, what a file holds, what every renderer reads.
//!
//! Everything here is `Clone + PartialEq`, does no I/O and holds no GPU handle. Lengths are metres, angles are
//! degrees (the fields say `_deg`: the file, the panels and the history then hold the very number the user typed;
//! renderers convert once, when they prepare). Axes are right-handed with Y up; cameras and lights look along their
//! local -Z.

mod aim;
mod assets;
mod camera;
mod change;
mod emitter;
mod gel;
mod id;
mod inventory;
mod light;
mod material;
mod mesh;
mod meter;
mod modifier;
mod named_modifier;
mod object;
mod room;
mod tessellate;
mod validate;

pub use aim::Aim;
pub use assets::{Assets, Texture, path_complaint};
pub use camera::{Camera, CameraFrame, Focus, Orientation, Sensor};
pub use change::{LightChange, SceneChange};
pub use emitter::Emitter;
pub use gel::{Gel, GelFamily, NamedGel};
pub use id::{LightId, ObjectId};
pub use inventory::{AssetField, AssetRef, MaterialSlot};
pub use light::{ColorSource, Light, LightColor, Output, Power, Role, Solo};
pub use material::{Material, MaterialPreset};
pub use mesh::{Mesh, MeshPart};
pub use meter::{Facing, Meter, Receptor};
pub use modifier::{BarnDoors, Cone, Modifier};
pub use named_modifier::{HARD_GRIDS_DEG, NamedModifier, SOFT_GRIDS_DEG};
pub use object::{Figure, Mannequin, Object, Pose, Shape, Transform};
pub use room::Room;
pub use tessellate::{ROOM_STANDS_BACK_M, room_mesh, tessellate};
pub use validate::{Finding, LIST_LIMIT, Severity, placement, validate};

use glam::Vec3;

/// A whole studio.
#[derive(Clone, Debug, PartialEq, Default)]
pub struct Scene {
    /// Title, for window and lists.
    pub name: String,
    /// One line that says what the set-up is for.
    pub description: String,
    /// The camera that takes the picture.
    pub camera: Camera,
    /// Floor, walls and ceiling; none is an endless black void.
    pub room: Option<Room>,
    /// Mannequins, props and backdrops, in list order.
    pub objects: Vec<Object>,
    /// All lights, in list order; film layers follow this order.
    pub lights: Vec<Light>,
    /// The light meter, where one is up.
    pub meter: Option<Meter>,
    /// While some lights shine alone: which, and what was on before.
    pub solo: Option<Solo>,
}

impl Scene {
    /// Whether a light is off only because others shine alone.
    pub fn is_silenced(&self, light: &Light) -> bool {
        !light.on && self.solo.as_ref().is_some_and(|solo| solo.restores.contains(&light.id))
    }

    /// The object with this id.
    pub fn object(&self, id: ObjectId) -> Option<&Object> {
        self.objects.iter().find(|o| o.id == id)
    }

    /// The object with this id, to be changed.
    pub fn object_mut(&mut self, id: ObjectId) -> Option<&mut Object> {
        self.objects.iter_mut().find(|o| o.id == id)
    }

    /// The light with this id.
    pub fn light(&self, id: LightId) -> Option<&Light> {
        self.lights.iter().find(|l| l.id == id)
    }

    /// The light with this id, to be changed.
    pub fn light_mut(&mut self, id: LightId) -> Option<&mut Light> {
        self.lights.iter_mut().find(|l| l.id == id)
    }

    /// An id no object has.
    pub fn fresh_object_id(&self) -> ObjectId {
        ObjectId(self.objects.iter().map(|o| o.id.0 + 1).max().unwrap_or(0))
    }

    /// An id no light has.
    pub fn fresh_light_id(&self) -> LightId {
        LightId(self.lights.iter().map(|l| l.id.0 + 1).max().unwrap_or(0))
    }

    /// `wanted`, or `wanted 2`, `wanted 3` ...: the first name that no object and no light bears.
    pub fn unique_name(&self, wanted: &str) -> String {
        let taken =
            |name: &str| self.objects.iter().any(|o| o.name == name) || self.lights.iter().any(|l| l.name == name);
        if !taken(wanted) {
            return wanted.to_owned();
        }
        let stem = wanted.trim_end_matches(|c: char| c.is_ascii_digit()).trim_end();
        let stem = if stem.is_empty() { wanted } else { stem };
        (2..).map(|n| format!("{stem} {n}")).find(|name| !taken(name)).unwrap_or_default()
    }

    /// The world point that `aim` means for something that stands at `position`. An aim at an object that is gone
    /// means the origin; `validate` reports it.
    pub fn aim_point(&self, aim: &Aim, position: Vec3) -> Vec3 {
        match *aim {
            Aim::Point(point) => point,
            Aim::Object { object, offset } => {
                self.object(object).map_or(Vec3::ZERO, |o| o.transform.world_from_object().transform_point3(offset))
            }
            Aim::Angles { yaw_deg, pitch_deg } => {
                let (sin_yaw, cos_yaw) = yaw_deg.to_radians().sin_cos();
                let (sin_pitch, cos_pitch) = pitch_deg.to_radians().sin_cos();
                position + Vec3::new(-sin_yaw * cos_pitch, sin_pitch, -cos_yaw * cos_pitch)
            }
        }
    }

    /// World frame of a light: columns right, up, back (it shines along -Z), and its position.
    pub fn light_frame(&self, light: &Light) -> glam::Affine3A {
        let target = self.aim_point(&light.aim, light.position);
        crate::math::look_at(light.position, target, light.roll_deg.to_radians())
    }

    /// What the camera frames at a picture aspect (width / height).
    pub fn camera_frame(&self, aspect: f32) -> CameraFrame {
        let target = self.aim_point(&self.camera.aim, self.camera.position);
        self.camera.frame(target, aspect)
    }
}

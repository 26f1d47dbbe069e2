//! The scene: a studio as plain data, which the user edits, files store and every renderer reads.
//!
//! All types are `Clone + PartialEq`, do no I/O and hold no GPU handles. Lengths are in metres. Angles are in degrees,
//! in fields that end in `_deg`, so that file, panels and undo history keep the number that the user typed; renderers
//! convert when they prepare. Axes are right-handed with Y up; cameras and lights look along their local -Z.

mod aim;
mod assets;
mod bodies;
mod body;
mod builtin_texture;
mod camera;
mod change;
mod emitter;
mod environment_map;
mod fibre;
mod figure;
mod focused_lens;
mod gel;
mod head;
mod id;
mod intensity_table;
mod inventory;
mod light;
mod material;
mod material_preset;
mod mesh;
mod meter;
mod modifier;
mod modifier_kind;
mod named_modifier;
mod object;
mod plain_base;
mod prop;
mod ribbons;
mod room;
mod strands;
mod surface_layers;
mod tank;
mod tessellate;
mod texture;
mod texture_placement;
mod validate;
mod variants;

pub use aim::Aim;
pub use assets::{Asset, AssetKey, AssetRef, Assets, FigureMeshes, path_complaint};
pub use bodies::{Bodies, BodyChoice};
pub use body::{BodyPiece, LightBody, ModifierShape, PieceShape, body_material};
pub use builtin_texture::BuiltinTexture;
pub use camera::{Camera, CameraFrame, Focus, Orientation, Sensor};
pub use change::{LightChange, SceneChange};
pub use emitter::Emitter;
pub use environment_map::{BrightSpot, EnvironmentMap};
pub use fibre::{Fibre, FibreColor};
pub use figure::{
    Arm, Beard, Body, Bottom, Expression, Extent, Face, Figure, Gaze, HairStyle, Leg, Parameter, ParameterSet, Pose,
    SEAT_RANGE_M, Top, Torso,
};
pub use focused_lens::FocusedLens;
pub use gel::{Gel, GelFamily, NamedGel};
pub use head::{BeyondDial, DialScale, Head, HeadDial};
pub use id::{LightId, ObjectId};
pub use intensity_table::IntensityTable;
pub use inventory::{AssetField, MaterialSlot};
pub use light::{ColorSource, Light, LightColor, Output, Power, Role, Solo};
pub use material::{Alpha, Material, Subsurface};
pub use material_preset::MaterialPreset;
pub use mesh::{Mesh, MeshPart};
pub use meter::{Facing, Meter, Receptor};
pub use modifier::{BarnDoors, Cone, Modifier};
pub use modifier_kind::ModifierKind;
pub use named_modifier::{HARD_GRIDS_DEG, NamedModifier, SOFT_GRIDS_DEG};
pub use object::{Object, Shape, Transform};
pub use plain_base::PlainBase;
pub use prop::PropModel;
pub use ribbons::strand_ribbons;
pub use room::Room;
pub use strands::{StrandPart, StrandPoint, Strands};
pub use surface_layers::{Anisotropy, Clearcoat, Sheen};
pub use tank::{
    Block, BrushStroke, CellContent, Drop, FLUID_FRAMES_PER_S, Fluid, Jet, Obstacle, ObstacleForm, Spring,
    TANK_STEPS_PER_S, Tank, TankLook, Terrain,
};
pub use tessellate::{ROOM_STANDS_BACK_M, room_mesh, tessellate};
pub use texture::{MaterialTextures, Texture, TextureRef, TextureSlot};
pub use texture_placement::{TexturePlacement, Wrap};
pub use validate::{Finding, LIST_LIMIT, Severity, placement, validate};
pub use variants::{CameraDifference, LightDifference, SetupDifference, VARIANT_LIMIT, Variant, VariantId, Variants};

use aim::direction_of_angles;
use glam::Vec3;

/// A whole studio.
#[derive(Clone, Debug, PartialEq, Default)]
pub struct Scene {
    /// Title.
    pub name: String,
    /// One line on the purpose of the set-up.
    pub description: String,
    /// The camera.
    pub camera: Camera,
    /// Floor, walls and ceiling; `None` is an empty black space.
    pub room: Option<Room>,
    /// Figures, props and backdrops, in list order.
    pub objects: Vec<Object>,
    /// Lights, in list order; film layers have the same order.
    pub lights: Vec<Light>,
    /// The bodies of lights, where a light does not say otherwise.
    pub bodies: Bodies,
    /// The light meter, if there is one.
    pub meter: Option<Meter>,
    /// The solo, if some lights are on alone.
    pub solo: Option<Solo>,
    /// The variants, of which the fields above are the shown one.
    pub variants: Variants,
}

/// The object or light that has a name.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum NameOwner {
    /// An object.
    Object(ObjectId),
    /// A light.
    Light(LightId),
}

impl Scene {
    /// Returns the name, with that of the variant if there are several.
    pub fn title(&self) -> String {
        match self.variants.name(self.variants.shown()).filter(|_| !self.variants.is_empty()) {
            Some(variant) => format!("{} ({variant})", self.name).trim_start().to_owned(),
            None => self.name.clone(),
        }
    }

    /// Returns true if a light is off only because others are soloed.
    pub fn is_silenced(&self, light: &Light) -> bool {
        !light.on && self.solo.as_ref().is_some_and(|solo| solo.restores.contains(&light.id))
    }

    /// Ends the solo and restores the switches. Lights added during the solo keep theirs.
    pub fn end_solo(&mut self) {
        if let Some(solo) = self.solo.take() {
            solo.end(&mut self.lights);
        }
    }

    /// Returns the object with this id.
    pub fn object(&self, id: ObjectId) -> Option<&Object> {
        self.objects.iter().find(|o| o.id == id)
    }

    /// Returns the object with this id, to change it.
    pub fn object_mut(&mut self, id: ObjectId) -> Option<&mut Object> {
        self.objects.iter_mut().find(|o| o.id == id)
    }

    /// Returns the light with this id.
    pub fn light(&self, id: LightId) -> Option<&Light> {
        self.lights.iter().find(|l| l.id == id)
    }

    /// Returns the light with this id, to change it.
    pub fn light_mut(&mut self, id: LightId) -> Option<&mut Light> {
        self.lights.iter_mut().find(|l| l.id == id)
    }

    /// Returns an id that no object has.
    pub fn fresh_object_id(&self) -> ObjectId {
        ObjectId(self.objects.iter().map(|o| o.id.0 + 1).max().unwrap_or(0))
    }

    /// Returns an id that no light of any variant has.
    pub fn fresh_light_id(&self) -> LightId {
        LightId(self.lights.iter().chain(self.variants.stored_lights()).map(|l| l.id.0 + 1).max().unwrap_or(0))
    }

    /// Returns the first of `wanted`, `wanted 2`, `wanted 3` ... that is not the name of an object or of a light of any
    /// variant. A copy of `Key 2` is `Key 3` where there is a `Key`; one of `Octa 120` is `Octa 120 2`.
    pub fn unique_name(&self, wanted: &str) -> String {
        let taken = |name: &str| self.name_owner(name).is_some();
        if !taken(wanted) {
            return wanted.to_owned();
        }
        let stem = name_stem(wanted, taken);
        (2..).map(|n| format!("{stem} {n}")).find(|name| !taken(name)).unwrap_or_default()
    }

    /// Returns the object or light, of any variant, that has this name.
    pub fn name_owner(&self, name: &str) -> Option<NameOwner> {
        let object = self.objects.iter().find(|object| object.name == name).map(|object| NameOwner::Object(object.id));
        // The names of stored lights follow when another variant is shown
        let stored = self.variants.stored_lights().filter(|light| self.light(light.id).is_none());
        let mut lights = self.lights.iter().chain(stored);
        object.or_else(|| lights.find(|light| light.name == name).map(|light| NameOwner::Light(light.id)))
    }

    /// Returns the world-space point of an aim from `position`; 1 m ahead for angles. For an object that does not
    /// exist, it is the origin; `validate` reports that.
    ///
    /// A direction is to be computed by [`Scene::aim_vector`]: far from the origin the point rounds to centimetres.
    pub fn aim_point(&self, aim: &Aim, position: Vec3) -> Vec3 {
        match *aim {
            Aim::Point(point) => point,
            Aim::Object { object, offset } => {
                self.object(object).map_or(Vec3::ZERO, |o| o.transform.world_from_object().transform_point3(offset))
            }
            Aim::Angles { .. } => position + self.aim_vector(aim, position),
        }
    }

    /// Returns the vector from `position` to the point of an aim, metres, world space; a unit vector for angles.
    pub fn aim_vector(&self, aim: &Aim, position: Vec3) -> Vec3 {
        match *aim {
            Aim::Angles { yaw_deg, pitch_deg } => direction_of_angles(yaw_deg, pitch_deg),
            Aim::Point(_) | Aim::Object { .. } => self.aim_point(aim, position) - position,
        }
    }

    /// Returns the world frame of a light: columns right, up, back (it faces -Z), and its position.
    pub fn light_frame(&self, light: &Light) -> glam::Affine3A {
        let ahead = self.aim_vector(&light.aim, light.position);
        crate::math::look_along(light.position, ahead, light.roll_deg.to_radians())
    }

    /// Returns the camera's frame for a picture aspect (width / height).
    pub fn camera_frame(&self, aspect: f32) -> CameraFrame {
        self.focused_lens().frame(&self.camera, aspect)
    }

    /// Returns the camera's lens at its focus.
    pub fn focused_lens(&self) -> FocusedLens {
        FocusedLens::new(self, &self.camera)
    }
}

/// Returns a name without the number that tells it from its likes: a number counts as one where something bears the name
/// without it, and is part of the name otherwise.
pub fn name_stem(name: &str, is_taken: impl Fn(&str) -> bool) -> &str {
    let stem = name.trim_end_matches(|c: char| c.is_ascii_digit()).trim_end();
    if stem.is_empty() || !is_taken(stem) { name } else { stem }
}

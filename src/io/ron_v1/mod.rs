//! Format 1 of the scene file: the structs that serde reads and writes, separate from the scene's own, so that the
//! scene can change without breaking files. A later format gets its own module, and this one an upgrade step.
//!
//! Lengths are metres, angles degrees; other units are part of the names. Default values may be left out (a scale of 1,
//! a light that is on). [`scene`] and [`convert`] resolve names to ids.

#[macro_use]
mod same_variants;

mod bodies;
mod convert;
mod defaults;
mod figure;
mod fluid;
mod gear;
mod head;
mod mannequin;
mod material;
mod material_layers;
mod material_preset;
mod names;
mod painted_eyes;
mod prop;
mod scene;
mod shape;
mod tank;
mod texture_placement;
mod variants;

pub(super) use gear::{GearV1, gear_from_v1, v1_from_gear};
pub(super) use names::UnknownName;
pub(super) use scene::{scene_from_v1, v1_from_scene};

use bodies::{BodiesV1, BodyChoiceV1};
use defaults::{
    Triple, default_efficacy, default_meter_constant, is_default, is_default_meter_constant, is_one, is_studio_name,
    is_true, one, studio_name, yes,
};
use head::{HeadChangeV1, HeadV1};
use material::MaterialV1;
use serde::{Deserialize, Serialize};
use shape::ShapeV1;

/// The whole file.
#[derive(Debug, Serialize, Deserialize)]
#[serde(rename = "Scene", deny_unknown_fields)]
pub(super) struct SceneV1 {
    format: u32,
    name: String,
    #[serde(default)]
    description: String,
    camera: CameraV1,
    #[serde(default, skip_serializing_if = "Option::is_none")]
    room: Option<RoomV1>,
    #[serde(default)]
    objects: Vec<ObjectV1>,
    #[serde(default)]
    lights: Vec<LightV1>,
    #[serde(default, skip_serializing_if = "is_default")]
    bodies: BodiesV1,
    #[serde(default, skip_serializing_if = "Option::is_none")]
    meter: Option<MeterV1>,
    #[serde(default, skip_serializing_if = "Option::is_none")]
    solo: Option<SoloV1>,
    #[serde(default, skip_serializing_if = "Option::is_none")]
    variants: Option<VariantsV1>,
}

/// The soloed lights, by name, and those that were on before.
#[derive(Debug, Serialize, Deserialize)]
#[serde(rename = "Solo", deny_unknown_fields)]
struct SoloV1 {
    lights: Vec<String>,
    #[serde(default)]
    restores: Vec<String>,
}

/// A light meter in the studio.
#[derive(Clone, Copy, Debug, Serialize, Deserialize)]
#[serde(rename = "Meter", deny_unknown_fields)]
struct MeterV1 {
    position: Triple,
    #[serde(default, skip_serializing_if = "is_default")]
    facing: FacingV1,
    #[serde(default)]
    receptor: ReceptorV1,
}

#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(rename = "Facing", deny_unknown_fields)]
enum FacingV1 {
    #[default]
    Camera,
    Angles {
        yaw_deg: f32,
        pitch_deg: f32,
    },
}

#[derive(Clone, Copy, Debug, Default, Serialize, Deserialize)]
#[serde(rename = "Receptor")]
enum ReceptorV1 {
    #[default]
    Flat,
    Dome,
}

#[derive(Debug, Serialize, Deserialize)]
#[serde(rename = "Camera", deny_unknown_fields)]
struct CameraV1 {
    position: Triple,
    aim: AimV1,
    #[serde(default, skip_serializing_if = "is_default")]
    roll_deg: f32,
    #[serde(default)]
    sensor: SensorV1,
    #[serde(default)]
    orientation: OrientationV1,
    focal_length_mm: f32,
    f_number: f32,
    shutter_s: f32,
    iso: f32,
    white_balance_k: f32,
    #[serde(default, skip_serializing_if = "is_default")]
    nd_stops: f32,
    #[serde(default, skip_serializing_if = "is_default")]
    focus: FocusV1,
    #[serde(default, skip_serializing_if = "is_default")]
    depth_of_field: bool,
    #[serde(default, skip_serializing_if = "is_default")]
    focus_breathing: bool,
    #[serde(default = "default_meter_constant", skip_serializing_if = "is_default_meter_constant")]
    meter_constant: f32,
}

#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(rename = "Sensor", deny_unknown_fields)]
enum SensorV1 {
    #[default]
    FullFrame,
    ApsC,
    MicroFourThirds,
    Medium44x33,
    Medium54x40,
    Custom {
        width_mm: f32,
        height_mm: f32,
    },
}

#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(rename = "Orientation")]
enum OrientationV1 {
    #[default]
    Landscape,
    Portrait,
}

/// The plane of focus.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(rename = "Focus", deny_unknown_fields)]
enum FocusV1 {
    #[default]
    OnAim,
    OnObject {
        name: String,
        #[serde(default, skip_serializing_if = "is_default")]
        offset: Triple,
    },
    Distance(f32),
}

/// The direction of a camera or a light.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(rename = "Aim", deny_unknown_fields)]
enum AimV1 {
    Point(f32, f32, f32),
    Object {
        name: String,
        #[serde(default, skip_serializing_if = "is_default")]
        offset: Triple,
    },
    Angles {
        yaw_deg: f32,
        pitch_deg: f32,
    },
}

#[derive(Debug, Serialize, Deserialize)]
#[serde(rename = "Room", deny_unknown_fields)]
struct RoomV1 {
    size_m: Triple,
    floor: MaterialV1,
    walls: MaterialV1,
    ceiling: MaterialV1,
}

#[derive(Debug, Serialize, Deserialize)]
#[serde(rename = "Object", deny_unknown_fields)]
struct ObjectV1 {
    name: String,
    shape: ShapeV1,
    #[serde(default)]
    position: Triple,
    #[serde(default, skip_serializing_if = "is_default")]
    rotation_deg: Triple,
    #[serde(default = "one", skip_serializing_if = "is_one")]
    scale: Triple,
    material: MaterialV1,
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    part_materials: Vec<PartMaterialV1>,
    #[serde(default = "yes", skip_serializing_if = "is_true")]
    visible: bool,
    #[serde(default, skip_serializing_if = "is_default")]
    locked: bool,
}

#[derive(Debug, Serialize, Deserialize)]
#[serde(rename = "PartMaterial", deny_unknown_fields)]
struct PartMaterialV1 {
    part: String,
    material: MaterialV1,
}

#[derive(Debug, Serialize, Deserialize)]
#[serde(rename = "Light", deny_unknown_fields)]
struct LightV1 {
    name: String,
    role: RoleV1,
    #[serde(default)]
    position: Triple,
    aim: AimV1,
    #[serde(default, skip_serializing_if = "is_default")]
    roll_deg: f32,
    emitter: EmitterV1,
    #[serde(default, skip_serializing_if = "Option::is_none")]
    photometric_file: Option<String>,
    #[serde(default, skip_serializing_if = "Option::is_none")]
    environment_map: Option<String>,
    #[serde(default, skip_serializing_if = "is_default")]
    modifier: ModifierV1,
    #[serde(default, skip_serializing_if = "Option::is_none")]
    head: Option<HeadV1>,
    power: PowerV1,
    color: ColorV1,
    #[serde(default, skip_serializing_if = "is_default")]
    gel: GelV1,
    /// Whether the gel takes its loss from the light. Without the field it does if there is no gel yet: files with gels
    /// are older than the field, and their lights make up for the loss.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    gel_loss_counts: Option<bool>,
    #[serde(default = "yes", skip_serializing_if = "is_true")]
    on: bool,
    #[serde(default, skip_serializing_if = "is_default")]
    visible_to_camera: bool,
    #[serde(default, skip_serializing_if = "is_default")]
    body: BodyChoiceV1,
    #[serde(default, skip_serializing_if = "is_default")]
    muted: bool,
    #[serde(default, skip_serializing_if = "is_default")]
    locked: bool,
}

#[derive(Clone, Copy, Debug, Serialize, Deserialize)]
#[serde(rename = "Role")]
enum RoleV1 {
    Key,
    Fill,
    Rim,
    Hair,
    Background,
    Accent,
}

#[derive(Clone, Copy, Debug, Serialize, Deserialize)]
#[serde(rename = "Emitter", deny_unknown_fields)]
enum EmitterV1 {
    Point,
    Sphere { radius_m: f32 },
    Spot { inner_deg: f32, outer_deg: f32 },
    RectPanel { width_m: f32, height_m: f32 },
    RoundPanel { diameter_m: f32 },
    Sun { angular_diameter_deg: f32 },
    Surround,
}

/// The photometric file of a variant's light where it differs.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(rename = "PhotometricFileChange", deny_unknown_fields)]
enum PhotometricFileChangeV1 {
    /// None.
    NoFile,
    /// This one, by its path.
    File(String),
}

/// A light modifier: losses and beam shapers.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(rename = "Modifier", deny_unknown_fields)]
struct ModifierV1 {
    #[serde(default, skip_serializing_if = "is_default")]
    loss_stops: f32,
    #[serde(default, skip_serializing_if = "is_default")]
    scrim_stops: f32,
    #[serde(default, skip_serializing_if = "Option::is_none")]
    beam: Option<ConeV1>,
    #[serde(default, skip_serializing_if = "Option::is_none")]
    grid_deg: Option<f32>,
    #[serde(default, skip_serializing_if = "Option::is_none")]
    doors: Option<BarnDoorsV1>,
}

#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(rename = "Cone", deny_unknown_fields)]
struct ConeV1 {
    inner_deg: f32,
    outer_deg: f32,
}

#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(rename = "BarnDoors", deny_unknown_fields)]
struct BarnDoorsV1 {
    left_deg: f32,
    right_deg: f32,
    top_deg: f32,
    bottom_deg: f32,
}

#[derive(Clone, Copy, Debug, Serialize, Deserialize)]
#[serde(rename = "Power", deny_unknown_fields)]
struct PowerV1 {
    output: OutputV1,
    #[serde(default, skip_serializing_if = "is_default")]
    dial_stops: f32,
}

#[derive(Clone, Copy, Debug, Serialize, Deserialize)]
#[serde(rename = "Output", deny_unknown_fields)]
enum OutputV1 {
    Lumens(f32),
    Candela(f32),
    LuxAt {
        lux: f32,
        distance_m: f32,
    },
    Lux(f32),
    FlashWs {
        energy_ws: f32,
        #[serde(default = "default_efficacy")]
        efficacy_lm_s_per_ws: f32,
    },
    FlashGuideNumber(f32),
}

#[derive(Clone, Copy, Debug, Serialize, Deserialize)]
#[serde(rename = "Color")]
enum ColorV1 {
    Kelvin(f32),
    Rgb(f32, f32, f32),
}

/// A gel. `NoGel`, since `None` is an absent value in RON.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(rename = "Gel")]
enum GelV1 {
    #[default]
    NoGel,
    Mired(f32),
    Tint(f32, f32, f32),
}

/// The variants.
#[derive(Debug, Serialize, Deserialize)]
#[serde(rename = "Variants", deny_unknown_fields)]
struct VariantsV1 {
    /// Name of the studio itself among them.
    #[serde(default = "studio_name", skip_serializing_if = "is_studio_name")]
    studio: String,
    /// The shown variant, in a copy that is kept for the case of a crash.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    shown: Option<String>,
    others: Vec<VariantV1>,
}

/// One variant. Lights and objects are referred to by name.
#[derive(Debug, Serialize, Deserialize)]
#[serde(rename = "Variant", deny_unknown_fields)]
struct VariantV1 {
    name: String,
    #[serde(default, skip_serializing_if = "is_default")]
    camera: CameraDifferenceV1,
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    lights: Vec<LightDifferenceV1>,
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    removed_lights: Vec<String>,
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    added_lights: Vec<LightV1>,
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    hidden: Vec<String>,
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    visible: Vec<String>,
}

/// Declares what differs in a struct: in parentheses the fields that are always written, then those that are left out
/// where they are equal.
macro_rules! difference {
    ($(#[$attribute:meta])* struct $name:ident ($($key:ident: $key_type:ty),*) {
        $($field:ident: $type:ty),+ $(,)?
    }) => {
        $(#[$attribute])*
        struct $name {
            $($key: $key_type,)*
            $(
                #[serde(default, skip_serializing_if = "Option::is_none")]
                $field: Option<$type>,
            )+
        }
    };
}

difference! {
    #[derive(Debug, Default, PartialEq, Serialize, Deserialize)]
    #[serde(rename = "CameraDifference", deny_unknown_fields)]
    struct CameraDifferenceV1 () {
        position: Triple,
        aim: AimV1,
        roll_deg: f32,
        sensor: SensorV1,
        orientation: OrientationV1,
        focal_length_mm: f32,
        f_number: f32,
        shutter_s: f32,
        iso: f32,
        white_balance_k: f32,
        nd_stops: f32,
        focus: FocusV1,
        depth_of_field: bool,
        focus_breathing: bool,
        meter_constant: f32,
    }
}

difference! {
    /// What differs in the light of this name. Output and dial are fields of their own: of the power, often the dial differs
    /// alone.
    #[derive(Debug, Serialize, Deserialize)]
    #[serde(rename = "LightDifference", deny_unknown_fields)]
    struct LightDifferenceV1 (light: String) {
        role: RoleV1,
        position: Triple,
        aim: AimV1,
        roll_deg: f32,
        emitter: EmitterV1,
        photometric_file: PhotometricFileChangeV1,
        environment_map: PhotometricFileChangeV1,
        modifier: ModifierV1,
        head: HeadChangeV1,
        output: OutputV1,
        dial_stops: f32,
        color: ColorV1,
        gel: GelV1,
        gel_loss_counts: bool,
        on: bool,
        visible_to_camera: bool,
        body: BodyChoiceV1,
        muted: bool,
    }
}

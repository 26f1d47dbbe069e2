//! Lights as a photographer states them: emitter, power, colour, role.

use super::{Aim, Emitter, Gel, LightId, Modifier};
use glam::Vec3;

/// What a light does in the set-up. It never changes what the light emits.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Default, Hash)]
pub enum Role {
    /// The main light.
    #[default]
    Key,
    /// Opens the key's shadows.
    Fill,
    /// Edge light from behind.
    Rim,
    /// On the hair, from above and behind.
    Hair,
    /// On the backdrop.
    Background,
    /// Anything else.
    Accent,
}

impl Role {
    /// All roles, in list order.
    pub const ALL: [Role; 6] = [Role::Key, Role::Fill, Role::Rim, Role::Hair, Role::Background, Role::Accent];

    /// Label in lists.
    pub fn label(self) -> &'static str {
        match self {
            Role::Key => "Key",
            Role::Fill => "Fill",
            Role::Rim => "Rim",
            Role::Hair => "Hair",
            Role::Background => "Background",
            Role::Accent => "Accent",
        }
    }
}

/// What the light gives with its dial at full power, before its [`Modifier`] takes from it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Output {
    /// Continuous luminous flux, lm.
    Lumens(f32),
    /// Continuous intensity on the axis, cd.
    Candela(f32),
    /// Continuous, as metered on the axis: `lux` at `distance_m`, far-field (I = E d2).
    LuxAt {
        /// Illuminance, lx.
        lux: f32,
        /// Distance from the light, metres.
        distance_m: f32,
    },
    /// Continuous light of a sun (illuminance normal to its direction) or a surround (illuminance on a plane that
    /// sees half of it), lx. Only for those two.
    Lux(f32),
    /// Flash energy with the head's efficacy.
    FlashWs {
        /// Stored energy, Ws.
        energy_ws: f32,
        /// Light a Ws gives, lm s per Ws; real heads 15-50.
        efficacy_lm_s_per_ws: f32,
    },
    /// Flash as a guide number on the axis, metres at ISO 100.
    FlashGuideNumber(f32),
}

impl Output {
    /// Efficacy assumed where nothing better is known, lm s per Ws.
    pub const DEFAULT_EFFICACY: f32 = 40.0;

    /// Whether this is a flash: counted once an exposure, whatever the shutter.
    pub fn is_flash(&self) -> bool {
        matches!(self, Output::FlashWs { .. } | Output::FlashGuideNumber(_))
    }
}

/// Output and the dial on the head.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Power {
    /// What the light gives at full power.
    pub output: Output,
    /// Dial, stops from full power: 0 is 1/1, -2 is 1/4.
    pub dial_stops: f32,
}

/// Where a light's colour comes from.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum ColorSource {
    /// Correlated colour temperature, kelvin.
    Kelvin(f32),
    /// Linear RGB, scaled to luminance 1 when used.
    Rgb([f32; 3]),
}

/// Colour of a light.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LightColor {
    /// Colour of the source.
    pub source: ColorSource,
    /// Filter before it.
    pub gel: Gel,
}

impl Default for LightColor {
    fn default() -> Self {
        LightColor { source: ColorSource::Kelvin(5500.0), gel: Gel::None }
    }
}

/// Some lights alone, and how to go back.
#[derive(Clone, Debug, PartialEq, Eq, Default)]
pub struct Solo {
    /// The lights that shine alone.
    pub lights: Vec<LightId>,
    /// The lights that were on before, and will be again.
    pub restores: Vec<LightId>,
}

/// One light of the studio.
#[derive(Clone, Debug, PartialEq)]
pub struct Light {
    /// Stable while the scene is open.
    pub id: LightId,
    /// Unique among objects and lights.
    pub name: String,
    /// Its part in the set-up.
    pub role: Role,
    /// Centre of the emitter, metres.
    pub position: Vec3,
    /// What it points at.
    pub aim: Aim,
    /// Turn about its axis, degrees.
    pub roll_deg: f32,
    /// What shines.
    pub emitter: Emitter,
    /// What is lost before it leaves.
    pub modifier: Modifier,
    /// How much.
    pub power: Power,
    /// In which colour.
    pub color: LightColor,
    /// Switched on.
    pub on: bool,
    /// Whether the camera sees the emitter itself. Mirrors and glass always show it.
    pub visible_to_camera: bool,
    /// Off only for now: it belongs to the set-up and comes on again when it is unmuted. Means nothing while `on`.
    pub muted: bool,
    /// Stays where it is: the editor neither moves nor deletes it, and a click in a view goes past it.
    pub locked: bool,
}

impl Light {
    /// A key light without a modifier, in white, switched on and unseen by the camera: at the origin, along -Z.
    pub fn new(emitter: Emitter, output: Output) -> Self {
        Light {
            id: LightId(0),
            name: "Light".to_owned(),
            role: Role::Key,
            position: Vec3::ZERO,
            aim: Aim::Point(Vec3::NEG_Z),
            roll_deg: 0.0,
            emitter,
            modifier: Modifier::default(),
            power: Power { output, dial_stops: 0.0 },
            color: LightColor::default(),
            on: true,
            visible_to_camera: false,
            muted: false,
            locked: false,
        }
    }
}

//! Lights in a photographer's terms: role, emitter, modifier, power, colour.

use super::{Aim, BodyChoice, Emitter, Gel, Head, HeadDial, LightId, Modifier};
use glam::Vec3;

/// The role of a light in the set-up, as a lighting diagram names it. It labels the light, groups it and colours its
/// gizmo; it does not change its output.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Default, Hash)]
pub enum Role {
    /// Main light: sets the exposure and shapes the subject.
    #[default]
    Key,
    /// Lifts the shadows of the key; sets the lighting ratio.
    Fill,
    /// Light from behind that outlines the subject (kicker, edge light).
    Rim,
    /// Light on the hair, from above and behind.
    Hair,
    /// Light on the background.
    Background,
    /// Any other light.
    Accent,
}

impl Role {
    /// All roles, in list order.
    pub const ALL: [Role; 6] = [Role::Key, Role::Fill, Role::Rim, Role::Hair, Role::Background, Role::Accent];

    /// Returns the label in lists.
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

    /// Returns the colour that stands for the role in views, lists and plans, sRGB: key amber, fill blue, rim pink, hair
    /// violet, background green, accent grey.
    pub fn srgb8(self) -> [u8; 3] {
        match self {
            Role::Key => [240, 176, 64],
            Role::Fill => [92, 156, 236],
            Role::Rim => [236, 112, 168],
            Role::Hair => [164, 124, 236],
            Role::Background => [104, 184, 116],
            Role::Accent => [176; 3],
        }
    }
}

/// The output of a light at full power, without the loss of its [`Modifier`].
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Output {
    /// Continuous luminous flux, lm.
    Lumens(f32),
    /// Continuous intensity on the axis, cd; of a light with a photometric file its largest intensity, as with all
    /// outputs that name the axis.
    Candela(f32),
    /// Continuous, metered on the axis: `lux` at `distance_m`, far field (I = E d²).
    LuxAt {
        /// Illuminance, lx.
        lux: f32,
        /// Distance from the light, metres.
        distance_m: f32,
    },
    /// Continuous illuminance of a sun (normal to its direction) or of a surround (on a plane that sees half of it),
    /// lx. Valid for these two alone.
    Lux(f32),
    /// Flash energy with the head's efficacy.
    FlashWs {
        /// Stored energy, Ws.
        energy_ws: f32,
        /// Luminous efficacy, lm s per Ws; real heads have 15 to 50.
        efficacy_lm_s_per_ws: f32,
    },
    /// Flash as a guide number on the axis, metres at ISO 100.
    FlashGuideNumber(f32),
}

impl Output {
    /// Default efficacy, lm s per Ws.
    pub const DEFAULT_EFFICACY: f32 = 40.0;

    /// Returns true for a flash, whose exposure does not depend on the shutter time.
    pub fn is_flash(&self) -> bool {
        matches!(self, Output::FlashWs { .. } | Output::FlashGuideNumber(_))
    }

    /// Returns true if it states luminous flux or energy; intensity or illuminance otherwise.
    pub fn states_flux(&self) -> bool {
        matches!(self, Output::Lumens(_) | Output::FlashWs { .. })
    }
}

/// The power of a light: its output, and the dial on the head.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Power {
    /// Output at full power.
    pub output: Output,
    /// Dial, stops from full power: 0 is 1/1, -2 is 1/4.
    pub dial_stops: f32,
}

/// The colour of a light source, before its gel.
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
    /// Gel.
    pub gel: Gel,
    /// True if the gel takes its loss from the light, as it does on the set; false if the head makes up for it.
    pub gel_loss_counts: bool,
}

impl LightColor {
    /// Returns the loss of the gel as far as it counts, stops.
    pub fn loss_stops(&self) -> f32 {
        if self.gel_loss_counts { self.gel.loss_stops() } else { 0.0 }
    }
}

impl Default for LightColor {
    fn default() -> Self {
        LightColor { source: ColorSource::Kelvin(5500.0), gel: Gel::None, gel_loss_counts: true }
    }
}

/// A solo: some lights on alone, to judge each light's contribution, and the switches to restore when it ends.
#[derive(Clone, Debug, PartialEq, Eq, Default)]
pub struct Solo {
    /// The soloed lights.
    pub lights: Vec<LightId>,
    /// The lights that were on before; ending the solo switches them on again.
    pub restores: Vec<LightId>,
}

impl Solo {
    /// Restores the switches of lights. Those added during the solo keep theirs.
    pub fn end(self, lights: &mut [Light]) {
        for light in lights {
            if self.restores.contains(&light.id) {
                light.on = true;
            } else if self.lights.contains(&light.id) {
                light.on = false;
            }
        }
    }
}

/// One light of the studio.
#[derive(Clone, Debug, PartialEq)]
pub struct Light {
    /// Stable while the scene is open.
    pub id: LightId,
    /// Unique among objects and lights.
    pub name: String,
    /// Role in the set-up.
    pub role: Role,
    /// Centre of the emitter, metres.
    pub position: Vec3,
    /// Aim.
    pub aim: Aim,
    /// Roll about its axis, degrees.
    pub roll_deg: f32,
    /// Luminous surface.
    pub emitter: Emitter,
    /// Path of the photometric file (IES, EULUMDAT) with its measured luminous intensity by direction, which takes the
    /// place of the emitter's own; relative to the scene file. The power says how much light it gives.
    pub photometric_file: Option<String>,
    /// Path of the picture (HDR, EXR) that a surround shines as, equirectangular, its middle towards -Z; relative to the
    /// scene file. `roll_deg` turns it to the left. The illuminance is that on the plane that gets most of its light.
    pub environment_map: Option<String>,
    /// Loss and beam shape.
    pub modifier: Modifier,
    /// The head behind it, if it is one of the list of gear: its dial. The output is in `power`.
    pub head: Option<Head>,
    /// Power.
    pub power: Power,
    /// Colour.
    pub color: LightColor,
    /// Switched on.
    pub on: bool,
    /// True if the camera sees the emitter itself. Mirrors and glass always show it.
    pub visible_to_camera: bool,
    /// Its body: modifier, head and stand.
    pub body: BodyChoice,
    /// Muted: off, and on again when it is unmuted. Ignored while `on`.
    pub muted: bool,
    /// Locked: the editor neither moves nor deletes it, and clicks in a view ignore it.
    pub locked: bool,
}

impl Light {
    /// Returns a white key light without modifier, on, not visible to the camera, at the origin and aimed along -Z.
    pub fn new(emitter: Emitter, output: Output) -> Self {
        Light {
            id: LightId(0),
            name: "Light".to_owned(),
            role: Role::Key,
            position: Vec3::ZERO,
            aim: Aim::Point(Vec3::NEG_Z),
            roll_deg: 0.0,
            emitter,
            photometric_file: None,
            environment_map: None,
            modifier: Modifier::default(),
            head: None,
            power: Power { output, dial_stops: 0.0 },
            color: LightColor::default(),
            on: true,
            visible_to_camera: false,
            body: BodyChoice::AsStudio,
            muted: false,
            locked: false,
        }
    }

    /// Hides emitter and body from the camera. Mirrors and glass show them, and the body casts its shadow. A body that is
    /// off stays off.
    pub fn hide_from_camera(&mut self) {
        self.visible_to_camera = false;
        if self.body != BodyChoice::Off {
            self.body = BodyChoice::InReflections;
        }
    }

    /// Returns the dial of its head; tenths of a stop where the head is not known.
    pub fn dial(&self) -> HeadDial {
        self.head.as_ref().map_or(HeadDial::UNKNOWN, |head| head.dial)
    }
}

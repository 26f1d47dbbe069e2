//! The loss and the beam shape of a light modifier.
//!
//! The shape and size of the luminous surface is the [`super::Emitter`]; a modifier only takes light away. The
//! modifiers that are sold are pairs of both, in [`super::NamedModifier::ALL`].

/// A cone about the light's axis: transmits all light inside the inner angle, falling linearly in angle to 0 at the
/// outer one. Full (edge to edge) angles, degrees, up to 180.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Cone {
    /// Full angle of full transmission.
    pub inner_deg: f32,
    /// Full angle of zero transmission.
    pub outer_deg: f32,
}

/// Barn doors: the opening of each flap from the light's axis, degrees; 90 is fully open. Sides are seen from behind
/// the light, along its axis.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct BarnDoors {
    /// Left flap.
    pub left_deg: f32,
    /// Right flap.
    pub right_deg: f32,
    /// Upper flap.
    pub top_deg: f32,
    /// Lower flap.
    pub bottom_deg: f32,
}

impl BarnDoors {
    /// All four half open.
    pub const HALF_OPEN: BarnDoors = BarnDoors { left_deg: 30.0, right_deg: 30.0, top_deg: 30.0, bottom_deg: 30.0 };
}

/// The loss and the beam shape of a modifier.
#[derive(Clone, Copy, Debug, PartialEq, Default)]
pub struct Modifier {
    /// Loss in cloth, dish or umbrella, stops; independent of the unit of the light's power.
    pub loss_stops: f32,
    /// Loss in a scrim, net or frost, stops.
    pub scrim_stops: f32,
    /// Beam of a dish, a snoot or a reflector's rim; `None` for the emitter's own.
    pub beam: Option<Cone>,
    /// Honeycomb grid: full angle of zero transmission, degrees. Transmission is 1 on the axis and falls linearly in
    /// angle.
    pub grid_deg: Option<f32>,
    /// Barn doors.
    pub doors: Option<BarnDoors>,
}

impl Modifier {
    /// Returns a modifier with a loss alone.
    pub const fn loss(loss_stops: f32) -> Self {
        Modifier { loss_stops, scrim_stops: 0.0, beam: None, grid_deg: None, doors: None }
    }

    pub(super) const fn beam(self, inner_deg: f32, outer_deg: f32) -> Self {
        Modifier { beam: Some(Cone { inner_deg, outer_deg }), ..self }
    }

    pub(super) const fn grid(self, deg: f32) -> Self {
        Modifier { grid_deg: Some(deg), ..self }
    }

    pub(super) const fn doors(self, doors: BarnDoors) -> Self {
        Modifier { doors: Some(doors), ..self }
    }

    /// Returns true if it shapes the beam.
    pub fn narrows(&self) -> bool {
        self.beam.is_some() || self.grid_deg.is_some() || self.doors.is_some()
    }
}

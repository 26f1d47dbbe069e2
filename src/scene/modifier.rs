//! What sits before a light's source: how much light it swallows, and to which directions it lets the rest pass.
//!
//! The shape and size of what shines is the [`super::Emitter`]; a modifier takes from its light and never adds or moves any.
//! Named modifiers of the trade are pairs of both, in [`super::NamedModifier::ALL`].

/// A cone about the light's axis that passes everything inside the inner angle and falls linearly in angle to nothing
/// at the outer one. Full (edge to edge) angles, degrees, up to 180.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Cone {
    /// Full angle of what passes untouched.
    pub inner_deg: f32,
    /// Full angle where it ends.
    pub outer_deg: f32,
}

/// Four flaps, each opened so far from the light's axis, degrees; 90 is out of the way. Sides as seen from behind the
/// light, along its axis.
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

/// What a light loses before it leaves.
#[derive(Clone, Copy, Debug, PartialEq, Default)]
pub struct Modifier {
    /// Light swallowed by cloth, dish or umbrella, stops; whatever the light's power is stated in.
    pub loss_stops: f32,
    /// Scrim, net or frost before it, stops.
    pub scrim_stops: f32,
    /// The beam that a dish, a snoot or a reflector's rim leaves; none is all that the emitter gives.
    pub beam: Option<Cone>,
    /// A honeycomb: the full angle beyond which nothing passes, degrees. It passes everything on its axis, and falls
    /// linearly in angle.
    pub grid_deg: Option<f32>,
    /// Barn doors.
    pub doors: Option<BarnDoors>,
}

impl Modifier {
    /// No loss but this.
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

    /// Whether it keeps light from some directions.
    pub fn narrows(&self) -> bool {
        self.beam.is_some() || self.grid_deg.is_some() || self.doors.is_some()
    }
}

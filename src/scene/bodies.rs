//! The choice between bodies of lights, and lights that are luminous surfaces alone.

/// What is there of the bodies of lights.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Default)]
pub enum Bodies {
    /// They are there as on the set. The camera sees them with their luminous fronts.
    On,
    /// Mirrors and glass show them and they cast shadows; the camera does not see them.
    InReflections,
    /// Lights are luminous surfaces alone.
    #[default]
    Off,
}

impl Bodies {
    /// All values, in list order.
    pub const ALL: [Bodies; 3] = [Bodies::On, Bodies::InReflections, Bodies::Off];

    /// Returns the label in lists.
    pub fn label(self) -> &'static str {
        match self {
            Bodies::On => "On",
            Bodies::InReflections => "In reflections and shadows only",
            Bodies::Off => "Off",
        }
    }
}

/// What is there of the body of one light.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Default)]
pub enum BodyChoice {
    /// What the studio says for all.
    #[default]
    AsStudio,
    /// See [`Bodies::On`].
    On,
    /// See [`Bodies::InReflections`].
    InReflections,
    /// See [`Bodies::Off`].
    Off,
}

impl BodyChoice {
    /// All values, in list order.
    pub const ALL: [BodyChoice; 4] = [BodyChoice::AsStudio, BodyChoice::On, BodyChoice::InReflections, BodyChoice::Off];
}

impl From<Bodies> for BodyChoice {
    fn from(bodies: Bodies) -> Self {
        match bodies {
            Bodies::On => BodyChoice::On,
            Bodies::InReflections => BodyChoice::InReflections,
            Bodies::Off => BodyChoice::Off,
        }
    }
}

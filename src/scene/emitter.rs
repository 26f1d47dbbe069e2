//! The shape of a light's luminous surface.

/// The luminous surface of a light.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Emitter {
    /// A point with the same intensity in all directions.
    Point,
    /// A sphere with the same intensity in all directions: a bare bulb, a lantern.
    Sphere {
        /// Radius, metres.
        radius_m: f32,
    },
    /// A point with a cone: constant intensity inside the inner angle, falling linearly in angle to 0 at the outer one.
    /// Equal angles give a hard edge. Full (edge to edge) angles, degrees, up to 180.
    Spot {
        /// Full angle of constant intensity.
        inner_deg: f32,
        /// Full angle of zero intensity.
        outer_deg: f32,
    },
    /// A Lambertian rectangle that emits to the front: softbox, strip, window.
    RectPanel {
        /// Width, metres.
        width_m: f32,
        /// Height, metres.
        height_m: f32,
    },
    /// A Lambertian disc that emits to the front: octa, beauty dish with a sock.
    RoundPanel {
        /// Diameter, metres.
        diameter_m: f32,
    },
    /// Directional light from `position` towards the aim; the distance does not matter.
    Sun {
        /// Angular diameter, degrees; 0 gives hard shadows, the real sun has 0.53.
        angular_diameter_deg: f32,
    },
    /// Uniform radiance from all directions: an overcast sky, a white tent.
    Surround,
}

impl Emitter {
    /// Returns the label in lists.
    pub fn label(&self) -> &'static str {
        match self {
            Emitter::Point => "Point",
            Emitter::Sphere { .. } => "Bulb",
            Emitter::Spot { .. } => "Spot",
            Emitter::RectPanel { .. } => "Rectangular panel",
            Emitter::RoundPanel { .. } => "Round panel",
            Emitter::Sun { .. } => "Sun",
            Emitter::Surround => "Surround",
        }
    }

    /// Returns true for sun and surround, which are at infinity and stated in lux.
    pub fn is_infinite(&self) -> bool {
        matches!(self, Emitter::Sun { .. } | Emitter::Surround)
    }
}

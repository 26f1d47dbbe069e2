//! The shape of a light's luminous surface.

/// Geometry of what shines.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Emitter {
    /// A point that shines evenly all round.
    Point,
    /// A bare bulb or lantern with a size, shining evenly all round.
    Sphere {
        /// Radius, metres.
        radius_m: f32,
    },
    /// A projector: even inside the inner cone, falling linearly in angle to nothing at the outer cone.
    /// Equal angles are a hard edge. Full (edge to edge) angles, degrees, up to 180.
    Spot {
        /// Full angle of the even part.
        inner_deg: f32,
        /// Full angle where the light ends.
        outer_deg: f32,
    },
    /// A Lambertian rectangle that shines forward only: softbox, strip, window.
    RectPanel {
        /// Width, metres.
        width_m: f32,
        /// Height, metres.
        height_m: f32,
    },
    /// A Lambertian disc that shines forward only: octa, beauty dish with a sock.
    RoundPanel {
        /// Diameter, metres.
        diameter_m: f32,
    },
    /// Parallel light from `position` towards the aim; position and distance do not matter.
    Sun {
        /// Angular diameter, degrees; 0 gives hard shadows, the real sun has 0.53.
        angular_diameter_deg: f32,
    },
    /// Even light from everywhere around: an overcast sky, a white tent.
    Surround,
}

impl Emitter {
    /// Label in lists.
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

    /// Sun and surround have no place: they are stated in lux and shine from infinity.
    pub fn is_infinite(&self) -> bool {
        matches!(self, Emitter::Sun { .. } | Emitter::Surround)
    }
}

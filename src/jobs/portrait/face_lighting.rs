//! The lighting of a face, and its description in words.

use crate::photo::portrait_pattern::{FaceSide, FoundPattern};
use std::fmt;

/// The side of a turned face on which the light is.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Modelling {
    /// The side that is turned to the camera is lit.
    Broad,
    /// The side that is turned from the camera is lit.
    Short,
}

/// The key light as seen from a face.
#[derive(Clone, Debug, PartialEq)]
pub struct KeyPlace {
    /// Name of the light.
    pub name: String,
    /// Angle from the direction of the face to the person's own left, degrees.
    pub left_deg: f32,
    /// Angle above the eyes, degrees.
    pub above_deg: f32,
}

/// The lighting of a face.
#[derive(Clone, Debug, PartialEq)]
pub enum FaceLighting {
    /// Hair or something else covers the face, or it is hidden.
    Covered,
    /// Neither lamp nor sun shines on the face directly.
    Unlit,
    /// No light gives half of the direct light.
    NoKey,
    /// A key light shapes the face.
    Key {
        /// The pattern; none where the shadows are none of the patterns.
        found: Option<FoundPattern>,
        /// Short or broad, of a pattern with a dark side on a face that is turned from the camera.
        modelling: Option<Modelling>,
        /// The key light.
        key: KeyPlace,
    },
}

/// Angle between camera and face under which a face is not turned: neither side is turned to the camera, degrees.
const FRONTAL_DEG: f32 = 10.0;

impl Modelling {
    /// Returns the modelling of a pattern on a face that sees the camera at an angle to its own left, degrees.
    pub fn of(found: FoundPattern, camera_left_deg: f32) -> Option<Self> {
        let lit_side = found.lit_side.filter(|_| found.pattern.has_shadow_side())?;
        let is_turned = (FRONTAL_DEG..=90.0).contains(&camera_left_deg.abs());
        let is_broad = lit_side == FaceSide::of(camera_left_deg);
        is_turned.then_some(if is_broad { Modelling::Broad } else { Modelling::Short })
    }

    fn label(self) -> &'static str {
        match self {
            Modelling::Broad => "broad",
            Modelling::Short => "short",
        }
    }
}

impl fmt::Display for FaceLighting {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            FaceLighting::Covered => write!(f, "no pattern: the face is covered"),
            FaceLighting::Unlit => write!(f, "no pattern: neither lamp nor sun shines on the face directly"),
            FaceLighting::NoKey => write!(f, "no pattern: no light gives half of the direct light on the face"),
            FaceLighting::Key { found, modelling, key } => {
                match found {
                    Some(found) => write!(f, "{} lighting", found.pattern.label())?,
                    None => write!(f, "no pattern")?,
                }
                if let Some(modelling) = modelling {
                    write!(f, ", {}", modelling.label())?;
                }
                write!(f, "; key {key}")
            }
        }
    }
}

impl fmt::Display for KeyPlace {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let KeyPlace { name, left_deg, above_deg } = self;
        let degrees = |angle: f32| angle.abs().round() as i32;
        write!(f, "\u{201c}{name}\u{201d} ")?;
        match (degrees(*left_deg), *left_deg > 0.0) {
            (0, _) => write!(f, "straight ahead")?,
            (angle, true) => write!(f, "{angle}\u{b0} to the person's left")?,
            (angle, false) => write!(f, "{angle}\u{b0} to the person's right")?,
        }
        match (degrees(*above_deg), *above_deg > 0.0) {
            (0, _) => write!(f, ", level with the eyes"),
            (angle, true) => write!(f, ", {angle}\u{b0} above the eyes"),
            (angle, false) => write!(f, ", {angle}\u{b0} below the eyes"),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::photo::portrait_pattern::PortraitPattern;

    fn found(pattern: PortraitPattern) -> FoundPattern {
        FoundPattern { pattern, lit_side: Some(FaceSide::Left) }
    }

    #[test]
    fn light_on_the_side_that_is_turned_to_the_camera_is_broad() {
        let of = |degrees| Modelling::of(found(PortraitPattern::Loop), degrees);
        assert_eq!([of(30.0), of(-30.0)], [Some(Modelling::Broad), Some(Modelling::Short)]);
        assert_eq!([of(5.0), of(-5.0), of(120.0), of(f32::NAN)], [None; 4], "not turned, or turned away");
        assert_eq!(Modelling::of(found(PortraitPattern::Butterfly), 30.0), None);
    }

    #[test]
    fn a_line_names_pattern_modelling_and_angles() {
        let place = |left_deg, above_deg| KeyPlace { name: "Dish".to_owned(), left_deg, above_deg };
        let loop_light = FaceLighting::Key {
            found: Some(found(PortraitPattern::Loop)),
            modelling: Some(Modelling::Broad),
            key: place(39.6, 35.2),
        };
        let expected =
            "loop lighting, broad; key \u{201c}Dish\u{201d} 40\u{b0} to the person's left, 35\u{b0} above the eyes";
        assert_eq!(loop_light.to_string(), expected);
        let none = FaceLighting::Key { found: None, modelling: None, key: place(-120.0, -8.0) };
        let expected = "no pattern; key \u{201c}Dish\u{201d} 120\u{b0} to the person's right, 8\u{b0} below the eyes";
        assert_eq!(none.to_string(), expected);
        assert_eq!(place(-0.2, 0.1).to_string(), "\u{201c}Dish\u{201d} straight ahead, level with the eyes");
    }
}

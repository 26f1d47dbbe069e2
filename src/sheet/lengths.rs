//! Lengths as text, in metres or in feet and inches.

use crate::photo::meter::FOOT_M;

/// Metres in an inch.
const INCH_M: f32 = 0.0254;

/// Distance under which centimetres and inches have a decimal, metres: close-ups.
const NEAR_M: f32 = 0.5;

/// The units of lengths on a sheet.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Units {
    /// Metres, and centimetres for sizes of things.
    #[default]
    Metres,
    /// Feet and inches.
    Feet,
}

impl Units {
    /// Formats a distance or a height: `1.40 m`, `4' 7"`.
    pub fn distance(self, metres: f32) -> String {
        match self {
            Units::Metres if metres.abs() < NEAR_M => format!("{:.1} cm", metres * 100.0).replace('-', "\u{2212}"),
            Units::Metres => format!("{metres:.2} m").replace('-', "\u{2212}"),
            Units::Feet if metres.abs() < NEAR_M => format!("{:.1}\"", metres / INCH_M).replace('-', "\u{2212}"),
            Units::Feet => {
                let inches = (metres / INCH_M).round();
                let (feet, rest) = ((inches.abs() / 12.0).floor(), inches.abs() % 12.0);
                let sign = if inches < 0.0 { "\u{2212}" } else { "" };
                format!("{sign}{feet:.0}' {rest:.0}\"")
            }
        }
    }

    /// Formats the size of a thing by its edges or its diameter: `60 x 90 cm`, `24 x 35"`.
    pub fn size(self, edges_m: &[f32]) -> String {
        let (unit_m, unit) = match self {
            Units::Metres => (0.01, " cm"),
            Units::Feet => (INCH_M, "\""),
        };
        let edges: Vec<String> = edges_m.iter().map(|edge| format!("{:.0}", edge / unit_m)).collect();
        format!("{}{unit}", edges.join(" x "))
    }

    /// Returns the length of the unit of the ruler, metres, and its symbol.
    pub fn ruler(self) -> (f32, &'static str) {
        match self {
            Units::Metres => (1.0, "m"),
            Units::Feet => (FOOT_M, "ft"),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn lengths_read_as_on_a_tape_measure() {
        assert_eq!([1.4, 0.057, -0.2].map(|m| Units::Metres.distance(m)), ["1.40 m", "5.7 cm", "\u{2212}20.0 cm"]);
        assert_eq!(
            [1.4, 1.8288, 0.508, 0.3].map(|m| Units::Feet.distance(m)),
            ["4' 7\"", "6' 0\"", "1' 8\"", "11.8\""]
        );
        assert_eq!(Units::Metres.size(&[0.6, 0.9]), "60 x 90 cm");
        assert_eq!(Units::Feet.size(&[0.6, 0.9]), "24 x 35\"");
    }
}

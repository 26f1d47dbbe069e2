//! Gels: colour filters of lights, with the names of the swatch book.

/// The gel of a light. Its colour is scaled to luminance 1; [`Gel::loss_stops`] returns the loss of the real filter, which
/// counts where [`super::LightColor::gel_loss_counts`] says so.
#[derive(Clone, Copy, Debug, PartialEq, Default)]
pub enum Gel {
    /// No gel.
    #[default]
    None,
    /// Shift in mired (1e6 / K): positive warms (CTO), negative cools (CTB).
    Mired(f32),
    /// Plus and minus green, and party colours: linear RGB transmittance.
    Tint([f32; 3]),
}

/// The purpose of a group of gels.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum GelFamily {
    /// CTO and CTB.
    Temperature,
    /// Plus and minus green: corrects fluorescent tubes.
    Green,
    /// Effects.
    Party,
}

/// A gel of the swatch book.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct NamedGel {
    /// Its name.
    pub name: &'static str,
    /// Section of the swatch book.
    pub family: GelFamily,
    /// Its colour.
    pub gel: Gel,
}

const fn mired(name: &'static str, shift: f32) -> NamedGel {
    NamedGel { name, family: GelFamily::Temperature, gel: Gel::Mired(shift) }
}

const fn green(name: &'static str, tint: [f32; 3]) -> NamedGel {
    NamedGel { name, family: GelFamily::Green, gel: Gel::Tint(tint) }
}

const fn party(name: &'static str, tint: [f32; 3]) -> NamedGel {
    NamedGel { name, family: GelFamily::Party, gel: Gel::Tint(tint) }
}

/// Loss of the standard conversion gels by mired shift, stops, as makers print it on the swatch.
const CONVERSION_LOSS: [(f32, f32); 9] = [
    (-137.0, 1.56),
    (-78.0, 0.87),
    (-35.0, 0.53),
    (-18.0, 0.30),
    (0.0, 0.0),
    (26.0, 0.23),
    (64.0, 0.34),
    (109.0, 0.50),
    (159.0, 0.85),
];

impl Gel {
    /// The swatch book. Green correction is stated as colour-compensating densities in makers' data: full is CC30, that
    /// is 10^-0.3 in the channels it takes from; a half CC15, a quarter CC075, an eighth CC035.
    pub const NAMED: [NamedGel; 26] = [
        mired("1/8 CTO", 26.0),
        mired("1/4 CTO", 64.0),
        mired("1/2 CTO", 109.0),
        mired("Full CTO", 159.0),
        mired("1/8 CTB", -18.0),
        mired("1/4 CTB", -35.0),
        mired("1/2 CTB", -78.0),
        mired("Full CTB", -137.0),
        green("1/8 Plus green", [0.923, 1.0, 0.923]),
        green("1/4 Plus green", [0.841, 1.0, 0.841]),
        green("1/2 Plus green", [0.708, 1.0, 0.708]),
        green("Full Plus green", [0.501, 1.0, 0.501]),
        green("1/8 Minus green", [1.0, 0.923, 1.0]),
        green("1/4 Minus green", [1.0, 0.841, 1.0]),
        green("1/2 Minus green", [1.0, 0.708, 1.0]),
        green("Full Minus green", [1.0, 0.501, 1.0]),
        party("Red", [0.85, 0.03, 0.02]),
        party("Orange", [0.9, 0.28, 0.02]),
        party("Yellow", [0.92, 0.75, 0.03]),
        party("Green", [0.05, 0.55, 0.08]),
        party("Teal", [0.03, 0.5, 0.42]),
        party("Cyan", [0.1, 0.6, 0.85]),
        party("Blue", [0.02, 0.08, 0.75]),
        party("Lavender", [0.5, 0.35, 0.9]),
        party("Magenta", [0.8, 0.06, 0.55]),
        party("Pink", [0.95, 0.45, 0.65]),
    ];

    /// Returns its name, if it is in the swatch book.
    pub fn name(&self) -> Option<&'static str> {
        const NAMED: &[NamedGel] = &Gel::NAMED;
        NAMED.iter().find(|named| named.gel == *self).map(|named| named.name)
    }

    /// Returns the loss of the real filter in white light, stops; interpolated linearly between the standard gels.
    pub fn loss_stops(&self) -> f32 {
        match *self {
            Gel::None => 0.0,
            Gel::Mired(shift) => conversion_loss(shift),
            Gel::Tint([r, g, b]) => -(0.2126 * r + 0.7152 * g + 0.0722 * b).max(1e-6).log2(),
        }
    }
}

fn conversion_loss(shift: f32) -> f32 {
    let (first, last) = (CONVERSION_LOSS[0], CONVERSION_LOSS[CONVERSION_LOSS.len() - 1]);
    let shift = shift.clamp(first.0, last.0);
    let pair = CONVERSION_LOSS.windows(2).find(|pair| shift <= pair[1].0);
    pair.map_or(last.1, |pair| {
        let [(from, low), (to, high)] = [pair[0], pair[1]];
        low + (high - low) * (shift - from) / (to - from)
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn gel_losses_agree_with_the_swatch_book() {
        assert_eq!(Gel::None.loss_stops(), 0.0);
        assert!((Gel::Mired(159.0).loss_stops() - 0.85).abs() < 1e-6);
        assert!((Gel::Mired(-137.0).loss_stops() - 1.56).abs() < 1e-6);
        assert!((Gel::Mired(86.5).loss_stops() - 0.42).abs() < 1e-3);
        assert_eq!(Gel::Mired(1e9).loss_stops(), 0.85);
        // CC30 magenta halves green, which is 72 % of white.
        assert!((Gel::Tint([1.0, 0.501, 1.0]).loss_stops() - 0.636).abs() < 0.01);
    }

    #[test]
    fn names_and_colours_of_the_swatch_book_are_unique() {
        for (i, named) in Gel::NAMED.iter().enumerate() {
            assert_eq!(named.gel.name(), Some(named.name));
            assert!(named.gel.loss_stops() > 0.0, "{}", named.name);
            assert!(Gel::NAMED[..i].iter().all(|other| other.name != named.name && other.gel != named.gel));
        }
    }
}

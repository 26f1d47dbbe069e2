//! Lengths in the window's read-outs, in metres or in feet. egui's memory keeps the units beside its style.

use crate::sheet::Units;
use eframe::egui::{Context, Id};

/// Sets the units of the window.
pub fn set_units(ctx: &Context, units: Units) {
    ctx.data_mut(|data| data.insert_temp(Id::unique("units of lengths"), units));
}

/// Returns the units of the window.
pub fn units(ctx: &Context) -> Units {
    ctx.data(|data| data.get_temp(Id::unique("units of lengths"))).unwrap_or_default()
}

/// Formats a length, to the centimetre or the inch: `1.40 m`, `4' 7"`.
pub fn text(units: Units, metres: f32) -> String {
    match units {
        Units::Metres => format!("{metres:.2} m"),
        Units::Feet => units.distance(metres),
    }
}

/// Formats a length in the units of the window.
pub fn shown(ctx: &Context, metres: f32) -> String {
    text(units(ctx), metres)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_window_shows_metres_until_it_is_set_to_feet() {
        let ctx = Context::default();
        assert_eq!(shown(&ctx, 1.4), "1.40 m");
        set_units(&ctx, Units::Feet);
        assert_eq!([shown(&ctx, 1.4), shown(&ctx, -1.4)], ["4' 7\"", "\u{2212}4' 7\""]);
    }
}

//! Names of neutral density filters: stops, filter factor and optical density.
//!
//! A filter of n stops passes 2^-n of the light. Its factor is 2^n (ND8: 3 stops), its density log10(2^n) = 0.301 n
//! (0.9: 3 stops).

/// Factors of the filters of 9 and 10 stops as makers print them; exactly they are 512 and 1024.
const ROUNDED_FACTORS: [(f32, u32); 2] = [(9.0, 500), (10.0, 1000)];

/// Returns factor and density as they are printed on a filter: `ND8, 0.9`; `none` for 0 stops.
pub fn name(stops: f32) -> String {
    if stops == 0.0 {
        return "none".to_owned();
    }
    let density = stops * std::f32::consts::LOG10_2;
    let factor = stops.exp2();
    match ROUNDED_FACTORS.iter().find(|(whole, _)| *whole == stops) {
        Some((_, printed)) => format!("ND{printed}, {density:.1}"),
        None if factor < 9.95 => format!("ND{}, {density:.1}", (10.0 * factor).round() / 10.0),
        None => format!("ND{factor:.0}, {density:.1}"),
    }
}

/// Returns stops and name of a filter: `3 stops (ND8, 0.9)`; `none` for 0 stops.
pub fn label(stops: f32) -> String {
    if stops == 0.0 { name(stops) } else { format!("{} ({})", stops_label(stops), name(stops)) }
}

/// Formats stops in thirds, `3\u{2153} stops`, or in hundredths where they are none.
pub fn stops_label(stops: f32) -> String {
    let thirds = (3.0 * stops).round();
    let unit = if stops <= 1.0 { "stop" } else { "stops" };
    if (thirds - 3.0 * stops).abs() > 0.03 {
        return format!("{} {unit}", (100.0 * stops).round() / 100.0);
    }
    let whole = (thirds / 3.0).floor();
    let fraction = ["", "\u{2153}", "\u{2154}"][(thirds - 3.0 * whole).clamp(0.0, 2.0) as usize];
    if whole == 0.0 && !fraction.is_empty() {
        format!("{fraction} {unit}")
    } else {
        format!("{whole}{fraction} {unit}")
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn filters_have_the_names_that_makers_print() {
        for (stops, printed) in [
            (1.0, "1 stop (ND2, 0.3)"),
            (2.0, "2 stops (ND4, 0.6)"),
            (3.0, "3 stops (ND8, 0.9)"),
            (6.0, "6 stops (ND64, 1.8)"),
            (9.0, "9 stops (ND500, 2.7)"),
            (10.0, "10 stops (ND1000, 3.0)"),
            (0.0, "none"),
        ] {
            assert_eq!(label(stops), printed);
        }
    }

    #[test]
    fn thirds_and_any_other_number_of_stops_have_names() {
        assert_eq!(label(1.0 / 3.0), "\u{2153} stop (ND1.3, 0.1)");
        assert_eq!(label(0.333), "\u{2153} stop (ND1.3, 0.1)");
        assert_eq!(label(10.0 / 3.0), "3\u{2153} stops (ND10, 1.0)");
        assert_eq!(label(5.0 / 3.0), "1\u{2154} stops (ND3.2, 0.5)");
        assert_eq!(label(6.6), "6.6 stops (ND97, 2.0)");
        assert_eq!(label(f32::NAN), "NaN stops (NDNaN, NaN)");
    }
}

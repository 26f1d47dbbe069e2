//! Numbers as they are typed into a field: with its unit, with another unit of the same kind, or with none.

/// Lengths in metres.
const LENGTHS: [(&str, f64); 8] = [
    ("mm", 0.001),
    ("cm", 0.01),
    ("m", 1.0),
    ("in", 0.0254),
    ("\"", 0.0254),
    ("ft", 0.3048),
    ("\u{2032}", 0.3048),
    ("'", 0.3048),
];

/// The number that a text means in a field that shows numbers in `unit`. A comma is a point. None where it means nothing
/// there: letters, or metres for an angle.
pub fn parse(text: &str, unit: &str) -> Option<f64> {
    let text = text.trim().replace('\u{2212}', "-").replace(',', ".");
    let end = text.rfind(|c: char| c.is_ascii_digit() || c == '.').map_or(0, |last| last + 1);
    let (number, typed) = text.split_at(end);
    let (number, typed, unit) = (number.trim().parse::<f64>().ok()?, typed.trim(), unit.trim());
    let metres = |unit: &str| LENGTHS.iter().find(|(name, _)| *name == unit).map(|(_, metres)| *metres);
    match (typed, metres(typed), metres(unit)) {
        ("", ..) => Some(number),
        (_, Some(from), Some(to)) => Some(number * from / to),
        (typed, ..) if typed == unit || (typed == "deg" && unit == "\u{b0}") => Some(number),
        _ => None,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn lengths_are_taken_in_any_unit() {
        let close = |text, unit, expected: f64| {
            let parsed = parse(text, unit).unwrap_or(f64::NAN);
            assert!((parsed - expected).abs() < 1e-9, "{text} in {unit}: {parsed}");
        };
        close("1.5", " m", 1.5);
        close("150 cm", " m", 1.5);
        close("1,5m", " cm", 150.0);
        close("5 ft", " m", 1.524);
        close("12\"", " cm", 30.48);
        close("\u{2212}15 deg", "\u{b0}", -15.0);
        close("-15\u{b0}", "\u{b0}", -15.0);
        close("400 Ws", " Ws", 400.0);
        close("1e3 lm", " lm", 1000.0);
    }

    #[test]
    fn what_means_nothing_changes_nothing() {
        for (text, unit) in [("", " m"), ("m", " m"), ("3 m", "\u{b0}"), ("3 K", " m"), ("1.2.3", ""), ("abc", "")] {
            assert_eq!(parse(text, unit), None, "{text} in {unit}");
        }
    }
}

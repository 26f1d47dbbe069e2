//! Parses typed numbers with units and formats durations.

use std::time::Duration;

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

/// Parses the text of a field in `unit`; a decimal comma is allowed. Returns none for letters and incompatible units.
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

/// Formats a duration: `12 s`, `3 min 05 s`, `2 h 10 min`.
pub fn duration_text(duration: Duration) -> String {
    let seconds = duration.as_secs_f64();
    match seconds {
        s if s < 10.0 => format!("{s:.1} s"),
        s if s < 60.0 => format!("{s:.0} s"),
        s if s < 3600.0 => format!("{} min {:02} s", s as u64 / 60, s as u64 % 60),
        s => format!("{} h {:02} min", s as u64 / 3600, s as u64 / 60 % 60),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn durations_read_well() {
        let text = |s| duration_text(Duration::from_secs_f64(s));
        assert_eq!([text(2.34), text(42.0), text(185.0), text(7800.0)], ["2.3 s", "42 s", "3 min 05 s", "2 h 10 min"]);
    }

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
    fn invalid_text_has_no_value() {
        for (text, unit) in [("", " m"), ("m", " m"), ("3 m", "\u{b0}"), ("3 K", " m"), ("1.2.3", ""), ("abc", "")] {
            assert_eq!(parse(text, unit), None, "{text} in {unit}");
        }
    }
}

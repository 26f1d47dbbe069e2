//! Numbers as text: stops and quantities.

/// Formats stops with their sign: `+0.3`, `-2.0`, `0.0`.
pub fn signed_stops(stops: f32) -> String {
    let rounded = (stops * 10.0).round() / 10.0;
    if rounded == 0.0 { "0.0".to_owned() } else { format!("{rounded:+.1}").replace('-', "\u{2212}") }
}

/// Formats stops with their sign to a hundredth: `+0.04`, `-1.25`, `0.00`.
pub fn signed_hundredths(stops: f32) -> String {
    let rounded = (stops * 100.0).round() / 100.0;
    if rounded == 0.0 { "0.00".to_owned() } else { format!("{rounded:+.2}").replace('-', "\u{2212}") }
}

/// Formats a quantity with at most two decimals: three significant digits from 1 to 999.
pub fn three_digits(value: f32) -> String {
    match value.abs() {
        v if !v.is_finite() => "\u{2013}".to_owned(),
        v if v >= 100.0 => format!("{value:.0}"),
        v if v >= 10.0 => format!("{value:.1}"),
        _ => format!("{value:.2}"),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn stops_and_numbers_read_well() {
        assert_eq!(signed_stops(-2.04), "\u{2212}2.0");
        assert_eq!(signed_stops(0.31), "+0.3");
        assert_eq!(signed_stops(-0.01), "0.0");
        assert_eq!([-1.254, 0.04, -0.001].map(signed_hundredths), ["\u{2212}1.25", "+0.04", "0.00"]);
        assert_eq!([1234.4, 45.678, 1.234].map(three_digits), ["1234", "45.7", "1.23"]);
    }
}

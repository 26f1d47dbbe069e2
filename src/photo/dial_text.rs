//! The display of a head's dial as text, and back.

use super::text::{signed_stops, three_digits};
use crate::scene::{DialScale, HeadDial, Light};

/// Settings a stop of a dial in thirds.
const THIRDS: u8 = 3;

/// Formats a setting as the head displays it: `1/4 +0.3`, `7.3`, `100 Ws`, `25 %`.
pub fn dial_text(dial: &HeadDial, stops: f32) -> String {
    match dial.scale {
        DialScale::Fractions => fraction_text(dial, stops),
        DialScale::Number { full } => format!("{:.1}", full + stops).replace('-', "\u{2212}"),
        DialScale::WattSeconds { full } => format!("{} Ws", three_digits(full * stops.exp2())),
        DialScale::PerCent => {
            let per_cent = 100.0 * stops.exp2();
            if per_cent < 9.95 && (per_cent - per_cent.round()).abs() > 0.05 {
                format!("{per_cent:.1} %")
            } else {
                format!("{per_cent:.0} %")
            }
        }
    }
}

/// Formats a setting of a light's dial as its head displays it. Where the head is not known, as most do: a flash in
/// fractions and tenths of a stop, a lamp in per cent.
pub fn light_dial_text(light: &Light, stops: f32) -> String {
    let scale = if light.power.output.is_flash() { DialScale::Fractions } else { DialScale::PerCent };
    let usual = HeadDial { scale, ..HeadDial::UNKNOWN };
    dial_text(light.head.as_ref().map_or(&usual, |head| &head.dial), stops)
}

/// Formats the duration of a flash: `1/500 s`.
pub fn flash_time_text(time_s: f32) -> String {
    format!("1/{:.0} s", 1.0 / time_s.max(1e-9))
}

/// Formats a power as a fraction and the stops over it: `1/4 +0.3`.
fn fraction_text(dial: &HeadDial, stops: f32) -> String {
    // To a tenth, so that 1/4 +1.0 is 1/2
    let tenths = (10.0 * stops).round();
    let whole = (tenths / 10.0).floor();
    let over = tenths / 10.0 - whole;
    let fraction = if whole <= 0.0 { format!("1/{}", (-whole).exp2()) } else { format!("{}/1", whole.exp2()) };
    match over {
        over if over < 0.05 => fraction,
        over if dial.steps_per_stop == THIRDS && over < 0.5 => format!("{fraction} +\u{2153}"),
        _ if dial.steps_per_stop == THIRDS => format!("{fraction} +\u{2154}"),
        over => format!("{fraction} {}", signed_stops(over)),
    }
}

/// Returns the stops from full power of a setting as a user types it; none if it is no setting. A dial in fractions takes
/// `1/4`, `1/4 +0.3` and stops, such as `-2.3`; the others take a number in their unit.
pub fn dial_from_text(dial: &HeadDial, text: &str) -> Option<f32> {
    let text = text.replace('\u{2212}', "-").replace('\u{2153}', "0.33").replace('\u{2154}', "0.67").replace(',', ".");
    let text = text.trim();
    let number = |text: &str| text.trim().trim_end_matches(['%', 'W', 's']).trim().parse::<f32>().ok();
    let stops = match dial.scale {
        DialScale::Fractions => match text.split_once('/') {
            None => number(text)?,
            Some((above, below)) => {
                let (below, over) = match below.find(['+', '-']) {
                    Some(sign) => (&below[..sign], number(&below[sign..])?),
                    None => (below, 0.0),
                };
                (number(above)? / number(below)?).log2() + over
            }
        },
        DialScale::Number { full } => number(text)? - full,
        DialScale::WattSeconds { full } => (number(text)? / full).log2(),
        DialScale::PerCent => (number(text)? / 100.0).log2(),
    };
    stops.is_finite().then_some(stops)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scene::{Emitter, Output};

    fn dial(scale: DialScale, steps_per_stop: u8) -> HeadDial {
        HeadDial { scale, lowest_stops: -8.0, steps_per_stop }
    }

    #[test]
    fn settings_read_as_on_the_head() {
        let fractions = dial(DialScale::Fractions, 10);
        assert_eq!([0.0, -2.0, -1.7, -8.0].map(|s| dial_text(&fractions, s)), ["1/1", "1/4", "1/4 +0.3", "1/256"]);
        assert_eq!([-1.04, -0.96, 1.0].map(|s| dial_text(&fractions, s)), ["1/2", "1/2", "2/1"]);
        let thirds = dial(DialScale::Fractions, 3);
        assert_eq!([-5.0 / 3.0, -4.0 / 3.0].map(|s| dial_text(&thirds, s)), ["1/4 +\u{2153}", "1/4 +\u{2154}"]);
        let numbers = dial(DialScale::Number { full: 10.0 }, 10);
        assert_eq!([0.0, -2.7, -8.0].map(|s| dial_text(&numbers, s)), ["10.0", "7.3", "2.0"]);
        assert_eq!(dial_text(&dial(DialScale::WattSeconds { full: 400.0 }, 10), -2.0), "100 Ws");
        let led = dial(DialScale::PerCent, 1);
        assert_eq!([0.0, -2.0, -6.0].map(|s| dial_text(&led, s)), ["100 %", "25 %", "1.6 %"]);
    }

    #[test]
    fn a_flash_of_no_known_head_reads_in_fractions_and_a_lamp_in_per_cent() {
        let flash = Output::FlashWs { energy_ws: 400.0, efficacy_lm_s_per_ws: 40.0 };
        let [flash, lamp] = [flash, Output::Lumens(800.0)].map(|output| Light::new(Emitter::Point, output));
        assert_eq!(
            [0.0, -2.0, -2.8, -5.9].map(|s| light_dial_text(&flash, s)),
            ["1/1", "1/4", "1/8 +0.2", "1/64 +0.1"]
        );
        assert_eq!([0.0, -1.0, -5.9].map(|s| light_dial_text(&lamp, s)), ["100 %", "50 %", "1.7 %"]);
    }

    #[test]
    fn what_is_displayed_can_be_typed() {
        for scale in [
            DialScale::Fractions,
            DialScale::Number { full: 10.0 },
            DialScale::WattSeconds { full: 600.0 },
            DialScale::PerCent,
        ] {
            let dial = dial(scale, 10);
            for stops in [0.0, -1.0, -2.3, -6.0] {
                let text = dial_text(&dial, stops);
                let read = dial_from_text(&dial, &text).unwrap();
                assert!((read - stops).abs() < 0.06, "{text} is {read}, not {stops}");
            }
            assert_eq!(dial_from_text(&dial, "full"), None);
            assert_eq!(dial_from_text(&dial, "1/0"), None);
        }
        assert_eq!(dial_from_text(&dial(DialScale::Fractions, 3), "1/4 +\u{2153}"), Some(-2.0 + 0.33));
        assert_eq!(dial_from_text(&dial(DialScale::Fractions, 10), "\u{2212}2.5"), Some(-2.5));
    }
}

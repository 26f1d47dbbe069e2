//! The third-stop scales of f-number, shutter and ISO: exact values for arithmetic, nominal labels for display.
//!
//! A value of a scale is a whole number of thirds `k`: f-number 2^(k/6), shutter 2^(-k/3) s, ISO 100 x 2^(k/3).
//! Nominal labels are rounded (ISO 2720, annex): f/5.6 is exactly 5.657, 1/125 s exactly 1/128.

/// Nominal labels f/1 to f/32, from k = 0.
const F_NUMBERS: [&str; 31] = [
    "1", "1.1", "1.2", "1.4", "1.6", "1.8", "2", "2.2", "2.5", "2.8", "3.2", "3.5", "4", "4.5", "5", "5.6", "6.3",
    "7.1", "8", "9", "10", "11", "13", "14", "16", "18", "20", "22", "25", "29", "32",
];
/// Nominal labels 30 s to 1/8000 s, from k = -15.
const SHUTTERS: [&str; 55] = [
    "30 s", "25 s", "20 s", "15 s", "13 s", "10 s", "8 s", "6 s", "5 s", "4 s", "3.2 s", "2.5 s", "2 s", "1.6 s",
    "1.3 s", "1 s", "0.8 s", "0.6 s", "0.5 s", "0.4 s", "0.3 s", "1/4", "1/5", "1/6", "1/8", "1/10", "1/13", "1/15",
    "1/20", "1/25", "1/30", "1/40", "1/50", "1/60", "1/80", "1/100", "1/125", "1/160", "1/200", "1/250", "1/320",
    "1/400", "1/500", "1/640", "1/800", "1/1000", "1/1250", "1/1600", "1/2000", "1/2500", "1/3200", "1/4000", "1/5000",
    "1/6400", "1/8000",
];
/// Nominal labels ISO 50 to 25600, from k = -3.
const ISOS: [&str; 28] = [
    "50", "64", "80", "100", "125", "160", "200", "250", "320", "400", "500", "640", "800", "1000", "1250", "1600",
    "2000", "2500", "3200", "4000", "5000", "6400", "8000", "10000", "12800", "16000", "20000", "25600",
];

/// A dial of the camera's exposure.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Dial {
    /// Aperture, f-number.
    FNumber,
    /// Exposure time, seconds.
    Shutter,
    /// ISO speed.
    Iso,
}

impl Dial {
    /// Returns the range of the scale, whole thirds.
    pub fn range(self) -> std::ops::RangeInclusive<i32> {
        let (first, labels) = self.table();
        first..=first + labels.len() as i32 - 1
    }

    fn table(self) -> (i32, &'static [&'static str]) {
        match self {
            Dial::FNumber => (0, &F_NUMBERS),
            Dial::Shutter => (-15, &SHUTTERS),
            Dial::Iso => (-3, &ISOS),
        }
    }

    /// Returns the exact value `thirds` of a stop from f/1, 1 s or ISO 100. More thirds are a smaller aperture, a
    /// shorter time, a higher speed.
    pub fn value(self, thirds: i32) -> f32 {
        let stops = f64::from(thirds) / 3.0;
        match self {
            Dial::FNumber => (0.5 * stops).exp2() as f32,
            Dial::Shutter => (-stops).exp2() as f32,
            Dial::Iso => (100.0 * stops.exp2()) as f32,
        }
    }

    /// Returns the thirds of a stop of any value, not rounded.
    pub fn thirds(self, value: f32) -> f32 {
        let value = value.max(f32::MIN_POSITIVE);
        match self {
            Dial::FNumber => 6.0 * value.log2(),
            Dial::Shutter => -3.0 * value.log2(),
            Dial::Iso => 3.0 * (value / 100.0).log2(),
        }
    }

    /// Returns the nominal label of a whole number of thirds; none outside the scale.
    pub fn nominal_label(self, thirds: i32) -> Option<&'static str> {
        let (first, labels) = self.table();
        usize::try_from(thirds - first).ok().and_then(|i| labels.get(i)).copied()
    }

    /// Formats a value: the nominal label within a twentieth of a stop, otherwise the number itself.
    pub fn label(self, value: f32) -> String {
        let thirds = self.thirds(value);
        let nearest = thirds.round();
        let nominal = ((thirds - nearest).abs() < 0.15).then(|| self.nominal_label(nearest as i32)).flatten();
        match (self, nominal) {
            (Dial::FNumber, Some(text)) => format!("f/{text}"),
            // Nominal values of files, such as 11 and 22, lie between the exact ones
            (Dial::FNumber, None) if value >= 10.0 && (value - value.round()).abs() < 0.05 => format!("f/{value:.0}"),
            (Dial::FNumber, None) => format!("f/{value:.1}"),
            (Dial::Iso, Some(text)) => text.to_owned(),
            (Dial::Iso, None) => format!("{value:.0}"),
            (Dial::Shutter, Some(text)) => text.to_owned(),
            (Dial::Shutter, None) if value < 0.3 => format!("1/{:.0}", 1.0 / value),
            (Dial::Shutter, None) => format!("{value:.1} s"),
        }
    }

    /// Returns a value as it is printed on a dial: 5.6 for 5.657; the value itself between the marks.
    pub fn printed(self, value: f32) -> f32 {
        let label = self.label(value);
        let number = label.trim_start_matches("f/").trim_end_matches(" s");
        let parsed = match number.strip_prefix("1/") {
            Some(denominator) => denominator.parse().map(|denominator: f32| 1.0 / denominator),
            None => number.parse(),
        };
        parsed.unwrap_or(value)
    }

    /// Returns the next whole third from `value` in a direction (+1 or -1), clamped to the scale.
    pub fn step(self, value: f32, direction: i32) -> f32 {
        let thirds = self.thirds(value);
        // Files hold nominal values (5.6, 1/60), up to 0.3 thirds from the exact ones: such a value counts as its
        // third.
        let nearest = thirds.round();
        let next = match (direction > 0, (thirds - nearest).abs() < 0.35) {
            (true, true) => nearest as i32 + 1,
            (false, true) => nearest as i32 - 1,
            (true, false) => thirds.ceil() as i32,
            (false, false) => thirds.floor() as i32,
        };
        self.value(next.clamp(*self.range().start(), *self.range().end()))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn nominal_labels_are_the_exact_values_rounded() {
        for dial in [Dial::FNumber, Dial::Shutter, Dial::Iso] {
            for thirds in dial.range() {
                let text = dial.nominal_label(thirds).unwrap().trim_end_matches(" s");
                let shown: f32 = match text.strip_prefix("1/") {
                    Some(denominator) => 1.0 / denominator.parse::<f32>().unwrap(),
                    None => text.parse().unwrap(),
                };
                // Labels are rounded by up to a sixth of a stop (f/1.2, 1/60, 1/6).
                let off = (dial.thirds(shown) - thirds as f32).abs();
                assert!(off < 0.5, "{dial:?} {text} is {off} thirds off");
            }
        }
    }

    #[test]
    fn values_are_labelled_as_on_a_camera() {
        assert_eq!(Dial::FNumber.label(5.6), "f/5.6");
        assert_eq!(Dial::Shutter.label(1.0 / 125.0), "1/125");
        assert_eq!(Dial::Shutter.label(2.0), "2 s");
        assert_eq!(Dial::Iso.label(100.0), "100");
        assert_eq!(Dial::FNumber.label(6.0), "f/6.0");
        assert_eq!([11.0, 11.4, 22.0].map(|n| Dial::FNumber.label(n)), ["f/11", "f/11", "f/22"]);
    }

    #[test]
    fn printed_values_are_those_of_the_labels() {
        let printed = [(Dial::FNumber, 5.657), (Dial::Shutter, 1.0 / 128.0), (Dial::Iso, 400.0), (Dial::Shutter, 2.0)];
        assert_eq!(printed.map(|(dial, value)| dial.printed(value)), [5.6, 1.0 / 125.0, 400.0, 2.0]);
    }

    #[test]
    fn steps_are_thirds_and_stop_at_the_ends_of_the_scale() {
        let up = Dial::FNumber.step(5.6, 1);
        assert!((up - 2.0_f32.powf(16.0 / 6.0)).abs() < 1e-5, "{up}");
        assert_eq!(Dial::FNumber.label(up), "f/6.3");
        assert_eq!(Dial::Iso.step(50.0, -1), 50.0);
        assert_eq!(Dial::Shutter.label(Dial::Shutter.step(1.0 / 125.0, -1)), "1/100");
    }
}

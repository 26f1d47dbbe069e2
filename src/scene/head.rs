//! Lamp heads: the dial of a head, and what limits its flash.

use std::ops::RangeInclusive;

/// The scale that a head displays.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum DialScale {
    /// Fractions of full power: 1/1, 1/2, 1/4, and tenths of a stop between.
    Fractions,
    /// A number that rises by one a stop.
    Number {
        /// The number at full power.
        full: f32,
    },
    /// Energy, watt seconds.
    WattSeconds {
        /// Energy at full power.
        full: f32,
    },
    /// Per cent of full power.
    PerCent,
}

/// The end of a dial that a power lies beyond.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum BeyondDial {
    /// More than full power.
    Full,
    /// Less than the lowest setting.
    Lowest,
}

/// The dial of a head.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct HeadDial {
    /// What the display shows.
    pub scale: DialScale,
    /// Lowest setting, stops from full power, at most 0.
    pub lowest_stops: f32,
    /// Settings a stop; whole per cents on a dial in per cent.
    pub steps_per_stop: u8,
}

impl HeadDial {
    /// The dial of a head that is not known: tenths of a stop from 1/512 to full power.
    pub const UNKNOWN: HeadDial = HeadDial { scale: DialScale::Fractions, lowest_stops: -9.0, steps_per_stop: 10 };

    /// Returns the range, stops from full power.
    pub fn range(&self) -> RangeInclusive<f32> {
        self.lowest_stops..=0.0
    }

    /// Returns the end that a power lies beyond, stops from full power; none if the head can be set to it.
    pub fn beyond(&self, stops: f32) -> Option<BeyondDial> {
        // Rounding of a dial in thirds, stops
        const ROUNDING: f32 = 1e-3;
        match stops {
            stops if stops > ROUNDING => Some(BeyondDial::Full),
            stops if stops < self.lowest_stops - ROUNDING => Some(BeyondDial::Lowest),
            _ => None,
        }
    }

    /// Returns the distance of two settings about a power, stops.
    pub fn step_stops(&self, stops: f32) -> f32 {
        match self.scale {
            DialScale::PerCent => (1.0 + 1.0 / (100.0 * stops.exp2()).max(1.0)).log2(),
            DialScale::Fractions | DialScale::Number { .. } | DialScale::WattSeconds { .. } => {
                1.0 / f32::from(self.steps_per_stop.max(1))
            }
        }
    }

    /// Returns the setting nearest to a power, stops from full power.
    pub fn nearest(&self, stops: f32) -> f32 {
        let steps = f32::from(self.steps_per_stop.max(1));
        let nearest = match self.scale {
            DialScale::PerCent => ((100.0 * stops.exp2()).round().max(1.0) / 100.0).log2(),
            DialScale::Fractions | DialScale::Number { .. } | DialScale::WattSeconds { .. } => {
                (stops * steps).round() / steps
            }
        };
        nearest.clamp(self.lowest_stops.min(0.0), 0.0)
    }

    /// Returns the setting about `by_stops` over the nearest one, at least one setting further.
    pub fn moved(&self, stops: f32, by_stops: f32) -> f32 {
        let now = self.nearest(stops);
        let moved = self.nearest(now + by_stops);
        if moved == now { self.nearest(now + self.step_stops(now).copysign(by_stops)) } else { moved }
    }
}

/// A lamp head by name. A studio keeps a copy of it, so that its dials read the same on a machine whose list of gear
/// lacks the head.
#[derive(Clone, Debug, PartialEq)]
pub struct Head {
    /// Its name in the list of gear.
    pub name: String,
    /// Its dial.
    pub dial: HeadDial,
    /// Shortest shutter that gets the whole flash, seconds; none if not known.
    pub sync_s: Option<f32>,
    /// Loss by the change to high-speed sync, stops; none if the head has none, or it is not known.
    pub hss_loss_stops: Option<f32>,
    /// Time in which the flash is over a tenth of its peak, at full power, seconds; none if not known.
    pub t01_s: Option<f32>,
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn settings_are_those_of_the_dial() {
        let thirds = HeadDial { scale: DialScale::Fractions, lowest_stops: -7.0, steps_per_stop: 3 };
        assert_eq!(thirds.nearest(-1.4), -4.0 / 3.0);
        assert_eq!([thirds.nearest(0.4), thirds.nearest(-12.0)], [0.0, -7.0]);
        assert!((thirds.moved(-1.0, -0.7) + 5.0 / 3.0).abs() < 1e-6);
        assert!((thirds.moved(-1.0, 0.1) + 2.0 / 3.0).abs() < 1e-6, "at least a setting");
        assert_eq!([-7.0005, -3.0, 0.0005].map(|stops| thirds.beyond(stops)), [None; 3]);
        assert_eq!([-7.1, 0.1].map(|stops| thirds.beyond(stops)), [Some(BeyondDial::Lowest), Some(BeyondDial::Full)]);
        let led = HeadDial { scale: DialScale::PerCent, lowest_stops: 0.01_f32.log2(), steps_per_stop: 1 };
        assert!((led.nearest(-1.02).exp2() - 0.49).abs() < 1e-6);
        assert!((led.moved(-1.0, 1.0 / 3.0).exp2() - 0.63).abs() < 1e-6);
        assert!((led.moved(0.02_f32.log2(), 0.1).exp2() - 0.03).abs() < 1e-6);
        assert!((led.step_stops(0.0) - 0.01435).abs() < 1e-4 && thirds.step_stops(-3.0) == 1.0 / 3.0);
        assert!((led.moved(-20.0, -1.0).exp2() - 0.01).abs() < 1e-6, "the lowest setting stays");
    }
}

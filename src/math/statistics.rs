//! Tests of hypotheses for the tests of samplers and estimators: the one place where false alarms are reckoned.
//!
//! A family of tests shares one false-alarm rate, [`FALSE_ALARM`]: Sidak's correction gives each its part. Seeds are
//! fixed, so a test that passes today passes always; the rate says how likely it was that correct code failed when the
//! test was written, and so how much a failure means after a change.

use glam::{Vec2, Vec3};

/// Chance that a whole family of tests accuses correct code.
pub const FALSE_ALARM: f64 = 1e-3;

/// Independent numbers (Steele, Lea and Flood 2014, SplitMix64). Quasi-random ones would be too even for these tests.
#[derive(Clone, Debug)]
pub struct Numbers(u64);

impl Numbers {
    /// The same numbers for the same seed.
    pub fn new(seed: u64) -> Self {
        Numbers(seed.wrapping_mul(0x9e37_79b9_7f4a_7c15) ^ 0x5851_f42d_4c95_7f2d)
    }

    fn bits(&mut self) -> u64 {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let mut z = self.0;
        z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        z ^ (z >> 31)
    }

    /// In [0, 1), 24 bits.
    pub fn number(&mut self) -> f32 {
        (self.bits() >> 40) as f32 / (1_u64 << 24) as f32
    }

    /// In [low, high).
    pub fn between(&mut self, low: f32, high: f32) -> f32 {
        low + (high - low) * self.number()
    }

    /// A point of the unit square.
    pub fn square(&mut self) -> Vec2 {
        Vec2::new(self.number(), self.number())
    }

    /// A unit vector, uniform on the sphere (Marsaglia 1972): independent of the warps under test.
    pub fn direction(&mut self) -> Vec3 {
        loop {
            let p = self.square() * 2.0 - 1.0;
            let s = p.length_squared();
            if s < 1.0 {
                let root = 2.0 * (1.0 - s).sqrt();
                return Vec3::new(p.x * root, p.y * root, 1.0 - 2.0 * s);
            }
        }
    }
}

/// Logarithm of the gamma function (Lanczos 1964, g = 7, nine terms): 1e-13 for positive arguments.
fn ln_gamma(x: f64) -> f64 {
    const TERMS: [f64; 9] = [
        0.999_999_999_999_809_9,
        676.520_368_121_885_1,
        -1_259.139_216_722_402_8,
        771.323_428_777_653_1,
        -176.615_029_162_140_6,
        12.507_343_278_686_905,
        -0.138_571_095_265_720_12,
        9.984_369_578_019_572e-6,
        1.505_632_735_149_311_6e-7,
    ];
    let x = x - 1.0;
    let t = x + 7.5;
    let sum = TERMS.iter().skip(1).enumerate().fold(TERMS[0], |sum, (i, c)| sum + c / (x + i as f64 + 1.0));
    0.5 * (2.0 * std::f64::consts::PI).ln() + (x + 0.5) * t.ln() - t + sum.ln()
}

/// Upper regularised incomplete gamma function Q(a, x): by its series below a + 1, by its continued fraction above
/// (DLMF 8.11.4 and 8.9.2, the latter by Lentz's method).
fn upper_gamma(a: f64, x: f64) -> f64 {
    if x <= 0.0 {
        return 1.0;
    }
    let front = (a * x.ln() - x - ln_gamma(a)).exp();
    if x < a + 1.0 {
        let (mut term, mut sum) = (1.0 / a, 1.0 / a);
        for n in 1..10_000 {
            term *= x / (a + f64::from(n));
            sum += term;
            if term < sum * 1e-15 {
                break;
            }
        }
        return 1.0 - front * sum;
    }
    let mut b = x + 1.0 - a;
    let (mut c, mut d) = (1e300, 1.0 / b);
    let mut fraction = d;
    for n in 1..10_000 {
        let an = -f64::from(n) * (f64::from(n) - a);
        b += 2.0;
        d = 1.0 / (an * d + b);
        c = b + an / c;
        fraction *= d * c;
        if (d * c - 1.0).abs() < 1e-15 {
            break;
        }
    }
    front * fraction
}

/// Chance that a chi-square variable with so many degrees of freedom exceeds `x`.
pub fn chi_square_tail(x: f64, degrees: usize) -> f64 {
    upper_gamma(0.5 * degrees as f64, 0.5 * x)
}

/// Chance that a normal variable strays from its mean by more than `z` standard deviations, either way.
pub fn normal_tails(z: f64) -> f64 {
    upper_gamma(0.5, 0.5 * z * z)
}

/// Sidak's share of [`FALSE_ALARM`] for each of `tests` tests.
pub fn share(tests: usize) -> f64 {
    -((-FALSE_ALARM).ln_1p() / tests as f64).exp_m1()
}

/// The number of standard errors that each of `tests` estimates may be off.
pub fn allowed_errors(tests: usize) -> f64 {
    let (mut low, mut high) = (0.0, 40.0);
    for _ in 0..80 {
        let middle = 0.5 * (low + high);
        if normal_tails(middle) > share(tests) { low = middle } else { high = middle }
    }
    high
}

/// Pearson's test of counts against expected counts. Cells that expect less than five are pooled.
#[derive(Clone, Debug, Default)]
pub struct ChiSquare {
    counts: Vec<f64>,
    expected: Vec<f64>,
}

impl ChiSquare {
    /// Adds a cell.
    pub fn cell(&mut self, count: f64, expected: f64) {
        self.counts.push(count);
        self.expected.push(expected);
    }

    /// The p-value: small for counts that hardly come from these expectations, 0 where a sample fell into a cell that
    /// expects none. The totals are taken to be equal.
    pub fn p_value(&self) -> f64 {
        let mut order: Vec<usize> = (0..self.counts.len()).collect();
        order.sort_by(|&a, &b| self.expected[a].total_cmp(&self.expected[b]));
        if self.counts.iter().zip(&self.expected).any(|(&count, &expected)| count > 0.0 && expected <= 0.0) {
            return 0.0;
        }
        let (mut statistic, mut cells) = (0.0, 0_usize);
        let (mut count, mut expected) = (0.0, 0.0);
        for &i in &order {
            count += self.counts[i];
            expected += self.expected[i];
            // Rare cells come first and are pooled.
            if expected >= 5.0 {
                statistic += (count - expected) * (count - expected) / expected;
                cells += 1;
                (count, expected) = (0.0, 0.0);
            }
        }
        chi_square_tail(statistic, cells.saturating_sub(1).max(1))
    }
}

/// Mean and standard error of independent values.
#[derive(Clone, Copy, Debug)]
pub struct Estimate {
    /// Mean of the values.
    pub mean: f64,
    /// Standard error of the mean.
    pub error: f64,
}

impl Estimate {
    /// From values that do not know of each other.
    pub fn of(values: impl IntoIterator<Item = f64>) -> Self {
        // Welford's update: the variance keeps its digits.
        let (mut n, mut mean, mut squares) = (0.0, 0.0, 0.0);
        for value in values {
            n += 1.0;
            let off = value - mean;
            mean += off / n;
            squares += off * (value - mean);
        }
        Estimate { mean, error: (squares / (n * (n - 1.0))).sqrt() }
    }

    /// Whether `truth` is within the errors that one of `tests` estimates may have; `bias` is what the set-up itself
    /// adds (a card of some size, single precision), as a share of the truth.
    pub fn agrees(&self, truth: f64, bias: f64, tests: usize) -> bool {
        (self.mean - truth).abs() <= allowed_errors(tests) * self.error + bias * truth.abs()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn tails_match_printed_tables() {
        // Abramowitz and Stegun, tables 26.1 and 26.8.
        for (z, p) in [(1.0, 0.317_311), (1.959_964, 0.05), (3.290_527, 0.001)] {
            assert!((normal_tails(z) - p).abs() < 1e-5, "{z}: {}", normal_tails(z));
        }
        for (x, degrees, p) in [(3.841_46, 1, 0.05), (18.307, 10, 0.05), (149.449, 100, 0.001)] {
            assert!((chi_square_tail(x, degrees) - p).abs() < 1e-5, "{x}: {}", chi_square_tail(x, degrees));
        }
    }

    #[test]
    fn the_family_keeps_its_rate() {
        assert!((1.0 - (1.0 - share(40)).powi(40) - FALSE_ALARM).abs() < 1e-12);
        assert!((allowed_errors(1) - 3.2905).abs() < 1e-3);
    }

    #[test]
    fn a_fair_die_passes_and_a_loaded_one_does_not() {
        let mut numbers = Numbers::new(1);
        for (load, fair) in [(0.0, true), (0.02, false)] {
            let mut counts = [0.0; 6];
            for _ in 0..60_000 {
                let x = numbers.number();
                counts[if numbers.number() < load { 5 } else { (x * 6.0) as usize }] += 1.0;
            }
            let mut test = ChiSquare::default();
            counts.iter().for_each(|&c| test.cell(c, 10_000.0));
            assert_eq!(test.p_value() > FALSE_ALARM, fair, "{load}: {}", test.p_value());
        }
    }

    #[test]
    fn rare_cells_are_pooled_and_impossible_ones_accuse() {
        let mut test = ChiSquare::default();
        (0..10).for_each(|_| test.cell(1.0, 1.0));
        test.cell(990.0, 990.0);
        assert!(test.p_value() > 0.99);
        let mut impossible = ChiSquare::default();
        impossible.cell(1.0, 0.0);
        (0..10).for_each(|_| impossible.cell(100.0, 100.1));
        assert_eq!(impossible.p_value(), 0.0);
    }

    #[test]
    fn estimates_know_their_error() {
        let mut numbers = Numbers::new(2);
        let estimate = Estimate::of((0..10_000).map(|_| f64::from(numbers.number())));
        // A uniform number has variance 1 / 12.
        assert!((estimate.error - (1.0 / 12.0_f64).sqrt() / 100.0).abs() < 1e-4);
        assert!(estimate.agrees(0.5, 0.0, 1) && !estimate.agrees(0.52, 0.0, 1));
    }
}

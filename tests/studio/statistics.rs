//! Hypothesis tests for samplers and estimators, with a stated false-alarm rate. Unit tests and integration tests use
//! it.
//!
//! A family of tests shares one false-alarm rate, [`FALSE_ALARM`]: the Sidak correction gives the level of each test.
//! Seeds are fixed, so results repeat; the rate is the probability that correct code failed when the test was written.

use glam::{Vec2, Vec3};
use statrs::distribution::{ChiSquared, ContinuousCDF, Normal, StudentsT};

/// Probability that a family of tests rejects correct code.
pub const FALSE_ALARM: f64 = 1e-3;

/// The pseudo-random generator SplitMix64 (Steele, Lea and Flood 2014). Its numbers are independent, unlike the
/// renderer's low-discrepancy points, so that the tests' distributions hold.
#[derive(Clone, Debug)]
pub struct TestRng(u64);

impl TestRng {
    /// Returns a generator whose sequence depends on the seed alone.
    pub fn new(seed: u64) -> Self {
        TestRng(seed.wrapping_mul(0x9e37_79b9_7f4a_7c15) ^ 0x5851_f42d_4c95_7f2d)
    }

    fn bits(&mut self) -> u64 {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let mut z = self.0;
        z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        z ^ (z >> 31)
    }

    /// Returns a uniform number in [0, 1) with 24 random bits.
    pub fn uniform(&mut self) -> f32 {
        (self.bits() >> 40) as f32 / (1_u64 << 24) as f32
    }

    /// Returns a uniform number in [low, high).
    pub fn range(&mut self, low: f32, high: f32) -> f32 {
        low + (high - low) * self.uniform()
    }

    /// Returns a uniform point of the unit square.
    pub fn unit_square(&mut self) -> Vec2 {
        Vec2::new(self.uniform(), self.uniform())
    }

    /// Returns a unit vector, uniform on the sphere (Marsaglia 1972), computed without the warps under test.
    pub fn direction(&mut self) -> Vec3 {
        loop {
            let p = self.unit_square() * 2.0 - 1.0;
            let s = p.length_squared();
            if s < 1.0 {
                let root = 2.0 * (1.0 - s).sqrt();
                return Vec3::new(p.x * root, p.y * root, 1.0 - 2.0 * s);
            }
        }
    }
}

/// Returns the probability that a chi-square variable with `degrees` degrees of freedom exceeds `x`.
pub fn chi_square_tail(x: f64, degrees: usize) -> f64 {
    ChiSquared::new(degrees as f64).unwrap().sf(x)
}

/// Returns the probability that a normal variable lies more than `z` standard deviations from its mean.
pub fn normal_tails(z: f64) -> f64 {
    2.0 * Normal::standard().sf(z)
}

/// Returns the probability that a variable with Student's t-distribution lies more than `t` from 0.
pub fn student_tails(t: f64, degrees: f64) -> f64 {
    2.0 * StudentsT::new(0.0, 1.0, degrees).unwrap().sf(t)
}

/// Returns the significance level of one of `tests` tests that share [`FALSE_ALARM`] (Sidak 1967).
pub fn sidak_level(tests: usize) -> f64 {
    -((-FALSE_ALARM).ln_1p() / tests as f64).exp_m1()
}

/// Returns the number of standard errors by which each of `tests` estimates may be off.
pub fn critical_z(tests: usize) -> f64 {
    -Normal::standard().inverse_cdf(0.5 * sidak_level(tests))
}

/// Pearson's chi-square test of counts against expected counts. Bins that expect less than five are pooled.
#[derive(Clone, Debug, Default)]
pub struct ChiSquare {
    counts: Vec<f64>,
    expected: Vec<f64>,
}

impl ChiSquare {
    /// Adds a bin.
    pub fn add_bin(&mut self, count: f64, expected: f64) {
        self.counts.push(count);
        self.expected.push(expected);
    }

    /// Returns the p-value, or 0 if a sample fell into a bin that expects none. Assumes equal totals.
    pub fn p_value(&self) -> f64 {
        let mut order: Vec<usize> = (0..self.counts.len()).collect();
        order.sort_by(|&a, &b| self.expected[a].total_cmp(&self.expected[b]));
        if self.counts.iter().zip(&self.expected).any(|(&count, &expected)| count > 0.0 && expected <= 0.0) {
            return 0.0;
        }
        let (mut statistic, mut bins) = (0.0, 0_usize);
        let (mut count, mut expected) = (0.0, 0.0);
        for &i in &order {
            count += self.counts[i];
            expected += self.expected[i];
            // Pool the rare bins, which come first.
            if expected >= 5.0 {
                statistic += (count - expected) * (count - expected) / expected;
                bins += 1;
                (count, expected) = (0.0, 0.0);
            }
        }
        chi_square_tail(statistic, bins.saturating_sub(1).max(1))
    }
}

/// The mean of independent values and its standard error.
#[derive(Clone, Copy, Debug)]
pub struct SampleMean {
    /// Mean of the values.
    pub mean: f64,
    /// Standard error of the mean.
    pub standard_error: f64,
}

impl SampleMean {
    /// Computes mean and standard error of independent values (Welford 1962).
    pub fn of(values: impl IntoIterator<Item = f64>) -> Self {
        let (mut n, mut mean, mut squares) = (0.0, 0.0, 0.0);
        for value in values {
            n += 1.0;
            let deviation = value - mean;
            mean += deviation / n;
            squares += deviation * (value - mean);
        }
        SampleMean { mean, standard_error: (squares / (n * (n - 1.0))).sqrt() }
    }

    /// Returns the mean and standard error in other units, `scale` times as large.
    pub fn scaled(self, scale: f64) -> Self {
        SampleMean { mean: self.mean * scale, standard_error: self.standard_error * scale }
    }

    /// Returns true if `expected` lies within the error that one of `tests` estimates may have. `bias` is the relative
    /// error of the set-up itself (a card of finite size, single precision).
    pub fn agrees_with(&self, expected: f64, bias: f64, tests: usize) -> bool {
        (self.mean - expected).abs() <= critical_z(tests) * self.standard_error + bias * expected.abs()
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
        // Student 1908, as in Abramowitz and Stegun, table 26.10.
        for (t, degrees, p) in [(12.7062, 1.0, 0.05), (2.228_14, 10.0, 0.05), (3.290_53, 1e7, 0.001)] {
            assert!((student_tails(t, degrees) - p).abs() < 1e-5, "{t}: {}", student_tails(t, degrees));
        }
        for (x, degrees, p) in [(3.841_46, 1, 0.05), (18.307, 10, 0.05), (149.449, 100, 0.001)] {
            assert!((chi_square_tail(x, degrees) - p).abs() < 1e-5, "{x}: {}", chi_square_tail(x, degrees));
        }
    }

    #[test]
    fn a_family_of_tests_keeps_its_false_alarm_rate() {
        assert!((1.0 - (1.0 - sidak_level(40)).powi(40) - FALSE_ALARM).abs() < 1e-12);
        assert!((critical_z(1) - 3.2905).abs() < 1e-3);
    }

    #[test]
    fn a_fair_die_passes_and_a_loaded_one_does_not() {
        let mut rng = TestRng::new(1);
        for (load, fair) in [(0.0, true), (0.02, false)] {
            let mut counts = [0.0; 6];
            for _ in 0..60_000 {
                let x = rng.uniform();
                counts[if rng.uniform() < load { 5 } else { (x * 6.0) as usize }] += 1.0;
            }
            let mut test = ChiSquare::default();
            counts.iter().for_each(|&c| test.add_bin(c, 10_000.0));
            assert_eq!(test.p_value() > FALSE_ALARM, fair, "{load}: {}", test.p_value());
        }
    }

    #[test]
    fn rare_bins_are_pooled_and_impossible_ones_reject() {
        let mut test = ChiSquare::default();
        (0..10).for_each(|_| test.add_bin(1.0, 1.0));
        test.add_bin(990.0, 990.0);
        assert!(test.p_value() > 0.99);
        let mut impossible = ChiSquare::default();
        impossible.add_bin(1.0, 0.0);
        (0..10).for_each(|_| impossible.add_bin(100.0, 100.1));
        assert_eq!(impossible.p_value(), 0.0);
    }

    #[test]
    fn the_standard_error_of_a_uniform_sample_is_exact() {
        let mut rng = TestRng::new(2);
        let estimate = SampleMean::of((0..10_000).map(|_| f64::from(rng.uniform())));
        // A uniform number has variance 1 / 12.
        assert!((estimate.standard_error - (1.0 / 12.0_f64).sqrt() / 100.0).abs() < 1e-4);
        assert!(estimate.agrees_with(0.5, 0.0, 1) && !estimate.agrees_with(0.52, 0.0, 1));
    }
}

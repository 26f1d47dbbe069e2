//! Sums of floats without rounding: their value does not depend on the order or the grouping of the addends.
//!
//! Fixed point: whole multiples of 2^-64 in 128 bits, from 5e-20 to 9e18. An addend loses what lies below, always
//! the same; the sums are those of integers. Addends are clamped to a million millions, so that nine million of them do
//! not overflow: clamping a sum instead would make it depend on the order.

/// Steps per unit: 2^64.
const STEPS: f64 = 18_446_744_073_709_551_616.0;

/// Greatest absolute value of an addend.
const MAX_ADDEND: f32 = 1e12;

/// A sum of floats without rounding.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct ExactSum(i128);

impl ExactSum {
    /// Adds a float, clamped to the greatest absolute value of an addend. NaN counts as 0.
    #[inline]
    pub fn add(&mut self, value: f32) {
        // Scaling by a power of two is exact in 64 bits.
        self.merge(ExactSum((f64::from(value.clamp(-MAX_ADDEND, MAX_ADDEND)) * STEPS) as i128));
    }

    /// Adds another sum.
    #[inline]
    pub fn merge(&mut self, other: ExactSum) {
        self.0 = self.0.wrapping_add(other.0);
    }

    /// Returns the sum, rounded to a float.
    pub fn value(self) -> f64 {
        self.0 as f64 / STEPS
    }

    /// Returns the bits of the sum in words of 32, the lowest first.
    pub fn words(self) -> [u32; 4] {
        [0, 32, 64, 96].map(|shift| (self.0 as u128 >> shift) as u32)
    }

    /// Returns the sum with these bits.
    pub fn from_words(words: [u32; 4]) -> Self {
        let bits = words.iter().rev().fold(0_u128, |bits, word| bits << 32 | u128::from(*word));
        ExactSum(bits as i128)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn any_order_and_grouping_of_floats_has_the_same_sum() {
        // Addends whose float sum depends on the order: sizes from 1e-9 to 1e9, of both signs.
        let value = |i: u32| {
            let mantissa = (i.wrapping_mul(2_654_435_761) >> 8) as f32 / 16_777_216.0 - 0.4;
            mantissa * 10_f32.powi((i % 19) as i32 - 9)
        };
        let values: Vec<f32> = (0..1000).map(value).collect();
        let sum = |values: &mut dyn Iterator<Item = &f32>| {
            let mut sum = ExactSum::default();
            values.for_each(|value| sum.add(*value));
            sum
        };
        let forward = sum(&mut values.iter());
        assert_eq!(sum(&mut values.iter().rev()), forward);
        for cut in [1, 7, 500, 999] {
            let (before, after) = values.split_at(cut);
            let mut merged = sum(&mut after.iter());
            merged.merge(sum(&mut before.iter()));
            assert_eq!(merged, forward);
        }
        let floats = |values: &mut dyn Iterator<Item = &f32>| values.fold(0.0_f32, |sum, value| sum + value);
        assert_ne!(floats(&mut values.iter()), floats(&mut values.iter().rev()), "floats do depend on it");
        let doubles: f64 = values.iter().map(|value| f64::from(*value)).sum();
        assert!((forward.value() - doubles).abs() < 1e-6 * doubles.abs(), "{} {doubles}", forward.value());
    }

    #[test]
    fn sums_of_huge_and_infinite_addends_do_not_overflow_and_nan_counts_as_0() {
        let sum = |values: &[f32]| {
            let mut sum = ExactSum::default();
            values.iter().for_each(|value| sum.add(*value));
            sum
        };
        let limit = f64::from(MAX_ADDEND);
        for huge in [f32::INFINITY, f32::MAX, 9.3e18] {
            assert_eq!(sum(&[huge, 1.0]).value(), limit + 1.0, "{huge}");
            assert_eq!(sum(&[1.0, huge, huge]).value(), 2.0 * limit + 1.0, "{huge}");
            assert_eq!(sum(&[-huge, 1.0, huge]).value(), 1.0, "{huge}");
        }
        assert_eq!(sum(&[f32::NAN, 2.0]).value(), 2.0);
    }

    #[test]
    fn words_keep_every_bit_and_the_sign() {
        for value in [0.0, 1.0, -1.0, 5.5e-20, 8.0e18, -3.7e-5, f32::MAX, f32::NEG_INFINITY, f32::NAN] {
            let mut sum = ExactSum::default();
            sum.add(value);
            assert_eq!(ExactSum::from_words(sum.words()), sum, "{value}");
            if value.abs() < 1e18 && value.abs() > 1e-12 {
                assert!((sum.value() - f64::from(value)).abs() < 1e-7 * f64::from(value.abs()), "{value}");
            }
        }
    }
}

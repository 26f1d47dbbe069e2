//! Functions without a jump, so that a loop over pixels can take eight at a time.

use std::f32::consts::{FRAC_1_SQRT_2, FRAC_PI_2, LN_2, LOG2_E, PI};

/// The larger one; the bound where the first is NaN.
#[inline(always)]
pub(super) fn at_least(x: f32, bound: f32) -> f32 {
    if x > bound { x } else { bound }
}

/// The smaller one; the bound where the first is NaN.
#[inline(always)]
pub(super) fn at_most(x: f32, bound: f32) -> f32 {
    if x < bound { x } else { bound }
}

/// x^n, for a normal x up to 1 and n >= 0.
#[inline(always)]
pub(super) fn power(x: f32, n: f32) -> f32 {
    two_to(log2(x) * n)
}

/// Base-2 logarithm of a normal positive number, to 2e-7 absolute: the exponent, and the series of
/// artanh((m - 1) / (m + 1)) for a mantissa between sqrt(1/2) and sqrt(2).
#[inline(always)]
fn log2(x: f32) -> f32 {
    const SQRT_HALF: i32 = FRAC_1_SQRT_2.to_bits() as i32;
    let exponent = (x.to_bits() as i32 - SQRT_HALF) >> 23;
    let mantissa = f32::from_bits((x.to_bits() as i32 - (exponent << 23)) as u32);
    let t = (mantissa - 1.0) / (mantissa + 1.0);
    let square = t * t;
    let series = 1.0 + square * (1.0 / 3.0 + square * (1.0 / 5.0 + square * (1.0 / 7.0)));
    exponent as f32 + 2.0 * LOG2_E * t * series
}

/// Two to the power of a number under 1, to 3e-7 of the result; 2^-125 for all below.
#[inline(always)]
fn two_to(power: f32) -> f32 {
    /// Adding it rounds to whole numbers, which then are its last bits.
    const ROUNDER: f32 = 12_582_912.0;
    let power = at_least(power, -125.0);
    let rounded = power + ROUNDER;
    let whole = rounded.to_bits() as i32 - ROUNDER.to_bits() as i32;
    let f = (power - (rounded - ROUNDER)) * LN_2;
    // Taylor's series for |f| under 0.35.
    let series =
        1.0 + f * (1.0 + f * (0.5 + f * (1.0 / 6.0 + f * (1.0 / 24.0 + f * (1.0 / 120.0 + f * (1.0 / 720.0))))));
    f32::from_bits((series.to_bits() as i32 + (whole << 23)) as u32)
}

/// Arc cosine to 1e-6; the argument is clamped to [-1, 1]. Hastings's polynomial (Abramowitz and Stegun 4.4.46).
#[inline(always)]
pub(super) fn acos(x: f32) -> f32 {
    let m = at_most(x.abs(), 1.0);
    let high = 0.030_891_88 + m * (-0.017_088_126 + m * (0.006_670_09 - m * 0.001_262_491_1));
    let series = FRAC_PI_2 + m * (-0.214_598_8 + m * (0.088_978_99 + m * (-0.050_174_305 + m * high)));
    let angle = (1.0 - m).sqrt() * series;
    if x < 0.0 { PI - angle } else { angle }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn powers_are_those_of_the_library() {
        for n in [0.0_f32, 0.7, 1.0, 13.0, 800.0, 2e4] {
            for x in [1e-30_f32, 1e-3, 0.3, 0.707, FRAC_1_SQRT_2, 0.99, 0.999_999, 1.0] {
                let (got, exact) = (power(x, n), x.powf(n));
                // The logarithm's error counts n times.
                let error = (got - exact).abs();
                assert!(error <= 1e-6 * exact * (1.0 + 0.3 * n) + 1e-30, "{x}^{n}: {got}, not {exact}");
            }
        }
    }

    #[test]
    fn angles_are_those_of_the_library() {
        for x in (-1010..=1010).map(|step| step as f32 * 1e-3) {
            assert!((acos(x) - crate::math::safe_acos(x)).abs() < 2e-6, "{x}");
        }
    }
}

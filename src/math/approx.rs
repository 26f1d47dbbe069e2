//! Branch-free polynomial approximations, so that loops over pixels and lanes vectorize.

use std::f32::consts::{FRAC_1_SQRT_2, FRAC_PI_2, LN_2, LOG2_E, PI};

/// Returns the larger value; `bound` where `x` is NaN.
#[inline(always)]
pub fn max(x: f32, bound: f32) -> f32 {
    if x > bound { x } else { bound }
}

/// Returns the smaller value; `bound` where `x` is NaN.
#[inline(always)]
pub fn min(x: f32, bound: f32) -> f32 {
    if x < bound { x } else { bound }
}

/// Returns x^n, for a normal x up to 1 and n >= 0.
#[inline(always)]
pub fn pow(x: f32, n: f32) -> f32 {
    exp2(log2(x) * n)
}

/// Returns the base-2 logarithm of a normal positive number, with an absolute error of 2e-7: the exponent, plus the
/// series of artanh((m - 1) / (m + 1)) for a mantissa m between sqrt(1/2) and sqrt(2).
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

/// 1.5 x 2^23: adding it rounds to an integer, which is then in the last bits.
pub(super) const ROUNDER: f32 = 12_582_912.0;

/// Returns 2^x for x under 1, with a relative error of 3e-7; 2^-125 for all x below -125.
#[inline(always)]
fn exp2(x: f32) -> f32 {
    let x = max(x, -125.0);
    let rounded = x + ROUNDER;
    let whole = rounded.to_bits() as i32 - ROUNDER.to_bits() as i32;
    let f = (x - (rounded - ROUNDER)) * LN_2;
    // Taylor series for |f| under 0.35.
    let series =
        1.0 + f * (1.0 + f * (0.5 + f * (1.0 / 6.0 + f * (1.0 / 24.0 + f * (1.0 / 120.0 + f * (1.0 / 720.0))))));
    f32::from_bits((series.to_bits() as i32 + (whole << 23)) as u32)
}

/// Returns e^x for x under 0.6, with a relative error of 4e-7 + 1e-7 |x|; e^-86 for all x below -86.
#[inline(always)]
pub fn exp(x: f32) -> f32 {
    exp2(x * LOG2_E)
}

/// Returns the nearest whole number, for x within 4e6; halves go to the even one.
#[inline(always)]
pub fn round(x: f32) -> f32 {
    (x + ROUNDER) - ROUNDER
}

/// Returns the arc cosine with an error of 1e-6; the argument is clamped to [-1, 1]. Hastings's polynomial (Abramowitz
/// and Stegun 4.4.46).
#[inline(always)]
pub fn acos(x: f32) -> f32 {
    let m = min(x.abs(), 1.0);
    let high = 0.030_891_88 + m * (-0.017_088_126 + m * (0.006_670_09 - m * 0.001_262_491_1));
    let series = FRAC_PI_2 + m * (-0.214_598_8 + m * (0.088_978_99 + m * (-0.050_174_305 + m * high)));
    let angle = (1.0 - m).sqrt() * series;
    if x < 0.0 { PI - angle } else { angle }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn pow_agrees_with_the_standard_library() {
        for n in [0.0_f32, 0.7, 1.0, 13.0, 800.0, 2e4] {
            for x in [1e-30_f32, 1e-3, 0.3, 0.707, FRAC_1_SQRT_2, 0.99, 0.999_999, 1.0] {
                let (got, exact) = (pow(x, n), x.powf(n));
                // The logarithm's error counts n times.
                let error = (got - exact).abs();
                assert!(error <= 1e-6 * exact * (1.0 + 0.3 * n) + 1e-30, "{x}^{n}: {got}, not {exact}");
            }
        }
    }

    #[test]
    fn exp_and_round_agree_with_the_standard_library() {
        for x in (-86_000..600).map(|step| step as f32 * 1e-3) {
            let exact = f64::from(x).exp();
            let error = (f64::from(exp(x)) / exact - 1.0).abs();
            assert!(error < 4e-7 + 1e-7 * f64::from(x.abs()), "{x}: {error}");
            assert_eq!(round(x), x.round_ties_even());
        }
        assert!(exp(-1e9) > 0.0 && exp(-1e9) < 1e-37);
    }

    #[test]
    fn acos_agrees_with_the_standard_library() {
        for x in (-1010..=1010).map(|step| step as f32 * 1e-3) {
            assert!((acos(x) - crate::math::safe_acos(x)).abs() < 2e-6, "{x}");
        }
    }
}

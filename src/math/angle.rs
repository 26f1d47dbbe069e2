//! Sine, cosine and arc tangent by polynomials that the compiler can inline. Unlike the standard library's, they need no
//! range reduction for large angles, and no branches.

use super::approx::ROUNDER;
use std::f32::consts::{FRAC_2_PI, FRAC_PI_2, PI};

/// A quarter turn in two parts (Cody and Waite 1980): products of the first with small whole numbers are exact.
const QUARTER_HIGH: f32 = 1.570_312_5;
const QUARTER_LOW: f32 = 4.838_268e-4;

/// Returns sine and cosine of an angle in -pi/4..pi/4, within 1.2e-7 (the minimax polynomials of Moshier's Cephes
/// library).
#[inline(always)]
pub fn sin_cos_eighth(angle_rad: f32) -> (f32, f32) {
    let x2 = angle_rad * angle_rad;
    let sin = ((-1.951_529_6e-4 * x2 + 8.332_161e-3) * x2 - 1.666_665_5e-1) * x2 * angle_rad + angle_rad;
    let cos = ((2.443_315_7e-5 * x2 - 1.388_731_6e-3) * x2 + 4.166_664_6e-2) * x2 * x2 - 0.5 * x2 + 1.0;
    (sin, cos)
}

/// Returns sine and cosine of 2 pi u for `u` in 0..1, within 1.2e-7.
#[inline(always)]
pub fn sin_cos_turn(u: f32) -> (f32, f32) {
    let quarter = (4.0 * u + 0.5) as i32;
    // The difference is exact: both are small multiples of the same power of two.
    let (sin, cos) = sin_cos_eighth((4.0 * u - quarter as f32) * FRAC_PI_2);
    let (sin, cos) = if quarter & 1 == 0 { (sin, cos) } else { (cos, -sin) };
    if quarter & 2 == 0 { (sin, cos) } else { (-sin, -cos) }
}

/// Returns sine and cosine of an angle in -4 pi..4 pi, within 2e-7.
#[inline(always)]
pub fn sin_cos(angle_rad: f32) -> (f32, f32) {
    // The number of quarter turns is in the last bits
    let rounded = angle_rad * FRAC_2_PI + ROUNDER;
    let quarters = rounded - ROUNDER;
    let (sin, cos) = sin_cos_eighth((angle_rad - quarters * QUARTER_HIGH) - quarters * QUARTER_LOW);
    let (sin, cos) = if rounded.to_bits() & 1 == 0 { (sin, cos) } else { (cos, -sin) };
    if rounded.to_bits() & 2 == 0 { (sin, cos) } else { (-sin, -cos) }
}

/// Returns the angle of a point from the X axis, -pi to pi, within 3e-7 (Hastings's polynomial, Abramowitz and Stegun
/// 4.4.49); relative to the angle near 0. 0 for the origin.
#[inline(always)]
pub fn atan2(y: f32, x: f32) -> f32 {
    let (along, across) = (x.abs(), y.abs());
    let (low, high) = if across > along { (along, across) } else { (across, along) };
    let t = low / high.max(f32::MIN_POSITIVE);
    let t2 = t * t;
    let high_terms = -0.075_289_64 + t2 * (0.042_909_614 + t2 * (-0.016_165_737 + t2 * 0.002_866_225_7));
    let low_terms = -0.333_331_45 + t2 * (0.199_935_51 + t2 * (-0.142_089 + t2 * (0.106_562_64 + t2 * high_terms)));
    let eighth = t + t * t2 * low_terms;
    let quarter = if across > along { FRAC_PI_2 - eighth } else { eighth };
    let half = if x < 0.0 { PI - quarter } else { quarter };
    half.copysign(y)
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::f64::consts::TAU;

    #[test]
    fn the_arc_tangent_is_within_its_error_bound() {
        for i in 0..1_000_000 {
            let (sin, cos) = (f64::from(i) / 1e6 * TAU - TAU / 2.0).sin_cos();
            let (y, x) = ((sin * 3.7) as f32, (cos * 3.7) as f32);
            let exact = f64::from(y).atan2(f64::from(x));
            let error = (f64::from(atan2(y, x)) - exact).abs();
            assert!(error < 3e-7 && error < 1e-6 * exact.abs() + 1e-12, "{y} {x}: {error}");
        }
        assert_eq!((atan2(0.0, 0.0), atan2(1.0, 0.0), atan2(0.0, -1.0)), (0.0, FRAC_PI_2, PI));
        assert_eq!((atan2(1e-30, 1.0), atan2(f32::MAX, f32::MAX)), (1e-30, FRAC_PI_2 / 2.0));
    }

    #[test]
    fn sine_and_cosine_are_within_their_error_bound() {
        for i in 0..=1_000_000 {
            let u = i as f32 / 1e6;
            let (sin, cos) = sin_cos_turn(u);
            let (exact_sin, exact_cos) = (f64::from(u) * TAU).sin_cos();
            let error = (f64::from(sin) - exact_sin).abs().max((f64::from(cos) - exact_cos).abs());
            assert!(error < 1.2e-7, "{u}: {error}");
        }
        for i in -2_000_000..=2_000_000 {
            let angle = i as f32 / 2e6 * 2.0 * TAU as f32;
            let (sin, cos) = sin_cos(angle);
            let (exact_sin, exact_cos) = f64::from(angle).sin_cos();
            let error = (f64::from(sin) - exact_sin).abs().max((f64::from(cos) - exact_cos).abs());
            assert!(error < 2e-7, "{angle}: {error}");
        }
    }
}

//! Sine and cosine for sampling warps, by polynomials that the compiler can inline. Unlike the standard library, they
//! need no range reduction for large angles.

use std::f32::consts::FRAC_PI_2;

/// Returns sine and cosine of an angle in -pi/4..pi/4, within 1.2e-7 (the minimax polynomials of Moshier's Cephes
/// library).
#[inline]
pub fn sin_cos_eighth(angle_rad: f32) -> (f32, f32) {
    let x2 = angle_rad * angle_rad;
    let sin = ((-1.951_529_6e-4 * x2 + 8.332_161e-3) * x2 - 1.666_665_5e-1) * x2 * angle_rad + angle_rad;
    let cos = ((2.443_315_7e-5 * x2 - 1.388_731_6e-3) * x2 + 4.166_664_6e-2) * x2 * x2 - 0.5 * x2 + 1.0;
    (sin, cos)
}

/// Returns sine and cosine of 2 pi u for `u` in 0..1, within 1.2e-7.
#[inline]
pub fn sin_cos_turn(u: f32) -> (f32, f32) {
    let quarter = (4.0 * u + 0.5) as u32;
    // The difference is exact: both are small multiples of the same power of two.
    let (sin, cos) = sin_cos_eighth((4.0 * u - quarter as f32) * FRAC_PI_2);
    let (sin, cos) = if quarter & 1 == 0 { (sin, cos) } else { (cos, -sin) };
    if quarter & 2 == 0 { (sin, cos) } else { (-sin, -cos) }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::f64::consts::TAU;

    #[test]
    fn sine_and_cosine_are_within_their_error_bound() {
        for i in 0..=1_000_000 {
            let u = i as f32 / 1e6;
            let (sin, cos) = sin_cos_turn(u);
            let (exact_sin, exact_cos) = (f64::from(u) * TAU).sin_cos();
            let error = (f64::from(sin) - exact_sin).abs().max((f64::from(cos) - exact_cos).abs());
            assert!(error < 1.2e-7, "{u}: {error}");
        }
    }
}

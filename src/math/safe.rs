//! Square roots and angles that a rounding error cannot turn into NaN.

use glam::Vec3;

/// Square root, 0 for negative arguments and NaN.
pub fn safe_sqrt(x: f32) -> f32 {
    x.max(0.0).sqrt()
}

/// Arc cosine with the argument clamped to [-1, 1].
pub fn safe_acos(x: f32) -> f32 {
    x.clamp(-1.0, 1.0).acos()
}

/// Angle between two vectors of any length, radians; exact also near 0 and pi (Kahan). 0 if one is zero.
pub fn angle_between(a: Vec3, b: Vec3) -> f32 {
    let (a, b) = (a.normalize_or_zero(), b.normalize_or_zero());
    2.0 * (a - b).length().atan2((a + b).length())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn rounding_errors_do_not_become_nan() {
        assert_eq!(safe_sqrt(-1e-9), 0.0);
        assert_eq!(safe_sqrt(f32::NAN), 0.0);
        assert_eq!(safe_acos(1.000_000_1), 0.0);
    }

    #[test]
    fn small_angles_keep_their_digits() {
        let tiny = angle_between(Vec3::X, Vec3::new(1.0, 1e-5, 0.0));
        assert!((tiny - 1e-5).abs() < 1e-10);
        assert_eq!(angle_between(Vec3::X, Vec3::ZERO), 2.0 * 1.0_f32.atan2(1.0));
    }
}

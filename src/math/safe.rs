//! Square roots and angles that are not NaN after rounding errors.

use glam::Vec3;

/// Returns the square root; 0 for negative arguments and NaN.
#[inline(always)]
pub fn safe_sqrt(x: f32) -> f32 {
    x.max(0.0).sqrt()
}

/// Returns the arc cosine of the argument clamped to [-1, 1].
pub fn safe_acos(x: f32) -> f32 {
    x.clamp(-1.0, 1.0).acos()
}

/// Returns the angle between two vectors of any length, radians; precise near 0 and pi (Kahan 2006, "How Futile are
/// Mindless Assessments of Roundoff", section 12). pi/2 if one is zero.
pub fn angle_between(a: Vec3, b: Vec3) -> f32 {
    let (a, b) = (a.normalize_or_zero(), b.normalize_or_zero());
    2.0 * (a - b).length().atan2((a + b).length())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn rounding_errors_do_not_give_nan() {
        assert_eq!(safe_sqrt(-1e-9), 0.0);
        assert_eq!(safe_sqrt(f32::NAN), 0.0);
        assert_eq!(safe_acos(1.000_000_1), 0.0);
    }

    #[test]
    fn small_angles_are_precise() {
        let tiny = angle_between(Vec3::X, Vec3::new(1.0, 1e-5, 0.0));
        assert!((tiny - 1e-5).abs() < 1e-10);
        assert_eq!(angle_between(Vec3::X, Vec3::ZERO), 2.0 * 1.0_f32.atan2(1.0));
    }
}

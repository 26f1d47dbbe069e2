//! Rays, and the error bounds that let them leave a surface without hitting it again.

use glam::Vec3;

/// A half-line with an upper end, in whatever space the caller says.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Ray {
    /// Start.
    pub origin: Vec3,
    /// Direction, of any length; `t` counts in multiples of it.
    pub direction: Vec3,
    /// Hits at or beyond this are not wanted.
    pub t_max: f32,
}

/// Bound on the relative error of `n` rounded operations (Higham): n eps / (1 - n eps), eps half an ulp of 1.
pub const fn gamma(n: i32) -> f32 {
    let bound = n as f32 * (f32::EPSILON * 0.5);
    bound / (1.0 - bound)
}

/// Moves a surface point with the absolute error `error` (each axis) off the surface, along `normal` or against it,
/// whichever side `direction` leaves to. The result is on the right side for every true position inside the error box
/// (Pharr, Jakob, Humphreys, "Physically Based Rendering", 4th ed., section 6.8.6).
pub fn offset_origin(point: Vec3, error: Vec3, normal: Vec3, direction: Vec3) -> Vec3 {
    let distance = normal.abs().dot(error);
    let offset = if direction.dot(normal) < 0.0 { -normal * distance } else { normal * distance };
    let moved = point + offset;
    // Round away from the surface, so that rounding cannot undo the move.
    Vec3::new(round_along(moved.x, offset.x), round_along(moved.y, offset.y), round_along(moved.z, offset.z))
}

fn round_along(value: f32, towards: f32) -> f32 {
    if towards > 0.0 {
        value.next_up()
    } else if towards < 0.0 {
        value.next_down()
    } else {
        value
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_moved_point_leaves_the_error_box_on_the_right_side() {
        let normal = Vec3::new(0.6, 0.0, 0.8);
        let point = Vec3::new(10.0, -3.0, 2.0);
        let error = Vec3::splat(1e-5);
        for side in [1.0, -1.0] {
            let moved = offset_origin(point, error, normal, normal * side);
            let worst_corner = point + (normal * side).signum() * error;
            assert!((moved - worst_corner).dot(normal) * side >= -1e-6);
        }
    }
}

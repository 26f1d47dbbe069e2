//! Rays, and the error bounds that prevent self-intersection.

use glam::Vec3;

/// A ray with an upper end, in the space of the caller.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Ray {
    /// Origin.
    pub origin: Vec3,
    /// Direction of any length; distances `t` are multiples of it.
    pub direction: Vec3,
    /// End of the ray: hits at or beyond it are discarded.
    pub t_max: f32,
}

/// Returns the bound on the relative error of `n` rounded operations, n eps / (1 - n eps), with eps half an ulp of 1
/// (Higham 2002, "Accuracy and Stability of Numerical Algorithms", section 3.1).
pub const fn gamma(n: i32) -> f32 {
    let bound = n as f32 * (f32::EPSILON * 0.5);
    bound / (1.0 - bound)
}

/// Offsets the origin of a ray that leaves a surface in `direction`. `error` is the absolute error bound of `point`
/// along each axis. The result is on the side of `direction` for every position inside the error box (Pharr, Jakob and
/// Humphreys, "Physically Based Rendering", 4th ed., section 6.8.6).
pub fn offset_origin(point: Vec3, error: Vec3, normal: Vec3, direction: Vec3) -> Vec3 {
    let distance = normal.abs().dot(error);
    let offset = if direction.dot(normal) < 0.0 { -normal * distance } else { normal * distance };
    let origin = point + offset;
    // Round away from the surface, so that rounding does not undo the offset.
    Vec3::new(round_along(origin.x, offset.x), round_along(origin.y, offset.y), round_along(origin.z, offset.z))
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
    fn the_offset_origin_is_outside_the_error_box_on_the_right_side() {
        let normal = Vec3::new(0.6, 0.0, 0.8);
        let point = Vec3::new(10.0, -3.0, 2.0);
        let error = Vec3::splat(1e-5);
        for side in [1.0, -1.0] {
            let origin = offset_origin(point, error, normal, normal * side);
            let worst_corner = point + (normal * side).signum() * error;
            assert!((origin - worst_corner).dot(normal) * side >= -1e-6);
        }
    }
}

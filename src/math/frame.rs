//! Orthonormal frames.

use glam::{Affine3A, Vec3};

/// Returns tangent and bitangent of a right-handed basis with `normal` as third axis: `t x b = n` (Duff et al. 2017,
/// "Building an Orthonormal Basis, Revisited").
pub fn orthonormal_basis(normal: Vec3) -> (Vec3, Vec3) {
    let sign = 1.0_f32.copysign(normal.z);
    let a = -1.0 / (sign + normal.z);
    let b = normal.x * normal.y * a;
    let tangent = Vec3::new(1.0 + sign * normal.x * normal.x * a, sign * b, -sign * normal.x);
    let bitangent = Vec3::new(b, sign + normal.y * normal.y * a, -normal.y);
    (tangent, bitangent)
}

/// Returns the frame at `eye` that looks along its -Z at `target`; see [`look_along`]. `target == eye` looks along world
/// -Z.
pub fn look_at(eye: Vec3, target: Vec3, roll_rad: f32) -> Affine3A {
    look_along(eye, target - eye, roll_rad)
}

/// Returns the frame at `eye` that looks along its -Z in the direction `ahead`, of any length, with world +Y up, rotated
/// by `roll_rad` about its own Z. The frame is finite for all arguments: vertical directions use world -Z or +Z as up,
/// the zero vector looks along world -Z.
pub fn look_along(eye: Vec3, ahead: Vec3, roll_rad: f32) -> Affine3A {
    let back = (-ahead).try_normalize().unwrap_or(Vec3::Z);
    let right = Vec3::Y.cross(back);
    let right = if right.length_squared() > 1e-10 { right.normalize() } else { Vec3::X };
    let up = back.cross(right);
    let (sin, cos) = roll_rad.sin_cos();
    Affine3A::from_mat3_translation(glam::Mat3::from_cols(right * cos + up * sin, up * cos - right * sin, back), eye)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn bases_are_orthonormal_at_both_poles() {
        for n in [Vec3::Z, Vec3::NEG_Z, Vec3::X, Vec3::new(1.0, -2.0, -3.0).normalize()] {
            let (t, b) = orthonormal_basis(n);
            assert!(t.dot(b).abs() < 1e-6 && t.dot(n).abs() < 1e-6 && b.dot(n).abs() < 1e-6);
            assert!((t.cross(b) - n).length() < 1e-6);
        }
    }

    #[test]
    fn frames_that_look_straight_up_are_finite_and_right_handed() {
        for target in [Vec3::Y, Vec3::NEG_Y, Vec3::ZERO, Vec3::X] {
            let frame = look_at(Vec3::ZERO, target, 0.3);
            let m = frame.matrix3;
            assert!(frame.is_finite());
            assert!((glam::Mat3::from(m).determinant() - 1.0).abs() < 1e-5);
            assert!(target == Vec3::ZERO || (Vec3::from(m.z_axis) + target).length() < 1e-6);
        }
    }
}

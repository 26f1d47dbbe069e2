//! Skinning: vertices follow the bones by blended dual quaternions (Kavan et al. 2007, "Skinning with Dual
//! Quaternions"), which keep the volume of twisted joints.

use super::body_data::{BodyData, BoneWeights};
use glam::{Affine3A, Quat, Vec3};
use rayon::prelude::*;

/// A rigid motion as a dual quaternion.
#[derive(Clone, Copy, Debug)]
struct DualQuat {
    real: Quat,
    dual: Quat,
}

impl DualQuat {
    fn new(transform: &Affine3A) -> DualQuat {
        let real = Quat::from_mat3a(&transform.matrix3).normalize();
        let t = transform.translation;
        DualQuat { real, dual: Quat::from_xyzw(t.x, t.y, t.z, 0.0) * real * 0.5 }
    }

    fn transform_point(&self, point: Vec3) -> Vec3 {
        let scale = 1.0 / self.real.length();
        let (real, dual) = (self.real * scale, self.dual * scale);
        let shift = dual * real.conjugate();
        real * point + Vec3::new(shift.x, shift.y, shift.z) * 2.0
    }
}

/// Returns the vertices moved by their bones' transforms (world from rest).
pub fn skin(data: &BodyData, rest: &[Vec3], transforms: &[Affine3A]) -> Vec<Vec3> {
    let bones: Vec<DualQuat> = transforms.iter().map(DualQuat::new).collect();
    let moved = |(position, weights): (&Vec3, &BoneWeights)| blend(&bones, weights).transform_point(*position);
    rest.par_iter().zip(&data.weights).map(moved).collect()
}

/// Returns the weighted sum of the bones' motions. Quaternions of opposite sign are the same rotation: each takes the
/// sign of the first.
fn blend(bones: &[DualQuat], weights: &BoneWeights) -> DualQuat {
    let first = bones[usize::from(weights[0].0)];
    let mut sum = DualQuat { real: Quat::from_xyzw(0.0, 0.0, 0.0, 0.0), dual: Quat::from_xyzw(0.0, 0.0, 0.0, 0.0) };
    for &(bone, weight) in weights.iter().filter(|(_, weight)| *weight > 0) {
        let motion = bones[usize::from(bone)];
        let weight = f32::from(weight) / 255.0 * if motion.real.dot(first.real) < 0.0 { -1.0 } else { 1.0 };
        sum = DualQuat { real: sum.real + motion.real * weight, dual: sum.dual + motion.dual * weight };
    }
    sum
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_vertex_of_one_bone_moves_with_it_and_a_twist_keeps_the_radius() {
        let transform = Affine3A::from_rotation_translation(Quat::from_rotation_y(1.2), Vec3::new(0.3, -0.1, 2.0));
        let bones = [transform, Affine3A::from_rotation_x(3.0)].map(|t| DualQuat::new(&t));
        let point = Vec3::new(0.2, 1.4, -0.3);
        let moved = blend(&bones, &[(0, 255), (0, 0), (0, 0), (0, 0)]).transform_point(point);
        assert!(moved.distance(transform.transform_point3(point)) < 1e-5);
        // Halfway between no twist and 170 degrees about the limb, linear blending would shrink the radius to 9 %.
        let twist = [Affine3A::IDENTITY, Affine3A::from_rotation_y(170_f32.to_radians())].map(|t| DualQuat::new(&t));
        let middle = blend(&twist, &[(0, 128), (1, 127), (0, 0), (0, 0)]).transform_point(Vec3::new(0.05, 0.3, 0.0));
        assert!((Vec3::new(middle.x, 0.0, middle.z).length() - 0.05).abs() < 1e-5, "{middle}");
    }
}

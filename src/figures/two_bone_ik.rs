//! Inverse kinematics of two bones: the joint between a fixed root and a wanted end, in closed form.

use glam::{Mat3, Quat, Vec3};

/// Two bones from a root, which bend towards the pole.
#[derive(Clone, Copy, Debug)]
pub struct Chain {
    /// Place of the first joint.
    pub root: Vec3,
    /// Lengths of the bones.
    pub lengths: [f32; 2],
    /// Direction in which the middle joint lies from the line between root and end.
    pub pole: Vec3,
}

/// Places of the joints.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Joints {
    /// Of the joint between the bones.
    pub middle: Vec3,
    /// Of the end: the wanted one if it is within reach, else the nearest on the line to it.
    pub end: Vec3,
}

/// Returns the joints of a chain whose end is where it is wanted (law of cosines).
pub fn solve(chain: &Chain, wanted: Vec3) -> Joints {
    let [a, b] = chain.lengths;
    let to_end = wanted - chain.root;
    let distance = to_end.length().clamp((a - b).abs() * 1.001 + 1e-5, (a + b) * 0.9999);
    let along = to_end.normalize_or(Vec3::NEG_Y);
    let side = (chain.pole - along * chain.pole.dot(along)).normalize_or_zero();
    // Distance of the middle joint along the line, and from it
    let x = (distance * distance + a * a - b * b) / (2.0 * distance);
    let y = (a * a - x * x).max(0.0).sqrt();
    Joints { middle: chain.root + along * x + side * y, end: chain.root + along * distance }
}

/// Returns the rotation that takes one pair of a direction and a direction beside it to another. The first ones are
/// matched exactly.
pub fn aligned(from: [Vec3; 2], to: [Vec3; 2]) -> Quat {
    let basis = |[along, beside]: [Vec3; 2]| {
        let y = along.normalize_or(Vec3::NEG_Y);
        let x = y.cross(beside).try_normalize().unwrap_or_else(|| y.any_orthonormal_vector());
        Mat3::from_cols(x, y, x.cross(y))
    };
    Quat::from_mat3(&(basis(to) * basis(from).transpose())).normalize()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_end_is_reached_the_bones_keep_their_lengths_and_bend_towards_the_pole() {
        let chain = Chain { root: Vec3::new(0.1, 0.9, 0.0), lengths: [0.43, 0.41], pole: Vec3::Z };
        for wanted in [Vec3::new(0.1, 0.1, 0.0), Vec3::new(0.3, 0.3, 0.3), Vec3::new(0.1, 0.45, 0.45)] {
            let joints = solve(&chain, wanted);
            assert!(joints.end.distance(wanted) < 1e-5, "{joints:?}");
            assert!((joints.middle.distance(chain.root) - 0.43).abs() < 1e-5);
            assert!((joints.middle.distance(joints.end) - 0.41).abs() < 1e-5);
            let straight = (chain.root + joints.end) / 2.0;
            assert!((joints.middle - straight).dot(chain.pole) > 0.0);
        }
        let far = solve(&chain, Vec3::new(0.1, -3.0, 0.0));
        assert!((far.end.y - (0.9 - 0.84)).abs() < 1e-3, "an end out of reach is approached: {far:?}");
    }

    #[test]
    fn aligned_takes_one_pair_to_the_other() {
        let (from, to) = ([Vec3::NEG_Y, Vec3::Z], [Vec3::new(0.0, -1.0, 1.0), Vec3::new(1.0, 0.0, 0.2)]);
        let rotation = aligned(from, to);
        assert!((rotation * from[0]).distance(to[0].normalize()) < 1e-5);
        assert!((rotation * from[1]).dot(to[1]) > 0.9);
    }
}

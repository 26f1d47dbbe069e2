//! Positions of the joints in a pose.

use super::pose::{ArmPose, LegPose, PoseAngles};
use super::proportions::Build;
use glam::{Affine3A, Mat3, Quat, Vec3};

/// A side of the body: left is the figure's own left, at +X.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum BodySide {
    /// At +X.
    Left,
    /// At -X.
    Right,
}

impl BodySide {
    /// +1 for left, -1 for right.
    pub fn sign(self) -> f32 {
        match self {
            BodySide::Left => 1.0,
            BodySide::Right => -1.0,
        }
    }
}

/// An arm's joints.
#[derive(Clone, Copy, Debug)]
pub struct Arm {
    /// Side of the body.
    pub side: BodySide,
    /// Joint of the shoulder.
    pub shoulder: Vec3,
    /// Joint of the elbow.
    pub elbow: Vec3,
    /// Joint of the wrist.
    pub wrist: Vec3,
    /// Direction of the fingers.
    pub fingers: Vec3,
    /// Direction the palm faces, square to the fingers.
    pub palm: Vec3,
}

/// A leg's joints.
#[derive(Clone, Copy, Debug)]
pub struct Leg {
    /// Side of the body.
    pub side: BodySide,
    /// Joint of the hip.
    pub hip: Vec3,
    /// Joint of the knee.
    pub knee: Vec3,
    /// Joint of the ankle.
    pub ankle: Vec3,
    /// BodySide to which the knee points, square to the line from hip to ankle.
    pub front: Vec3,
    /// World from foot: origin on the floor under the ankle, +Z to the toes.
    pub foot: Affine3A,
}

/// Joints in world space. A body unit is a metre on a man of 1.80 m, and in proportion to the height of the neck on
/// other figures.
#[derive(Clone, Debug)]
pub struct Skeleton {
    /// Metres a body unit.
    pub unit: f32,
    /// World from the standing pose, for what is fixed to the pelvis.
    pub pelvis: Affine3A,
    /// World from the standing pose, for what is fixed to the waist.
    pub waist: Affine3A,
    /// World from the standing pose, for what is fixed to the chest.
    pub chest: Affine3A,
    /// World from the standing pose, for what is fixed to the neck.
    pub neck: Affine3A,
    /// World from head: origin between the eyes.
    pub head: Affine3A,
    /// Left, right.
    pub arms: [Arm; 2],
    /// Left, right.
    pub legs: [Leg; 2],
}

/// Heights of joints over the floor when standing, in body units.
pub mod rest {
    /// Root of the neck.
    pub const NECK: f32 = 1.507;
    /// Shoulder joints.
    pub const SHOULDER: f32 = 1.425;
    /// Pivot of the chest.
    pub const CHEST: f32 = 1.20;
    /// Pivot of the waist.
    pub const WAIST: f32 = 1.04;
    /// Hip joints.
    pub const HIP: f32 = 0.925;
    /// Knees.
    pub const KNEE: f32 = 0.505;
    /// Ankles.
    pub const ANKLE: f32 = 0.08;
    /// Distance of the neck's root behind the line of the shoulders.
    pub const NECK_BACK: f32 = 0.04;
    /// Upper arm.
    pub const UPPER_ARM: f32 = 0.305;
    /// Forearm.
    pub const FOREARM: f32 = 0.255;
    /// Distance of each hip joint from the middle.
    pub const HIP_OUT: f32 = 0.088;
}

/// Returns a rotation about a point.
fn about(pivot: Vec3, rotation: Quat) -> Affine3A {
    Affine3A::from_translation(pivot) * Affine3A::from_quat(rotation) * Affine3A::from_translation(-pivot)
}

impl Skeleton {
    /// Poses a skeleton.
    pub fn new(build: &Build, pose: &PoseAngles) -> Skeleton {
        let neck_height = build.height - 1.22 * build.head;
        let unit = neck_height / rest::NECK;
        let up = |y: f32| Vec3::new(0.0, y * unit, 0.0);
        let hips = up(rest::HIP);
        let pelvis = Affine3A::from_translation(hip_shift(build, pose, unit)) * about(hips, pose.pelvis.rotation());
        let waist = pelvis * about(up(rest::WAIST), pose.waist.rotation());
        let chest = waist * about(up(rest::CHEST), pose.chest.rotation());
        let neck_root = Vec3::new(0.0, neck_height, -rest::NECK_BACK * unit);
        let neck = chest * about(neck_root, pose.neck.rotation());
        let eyes = Vec3::new(0.0, build.height - 0.5 * build.head, 0.004 * unit);
        // The head rotates about the top of the spine, between and slightly below the ears.
        let nod = eyes + Vec3::new(0.0, -0.14, -0.05) * build.head;
        let head = neck * about(nod, pose.head.rotation()) * Affine3A::from_translation(eyes);
        let arm = |side: BodySide, arm: &ArmPose| pose_arm(side, arm, build, &chest, &pelvis, unit);
        let leg = |side: BodySide, leg: &LegPose| pose_leg(side, leg, build, &pelvis, unit);
        Skeleton {
            unit,
            pelvis,
            waist,
            chest,
            neck,
            head,
            arms: [arm(BodySide::Left, &pose.arms[0]), arm(BodySide::Right, &pose.arms[1])],
            legs: [leg(BodySide::Left, &pose.legs[0]), leg(BodySide::Right, &pose.legs[1])],
        }
    }

    /// Returns a box that contains the whole figure: lowest and highest corner.
    pub fn bounds(&self) -> (Vec3, Vec3) {
        let joints =
            self.arms.iter().flat_map(|a| [a.shoulder, a.elbow, a.wrist, a.wrist + a.fingers * 0.12 * self.unit]);
        let joints = joints.chain(self.legs.iter().flat_map(|l| [l.hip, l.knee, l.ankle]));
        let joints = joints.chain([Vec3::from(self.head.translation), Vec3::from(self.pelvis.translation)]);
        let (low, high) = joints.fold((Vec3::INFINITY, Vec3::NEG_INFINITY), |(low, high), p| (low.min(p), high.max(p)));
        let room = Vec3::new(0.14, 0.16, 0.26) * self.unit.max(0.9);
        ((low - room).with_y(-0.02), high + room)
    }
}

/// Returns the offset of the hips from standing, metres.
fn hip_shift(build: &Build, pose: &PoseAngles, unit: f32) -> Vec3 {
    let shift = pose.hip_shift * unit;
    let Some(seat) = pose.seat_m else { return shift };
    // The joints lie over the seat by the flesh of the thighs.
    let over_seat = 0.088 * unit * build.limb.max(0.9);
    let thigh = (rest::HIP - rest::KNEE) * unit;
    shift + Vec3::new(0.0, seat + over_seat - rest::HIP * unit, -0.97 * thigh - 0.03 * unit)
}

/// Solves two-bone inverse kinematics: returns the joint between bones of given lengths from `a` to `b`, bent towards
/// `pole`, and the unit direction of the bend. If `b` is out of reach, the bones lie straight.
fn middle_joint(a: Vec3, b: Vec3, upper: f32, lower: f32, pole: Vec3) -> (Vec3, Vec3) {
    let reach = (b - a).length().clamp((upper - lower).abs() + 1e-4, upper + lower - 1e-4);
    let along = (b - a).normalize_or(Vec3::NEG_Y);
    let bend = (pole - along * pole.dot(along)).normalize_or(Vec3::Z);
    let foot = (upper * upper - lower * lower + reach * reach) / (2.0 * reach);
    (a + along * foot + bend * (upper * upper - foot * foot).max(0.0).sqrt(), bend)
}

fn pose_arm(side: BodySide, pose: &ArmPose, build: &Build, chest: &Affine3A, pelvis: &Affine3A, unit: f32) -> Arm {
    let out = Vec3::new(side.sign(), 1.0, 1.0);
    let rest_shoulder = Vec3::new(0.5 * build.shoulder_width, rest::SHOULDER * unit, -0.012 * unit) * out;
    let shoulder = chest.transform_point3(rest_shoulder);
    let (upper, lower) = (rest::UPPER_ARM * unit, rest::FOREARM * unit);
    match *pose {
        ArmPose::Free { abduct_deg, lift_deg, elbow_deg } => {
            let (abduct, lift, bend) = (abduct_deg.to_radians(), lift_deg.to_radians(), elbow_deg.to_radians());
            let along = |lift: f32, abduct: f32| {
                let hanging = Vec3::new(abduct.sin(), -abduct.cos() * lift.cos(), abduct.cos() * lift.sin()) * out;
                chest.transform_vector3(hanging)
            };
            let elbow = shoulder + along(lift, abduct) * upper;
            let fingers = along(lift + bend, abduct * 0.55);
            let inwards = chest.transform_vector3(Vec3::new(-1.0, 0.0, -0.35) * out);
            let palm = (inwards - fingers * inwards.dot(fingers)).normalize_or(Vec3::X);
            Arm {
                side,
                shoulder,
                elbow,
                wrist: elbow + fingers * lower,
                fingers: along(lift + bend * 1.1, abduct * 0.3),
                palm,
            }
        }
        ArmPose::Laid { wrist, elbow, fingers, palm } => {
            let hips = pelvis.transform_point3(Vec3::Y * rest::HIP * unit);
            let wrist = hips + pelvis.transform_vector3(wrist * out * unit);
            let pole = chest.transform_vector3(elbow * out);
            let (elbow, _) = middle_joint(shoulder, wrist, upper, lower, pole);
            let fingers = pelvis.transform_vector3(fingers * out).normalize_or(Vec3::NEG_Y);
            let palm = pelvis.transform_vector3(palm * out);
            let palm = (palm - fingers * palm.dot(fingers)).normalize_or(Vec3::X);
            let wrist = elbow + (wrist - elbow).normalize_or(Vec3::NEG_Y) * lower;
            Arm { side, shoulder, elbow, wrist, fingers, palm }
        }
    }
}

fn pose_leg(side: BodySide, pose: &LegPose, build: &Build, pelvis: &Affine3A, unit: f32) -> Leg {
    let sign = side.sign();
    let out = rest::HIP_OUT * unit * (0.6 + 0.4 * build.hip_width / (0.335 * unit));
    let hip = pelvis.transform_point3(Vec3::new(sign * out, rest::HIP * unit, 0.0));
    let yaw = Quat::from_rotation_y(sign * pose.toes_out_deg.to_radians());
    let ankle_height = rest::ANKLE * unit;
    let floor = Vec3::new(sign * pose.ankle.x, 0.0, pose.ankle.y) * unit;
    let ankle = floor + Vec3::Y * ankle_height;
    let knee_yaw = Quat::from_rotation_y(sign * pose.knee_out_deg.to_radians());
    let pole = knee_yaw * yaw * Vec3::new(0.0, 0.25, 1.0);
    // Slightly longer than the distance, so that a straight leg keeps a defined knee.
    let (upper, lower) = ((rest::HIP - rest::KNEE) * unit * 1.004, (rest::KNEE - rest::ANKLE) * unit * 1.004);
    let (knee, front) = middle_joint(hip, ankle, upper, lower, pole);
    let foot = Affine3A::from_mat3_translation(Mat3::from_quat(yaw), floor);
    Leg { side, hip, knee, ankle, front, foot }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn two_bones_keep_their_lengths() {
        let (a, b) = (Vec3::new(0.1, 0.9, 0.0), Vec3::new(0.15, 0.1, 0.1));
        let (knee, bend) = middle_joint(a, b, 0.45, 0.42, Vec3::Z);
        assert!(((knee - a).length() - 0.45).abs() < 1e-5 && ((b - knee).length() - 0.42).abs() < 1e-5);
        assert!(bend.z > 0.9);
    }

    #[test]
    fn bones_that_cannot_reach_lie_straight() {
        let (knee, _) = middle_joint(Vec3::ZERO, Vec3::X * 2.0, 0.5, 0.5, Vec3::Y);
        assert!(knee.is_finite() && knee.y < 0.02);
    }
}

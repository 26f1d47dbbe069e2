//! The posed skeleton: a rotation and a position for every bone.
//!
//! Rotations are about the axes of the rest pose, which are those of the world: X to the figure's left, Y up, Z forwards.

use super::body_data::BodyData;
use super::two_bone_ik::{Chain, aligned, solve};
use crate::scene::{Arm, Figure, Leg, Torso};
use glam::{Affine3A, EulerRot, Quat, Vec2, Vec3};

/// Bones of the spine, from the pelvis up.
const SPINE: [&str; 5] = ["spine05", "spine04", "spine03", "spine02", "spine01"];
const NECK: [&str; 3] = ["neck01", "neck02", "neck03"];
/// Part of the head's turn that the neck makes.
const NECK_SHARE: f32 = 0.45;
/// Straightest leg, as a part of its length: a locked knee looks stiff and makes the direction of the knee unsteady.
const REACH: f32 = 0.995;
/// Height of the pelvis over the seat, as a part of the distance from the pelvis to the knee.
const SEAT_DEPTH: f32 = 0.2;
/// Angle of the arms in the rest pose, degrees, and the part of an arm's angle by which its shoulder rises.
const HALF_RAISED_DEG: f32 = 40.0;
const SHOULDER_SHARE: f32 = 0.25;
/// Bend of a finger joint of a fist, degrees.
const FIST_DEG: f32 = 78.0;

/// A side of the body.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Side {
    /// The figure's own left, +X.
    Left,
    /// The figure's own right.
    Right,
}

impl Side {
    /// Both sides, in the order of pairs.
    pub const BOTH: [Side; 2] = [Side::Left, Side::Right];

    /// Returns 1 for left and -1 for right.
    fn sign(self) -> f32 {
        match self {
            Side::Left => 1.0,
            Side::Right => -1.0,
        }
    }

    /// Returns the name of a bone of this side.
    pub fn bone(self, stem: &str) -> String {
        format!("{stem}.{}", if self == Side::Left { "L" } else { "R" })
    }
}

/// Positions of the bones' ends in the rest pose.
#[derive(Clone, Debug)]
struct RestBones<'a> {
    data: &'a BodyData,
    positions: &'a [Vec3],
}

impl RestBones<'_> {
    fn head(&self, bone: &str) -> Vec3 {
        self.end(bone, |bone| bone.head)
    }

    fn tail(&self, bone: &str) -> Vec3 {
        self.end(bone, |bone| bone.tail)
    }

    fn end(&self, bone: &str, end: impl Fn(&super::body_data::Bone) -> u16) -> Vec3 {
        let bone = self.data.bone(bone).map(|index| &self.data.bones[index]);
        bone.map_or(Vec3::ZERO, |bone| self.positions[usize::from(end(bone))])
    }
}

/// A skeleton in a pose.
#[derive(Clone, Debug)]
pub struct Skeleton {
    /// World from rest for each bone of the body data.
    pub transforms: Vec<Affine3A>,
}

impl Skeleton {
    /// Poses the bones of a body. `positions` are those of the rest pose.
    pub fn new(data: &BodyData, positions: &[Vec3], figure: &Figure) -> Skeleton {
        let rest = RestBones { data, positions };
        let pose = &figure.pose;
        // Turn the joints of trunk and arms
        let mut turns = Turns { data, local: vec![Quat::IDENTITY; data.bones.len()] };
        turns.torso(&pose.torso);
        for (side, arm) in Side::BOTH.into_iter().zip(&pose.arms) {
            turns.arm(&rest, side, arm);
        }
        // Place the pelvis over the feet or on the seat, then the legs
        let pelvis_turn = turns.global("root");
        let feet = Side::BOTH.map(|side| Foot::new(&rest, side, &pose.legs[side as usize]));
        let pelvis = place_pelvis(&rest, pelvis_turn, &feet, figure);
        for foot in &feet {
            turns.leg(&rest, foot, pelvis, pelvis_turn);
        }
        // Chain the bones
        let mut transforms: Vec<Affine3A> = Vec::with_capacity(data.bones.len());
        for (bone, local) in data.bones.iter().zip(&turns.local) {
            let head = positions[usize::from(bone.head)];
            let transform = match bone.parent {
                None => about(rest.head("pelvis.L"), *local, pelvis),
                Some(parent) => {
                    let parent = transforms[usize::from(parent)];
                    let turned = Quat::from_mat3a(&parent.matrix3) * *local;
                    about(head, turned, parent.transform_point3(head))
                }
            };
            transforms.push(transform);
        }
        Skeleton { transforms }
    }
}

/// Returns the transform that turns about a rest point and moves it to a place.
fn about(rest_point: Vec3, turn: Quat, place: Vec3) -> Affine3A {
    Affine3A::from_translation(place) * Affine3A::from_quat(turn) * Affine3A::from_translation(-rest_point)
}

/// Returns the rotation by pitch (forwards), yaw (to the left) and roll (left side up), degrees.
fn turn(pitch_deg: f32, yaw_deg: f32, roll_deg: f32) -> Quat {
    let [pitch, yaw, roll] = [pitch_deg, yaw_deg, roll_deg].map(f32::to_radians);
    Quat::from_euler(EulerRot::YXZ, yaw, pitch, roll)
}

/// Returns the part `share` of a rotation.
fn part(rotation: Quat, share: f32) -> Quat {
    Quat::IDENTITY.slerp(rotation, share)
}

/// The rotation of each bone against its parent.
struct Turns<'a> {
    data: &'a BodyData,
    local: Vec<Quat>,
}

impl Turns<'_> {
    fn set(&mut self, bone: &str, turn: Quat) {
        if let Some(index) = self.data.bone(bone) {
            self.local[index] = turn;
        }
    }

    /// Returns the rotation of a bone in the world.
    fn global(&self, bone: &str) -> Quat {
        let mut turn = Quat::IDENTITY;
        let mut next = self.data.bone(bone);
        while let Some(index) = next {
            turn = self.local[index] * turn;
            next = self.data.bones[index].parent.map(usize::from);
        }
        turn
    }

    fn torso(&mut self, t: &Torso) {
        self.set("root", turn(t.pelvis_pitch_deg, t.pelvis_yaw_deg, t.pelvis_roll_deg));
        let chest = turn(t.chest_pitch_deg, t.chest_yaw_deg, t.chest_roll_deg);
        for bone in SPINE {
            self.set(bone, part(chest, 1.0 / SPINE.len() as f32));
        }
        let head = turn(t.head_pitch_deg, t.head_yaw_deg, t.head_roll_deg);
        for bone in NECK {
            self.set(bone, part(head, NECK_SHARE / NECK.len() as f32));
        }
        self.set("head", part(head, 1.0 - NECK_SHARE));
    }

    fn arm(&mut self, rest: &RestBones, side: Side, arm: &Arm) {
        let sign = side.sign();
        let bone = |stem: &str| side.bone(stem);
        // The shoulder rises with the arm: the rest pose is that of arms half raised
        let raised = Vec2::new(arm.out_deg, arm.forward_deg).max(Vec2::ZERO).length();
        let lift = arm.shoulder_deg + SHOULDER_SHARE * (raised - HALF_RAISED_DEG);
        let shoulder = Quat::from_rotation_z(sign * lift.to_radians());
        self.set(&bone("clavicle"), shoulder);
        // Upper arm: from the rest direction to hanging, twisted, then out and forwards
        let (top, elbow, wrist) =
            (rest.head(&bone("upperarm01")), rest.head(&bone("lowerarm01")), rest.head(&bone("wrist")));
        let along = (elbow - top).normalize_or_zero();
        let hang = Quat::from_rotation_arc(along, Vec3::NEG_Y);
        let out = Quat::from_rotation_z(sign * arm.out_deg.to_radians());
        let forward = Quat::from_rotation_x(-arm.forward_deg.to_radians());
        let twist = Quat::from_rotation_y(sign * arm.twist_deg.to_radians());
        // Half of it turns the top of the shoulder, which bulges otherwise
        let upper_arm = shoulder.inverse() * forward * out * twist * hang;
        let half = part(upper_arm, 0.5);
        self.set(&bone("shoulder01"), half);
        self.set(&bone("upperarm01"), half.inverse() * upper_arm);
        // Elbow: a hinge that bends the forearm forwards; the rest pose is bent already
        let forearm = (wrist - elbow).normalize_or_zero();
        let hinge = along.cross(forearm).normalize_or(Vec3::NEG_X);
        let bent = along.angle_between(forearm);
        self.set(&bone("lowerarm01"), Quat::from_axis_angle(hinge, arm.elbow_deg.to_radians() - bent));
        // Forearm and wrist
        let roll = Quat::from_axis_angle(forearm, -sign * arm.forearm_deg.to_radians());
        self.set(&bone("lowerarm02"), part(roll, 0.5));
        let knuckles = rest.head(&bone("finger2-1")) - rest.head(&bone("finger5-1"));
        let across = (knuckles - forearm * knuckles.dot(forearm)).normalize_or(Vec3::Z);
        let flex = Quat::from_axis_angle(across, sign * arm.wrist_deg.to_radians());
        self.set(&bone("wrist"), flex * part(roll, 0.5));
        self.fingers(rest, side, arm.fingers);
    }

    /// Bends all fingers to a part of a fist. A finger bends about the axis across its own rest curl.
    fn fingers(&mut self, rest: &RestBones, side: Side, fist: f32) {
        let palm_across = rest.head(&side.bone("finger2-1")) - rest.head(&side.bone("finger5-1"));
        for finger in 1..=5 {
            let joint = |k: usize| side.bone(&format!("finger{finger}-{k}"));
            let first = (rest.tail(&joint(1)) - rest.head(&joint(1))).normalize_or_zero();
            let last = (rest.tail(&joint(3)) - rest.head(&joint(3))).normalize_or_zero();
            let curl = first.cross(last);
            let axis = if finger == 1 { curl } else { palm_across * curl.dot(palm_across).signum() };
            let axis = axis.normalize_or(Vec3::X);
            let bent = first.angle_between(last) / 2.0;
            let share = if finger == 1 { 0.45 } else { 1.0 };
            for k in 1..=3 {
                let wanted = fist * FIST_DEG.to_radians() * share;
                let rest_bend = if k == 1 { 0.0 } else { bent };
                self.set(&joint(k), Quat::from_axis_angle(axis, wanted - rest_bend));
            }
        }
    }

    /// Bends hip and knee so that the ankle is where the foot wants it, and keeps the sole level.
    fn leg(&mut self, rest: &RestBones, foot: &Foot, pelvis: Vec3, pelvis_turn: Quat) {
        let bone = |stem: &str| foot.side.bone(stem);
        let [hip, knee, ankle] = foot.rest_joints;
        let top = pelvis + pelvis_turn * (hip - rest.head("pelvis.L"));
        let chain = Chain { root: top, lengths: [hip.distance(knee), knee.distance(ankle)], pole: foot.knee_direction };
        let bent = solve(&chain, foot.ankle);
        let thigh = aligned([knee - hip, Vec3::Z], [bent.middle - top, foot.knee_direction]);
        let shank = aligned([ankle - knee, Vec3::Z], [bent.end - bent.middle, foot.knee_direction]);
        self.set(&bone("upperleg01"), pelvis_turn.inverse() * thigh);
        self.set(&bone("lowerleg01"), thigh.inverse() * shank);
        self.set(&bone("foot"), shank.inverse() * foot.turn);
        self.set(&bone("toe1-1"), Quat::from_rotation_x(-foot.heel));
    }
}

/// The place of a foot.
struct Foot {
    side: Side,
    /// Hip, knee and ankle of the rest pose.
    rest_joints: [Vec3; 3],
    /// Place of the ankle, before the figure is put on the floor; the floor is at height 0.
    ankle: Vec3,
    /// Direction of the knee from the line between hip and ankle, unit.
    knee_direction: Vec3,
    turn: Quat,
    /// Angle of the raised heel, radians.
    heel: f32,
}

impl Foot {
    fn new(rest: &RestBones, side: Side, leg: &Leg) -> Foot {
        let rest_joints = ["upperleg01", "lowerleg01", "foot"].map(|stem| rest.head(&side.bone(stem)));
        let sign = side.sign();
        let yaw = Quat::from_rotation_y(sign * leg.toes_out_deg.to_radians());
        let heel = leg.heel_deg.to_radians();
        let turn = yaw * Quat::from_rotation_x(heel);
        let [.., ankle] = rest_joints;
        // A raised heel turns about the ball of the foot.
        let ball = rest.tail(&side.bone("foot")) - ankle;
        let lifted = yaw * (ball - Quat::from_rotation_x(heel) * ball);
        let ankle = Vec3::new(sign * leg.out_m, ankle.y + leg.up_m, ankle.z + leg.forward_m) + lifted;
        let knee_yaw = sign * (leg.toes_out_deg + leg.knee_out_deg).to_radians();
        Foot { side, rest_joints, ankle, knee_direction: Quat::from_rotation_y(knee_yaw) * Vec3::Z, turn, heel }
    }
}

/// Returns the place of the pelvis: over the seat and a thigh's length behind the feet, or as high as the shorter leg allows.
fn place_pelvis(rest: &RestBones, turn: Quat, feet: &[Foot; 2], figure: &Figure) -> Vec3 {
    let pose = &figure.pose;
    let pelvis = rest.head("pelvis.L");
    let across = Vec3::new(pose.torso.pelvis_left_m, 0.0, pelvis.z);
    if let Some(seat_m) = pose.seat_m {
        let [hip, knee, _] = feet[0].rest_joints;
        let thigh = hip.distance(knee);
        return across + Vec3::new(0.0, seat_m + SEAT_DEPTH * thigh + (pelvis.y - hip.y), -thigh);
    }
    let highest = |foot: &Foot| {
        let [hip, knee, ankle] = foot.rest_joints;
        let to_hip = turn * (hip - pelvis);
        let length = (hip.distance(knee) + knee.distance(ankle)) * REACH;
        let level = (across + to_hip - foot.ankle) * Vec3::new(1.0, 0.0, 1.0);
        foot.ankle.y + (length * length - level.length_squared()).max(0.0).sqrt() - to_hip.y
    };
    // A foot that is raised on purpose does not pull the pelvis up.
    across + Vec3::Y * feet.iter().map(highest).fold(f32::INFINITY, f32::min)
}

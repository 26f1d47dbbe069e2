//! Poses: rotations of the joints, positions of feet and hands.

use crate::scene::{Figure, Pose};
use glam::{EulerRot, Quat, Vec2, Vec3};

/// The rotation of a joint, degrees.
#[derive(Clone, Copy, Debug, PartialEq, Default)]
pub struct Turn {
    /// Forwards.
    pub pitch_deg: f32,
    /// To the figure's own left.
    pub yaw_deg: f32,
    /// The left side upwards.
    pub roll_deg: f32,
}

impl Turn {
    const fn new(pitch_deg: f32, yaw_deg: f32, roll_deg: f32) -> Turn {
        Turn { pitch_deg, yaw_deg, roll_deg }
    }

    /// Returns the rotation: yaw, then pitch, then roll.
    pub fn rotation(self) -> Quat {
        let [yaw, pitch, roll] = [self.yaw_deg, self.pitch_deg, self.roll_deg].map(f32::to_radians);
        Quat::from_euler(EulerRot::YXZ, yaw, pitch, roll)
    }
}

/// The pose of an arm.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum ArmPose {
    /// Given by the angles of its joints.
    Free {
        /// Away from the body, degrees.
        abduct_deg: f32,
        /// Forwards, degrees.
        lift_deg: f32,
        /// Bend of the elbow, degrees.
        elbow_deg: f32,
    },
    /// Given by the position of the hand; the elbow follows.
    Laid {
        /// Position of the wrist from the middle of the hips, in body units (see `Skeleton`); +X is outwards.
        wrist: Vec3,
        /// BodySide to which the elbow points; +X is outwards.
        elbow: Vec3,
        /// Direction of the fingers; +X is outwards.
        fingers: Vec3,
        /// Direction the palm faces; +X is outwards.
        palm: Vec3,
    },
}

/// The pose of a leg, given by the position of the foot; the knee follows.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LegPose {
    /// Position of the ankle on the floor, in body units: outwards, forwards.
    pub ankle: Vec2,
    /// Toes turned outwards, degrees.
    pub toes_out_deg: f32,
    /// Knee turned outwards against the toes, degrees.
    pub knee_out_deg: f32,
}

/// A whole pose. Pairs are left, right.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PoseAngles {
    /// Height of the seat the figure sits on, metres; its hips then lie over the seat, a thigh's length behind the
    /// knees.
    pub seat_m: Option<f32>,
    /// Offset of the hips from standing straight (or sitting), in body units.
    pub hip_shift: Vec3,
    /// Turn of the pelvis.
    pub pelvis: Turn,
    /// Turn of the waist against the pelvis.
    pub waist: Turn,
    /// Turn of the chest against the waist.
    pub chest: Turn,
    /// Turn of the neck against the chest.
    pub neck: Turn,
    /// Turn of the head against the neck.
    pub head: Turn,
    /// Arms.
    pub arms: [ArmPose; 2],
    /// Legs.
    pub legs: [LegPose; 2],
}

const HANGING: ArmPose = ArmPose::Free { abduct_deg: 11.0, lift_deg: 2.0, elbow_deg: 14.0 };
const PLANTED: LegPose = LegPose { ankle: Vec2::new(0.105, -0.03), toes_out_deg: 9.0, knee_out_deg: 0.0 };
const STANDING: PoseAngles = PoseAngles {
    seat_m: None,
    hip_shift: Vec3::ZERO,
    pelvis: Turn::new(0.0, 0.0, 0.0),
    waist: Turn::new(0.0, 0.0, 0.0),
    chest: Turn::new(0.0, 0.0, 0.0),
    neck: Turn::new(0.0, 0.0, 0.0),
    head: Turn::new(0.0, 0.0, 0.0),
    arms: [HANGING; 2],
    legs: [PLANTED; 2],
};

impl PoseAngles {
    /// Returns the pose of a shipped figure.
    pub fn of(figure: Figure, pose: Pose) -> PoseAngles {
        match pose {
            Pose::Standing => STANDING,
            Pose::HeadTurned => {
                PoseAngles { neck: Turn::new(0.0, 11.0, 0.0), head: Turn::new(0.0, 19.0, 0.0), ..STANDING }
            }
            Pose::Contrapposto => contrapposto(),
            Pose::Seated => seated(if figure == Figure::Child { 0.32 } else { 0.45 }),
        }
    }
}

/// Contrapposto: weight on the right leg, left knee bent, right hand on the raised hip.
fn contrapposto() -> PoseAngles {
    let on_hip = ArmPose::Laid {
        wrist: Vec3::new(0.205, 0.115, 0.005),
        elbow: Vec3::new(1.0, 0.1, -0.6),
        fingers: Vec3::new(-0.35, -0.45, 0.82),
        palm: Vec3::new(-0.9, -0.1, -0.35),
    };
    PoseAngles {
        seat_m: None,
        hip_shift: Vec3::new(-0.055, -0.012, 0.0),
        pelvis: Turn::new(0.0, -4.0, -6.0),
        waist: Turn::new(0.0, 2.0, 5.0),
        chest: Turn::new(0.0, 3.0, 5.0),
        neck: Turn::new(0.0, 2.0, -2.0),
        head: Turn::new(0.0, 3.0, -2.0),
        arms: [ArmPose::Free { abduct_deg: 15.0, lift_deg: 4.0, elbow_deg: 18.0 }, on_hip],
        legs: [
            LegPose { ankle: Vec2::new(0.13, 0.06), toes_out_deg: 24.0, knee_out_deg: 0.0 },
            LegPose { ankle: Vec2::new(0.085, -0.05), toes_out_deg: 10.0, knee_out_deg: 0.0 },
        ],
    }
}

/// Sitting, feet flat on the floor, hands on the thighs. `seat_m` is the seat's height, metres.
fn seated(seat_m: f32) -> PoseAngles {
    let on_thigh = ArmPose::Laid {
        wrist: Vec3::new(0.135, 0.085, 0.245),
        elbow: Vec3::new(0.75, -0.2, -0.9),
        fingers: Vec3::new(-0.22, -0.12, 1.0),
        palm: Vec3::new(-0.15, -1.0, -0.1),
    };
    PoseAngles {
        seat_m: Some(seat_m),
        waist: Turn::new(3.0, 0.0, 0.0),
        neck: Turn::new(-2.0, 0.0, 0.0),
        head: Turn::new(-1.0, 0.0, 0.0),
        arms: [on_thigh; 2],
        legs: [LegPose { ankle: Vec2::new(0.13, -0.03), toes_out_deg: 10.0, knee_out_deg: 0.0 }; 2],
        ..STANDING
    }
}

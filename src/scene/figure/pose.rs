//! The pose of a figure: angles of joints and places of the feet. Ranges are those of a limber adult.

use super::parameter::parameters;

parameters! {
    /// Pelvis, chest, head and eyes. Positive pitch bends forwards, positive yaw turns to the figure's left, positive
    /// roll raises its left side.
    Torso {
        /// Bend of the pelvis, degrees.
        pelvis_pitch_deg: "Hips bend", -30.0 to 60.0, 0.0;
        /// Turn of the pelvis, degrees.
        pelvis_yaw_deg: "Hips turn", -60.0 to 60.0, 0.0;
        /// Tilt of the pelvis, degrees.
        pelvis_roll_deg: "Hips tilt", -20.0 to 20.0, 0.0;
        /// The pelvis to the figure's left, metres.
        pelvis_left_m: "Hips shift", -0.2 to 0.2, 0.0;
        /// Bend of the chest against the pelvis, degrees.
        chest_pitch_deg: "Back bend", -30.0 to 70.0, 0.0;
        /// Turn of the chest, degrees.
        chest_yaw_deg: "Shoulders turn", -45.0 to 45.0, 0.0;
        /// Tilt of the chest, degrees.
        chest_roll_deg: "Shoulders tilt", -30.0 to 30.0, 0.0;
        /// Bend of the head against the chest, degrees.
        head_pitch_deg: "Head nod", -50.0 to 50.0, 0.0;
        /// Turn of the head, degrees.
        head_yaw_deg: "Head turn", -80.0 to 80.0, 0.0;
        /// Tilt of the head, degrees.
        head_roll_deg: "Head tilt", -35.0 to 35.0, 0.0;
        /// Turn of the eyes, degrees.
        gaze_yaw_deg: "Gaze turn", -35.0 to 35.0, 0.0;
        /// The eyes downwards, degrees.
        gaze_pitch_deg: "Gaze down", -25.0 to 30.0, 0.0;
    }
}

parameters! {
    /// An arm. All angles 0: it hangs straight down, the palm against the thigh.
    Arm {
        /// Shoulder upwards, degrees.
        shoulder_deg: "Shoulder up", -10.0 to 30.0, 0.0;
        /// Away from the body, degrees.
        out_deg: "Arm out", -25.0 to 170.0, 10.0;
        /// Forwards, degrees.
        forward_deg: "Arm forward", -50.0 to 175.0, 2.0;
        /// About its own axis, outwards, degrees.
        twist_deg: "Arm twist", -90.0 to 90.0, 0.0;
        /// Bend of the elbow, degrees.
        elbow_deg: "Elbow", 0.0 to 148.0, 14.0;
        /// Palm turned forwards, degrees.
        forearm_deg: "Palm turn", -85.0 to 85.0, 0.0;
        /// Bend of the wrist towards the palm, degrees.
        wrist_deg: "Wrist", -70.0 to 75.0, 0.0;
        /// Bend of the fingers: 0 straight, 1 a fist.
        fingers: "Fingers", 0.0 to 1.0, 0.25;
    }
}

parameters! {
    /// A leg, by the place of its foot; hip and knee follow.
    Leg {
        /// The foot to its own side of the middle, metres.
        out_m: "Foot out", -0.3 to 0.7, 0.1;
        /// The foot forwards, metres.
        forward_m: "Foot forward", -0.6 to 0.9, 0.0;
        /// The foot above the floor, metres.
        up_m: "Foot up", 0.0 to 0.9, 0.0;
        /// The toes outwards, degrees.
        toes_out_deg: "Toes out", -30.0 to 70.0, 9.0;
        /// The knee outwards against the toes, degrees.
        knee_out_deg: "Knee out", -40.0 to 60.0, 0.0;
        /// Heel raised, degrees.
        heel_deg: "Heel up", 0.0 to 60.0, 0.0;
    }
}

/// A pose. Pairs are left, right.
#[derive(Clone, Copy, Debug, PartialEq, Default)]
pub struct Pose {
    /// Height of the seat, metres; none for a standing figure. A seated one has its feet a thigh's length in front.
    pub seat_m: Option<f32>,
    /// Pelvis, chest, head and eyes.
    pub torso: Torso,
    /// Arms.
    pub arms: [Arm; 2],
    /// Legs.
    pub legs: [Leg; 2],
}

/// Lowest and highest seat, metres.
pub const SEAT_RANGE_M: [f32; 2] = [0.2, 1.1];

impl Pose {
    /// Returns the pose with left and right exchanged.
    pub fn mirrored(&self) -> Pose {
        let t = &self.torso;
        let torso = Torso {
            pelvis_yaw_deg: -t.pelvis_yaw_deg,
            pelvis_roll_deg: -t.pelvis_roll_deg,
            pelvis_left_m: -t.pelvis_left_m,
            chest_yaw_deg: -t.chest_yaw_deg,
            chest_roll_deg: -t.chest_roll_deg,
            head_yaw_deg: -t.head_yaw_deg,
            head_roll_deg: -t.head_roll_deg,
            gaze_yaw_deg: -t.gaze_yaw_deg,
            ..*t
        };
        let ([left_arm, right_arm], [left_leg, right_leg]) = (self.arms, self.legs);
        Pose { seat_m: self.seat_m, torso, arms: [right_arm, left_arm], legs: [right_leg, left_leg] }
    }
}

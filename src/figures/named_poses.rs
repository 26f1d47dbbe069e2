//! Named poses.

use crate::scene::{Arm, Leg, Pose, Torso};

/// A pose with a name.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum NamedPose {
    /// Upright, arms at the sides.
    Standing,
    /// Weight on one leg.
    Relaxed,
    /// Weight on one leg, hand on the raised hip.
    HandOnHip,
    /// Both hands on the hips.
    HandsOnHips,
    /// Body turned a third away, face to the front.
    ThreeQuarter,
    /// Body turned away, face over the shoulder.
    OverShoulder,
    /// Arms crossed.
    ArmsCrossed,
    /// Hands joined in front.
    HandsJoined,
    /// Hands behind the back.
    HandsBehind,
    /// Hand at the chin.
    HandAtChin,
    /// Hand in the hair.
    HandInHair,
    /// A step forwards.
    Walking,
    /// Leaning against something behind.
    Leaning,
    /// Arms up.
    ArmsUp,
    /// On a seat, hands on the thighs.
    Seated,
    /// On a seat, leaning forwards, forearms on the thighs.
    SeatedForward,
    /// On a seat, one leg over the other.
    LegsCrossed,
    /// On a high stool, one foot on its ring.
    HighStool,
    /// On a low box, knees together, hands on the knees.
    LowSeat,
    /// A child with a hand raised.
    Waving,
}

impl NamedPose {
    /// All poses, in list order.
    pub const ALL: [NamedPose; 20] = [
        NamedPose::Standing,
        NamedPose::Relaxed,
        NamedPose::HandOnHip,
        NamedPose::HandsOnHips,
        NamedPose::ThreeQuarter,
        NamedPose::OverShoulder,
        NamedPose::ArmsCrossed,
        NamedPose::HandsJoined,
        NamedPose::HandsBehind,
        NamedPose::HandAtChin,
        NamedPose::HandInHair,
        NamedPose::Walking,
        NamedPose::Leaning,
        NamedPose::ArmsUp,
        NamedPose::Waving,
        NamedPose::Seated,
        NamedPose::SeatedForward,
        NamedPose::LegsCrossed,
        NamedPose::HighStool,
        NamedPose::LowSeat,
    ];

    /// Returns the label in lists.
    pub fn label(self) -> &'static str {
        match self {
            NamedPose::Standing => "Standing",
            NamedPose::Relaxed => "Relaxed",
            NamedPose::HandOnHip => "Hand on hip",
            NamedPose::HandsOnHips => "Hands on hips",
            NamedPose::ThreeQuarter => "Turned a third",
            NamedPose::OverShoulder => "Over the shoulder",
            NamedPose::ArmsCrossed => "Arms crossed",
            NamedPose::HandsJoined => "Hands joined",
            NamedPose::HandsBehind => "Hands behind",
            NamedPose::HandAtChin => "Hand at chin",
            NamedPose::HandInHair => "Hand in hair",
            NamedPose::Walking => "Walking",
            NamedPose::Leaning => "Leaning",
            NamedPose::ArmsUp => "Arms up",
            NamedPose::Seated => "Seated",
            NamedPose::SeatedForward => "Seated, leaning",
            NamedPose::LegsCrossed => "Seated, legs crossed",
            NamedPose::HighStool => "On a high stool",
            NamedPose::LowSeat => "On a low seat",
            NamedPose::Waving => "Waving",
        }
    }

    /// Returns the pose.
    pub fn pose(self) -> Pose {
        let standing = Pose::default();
        let relaxed = relaxed();
        match self {
            NamedPose::Standing => standing,
            NamedPose::Relaxed => relaxed,
            NamedPose::HandOnHip => Pose { arms: [relaxed.arms[0], ON_HIP], ..relaxed },
            NamedPose::HandsOnHips => Pose { arms: [ON_HIP; 2], ..standing },
            NamedPose::ThreeQuarter => turned(relaxed, 25.0, 12.0, -30.0),
            NamedPose::OverShoulder => turned(relaxed, 55.0, 25.0, -70.0),
            NamedPose::ArmsCrossed => Pose { arms: CROSSED, ..standing },
            NamedPose::HandsJoined => Pose { arms: JOINED, ..standing },
            NamedPose::HandsBehind => Pose { arms: BEHIND, ..standing },
            NamedPose::HandAtChin => Pose { arms: [SUPPORTING, AT_CHIN], ..relaxed },
            NamedPose::HandInHair => Pose { arms: [relaxed.arms[0], IN_HAIR], ..relaxed },
            NamedPose::Walking => walking(),
            NamedPose::Leaning => leaning(),
            NamedPose::ArmsUp => Pose { arms: [UP; 2], ..standing },
            NamedPose::Waving => Pose { arms: [standing.arms[0], WAVING], ..relaxed },
            NamedPose::Seated => seated(0.45),
            NamedPose::SeatedForward => seated_forward(),
            NamedPose::LegsCrossed => legs_crossed(),
            NamedPose::HighStool => high_stool(),
            NamedPose::LowSeat => Pose { arms: [ON_KNEE; 2], legs: [TOGETHER; 2], ..seated(0.32) },
        }
    }
}

const HANGING: Arm = Arm {
    shoulder_deg: 0.0,
    out_deg: 10.0,
    forward_deg: 2.0,
    twist_deg: 0.0,
    elbow_deg: 14.0,
    forearm_deg: 0.0,
    wrist_deg: 0.0,
    fingers: 0.25,
};
const PLANTED: Leg = Leg { out_m: 0.1, forward_m: 0.0, up_m: 0.0, toes_out_deg: 9.0, knee_out_deg: 0.0, heel_deg: 0.0 };
const ON_HIP: Arm =
    Arm { out_deg: 48.0, forward_deg: -22.0, twist_deg: -52.0, elbow_deg: 96.0, wrist_deg: 20.0, ..HANGING };
/// Of a usual body, the left hand is tucked in between ribs and upper arm, and the right one lies on the upper arm.
const CROSSED: [Arm; 2] = [
    Arm {
        shoulder_deg: 1.1,
        out_deg: 11.6,
        forward_deg: 28.6,
        twist_deg: -90.0,
        elbow_deg: 103.6,
        forearm_deg: 10.5,
        wrist_deg: 4.7,
        fingers: 0.57,
    },
    Arm {
        shoulder_deg: -8.2,
        out_deg: -4.2,
        forward_deg: 37.7,
        twist_deg: -84.0,
        elbow_deg: 104.0,
        forearm_deg: 33.1,
        wrist_deg: 6.4,
        fingers: 0.3,
    },
];
/// The palm lies under the right elbow.
const SUPPORTING: Arm = Arm {
    shoulder_deg: -7.0,
    out_deg: 2.0,
    forward_deg: 28.0,
    twist_deg: -70.0,
    elbow_deg: 89.5,
    forearm_deg: 85.0,
    wrist_deg: 3.5,
    fingers: 0.35,
};
/// The right hand lies on the back of the left one, before the belly.
const JOINED: [Arm; 2] = [
    Arm {
        shoulder_deg: -1.5,
        out_deg: 19.0,
        forward_deg: 10.0,
        twist_deg: -69.5,
        elbow_deg: 68.0,
        forearm_deg: 18.5,
        wrist_deg: -13.0,
        fingers: 0.3,
    },
    Arm {
        shoulder_deg: 12.0,
        out_deg: 15.0,
        forward_deg: 8.5,
        twist_deg: -64.0,
        elbow_deg: 68.5,
        forearm_deg: 0.0,
        wrist_deg: -8.5,
        fingers: 0.2,
    },
];
/// The back of the right hand lies in the left palm, behind the lower back.
const BEHIND: [Arm; 2] = [
    Arm {
        shoulder_deg: -10.0,
        out_deg: 16.5,
        forward_deg: -23.0,
        twist_deg: -90.0,
        elbow_deg: 57.0,
        forearm_deg: 7.5,
        wrist_deg: 22.0,
        fingers: 0.35,
    },
    Arm {
        shoulder_deg: -3.0,
        out_deg: 23.5,
        forward_deg: -29.0,
        twist_deg: -76.5,
        elbow_deg: 61.0,
        forearm_deg: 23.0,
        wrist_deg: 20.0,
        fingers: 0.3,
    },
];
/// The bent index finger lies at the chin: of a woman below it, of a man beside it.
const AT_CHIN: Arm = Arm {
    shoulder_deg: -1.0,
    out_deg: -0.5,
    forward_deg: 59.5,
    twist_deg: -18.0,
    elbow_deg: 138.5,
    forearm_deg: -26.5,
    wrist_deg: -20.5,
    fingers: 0.65,
};
/// The palm lies on the back of the head, over the ear.
const IN_HAIR: Arm = Arm {
    shoulder_deg: 2.5,
    out_deg: 134.0,
    forward_deg: 36.5,
    twist_deg: 53.0,
    elbow_deg: 138.0,
    forearm_deg: 38.0,
    wrist_deg: 52.0,
    fingers: 0.15,
};
const UP: Arm = Arm { out_deg: 160.0, forward_deg: 10.0, elbow_deg: 20.0, fingers: 0.1, ..HANGING };
const WAVING: Arm =
    Arm { out_deg: 80.0, forward_deg: 15.0, twist_deg: 88.0, elbow_deg: 110.0, fingers: 0.05, ..HANGING };
const ON_THIGH: Arm =
    Arm { out_deg: 12.0, forward_deg: 22.0, twist_deg: -18.0, elbow_deg: 58.0, forearm_deg: -55.0, ..HANGING };
/// Of a usual man, the palm lies on the thigh of a seated figure; that of a woman is 2 cm above it.
const RESTING: Arm = Arm {
    shoulder_deg: -5.0,
    out_deg: 18.0,
    forward_deg: 12.0,
    twist_deg: -21.0,
    elbow_deg: 59.0,
    forearm_deg: -16.0,
    wrist_deg: 16.5,
    fingers: 0.15,
};
const ON_KNEE: Arm =
    Arm { out_deg: 8.0, forward_deg: 38.0, twist_deg: -12.0, elbow_deg: 36.0, forearm_deg: -60.0, ..HANGING };
const TOGETHER: Leg = Leg { out_m: 0.07, toes_out_deg: 2.0, ..PLANTED };

fn relaxed() -> Pose {
    Pose {
        seat_m: None,
        torso: Torso {
            pelvis_left_m: -0.05,
            pelvis_roll_deg: -5.0,
            pelvis_yaw_deg: -4.0,
            chest_roll_deg: 7.0,
            chest_yaw_deg: 4.0,
            head_roll_deg: -3.0,
            head_yaw_deg: 2.0,
            ..Torso::default()
        },
        arms: [Arm { out_deg: 13.0, elbow_deg: 20.0, ..HANGING }, HANGING],
        legs: [
            Leg { out_m: 0.13, forward_m: 0.07, toes_out_deg: 24.0, ..PLANTED },
            Leg { out_m: 0.07, forward_m: -0.03, toes_out_deg: 10.0, ..PLANTED },
        ],
    }
}

/// Turns hips and shoulders to the figure's left and the head back.
fn turned(pose: Pose, hips_deg: f32, shoulders_deg: f32, head_deg: f32) -> Pose {
    let mut pose = pose;
    pose.torso.pelvis_yaw_deg += hips_deg;
    pose.torso.chest_yaw_deg += shoulders_deg;
    pose.torso.head_yaw_deg += head_deg;
    // The feet turn with the hips.
    pose.legs[0].toes_out_deg += hips_deg * 0.8;
    pose.legs[1].toes_out_deg -= hips_deg * 0.7;
    pose
}

fn walking() -> Pose {
    Pose {
        torso: Torso { pelvis_yaw_deg: 6.0, chest_yaw_deg: -12.0, head_yaw_deg: 6.0, ..Torso::default() },
        arms: [Arm { forward_deg: 22.0, elbow_deg: 28.0, ..HANGING }, Arm { forward_deg: -20.0, ..HANGING }],
        legs: [
            Leg { out_m: 0.06, forward_m: -0.28, heel_deg: 38.0, toes_out_deg: 4.0, ..PLANTED },
            Leg { out_m: 0.06, forward_m: 0.28, toes_out_deg: 4.0, ..PLANTED },
        ],
        ..Pose::default()
    }
}

fn leaning() -> Pose {
    Pose {
        torso: Torso { pelvis_pitch_deg: -6.0, chest_pitch_deg: -4.0, head_pitch_deg: 8.0, ..Torso::default() },
        arms: CROSSED,
        legs: [
            Leg { out_m: 0.1, forward_m: 0.22, toes_out_deg: 14.0, ..PLANTED },
            Leg { out_m: 0.02, forward_m: 0.34, toes_out_deg: 12.0, ..PLANTED },
        ],
        ..Pose::default()
    }
}

fn seated(seat_m: f32) -> Pose {
    Pose {
        seat_m: Some(seat_m),
        torso: Torso { chest_pitch_deg: 4.0, head_pitch_deg: -3.0, ..Torso::default() },
        arms: [RESTING; 2],
        legs: [Leg { out_m: 0.14, toes_out_deg: 10.0, ..PLANTED }; 2],
    }
}

fn seated_forward() -> Pose {
    let seated = seated(0.45);
    Pose {
        torso: Torso { pelvis_pitch_deg: 18.0, chest_pitch_deg: 26.0, head_pitch_deg: -32.0, ..Torso::default() },
        arms: [Arm { out_deg: 14.0, forward_deg: 62.0, elbow_deg: 62.0, twist_deg: -32.0, ..ON_THIGH }; 2],
        legs: [Leg { out_m: 0.2, toes_out_deg: 16.0, ..PLANTED }; 2],
        ..seated
    }
}

fn legs_crossed() -> Pose {
    let seated = seated(0.48);
    Pose {
        arms: [Arm { twist_deg: -34.0, ..ON_THIGH }, Arm { twist_deg: -26.0, ..ON_THIGH }],
        legs: [
            Leg { out_m: 0.06, forward_m: -0.02, toes_out_deg: 6.0, ..PLANTED },
            Leg { out_m: -0.2, forward_m: 0.1, up_m: 0.24, toes_out_deg: -12.0, knee_out_deg: 6.0, heel_deg: 16.0 },
        ],
        ..seated
    }
}

fn high_stool() -> Pose {
    let seated = seated(0.72);
    Pose {
        legs: [
            Leg { out_m: 0.16, forward_m: 0.06, toes_out_deg: 16.0, ..PLANTED },
            Leg { out_m: 0.12, forward_m: -0.08, up_m: 0.26, toes_out_deg: 12.0, ..PLANTED },
        ],
        ..seated
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::figures::BodyData;
    use crate::figures::patch::Patch;
    use crate::figures::posed_body::PosedBody;
    use crate::figures::regions::{Edges, Place};
    use crate::scene::{Body, Figure};
    use glam::Vec3;

    /// Sex, height in metres and weight of bodies: usual, thin and heavy.
    const BODIES: [(f32, f32, f32); 4] = [(0.0, 1.66, 0.45), (1.0, 1.8, 0.5), (1.0, 1.82, 0.3), (1.0, 1.78, 0.8)];
    /// Distance from a vertex of a part within which a point may be in the part, metres: more than half of an edge.
    const NEAR_M: f32 = 0.02;

    /// Height of the neck on the trunk, as in [`Place::Trunk`].
    const NECK_HEIGHT: f32 = 1.08;

    /// Returns the vertices of a posed body at places of one side, left or right.
    fn part(body: &PosedBody, is_left: bool, is_in: impl Fn(Place) -> bool) -> Vec<Vec3> {
        let data = BodyData::shipped();
        let is_in = |v: &usize| (data.positions[*v].x > 0.0) == is_left && is_in(Edges::shipped().place(*v as u16));
        (0..data.positions.len()).filter(is_in).map(|v| body.positions[v]).collect()
    }

    /// Returns the distance within which a share of some vertices lie from others, metres.
    fn nearest_m(vertices: &[Vec3], others: &[Vec3], share: f32) -> f32 {
        let nearest = |v: &Vec3| others.iter().map(|other| v.distance(*other)).fold(f32::INFINITY, f32::min);
        let mut distances: Vec<f32> = vertices.iter().map(nearest).collect();
        distances.sort_by(f32::total_cmp);
        distances[(distances.len() as f32 * share) as usize]
    }

    #[test]
    fn hands_of_crossed_arms_and_on_hips_lie_on_the_body() {
        let upper_arm = |place: Place| matches!(place, Place::Arm(at) if at < 1.0);
        let hand = |place: Place| matches!(place, Place::Arm(at) if at >= 2.0);
        let trunk = |place: Place| matches!(place, Place::Trunk { .. });
        // Vertices are up to 3 cm apart
        for (sex, height_m, weight) in BODIES {
            let figure = Figure { body: Body { sex, height_m, weight, ..Body::default() }, ..Figure::default() };
            let posed =
                |named: NamedPose| PosedBody::new(BodyData::shipped(), &Figure { pose: named.pose(), ..figure });
            let body = posed(NamedPose::ArmsCrossed);
            let over = nearest_m(&part(&body, false, hand), &part(&body, true, upper_arm), 0.1);
            let under = nearest_m(&part(&body, true, hand), &part(&body, false, upper_arm), 0.1);
            let hips = posed(NamedPose::HandsOnHips);
            let trunk: Vec<Vec3> = [true, false].into_iter().flat_map(|side| part(&hips, side, trunk)).collect();
            let on_hip = nearest_m(&part(&hips, true, hand), &trunk, 0.1);
            assert!(over.max(under).max(on_hip) < 0.04, "{sex} {weight}: {over} {under} {on_hip}");
        }
    }

    /// Returns the depth of the deepest twentieth of some vertices in a part of a body, of one or both sides, metres.
    fn depth_m(vertices: &[Vec3], body: &PosedBody, is_left: Option<bool>, is_in: impl Fn(Place) -> bool) -> f32 {
        let data = BodyData::shipped();
        let is_of_part = |v: u16| {
            let side = data.positions[usize::from(v)].x > 0.0;
            is_left.is_none_or(|is_left| is_left == side) && is_in(Edges::shipped().place(v))
        };
        let patch = Patch::new(data, "body", &body.positions, &|quad| quad.iter().all(|&v| is_of_part(v)));
        let positions = patch.positions.clone();
        let skin = patch.skin();
        // A point beside the edge of a part is not in it
        let is_near = |v: &Vec3| positions.iter().any(|other| v.distance(*other) < NEAR_M);
        let height = |v: &Vec3| if is_near(v) { skin.height(*v).map_or(0.0, |(height, _)| height) } else { 0.0 };
        let mut depths: Vec<f32> = vertices.iter().map(|v| (-height(v)).max(0.0)).collect();
        depths.sort_by(f32::total_cmp);
        depths[depths.len() * 19 / 20]
    }

    #[test]
    fn hands_that_are_joined_at_the_chin_in_the_hair_and_on_thighs_touch() {
        let hand = |place: Place| matches!(place, Place::Arm(at) if at >= 2.0);
        let elbow = |place: Place| matches!(place, Place::Arm(at) if (0.7..1.3).contains(&at));
        let head = |place: Place| matches!(place, Place::Trunk { height } if height > NECK_HEIGHT);
        let trunk = |place: Place| matches!(place, Place::Trunk { height } if height < NECK_HEIGHT);
        let leg = |place: Place| matches!(place, Place::Leg(_));
        for (sex, height_m, weight) in BODIES {
            let figure = Figure { body: Body { sex, height_m, weight, ..Body::default() }, ..Figure::default() };
            // Returns a body and the vertices of its left and right hand
            let posed = |named: NamedPose| {
                let body = PosedBody::new(BodyData::shipped(), &Figure { pose: named.pose(), ..figure });
                let hands = [true, false].map(|side| part(&body, side, hand));
                (body, hands)
            };
            let both =
                |body: &PosedBody, is_in: fn(Place) -> bool| [true, false].map(|s| part(body, s, is_in)).concat();
            let check = |what: &str, distance_m: f32, limit_m: f32| {
                assert!(distance_m < limit_m, "sex {sex}, weight {weight}, {what}: {distance_m} m");
            };
            for named in [NamedPose::HandsJoined, NamedPose::HandsBehind] {
                let (body, [left, right]) = posed(named);
                check("between the hands", nearest_m(&right, &left, 0.5), 0.016);
                check("one hand in the other", depth_m(&right, &body, Some(true), hand), 0.007);
                check("between hands and trunk", nearest_m(&left, &both(&body, trunk), 0.1), 0.07);
            }
            let (body, [left, right]) = posed(NamedPose::HandAtChin);
            check("between hand and chin", nearest_m(&both(&body, head), &right, 0.0), 0.011);
            check("hand in chin", depth_m(&right, &body, None, head), 0.003);
            check("between hand and elbow", nearest_m(&left, &part(&body, false, elbow), 0.25), 0.025);
            check("hand in elbow", depth_m(&left, &body, Some(false), elbow), 0.006);
            let (body, [_, right]) = posed(NamedPose::HandInHair);
            check("between hand and head", nearest_m(&right, &both(&body, head), 0.5), 0.025);
            check("hand in head", depth_m(&right, &body, None, head), 0.008);
            let (body, [left, _]) = posed(NamedPose::Seated);
            check("between hand and thigh", nearest_m(&left, &part(&body, true, leg), 0.5), 0.035);
            check("hand in thigh", depth_m(&left, &body, Some(true), leg), 0.006);
        }
    }
}

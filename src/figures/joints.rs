//! The joints that a figure is posed by: where they are, and the pose in which one of them is where it is dragged.

use super::body_data::BodyData;
use super::gaze::without_gaze;
use super::morph::rest_positions;
use super::posed_body::PosedBody;
use super::skeleton::{Side, Skeleton};
use crate::scene::{Extent, Figure, Parameter, ParameterSet, Pose};
use glam::{Mat2, Vec2, Vec3};

/// A joint, or a part, that a limb is dragged by.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Joint {
    /// The face: turns and nods the head.
    Head,
    /// The base of the neck: bends the back.
    Chest,
    /// The pelvis: shifts it to a side.
    Hips,
    /// An elbow: turns the arm about the shoulder.
    Elbow(Side),
    /// A wrist: turns the arm and bends the elbow.
    Hand(Side),
    /// A knee: turns the leg about hip and ankle.
    Knee(Side),
    /// An ankle: places the foot; hip and knee follow.
    Foot(Side),
}

/// Distance of the head's handle in front of the point between the eyes, as a part of the height.
const BEFORE_FACE: f32 = 0.07;
/// Steps of the search for a pose, and the distance at which it ends, metres.
const STEPS: usize = 16;
const CLOSE_M: f32 = 5e-4;
/// Distance that an angle is not turned for, metres: it keeps a limb that cannot reach from jumping about.
const DAMPING_M: f32 = 0.03;
/// Step of the derivatives, as a part of a parameter's range.
const DIFFERENCE: f32 = 1e-3;

impl Joint {
    /// All joints, from the head down.
    pub const ALL: [Joint; 11] = [
        Joint::Head,
        Joint::Chest,
        Joint::Hips,
        Joint::Elbow(Side::Left),
        Joint::Elbow(Side::Right),
        Joint::Hand(Side::Left),
        Joint::Hand(Side::Right),
        Joint::Knee(Side::Left),
        Joint::Knee(Side::Right),
        Joint::Foot(Side::Left),
        Joint::Foot(Side::Right),
    ];

    /// Returns the name in the window.
    pub fn label(self) -> &'static str {
        match self {
            Joint::Head => "Head",
            Joint::Chest => "Shoulders",
            Joint::Hips => "Hips",
            Joint::Elbow(_) => "Elbow",
            Joint::Hand(_) => "Hand",
            Joint::Knee(_) => "Knee",
            Joint::Foot(_) => "Foot",
        }
    }

    /// Returns true if the part of a figure that is there has the joint.
    pub fn is_part_of(self, figure: &Figure) -> bool {
        figure.extent == Extent::Whole || matches!(self, Joint::Head)
    }

    /// Returns the names of the parameters that a drag changes.
    fn parameter_names(self) -> &'static [&'static str] {
        match self {
            Joint::Head => &["head_yaw_deg", "head_pitch_deg"],
            Joint::Chest => &["chest_pitch_deg", "chest_roll_deg"],
            Joint::Hips => &["pelvis_left_m"],
            Joint::Elbow(_) => &["out_deg", "forward_deg"],
            Joint::Hand(_) => &["out_deg", "forward_deg", "twist_deg", "elbow_deg"],
            Joint::Knee(_) => &["knee_out_deg"],
            Joint::Foot(_) => &["out_m", "forward_m", "up_m"],
        }
    }

    /// Returns the parameters that a drag changes, with their values.
    fn parameters(self, pose: &mut Pose) -> Vec<(&'static Parameter, &mut f32)> {
        fn named<'a, S: ParameterSet>(
            set: &'a mut S,
            names: &'static [&'static str],
        ) -> Vec<(&'static Parameter, &'a mut f32)> {
            S::PARAMETERS
                .iter()
                .zip(set.values_mut())
                .filter(|(parameter, _)| names.contains(&parameter.name))
                .collect()
        }
        let names = self.parameter_names();
        match self {
            Joint::Head | Joint::Chest | Joint::Hips => named(&mut pose.torso, names),
            Joint::Elbow(side) | Joint::Hand(side) => named(&mut pose.arms[side as usize], names),
            Joint::Knee(side) | Joint::Foot(side) => named(&mut pose.legs[side as usize], names),
        }
    }
}

/// The body of a figure, measured once and posed many times.
#[derive(Clone, Debug)]
pub struct PosableBody {
    figure: Figure,
    rest: Vec<Vec3>,
    /// From the skeleton's space to the object's: the figure stands on the floor.
    shift: Vec3,
}

impl PosableBody {
    /// Measures the body of a figure.
    pub fn new(figure: &Figure) -> PosableBody {
        let data = BodyData::shipped();
        let figure = without_gaze(figure);
        let shift = PosedBody::new(data, &figure).shift;
        PosableBody { figure, rest: rest_positions(data, &figure), shift }
    }

    /// Returns true if it is the body of a figure, in its pose.
    pub fn is_of(&self, figure: &Figure) -> bool {
        self.figure == without_gaze(figure)
    }

    /// Returns the place of a joint in object space, metres.
    pub fn place(&self, joint: Joint) -> Vec3 {
        self.place_in(&self.figure.pose, joint)
    }

    /// Returns the place of a joint in another pose, object space, metres.
    fn place_in(&self, pose: &Pose, joint: Joint) -> Vec3 {
        let data = BodyData::shipped();
        let skeleton = Skeleton::new(data, &self.rest, &Figure { pose: *pose, ..self.figure });
        let at = |bone: &str, offset: Vec3| {
            let Some(index) = data.bone(bone) else { return Vec3::ZERO };
            let rest = self.rest[usize::from(data.bones[index].head)];
            skeleton.transforms[index].transform_point3(rest + offset)
        };
        let of = |stem: &str, side: Side| at(&side.bone(stem), Vec3::ZERO);
        let place = match joint {
            Joint::Head => at("head", Vec3::new(0.0, 0.03, 0.05 + BEFORE_FACE) * self.figure.body.height_m),
            Joint::Chest => at("neck01", Vec3::ZERO),
            Joint::Hips => at("spine05", Vec3::ZERO),
            Joint::Elbow(side) => of("lowerarm01", side),
            Joint::Hand(side) => of("wrist", side),
            Joint::Knee(side) => of("lowerleg01", side),
            Joint::Foot(side) => of("foot", side),
        };
        place + self.shift
    }

    /// Returns the pose, with eyes straight ahead, in which a joint is nearest to a point, as seen along the axis across
    /// two unit vectors in object space. Every parameter stops at its limit; of the poses that bring the joint there, it
    /// is one near the present one (damped least squares, Wampler 1986).
    pub fn dragged(&self, joint: Joint, to: Vec3, across: [Vec3; 2]) -> Pose {
        let mut pose = self.figure.pose;
        let seen = |pose: &Pose| {
            let place = self.place_in(pose, joint);
            Vec2::new(place.dot(across[0]), place.dot(across[1]))
        };
        let wanted = Vec2::new(to.dot(across[0]), to.dot(across[1]));
        if !wanted.is_finite() {
            return pose;
        }
        for _ in 0..STEPS {
            let now = seen(&pose);
            let left = wanted - now;
            if left.length() < CLOSE_M {
                break;
            }
            // How the joint moves with each parameter, in parts of its range
            let count = joint.parameters(&mut pose).len();
            let slope = |index: usize| {
                let mut other = pose;
                let step = nudge(&mut joint.parameters(&mut other)[index]);
                (seen(&other) - now) / step
            };
            let slopes: Vec<Vec2> = (0..count).map(slope).collect();
            let steps = damped_steps(&slopes, left, &mut joint.parameters(&mut pose));
            for ((parameter, value), step) in joint.parameters(&mut pose).into_iter().zip(steps) {
                *value = (*value + step * (parameter.high - parameter.low)).clamp(parameter.low, parameter.high);
            }
        }
        pose
    }
}

/// Moves a value a little, inwards at the upper limit. Returns the step in parts of its range.
fn nudge((parameter, value): &mut (&'static Parameter, &mut f32)) -> f32 {
    let range = parameter.high - parameter.low;
    let step = if **value + DIFFERENCE * range > parameter.high { -DIFFERENCE } else { DIFFERENCE };
    **value += step * range;
    step
}

/// Returns the steps of all parameters, in parts of their ranges, that go the way that is left. Those that would leave
/// their ranges take none.
fn damped_steps(slopes: &[Vec2], left: Vec2, parameters: &mut [(&'static Parameter, &mut f32)]) -> Vec<f32> {
    let mut free = vec![true; slopes.len()];
    loop {
        let used = || slopes.iter().zip(&free).map(|(slope, free)| if *free { *slope } else { Vec2::ZERO });
        let squares = used().fold(Mat2::from_diagonal(Vec2::splat(DAMPING_M * DAMPING_M)), |sum, slope| {
            sum + Mat2::from_cols(slope * slope.x, slope * slope.y)
        });
        let pull = squares.inverse() * left;
        let steps: Vec<f32> = used().map(|slope| slope.dot(pull)).collect();
        let is_stuck = |index: usize| {
            let (parameter, value) = (&parameters[index].0, *parameters[index].1);
            (value <= parameter.low && steps[index] < 0.0) || (value >= parameter.high && steps[index] > 0.0)
        };
        match (0..steps.len()).find(|&index| free[index] && is_stuck(index)) {
            Some(index) => free[index] = false,
            None => return steps,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::figures::NamedPose;

    const FRONT: [Vec3; 2] = [Vec3::X, Vec3::Y];

    fn standing() -> Figure {
        Figure { pose: NamedPose::Standing.pose(), ..Figure::default() }
    }

    fn after(figure: &Figure, pose: Pose) -> PosableBody {
        PosableBody::new(&Figure { pose, ..*figure })
    }

    #[test]
    fn a_dragged_joint_is_under_the_pointer() {
        let figure = standing();
        let body = PosableBody::new(&figure);
        for (joint, by) in [
            (Joint::Hand(Side::Left), Vec3::new(0.3, 0.5, 0.0)),
            (Joint::Hand(Side::Right), Vec3::new(-0.1, 0.25, 0.0)),
            (Joint::Elbow(Side::Left), Vec3::new(0.15, 0.12, 0.0)),
            (Joint::Head, Vec3::new(0.03, -0.03, 0.0)),
            (Joint::Chest, Vec3::new(0.03, 0.0, 0.0)),
            (Joint::Foot(Side::Right), Vec3::new(-0.15, 0.0, 0.0)),
            (Joint::Hips, Vec3::new(0.05, 0.0, 0.0)),
        ] {
            let wanted = body.place(joint) + by;
            let pose = body.dragged(joint, wanted, FRONT);
            let reached = body.place_in(&pose, joint);
            assert!((reached - wanted).truncate().length() < 2e-3, "{joint:?}: {reached} for {wanted}");
            // The other limbs do not move
            let other =
                if let Joint::Hand(Side::Left) = joint { Joint::Hand(Side::Right) } else { Joint::Hand(Side::Left) };
            let moves_more = matches!(joint, Joint::Chest | Joint::Hips | Joint::Elbow(_) | Joint::Foot(_));
            if !moves_more {
                assert!((body.place_in(&pose, other) - body.place(other)).length() < 0.01, "{joint:?}");
            }
        }
    }

    #[test]
    fn a_foot_that_is_lifted_leaves_the_other_on_the_floor() {
        let figure = standing();
        let body = PosableBody::new(&figure);
        let joint = Joint::Foot(Side::Left);
        let pose = body.dragged(joint, body.place(joint) + Vec3::new(0.0, 0.3, 0.0), FRONT);
        assert!((pose.legs[0].up_m - figure.pose.legs[0].up_m - 0.3).abs() < 0.01, "{:?}", pose.legs[0]);
        let lifted = after(&figure, pose);
        assert!((lifted.place(Joint::Foot(Side::Right)) - body.place(Joint::Foot(Side::Right))).length() < 0.01);
    }

    #[test]
    fn joints_stop_at_their_limits_and_stay_steady_out_of_reach() {
        let figure = standing();
        let body = PosableBody::new(&figure);
        for joint in Joint::ALL {
            for far in [Vec3::new(5.0, 3.0, 0.0), Vec3::new(-5.0, -4.0, 1.0), Vec3::NAN] {
                let mut pose = body.dragged(joint, far, FRONT);
                for (parameter, value) in joint.parameters(&mut pose) {
                    let within = (parameter.low..=parameter.high).contains(value);
                    assert!(within, "{joint:?}: {} is {value}", parameter.name);
                }
                let mut known = figure.pose;
                for ((_, ours), (_, theirs)) in
                    joint.parameters(&mut known).into_iter().zip(joint.parameters(&mut pose))
                {
                    *ours = *theirs;
                }
                assert!(known == pose, "{joint:?}: no other joint moves");
            }
        }
    }
}

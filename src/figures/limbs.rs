//! Arms and legs.

use super::field::{Join, PrimitiveGroup};
use super::primitive::Primitive;
use super::proportions::Build;
use super::skeleton::{Arm, Leg, Skeleton};
use glam::{Mat3, Vec3};

/// A bone with a local frame; muscles are placed along it, to the front and outwards.
struct Bone {
    start: Vec3,
    end: Vec3,
    front: Vec3,
    out: Vec3,
    unit: f32,
}

impl Bone {
    fn new(start: Vec3, end: Vec3, front: Vec3, out_hint: Vec3, unit: f32) -> Bone {
        let along = (end - start).normalize_or(Vec3::NEG_Y);
        let front = (front - along * front.dot(along)).normalize_or(Vec3::Z);
        let out = along.cross(front);
        Bone { start, end, front, out: out * out.dot(out_hint).signum(), unit }
    }

    fn at(&self, along: f32, front: f32, out: f32) -> Vec3 {
        self.start.lerp(self.end, along) + (self.front * front + self.out * out) * self.unit
    }

    /// Adds a muscle along the bone: radii outwards, along, to the front.
    fn belly(&self, group: &mut PrimitiveGroup, center: Vec3, radii: Vec3, width: f32) {
        let along = (self.end - self.start).normalize_or(Vec3::NEG_Y);
        let axes = Mat3::from_cols(self.out, along, self.front);
        group.add(Primitive::Ellipsoid { center, axes, radii: radii * self.unit }, width * self.unit);
    }
}

/// Builds upper arm, forearm and hand.
pub fn arm(s: &Skeleton, arm: &Arm, b: &Build) -> PrimitiveGroup {
    let mut g = upper_arm(s, arm, b);
    let outwards = s.chest.transform_vector3(Vec3::X * arm.side.sign());
    add_forearm(&mut g, arm, b, outwards, s.unit);
    super::extremities::add_hand(&mut g, arm, b, s.unit);
    g
}

/// Builds the arm from shoulder to elbow.
pub fn upper_arm(s: &Skeleton, arm: &Arm, b: &Build) -> PrimitiveGroup {
    let (u, l, m) = (s.unit, b.limb, b.muscle);
    let join = Join { center: arm.shoulder, radius: 0.085 * u, near: 0.05 * u, far: 0.004 * u };
    let mut g = PrimitiveGroup::in_world(join);
    let outwards = s.chest.transform_vector3(Vec3::X * arm.side.sign());
    let forwards = s.chest.transform_vector3(Vec3::Z);
    let upper = Bone::new(arm.shoulder, arm.elbow, forwards, outwards, u);
    let r = |metres: f32| metres * l * u;
    g.cone(upper.at(0.0, 0.0, 0.0), r(0.05), upper.at(1.0, 0.0, 0.0), r(0.036), 0.0);
    // Deltoid, biceps, triceps.
    let deltoid = Vec3::new(0.042, 0.085, 0.052) * l * (0.9 + 0.1 * m);
    upper.belly(&mut g, upper.at(0.16, 0.0, 0.018 * l), deltoid, 0.03);
    upper.belly(&mut g, upper.at(0.58, 0.017 * l, -0.003), Vec3::new(0.032, 0.09, 0.028 + 0.006 * m) * l, 0.025);
    upper.belly(&mut g, upper.at(0.5, -0.018 * l, 0.0), Vec3::new(0.034, 0.11, 0.026 + 0.006 * m) * l, 0.025);
    g
}

fn add_forearm(g: &mut PrimitiveGroup, arm: &Arm, b: &Build, outwards: Vec3, u: f32) {
    let l = b.limb;
    let r = |metres: f32| metres * l * u;
    // Full below the elbow, flat at the wrist. Its broad side follows the palm.
    let fore = Bone::new(arm.elbow, arm.wrist, arm.palm, outwards, u);
    g.cone(fore.at(0.0, 0.0, 0.0), r(0.035), fore.at(0.9, 0.0, 0.0), r(0.023), 0.02 * u);
    fore.belly(g, fore.at(0.28, 0.006 * l, 0.006), Vec3::new(0.041, 0.085, 0.034) * l, 0.025);
    fore.belly(g, fore.at(0.93, 0.0, 0.0), Vec3::new(0.029, 0.04, 0.019) * l, 0.02);
    let back = (arm.shoulder + arm.wrist) * 0.5 - arm.elbow;
    g.ball(arm.elbow - back.normalize_or(Vec3::ZERO) * 0.016 * u, Vec3::splat(r(0.024)), 0.02 * u);
}

/// Builds thigh, shin and foot.
pub fn leg(s: &Skeleton, leg: &Leg, b: &Build) -> PrimitiveGroup {
    let mut g = thigh(s, leg, b);
    add_shin(&mut g, s, leg, b);
    super::extremities::add_foot(&mut g, leg, b, s.unit);
    g
}

/// Builds the leg from hip to knee.
pub fn thigh(s: &Skeleton, leg: &Leg, b: &Build) -> PrimitiveGroup {
    let (u, l, m) = (s.unit, b.limb, b.muscle);
    let join = Join { center: leg.hip, radius: 0.12 * u, near: 0.045 * u, far: 0.006 * u };
    let mut g = PrimitiveGroup::in_world(join);
    let outwards = s.pelvis.transform_vector3(Vec3::X * leg.side.sign());
    let thigh = Bone::new(leg.hip, leg.knee, leg.front, outwards, u);
    let r = |metres: f32| metres * l * u;
    let full = 1.0 + 0.08 * (1.0 - m) * (b.bust / 0.06).min(1.0);
    g.cone(thigh.at(0.0, 0.0, 0.0), r(0.082) * full, thigh.at(1.0, -0.004, 0.0), r(0.05), 0.0);
    thigh.belly(&mut g, thigh.at(0.45, 0.02 * l, 0.01), Vec3::new(0.06, 0.17, 0.05) * l * full, 0.04);
    thigh.belly(&mut g, thigh.at(0.5, -0.022 * l, 0.0), Vec3::new(0.055, 0.17, 0.045) * l * full, 0.04);
    thigh.belly(&mut g, thigh.at(0.2, 0.0, -0.03), Vec3::new(0.055, 0.12, 0.06) * l * full, 0.04);
    // Above the kneecap, inside and outside.
    thigh.belly(&mut g, thigh.at(0.84, 0.018, -0.02 * l), Vec3::new(0.024, 0.05, 0.028) * l, 0.025);
    thigh.belly(&mut g, thigh.at(0.78, 0.018, 0.022 * l), Vec3::new(0.024, 0.055, 0.028) * l, 0.025);
    g
}

fn add_shin(g: &mut PrimitiveGroup, s: &Skeleton, leg: &Leg, b: &Build) {
    let (u, l, m) = (s.unit, b.limb, b.muscle);
    let outwards = s.pelvis.transform_vector3(Vec3::X * leg.side.sign());
    let r = |metres: f32| metres * l * u;
    let shin = Bone::new(leg.knee, leg.ankle, leg.front, outwards, u);
    g.cone(shin.at(0.0, -0.004, 0.0), r(0.047), shin.at(1.0, 0.0, 0.0), r(0.031), 0.03 * u);
    let kneecap = (leg.front + shin.front).normalize_or(Vec3::Z) * 0.03 * l * u;
    shin.belly(g, leg.knee + kneecap, Vec3::new(0.025, 0.03, 0.022) * l, 0.025);
    g.cone(shin.at(0.1, 0.026 * l, 0.0), r(0.018), shin.at(0.7, 0.014 * l, 0.0), r(0.018), 0.03 * u);
    // Calf: the inner head hangs lower.
    let calf = 0.9 + 0.1 * m;
    shin.belly(g, shin.at(0.28, -0.026 * l, -0.014 * l), Vec3::new(0.034, 0.095, 0.036) * l * calf, 0.03);
    shin.belly(g, shin.at(0.24, -0.026 * l, 0.016 * l), Vec3::new(0.033, 0.085, 0.034) * l * calf, 0.03);
    g.cone(shin.at(0.6, -0.018 * l, 0.0), r(0.02), shin.at(1.02, -0.03, 0.0), r(0.0125), 0.03 * u);
    // Ankle bones.
    g.ball(shin.at(0.985, 0.002, 0.029 * l), Vec3::splat(r(0.013)), 0.015 * u);
    g.ball(shin.at(0.965, 0.005, -0.029 * l), Vec3::splat(r(0.014)), 0.015 * u);
}

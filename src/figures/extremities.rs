//! Hands and feet.

use super::field::PrimitiveGroup;
use super::primitive::Primitive;
use super::proportions::Build;
use super::skeleton::{Arm, Leg};
use glam::{Mat3, Vec3};

/// Fingers: sideways position of the knuckle, its distance from the wrist, length of the finger, radius at the knuckle;
/// body units.
const FINGERS: [(f32, f32, f32, f32); 4] = [
    (0.031, 0.092, 0.078, 0.0100),
    (0.0105, 0.096, 0.086, 0.0104),
    (-0.0098, 0.093, 0.080, 0.0100),
    (-0.0285, 0.085, 0.063, 0.0088),
];

/// Adds a hand that is a little curled, its fingers side by side.
pub fn add_hand(g: &mut PrimitiveGroup, arm: &Arm, b: &Build, unit: f32) {
    let size = (0.75 + 0.25 * b.limb) * unit;
    let thumb_side = arm.palm.cross(arm.fingers) * arm.side.sign();
    let axes = Mat3::from_cols(thumb_side, arm.fingers, arm.palm);
    let at = |p: Vec3| arm.wrist + axes * p * size;
    let p = |side: f32, along: f32, palm: f32| Vec3::new(side, along, palm);
    for (side, reach, length, radius) in FINGERS {
        let r = radius * (0.6 + 0.4 * b.limb);
        let knuckle = p(side, reach, -0.003);
        // Bones of the palm.
        g.cone(at(p(side * 0.55, 0.004, 0.0)), 0.0145 * size, at(knuckle), (r + 0.0012) * size, 0.018 * size);
        // Three joints, each more curled than the one before, converging towards the middle finger.
        let mut from = knuckle;
        for (joint, (share, curl)) in [(0.46, 0.2_f32), (0.3, 0.5), (0.24, 0.75)].into_iter().enumerate() {
            let close = -0.13 * (side - 0.001) / 0.03;
            let to = from + p(close, curl.cos(), curl.sin()) * length * share;
            let (r0, r1) = (r * (1.0 - 0.09 * joint as f32), r * (0.91 - 0.09 * joint as f32));
            g.cone(at(from), r0 * size, at(to), r1 * size, 0.006 * size);
            from = to;
        }
    }
    // Ball of the thumb, heel of the hand.
    let pad = |center: Vec3, radii: Vec3| Primitive::Ellipsoid { center: at(center), axes, radii: radii * size };
    g.add(pad(p(0.021, 0.036, 0.009), p(0.018, 0.032, 0.015)), 0.016 * size);
    g.add(pad(p(-0.021, 0.04, 0.006), p(0.015, 0.036, 0.013)), 0.016 * size);
    // Thumb.
    g.cone(at(p(0.02, 0.018, 0.008)), 0.0145 * size, at(p(0.043, 0.058, 0.017)), 0.0118 * size, 0.014 * size);
    g.cone(at(p(0.043, 0.058, 0.017)), 0.0116 * size, at(p(0.05, 0.09, 0.021)), 0.0098 * size, 0.005 * size);
    g.cone(at(p(0.05, 0.09, 0.021)), 0.0098 * size, at(p(0.05, 0.114, 0.022)), 0.0078 * size, 0.005 * size);
}

/// Adds a bare foot, flat on the floor.
pub fn add_foot(g: &mut PrimitiveGroup, leg: &Leg, b: &Build, unit: f32) {
    let size = (0.7 + 0.3 * b.limb) * unit;
    let inner = -leg.side.sign();
    let at = |side: f32, y: f32, z: f32| leg.foot.transform_point3(Vec3::new(side * inner, y, z) * size);
    let r = |metres: f32| metres * size;
    // Heel, ankle, bridge, ball.
    g.cone(at(0.0, 0.034, -0.036), r(0.031), at(0.0, 0.09, -0.01), r(0.03), 0.025 * size);
    g.cone(at(0.004, 0.075, 0.012), r(0.034), at(0.012, 0.04, 0.085), r(0.026), 0.03 * size);
    g.cone(at(-0.01, 0.036, -0.02), r(0.03), at(-0.026, 0.021, 0.115), r(0.02), 0.03 * size);
    g.cone(at(0.012, 0.04, 0.06), r(0.026), at(0.024, 0.026, 0.135), r(0.024), 0.03 * size);
    g.cone(at(0.02, 0.024, 0.132), r(0.022), at(-0.028, 0.02, 0.118), r(0.018), 0.025 * size);
    // Toes, the great one first.
    const TOES: [(f32, f32, f32); 5] = [
        (0.029, 0.192, 0.0142),
        (0.008, 0.196, 0.0105),
        (-0.0085, 0.188, 0.0098),
        (-0.0235, 0.176, 0.0092),
        (-0.0365, 0.161, 0.0088),
    ];
    for (side, tip, radius) in TOES {
        let root = at(side * 0.88 + 0.001, 0.022, tip - 0.062);
        let knuckle = at(side, radius + 0.007, tip - 0.027);
        g.cone(root, r(radius * 1.1), knuckle, r(radius), 0.012 * size);
        g.cone(knuckle, r(radius), at(side, radius * 0.95, tip - radius), r(radius * 0.92), 0.004 * size);
    }
    // Sole.
    let normal = Vec3::Y;
    g.cut(Primitive::HalfSpace { normal, offset: 0.000_5 }, 0.012 * size);
}

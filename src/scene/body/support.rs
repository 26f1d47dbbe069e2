//! Heads, stands and booms.

use super::builder::{Builder, turn};
use super::material::{BLACK_METAL, STEEL};
use super::shape::{BEHIND_EMITTER_M, HEAD_M, ModifierShape};
use glam::{Vec2, Vec3};

/// Radii of the tubes of a stand, from its foot to its top, metres.
const TUBES_M: [f32; 3] = [0.0175, 0.0145, 0.0115];
/// Reach of the legs of a stand, metres.
const FOOT_M: f32 = 0.5;
/// Length of a boom beyond its stand, with the counterweight, metres.
const COUNTERWEIGHT_M: f32 = 0.5;

/// Adds a monolight behind a modifier, or before an umbrella.
pub(super) fn head(builder: &mut Builder, shape: &ModifierShape) {
    let (length, radius) = HEAD_M;
    let side = shape.head_side();
    let start = shape.head_m() + BEHIND_EMITTER_M;
    // Beside the shaft of an umbrella
    let up = if shape.head_m() == shape.depth_m() { 0.0 } else { radius + 0.01 };
    let at = |z: f32| Vec3::new(0.0, up, start - side * z);
    builder.part(BLACK_METAL);
    builder.tube([at(0.0), at(0.06 * length)], [1.12 * radius; 2], 16);
    builder.tube([at(0.06 * length), at(0.94 * length)], [radius; 2], 16);
    builder.tube([at(0.94 * length), at(length)], [0.85 * radius; 2], 16);
    // The handle, which turns it
    builder.cuboid(
        Vec3::new(0.0, up - radius - 0.02, shape.stand_point_m()),
        [Vec3::X * 0.012, Vec3::Y * 0.03, Vec3::Z * 0.02],
    );
}

/// Adds a stand about the Y axis with its feet in the plane y = 0. A boom reaches from its top towards +X, with a
/// counterweight beyond.
pub(super) fn stand(builder: &mut Builder, height_m: f32, boom_m: f32) {
    builder.part(STEEL);
    let steps = [0.06_f32, 0.4, 0.7, 1.0].map(|part| height_m * part);
    for (index, radius) in TUBES_M.into_iter().enumerate() {
        builder.tube([Vec3::Y * steps[index], Vec3::Y * steps[index + 1]], [radius; 2], 10);
    }
    builder.part(BLACK_METAL);
    let hub = 0.3 * height_m.min(2.0);
    let reach = FOOT_M.min(0.7 * height_m);
    for leg in 0..3 {
        // A leg under the boom carries its weight
        let out = Vec2::from_angle(turn(leg, 3));
        let out = Vec3::new(out.x, 0.0, out.y);
        let foot = out * reach + Vec3::Y * 0.012_f32.min(0.1 * height_m);
        builder.tube([out * 0.01 + Vec3::Y * hub, foot], [0.009; 2], 6);
        builder.tube([Vec3::Y * steps[0], out * 0.5 * reach + Vec3::Y * 0.5 * (hub + foot.y)], [0.006; 2], 6);
    }
    for joint in &steps[1..3] {
        builder.tube([Vec3::Y * (joint - 0.03), Vec3::Y * (joint + 0.03)], [0.024; 2], 10);
    }
    if boom_m > 0.0 {
        builder.part(STEEL);
        let top = Vec3::Y * height_m;
        builder.tube([top + Vec3::X * boom_m, top - Vec3::X * COUNTERWEIGHT_M], [0.014; 2], 10);
        builder.part(BLACK_METAL);
        builder.tube([top - Vec3::Y * 0.04, top + Vec3::Y * 0.04], [0.03; 2], 10);
        let weight = top - Vec3::X * COUNTERWEIGHT_M;
        builder.cuboid(weight - Vec3::Y * 0.16, [Vec3::X * 0.07, Vec3::Y * 0.14, Vec3::Z * 0.1]);
    }
}

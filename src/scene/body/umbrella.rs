//! Umbrellas: canopy, ribs and shaft.

use super::builder::{Builder, turn};
use super::material::{BLACK_FABRIC, STEEL, WHITE_FABRIC};
use super::shape::{BEHIND_EMITTER_M, ModifierShape};
use crate::scene::modifier_kind::ModifierKind;
use glam::{Vec2, Vec3};

/// Ribs of an umbrella.
const RIBS: u32 = 8;
/// Rings of panels from the edge to the top.
const ROWS: u32 = 5;

/// Adds an umbrella: the hollow of one that reflects faces ahead, the point of a translucent one does.
pub(super) fn umbrella(builder: &mut Builder, shape: &ModifierShape) {
    let reflects = shape.kind == ModifierKind::Umbrella;
    let depth = shape.depth_m();
    // The round front lies inside of the octagon between the ribs
    let radius = 0.501 * shape.front_m.x / (0.5 * turn(1, RIBS)).cos();
    let cloth = (2e-3_f32).min(0.05 * depth);
    // Height over the edge, 0 to 1, as a spherical cap has it
    let rise = |out: f32| 1.0 - out * out;
    let z = |out: f32, lift: f32| match reflects {
        true => BEHIND_EMITTER_M + rise(out) * (depth - cloth) + lift,
        false => BEHIND_EMITTER_M + (1.0 - rise(out)) * (depth - cloth) + lift,
    };
    let ring = |row: u32, lift: f32| -> Vec<Vec3> {
        let out = row as f32 / ROWS as f32;
        (0..RIBS).map(|rib| (Vec2::from_angle(turn(rib, RIBS)) * radius * out).extend(z(out, lift))).collect()
    };
    let (front, back): (Vec<_>, Vec<_>) = (0..=ROWS).map(|row| (ring(row, 0.0), ring(row, cloth))).unzip();
    let (inside, outside) = if reflects { (WHITE_FABRIC, BLACK_FABRIC) } else { (WHITE_FABRIC, WHITE_FABRIC) };
    builder.part(inside);
    for row in 0..ROWS as usize {
        builder.strip(&front[row], &front[row + 1]);
    }
    builder.part(outside);
    builder.strip(&front[ROWS as usize], &back[ROWS as usize]);
    for row in (0..ROWS as usize).rev() {
        builder.strip(&back[row + 1], &back[row]);
    }
    builder.part(STEEL);
    let thin = (1.5e-3_f32).min(0.01 * radius);
    let hollow = if reflects { -2.0 * thin } else { cloth + 2.0 * thin };
    for rib in 0..RIBS {
        let around = Vec2::from_angle(turn(rib, RIBS)) * radius;
        let points: [Vec3; 4] = std::array::from_fn(|i| {
            let out = i as f32 / 3.0 * 0.98;
            (around * out).extend(z(out, hollow))
        });
        for pair in points.windows(2) {
            builder.tube([pair[0], pair[1]], [thin; 2], 4);
        }
    }
    // The shaft, from the top past the head
    let top = z(0.0, 0.0);
    let end = shape.head_m() - 0.1 * shape.head_side();
    let thick = (4e-3_f32).min(0.03 * radius);
    builder.tube([Vec3::Z * top.min(end), Vec3::Z * top.max(end)], [thick; 2], 8);
}

//! Softboxes, octas, lanterns and framed cloth.

use super::builder::{Builder, turn};
use super::material::{ALUMINIUM, BLACK_FABRIC, BLACK_METAL, WHITE_FABRIC};
use super::shape::{BEHIND_EMITTER_M, ModifierShape};
use glam::{Vec2, Vec3};

/// Width of the rim around a front, metres.
const RIM_M: f32 = 0.02;
/// Radius of the ring at the back, which holds the rods, metres.
const SPEEDRING_M: f32 = 0.09;
/// The bow of the cloth over its rods: part of the depth, and part of the way from rim to speedring.
const BOW: [(f32, f32); 4] = [(0.0, 0.0), (0.35, 0.12), (0.7, 0.42), (1.0, 1.0)];
/// Edge of the cells of a grid of fabric, its depth and half of the thickness of its walls, metres.
const CELL_M: (f32, f32, f32) = (0.09, 0.05, 0.001);
/// Most walls of a grid in one direction.
const MOST_WALLS: f32 = 14.0;

/// Adds a rectangular softbox.
pub(super) fn softbox(builder: &mut Builder, shape: &ModifierShape) {
    let half = 0.5 * shape.front_m;
    let corners = [(-1.0, -1.0), (1.0, -1.0), (1.0, 1.0), (-1.0, 1.0)].map(|(x, y)| Vec2::new(x, y));
    let front = corners.map(|corner| corner * half);
    let outside = corners.map(|corner| corner * (half + rim_m(shape)));
    box_of_cloth(builder, shape, &front, &outside);
    if shape.has_grid {
        grid(builder, half, |_| 1.0);
    }
}

/// Adds an octagonal softbox around its round front.
pub(super) fn octa(builder: &mut Builder, shape: &ModifierShape) {
    let radius = 0.5 * shape.front_m.x;
    // The round front lies inside of the octagon
    let around = (radius * 1.001 + 0.5 * rim_m(shape)) / (0.5 * turn(1, 8)).cos();
    let corners: [Vec2; 8] = std::array::from_fn(|i| Vec2::from_angle(turn(i as u32, 8) + 0.5 * turn(1, 8)));
    let front = corners.map(|corner| corner * radius / (0.5 * turn(1, 8)).cos());
    box_of_cloth(builder, shape, &front, &corners.map(|corner| corner * around));
    if shape.has_grid {
        grid(builder, Vec2::splat(radius), |across| (1.0 - across * across).max(0.0).sqrt());
    }
}

fn rim_m(shape: &ModifierShape) -> f32 {
    RIM_M.min(0.1 * shape.front_m.min_element())
}

/// Adds a box of black cloth with a white front: from its front over its rim to the speedring.
fn box_of_cloth(builder: &mut Builder, shape: &ModifierShape, front: &[Vec2], outside: &[Vec2]) {
    let depth = shape.depth_m();
    let ring = |points: &[Vec2], z: f32| -> Vec<Vec3> { points.iter().map(|point| point.extend(z)).collect() };
    let flat_front = ring(front, BEHIND_EMITTER_M);
    builder.part(WHITE_FABRIC);
    builder.cap(&flat_front, false);
    builder.part(BLACK_FABRIC);
    let narrow = SPEEDRING_M.min(0.6 * outside.iter().map(|point| point.length()).fold(f32::INFINITY, f32::min));
    let rings: Vec<Vec<Vec3>> = BOW
        .iter()
        .map(|&(back, inwards)| {
            let points = outside.iter().map(|point| point.lerp(point.normalize_or_zero() * narrow, inwards));
            ring(&points.collect::<Vec<_>>(), BEHIND_EMITTER_M + back * depth)
        })
        .collect();
    builder.strip(&flat_front, &rings[0]);
    for pair in rings.windows(2) {
        builder.strip(&pair[0], &pair[1]);
    }
    builder.part(BLACK_METAL);
    builder.cap(&rings[BOW.len() - 1], true);
}

/// Adds the crossed walls of a fabric grid before a front. `reach` is the part of the half size that a wall spans, by its
/// place across, -1 to 1.
fn grid(builder: &mut Builder, half: Vec2, reach: impl Fn(f32) -> f32) {
    let (cell, depth, thickness) = CELL_M;
    builder.part(BLACK_FABRIC);
    let z = Vec3::Z * 0.5 * depth;
    let thickness = thickness.min(0.01 * half.min_element());
    for (along, across, length, width) in [(Vec3::X, Vec3::Y, half.x, half.y), (Vec3::Y, Vec3::X, half.y, half.x)] {
        let walls = (2.0 * width / cell).clamp(2.0, MOST_WALLS).round() as u32;
        for wall in 0..=walls {
            let place = 2.0 * wall as f32 / walls as f32 - 1.0;
            let reach = length * reach(place);
            if reach > 0.05 * length {
                let right = along * reach;
                let up = across * if right.cross(across).z > 0.0 { thickness } else { -thickness };
                builder.cuboid(across * width * place - z, [right, up, z]);
            }
        }
    }
}

/// Adds cloth in a frame.
pub(super) fn frame(builder: &mut Builder, shape: &ModifierShape) {
    let half = 0.5 * shape.front_m;
    let tube = 0.0125_f32.min(0.05 * half.min_element());
    let cloth = tube.min(1e-3);
    builder.part(WHITE_FABRIC);
    let (x, y) = (Vec3::X * half.x, Vec3::Y * half.y);
    builder.cuboid(Vec3::Z * (BEHIND_EMITTER_M + cloth), [x, y, Vec3::Z * cloth]);
    builder.part(ALUMINIUM);
    let z = Vec3::Z * tube;
    for side in [-1.0, 1.0] {
        let middle = Vec3::Z * (BEHIND_EMITTER_M + tube);
        builder.cuboid(middle + Vec3::X * side * (half.x + tube), [Vec3::X * tube, y + Vec3::Y * 2.0 * tube, z]);
        builder.cuboid(middle + Vec3::Y * side * (half.y + tube), [x, Vec3::Y * tube, z]);
    }
}

/// Adds the paper of a lantern, inside of its luminous sphere.
pub(super) fn lantern(builder: &mut Builder, shape: &ModifierShape) {
    let radius = 0.5 * shape.front_m.x - BEHIND_EMITTER_M;
    const ROWS: u32 = 10;
    let at = |row: u32| {
        let angle = 0.5 * turn(row, ROWS);
        let out = if row == 0 || row == ROWS { 0.0 } else { angle.sin() };
        (radius * out, -radius * angle.cos())
    };
    builder.part(WHITE_FABRIC);
    builder.lathe(&(0..=ROWS).map(at).collect::<Vec<_>>(), 24);
}

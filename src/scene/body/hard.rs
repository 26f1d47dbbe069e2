//! Beauty dishes, reflectors, snoots and projectors, with honeycombs and barn doors.

use super::builder::{Builder, turn};
use super::material::{ALUMINIUM, BLACK_METAL, WHITE_PAINT};
use super::shape::{BEHIND_EMITTER_M, HEAD_M, ModifierShape};
use crate::scene::BarnDoors;
use glam::{Vec2, Vec3};

/// Thickness of sheet metal, metres.
const SHEET_M: f32 = 2e-3;
/// Sides of what is round.
const SIDES: u32 = 32;
/// Walls of a honeycomb in each of its three directions.
const WALLS: u32 = 7;

/// Adds a white dish with its deflector.
pub(super) fn dish(builder: &mut Builder, shape: &ModifierShape) {
    let (radius, depth) = (0.5 * shape.front_m.x, shape.depth_m());
    bowl(builder, radius, depth, (WHITE_PAINT, WHITE_PAINT));
    // The deflector before the lamp, on three pins
    builder.part(WHITE_PAINT);
    let (disc, z) = (0.3 * radius, BEHIND_EMITTER_M + 0.45 * depth);
    let sheet = sheet_m(radius);
    builder.lathe(&[(0.0, z), (disc, z + 0.15 * depth), (disc, z + 0.15 * depth + sheet), (0.0, z + sheet)], SIDES);
    builder.part(BLACK_METAL);
    for pin in 0..3 {
        let out = (Vec2::from_angle(turn(pin, 3)) * 0.8 * disc).extend(0.0);
        let ends = [out + Vec3::Z * (z + 0.13 * depth), out + Vec3::Z * (BEHIND_EMITTER_M + depth - sheet)];
        builder.tube(ends, [sheet; 2], 6);
    }
    accessories(builder, shape, radius);
}

/// Adds a standard reflector.
pub(super) fn reflector(builder: &mut Builder, shape: &ModifierShape) {
    let radius = 0.5 * shape.front_m.x;
    bowl(builder, radius, shape.depth_m(), (BLACK_METAL, ALUMINIUM));
    accessories(builder, shape, radius);
}

/// Adds a tube that ends in a reflector.
pub(super) fn snoot(builder: &mut Builder, shape: &ModifierShape) {
    let (radius, depth) = (0.5 * shape.front_m.x, shape.depth_m());
    let (front, back) = (BEHIND_EMITTER_M, BEHIND_EMITTER_M + depth);
    let wide = HEAD_M.1.max(1.3 * radius);
    let sheet = sheet_m(radius);
    builder.part(BLACK_METAL);
    let inside = [(0.0, back - sheet), (wide - sheet, back - sheet), (radius - sheet, front)];
    builder.lathe(&[&inside[..], &[(radius, front), (wide, back), (0.0, back)]].concat(), SIDES);
    accessories(builder, shape, radius);
}

/// Adds a projector: a long tube with a lens, which is drawn dark.
pub(super) fn projector(builder: &mut Builder, shape: &ModifierShape) {
    let (radius, depth) = (0.5 * shape.front_m.x, shape.depth_m());
    let (front, back) = (BEHIND_EMITTER_M, BEHIND_EMITTER_M + depth);
    let (inner, waist) = (0.9 * radius, 0.75 * radius);
    builder.part(BLACK_METAL);
    let sunk = (0.1 * radius).min(0.1 * depth);
    let lens = [(0.0, front + sunk), (inner, front + 3.0 * sunk), (inner, front), (radius, front)];
    let tube = [(radius, front + 0.4 * depth), (waist, front + 0.45 * depth), (waist, back), (0.0, back)];
    builder.lathe(&[lens, tube].concat(), SIDES);
    accessories(builder, shape, radius);
}

fn sheet_m(radius: f32) -> f32 {
    SHEET_M.min(0.1 * radius)
}

/// Adds an open bowl from its mouth to the head, with the materials of its outside and its inside.
fn bowl(builder: &mut Builder, radius: f32, depth: f32, (outside, inside): (&str, &str)) {
    let narrow = HEAD_M.1.min(0.5 * radius);
    let sheet = sheet_m(radius);
    let (front, back) = (BEHIND_EMITTER_M, BEHIND_EMITTER_M + depth);
    let profile = |inset: f32| {
        [(0.0, 1.0), (0.3, 0.95), (0.7, 0.74), (1.0, 0.3)].map(|(deep, wide)| {
            let z = front + deep * (depth - inset);
            ((narrow + wide * (radius - narrow) - inset).max(0.0), if deep == 0.0 { front } else { z })
        })
    };
    // Inside and outside meet on the rim: together they enclose the sheet
    let mut inner = profile(sheet).to_vec();
    inner.push((0.0, back - sheet));
    inner.reverse();
    inner.push((radius, front));
    let mut outer = vec![(radius, front)];
    outer.extend(profile(0.0));
    outer.push((0.0, back));
    builder.part(inside);
    builder.lathe(&inner, SIDES);
    builder.part(outside);
    builder.lathe(&outer, SIDES);
}

/// Adds the honeycomb and the barn doors before a round front.
fn accessories(builder: &mut Builder, shape: &ModifierShape, radius: f32) {
    builder.part(BLACK_METAL);
    if shape.has_grid {
        honeycomb(builder, radius);
    }
    if let Some(doors) = &shape.doors {
        barn_doors(builder, Vec2::splat(radius), doors);
    }
}

/// Adds three sets of parallel walls, whose cells look like those of a honeycomb.
fn honeycomb(builder: &mut Builder, radius: f32) {
    let (depth, thickness) = ((0.12 * radius).max(1e-4), 0.006 * radius);
    for direction in 0..3 {
        let along = Vec2::from_angle(turn(direction, 6)).extend(0.0);
        let across = Vec3::Z.cross(along);
        for wall in 0..WALLS {
            let place = (2.0 * (wall as f32 + 0.5) / WALLS as f32 - 1.0) * radius;
            let reach = (radius * radius - place * place).max(0.0).sqrt();
            let centre = across * place - Vec3::Z * depth;
            builder.cuboid(centre, [along * reach, across * thickness, Vec3::Z * depth]);
        }
    }
    // The ring that holds it
    let rim = (radius, 1.03 * radius);
    let (front, back) = (-2.0 * depth, BEHIND_EMITTER_M);
    let ring = |r: f32, z: f32| -> Vec<Vec3> {
        (0..SIDES).map(|side| (Vec2::from_angle(turn(side, SIDES)) * r).extend(z)).collect()
    };
    let [inner_front, outer_front, outer_back, inner_back] =
        [(rim.0, front), (rim.1, front), (rim.1, back), (rim.0, back)].map(|(r, z)| ring(r, z));
    for (from, to) in [
        (&inner_front, &outer_front),
        (&outer_front, &outer_back),
        (&outer_back, &inner_back),
        (&inner_back, &inner_front),
    ] {
        builder.strip(from, to);
    }
}

/// Adds four flaps, hinged at the edges of a front.
pub(super) fn barn_doors(builder: &mut Builder, half: Vec2, doors: &BarnDoors) {
    let BarnDoors { left_deg, right_deg, top_deg, bottom_deg } = *doors;
    builder.part(BLACK_METAL);
    for (out, reach, width, open_deg) in [
        (Vec3::NEG_X, half.x, half.y, left_deg),
        (Vec3::X, half.x, half.y, right_deg),
        (Vec3::Y, half.y, half.x, top_deg),
        (Vec3::NEG_Y, half.y, half.x, bottom_deg),
    ] {
        let (sin, cos) = open_deg.to_radians().sin_cos();
        let ahead = out * sin - Vec3::Z * cos;
        let side = ahead.cross(out * cos + Vec3::Z * sin);
        let length = (0.9 * reach).min(0.25);
        let thickness = 0.01 * length;
        let hinge = out * reach;
        let flap = [side * width, ahead * 0.5 * length, side.cross(ahead) * thickness];
        builder.cuboid(hinge + ahead * 0.5 * length, flap);
    }
}

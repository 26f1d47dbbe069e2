//! The surface of the head as a height field over directions: what hair lies on.

use super::hair_body::HairBody;
use crate::figures::patch::Patch;
use crate::figures::subdivide::{QuadMesh, SubdivisionSurface};
use crate::math::atan2;
use glam::{Vec2, Vec3};
use std::f32::consts::{PI, TAU};

/// Cells from the top to the bottom, and round: 6 mm on a head.
const ROWS: usize = 48;
const COLUMNS: usize = 96;
/// Height of the lowest skin that counts, from the eyes of the base mesh, metres: the throat.
const LOWEST_M: f32 = -0.15;

/// Distances of the skin from a point inside of the skull, in the head's frame.
#[derive(Clone, Debug)]
pub struct HeadSurface {
    centre: Vec3,
    /// Rows from the top, metres.
    radii: Vec<f32>,
    /// The largest of them, metres.
    greatest: f32,
}

impl HeadSurface {
    /// Measures the skin of the head. Ears count if hair lies over them.
    pub fn new(body: &HairBody, centre: Vec3, over_ears: bool) -> HeadSurface {
        let eyes = body.data.eyes_middle();
        let to_head = body.head.inverse();
        let is_head = |v: u16| {
            let place = body.data.positions[usize::from(v)] - eyes;
            place.y > LOWEST_M && (over_ears || !is_ear(place))
        };
        let wanted = |quad: &[u16; 4]| quad.iter().all(|&v| is_head(v));
        let patch = Patch::new(body.data, "body", body.positions, &wanted);
        let skin = QuadMesh { positions: patch.positions, quads: patch.quads, uvs: patch.uvs, ..QuadMesh::default() };
        let mut surface = HeadSurface { centre, radii: vec![0.0; ROWS * COLUMNS], greatest: 0.0 };
        for position in SubdivisionSurface::new(skin).subdivided().subdivided().mesh.positions {
            let offset = to_head.transform_point3(position) - centre;
            let cell = cell_of(offset).round().as_uvec2();
            let index = (cell.y as usize).min(ROWS - 1) * COLUMNS + cell.x as usize % COLUMNS;
            surface.radii[index] = surface.radii[index].max(offset.length());
        }
        surface.fill_gaps();
        surface.greatest = surface.radii.iter().copied().fold(0.0, f32::max);
        surface
    }

    /// Gives cells without skin the mean of their neighbours, from the rims of gaps inwards.
    fn fill_gaps(&mut self) {
        while self.radii.contains(&0.0) && self.radii.iter().any(|r| *r > 0.0) {
            let old = self.radii.clone();
            for index in (0..old.len()).filter(|&i| old[i] == 0.0) {
                let (row, column) = (index / COLUMNS, index % COLUMNS);
                let around = [
                    row * COLUMNS + (column + 1) % COLUMNS,
                    row * COLUMNS + (column + COLUMNS - 1) % COLUMNS,
                    row.saturating_sub(1) * COLUMNS + column,
                    (row + 1).min(ROWS - 1) * COLUMNS + column,
                ];
                let known: Vec<f32> = around.into_iter().map(|i| old[i]).filter(|r| *r > 0.0).collect();
                self.radii[index] = known.iter().sum::<f32>() / known.len().max(1) as f32;
            }
        }
    }

    /// Returns the distance of the skin from the middle in the direction of a point, metres.
    fn radius_towards(&self, offset: Vec3) -> f32 {
        let at = cell_of(offset);
        // Both are at least 0: the whole parts are what is before the point
        let (column, line) = (at.x as usize, at.y as usize);
        let t = at - Vec2::new(column as f32, line as f32);
        let value = |dx: usize, dy: usize| self.radii[(line + dy).min(ROWS - 1) * COLUMNS + (column + dx) % COLUMNS];
        let row = |dy: usize| value(0, dy) + (value(1, dy) - value(0, dy)) * t.x;
        row(0) + (row(1) - row(0)) * t.y
    }

    /// Returns the height of a point over the skin, metres; negative inside.
    pub fn height(&self, p: Vec3) -> f32 {
        (p - self.centre).length() - self.radius_towards(p - self.centre)
    }

    /// Returns a point moved out to at least this height over the skin, metres.
    pub fn pushed_out(&self, p: Vec3, height: f32) -> Vec3 {
        // Most of long hair is farther away than any skin
        if (p - self.centre).length() >= self.greatest + height {
            return p;
        }
        let missing = height - self.height(p);
        if missing > 0.0 { p + (p - self.centre).normalize_or(Vec3::Y) * missing } else { p }
    }
}

/// Returns true for a place on an ear of the base mesh, from between its eyes, metres.
pub fn is_ear(place: Vec3) -> bool {
    place.x.abs() > 0.075 && place.y < 0.03 && (-0.125..-0.055).contains(&place.z)
}

/// Returns column and row of a direction of any length, of cells whose middles are at whole numbers.
#[inline(always)]
fn cell_of(offset: Vec3) -> Vec2 {
    let turn = atan2(offset.x, offset.z) / TAU;
    let turn = if turn < 0.0 { turn + 1.0 } else { turn };
    let polar = atan2((offset.x * offset.x + offset.z * offset.z).sqrt(), offset.y);
    Vec2::new(turn * COLUMNS as f32, polar / PI * (ROWS - 1) as f32)
}

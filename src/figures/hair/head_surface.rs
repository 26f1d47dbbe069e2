//! The surface of the head as a height field over directions: what hair lies on.

use super::hair_body::HairBody;
use crate::figures::patch::Patch;
use crate::figures::subdivide::{QuadMesh, SubdivisionSurface};
use crate::math::atan2;
use crate::math::simd::{self, Avx2, LANES, SimdTask};
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

    /// Returns the distance of the skin from the middle in the direction of a column and row, metres.
    fn radius_at(&self, at: Vec2) -> f32 {
        // Both are at least 0: the whole parts are what is before the point
        let (column, line) = (at.x as usize, at.y as usize);
        let t = at - Vec2::new(column as f32, line as f32);
        let value = |dx: usize, dy: usize| self.radii[(line + dy).min(ROWS - 1) * COLUMNS + (column + dx) % COLUMNS];
        let row = |dy: usize| value(0, dy) + (value(1, dy) - value(0, dy)) * t.x;
        row(0) + (row(1) - row(0)) * t.y
    }

    /// Returns the height of a point over the skin, metres; negative inside.
    pub fn height(&self, p: Vec3) -> f32 {
        (p - self.centre).length() - self.radius_at(cell_of(p - self.centre))
    }

    /// Moves points as [`HeadSurface::pushed_out`] does, to the bit.
    pub fn push_out(&self, points: &mut [Vec3], height: f32) {
        for points in points.chunks_mut(LANES) {
            let mut offsets = [Vec3::splat(self.greatest + height); LANES];
            offsets.iter_mut().zip(&*points).for_each(|(offset, p)| *offset = *p - self.centre);
            // Most of long hair is farther away than any skin
            if offsets.iter().all(|offset| offset.length() >= self.greatest + height) {
                continue;
            }
            let cells = simd::dispatch(Cells(&offsets));
            for ((p, offset), cell) in points.iter_mut().zip(offsets).zip(cells) {
                let missing = height - (offset.length() - self.radius_at(cell));
                if missing > 0.0 {
                    *p += offset.normalize_or(Vec3::Y) * missing;
                }
            }
        }
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

/// Columns and rows of directions, one a lane.
struct Cells<'a>(&'a [Vec3; LANES]);

impl SimdTask for Cells<'_> {
    type Output = [Vec2; LANES];

    #[inline(always)]
    fn run(self, _: Option<Avx2>) -> [Vec2; LANES] {
        let offsets = self.0;
        let [x, y, z] = [0, 1, 2].map(|axis| -> [f32; LANES] { std::array::from_fn(|i| offsets[i][axis]) });
        let (mut columns, mut rows) = ([0.0; LANES], [0.0; LANES]);
        for i in 0..LANES {
            let cell = cell_of(Vec3::new(x[i], y[i], z[i]));
            (columns[i], rows[i]) = (cell.x, cell.y);
        }
        std::array::from_fn(|i| Vec2::new(columns[i], rows[i]))
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

#[cfg(test)]
mod tests {
    use super::*;
    use crate::figures::random::Random;

    #[test]
    fn points_are_moved_together_as_one_by_one() {
        let radii: Vec<f32> = (0..ROWS * COLUMNS).map(|i| 0.1 + 0.01 * (i as f32 * 0.37).sin()).collect();
        let greatest = radii.iter().copied().fold(0.0, f32::max);
        let surface = HeadSurface { centre: Vec3::new(0.0, 0.02, -0.08), radii, greatest };
        let mut random = Random::new(3, 0);
        let mut point = || surface.centre + Vec3::new(random.bell(), random.bell(), random.bell()) * 0.06;
        let points: Vec<Vec3> = (0..1003).map(|_| point()).collect();
        let mut together = points.clone();
        surface.push_out(&mut together, 0.002);
        let one_by_one: Vec<Vec3> = points.iter().map(|p| surface.pushed_out(*p, 0.002)).collect();
        assert_eq!(together, one_by_one);
        let moved = points.iter().zip(&together).filter(|(before, after)| before != after).count();
        assert!((200..900).contains(&moved), "{moved} of 1003");
    }
}

//! Patches: triangles of casters, or equal parts of large ones.

use glam::{Vec2, Vec3};

/// One of n x n congruent parts of a triangle. They lie in n rows of 2n - 1, 2n - 3 ... 1 parts, of which every other
/// one is upside down.
#[derive(Clone, Copy, Debug)]
pub struct Patch {
    /// Index of the instance.
    pub instance: u32,
    /// Index of the triangle in its mesh.
    pub triangle: u32,
    /// Number of divisions of the triangle's edges.
    divisions: u16,
    /// Row, along the third corner.
    row: u16,
    /// Position in the row: odd ones are upside down.
    column: u16,
}

impl Patch {
    /// Divides a triangle into `count` patches at least; `count` is at most 10^8.
    pub fn divide(instance: u32, triangle: u32, count: f64) -> impl Iterator<Item = Patch> {
        let divisions = count.sqrt().ceil().max(1.0) as u16;
        let row = move |row: u16| {
            let columns = 0..2 * (divisions - row) - 1;
            columns.map(move |column| Patch { instance, triangle, divisions, row, column })
        };
        (0..divisions).flat_map(row)
    }

    /// Returns the share of the triangle's area.
    pub fn share(&self) -> f64 {
        1.0 / (f64::from(self.divisions) * f64::from(self.divisions))
    }

    /// Returns the barycentric coordinates, of the second and the third corner, of a point that is uniform in the patch
    /// for a uniform `u`.
    pub fn barycentric(&self, u: Vec2) -> [f32; 2] {
        // The square folded onto the triangle along its diagonal
        let folded = if u.x + u.y < 1.0 { u } else { Vec2::ONE - u };
        self.in_triangle(folded)
    }

    /// Returns the centre, for a triangle with these corners.
    pub fn centre(&self, [a, b, c]: [Vec3; 3]) -> Vec3 {
        let [v, w] = self.in_triangle(Vec2::splat(1.0 / 3.0));
        a + (b - a) * v + (c - a) * w
    }

    /// Returns the barycentric coordinates in the triangle from those in the patch.
    fn in_triangle(&self, point: Vec2) -> [f32; 2] {
        let corner = Vec2::new(f32::from(self.column / 2), f32::from(self.row));
        let in_cell = if self.column.is_multiple_of(2) { point } else { Vec2::ONE - point };
        ((corner + in_cell) / f32::from(self.divisions)).to_array()
    }

    /// Returns the index of the patch that contains a point, among the `count` patches of its triangle in the order of
    /// [`Self::divide`].
    pub fn index_at(count: u32, barycentric: [f32; 2]) -> u32 {
        let divisions = count.isqrt();
        let point = Vec2::from(barycentric).clamp(Vec2::ZERO, Vec2::ONE) * divisions as f32;
        let row = (point.y as u32).min(divisions - 1);
        let in_row = 2 * (divisions - row) - 1;
        let is_upper = point.x.fract() + point.y.fract() >= 1.0;
        let column = (2 * point.x as u32 + u32::from(is_upper)).min(in_row - 1);
        // The rows before
        row * (2 * divisions - row) + column
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::statistics::TestRng;

    #[test]
    fn patches_are_found_by_their_points_and_cover_the_triangle_evenly() {
        let mut rng = TestRng::new(3);
        for wanted in [0.1, 1.0, 3.0, 100.0, 8192.0] {
            let patches: Vec<Patch> = Patch::divide(2, 7, wanted).collect();
            let count = patches.len() as u32;
            assert!(f64::from(count) >= wanted, "{count} for {wanted}");
            let share: f64 = patches.iter().map(Patch::share).sum();
            assert!((share - 1.0).abs() < 1e-9);
            for (index, patch) in (0..).zip(&patches) {
                // Away from edges, where rounding decides
                let inside = Vec2::splat(0.01) + rng.unit_square() * 0.48;
                let point = patch.barycentric(inside);
                assert_eq!(Patch::index_at(count, point), index, "{patch:?} of {count} at {point:?}");
                assert!(point[0] >= 0.0 && point[1] >= 0.0 && point[0] + point[1] <= 1.0 + 1e-6);
            }
        }
        for corner in [[0.0, 0.0], [1.0, 0.0], [0.0, 1.0], [-1e-7, 1.0], [0.5, 0.500_001]] {
            assert!(Patch::index_at(16, corner) < 16, "{corner:?}");
        }
    }
}

//! Traversal of a grid of cells, for `catchlight chart --voxels` (Amanatides and Woo 1987, "A Fast Voxel Traversal
//! Algorithm for Ray Tracing"), cell by cell or with a jump over each empty brick of 8 x 8 x 8 cells.
//!
//! Renders trace the faces of the cells in their BVH; the chart compares the three.

use crate::math::Ray;
use glam::{IVec3, Vec3};

/// Cells along each edge of a brick, as a power of two.
const BRICK_BITS: i32 = 3;
/// Cells along each edge of a brick.
const BRICK: i32 = 1 << BRICK_BITS;
/// Words of 64 cells in a brick.
const WORDS: usize = 8;
/// The index of a brick without filled cells.
const EMPTY: u32 = u32::MAX;

/// Cells of edge 1 that are filled or not, in bricks. An empty brick takes four bytes, another one 68.
#[derive(Debug)]
pub struct VoxelGrid {
    size: IVec3,
    bricks: IVec3,
    /// Index of each brick's cells.
    index: Vec<u32>,
    cells: Vec<[u64; WORDS]>,
}

/// The first filled cell on a ray.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct VoxelHit {
    /// The cell.
    pub cell: IVec3,
    /// Distance of its face, in multiples of the ray's direction; 0 for a ray that starts in it.
    pub t: f32,
    /// Normal of the face; zero for a ray that starts in the cell.
    pub normal: IVec3,
}

/// The way through the empty cells.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum VoxelWay {
    /// Every cell.
    Cells,
    /// Every cell of bricks that are not empty, and those bricks at once that are.
    Bricks,
}

impl VoxelGrid {
    /// Returns a grid of so many cells; `is_filled` says of each cell whether it is filled.
    pub fn new(size: [usize; 3], is_filled: impl Fn([usize; 3]) -> bool) -> Self {
        let size = IVec3::from(size.map(|side| side as i32));
        let bricks = (size + (BRICK - 1)) / BRICK;
        let mut grid =
            VoxelGrid { size, bricks, index: vec![EMPTY; bricks.element_product() as usize], cells: Vec::new() };
        for z in 0..size.z {
            for y in 0..size.y {
                for x in 0..size.x {
                    let cell = IVec3::new(x, y, z);
                    if is_filled(cell.to_array().map(|side| side as usize)) {
                        grid.fill(cell);
                    }
                }
            }
        }
        grid
    }

    fn fill(&mut self, cell: IVec3) {
        let brick = self.brick_of(cell);
        if self.index[brick] == EMPTY {
            self.index[brick] = self.cells.len() as u32;
            self.cells.push([0; WORDS]);
        }
        let (word, bit) = place_in_brick(cell);
        self.cells[self.index[brick] as usize][word] |= 1 << bit;
    }

    fn brick_of(&self, cell: IVec3) -> usize {
        let brick = cell >> BRICK_BITS;
        ((brick.z * self.bricks.y + brick.y) * self.bricks.x + brick.x) as usize
    }

    /// Returns true for a filled cell.
    fn is_filled(&self, brick: u32, cell: IVec3) -> bool {
        let (word, bit) = place_in_brick(cell);
        brick != EMPTY && self.cells[brick as usize][word] >> bit & 1 == 1
    }

    /// Returns the memory of the cells, bytes.
    pub fn bytes(&self) -> usize {
        size_of_val(&self.index[..]) + size_of_val(&self.cells[..])
    }

    /// Returns the first filled cell on a ray, and the number of cells and bricks that it has visited.
    pub fn intersect(&self, ray: &Ray, way: VoxelWay) -> (Option<VoxelHit>, u32) {
        // Clip the ray to the grid
        let inverse = ray.direction.recip();
        let (near, far) = (-ray.origin * inverse, (self.size.as_vec3() - ray.origin) * inverse);
        // Rays in the plane of a side give NaN there, which min and max drop
        let is_usable = ray.origin.is_finite() && ray.direction.is_finite() && self.size.min_element() > 0;
        let enter = near.min(far).max_element().max(0.0);
        let exit = near.max(far).min_element().min(ray.t_max);
        let is_met = is_usable && enter <= exit;
        if !is_met {
            return (None, 0);
        }
        let step = ray.direction.signum().as_ivec3();
        let last = self.size - 1;
        let mut cell = (ray.origin + ray.direction * enter).floor().as_ivec3().clamp(IVec3::ZERO, last);
        let (mut t, mut visited) = (enter, 0);
        let mut normal = if enter > 0.0 { side_of_entry(near.min(far), step) } else { IVec3::ZERO };
        loop {
            visited += 1;
            let brick = self.index[self.brick_of(cell)];
            if self.is_filled(brick, cell) {
                return (Some(VoxelHit { cell, t, normal }), visited);
            }
            // The far corner of the cell, or of the empty brick around it
            let is_jump = way == VoxelWay::Bricks && brick == EMPTY;
            let low = if is_jump { cell >> BRICK_BITS << BRICK_BITS } else { cell };
            let side = if is_jump { BRICK } else { 1 };
            let ahead = low + step.max(IVec3::ZERO) * side;
            let leave = ((ahead.as_vec3() - ray.origin) * inverse).to_array();
            let leave = leave.map(|t| if t.is_nan() { f32::INFINITY } else { t });
            let axis = if leave[0] <= leave[1] && leave[0] <= leave[2] {
                0
            } else if leave[1] <= leave[2] {
                1
            } else {
                2
            };
            t = leave[axis].max(t);
            if is_jump {
                let at = (ray.origin + ray.direction * t).floor().as_ivec3();
                cell = at.clamp(low, low + (BRICK - 1));
                cell[axis] = if step[axis] > 0 { ahead[axis] - 1 } else { ahead[axis] };
            }
            cell[axis] += step[axis];
            if t > exit || cell[axis] < 0 || cell[axis] > last[axis] {
                return (None, visited);
            }
            // A jump may round past the last cells of an uneven grid
            cell = cell.min(last);
            normal = IVec3::ZERO;
            normal[axis] = -step[axis];
        }
    }
}

/// Returns the word and the bit of a cell in its brick.
fn place_in_brick(cell: IVec3) -> (usize, i32) {
    let within = cell & (BRICK - 1);
    (within.z as usize, within.y * BRICK + within.x)
}

/// Returns the normal of the side of the grid through which a ray enters.
fn side_of_entry(enters: Vec3, step: IVec3) -> IVec3 {
    let axis = enters.max_position();
    let mut normal = IVec3::ZERO;
    normal[axis] = -step[axis];
    normal
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::math::warp;
    use glam::Vec2;

    /// Returns the distance of the nearest filled cell by a test of every cell.
    fn brute_force(filled: &[IVec3], ray: &Ray) -> Option<f32> {
        let inverse = ray.direction.recip();
        let distance = |cell: &IVec3| {
            let near = (cell.as_vec3() - ray.origin) * inverse;
            let far = ((cell + 1).as_vec3() - ray.origin) * inverse;
            let (enter, exit) = (near.min(far).max_element().max(0.0), near.max(far).min_element());
            (enter <= exit && enter <= ray.t_max).then_some(enter)
        };
        filled.iter().filter_map(distance).min_by(f32::total_cmp)
    }

    #[test]
    fn both_ways_find_the_cell_that_brute_force_finds() {
        let size = [21, 13, 30];
        // Sparse: whole bricks are empty
        let is_filled = |[x, y, z]: [usize; 3]| (x * 7 + y * 13 + z * 29) % 97 == 0 && !(8..16).contains(&x);
        let grid = VoxelGrid::new(size, is_filled);
        let cells = (0..21).flat_map(|x| (0..13).flat_map(move |y| (0..30).map(move |z| [x, y, z])));
        let filled: Vec<IVec3> =
            cells.filter(|cell| is_filled(*cell)).map(|cell| IVec3::from(cell.map(|side| side as i32))).collect();
        let (mut hits, mut visits) = (0, [0, 0]);
        for i in 0..3000 {
            let [a, b, c, d] = sobol_burley::sample_4d(i, 0, 7);
            let from = warp::uniform_sphere(Vec2::new(a, b)) * 25.0 + Vec3::new(10.5, 6.5, 15.0);
            // Every third ray starts inside of the grid; some end early
            let origin = if i % 3 == 0 { Vec3::new(21.0 * a, 13.0 * b, 30.0 * c) } else { from };
            let aim = Vec3::new(21.0 * c, 13.0 * d, 30.0 * a) - origin;
            let t_max = if i % 5 == 0 { 0.4 } else { f32::INFINITY };
            let ray = Ray { origin, direction: aim, t_max };
            let expected = brute_force(&filled, &ray);
            hits += usize::from(expected.is_some());
            for (way, visits) in [VoxelWay::Cells, VoxelWay::Bricks].into_iter().zip(&mut visits) {
                let (hit, visited) = grid.intersect(&ray, way);
                *visits += visited;
                let found = hit.map(|hit| hit.t);
                let is_same = match (found, expected) {
                    (Some(found), Some(expected)) => (found - expected).abs() < 1e-5,
                    (None, None) => true,
                    _ => false,
                };
                assert!(is_same, "{way:?} ray {i}: {found:?} for {expected:?}");
            }
        }
        assert!(hits > 300, "{hits}");
        assert!(visits[1] * 4 < visits[0] * 3, "bricks save visits: {visits:?}");
    }

    #[test]
    fn rays_along_the_axes_and_in_the_planes_of_faces_are_right() {
        let grid = VoxelGrid::new([16, 16, 16], |[x, y, z]| x == 12 && y == 3 && z == 5);
        let hit = |origin: Vec3, direction: Vec3, way| {
            grid.intersect(&Ray { origin, direction, t_max: f32::INFINITY }, way).0
        };
        for way in [VoxelWay::Cells, VoxelWay::Bricks] {
            let expected = VoxelHit { cell: IVec3::new(12, 3, 5), t: 14.0, normal: IVec3::NEG_X };
            assert_eq!(hit(Vec3::new(-2.0, 3.5, 5.5), Vec3::X, way), Some(expected));
            assert_eq!(hit(Vec3::new(-2.0, 3.0, 5.5), Vec3::X, way), Some(expected), "on a face");
            assert_eq!(hit(Vec3::new(-2.0, 2.5, 5.5), Vec3::X, way), None);
            assert_eq!(hit(Vec3::new(-2.0, 3.5, 5.5), Vec3::NEG_X, way), None, "behind");
            let down = hit(Vec3::new(12.5, 20.0, 5.5), Vec3::NEG_Y * 2.0, way);
            assert_eq!(down, Some(VoxelHit { t: 8.0, normal: IVec3::Y, ..expected }));
            let inside = hit(Vec3::new(12.5, 3.5, 5.5), Vec3::Y, way);
            assert_eq!(inside, Some(VoxelHit { t: 0.0, normal: IVec3::ZERO, ..expected }));
            assert_eq!(hit(Vec3::splat(f32::NAN), Vec3::X, way), None);
        }
        assert_eq!(
            VoxelGrid::new([0, 4, 4], |_| true)
                .intersect(&Ray { origin: Vec3::ZERO, direction: Vec3::X, t_max: 1.0 }, VoxelWay::Cells)
                .0,
            None
        );
        assert_eq!(grid.bytes(), 8 * 4 + 64, "seven of eight bricks are empty");
    }
}

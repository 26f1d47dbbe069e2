//! A hash grid of items in space.

use glam::{IVec3, Vec3};

/// An item at a position.
pub trait Positioned {
    /// Position, in the tracer's space.
    fn position(&self) -> Vec3;
}

/// Items sorted by the hash of their cell.
#[derive(Debug)]
pub struct HashGrid<T> {
    items: Vec<T>,
    /// First item of each hash; one more at the end.
    starts: Vec<u32>,
    cells_per_m: f32,
}

impl<T: Positioned + Copy> HashGrid<T> {
    /// Sorts items for queries within at most `radius` (metres), by counting.
    pub fn new(unsorted: &[T], radius: f32) -> Self {
        let size = unsorted.len().max(1).next_power_of_two();
        let cells_per_m = 0.5 / radius;
        let hash_of = |item: &T| hash(cell(item.position() * cells_per_m), size) as u32;
        let hashes: Vec<u32> = unsorted.iter().map(hash_of).collect();
        let mut starts = vec![0_u32; size + 1];
        hashes.iter().for_each(|&hash| starts[hash as usize + 1] += 1);
        for hash in 0..size {
            starts[hash + 1] += starts[hash];
        }
        let mut next = starts.clone();
        let mut order = vec![0_u32; unsorted.len()];
        for (index, &hash) in (0..).zip(&hashes) {
            order[next[hash as usize] as usize] = index;
            next[hash as usize] += 1;
        }
        let items = order.iter().map(|&index| unsorted[index as usize]).collect();
        HashGrid { items, starts, cells_per_m }
    }

    /// Returns the items within `radius`, at most that of the grid, with their squared distances.
    pub fn near(&self, position: Vec3, radius: f32) -> impl Iterator<Item = (&T, f32)> {
        // The query's diameter is one cell at most: it overlaps at most two cells along each axis.
        let low = cell((position - Vec3::splat(radius)) * self.cells_per_m);
        let mut hashes = [None; 8];
        for corner in 0..8 {
            let step = IVec3::new(corner & 1, (corner >> 1) & 1, corner >> 2);
            let hash = Some(hash(low.wrapping_add(step), self.starts.len() - 1));
            // Two cells may have the same hash
            if !hashes.contains(&hash) {
                hashes[corner as usize] = hash;
            }
        }
        let of_hash = |hash: usize| &self.items[self.starts[hash] as usize..self.starts[hash + 1] as usize];
        hashes.into_iter().flatten().flat_map(of_hash).filter_map(move |item| {
            let distance2 = item.position().distance_squared(position);
            (distance2 < radius * radius).then_some((item, distance2))
        })
    }
}

/// Returns the cell of a position in cell widths.
fn cell(position: Vec3) -> IVec3 {
    position.floor().as_ivec3()
}

/// Hashes a cell (Teschner et al. 2003, "Optimized Spatial Hashing for Collision Detection of Deformable Objects") to
/// less than `size`, a power of two.
fn hash(cell: IVec3, size: usize) -> usize {
    let mixed = (cell.x as u32).wrapping_mul(73_856_093)
        ^ (cell.y as u32).wrapping_mul(19_349_663)
        ^ (cell.z as u32).wrapping_mul(83_492_791);
    (mixed ^ (mixed >> 15)) as usize & (size - 1)
}

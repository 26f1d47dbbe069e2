//! A hash grid over photons.

use super::photon::Photon;
use glam::{IVec3, Vec3};

/// Photons sorted by the hash of their cell.
#[derive(Debug)]
pub struct PhotonGrid {
    photons: Vec<Photon>,
    /// First photon of each hash; one more at the end.
    starts: Vec<u32>,
    cells_per_m: f32,
}

impl PhotonGrid {
    /// Sorts photons for queries within at most `radius` (metres), by counting.
    pub fn new(unsorted: Vec<Photon>, radius: f32) -> Self {
        let size = unsorted.len().max(1).next_power_of_two();
        let cells_per_m = 0.5 / radius;
        let hash_of = |photon: &Photon| hash(cell(photon.position * cells_per_m), size) as u32;
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
        let photons = order.iter().map(|&index| unsorted[index as usize]).collect();
        PhotonGrid { photons, starts, cells_per_m }
    }

    /// Calls `found` for every photon within `radius`, at most that of the grid, with its squared distance.
    pub fn for_each_near(&self, position: Vec3, radius: f32, mut found: impl FnMut(&Photon, f32)) {
        if self.photons.is_empty() {
            return;
        }
        // The query's diameter is one cell at most: it overlaps at most two cells along each axis.
        let low = cell((position - Vec3::splat(radius)) * self.cells_per_m);
        let mut hashes = [usize::MAX; 8];
        for corner in 0..8 {
            let step = IVec3::new(corner & 1, (corner >> 1) & 1, corner >> 2);
            let hash = hash(low.wrapping_add(step), self.starts.len() - 1);
            // Two cells may have the same hash.
            if hashes.contains(&hash) {
                continue;
            }
            hashes[corner as usize] = hash;
            for photon in &self.photons[self.starts[hash] as usize..self.starts[hash + 1] as usize] {
                let distance2 = photon.position.distance_squared(position);
                if distance2 < radius * radius {
                    found(photon, distance2);
                }
            }
        }
    }
}

/// The cell of a position in cell widths.
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

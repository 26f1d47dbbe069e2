//! Photons in cells of space, found by a hash of the cell.

use super::photon::Photon;
use glam::{IVec3, Vec3};

/// Photons in the order of their cells' hashes.
#[derive(Debug)]
pub struct Grid {
    photons: Vec<Photon>,
    /// First photon of each hash; one more at the end.
    starts: Vec<u32>,
    /// Of the circle that is asked for, metres.
    radius: f32,
    /// Cells a metre.
    per_m: f32,
}

impl Grid {
    /// Sorts photons for questions within `radius`.
    pub fn new(unsorted: Vec<Photon>, radius: f32) -> Self {
        let size = unsorted.len().max(1).next_power_of_two();
        let per_m = 0.5 / radius;
        let slots: Vec<u32> = unsorted.iter().map(|photon| slot(cell(photon.position * per_m), size) as u32).collect();
        let mut starts = vec![0_u32; size + 1];
        slots.iter().for_each(|&slot| starts[slot as usize + 1] += 1);
        for slot in 0..size {
            starts[slot + 1] += starts[slot];
        }
        let mut next = starts.clone();
        let mut order = vec![0_u32; unsorted.len()];
        for (index, &slot) in (0..).zip(&slots) {
            order[next[slot as usize] as usize] = index;
            next[slot as usize] += 1;
        }
        let photons = order.iter().map(|&index| unsorted[index as usize]).collect();
        Grid { photons, starts, radius, per_m }
    }

    /// The radius that it was made for, metres.
    pub fn radius(&self) -> f32 {
        self.radius
    }

    /// Gives every photon within the radius, with the square of its distance.
    pub fn near(&self, position: Vec3, mut found: impl FnMut(&Photon, f32)) {
        if self.photons.is_empty() {
            return;
        }
        let radius = self.radius;
        // A circle no wider than a cell reaches into one neighbour along each axis.
        let low = cell((position - Vec3::splat(radius)) * self.per_m);
        let mut slots = [usize::MAX; 8];
        for corner in 0..8 {
            let step = IVec3::new(corner & 1, (corner >> 1) & 1, corner >> 2);
            let slot = slot(low.wrapping_add(step), self.starts.len() - 1);
            // Two cells may have one hash.
            if slots.contains(&slot) {
                continue;
            }
            slots[corner as usize] = slot;
            for photon in &self.photons[self.starts[slot] as usize..self.starts[slot + 1] as usize] {
                let distance2 = photon.position.distance_squared(position);
                if distance2 < radius * radius {
                    found(photon, distance2);
                }
            }
        }
    }
}

fn cell(place: Vec3) -> IVec3 {
    place.floor().as_ivec3()
}

/// Mixes a cell's numbers (Teschner et al. 2003, "Optimized Spatial Hashing for Collision Detection of Deformable
/// Objects") into one of `size`, a power of two.
fn slot(cell: IVec3, size: usize) -> usize {
    let mixed = (cell.x as u32).wrapping_mul(73_856_093)
        ^ (cell.y as u32).wrapping_mul(19_349_663)
        ^ (cell.z as u32).wrapping_mul(83_492_791);
    (mixed ^ (mixed >> 15)) as usize & (size - 1)
}

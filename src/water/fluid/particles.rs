//! The particles that carry the water of a fluid, and where they start.

use super::faces::Layout;
use super::solids::Solids;
use crate::scene::{Drop, Fluid, Jet, Tank};
use crate::water::grid::{FULL, Grid};
use glam::{Mat3, Vec3};

/// Distance of particles at the start, cells.
const SPACING: f32 = 0.5;
/// Largest irregularity of their places, cells.
const IRREGULARITY: f32 = 0.11;
/// Largest radius of a jet, in distances of particles.
const WIDEST_JET: f32 = 512.0;
/// Distance from obstacles at the start, cells.
const FREE: f32 = 0.15;

/// A particle: an eighth of a cell of water. Positions are in cells from the lowest corner, velocities in cells per
/// second.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Particle {
    /// Its position.
    pub at: Vec3,
    /// Its velocity.
    pub velocity: Vec3,
    /// The gradient of the velocity: the columns are its change along X, Y and Z.
    pub gradient: Mat3,
}

/// Returns the particles of still water, blocks and drops.
pub(super) fn start(grid: &Grid, tank: &Tank, fluid: &Fluid, solids: &Solids) -> Vec<Particle> {
    let layout = Layout::new(grid.size());
    let drops: Vec<(Vec3, f32, Vec3)> = fluid
        .drops
        .iter()
        .map(|&Drop { at_m, radius_m, velocity_m_s }| {
            (solids.cells_from_m(at_m), radius_m / tank.cell_m, velocity_m_s / tank.cell_m)
        })
        .collect();
    let mut particles = Vec::new();
    layout.for_each_cell(|at, cell| {
        let low = Vec3::from(at.map(|side| side as f32));
        let level = f32::from(grid.level(cell)) / f32::from(FULL);
        for corner in 0..8_u32 {
            let part = Vec3::new((corner & 1) as f32, (corner >> 1 & 1) as f32, (corner >> 2) as f32);
            let offset = (part + 0.5) * SPACING;
            let place = low + offset;
            let is_free = offset.y > solids.ground(cell) && solids.obstacle_distance(place, 0.0) > FREE;
            let drop = drops.iter().find(|(middle, radius, _)| middle.distance(place) < *radius);
            let velocity = match drop {
                Some((.., velocity)) => *velocity,
                None => Vec3::ZERO,
            };
            let is_wet = drop.is_some() || offset.y < level || solids.is_in_drink(place);
            if is_free && is_wet && particles.len() < Fluid::MAX_PARTICLES {
                let at = place + irregularity(fluid.seed, cell as u32, corner);
                particles.push(Particle { at, velocity, gradient: Mat3::ZERO });
            }
        }
    });
    particles
}

/// Adds what a jet pours between two times.
pub(super) fn pour(
    jet: &Jet,
    number: u32,
    from_s: f32,
    to_s: f32,
    context: (&Solids, &Fluid, f32),
    particles: &mut Vec<Particle>,
) {
    let (solids, fluid, cell_m) = context;
    let velocity = jet.velocity_m_s / cell_m;
    let Some(direction) = velocity.try_normalize() else { return };
    let (u, v) = direction.any_orthonormal_pair();
    let nozzle = solids.cells_from_m(jet.at_m);
    let radius = jet.radius_m / cell_m;
    let layer = |time_s: f32| (time_s.min(jet.until_s) * velocity.length() / SPACING) as u32;
    // No further than the tank
    let widest = radius.min(solids.reach_from(nozzle));
    let side = (widest / SPACING).min(WIDEST_JET) as i32 + 1;
    for index in layer(from_s)..layer(to_s) {
        // The layer left the nozzle some time ago
        let age_s = (to_s - (index + 1) as f32 * SPACING / velocity.length()).max(0.0);
        for (a, b) in (-side..=side).flat_map(|a| (-side..=side).map(move |b| (a, b))) {
            let (a, b) = (a as f32 * SPACING, b as f32 * SPACING);
            let at = nozzle
                + u * a
                + v * b
                + velocity * age_s
                + irregularity(fluid.seed, index ^ number << 24, (a.to_bits() >> 7) ^ b.to_bits());
            if particles.len() >= Fluid::MAX_PARTICLES {
                return;
            }
            if a * a + b * b < radius * radius && solids.is_in_tank(at) && !solids.is_in_ground(at) {
                particles.push(Particle { at, velocity, gradient: Mat3::ZERO });
            }
        }
    }
}

/// Sorts particles by their cells. Those of a cell keep their order. Returns where each cell's particles start, and the
/// end.
pub(super) fn sort(layout: Layout, particles: &mut Vec<Particle>, spare: &mut Vec<Particle>) -> Vec<u32> {
    let cells: Vec<u32> = particles.iter().map(|particle| layout.cell_at(particle.at) as u32).collect();
    let mut starts = vec![0_u32; layout.cell_count() + 1];
    cells.iter().for_each(|&cell| starts[cell as usize + 1] += 1);
    for cell in 0..layout.cell_count() {
        starts[cell + 1] += starts[cell];
    }
    let mut next = starts.clone();
    spare.clear();
    spare.extend_from_slice(particles);
    for (particle, &cell) in particles.iter().zip(&cells) {
        let place = &mut next[cell as usize];
        spare[*place as usize] = *particle;
        *place += 1;
    }
    std::mem::swap(particles, spare);
    starts
}

/// Returns a displacement by the hash of a seed and two numbers; none for the seed 0.
fn irregularity(seed: u32, a: u32, b: u32) -> Vec3 {
    if seed == 0 {
        return Vec3::ZERO;
    }
    let mut state = seed.wrapping_mul(0x9e37_79b9) ^ a.wrapping_mul(0x85eb_ca6b) ^ b.wrapping_mul(0xc2b2_ae35);
    let mut next = || {
        // The finaliser of MurmurHash3 (Appleby)
        state = state.wrapping_add(0x9e37_79b9);
        let mut value = (state ^ state >> 16).wrapping_mul(0x85eb_ca6b);
        value = (value ^ value >> 13).wrapping_mul(0xc2b2_ae35);
        (value ^ value >> 16) as f32 / u32::MAX as f32 * 2.0 - 1.0
    };
    Vec3::new(next(), next(), next()) * IRREGULARITY
}

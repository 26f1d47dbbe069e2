//! Water that moves by the laws of motion: the affine particle-in-cell method (Jiang et al. 2015, "The Affine
//! Particle-In-Cell Method"). Particles carry mass and momentum; a staggered grid makes their flow free of divergence.
//! Sides, ground and obstacles let it slip. There is no surface tension and no viscosity but that of the method.
//!
//! The state is a function of the recipe alone, for any number of threads: particles are sorted by their cells, those of
//! slabs of planes are summed in order, every other slab at once.
//!
//! | file | contents |
//! |---|---|
//! | `particles` | the particles, their start, jets, sorting |
//! | `faces` | the staggered grid |
//! | `solids` | sides, ground and obstacles |
//! | `pressure` | the pressures that keep the fluid incompressible |

mod faces;
mod particles;
mod pressure;
mod solids;

pub use particles::Particle;
pub(in crate::water) use solids::Solids;

use super::blur::blur;
use super::grid::Grid;
use super::terrain;
use crate::scene::{FLUID_FRAMES_PER_S, Fluid, Tank, TankLook, Texture};
use faces::{Faces, Layout};
use glam::{Mat3, Vec3};
use pressure::Projection;
use rayon::prelude::*;

/// Acceleration of gravity, m/s2.
const GRAVITY_M_S2: f32 = 9.81;
/// Cells that the fastest particle crosses in a step, at most.
const CELLS_PER_STEP: f32 = 2.5;
/// Largest number of steps in a frame. What is faster is slowed down.
const MAX_STEPS_PER_FRAME: u32 = 6;
/// Layers of faces around the fluid that have velocities.
const LAYERS: usize = 4;
/// Planes of cells in a slab.
const SLAB: usize = 4;
/// Particles that one task moves at least.
const PARTICLES_PER_TASK: usize = 2048;

/// The fluid of a tank at some time.
#[derive(Clone, Debug)]
pub struct FluidSimulation {
    recipe: Tank,
    fluid: Fluid,
    grid: Grid,
    solids: Solids,
    particles: Vec<Particle>,
    /// The pressures of the last step, a guess at those of the next.
    pressure: Vec<f32>,
    frame: u32,
}

/// What a run allocates once.
struct Scratch {
    spare: Vec<Particle>,
    /// Momentum and mass around each face.
    sums: [Vec<[f32; 2]>; 3],
    faces: Faces,
    open: Faces,
    pushed: Vec<f32>,
    walls: [Vec<bool>; 3],
    /// Open part of each cell, as it is and with its neighbours'.
    space: Vec<f32>,
    is_still: bool,
}

impl FluidSimulation {
    /// Returns the fluid of a tank at its start, of which `heights` is the picture of the ground, if it is made of one.
    pub fn new(tank: &Tank, heights: Option<&Texture>) -> Self {
        let fluid = tank.fluid.as_deref().cloned().unwrap_or_default();
        let mut grid = terrain::start(tank, heights);
        let solids = Solids::new(&grid, tank);
        let particles = particles::start(&grid, tank, &fluid, &solids);
        grid.water.fill(0);
        let pressure = vec![0.0; tank.cell_count()];
        FluidSimulation { recipe: tank.at_start(), fluid, grid, solids, particles, pressure, frame: 0 }
    }

    /// Returns the cells with their ground and without water.
    pub fn grid(&self) -> &Grid {
        &self.grid
    }

    /// Returns the particles, each of which is an eighth of a cell of water.
    pub fn particles(&self) -> &[Particle] {
        &self.particles
    }

    pub(super) fn solids(&self) -> &Solids {
        &self.solids
    }

    /// Returns the time of the state, seconds.
    pub fn time_s(&self) -> f32 {
        self.frame as f32 / FLUID_FRAMES_PER_S
    }

    /// Returns true if going on from here leads to the state that a tank shows: it is the same tank at a later time.
    pub fn leads_to(&self, tank: &Tank) -> bool {
        let recipe = |tank: &Tank| Tank { look: TankLook::Smooth, ..tank.at_start() };
        self.frame <= tank.steps() && recipe(&self.recipe) == recipe(tank)
    }

    /// Goes on to the state that a tank shows, which this one must lead to.
    pub fn run_to(&mut self, tank: &Tank) {
        let last = tank.steps();
        if self.frame >= last {
            return;
        }
        let mut scratch = Scratch::new(self);
        while self.frame < last {
            self.advance(&mut scratch);
        }
    }

    /// Makes one frame, in as many steps as its fastest particle needs.
    fn advance(&mut self, scratch: &mut Scratch) {
        let start_s = self.time_s();
        let frame_s = 1.0 / FLUID_FRAMES_PER_S;
        let jets = self.fluid.jets.iter().map(|jet| jet.velocity_m_s).chain(
            self.fluid
                .obstacles
                .iter()
                .map(|obstacle| Vec3::Y * if start_s < obstacle.stands_s { obstacle.falls_m_s } else { 0.0 }),
        );
        let fastest = jets.map(|velocity| velocity.length() / self.recipe.cell_m).fold(0.0, f32::max);
        let fastest = self.particles.iter().map(|particle| particle.velocity.length()).fold(fastest, f32::max);
        let steps = (fastest * frame_s / CELLS_PER_STEP).ceil().clamp(1.0, MAX_STEPS_PER_FRAME as f32) as u32;
        let step_s = frame_s / steps as f32;
        for step in 0..steps {
            self.step(start_s + step as f32 * step_s, step_s, scratch);
        }
        self.frame += 1;
    }

    fn step(&mut self, from_s: f32, step_s: f32, scratch: &mut Scratch) {
        let to_s = from_s + step_s;
        for (number, jet) in self.fluid.jets.iter().enumerate() {
            let context = (&self.solids, &self.fluid, self.recipe.cell_m);
            particles::pour(jet, number as u32, from_s, to_s, context, &mut self.particles);
        }
        let layout = Layout::new(self.grid.size());
        let starts = particles::sort(layout, &mut self.particles, &mut scratch.spare);
        if !scratch.is_still {
            scratch.meet_solids(&self.solids, layout, to_s);
        }
        let density = density(layout, &starts, &scratch.space);
        scratch.gather(layout, &self.particles, &starts);
        let gravity = -GRAVITY_M_S2 / self.recipe.cell_m * step_s;
        let [mut known, mut valid] = scratch.velocities(layout, &starts, gravity);
        let Scratch { faces, open, pushed, walls, .. } = scratch;
        // The cells right above the surface move with it
        layout.extrapolate(faces, &mut known, walls, 1);
        let projection = Projection { layout, density: &density, open, pushed, step_s };
        projection.project(faces, &mut self.pressure);
        layout.extrapolate(faces, &mut valid, walls, LAYERS);
        self.move_particles(layout, faces, step_s, to_s);
    }

    /// Gives the particles the velocities of the grid, and moves them.
    fn move_particles(&mut self, layout: Layout, faces: &Faces, step_s: f32, to_s: f32) {
        let offsets = layout.stencil_offsets();
        let limit = CELLS_PER_STEP / step_s;
        let solids = &self.solids;
        self.particles.par_iter_mut().with_min_len(PARTICLES_PER_TASK).for_each(|particle| {
            let mut velocity = Vec3::ZERO;
            let mut rows = [Vec3::ZERO; 3];
            for axis in 0..3 {
                let stencil = layout.stencil(particle.at, axis);
                let (weights, gradients) = (stencil.weights(), stencil.gradients());
                for i in 0..8 {
                    let value = faces[axis][stencil.base + offsets[i]];
                    velocity[axis] += weights[i] * value;
                    rows[axis] += gradients[i] * value;
                }
            }
            particle.gradient = Mat3::from_cols(rows[0], rows[1], rows[2]).transpose();
            // The midpoint rule
            let middle = particle.at + 0.5 * step_s * velocity.clamp_length_max(limit);
            let moves = layout.velocity(faces, &offsets, middle).clamp_length_max(limit);
            let to = particle.at + step_s * moves;
            (particle.at, particle.velocity) = solids.stop(particle.at, to, velocity.clamp_length_max(limit), to_s);
        });
    }
}

impl Scratch {
    fn new(simulation: &FluidSimulation) -> Self {
        let layout = Layout::new(simulation.grid.size());
        let mut scratch = Scratch {
            spare: Vec::new(),
            sums: [(); 3].map(|()| vec![[0.0; 2]; layout.face_count()]),
            faces: layout.faces(),
            open: layout.faces(),
            pushed: Vec::new(),
            walls: simulation.solids.walls(),
            space: Vec::new(),
            is_still: false,
        };
        scratch.meet_solids(&simulation.solids, layout, simulation.time_s());
        scratch
    }

    /// Computes what depends on where the obstacles are.
    fn meet_solids(&mut self, solids: &Solids, layout: Layout, time_s: f32) {
        (self.open, self.pushed) = solids.openings(time_s);
        self.space = smoothed(layout, solids.openness(time_s));
        self.is_still = solids.is_still(time_s);
    }

    /// Adds up the momentum and the mass of the particles around each face.
    fn gather(&mut self, layout: Layout, particles: &[Particle], starts: &[u32]) {
        let [nx, ny, nz] = layout.size();
        let plane = layout.plane();
        let offsets = layout.stencil_offsets();
        self.sums.iter_mut().for_each(|sums| sums.fill([0.0; 2]));
        // Slabs write to one plane before them and one after them: every other one at a time
        for parity in 0..2 {
            let [x, y, z] = &mut self.sums;
            let skipped = (parity * SLAB * plane).min(x.len());
            let slabs = (
                x[skipped..].par_chunks_mut(2 * SLAB * plane),
                y[skipped..].par_chunks_mut(2 * SLAB * plane),
                z[skipped..].par_chunks_mut(2 * SLAB * plane),
            );
            slabs.into_par_iter().enumerate().for_each(|(pair, (x, y, z))| {
                let first = (2 * pair + parity) * SLAB;
                if first >= nz {
                    return;
                }
                let range = |z: usize| starts[z.min(nz) * nx * ny] as usize;
                for particle in &particles[range(first)..range(first + SLAB)] {
                    for (axis, sums) in [&mut *x, &mut *y, &mut *z].into_iter().enumerate() {
                        let stencil = layout.stencil(particle.at, axis);
                        let weights = stencil.weights();
                        let slope = particle.gradient.row(axis);
                        let base = stencil.base - first * plane;
                        for i in 0..8 {
                            let value = particle.velocity[axis] + slope.dot(stencil.towards(i));
                            let sum = &mut sums[base + offsets[i]];
                            sum[0] += weights[i] * value;
                            sum[1] += weights[i];
                        }
                    }
                }
            });
        }
    }

    /// Computes the velocities across the faces around particles, gravity included; returns which faces those are, and
    /// which are faces of cells with particles.
    fn velocities(&mut self, layout: Layout, starts: &[u32], gravity: f32) -> [[Vec<bool>; 3]; 2] {
        let mut valid = [(); 3].map(|()| vec![false; layout.face_count()]);
        let mut known = valid.clone();
        layout.for_each_cell(|at, cell| {
            if starts[cell] < starts[cell + 1] {
                for (axis, valid) in valid.iter_mut().enumerate() {
                    let face = layout.face(at);
                    valid[face] = true;
                    valid[face + layout.face_stride(axis)] = true;
                }
            }
        });
        for axis in 0..3 {
            let added = if axis == 1 { gravity } else { 0.0 };
            let (sums, open, walls) = (&self.sums[axis], &self.open[axis], &self.walls[axis]);
            let lists = self.faces[axis].par_iter_mut().zip(&mut known[axis]).zip(&mut valid[axis]);
            lists.enumerate().with_min_len(4096).for_each(|(face, ((value, known), valid))| {
                let [momentum, mass] = sums[face];
                *known = mass > 0.0 && open[face] > 0.0;
                *value = if mass > 0.0 && !walls[face] { momentum / mass + added } else { 0.0 };
                *valid &= *known;
            });
        }
        [known, valid]
    }
}

/// Returns the mean over the neighbours of each cell, by binomial weights.
fn smoothed(layout: Layout, mut values: Vec<f32>) -> Vec<f32> {
    let [nx, ny, nz] = layout.size();
    blur(&mut values, 1, ny);
    blur(&mut values, ny, nx);
    blur(&mut values, ny * nx, nz);
    values
}

/// Returns the water in and around each cell as a part of the space there.
fn density(layout: Layout, starts: &[u32], space: &[f32]) -> Vec<f32> {
    let count = |pair: &[u32]| (pair[1] - pair[0]) as f32 / Fluid::PARTICLES_PER_CELL as f32;
    let water = smoothed(layout, starts.windows(2).map(count).collect());
    water.iter().zip(space).map(|(water, space)| water / space.max(0.05)).collect()
}

#[cfg(test)]
mod tests;

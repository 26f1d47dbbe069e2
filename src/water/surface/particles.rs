//! The surface of a fluid: the level set of its particles (Zhu and Bridson 2005, "Animating Sand as a Fluid", section 5).
//!
//! The value of a sample is the distance between it and the mean place of the particles around it, less their radius.
//! The surface of much water is smoothed; spray and thin sheets are not, since smoothing would remove them. Into solids
//! the values go on as they are beside them, as far as the overlap of water and solid.

use super::nets::Field;
use crate::scene::{Fluid, Mesh};
use crate::water::blur::blur;
use crate::water::fluid::FluidSimulation;
use glam::{Vec3, Vec4};

/// Samples along the edge of a cell.
const PER_CELL: f32 = 2.0;
/// Samples beyond the sides of the tank.
const BEYOND: f32 = 2.0;
/// Distance in which particles count, cells.
const REACH: f32 = 1.25;
/// Radius of a particle, as a part of the reach. A half-space of particles has its surface where its volume ends: the
/// mean depth of the weights (1 - s^2)^3 in a half ball is 0.246. A single particle is a ball of 0.98 of its volume.
const RADIUS: f32 = 0.246 * REACH;
/// Distance from solids within which particles are too few for a value, cells.
const MARGIN: f32 = 0.2;
/// Samples that water reaches into solids, at most.
const LAYERS: usize = 4;
/// Cells that water reaches into obstacles, and keeps from the sides of the tank.
const OVERLAP: f32 = 0.15;
/// Passes of smoothing.
const PASSES: usize = 3;
/// Passes that tell much water from little.
const WIDE_PASSES: usize = 6;
/// Part of water around a sample below which nothing is smoothed, and from which on everything is.
const MUCH: [f32; 2] = [0.3, 0.46];
/// How much faster the values grow inside, so that smoothing moves no plane.
const STEEPER: f32 = 3.0;
/// Largest value of a sample, cells.
const LARGEST: f32 = RADIUS;

/// Returns the surface of a fluid, in cells from the lowest corner.
pub(super) fn surface(simulation: &FluidSimulation) -> Mesh {
    if simulation.particles().is_empty() {
        return Mesh::default();
    }
    let lattice = Lattice::new(simulation.grid().size());
    let mut values = lattice.level_set(simulation);
    lattice.continue_into_solids(simulation, &mut values);
    lattice.smooth(&mut values);
    lattice.clip(simulation, &mut values);
    let mut mesh = Field::from_values(lattice.size, values).smooth_surface();
    mesh.positions.iter_mut().for_each(|at| *at = lattice.place(*at));
    mesh.velocities = velocities(simulation, &mesh.positions);
    mesh
}

/// Returns the mean velocity of the particles around each place, cells per second: trilinear between the means of cells.
fn velocities(simulation: &FluidSimulation, places: &[Vec3]) -> Vec<Vec3> {
    let size = simulation.grid().size();
    let cell_at = |[x, y, z]: [usize; 3]| (z * size[0] + x) * size[1] + y;
    let mut sums = vec![Vec4::ZERO; size.iter().product()];
    for particle in simulation.particles() {
        let at = [0, 1, 2].map(|axis| (particle.at[axis].max(0.0) as usize).min(size[axis] - 1));
        sums[cell_at(at)] += particle.velocity.extend(1.0);
    }
    let velocity_at = |place: &Vec3| {
        let low = (*place - 0.5).max(Vec3::ZERO);
        let fraction = low - low.floor();
        let sum: Vec4 = (0..8)
            .map(|corner| {
                let offsets = [corner & 1, corner >> 1 & 1, corner >> 2];
                let at = [0, 1, 2].map(|axis| (low[axis] as usize + offsets[axis]).min(size[axis] - 1));
                let weights =
                    [0, 1, 2].map(|axis| if offsets[axis] == 1 { fraction[axis] } else { 1.0 - fraction[axis] });
                sums[cell_at(at)] * weights.iter().product::<f32>()
            })
            .sum();
        if sum.w > 0.0 { sum.truncate() / sum.w } else { Vec3::ZERO }
    };
    places.iter().map(velocity_at).collect()
}

/// The places of the samples.
struct Lattice {
    size: [usize; 3],
    /// Number of cells along each axis.
    cells: [usize; 3],
}

impl Lattice {
    fn new(cells: [usize; 3]) -> Self {
        Lattice { size: cells.map(|side| side * PER_CELL as usize + 2 * BEYOND as usize), cells }
    }

    /// Returns the place of a sample, in cells.
    fn place(&self, sample: Vec3) -> Vec3 {
        (sample - BEYOND + 0.5) / PER_CELL
    }

    fn strides(&self) -> [usize; 3] {
        [self.size[1], 1, self.size[0] * self.size[1]]
    }

    /// Calls a function for the place of each sample and its value.
    fn for_each(&self, values: &mut [f32], mut call: impl FnMut(Vec3, &mut f32)) {
        for (column, samples) in values.chunks_mut(self.size[1]).enumerate() {
            let (x, z) = (column % self.size[0], column / self.size[0]);
            for (y, value) in samples.iter_mut().enumerate() {
                call(self.place(Vec3::new(x as f32, y as f32, z as f32)), value);
            }
        }
    }

    /// Returns the level set of the particles, positive inside, cells.
    fn level_set(&self, simulation: &FluidSimulation) -> Vec<f32> {
        let deep = self.deep_cells(simulation);
        let cell_of = |at: Vec3| {
            let [x, y, z] = [0, 1, 2].map(|axis| (at[axis].max(0.0) as usize).min(self.cells[axis] - 1));
            (z * self.cells[0] + x) * self.cells[1] + y
        };
        // The weights around each sample, and the weighted vectors to its particles
        let mut sums = vec![[0.0_f32; 4]; self.size.iter().product()];
        let [dx, dy, dz] = self.strides();
        for particle in simulation.particles() {
            // Deep inside no sample needs them
            if deep[cell_of(particle.at)] > 1 {
                continue;
            }
            let middle = particle.at * PER_CELL + BEYOND - 0.5;
            let reach = REACH * PER_CELL;
            let low = (middle - reach).ceil().max(Vec3::ZERO).as_usizevec3();
            let range = |axis: usize| low[axis]..=((middle[axis] + reach) as usize).min(self.size[axis] - 1);
            for z in range(2) {
                for x in range(0) {
                    let flat = (x as f32 - middle.x).powi(2) + (z as f32 - middle.z).powi(2);
                    if flat >= reach * reach {
                        continue;
                    }
                    for y in range(1) {
                        let s2 = (flat + (y as f32 - middle.y).powi(2)) / (reach * reach);
                        if s2 < 1.0 {
                            let weight = (1.0 - s2).powi(3);
                            let sum = &mut sums[x * dx + y * dy + z * dz];
                            sum[0] += weight;
                            sum[1] += weight * (middle.x - x as f32);
                            sum[2] += weight * (middle.y - y as f32);
                            sum[3] += weight * (middle.z - z as f32);
                        }
                    }
                }
            }
        }
        let mut values = vec![0.0; sums.len()];
        let mut index = 0;
        self.for_each(&mut values, |place, value| {
            let [weight, x, y, z] = sums[index];
            index += 1;
            *value = if deep[cell_of(place)] > 0 {
                LARGEST
            } else if weight > 0.0 {
                {
                    let distance = RADIUS - Vec3::new(x, y, z).length() / (weight * PER_CELL);
                    // Inside the mean place comes nearer by less than the way
                    (if distance > 0.0 { STEEPER * distance } else { distance }).clamp(-LARGEST, LARGEST)
                }
            } else {
                -LARGEST
            };
        });
        values
    }

    /// Returns for each cell whether it is deep in the water: 1 if all cells around it are full, 2 if those are deep, too.
    /// What is beyond the sides counts as full.
    fn deep_cells(&self, simulation: &FluidSimulation) -> Vec<u8> {
        let [nx, ny, nz] = self.cells;
        let mut counts = vec![0_u16; nx * ny * nz];
        for particle in simulation.particles() {
            let [x, y, z] = [0, 1, 2].map(|axis| (particle.at[axis].max(0.0) as usize).min(self.cells[axis] - 1));
            let count = &mut counts[(z * nx + x) * ny + y];
            *count = count.saturating_add(1);
        }
        let mut deep: Vec<bool> =
            counts.iter().map(|&count| usize::from(count) * 2 > Fluid::PARTICLES_PER_CELL).collect();
        let mut levels = vec![0_u8; deep.len()];
        for _ in 0..2 {
            for (stride, length) in [(1, ny), (ny, nx), (ny * nx, nz)] {
                let before = deep.clone();
                for cell in 0..deep.len() {
                    let at = cell / stride % length;
                    deep[cell] = before[cell]
                        && (at == 0 || before[cell - stride])
                        && (at + 1 == length || before[cell + stride]);
                }
            }
            levels.iter_mut().zip(&deep).for_each(|(level, deep)| *level += u8::from(*deep));
        }
        levels
    }

    /// Continues the values into solids and beyond the sides.
    fn continue_into_solids(&self, simulation: &FluidSimulation, values: &mut [f32]) {
        let (solids, time_s) = (simulation.solids(), simulation.time_s());
        let high = Vec3::from(self.cells.map(|side| side as f32));
        let mut known = Vec::with_capacity(values.len());
        self.for_each(values, |place, value| {
            let is_inside = place.cmpge(Vec3::ZERO).all() && place.cmplt(high).all();
            let is_free = is_inside
                && !solids.is_in_ground(place)
                && (!solids.has_obstacles() || solids.obstacle_distance(place, time_s) > MARGIN);
            if !is_free {
                *value = -LARGEST;
            }
            known.push(is_free);
        });
        let strides = self.strides();
        let mut front: Vec<(usize, f32)> = Vec::new();
        for _ in 0..LAYERS {
            front.clear();
            for sample in (0..values.len()).filter(|&sample| !known[sample]) {
                let (mut sum, mut count) = (0.0, 0.0);
                for (axis, stride) in strides.into_iter().enumerate() {
                    let at = sample / stride % self.size[axis];
                    if at > 0 && known[sample - stride] {
                        (sum, count) = (sum + values[sample - stride], count + 1.0);
                    }
                    if at + 1 < self.size[axis] && known[sample + stride] {
                        (sum, count) = (sum + values[sample + stride], count + 1.0);
                    }
                }
                if count > 0.0 {
                    front.push((sample, sum / count));
                }
            }
            for &(sample, value) in &front {
                (values[sample], known[sample]) = (value, true);
            }
        }
    }

    /// Smooths the surface of much water.
    fn smooth(&self, values: &mut [f32]) {
        let mut blurred = values.to_vec();
        (0..PASSES).for_each(|_| self.blur_all(&mut blurred));
        let mut part: Vec<f32> = values.iter().map(|value| (0.5 + 0.5 * value / LARGEST).clamp(0.0, 1.0)).collect();
        (0..WIDE_PASSES).for_each(|_| self.blur_all(&mut part));
        for ((value, blurred), part) in values.iter_mut().zip(blurred).zip(part) {
            let share = ((part - MUCH[0]) / (MUCH[1] - MUCH[0])).clamp(0.0, 1.0);
            *value += (blurred - *value) * share * share * (3.0 - 2.0 * share);
        }
    }

    fn blur_all(&self, values: &mut [f32]) {
        for (axis, stride) in self.strides().into_iter().enumerate() {
            blur(values, stride, self.size[axis]);
        }
    }

    /// Ends the water at the sides and where its overlap with obstacles ends.
    fn clip(&self, simulation: &FluidSimulation, values: &mut [f32]) {
        let (solids, time_s) = (simulation.solids(), simulation.time_s());
        let high = Vec3::from(self.cells.map(|side| side as f32));
        self.for_each(values, |place, value| {
            let side = place.min(high - place).min_element() - OVERLAP;
            let obstacle =
                if solids.has_obstacles() { solids.obstacle_distance(place, time_s) + OVERLAP } else { LARGEST };
            *value = value.min(side).min(obstacle);
        });
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scene::{Drop, Obstacle, ObstacleForm, Tank, Terrain};

    fn surface_of(cells: [u16; 3], water_m: f32, fluid: Fluid) -> (Mesh, FluidSimulation) {
        let terrain = Terrain::Flat { height_m: 0.0 };
        let fluid = Some(Box::new(fluid));
        let tank = Tank { cells, cell_m: 1.0, terrain, water_m, fluid, ..Tank::default() };
        let simulation = FluidSimulation::new(&tank, None);
        (surface(&simulation), simulation)
    }

    /// Returns the volume of a closed mesh by the divergence theorem.
    fn volume(mesh: &Mesh) -> f32 {
        (0..mesh.triangles.len()).map(|t| mesh.corners(t)).map(|[a, b, c]| a.dot(b.cross(c)) / 6.0).sum()
    }

    #[test]
    fn still_water_is_a_closed_block_of_its_volume_with_a_level_top() {
        let (mesh, _) = surface_of([10, 8, 9], 4.5, Fluid { seed: 3, ..Fluid::default() });
        assert!(mesh.is_closed());
        // It keeps from the sides by the overlap
        let expected = (10.0 - 2.0 * OVERLAP) * (9.0 - 2.0 * OVERLAP) * (4.5 - OVERLAP);
        assert!((volume(&mesh) / expected - 1.0).abs() < 0.03, "{} for {expected}", volume(&mesh));
        let inner = |at: &&Vec3| at.y > 3.0 && (at.x - 5.0).abs() < 3.5 && (at.z - 4.5).abs() < 3.0;
        let heights: Vec<f32> = mesh.positions.iter().filter(inner).map(|at| at.y).collect();
        assert!(heights.len() > 100 && heights.iter().all(|height| (height - 4.5).abs() < 0.12), "{heights:?}");
        let tops = mesh.positions.iter().zip(&mesh.normals).filter(|(at, _)| inner(at));
        tops.for_each(|(_, normal)| assert!(normal.y > 0.97, "{normal}"));
    }

    #[test]
    fn a_drop_is_a_ball_of_its_volume() {
        // Smoothing shrinks what is curved: the radius of the large ball by 4 %
        for (radius_m, tolerance) in [(3.2, 0.13), (1.6, 0.3)] {
            let at_m = Vec3::new(0.25, 5.25, 0.25);
            let drop = Drop { at_m, radius_m, velocity_m_s: Vec3::ZERO };
            let (mesh, simulation) = surface_of([10, 10, 10], 0.0, Fluid { drops: vec![drop], ..Fluid::default() });
            assert!(mesh.is_closed());
            let expected = simulation.particles().len() as f32 / Fluid::PARTICLES_PER_CELL as f32;
            assert!((volume(&mesh) / expected - 1.0).abs() < tolerance, "{} for {expected}", volume(&mesh));
            let middle = at_m + Vec3::new(5.0, 0.0, 5.0);
            for (at, normal) in mesh.positions.iter().zip(&mesh.normals) {
                assert!((*at - middle).normalize().dot(*normal) > 0.8, "outwards at {at}: {normal}");
            }
        }
    }

    #[test]
    fn water_reaches_into_its_glass_and_not_through_it() {
        let form =
            ObstacleForm::Glass { floor_m: 2.0, floor_radius_m: 4.0, rim_m: 9.0, rim_radius_m: 4.5, drink_m: 4.0 };
        let glass = Obstacle { form, at_m: Vec3::ZERO, falls_m_s: 0.0, stands_s: 0.0 };
        let (mesh, _) = surface_of([18, 12, 18], 0.0, Fluid { obstacles: vec![glass], ..Fluid::default() });
        assert!(mesh.is_closed() && !mesh.triangles.is_empty());
        let mut at_the_wall = 0;
        for at in &mesh.positions {
            let radius = glam::Vec2::new(at.x - 9.0, at.z - 9.0).length();
            let inner = 4.0 + (at.y - 2.0) / 14.0;
            assert!(at.y > 2.0 - 1.5 * OVERLAP && radius < inner + 1.5 * OVERLAP, "{at}");
            at_the_wall += usize::from((3.0..5.0).contains(&at.y) && radius > inner);
        }
        assert!(at_the_wall > 100, "{at_the_wall}");
    }
}

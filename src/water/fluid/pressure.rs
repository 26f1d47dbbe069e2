//! The pressures that keep the fluid incompressible (Chorin 1968): conjugate gradients with the modified incomplete
//! Cholesky preconditioner of level zero (Bridson 2015, "Fluid Simulation for Computer Graphics", section 5.5).
//!
//! Faces that solids close in part count by their open part (Batty, Bertails and Bridson 2007, "A Fast Variational
//! Framework for Accurate Solid-Fluid Coupling"). The pressure is zero where the surface crosses the line between two
//! cells, not in the middle of the cell of air (Gibou et al. 2002, "A Second-Order-Accurate Symmetric Discretization of
//! the Poisson Equation on Irregular Domains").

use super::faces::{Faces, Layout};

/// No cell.
const NONE: u32 = u32::MAX;
/// Largest number of iterations.
const MAX_ITERATIONS: usize = 120;
/// The residual relative to the first one at which the iterations end.
const TOLERANCE: f64 = 2e-4;
/// Part of the compression of a full cell that a step takes back.
const RELAXATION: f32 = 0.1;
/// Density from which on cells count as compressed.
const COMPRESSED: f32 = 1.5;
/// Density below which particles are spray, which flies without pressure. The cells right above the surface have more:
/// so the water under them does not sink together.
const SPRAY: f32 = 0.15;
/// Smallest distance of the surface from the middle of a cell, as a part of that between cells.
const NEAREST_SURFACE: f32 = 0.15;
/// Parts of the preconditioner, by Bridson.
const MODIFIED: f32 = 0.97;
const SAFE_PIVOT: f32 = 0.25;

/// What the pressures depend on.
#[derive(Debug)]
pub(super) struct Projection<'a> {
    pub layout: Layout,
    /// Water in and around each cell as a part of the space there.
    pub density: &'a [f32],
    /// Open part of each face.
    pub open: &'a Faces,
    /// Flow that obstacles push through the faces across Y.
    pub pushed: &'a [f32],
    /// Length of the step, seconds.
    pub step_s: f32,
}

/// The equations of the cells of the fluid. The last entry of each list is of no cell.
struct System {
    diagonal: Vec<f32>,
    /// The next cell along each axis, and the one before.
    next: Vec<[u32; 3]>,
    before: Vec<[u32; 3]>,
    /// The coefficient towards the next cell along each axis.
    coefficient: Vec<[f32; 3]>,
    right: Vec<f32>,
}

impl Projection<'_> {
    /// Returns true for a cell whose fluid has a pressure.
    pub(super) fn is_fluid(&self, cell: usize) -> bool {
        self.density[cell] >= SPRAY
    }

    /// Makes the velocities free of divergence; `guess` has the pressures of the last step, and then of this one.
    pub(super) fn project(&self, faces: &mut Faces, guess: &mut [f32]) {
        let layout = self.layout;
        let mut index = vec![NONE; layout.cell_count()];
        let mut cells: Vec<([usize; 3], usize)> = Vec::new();
        layout.for_each_cell(|at, cell| {
            if self.is_fluid(cell) {
                index[cell] = cells.len() as u32;
                cells.push((at, cell));
            }
        });
        let system = self.system(&cells, &index, faces);
        let mut pressure: Vec<f32> = cells.iter().map(|&(_, cell)| guess[cell]).collect();
        pressure.push(0.0);
        system.solve(&mut pressure);
        guess.fill(0.0);
        cells.iter().zip(&pressure).for_each(|(&(_, cell), &value)| guess[cell] = value);
        self.subtract_gradient(faces, guess);
    }

    fn system(&self, cells: &[([usize; 3], usize)], index: &[u32], faces: &Faces) -> System {
        let (layout, count) = (self.layout, cells.len());
        let none = count as u32;
        let mut system = System {
            diagonal: vec![1.0; count + 1],
            next: vec![[none; 3]; count + 1],
            before: vec![[none; 3]; count + 1],
            coefficient: vec![[0.0; 3]; count + 1],
            right: vec![0.0; count + 1],
        };
        let mut has_air = false;
        for (i, &(at, cell)) in cells.iter().enumerate() {
            let (mut diagonal, mut divergence) = (0.0, 0.0);
            for (axis, velocities) in faces.iter().enumerate() {
                let low = layout.face(at);
                let stride = layout.cell_stride(axis);
                for (face, is_next) in [(low, false), (low + layout.face_stride(axis), true)] {
                    let sign = if is_next { 1.0 } else { -1.0 };
                    let open = self.open[axis][face];
                    divergence += sign * (open * velocities[face] + if axis == 1 { self.pushed[face] } else { 0.0 });
                    if open == 0.0 {
                        continue;
                    }
                    let other = if is_next { cell + stride } else { cell - stride };
                    if index[other] == NONE {
                        has_air = true;
                        diagonal += open / self.surface_distance(cell, other);
                    } else {
                        diagonal += open;
                        if is_next {
                            system.next[i][axis] = index[other];
                            system.coefficient[i][axis] = open;
                        } else {
                            system.before[i][axis] = index[other];
                        }
                    }
                }
            }
            let compression = (self.density[cell] - COMPRESSED).clamp(0.0, 1.0);
            if diagonal > 0.0 {
                system.diagonal[i] = diagonal;
                system.right[i] = RELAXATION * compression / self.step_s - divergence;
            }
        }
        if !has_air && count > 0 {
            // Pressures without a level: only differences count
            let mean = system.right.iter().sum::<f32>() / count as f32;
            system.right[..count].iter_mut().for_each(|value| *value -= mean);
        }
        system
    }

    /// Returns the distance of the surface from the middle of a cell of the fluid, towards a cell of air.
    fn surface_distance(&self, fluid: usize, air: usize) -> f32 {
        let (inside, outside) = (self.density[fluid], self.density[air]);
        ((inside - 0.5) / (inside - outside).max(1e-3)).clamp(NEAREST_SURFACE, 1.0)
    }

    fn subtract_gradient(&self, faces: &mut Faces, pressure: &[f32]) {
        let layout = self.layout;
        layout.for_each_cell(|at, cell| {
            for axis in (0..3).filter(|&axis| at[axis] > 0) {
                let other = cell - layout.cell_stride(axis);
                let face = layout.face(at);
                if self.open[axis][face] == 0.0 {
                    continue;
                }
                let difference = pressure[cell] - pressure[other];
                faces[axis][face] -= match (self.is_fluid(other), self.is_fluid(cell)) {
                    (true, true) => difference,
                    (true, false) => difference / self.surface_distance(other, cell),
                    (false, true) => difference / self.surface_distance(cell, other),
                    (false, false) => 0.0,
                };
            }
        });
    }
}

impl System {
    fn count(&self) -> usize {
        self.diagonal.len() - 1
    }

    fn multiply(&self, x: &[f32], result: &mut [f32]) {
        for i in 0..self.count() {
            let mut sum = self.diagonal[i] * x[i];
            for axis in 0..3 {
                let before = self.before[i][axis] as usize;
                sum -= self.coefficient[i][axis] * x[self.next[i][axis] as usize];
                sum -= self.coefficient[before][axis] * x[before];
            }
            result[i] = sum;
        }
    }

    /// Returns the reciprocal pivots of the preconditioner.
    fn preconditioner(&self) -> Vec<f32> {
        let mut pivots = vec![0.0_f32; self.count() + 1];
        for i in 0..self.count() {
            let mut pivot = self.diagonal[i];
            for axis in 0..3 {
                let before = self.before[i][axis] as usize;
                let c = self.coefficient[before];
                let others = c[(axis + 1) % 3] + c[(axis + 2) % 3];
                pivot -= c[axis] * (c[axis] + MODIFIED * others) * pivots[before] * pivots[before];
            }
            if pivot < SAFE_PIVOT * self.diagonal[i] {
                pivot = self.diagonal[i];
            }
            pivots[i] = 1.0 / pivot.max(1e-6).sqrt();
        }
        pivots
    }

    fn precondition(&self, pivots: &[f32], residual: &[f32], result: &mut [f32]) {
        for i in 0..self.count() {
            let mut sum = residual[i];
            for axis in 0..3 {
                let before = self.before[i][axis] as usize;
                sum += self.coefficient[before][axis] * pivots[before] * result[before];
            }
            result[i] = sum * pivots[i];
        }
        for i in (0..self.count()).rev() {
            let mut sum = result[i];
            for axis in 0..3 {
                sum += self.coefficient[i][axis] * pivots[i] * result[self.next[i][axis] as usize];
            }
            result[i] = sum * pivots[i];
        }
    }

    /// Improves the pressures by conjugate gradients.
    fn solve(&self, pressure: &mut [f32]) {
        let count = self.count();
        let mut applied = vec![0.0; count + 1];
        self.multiply(pressure, &mut applied);
        let mut residual: Vec<f32> = self.right.iter().zip(&applied).map(|(right, applied)| right - applied).collect();
        residual[count] = 0.0;
        let limit = TOLERANCE * TOLERANCE * dot(&self.right, &self.right);
        let pivots = self.preconditioner();
        let mut improved = vec![0.0; count + 1];
        self.precondition(&pivots, &residual, &mut improved);
        let mut direction = improved.clone();
        let mut energy = dot(&residual, &improved);
        for _ in 0..MAX_ITERATIONS {
            if dot(&residual, &residual) <= limit {
                break;
            }
            self.multiply(&direction, &mut applied);
            let curvature = dot(&direction, &applied);
            let is_usable = curvature > 0.0 && energy > 0.0;
            if !is_usable {
                break;
            }
            let step = (energy / curvature) as f32;
            for i in 0..count {
                pressure[i] += step * direction[i];
                residual[i] -= step * applied[i];
            }
            self.precondition(&pivots, &residual, &mut improved);
            let next_energy = dot(&residual, &improved);
            let share = (next_energy / energy) as f32;
            energy = next_energy;
            direction
                .iter_mut()
                .zip(&improved)
                .for_each(|(direction, improved)| *direction = improved + share * *direction);
        }
        if pressure.iter().any(|value| !value.is_finite()) {
            pressure.fill(0.0);
        }
    }
}

fn dot(a: &[f32], b: &[f32]) -> f64 {
    a.iter().zip(b).map(|(a, b)| f64::from(*a) * f64::from(*b)).sum()
}

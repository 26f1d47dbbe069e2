//! Meshes a distance field: surface nets on a grid that is finest at the face.

use super::culled_field::CulledField;
use super::remesh::remesh;
use crate::scene::Mesh;
use fast_surface_nets::ndshape::{RuntimeShape, Shape as _};
use fast_surface_nets::{SurfaceNetsBuffer, surface_nets};
use glam::{UVec3, Vec3};
use rayon::prelude::*;

/// A nonuniform grid: cells of `cell_m` at the focus, which grow more slowly than the distance from it.
#[derive(Clone, Copy, Debug)]
pub struct WarpedGrid {
    /// Point of the smallest cells.
    pub focus: Vec3,
    /// Edge of a cell at the focus, metres.
    pub cell_m: f32,
    /// Distance at which cells begin to grow, metres.
    pub core_m: f32,
}

impl WarpedGrid {
    /// Converts grid coordinates (cells from the focus) to world space.
    fn world(&self, u: Vec3) -> Vec3 {
        let flat = u * self.cell_m;
        let growth = 1.0 + flat.length_squared() / (self.core_m * self.core_m);
        self.focus + flat * growth.sqrt().sqrt() * growth.sqrt().sqrt().sqrt()
    }

    /// Returns the number of cells along an axis from the focus to `distance_m`.
    fn cells_to(&self, distance_m: f32) -> u32 {
        let reach = |cells: u32| self.world(Vec3::X * cells as f32).x - self.focus.x;
        let mut cells = 1;
        while reach(cells) < distance_m {
            cells += 1 + cells / 64;
        }
        cells
    }
}

/// Meshes the surface of a figure: closed, edges about `target` metres long, vertices on the surface.
pub fn skin(field: &CulledField, grid: &WarpedGrid, low: Vec3, high: Vec3, target: impl Fn(Vec3) -> f32) -> Mesh {
    let mut mesh = mesh(field, grid, low, high);
    mesh.positions = mesh.positions.par_iter().map(|&p| field.project(p, 2)).collect();
    remesh(mesh, field, target)
}

/// Meshes the surface within a box by surface nets.
fn mesh(field: &CulledField, grid: &WarpedGrid, low: Vec3, high: Vec3) -> Mesh {
    let below = (grid.focus - low).to_array().map(|d| grid.cells_to(d.max(0.0)) + 2);
    let above = (high - grid.focus).to_array().map(|d| grid.cells_to(d.max(0.0)) + 2);
    let size: [u32; 3] = std::array::from_fn(|k| below[k] + above[k] + 1);
    let shape = RuntimeShape::<u32, 3>::new(size);
    let origin = UVec3::from_array(below).as_vec3();
    let mut samples = vec![0.0_f32; shape.usize()];
    let layer = (size[0] * size[1]) as usize;
    samples.par_chunks_mut(layer).enumerate().for_each(|(z, samples)| {
        for (i, sample) in samples.iter_mut().enumerate() {
            let (x, y) = (i as u32 % size[0], i as u32 / size[0]);
            *sample = field.distance(grid.world(UVec3::new(x, y, z as u32).as_vec3() - origin));
        }
    });
    close_pinches(&mut samples, size);
    let mut buffer = SurfaceNetsBuffer::default();
    surface_nets(&samples, &shape, [0; 3], size.map(|n| n - 1), &mut buffer);
    let positions = buffer.positions.iter().map(|&u| grid.world(Vec3::from(u) - origin)).collect();
    let triangles = buffer.indices.chunks_exact(3).map(|t| [t[0], t[1], t[2]]).collect();
    Mesh { positions, triangles, ..Mesh::default() }
}

/// Fills cells where two sheets of the surface meet (solid or empty corners connected only across a diagonal): surface
/// nets place a single vertex in such a cell, where the mesh would touch itself.
fn close_pinches(samples: &mut [f32], size: [u32; 3]) {
    let stride = [1, size[0] as usize, (size[0] * size[1]) as usize];
    let corners: [usize; 8] =
        std::array::from_fn(|c| (0..3).map(|k| if c >> k & 1 == 1 { stride[k] } else { 0 }).sum::<usize>());
    let is_manifold: Vec<bool> = (0..256_usize).map(|mask| connected(mask) && connected(!mask & 255)).collect();
    loop {
        let mut filled = false;
        for z in 0..size[2] as usize - 1 {
            for y in 0..size[1] as usize - 1 {
                for x in 0..size[0] as usize - 1 {
                    let base = x + stride[1] * y + stride[2] * z;
                    let mask = (0..8).fold(0, |m, c| m | usize::from(samples[base + corners[c]] < 0.0) << c);
                    if is_manifold[mask] {
                        continue;
                    }
                    let empty = corners.iter().map(|c| base + c).filter(|&i| samples[i] >= 0.0);
                    if let Some(i) = empty.min_by(|&a, &b| samples[a].total_cmp(&samples[b])) {
                        samples[i] = -1e-6;
                        filled = true;
                    }
                }
            }
        }
        if !filled {
            return;
        }
    }
}

/// Returns true if a set of a cube's corners is connected along its edges.
fn connected(mask: usize) -> bool {
    let mut reached = mask & mask.wrapping_neg();
    for _ in 0..8 {
        for corner in (0..8).filter(|c| reached >> c & 1 == 1).collect::<Vec<_>>() {
            for axis in 0..3 {
                reached |= mask & (1 << (corner ^ (1 << axis)));
            }
        }
    }
    reached == mask
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn connected_corner_sets_are_recognized() {
        assert!(connected(0) && connected(0b1111_1111) && connected(0b0000_0011));
        assert!(!connected(0b0000_1001) && !connected(0b1000_0001));
    }

    #[test]
    fn cells_with_diagonal_corners_are_filled() {
        let size = [4, 4, 4];
        let mut samples = vec![1.0; 64];
        let at = |x: usize, y: usize, z: usize| x + 4 * y + 16 * z;
        samples[at(1, 1, 1)] = -1.0;
        samples[at(2, 2, 1)] = -1.0;
        close_pinches(&mut samples, size);
        assert!(samples[at(1, 2, 1)] < 0.0 || samples[at(2, 1, 1)] < 0.0);
    }
}

//! The mesh of a tank: closed surfaces of ground, metal and water.
//!
//! Water reaches some way into the ground that it touches, so that there is no air between them and no two surfaces lie
//! in one place: a ray in the water meets the ground first.

mod cubes;
mod nets;
mod smooth;

use super::grid::Grid;
use crate::scene::{Mesh, Tank, TankLook};
use glam::{Vec2, Vec3};

/// Water of less than this part of a cell is a wet spot, which is not drawn.
const FILM: f32 = 0.02;

/// Returns the mesh of a tank with these cells; its parts are those of [`Tank::PARTS`] that there are.
pub fn mesh(grid: &Grid, tank: &Tank) -> Mesh {
    surface_of(grid, tank.look, tank.low_m(), tank.cell_m)
}

/// Returns the surfaces of cells of an edge length, metres, from this lowest corner.
pub fn surface_of(grid: &Grid, look: TankLook, low_m: Vec3, cell_m: f32) -> Mesh {
    let surfaces = match look {
        TankLook::Smooth => smooth::surfaces(grid),
        TankLook::Cubes => cubes::surfaces(grid),
    };
    let mut mesh = Mesh::default();
    let [nx, _, nz] = grid.size().map(|side| side as f32);
    for (surface, name) in surfaces.into_iter().zip(Tank::PARTS) {
        if !surface.triangles.is_empty() {
            mesh.append(&surface.with_single_part(name));
        }
    }
    // Seen from above, a texture covers the tank once
    mesh.uvs = mesh.positions.iter().map(|at| Vec2::new(at.x / nx, 1.0 - at.z / nz)).collect();
    mesh.positions.iter_mut().for_each(|position| *position = low_m + *position * cell_m);
    mesh
}

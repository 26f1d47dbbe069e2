//! The mesh of a tank: closed surfaces of ground, metal and water.
//!
//! Water reaches some way into the ground that it touches, so that there is no air between them and no two surfaces lie
//! in one place: a ray in the water meets the ground first.

mod cubes;
mod falling;
mod nets;
mod particles;
mod smooth;

use super::fluid::FluidSimulation;
use super::grid::Grid;
use crate::scene::{Mesh, Tank, TankLook};
use glam::{Vec2, Vec3};

/// Water of less than this part of a cell is a wet spot, which is not drawn.
const FILM: f32 = 0.02;

/// Returns the mesh of a tank with these cells; its parts are those of [`Tank::PARTS`] that there are.
pub fn mesh(grid: &Grid, tank: &Tank) -> Mesh {
    surface_of(grid, tank.look, tank.low_m(), tank.cell_m)
}

/// Returns the mesh of a tank with this fluid; its parts are those of [`Tank::PARTS`] that there are.
pub fn fluid_mesh(simulation: &FluidSimulation, tank: &Tank) -> Mesh {
    let [ground, metal, _] = surfaces(simulation.grid(), tank.look);
    placed([ground, metal, particles::surface(simulation)], tank.cells.map(f32::from), tank.low_m(), tank.cell_m)
}

/// Returns the surfaces of cells of an edge length, metres, from this lowest corner.
pub fn surface_of(grid: &Grid, look: TankLook, low_m: Vec3, cell_m: f32) -> Mesh {
    placed(surfaces(grid, look), grid.size().map(|side| side as f32), low_m, cell_m)
}

fn surfaces(grid: &Grid, look: TankLook) -> [Mesh; 3] {
    match look {
        TankLook::Smooth => smooth::surfaces(grid),
        TankLook::Cubes => cubes::surfaces(grid),
    }
}

/// Returns the mesh of the surfaces of ground, metal and water, which are in cells.
fn placed(surfaces: [Mesh; 3], [nx, _, nz]: [f32; 3], low_m: Vec3, cell_m: f32) -> Mesh {
    let mut mesh = Mesh::default();
    for (surface, name) in surfaces.into_iter().zip(Tank::PARTS) {
        if !surface.triangles.is_empty() {
            mesh.append(&surface.with_single_part(name));
        }
    }
    // Seen from above, a texture covers the tank once
    mesh.uvs = mesh.positions.iter().map(|at| Vec2::new(at.x / nx, 1.0 - at.z / nz)).collect();
    mesh.positions.iter_mut().for_each(|position| *position = low_m + *position * cell_m);
    mesh.velocities.iter_mut().for_each(|velocity| *velocity *= cell_m);
    mesh
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scene::{Block, CellContent, Spring, Terrain};
    use crate::water::Simulation;

    #[test]
    fn surfaces_are_closed_and_water_meets_ground_without_a_gap() {
        let spring = Spring::new(Vec3::new(0.02, 0.2, 0.03), 0.2);
        for (look, time_s) in [(TankLook::Smooth, 0.0), (TankLook::Smooth, 0.8), (TankLook::Cubes, 0.8)] {
            let tank = Tank {
                cells: [20, 24, 18],
                terrain: Terrain::Hills { seed: 2, low_m: 0.02, high_m: 0.2, period_m: 0.15 },
                blocks: vec![Block { from: [3, 0, 3], to: [5, 20, 6], content: CellContent::Metal }],
                springs: vec![spring.clone()],
                time_s,
                look,
                ..Tank::default()
            };
            let mut simulation = Simulation::new(&tank);
            simulation.run_to(&tank);
            let mesh = mesh(simulation.grid(), &tank);
            let names: Vec<&str> = mesh.part_names().collect();
            assert_eq!(names, Tank::PARTS, "{look:?}");
            let (low, high) = mesh.bounds();
            let slack = Vec3::splat(0.1 * tank.cell_m);
            assert!((low - tank.low_m() + slack).cmpge(Vec3::ZERO).all(), "{low}");
            assert!((tank.low_m() + tank.size_m() + slack - high).cmpge(Vec3::ZERO).all(), "{high}");
            let part = |name: &str| {
                let part = mesh.parts.iter().find(|part| part.name == name).unwrap();
                let triangles = part.triangles.start as usize..part.triangles.end as usize;
                Mesh { triangles: mesh.triangles[triangles].to_vec(), parts: Vec::new(), ..mesh.clone() }
            };
            for name in Tank::PARTS {
                assert!(part(name).is_closed(), "{look:?} {name}");
            }
            // Straight down from inside of the water, a ray meets the ground before the water's own underside
            let (ground, water) = (part("ground"), part("water"));
            let mut met = 0;
            for (x, z) in (2..18).flat_map(|x| (2..16).map(move |z| (x, z))) {
                let at = tank.low_m() + Vec3::new(x as f32 + 0.37, 0.0, z as f32 + 0.43) * tank.cell_m;
                let heights = |mesh: &Mesh| heights_over(mesh, at);
                for pair in heights(&water).chunks(2) {
                    let [under, _] = pair else { panic!("an odd number of surfaces") };
                    let is_carried = |height: &f32| *height >= *under - 1e-5;
                    let metal_or_ground = heights(&ground).iter().any(is_carried) || heights(&part("metal")).len() > 1;
                    // Above the still water it may fall
                    let falls = *under > 0.105;
                    assert!(metal_or_ground || falls, "{look:?}: water over air at {at}, {under}");
                    met += 1;
                }
            }
            assert!(met > 40, "{met}");
        }
    }

    /// Returns the heights at which a mesh is crossed above and below a point, from the lowest.
    fn heights_over(mesh: &Mesh, at: Vec3) -> Vec<f32> {
        let height = |triangle: usize| {
            let [a, b, c] = mesh.corners(triangle);
            let edge = |p: Vec3, q: Vec3| (q.x - p.x) * (at.z - p.z) - (q.z - p.z) * (at.x - p.x);
            let weights = [edge(b, c), edge(c, a), edge(a, b)];
            let sum: f32 = weights.iter().sum();
            let is_in = weights.iter().all(|w| *w > 0.0) || weights.iter().all(|w| *w < 0.0);
            is_in.then(|| (weights[0] * a.y + weights[1] * b.y + weights[2] * c.y) / sum)
        };
        let mut heights: Vec<f32> = (0..mesh.triangles.len()).filter_map(height).collect();
        heights.sort_by(f32::total_cmp);
        heights
    }
}

//! The faces of cells, drawn as cubes: a cell is what fills half of it or more.

use super::FILM;
use crate::scene::Mesh;
use crate::water::grid::{FULL, Grid};
use glam::{IVec3, Vec3};

/// How far the faces of water reach into the ground that they touch, as a part of a cell.
const INTO_GROUND: f32 = 0.03;
/// How far they stay inside of the sides of the tank.
const OFF_SIDES: f32 = 0.01;

/// What a cell is drawn as.
#[derive(Clone, Copy, PartialEq, Eq)]
enum Kind {
    Air,
    Ground,
    Metal,
    Water,
}

/// Returns the faces of ground, metal and water, in cells from the lowest corner.
pub(super) fn surfaces(grid: &Grid) -> [Mesh; 3] {
    [Kind::Ground, Kind::Metal, Kind::Water].map(|kind| faces(grid, kind))
}

fn kind_of(grid: &Grid, cell: usize) -> Kind {
    if grid.is_metal(cell) {
        Kind::Metal
    } else if grid.ground(cell) >= FULL / 2 {
        Kind::Ground
    } else if grid.level(cell) >= FULL / 2 && f32::from(grid.water(cell)) >= FILM * f32::from(FULL) {
        Kind::Water
    } else {
        Kind::Air
    }
}

/// Returns what a cell is drawn as; air beyond the sides.
fn kind_at(grid: &Grid, at: IVec3) -> Kind {
    let size = IVec3::from(grid.size().map(|side| side as i32));
    if at.cmplt(IVec3::ZERO).any() || at.cmpge(size).any() {
        return Kind::Air;
    }
    kind_of(grid, grid.index(at.to_array().map(|side| side as usize)))
}

/// Returns the faces between the cells of a kind and all others.
fn faces(grid: &Grid, kind: Kind) -> Mesh {
    let [nx, ny, nz] = grid.size();
    let mut mesh = Mesh::default();
    for (z, x) in (0..nz).flat_map(|z| (0..nx).map(move |x| (z, x))) {
        for y in (0..ny).filter(|&y| kind_of(grid, grid.index([x, y, z])) == kind) {
            let at = IVec3::new(x as i32, y as i32, z as i32);
            for axis in 0..3 {
                for side in [0, 1] {
                    if kind_at(grid, at + IVec3::AXES[axis] * (2 * side - 1)) != kind {
                        add_face(&mut mesh, grid, kind, at, axis, side);
                    }
                }
            }
        }
    }
    mesh
}

/// Adds the face of a cell on one side of an axis: 0 the lower, 1 the upper.
fn add_face(mesh: &mut Mesh, grid: &Grid, kind: Kind, at: IVec3, axis: usize, side: i32) {
    let [u, v] = [IVec3::AXES[(axis + 1) % 3], IVec3::AXES[(axis + 2) % 3]];
    let corner = at + IVec3::AXES[axis] * side;
    let corners = if side == 1 {
        [corner, corner + u, corner + u + v, corner + v]
    } else {
        [corner, corner + v, corner + u + v, corner + u]
    };
    let first = mesh.positions.len() as u32;
    mesh.positions.extend(corners.map(|corner| match kind {
        Kind::Water => water_corner(grid, corner),
        Kind::Air | Kind::Ground | Kind::Metal => corner.as_vec3(),
    }));
    mesh.normals.extend([Vec3::AXES[axis] * (2 * side - 1) as f32; 4]);
    mesh.triangles.extend([[first, first + 1, first + 2], [first, first + 2, first + 3]]);
}

/// Returns a corner of water: into the ground and metal around it, and off the sides of the tank.
fn water_corner(grid: &Grid, corner: IVec3) -> Vec3 {
    let mut into = IVec3::ZERO;
    for i in 0..8 {
        let offset = IVec3::new(i & 1, i >> 1 & 1, i >> 2);
        if matches!(kind_at(grid, corner - offset), Kind::Ground | Kind::Metal) {
            into += IVec3::ONE - 2 * offset;
        }
    }
    let size = grid.size().map(|side| side as i32);
    let off = |axis: usize| match corner[axis] {
        0 => OFF_SIDES,
        at if at == size[axis] => -OFF_SIDES,
        _ => 0.0,
    };
    let off = Vec3::new(off(0), 0.0, off(2));
    corner.as_vec3() + into.signum().as_vec3() * INTO_GROUND + off
}

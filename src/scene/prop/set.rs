//! What stands about a set: backdrops, flags, reflectors, scrims.

use super::solid::{Solid, noise};
use crate::scene::{Mesh, MeshPart};
use glam::{Vec2, Vec3};
use std::f32::consts::{FRAC_PI_2, FRAC_PI_4};

/// Returns a grid of `columns` x `rows` cells whose vertices a function places from fractions of 0 to 1, with the colour
/// there. Front faces have columns to the right and rows upwards.
fn grid([columns, rows]: [u32; 2], name: &str, vertex: impl Fn(Vec2) -> (Vec3, Vec3)) -> Mesh {
    let mut mesh = Mesh::default();
    for row in 0..=rows {
        for column in 0..=columns {
            let uv = Vec2::new(column as f32 / columns as f32, row as f32 / rows as f32);
            let (position, color) = vertex(uv);
            mesh.positions.push(position);
            mesh.colors.push(color);
            mesh.uvs.push(uv);
        }
    }
    for (row, column) in (0..rows).flat_map(|row| (0..columns).map(move |column| (row, column))) {
        let a = row * (columns + 1) + column;
        let (b, d) = (a + 1, a + columns + 1);
        mesh.triangles.extend([[a, b, d + 1], [a, d + 1, d]]);
    }
    mesh.parts = vec![MeshPart { name: name.to_owned(), triangles: 0..mesh.triangles.len() as u32 }];
    mesh.compute_smooth_normals();
    mesh
}

/// A corner of a cyclorama, 4 x 4 m and 3 m high, with coves of 60 cm. It opens to the front; its origin is on the floor,
/// 2 m before the corner.
pub(super) fn cyclorama_corner() -> Mesh {
    const SIDE_M: f32 = 4.0;
    const HEIGHT_M: f32 = 3.0;
    const COVE_M: f32 = 0.6;
    // Along the foot of the walls: a wall, a quarter of a turn, the other wall. Its point and the direction inwards
    let straight = SIDE_M - COVE_M;
    let turn = COVE_M * FRAC_PI_2;
    let foot = |s: f32| {
        let along = s * (2.0 * straight + turn);
        if along < straight {
            return (Vec3::new(0.0, 0.0, SIDE_M - along), Vec3::X);
        }
        if along > straight + turn {
            return (Vec3::new(COVE_M + along - straight - turn, 0.0, 0.0), Vec3::Z);
        }
        let angle = (along - straight) / COVE_M;
        let inwards = Vec3::new(angle.cos(), 0.0, angle.sin());
        (Vec3::new(COVE_M, 0.0, COVE_M) - inwards * COVE_M, inwards)
    };
    let (columns, rows) = (80, 40);
    let upright = 0.5;
    let place = |uv: Vec2| {
        // Rows run upwards: the cove, then the wall
        let (point, inwards) = foot(uv.x);
        let position = if uv.y < upright {
            let angle = FRAC_PI_2 * uv.y / upright;
            point + inwards * (COVE_M * (1.0 - angle.sin())) + Vec3::Y * (COVE_M * (1.0 - angle.cos()))
        } else {
            point + Vec3::Y * (COVE_M + (HEIGHT_M - COVE_M) * (uv.y - upright) / (1.0 - upright))
        };
        (position, Vec3::ONE)
    };
    let mut mesh = grid([columns, rows], "paint", place);
    let floor = |uv: Vec2| {
        let reach = SIDE_M - COVE_M;
        (Vec3::new(COVE_M + uv.x * reach, 0.0, SIDE_M - uv.y * reach), Vec3::ONE)
    };
    mesh.append(&grid([4, 4], "paint", floor));
    mesh = mesh.with_single_part("paint");
    // Turn the corner to the back
    let (sin, cos) = FRAC_PI_4.sin_cos();
    let turned = |v: Vec3| Vec3::new(v.x * cos - v.z * sin, v.y, v.x * sin + v.z * cos);
    mesh.positions.iter_mut().for_each(|p| *p = turned(*p) - Vec3::Z * 2.0);
    mesh.normals.iter_mut().for_each(|n| *n = turned(*n));
    mesh.colors.clear();
    mesh
}

/// A hand-painted canvas, 2.4 x 2.7 m, hanging in slight waves. Its origin is on the floor under its middle.
pub(super) fn canvas() -> Mesh {
    grid([96, 108], "canvas", |uv| {
        let (x, y) = ((uv.x - 0.5) * 2.4, uv.y * 2.7 + 0.002);
        let wave = 0.012 * (x * 7.0 + 0.6 * noise(Vec3::new(x, y * 0.4, 3.0))).sin() * (1.2 - uv.y);
        let at = Vec3::new(x, y, 0.0);
        // Clouds of two sizes in two tones, lighter towards the middle
        let cloud = 0.55 * noise(at * 1.1) + 0.45 * noise(at * 3.7 + Vec3::Z * 5.0);
        let middle = 1.0 - 0.55 * ((x / 1.3).powi(2) + ((y - 1.5) / 1.6).powi(2)).min(1.0);
        let tone = (0.62 * middle + 0.75 * cloud).clamp(0.12, 1.0);
        let warm = 0.5 + 0.5 * noise(at * 0.8 + Vec3::Z * 9.0);
        (at + Vec3::Z * wave, Vec3::new(1.0, 0.93 + 0.04 * warm, 0.84 + 0.1 * warm) * tone)
    })
}

/// A flag of 60 x 90 cm on a stand with a heavy foot.
pub(super) fn flag() -> Mesh {
    let (middle, side) = (1.02, 0.315);
    let mut solid = Solid::default();
    solid.part("cloth").slab(Vec3::Y * middle, Vec3::new(0.6, 0.9, 0.004));
    solid.part("metal");
    for edge in [-0.455, 0.455] {
        solid.rod(Vec3::new(-side, middle + edge, 0.0), Vec3::new(0.31, middle + edge, 0.0), 0.006);
    }
    solid.rod(Vec3::new(-side, 0.02, 0.0), Vec3::new(-side, middle + 0.47, 0.0), 0.014);
    solid.turned_at(
        Vec3::X * -side,
        &[(0.0, 0.0), (0.2, 0.0), (0.205, 0.004), (0.2, 0.016), (0.03, 0.024), (0.0, 0.024)],
    );
    solid.finish()
}

/// A round reflector of 1.1 m, upright.
pub(super) fn reflector() -> Mesh {
    let mut solid = Solid::default();
    let centre = Vec3::Y * 0.56;
    solid.part("face").wheel(centre - Vec3::Z * 0.002, centre + Vec3::Z * 0.002, 0.55);
    solid.part("rim").wheel(centre - Vec3::Z * 0.0015, centre + Vec3::Z * 0.0015, 0.56);
    solid.finish()
}

/// A frame of 1.2 x 1.2 m with diffusion cloth, on two feet.
pub(super) fn scrim() -> Mesh {
    let (half, low) = (0.6, 0.03);
    let centre = Vec3::Y * (half + low);
    let mut solid = Solid::default();
    solid.part("cloth").sheet(centre, Vec3::X * half, Vec3::Y * half);
    solid.part("metal");
    for side in [-1.0, 1.0] {
        let (x, y) = (Vec3::X * (half * side), Vec3::Y * (half * side));
        solid.rod(centre + x - Vec3::Y * (half + 0.012), centre + x + Vec3::Y * (half + 0.012), 0.012);
        solid.rod(centre + y - Vec3::X * half, centre + y + Vec3::X * half, 0.012);
        solid.rod(Vec3::new(half * side, 0.012, -0.25), Vec3::new(half * side, 0.012, 0.25), 0.012);
    }
    solid.finish()
}

/// A tent of diffusion cloth for products, 80 cm, open to the front.
pub(super) fn tent() -> Mesh {
    let half = 0.4;
    let centre = Vec3::Y * (half + 0.004);
    let axes = [Vec3::X * half, Vec3::Y * half, Vec3::Z * half];
    let mut solid = Solid::default();
    solid.part("cloth");
    solid.sheet(centre - axes[0], axes[2], axes[1]).sheet(centre + axes[0], -axes[2], axes[1]);
    solid.sheet(centre + axes[1], axes[0], axes[2]).sheet(centre - axes[2], axes[0], axes[1]);
    solid.part("floor").sheet(centre - axes[1], axes[0], -axes[2]);
    solid.part("rods");
    for (a, b, c) in [(0, 1, 2), (1, 0, 2), (2, 0, 1)] {
        for (i, k) in [(-1.0, -1.0), (-1.0, 1.0), (1.0, -1.0), (1.0, 1.0)] {
            let middle = centre + axes[b] * i + axes[c] * k;
            solid.rod(middle - axes[a], middle + axes[a], 0.004);
        }
    }
    solid.finish()
}

//! Small things to photograph: a watch, a lipstick, fruit, textile.

use super::solid::{Solid, noise, smooth};
use crate::scene::{Mesh, MeshPart};
use glam::{Vec2, Vec3};
use std::f32::consts::{PI, TAU};

/// A wrist watch of 40 mm, lying on its back, its strap spread.
pub(super) fn watch() -> Mesh {
    let mut solid = Solid::default();
    solid.part("case").turned(&[
        (0.0, 0.0),
        (0.017, 0.0),
        (0.0192, 0.001),
        (0.02, 0.0025),
        (0.02, 0.0075),
        (0.0195, 0.0085),
        (0.0, 0.0085),
    ]);
    solid.rod(Vec3::new(0.0198, 0.005, 0.0), Vec3::new(0.0235, 0.005, 0.0), 0.0024);
    for (x, z) in [(-1.0, -1.0), (1.0, -1.0), (-1.0, 1.0), (1.0, 1.0)] {
        solid.slab(Vec3::new(x * 0.0115, 0.0042, z * 0.0195), Vec3::new(0.0028, 0.0055, 0.01));
    }
    let bezel = [
        (0.0168, 0.00852),
        (0.0198, 0.00852),
        (0.0196, 0.0096),
        (0.0182, 0.0108),
        (0.0172, 0.011),
        (0.0168, 0.0106),
        (0.0168, 0.00852),
    ];
    solid.part("bezel").turned(&bezel);
    solid.part("dial").turned(&[(0.0, 0.00854), (0.01675, 0.00854), (0.01675, 0.00868), (0.0, 0.00868)]);
    solid.part("hands");
    for hour in 0..12_u8 {
        let (sin, cos) = (f32::from(hour) * TAU / 12.0).sin_cos();
        let length = if hour % 3 == 0 { 0.0032 } else { 0.002 };
        let (inner, outer) = (0.0155 - length, 0.0155);
        let way = Vec3::new(sin, 0.0, -cos);
        solid.rod(way * inner + Vec3::Y * 0.0088, way * outer + Vec3::Y * 0.0088, 0.00035);
    }
    // Ten past ten, as in every catalogue
    for (turn, length, width, height) in [(10.17 / 12.0, 0.0085, 0.0005, 0.0091), (10.0 / 60.0, 0.0132, 0.0004, 0.0094)]
    {
        let (sin, cos) = (turn * TAU).sin_cos();
        let way = Vec3::new(sin, 0.0, -cos);
        solid.rod(way * -0.002 + Vec3::Y * height, way * length + Vec3::Y * height, width);
    }
    solid.turned(&[(0.0, 0.00869), (0.001, 0.00869), (0.001, 0.0098), (0.0, 0.0099)]);
    solid.part("crystal").turned(&[
        (0.0, 0.0102),
        (0.01675, 0.0102),
        (0.01675, 0.0108),
        (0.012, 0.0113),
        (0.006, 0.0115),
        (0.0, 0.0116),
    ]);
    solid.part("strap");
    for side in [-1.0_f32, 1.0] {
        solid.slab(Vec3::new(0.0, 0.0024, side * 0.025), Vec3::new(0.0196, 0.0028, 0.007));
        solid.chamfered(Vec3::new(0.0, 0.0013, side * 0.06), Vec3::new(0.0188, 0.0024, 0.07), 0.0006);
    }
    solid.finish()
}

/// A lipstick, open, with its cap beside it.
pub(super) fn lipstick() -> Mesh {
    let mut solid = Solid::default();
    solid.part("case").turned(&[
        (0.0, 0.0),
        (0.0092, 0.0),
        (0.0096, 0.0006),
        (0.0096, 0.03),
        (0.0092, 0.0305),
        (0.0, 0.0305),
    ]);
    let cap_end = Vec3::new(0.052, 0.0102, 0.018);
    solid.wheel(Vec3::new(0.014, 0.0102, 0.006), cap_end, 0.0102);
    solid.part("metal").turned(&[(0.0, 0.0306), (0.0082, 0.0306), (0.0082, 0.044), (0.0076, 0.0446), (0.0, 0.0446)]);
    let mut tip = vec![(0.0, 0.0447), (0.0062, 0.0447)];
    tip.extend(smooth(&[(0.0062, 0.058), (0.0058, 0.0615), (0.0042, 0.0645), (0.0018, 0.0662)]));
    tip.push((0.0, 0.0664));
    solid.part("stick").turned(&tip);
    solid.finish()
}

/// Returns a fruit of a profile, whose skin has a colour at each place, with a stem.
fn fruit(profile: &[(f32, f32)], stem: [Vec3; 2], color: impl Fn(Vec3) -> Vec3) -> Mesh {
    let mut solid = Solid::default();
    solid.part("skin").turned(profile);
    let mut mesh = solid.finish();
    mesh.colors = mesh.positions.iter().map(|p| color(*p).clamp(Vec3::ZERO, Vec3::ONE)).collect();
    let mut solid = Solid::default();
    solid.part("stem").rod(stem[0], stem[1], 0.0014);
    mesh.append(&solid.finish());
    mesh
}

/// An apple, red on one side.
pub(super) fn apple() -> Mesh {
    let profile = smooth(&[
        (0.0, 0.0035),
        (0.006, 0.002),
        (0.015, 0.0),
        (0.026, 0.006),
        (0.035, 0.022),
        (0.0385, 0.042),
        (0.035, 0.06),
        (0.024, 0.07),
        (0.012, 0.069),
        (0.005, 0.063),
        (0.0, 0.06),
    ]);
    fruit(&profile, [Vec3::new(0.0, 0.061, 0.0), Vec3::new(0.003, 0.078, 0.002)], |p| {
        let turn = p.z.atan2(p.x);
        // Streaks from pole to pole
        let streak = 0.5 + 0.5 * noise(Vec3::new(turn * 9.0, p.y * 22.0, 1.0));
        let blush = (0.6 + 0.45 * (turn - 1.2).cos() + 0.5 * (streak - 0.5)).clamp(0.0, 1.0);
        let end = ((p.y - 0.058) / 0.012).clamp(0.0, 1.0) * (1.0 - (p.x.hypot(p.z) / 0.016).min(1.0));
        Vec3::new(0.92, 0.72, 0.3).lerp(Vec3::new(0.75, 0.05, 0.06), blush).lerp(Vec3::new(0.5, 0.5, 0.1), end)
    })
}

/// An orange.
pub(super) fn orange() -> Mesh {
    let points: Vec<(f32, f32)> = (0..=24)
        .map(|i| {
            let (sin, cos) = (PI * i as f32 / 24.0).sin_cos();
            let dent = 0.0014 * (-(1.0 + cos.abs() - 2.0 * cos.abs()).abs() * 30.0).exp();
            (if i == 0 || i == 24 { 0.0 } else { 0.0375 * sin }, 0.0365 - (0.0365 - dent) * cos)
        })
        .collect();
    fruit(&points, [Vec3::new(0.0, 0.0695, 0.0), Vec3::new(0.0, 0.0722, 0.0)], |p| {
        let pores = 0.05 * noise(p * 420.0);
        Vec3::new(1.0, 0.93 + 0.07 * noise(p * 30.0) + pores, 0.8 + pores)
    })
}

/// A pear.
pub(super) fn pear() -> Mesh {
    let profile = smooth(&[
        (0.0, 0.003),
        (0.006, 0.0015),
        (0.015, 0.0),
        (0.027, 0.008),
        (0.034, 0.026),
        (0.033, 0.044),
        (0.025, 0.062),
        (0.0175, 0.078),
        (0.0135, 0.09),
        (0.008, 0.0965),
        (0.0035, 0.0965),
        (0.0, 0.095),
    ]);
    fruit(&profile, [Vec3::new(0.0, 0.095, 0.0), Vec3::new(0.005, 0.117, 0.003)], |p| {
        let freckles = (noise(p * 260.0) - 0.35).max(0.0);
        let ripe = 0.5 + 0.5 * noise(p * 24.0 + Vec3::X);
        Vec3::new(0.75, 0.85, 0.5).lerp(Vec3::new(1.0, 0.8, 0.4), ripe) * (1.0 - 0.7 * freckles)
    })
}

/// A stack of three folded cloths, 30 x 22 cm.
pub(super) fn folded_textile() -> Mesh {
    let mut mesh = Mesh::default();
    let mut low = 0.0;
    for (index, thickness) in [0.034_f32, 0.03, 0.032].into_iter().enumerate() {
        let seed = index as f32 * 3.7;
        let turn = 0.05 * (index as f32 - 1.0);
        let half = Vec3::new(0.15 - 0.004 * index as f32, 0.5 * thickness, 0.11);
        let name = ["under", "middle", "over"][index];
        mesh.append(&cushion(name, half, |p, direction| {
            // Folds bulge at the front; the cloth is uneven
            let bulge = 0.1 * half.y * (p.x * 23.0 + seed).sin() * direction.z.max(0.0);
            let uneven = 0.0022 * noise(p * 14.0 + Vec3::splat(seed));
            let (sin, cos) = turn.sin_cos();
            let at = p + direction * (uneven + bulge);
            Vec3::new(at.x * cos - at.z * sin, at.y + low + half.y, at.x * sin + at.z * cos)
        }));
        low += thickness * 0.97;
    }
    // Stand on the floor
    let lowest = mesh.bounds().0.y;
    mesh.positions.iter_mut().for_each(|p| p.y -= lowest);
    mesh
}

/// Returns a rounded box about the origin, whose vertices a function moves by their place and direction.
fn cushion(name: &str, half: Vec3, place: impl Fn(Vec3, Vec3) -> Vec3) -> Mesh {
    const AROUND: u32 = 96;
    const ROWS: u32 = 40;
    // A superellipsoid: nearly a box, seen from above and from the side
    let power = |x: f32, exponent: f32| x.signum() * x.abs().powf(exponent);
    let mut mesh = Mesh::default();
    for row in 0..=ROWS {
        let latitude = (row as f32 / ROWS as f32 - 0.5) * PI;
        let (height, out) =
            (power(latitude.sin(), 0.6), if row == 0 || row == ROWS { 0.0 } else { power(latitude.cos(), 0.35) });
        for column in 0..AROUND {
            let (sin, cos) = (TAU * column as f32 / AROUND as f32).sin_cos();
            let unit = Vec3::new(power(sin, 0.3) * out, height, power(cos, 0.3) * out);
            mesh.positions.push(place(unit * half, unit.normalize_or(Vec3::Y)));
            mesh.uvs.push(Vec2::new(column as f32 / AROUND as f32, row as f32 / ROWS as f32));
        }
    }
    for (row, column) in (0..ROWS).flat_map(|row| (0..AROUND).map(move |column| (row, column))) {
        let next = (column + 1) % AROUND;
        let [a, b, c, d] =
            [(row, column), (row, next), (row + 1, next), (row + 1, column)].map(|(r, c)| r * AROUND + c);
        // The poles are points
        if row > 0 {
            mesh.triangles.push([a, b, c]);
        }
        if row + 1 < ROWS {
            mesh.triangles.push([a, c, d]);
        }
    }
    mesh.parts = vec![MeshPart { name: name.to_owned(), triangles: 0..mesh.triangles.len() as u32 }];
    mesh.compute_smooth_normals();
    mesh
}

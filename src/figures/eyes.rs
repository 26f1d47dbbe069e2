//! Eyeballs, irises and pupils: separate meshes, so that they have glossy materials and show catchlights.

use super::face::{EYE_RADIUS, eye_center};
use super::proportions::FaceShape;
use crate::scene::Mesh;
use glam::{Affine3A, Vec3};

/// Segments around the line of sight.
const SEGMENTS: u32 = 40;
/// Half the width of an iris, head units.
const IRIS: f32 = 5.8;
/// Half the width of a pupil.
const PUPIL: f32 = 2.2;
/// Radius of curvature of the iris' front, which bulges out of the ball as a cornea does.
const CORNEA: f32 = 9.6;

/// Appends the parts `eyes`, `iris` and `pupil`, each a pair.
pub fn add_eyes(mesh: &mut Mesh, world_from_head: Affine3A, scale: f32, face: &FaceShape) {
    let ball: Vec<(f32, f32)> = (0..=24)
        .map(|i| {
            let angle = std::f32::consts::PI * i as f32 / 24.0;
            (EYE_RADIUS * angle.sin(), EYE_RADIUS * angle.cos())
        })
        .collect();
    // The rim lies slightly inside of the ball, so that ball and iris meet in a clean line.
    let rim = (EYE_RADIUS * EYE_RADIUS - IRIS * IRIS).sqrt() - 0.12;
    let middle = rim - (CORNEA * CORNEA - IRIS * IRIS).sqrt();
    let parts =
        [("eyes", ball), ("iris", lens(IRIS, middle, CORNEA, 7)), ("pupil", lens(PUPIL, middle, CORNEA + 0.06, 4))];
    for (name, profile) in parts {
        let mut part = Mesh::default();
        for side in [1.0, -1.0] {
            let center = eye_center(face) * Vec3::new(side, 1.0, 1.0);
            let place = |p: Vec3| world_from_head.transform_point3((center + p) * scale);
            part.append(&lathe(&profile, place));
        }
        mesh.append(&part.with_single_part(name));
    }
}

/// Returns the profile of a lens: the cap of a ball about (0, `middle`), closed by a shallow cone behind.
fn lens(half_width: f32, middle: f32, radius: f32, rings: u32) -> Vec<(f32, f32)> {
    let reach = (half_width / radius).asin();
    let mut profile: Vec<(f32, f32)> = (0..=rings)
        .map(|i| reach * i as f32 / rings as f32)
        .map(|angle| (radius * angle.sin(), middle + radius * angle.cos()))
        .collect();
    let rim = profile[rings as usize];
    profile.push((0.0, rim.1 - 0.5 * half_width));
    profile
}

/// Rotates a profile of (distance from the axis, position along it) about Z. Its first and last point lie on the axis.
fn lathe(profile: &[(f32, f32)], place: impl Fn(Vec3) -> Vec3) -> Mesh {
    let mut mesh = Mesh::default();
    let rings = profile.len() as u32 - 2;
    mesh.positions.push(place(Vec3::Z * profile[0].1));
    for &(radius, z) in &profile[1..=rings as usize] {
        for segment in 0..SEGMENTS {
            let (sin, cos) = (std::f32::consts::TAU * segment as f32 / SEGMENTS as f32).sin_cos();
            mesh.positions.push(place(Vec3::new(radius * cos, radius * sin, z)));
        }
    }
    mesh.positions.push(place(Vec3::Z * profile[profile.len() - 1].1));
    let at = |ring: u32, segment: u32| 1 + ring * SEGMENTS + segment % SEGMENTS;
    let last = 1 + rings * SEGMENTS;
    for s in 0..SEGMENTS {
        mesh.triangles.push([0, at(0, s), at(0, s + 1)]);
        for ring in 0..rings - 1 {
            let (a, b, c, d) = (at(ring, s), at(ring, s + 1), at(ring + 1, s), at(ring + 1, s + 1));
            mesh.triangles.extend([[a, c, d], [a, d, b]]);
        }
        mesh.triangles.push([at(rings - 1, s), last, at(rings - 1, s + 1)]);
    }
    mesh
}

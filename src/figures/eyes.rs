//! Eyes: a white ball with a bulging cornea that shows the lights. Iris and pupil are painted on the cornea, so that a
//! portrait is traced without refraction. Below its gloss the iris has the normals of what lies there: a flat disc with
//! fibres, so that the side opposite to a light is the brighter one, as behind a real cornea.
//!
//! Sizes are those of Atchison and Smith 2000, "Optics of the Human Eye": a cornea of 7.8 mm radius and an iris of
//! 11.8 mm diameter. The balls of the base mesh, round which its lids lie, have a radius of 13.8 mm instead of 12 mm, and
//! those of adult figures 12.5 to 15 mm; the iris has the same size in all of them.

use super::random::Random;
use super::subdivide::QuadMesh;
use crate::scene::Texture;
use glam::{Affine3A, Vec2, Vec3};
use std::f32::consts::TAU;

/// Radius of an eyeball of the base mesh, metres.
pub const BALL_M: f32 = 0.0138;
/// Radius of the iris, metres.
const IRIS_M: f32 = 0.0059;
/// Greatest radius of the iris, in radii of the ball: that of people, whose balls have a radius of 12 mm.
const GREATEST_IRIS: f32 = IRIS_M / 0.012;
/// Radius of the pupil in studio light, in radii of the iris.
const PUPIL: f32 = 0.0018 / IRIS_M;
/// Radius of the cornea's sphere, in radii of the iris.
const CORNEA: f32 = 0.0078 / IRIS_M;
/// Vertices around.
const AROUND: usize = 96;
/// Rings of the iris.
const IRIS_RINGS: u32 = 12;
/// Size of the picture of the iris's relief: around, and from its edge to the pupil, pixels.
const RELIEF_SIZE: [usize; 2] = [256, 64];
/// Angle by which the edge of the iris leans inwards: the cornea focuses light onto the opposite side. Typical.
const HOLLOW_RAD: f32 = 0.25;
/// Greatest slope of the fibres of the iris, across them. Typical.
const FIBRE_SLOPE: f32 = 0.35;

/// The cornea of an eye: a cap of a sphere.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Cornea {
    /// Centre of the sphere.
    pub centre: Vec3,
    /// Radius of the sphere.
    pub radius: f32,
    /// Unit vector from the centre to the middle of the cap.
    pub axis: Vec3,
}

impl Cornea {
    /// Sine of the angle between the axis and the edge of the cap, where the iris ends.
    pub const EDGE_SINE: f32 = 1.0 / CORNEA;

    /// Returns the cornea of an eye; see [`add_eye`].
    pub fn new(world_from_eye: Affine3A) -> Cornea {
        let axis = world_from_eye.transform_vector3(Vec3::Z);
        let iris = iris_radius(world_from_eye);
        let centre = world_from_eye.transform_point3(Vec3::Z * cornea_centre(iris));
        Cornea { centre, radius: CORNEA * iris * axis.length(), axis: axis.normalize_or(Vec3::Z) }
    }
}

/// Returns the radius of the iris of an eye, in radii of the ball.
fn iris_radius(world_from_eye: Affine3A) -> f32 {
    let ball = world_from_eye.transform_vector3(Vec3::Z).length();
    (IRIS_M / ball).min(GREATEST_IRIS)
}

/// Returns the distance from the ball's centre to that of the cornea's sphere in front of it, by the radius of the iris;
/// both in radii of the ball.
fn cornea_centre(iris: f32) -> f32 {
    (1.0 - iris * iris).sqrt() - iris * (CORNEA * CORNEA - 1.0).sqrt()
}

/// Parts of an eye, in the order of [`EyePart`].
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum EyePart {
    /// The white.
    White,
    /// The iris.
    Iris,
    /// The pupil.
    Pupil,
}

/// Appends an eye, and returns the colours of its vertices, factors of the base colours. `world_from_eye` takes a ball of
/// radius 1 that looks along +Z to its place; `part` numbers the parts.
pub fn add_eye(mesh: &mut QuadMesh, world_from_eye: Affine3A, part: impl Fn(EyePart) -> u8) -> Vec<Vec3> {
    let first = mesh.positions.len();
    let iris_radius = iris_radius(world_from_eye);
    // The white, from the back to the edge of the iris
    let limit = iris_radius.asin();
    let white = (0..=20).map(|i| {
        let angle = std::f32::consts::PI + (limit - std::f32::consts::PI) * i as f32 / 20.0;
        Vec2::new(angle.sin(), angle.cos())
    });
    add_rings(mesh, world_from_eye, part(EyePart::White), white);
    // The cornea: a steeper sphere through the edge of the iris, which is painted on it, as is the pupil
    let centre = cornea_centre(iris_radius);
    let cap = |from: f32, to: f32, steps: u32| {
        let (from, to) = ((from / CORNEA).asin(), (to / CORNEA).asin());
        (0..=steps).map(move |i| {
            let angle = from + (to - from) * i as f32 / steps as f32;
            Vec2::new(0.0, centre) + iris_radius * CORNEA * Vec2::new(angle.sin(), angle.cos())
        })
    };
    let iris = mesh.positions.len();
    add_rings(mesh, world_from_eye, part(EyePart::Iris), cap(1.0, PUPIL, IRIS_RINGS));
    let pupil = mesh.positions.len();
    add_rings(mesh, world_from_eye, part(EyePart::Pupil), cap(PUPIL, 0.0, 4));
    // Colours by the place on the eye
    let to_eye = world_from_eye.inverse();
    let color = |(i, position): (usize, &Vec3)| match first + i {
        vertex if vertex < iris => white_color(to_eye.transform_point3(*position), iris_radius),
        vertex if vertex < pupil => iris_color((vertex - iris) % AROUND, (vertex - iris) / AROUND),
        _ => Vec3::ONE,
    };
    mesh.positions[first..].iter().enumerate().map(color).collect()
}

/// Returns the colour of the white at a point: pinker towards the corners, where vessels are, and grey at the edge of
/// the iris, which shows through.
fn white_color(point: Vec3, iris_radius: f32) -> Vec3 {
    let aside = ((point.x.abs() - 0.5) / 0.45).clamp(0.0, 1.0);
    let vessels = Vec3::ONE.lerp(Vec3::new(0.95, 0.78, 0.74), aside);
    let edge = 1.0 - ((Vec2::new(point.x, point.y).length() - iris_radius) / 0.05).clamp(0.0, 1.0);
    vessels * (1.0 - 0.45 * edge)
}

/// Returns the colour of a vertex of the iris: dark at its edge (the limbal ring), with fibres from there to the pupil,
/// of which those near the pupil are lighter.
fn iris_color(around: usize, ring: usize) -> Vec3 {
    let outwards = 1.0 - ring as f32 / IRIS_RINGS as f32;
    let limbus = ((outwards - 0.78) / 0.22).clamp(0.0, 1.0);
    let mut random = Random::new(around as u32, 7);
    let [fibre, collarette] = [random.unit(), random.unit()];
    let inner = 1.0 - ((outwards - 0.1) / (0.2 + 0.15 * collarette)).clamp(0.0, 1.0);
    let streak = 0.45 + 0.35 * fibre;
    // The inner zone is lighter and warmer.
    let tint = Vec3::ONE.lerp(Vec3::new(1.0, 0.8, 0.45), inner) * (streak + 0.25 * inner);
    // The pupil's edge is a thin dark line.
    let rim = if ring == IRIS_RINGS as usize { 0.4 } else { 1.0 };
    tint * rim * (1.0 - 0.8 * limbus)
}

/// Draws the normals of the iris relative to those of the cornea over it: U goes round, V from the edge to the pupil.
pub fn iris_relief() -> Texture {
    let [width, height] = RELIEF_SIZE;
    let edge_of = |part: f32| (part / CORNEA).asin();
    let mut random = Random::new(0, 11);
    let fibres: Vec<f32> = (0..width).map(|_| FIBRE_SLOPE * (2.0 * random.unit() - 1.0)).collect();
    let pixel = |index: usize| {
        // Rows run down, V runs up
        let v = 1.0 - ((index / width) as f32 + 0.5) / height as f32;
        let angle = edge_of(1.0) + (edge_of(PUPIL) - edge_of(1.0)) * v;
        let outwards = (CORNEA * angle.sin() - PUPIL) / (1.0 - PUPIL);
        let inwards = angle + HOLLOW_RAD * outwards;
        // Fibres end before the edge
        let across = fibres[index % width] * (4.0 * outwards * (1.0 - outwards)).clamp(0.0, 1.0);
        let normal = Vec3::new(across, inwards.sin(), inwards.cos()).normalize_or(Vec3::Z);
        normal.to_array().map(|c| ((c + 1.0) * 127.5).round() as u8)
    };
    Texture::opaque(width as u32, height as u32, (0..width * height).map(pixel).collect())
}

/// Appends a surface of revolution about Z from points (radius, z), outside to the front.
fn add_rings(mesh: &mut QuadMesh, world: Affine3A, part: u8, profile: impl Iterator<Item = Vec2>) {
    let first = mesh.positions.len() as u32;
    let mut rings = 0;
    for point in profile {
        for k in 0..AROUND {
            let direction = Vec2::from_angle(TAU * k as f32 / AROUND as f32) * point.x;
            mesh.positions.push(world.transform_point3(Vec3::new(direction.x, direction.y, point.y)));
        }
        rings += 1;
    }
    let around = AROUND as u32;
    for ring in 0..rings - 1 {
        for k in 0..around {
            let [a, b] = [ring * around + k, ring * around + (k + 1) % around].map(|v| v + first);
            mesh.quads.push([a, b, b + around, a + around]);
            let [u, v] = [k as f32 / around as f32, ring as f32 / (rings - 1) as f32];
            let (du, dv) = (1.0 / around as f32, 1.0 / (rings - 1) as f32);
            mesh.uvs.push([Vec2::new(u, v), Vec2::new(u + du, v), Vec2::new(u + du, v + dv), Vec2::new(u, v + dv)]);
            mesh.parts.push(part);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::figures::{READY, corneas};
    use crate::math::{decode_normal, position_derivatives, tilted_normal};

    #[test]
    fn corneas_have_the_same_size_in_large_and_small_heads() {
        for ready in &READY {
            let figure = ready.figure();
            let least_m = if figure.body.age_years < 18.0 { 0.007 } else { 0.00779 };
            for cornea in corneas(&figure) {
                assert!((least_m..0.00781).contains(&cornea.radius), "{}: {} m", ready.name, cornea.radius);
            }
        }
    }

    #[test]
    fn the_normals_of_the_iris_lean_towards_the_pupil_and_those_of_the_cornea_away() {
        let mut mesh = QuadMesh::default();
        add_eye(&mut mesh, Affine3A::IDENTITY, |part| part as u8);
        let (normals, relief) = (mesh.normals(), iris_relief());
        let mut count = 0;
        for (index, quad) in mesh.quads.iter().enumerate().filter(|(i, _)| mesh.parts[*i] == EyePart::Iris as u8) {
            let [a, b, _, d] = quad.map(|v| mesh.positions[v as usize]);
            let uvs = mesh.uvs[index];
            let derivatives = position_derivatives([b - a, d - a], [uvs[1] - uvs[0], uvs[3] - uvs[0]]).unwrap();
            let middle = (uvs[0] + uvs[2]) / 2.0;
            let [x, y] = [middle.x * RELIEF_SIZE[0] as f32, (1.0 - middle.y) * RELIEF_SIZE[1] as f32];
            let code = relief.rgb[y as usize * RELIEF_SIZE[0] + x as usize].map(|c| f32::from(c) / 255.0);
            let cornea = (normals[quad[0] as usize] + normals[quad[2] as usize]).normalize();
            let iris = tilted_normal(cornea, derivatives, decode_normal(code.into(), 1.0));
            let outwards = ((a + b) / 2.0).with_z(0.0).normalize();
            assert!(cornea.dot(outwards) > 0.2, "{cornea} at {a}");
            // Within the rounding of the picture and of the ring's middle
            assert!((-0.3..0.03).contains(&iris.dot(outwards)) && iris.z > 0.85, "{iris} at {a}");
            count += 1;
        }
        assert_eq!(count, AROUND * IRIS_RINGS as usize);
    }
}

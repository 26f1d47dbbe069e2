//! Eyes: a white ball with a bulging cornea that shows the lights. Iris and pupil are a picture on the flat base of the
//! cornea, seen through it by refraction (see [`crate::math::Dome`]), so that a portrait is traced without rays in glass.
//! The iris has the normals of a flat disc with fibres, so that the side opposite to a light is the brighter one, as behind
//! a real cornea.
//!
//! Sizes are those of Atchison and Smith 2000, "Optics of the Human Eye": a cornea of 7.8 mm radius and an iris of
//! 11.8 mm diameter. The balls of the base mesh, round which its lids lie, have a radius of 13.8 mm instead of 12 mm, and
//! those of adult figures 12.5 to 15 mm; the iris has the same size in all of them.

use super::iris::{CORNEA, IRIS_M, IrisFibres, PUPIL};
use super::subdivide::QuadMesh;
use glam::{Affine3A, Vec2, Vec3};
use std::f32::consts::TAU;

/// Radius of an eyeball of the base mesh, metres.
pub const BALL_M: f32 = 0.0138;
/// Greatest radius of the iris, in radii of the ball: that of people, whose balls have a radius of 12 mm.
const GREATEST_IRIS: f32 = IRIS_M / 0.012;
/// Vertices around.
const AROUND: usize = 96;

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
    pub const EDGE_SINE: f32 = 1.0 / CORNEA.radius;

    /// Returns the cornea of an eye; see [`add_eye`].
    pub fn new(world_from_eye: Affine3A) -> Cornea {
        let axis = world_from_eye.transform_vector3(Vec3::Z);
        let iris = iris_radius(world_from_eye);
        let centre = world_from_eye.transform_point3(Vec3::Z * cornea_centre(iris));
        Cornea { centre, radius: CORNEA.radius * iris * axis.length(), axis: axis.normalize_or(Vec3::Z) }
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
    (1.0 - iris * iris).sqrt() - iris * (CORNEA.radius * CORNEA.radius - 1.0).sqrt()
}

/// Parts of an eye, in the order of [`EyePart`].
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum EyePart {
    /// The white.
    White,
    /// The cornea over iris and pupil.
    Iris,
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
        Ring { uv_radius: 2.0 - i as f32 / 20.0, point: Vec2::new(angle.sin(), angle.cos()) }
    });
    add_rings(mesh, world_from_eye, part(EyePart::White), white);
    // The cornea: a steeper sphere through the edge of the iris
    let centre = cornea_centre(iris_radius);
    let cap = |uv_radius: f32| {
        let angle = (uv_radius / CORNEA.radius).asin();
        let point = Vec2::new(0.0, centre) + iris_radius * CORNEA.radius * Vec2::new(angle.sin(), angle.cos());
        Ring { uv_radius, point }
    };
    let cornea = mesh.positions.len();
    let over_iris = (0..=12).map(|i| 1.0 + (PUPIL - 1.0) * i as f32 / 12.0);
    let over_pupil = [0.97, 0.75, 0.5, 0.25, 0.0].map(|part| PUPIL * part);
    add_rings(mesh, world_from_eye, part(EyePart::Iris), over_iris.chain(over_pupil).map(cap));
    // The colours of vertices are those of materials without the picture: iris and pupil are painted on the cornea
    let (fibres, to_eye) = (IrisFibres::new(PUPIL), world_from_eye.inverse());
    let color = |(i, position): (usize, &Vec3)| {
        let point = to_eye.transform_point3(*position);
        if first + i < cornea { white_color(point, iris_radius) } else { fibres.color(point.truncate() / iris_radius) }
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

/// A circle around the axis of the eye.
#[derive(Clone, Copy, Debug)]
struct Ring {
    /// Radius in the texture coordinates, in half widths of the picture of the iris.
    uv_radius: f32,
    /// Radius and position along the axis, in radii of the ball.
    point: Vec2,
}

/// Appends a surface of revolution about Z from rings, outside to the front.
fn add_rings(mesh: &mut QuadMesh, world: Affine3A, part: u8, rings: impl Iterator<Item = Ring>) {
    let first = mesh.positions.len() as u32;
    let mut uv_radii = Vec::new();
    let direction = |k: usize| Vec2::from_angle(TAU * k as f32 / AROUND as f32);
    for Ring { uv_radius, point } in rings {
        let positions = (0..AROUND).map(|k| (direction(k) * point.x).extend(point.y));
        mesh.positions.extend(positions.map(|position| world.transform_point3(position)));
        uv_radii.push(uv_radius);
    }
    let around = AROUND as u32;
    for (ring, radii) in uv_radii.windows(2).enumerate() {
        for k in 0..AROUND {
            let next = (k + 1) % AROUND;
            let [a, b] = [k, next].map(|k| first + ring as u32 * around + k as u32);
            mesh.quads.push([a, b, b + around, a + around]);
            let uv = |k: usize, radius: f32| direction(k) * (0.5 * radius) + Vec2::splat(0.5);
            mesh.uvs.push([uv(k, radii[0]), uv(next, radii[0]), uv(next, radii[1]), uv(k, radii[1])]);
            mesh.parts.push(part);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::figures::{READY, corneas};

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
    fn the_cornea_is_the_dome_over_the_picture_of_the_iris() {
        let mut mesh = QuadMesh::default();
        add_eye(&mut mesh, Affine3A::IDENTITY, |part| part as u8);
        let normals = mesh.normals();
        for (index, quad) in mesh.quads.iter().enumerate().filter(|(i, _)| mesh.parts[*i] == EyePart::Iris as u8) {
            for (vertex, uv) in quad.iter().zip(mesh.uvs[index]) {
                let point = uv * 2.0 - Vec2::ONE;
                assert!(point.length() < 1.0001, "{point}");
                // The mesh has the normals of the dome but at its edge, where the mesh ends
                let expected = CORNEA.frame(point).z_axis;
                let off = normals[*vertex as usize].angle_between(expected).to_degrees();
                assert!(point.length() > 0.99 || off < 2.0, "{off} degrees at {point}");
            }
        }
    }
}

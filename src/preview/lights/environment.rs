//! The environment estimate: a box of six uniform faces for reflections, and the irradiance bounced by backdrops.
//! Computed on the CPU from a few rays against walls and backdrops, lit without shadows.

use super::light_table::{GpuLight, LightTable};
use crate::photo::PhotometricLight;
use crate::photo::emitter::EmitterShape;
use crate::scene::{Mesh, Scene, Shape, room_mesh, tessellate};
use glam::{Affine3A, Vec3, Vec3A};
use std::f32::consts::{PI, TAU};

/// Outward directions of the six faces.
const FACES: [Vec3; 6] = [Vec3::X, Vec3::NEG_X, Vec3::Y, Vec3::NEG_Y, Vec3::Z, Vec3::NEG_Z];
/// Number of rays of the bounce estimate.
const RAYS: u32 = 96;
/// Distance of a face whose ray hits nothing, metres.
const FAR_M: f32 = 20.0;

/// The environment around the subjects.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Environment {
    /// Corners of the box, world space.
    pub low: Vec3,
    pub high: Vec3,
    /// Radiance of the faces +X, -X, +Y, -Y, +Z, -Z, picture units.
    pub radiance: [Vec3; 6],
    /// Bounced irradiance on a surface that faces +X, -X, +Y, -Y, +Z, -Z, picture units.
    pub irradiance: [Vec3; 6],
}

/// A triangle of a wall or backdrop in world space.
struct BackdropTriangle {
    corners: [Vec3; 3],
    albedo: Vec3,
}

impl Environment {
    /// Estimates the environment; none without a subject, or where the estimate is not finite.
    pub fn new(scene: &Scene, table: &LightTable) -> Option<Self> {
        let probe = probe(scene)?;
        let triangles = backdrop_triangles(scene);
        // Distance and reflected radiance along a ray; none where it hits nothing
        let reflected = |direction: Vec3| {
            let (distance, triangle) = closest_hit(&triangles, probe, direction)?;
            let [a, b, c] = triangle.corners;
            let normal = (b - a).cross(c - a).normalize_or_zero();
            let facing = if normal.dot(direction) > 0.0 { -normal } else { normal };
            let lit = irradiance(table, probe + distance * direction, facing)
                + table.ambient.irradiance
                + table.ambient.bounced;
            Some((distance, triangle.albedo * lit / PI))
        };
        // One ray per face of the box
        let seen = |direction| reflected(direction).unwrap_or_else(|| (FAR_M, table.surround_radiance(direction)));
        let faces = FACES.map(seen);
        let distance = faces.map(|(distance, _)| distance);
        // Integrate the bounced irradiance of each face over the sphere; that of the surround is counted as it comes
        let mut bounced = [Vec3::ZERO; 6];
        for direction in sphere_directions() {
            let Some((_, radiance)) = reflected(direction) else { continue };
            let weight = radiance * (2.0 * TAU / RAYS as f32);
            for (sum, face) in bounced.iter_mut().zip(FACES) {
                *sum += weight * face.dot(direction).max(0.0);
            }
        }
        let environment = Environment {
            low: probe - Vec3::new(distance[1], distance[3], distance[5]),
            high: probe + Vec3::new(distance[0], distance[2], distance[4]),
            radiance: faces.map(|(_, radiance)| radiance),
            irradiance: bounced,
        };
        environment.radiance.iter().chain(&environment.irradiance).all(|c| c.is_finite()).then_some(environment)
    }
}

/// Returns the mean position of the subjects, which are all visible objects except backdrops.
fn probe(scene: &Scene) -> Option<Vec3> {
    let subjects = scene.objects.iter().filter(|o| o.visible && !o.shape.is_sheet());
    let (mut sum, mut count) = (Vec3::ZERO, 0.0);
    for object in subjects {
        // The origin of a figure is between its feet
        let centre = if matches!(object.shape, Shape::Figure(_)) { Vec3::Y * 0.5 } else { Vec3::ZERO };
        sum += object.transform.world_from_object().transform_point3(centre);
        count += 1.0;
    }
    let mean = sum / count + Vec3::Y * 0.02;
    (count > 0.0 && mean.is_finite()).then_some(mean)
}

/// Returns the triangles of the room and of visible backdrops.
fn backdrop_triangles(scene: &Scene) -> Vec<BackdropTriangle> {
    let mut triangles = Vec::new();
    let mut add = |mesh: &Mesh, world: Affine3A, albedo: &dyn Fn(&str) -> [f32; 3]| {
        for part in &mesh.parts {
            let albedo = Vec3::from(albedo(&part.name)).clamp(Vec3::ZERO, Vec3::ONE);
            let corners = part.triangles.clone().map(|t| mesh.corners(t as usize));
            triangles
                .extend(corners.map(|c| BackdropTriangle { corners: c.map(|p| world.transform_point3(p)), albedo }));
        }
    };
    if let Some(room) = &scene.room {
        add(&room_mesh(room), Affine3A::IDENTITY, &|part| room.material_of(part).base_color);
    }
    for object in scene.objects.iter().filter(|o| o.visible && o.shape.is_sheet()) {
        let Some(mesh) = tessellate(&object.shape) else { continue };
        add(&mesh, object.transform.world_from_object(), &|part| {
            let material = object.material_of(part);
            if material.transmission > 0.0 { [0.0; 3] } else { material.base_color }
        });
    }
    triangles
}

/// Returns the closest hit (Moller and Trumbore 1997; the estimate needs no watertight test).
fn closest_hit(triangles: &[BackdropTriangle], origin: Vec3, direction: Vec3) -> Option<(f32, &BackdropTriangle)> {
    let distance = |triangle: &BackdropTriangle| {
        let [a, b, c] = triangle.corners;
        let (u, v) = (b - a, c - a);
        let p = direction.cross(v);
        let scale = 1.0 / u.dot(p);
        let from_a = origin - a;
        let x = from_a.dot(p) * scale;
        let q = from_a.cross(u);
        let y = direction.dot(q) * scale;
        let t = v.dot(q) * scale;
        (x >= 0.0 && y >= 0.0 && x + y <= 1.0 && t > 1e-4).then_some(t)
    };
    triangles
        .iter()
        .filter_map(|triangle| Some((distance(triangle)?, triangle)))
        .min_by(|a, b| a.0.total_cmp(&b.0))
        .filter(|(distance, _)| *distance < FAR_M)
}

/// Returns the unshadowed irradiance of all lights, panels taken from their centre, picture units.
fn irradiance(table: &LightTable, point: Vec3, normal: Vec3) -> Vec3 {
    let lights = table.lights.iter().zip(&table.photometric);
    lights.map(|(gpu, light)| Vec3::from(gpu.color) * irradiance_per_color(gpu, light, point, normal)).sum()
}

/// Returns the irradiance for each unit of a light's packed colour (intensity, luminance or illuminance).
fn irradiance_per_color(gpu: &GpuLight, light: &PhotometricLight, point: Vec3, normal: Vec3) -> f32 {
    let axis = light.axis();
    let to_light = light.position() - point;
    let squared = to_light.length_squared().max(1e-6);
    let direction = to_light / squared.sqrt();
    let (cosine, cos_axis) = (normal.dot(direction).max(0.0), -axis.dot(direction));
    let factor = match &light.shape {
        EmitterShape::Point(distribution) => distribution.relative_intensity(cos_axis) * cosine / squared,
        EmitterShape::Sphere { .. } => gpu.area_m2() * cosine / squared.max(gpu.radius * gpu.radius),
        // Exact on the axis of a disc: E = pi L R^2 / (R^2 + d^2).
        EmitterShape::Rect { .. } | EmitterShape::Disc { .. } => {
            gpu.area_m2() * cosine * cos_axis.max(0.0) / (squared + gpu.area_m2() / PI)
        }
        EmitterShape::Sun { .. } => return normal.dot(-axis).max(0.0),
        EmitterShape::Surround => return 0.0,
    };
    let away_light = light.world_from_light.matrix3.transpose() * Vec3A::from(-direction);
    factor * light.beam.as_ref().map_or(1.0, |beam| beam.transmission(away_light.into()))
}

/// Returns uniform directions over the sphere (golden spiral).
fn sphere_directions() -> impl Iterator<Item = Vec3> {
    (0..RAYS).map(|i| {
        let height = 1.0 - (2 * i + 1) as f32 / RAYS as f32;
        let turn = glam::Vec2::from_angle(i as f32 * 2.399_963_2) * (1.0 - height * height).max(0.0).sqrt();
        Vec3::new(turn.x, height, turn.y)
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scene::{Material, Object, Room, Transform};

    fn subject() -> Object {
        Object { transform: Transform::at(Vec3::Y), ..Object::new("Ball", Shape::Sphere { radius_m: 0.1 }) }
    }

    #[test]
    fn a_uniform_room_has_its_radiance_and_its_size() {
        let paint = Material { base_color: [0.5; 3], ..Material::default() };
        let room =
            Room { size_m: Vec3::new(4.0, 3.0, 6.0), floor: paint.clone(), walls: paint.clone(), ceiling: paint };
        let scene = Scene { room: Some(room), objects: vec![subject()], ..Scene::default() };
        let mut table = LightTable::default();
        table.ambient.irradiance = Vec3::splat(PI);
        let environment = Environment::new(&scene, &table).unwrap();
        // The walls are slightly outside of the room's size
        let slack = 1e-4 + crate::scene::ROOM_STANDS_BACK_M;
        assert!((environment.low - Vec3::new(-2.0, 0.0, -3.0)).abs().max_element() < slack);
        assert!((environment.high - Vec3::new(2.0, 3.0, 3.0)).abs().max_element() < slack);
        for face in 0..6 {
            assert!((environment.radiance[face].x - 0.5).abs() < 1e-5);
            // Half of pi comes back; 96 rays hold it within two percent.
            assert!((environment.irradiance[face].x / (0.5 * PI) - 1.0).abs() < 0.02);
        }
    }

    #[test]
    fn an_empty_scene_has_no_bounced_light() {
        let scene = Scene { objects: vec![subject()], ..Scene::default() };
        let mut table = LightTable::default();
        let environment = Environment::new(&scene, &table).unwrap();
        assert_eq!((environment.radiance, environment.irradiance), ([Vec3::ZERO; 6], [Vec3::ZERO; 6]));
        // The light of a surround is seen, but not bounced
        table.ambient.surround_radiance = Vec3::ONE;
        let environment = Environment::new(&scene, &table).unwrap();
        assert_eq!((environment.radiance, environment.irradiance), ([Vec3::ONE; 6], [Vec3::ZERO; 6]));
        assert_eq!(Environment::new(&Scene::default(), &LightTable::default()), None);
    }
}

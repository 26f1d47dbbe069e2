//! A brute-force path tracer in double precision: the simplest estimator of the picture that the model defines.
//!
//! A path starts at the camera, samples the BSDF alone at every surface, and collects the front of every emitter that
//! it crosses. Emitters neither block nor scatter light. Each ray is tested against every triangle. There is no light
//! sampling, no MIS, no photon, no render plan and no acceleration structure, and nothing is shared with the tracer
//! but the scene, its meshes and the camera's frame.

use crate::reference_bsdf::{Polarisation, Surface};
use crate::studio::statistics::TestRng;
use catchlight::photo::PhotometricLight;
use catchlight::scene::{Assets, CameraFrame, Emitter, Light, Output, Scene, Shape, room_mesh};
use glam::{DAffine3, DMat3, DVec3, Vec2};
use rayon::prelude::*;
use std::f64::consts::PI;

/// Distance that a ray skips, metres: rounding in double precision is some 1e-15.
const START_M: f64 = 1e-9;
/// Depth from which Russian roulette ends paths that have lost light, and from which it ends any path.
const ROULETTE_DEPTH: (u32, u32) = (3, 24);

/// A scene as flat lists.
pub struct BruteForce {
    triangles: Vec<Triangle>,
    /// By object, one for each part of its mesh.
    surfaces: Vec<Surface>,
    emitters: Vec<FrontEmitter>,
    frame: CameraFrame,
    origin: DVec3,
    /// Picture value of 1 cd/m2.
    exposure: f64,
}

struct Triangle {
    /// Outward unit normal, and its product with a point of the plane.
    normal: DVec3,
    offset: f64,
    /// Inward normals of the edges, and their products with a point of the edge.
    edges: [(DVec3, f64); 3],
    surface: usize,
    is_thin: bool,
}

/// A luminous surface.
struct FrontEmitter {
    shape: Emitter,
    centre: DVec3,
    /// Right, up and back: it shines along -back.
    axes: DMat3,
    /// Luminance times colour, cd/m2.
    luminance: DVec3,
    is_visible: bool,
}

#[derive(Clone, Copy)]
struct Ray {
    origin: DVec3,
    direction: DVec3,
}

impl BruteForce {
    /// Converts a scene, whose lights must have extent and continuous output.
    pub fn new(scene: &Scene, assets: &Assets) -> Self {
        let (mut triangles, mut materials) = (Vec::new(), Vec::new());
        let mut add = |mesh: &catchlight::scene::Mesh, world: DAffine3, is_sheet: bool, first: usize| {
            for (part, range) in mesh.parts.iter().enumerate() {
                for index in range.triangles.clone() {
                    let corners = mesh.corners(index as usize).map(|p| world.transform_point3(p.as_dvec3()));
                    triangles.extend(Triangle::new(corners, first + part, is_sheet));
                }
            }
        };
        if let Some(room) = &scene.room {
            let mesh = room_mesh(room);
            add(&mesh, DAffine3::IDENTITY, false, 0);
            materials.extend(mesh.parts.iter().map(|part| room.material_of(&part.name)));
        }
        for object in &scene.objects {
            let mesh = assets.mesh_of(&object.shape).unwrap();
            let world = object.transform.world_from_object();
            let matrix = DMat3::from_cols_array(&world.matrix3.to_cols_array().map(f64::from));
            let world =
                DAffine3 { matrix3: matrix, translation: DVec3::from(world.translation.to_array().map(f64::from)) };
            add(&mesh, world, matches!(object.shape, Shape::Plane { .. }), materials.len());
            materials.extend(mesh.parts.iter().map(|part| object.material_of(&part.name)));
        }
        let camera = &scene.camera;
        // pixel = pi S t L / (C N2) (ISO 2720)
        let [iso, shutter, constant, n] =
            [camera.iso, camera.shutter_s, camera.meter_constant, camera.f_number].map(f64::from);
        BruteForce {
            triangles,
            surfaces: materials.into_par_iter().map(Surface::new).collect(),
            emitters: scene.lights.iter().map(|light| FrontEmitter::new(scene, light)).collect(),
            frame: scene.camera_frame(crate::comparison::ASPECT),
            origin: camera.position.as_dvec3(),
            exposure: PI * iso * shutter / (constant * n * n),
        }
    }

    /// Returns one sample of the picture value at a picture point (0 to 1 from the top left).
    pub fn sample(&self, point: Vec2, rng: &mut TestRng) -> DVec3 {
        let direction = self.frame.direction(point).as_dvec3().normalize();
        self.radiance(Ray { origin: self.origin, direction }, rng) * self.exposure
    }

    /// Returns one sample of the radiance along a camera ray, cd/m2.
    fn radiance(&self, mut ray: Ray, rng: &mut TestRng) -> DVec3 {
        let (mut sum, mut throughput) = (DVec3::ZERO, DVec3::ONE);
        // Scale of radiance by squared indices of refraction, which roulette leaves out
        let mut eta_scale = 1.0;
        // Surfaces of the clear bodies around the ray, the innermost last
        let mut bodies: Vec<usize> = Vec::new();
        let mut accepted = Polarisation::none(ray.direction);
        for depth in 0.. {
            let hit = self.nearest(&ray);
            let distance = hit.map_or(f64::INFINITY, |(distance, _)| distance);
            let medium = bodies.last().map(|&body| &self.surfaces[body]);
            let transmittance = |distance| medium.map_or(DVec3::ONE, |medium| medium.transmittance(distance));

            // Collect the emitters in front of the surface; the camera sees the nearest visible one, and nothing behind
            let crossed = self.emitters.iter().filter_map(|emitter| Some((emitter, emitter.distance(&ray)?)));
            let crossed = crossed.filter(|(_, at)| *at < distance || hit.is_none());
            if depth == 0 {
                let visible: Vec<_> = crossed.filter(|(emitter, _)| emitter.is_visible).collect();
                let nearest = visible.iter().map(|(_, at)| *at).fold(f64::INFINITY, f64::min);
                if !visible.is_empty() {
                    let seen = visible.iter().filter(|(_, at)| *at == nearest);
                    return seen.map(|(emitter, _)| emitter.luminance).sum();
                }
            } else {
                sum += crossed.map(|(emitter, at)| throughput * transmittance(at) * emitter.luminance).sum::<DVec3>();
            }
            let Some((distance, triangle)) = hit else { return sum };
            throughput *= transmittance(distance);

            // Scatter at the surface
            let surface = &self.surfaces[triangle.surface];
            sum += throughput * surface.emission;
            let enters = ray.direction.dot(triangle.normal) < 0.0;
            let normal = if enters { triangle.normal } else { -triangle.normal };
            let after = (surface.is_clear() && !triangle.is_thin).then(|| crossing(&bodies, triangle.surface, enters));
            let ior = |bodies: &[usize]| bodies.last().map_or(1.0, |&body| self.surfaces[body].ior);
            let eta = after.as_ref().map(|after| ior(after) / ior(&bodies));
            let Some(sample) = surface.scatter(-ray.direction, normal, eta, accepted, rng) else { return sum };
            if let (true, Some(after)) = (sample.is_transmitted, after) {
                bodies = after;
                eta_scale /= eta.map_or(1.0, |eta| eta * eta);
            }
            throughput *= sample.weight;
            accepted = sample.accepted;

            // Play Russian roulette
            let left = (throughput.max_element() / eta_scale).min(if depth < ROULETTE_DEPTH.1 { 1.0 } else { 0.95 });
            if depth >= ROULETTE_DEPTH.0 {
                if f64::from(rng.uniform()) >= left {
                    return sum;
                }
                throughput /= left;
            }
            ray = Ray { origin: ray.origin + ray.direction * distance, direction: sample.direction };
        }
        sum
    }

    fn nearest(&self, ray: &Ray) -> Option<(f64, &Triangle)> {
        let mut nearest = None;
        let mut limit = f64::INFINITY;
        for triangle in &self.triangles {
            if let Some(distance) = triangle.distance(ray, limit) {
                limit = distance;
                nearest = Some((distance, triangle));
            }
        }
        nearest
    }
}

/// Returns the bodies around a ray after it entered or left one. A body that was left need not be the innermost.
fn crossing(bodies: &[usize], body: usize, enters: bool) -> Vec<usize> {
    let mut after = bodies.to_vec();
    if enters {
        after.push(body);
    } else if let Some(at) = after.iter().rposition(|&other| other == body) {
        after.remove(at);
    }
    after
}

impl Triangle {
    /// Returns a triangle; none without area.
    fn new([a, b, c]: [DVec3; 3], surface: usize, is_thin: bool) -> Option<Self> {
        let normal = (b - a).cross(c - a).try_normalize()?;
        let edge = |from: DVec3, to: DVec3| {
            let inward = normal.cross(to - from);
            (inward, inward.dot(from))
        };
        let edges = [edge(a, b), edge(b, c), edge(c, a)];
        Some(Triangle { normal, offset: normal.dot(a), edges, surface, is_thin })
    }

    /// Returns the distance at which a ray hits the triangle before `limit`.
    fn distance(&self, ray: &Ray, limit: f64) -> Option<f64> {
        let distance = (self.offset - self.normal.dot(ray.origin)) / self.normal.dot(ray.direction);
        if !(distance > START_M && distance < limit) {
            return None;
        }
        let point = ray.origin + ray.direction * distance;
        self.edges.iter().all(|(inward, offset)| inward.dot(point) >= *offset).then_some(distance)
    }
}

impl FrontEmitter {
    fn new(scene: &Scene, light: &Light) -> Self {
        let frame = scene.light_frame(light);
        let axes = DMat3::from_cols_array(&frame.matrix3.to_cols_array().map(f64::from));
        // Luminance for a flux or an illuminance: F / (pi A), F / (4 pi2 R2), E / (pi sin2 a), E / pi
        let luminance = match (light.emitter, light.power.output) {
            (Emitter::RectPanel { width_m, height_m }, Output::Lumens(flux)) => {
                f64::from(flux) / (PI * f64::from(width_m) * f64::from(height_m))
            }
            (Emitter::RoundPanel { diameter_m }, Output::Lumens(flux)) => {
                f64::from(flux) / (PI * PI * (0.5 * f64::from(diameter_m)).powi(2))
            }
            (Emitter::Sphere { radius_m }, Output::Lumens(flux)) => {
                f64::from(flux) / (4.0 * (PI * f64::from(radius_m)).powi(2))
            }
            (Emitter::Sun { angular_diameter_deg }, Output::Lux(lux)) => {
                f64::from(lux) / (PI * (0.5 * f64::from(angular_diameter_deg)).to_radians().sin().powi(2))
            }
            (Emitter::Surround, Output::Lux(lux)) => f64::from(lux) / PI,
            other => panic!("a light without extent or in other units: {other:?}"),
        };
        let luminance = PhotometricLight::new(scene, &Assets::default(), light).tint.as_dvec3() * luminance;
        let is_visible = light.visible_to_camera;
        FrontEmitter { shape: light.emitter, centre: light.position.as_dvec3(), axes, luminance, is_visible }
    }

    /// Returns the distance at which a ray meets the luminous side; infinite for sun and surround.
    fn distance(&self, ray: &Ray) -> Option<f64> {
        let to_centre = self.centre - ray.origin;
        let along = self.axes.z_axis.dot(ray.direction);
        // Panels shine along -back: a ray meets the front where it travels along +back
        let on_plane = |inside: &dyn Fn(f64, f64) -> bool| {
            let distance = self.axes.z_axis.dot(to_centre) / along;
            let local = ray.direction * distance - to_centre;
            let is_hit = along > 0.0
                && distance > 0.0
                && inside(self.axes.x_axis.dot(local).abs(), self.axes.y_axis.dot(local).abs());
            is_hit.then_some(distance)
        };
        match self.shape {
            Emitter::RectPanel { width_m, height_m } => {
                on_plane(&|x, y| x <= 0.5 * f64::from(width_m) && y <= 0.5 * f64::from(height_m))
            }
            Emitter::RoundPanel { diameter_m } => on_plane(&|x, y| x.hypot(y) <= 0.5 * f64::from(diameter_m)),
            Emitter::Sphere { radius_m } => {
                let radius2 = f64::from(radius_m).powi(2);
                let nearest = to_centre.dot(ray.direction);
                let half_chord2 = radius2 - (to_centre - ray.direction * nearest).length_squared();
                let is_hit = to_centre.length_squared() > radius2 && nearest > 0.0 && half_chord2 >= 0.0;
                is_hit.then(|| nearest - half_chord2.sqrt())
            }
            Emitter::Sun { angular_diameter_deg } => {
                let cos = (0.5 * f64::from(angular_diameter_deg)).to_radians().cos();
                (along >= cos).then_some(f64::INFINITY)
            }
            Emitter::Surround => Some(f64::INFINITY),
            Emitter::Point | Emitter::Spot { .. } => None,
        }
    }
}

//! The connection of a point with a light sample: shadow rays, and straight transmission through clear bodies.
//!
//! `straight_path` says which light these connections bring. A straight path through a body is displaced sideways: a
//! connection refracts the ray at each face. Towards a sun the direction is given. Towards a point, of an area light,
//! too, it is solved by Newton's method; the wavefront between both gives its derivative, the illuminance and the density
//! of the direction (generalised ray tracing: Kneisly 1964, "Local Curvature of Wavefronts in an Optical System").
//!
//! Inner reflections of a body are counted as if they arrived from the same point; they are displaced by a part of its
//! thickness. Without photons nothing else finds light without extent behind glass. It is then approximated: reflections
//! between parallel bodies arrive from the same point, too, and where the path is caustic, light passes on the straight
//! line.

use super::bsdf::{TracedMaterial, fresnel};
use super::face_stack::{ClearFace, FaceStack};
use super::geometry::SurfaceInteraction;
use super::lights::{LightSample, TracedLight};
use super::medium_stack::MediumStack;
use super::ray_caster::{RayCaster, shadow_ray_end};
use super::straight_path::StraightPath;
use crate::math::{Ray, orthonormal_basis};
use glam::{Mat2, Vec2, Vec3};

/// Maximum number of clear surfaces on the way to a light.
const MAX_CLEAR_SURFACES: u32 = 64;
/// Steps of Newton's method towards a point; each doubles the digits.
const MAX_NEWTON_STEPS: u32 = 8;
/// Distance from the point, relative to that of the light, at which the solution is accepted.
const NEWTON_TOLERANCE: f32 = 1e-5;

/// Relative difference of distances at which a point of an emitter counts as hidden by the emitter's front.
const HIDDEN_TOLERANCE: f32 = 1e-4;

/// Light that arrives at a point from a light sample.
#[derive(Clone, Copy, Debug)]
pub struct Connection {
    /// Unit direction towards the light, in which it arrives.
    pub direction: Vec3,
    /// Luminance over pdf, or illuminance normal to the direction, as [`LightSample::value`].
    pub value: f32,
    /// Solid angle density of the direction, 1/sr; none for delta lights.
    pub pdf: Option<f32>,
    /// Transmittance of panes and bodies.
    pub transmittance: Vec3,
}

/// How a ray towards a light passes bodies.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum BodyMode {
    /// Bodies block it.
    Block,
    /// It is refracted while its path is straight.
    Refract,
    /// It passes all of them without refraction.
    Ignore,
}

/// The end of a connection.
#[derive(Clone, Copy, Debug)]
enum Target {
    /// A sun: every ray arrives.
    Infinity,
    /// A point light, a point of an area light, or the centre of a light.
    Point(Vec3),
}

impl Target {
    /// Distance along a ray; none if the target is not ahead.
    fn distance(&self, origin: Vec3, direction: Vec3) -> Option<f32> {
        match self {
            Target::Infinity => Some(f32::INFINITY),
            Target::Point(point) => Some((*point - origin).dot(direction)).filter(|distance| *distance > 0.0),
        }
    }

    /// Returns true for a point whose distance along the ray is less than this.
    fn is_point_within(&self, ray: &Ray, distance: f32) -> bool {
        matches!(self, Target::Point(point) if (*point - ray.origin).dot(ray.direction) < distance)
    }
}

/// The result of following a ray towards a light.
enum Passage {
    Blocked,
    /// The path is caustic.
    Caustic,
    Arrived(Arrival),
}

/// A ray that arrived at a light, or passed beside a point.
struct Arrival {
    transmittance: Vec3,
    crosses_body: bool,
    /// Vector from the ray to the point, perpendicular to the ray.
    miss: Vec3,
    wavefront: Wavefront,
}

/// A ray to follow.
struct Walk {
    target: Target,
    /// Distance of the target from the origin, metres.
    distance: f32,
    /// The bodies around the origin.
    media: MediumStack,
    mode: BodyMode,
    /// Reflections between bodies with parallel faces are included.
    between_bodies: bool,
}

/// The path to a light is caustic.
struct CausticPath;

impl RayCaster<'_> {
    /// Connects a point inside `media` with a light sample. Returns none where no light arrives.
    pub fn connect(
        &mut self,
        origin: Vec3,
        light: &TracedLight,
        sample: &LightSample,
        media: MediumStack,
    ) -> Option<Connection> {
        let LightSample { direction, distance, .. } = *sample;
        if !self.scene.plan().refraction {
            let is_visible = !self.occluded(origin, direction, distance);
            return is_visible.then(|| Connection::on_line(sample, Vec3::ONE));
        }
        let target = if distance.is_finite() { Target::Point(origin + direction * distance) } else { Target::Infinity };
        let is_approximate = sample.pdf.is_none() && !self.photon_caustics();
        let mut walk = Walk { target, distance, media, mode: BodyMode::Refract, between_bodies: is_approximate };
        match self.solve(&walk, origin, light, sample) {
            Ok(connection) => connection,
            Err(CausticPath) if is_approximate => {
                walk.mode = BodyMode::Ignore;
                let Passage::Arrived(arrival) = self.follow(&walk, origin, direction) else { return None };
                Some(Connection::on_line(sample, arrival.transmittance))
            }
            Err(CausticPath) => None,
        }
    }

    /// Transmittance of thin panes from a point to a light at `distance`; bodies block it.
    pub fn pane_transmittance(&mut self, origin: Vec3, direction: Vec3, distance: f32) -> Vec3 {
        let walk = Walk {
            target: Target::Infinity,
            distance,
            media: MediumStack::default(),
            mode: BodyMode::Block,
            between_bodies: false,
        };
        match self.follow(&walk, origin, direction) {
            Passage::Arrived(arrival) => arrival.transmittance,
            Passage::Blocked | Passage::Caustic => Vec3::ZERO,
        }
    }

    /// Finds the straight path to a light sample; towards a point by Newton's method.
    fn solve(
        &mut self,
        walk: &Walk,
        origin: Vec3,
        light: &TracedLight,
        sample: &LightSample,
    ) -> Result<Option<Connection>, CausticPath> {
        let mut direction = sample.direction;
        for _ in 0..MAX_NEWTON_STEPS {
            let arrival = match self.follow(walk, origin, direction) {
                Passage::Blocked => return Ok(None),
                Passage::Caustic => return Err(CausticPath),
                Passage::Arrived(arrival) => arrival,
            };
            let on_line = Connection::on_line(sample, arrival.transmittance);
            let Target::Point(point) = walk.target else { return Ok(Some(on_line)) };
            if !arrival.crosses_body {
                // A solution beside the body is none of this sequence of faces.
                return Ok((direction == sample.direction).then_some(on_line));
            }
            if arrival.miss.length() < NEWTON_TOLERANCE * sample.distance {
                return Ok(refracted_connection(light, sample, point, direction, &arrival));
            }
            direction = arrival.wavefront.correct(direction, arrival.miss);
        }
        Ok(None)
    }

    /// The density with which [`RayCaster::connect`] samples the direction of a straight path from `origin` that crosses
    /// bodies and hits a light at `point`, 1/sr. `media` are those at both ends.
    pub fn straight_path_pdf(
        &mut self,
        light: &TracedLight,
        origin: Vec3,
        direction: Vec3,
        point: Vec3,
        media: MediumStack,
    ) -> f32 {
        let to_point = point - origin;
        let (distance, target) = (to_point.length(), Target::Point(point));
        let walk = Walk { target, distance, media, mode: BodyMode::Refract, between_bodies: false };
        let Passage::Arrived(arrival) = self.follow(&walk, origin, direction) else { return 0.0 };
        let line = to_point / distance;
        light.pdf(origin, line, distance) * density_ratio(light, point, (line, distance), direction, &arrival)
    }

    /// Follows a ray through clear surfaces to its target.
    fn follow(&mut self, walk: &Walk, origin: Vec3, direction: Vec3) -> Passage {
        let scene = self.scene;
        let mut media = walk.media;
        let mut path = StraightPath::default();
        let mut faces = FaceStack::new(direction, walk.between_bodies);
        let mut wavefront = Wavefront::new(direction);
        let mut ray = Ray { origin, direction, t_max: shadow_ray_end(origin, walk.distance) };
        for _ in 0..MAX_CLEAR_SURFACES {
            let Some(hit) = self.intersect(&ray) else {
                if path.open_normal().is_some() {
                    return Passage::Blocked;
                }
                // The space beyond the last surface, up to the sun, is not inside of anything.
                let rest = if ray.t_max.is_finite() { ray.t_max } else { 0.0 };
                let transmittance = faces.transmittance(media.transmittance(&scene.materials, rest));
                return Passage::Arrived(Arrival::new(walk, &ray, transmittance, path.crosses_body(), wavefront));
            };
            let surface = scene.aggregate.surface(&hit);
            let material = &scene.materials[surface.material as usize];
            if !material.transmits() || (walk.mode == BodyMode::Block && !surface.is_thin) {
                return Passage::Blocked;
            }
            let gap = media.transmittance(&scene.materials, hit.triangle.t);
            let color = material.transmission_color(scene.texture_value(&surface), surface.is_thin);
            let is_inside = path.open_normal().is_some();
            wavefront.propagate(hit.triangle.t, ray.direction, path.open_normal());

            // Pass a thin pane
            if surface.is_thin {
                faces.push(&pane_face(&surface, material, color, ray.direction), gap, is_inside);
                let rest = ray.t_max - hit.triangle.t;
                ray = Ray { origin: surface.spawn_origin(ray.direction), direction: ray.direction, t_max: rest };
                continue;
            }

            // Pass the face of a body
            let from_outside = ray.direction.dot(surface.geometric_normal) < 0.0;
            let eta = media.interface(&scene.materials, surface.material, from_outside).eta;
            media.cross(surface.material, from_outside);
            if walk.mode == BodyMode::Ignore {
                // The angle of incidence is that on the thinner side.
                faces.push(&body_face(&surface, color, ray.direction, eta.max(1.0 / eta)), gap, !from_outside);
                let rest = ray.t_max - hit.triangle.t;
                ray = Ray { origin: surface.spawn_origin(direction), direction, t_max: rest };
                continue;
            }
            if is_inside && walk.target.is_point_within(&ray, hit.triangle.t) {
                return Passage::Caustic;
            }
            path.transmit(&surface, from_outside);
            if path.is_caustic() {
                return Passage::Caustic;
            }
            faces.push(&body_face(&surface, color, ray.direction, eta), gap, is_inside);
            let side = if from_outside { 1.0 } else { -1.0 };
            let Some(refracted) = fresnel::refract_about(-ray.direction, surface.normal * side, eta) else {
                return Passage::Blocked;
            };
            wavefront.refract(eta);
            // Parallel faces restore the direction, here without rounding.
            let next = if path.is_straight() { direction } else { refracted };
            let next_origin = surface.spawn_origin(next);
            let t_max = if path.is_straight() {
                match walk.target.distance(next_origin, direction) {
                    Some(distance) => shadow_ray_end(next_origin, distance),
                    None => return Passage::Blocked,
                }
            } else {
                f32::INFINITY
            };
            ray = Ray { origin: next_origin, direction: next, t_max };
        }
        Passage::Blocked
    }
}

impl Connection {
    /// The light sample itself, on the straight line.
    fn on_line(sample: &LightSample, transmittance: Vec3) -> Self {
        let LightSample { direction, value, pdf, .. } = *sample;
        Connection { direction, value, pdf, transmittance }
    }
}

/// The light of a sample at `point` that arrives in another direction, through bodies.
fn refracted_connection(
    light: &TracedLight,
    sample: &LightSample,
    point: Vec3,
    direction: Vec3,
    arrival: &Arrival,
) -> Option<Connection> {
    let LightSample { distance, .. } = *sample;
    let transmittance = arrival.transmittance;
    let viewpoint = point - direction * distance;
    let Some(pdf) = sample.pdf else {
        // The illuminance at the same distance, changed by the wavefront
        let value = light.sample_centre(viewpoint)?.value * distance * distance / arrival.wavefront.area();
        return Some(Connection { direction, value, pdf: None, transmittance });
    };
    // The point may be hidden in this direction: behind the front of a bulb, or at the back of a panel
    let hit = light.intersect(viewpoint, direction)?;
    if (hit.distance - distance).abs() > HIDDEN_TOLERANCE * distance {
        return None;
    }
    let pdf = pdf * density_ratio(light, point, (sample.direction, distance), direction, arrival);
    Some(Connection { direction, value: hit.luminance / pdf, pdf: Some(pdf), transmittance }).filter(|_| pdf > 0.0)
}

/// Density of a direction through bodies over that of the straight line to the same point of an emitter: the solid
/// angles of its surface are cos / d2 on the line and cos / area by the wavefront.
fn density_ratio(
    light: &TracedLight,
    point: Vec3,
    (line, distance): (Vec3, f32),
    direction: Vec3,
    arrival: &Arrival,
) -> f32 {
    let Some(normal) = light.emitter_normal(point) else { return 0.0 };
    let cosines = line.dot(normal).abs() / direction.dot(normal).abs().max(f32::MIN_POSITIVE);
    cosines * arrival.wavefront.area() / (distance * distance)
}

impl Arrival {
    fn new(walk: &Walk, ray: &Ray, transmittance: Vec3, crosses_body: bool, mut wavefront: Wavefront) -> Self {
        let mut miss = Vec3::ZERO;
        if let Target::Point(point) = walk.target {
            let to_point = point - ray.origin;
            let along = to_point.dot(ray.direction);
            wavefront.propagate(along, ray.direction, None);
            miss = to_point - ray.direction * along;
        }
        Arrival { transmittance, crosses_body, miss, wavefront }
    }
}

/// The derivative of the position at which a ray arrives by its direction, both perpendicular to the direction outside
/// of bodies: the distance where there are none. Symmetric, so that it holds from both ends.
struct Wavefront {
    direction: Vec3,
    /// Unit axes perpendicular to the direction.
    axes: [Vec3; 2],
    matrix: Mat2,
    /// Index of refraction relative to the outside of all bodies.
    index: f32,
}

impl Wavefront {
    fn new(direction: Vec3) -> Self {
        let axes = orthonormal_basis(direction).into();
        Wavefront { direction, axes, matrix: Mat2::ZERO, index: 1.0 }
    }

    fn local(&self, w: Vec3) -> Vec2 {
        Vec2::new(w.dot(self.axes[0]), w.dot(self.axes[1]))
    }

    /// Moves on along a ray, outside of bodies or between faces of this normal. Between faces, the angle changes by a
    /// factor 1 / n, and in the plane of incidence by cos2 i / (n cos2 r).
    fn propagate(&mut self, distance: f32, ray_direction: Vec3, between: Option<Vec3>) {
        let reduced = distance / self.index;
        self.matrix += Mat2::from_diagonal(Vec2::splat(reduced));
        if let Some(normal) = between {
            let (cos_i, cos_r) = (self.direction.dot(normal), ray_direction.dot(normal));
            let tangent = self.local(normal).normalize_or_zero();
            let factor = (cos_i * cos_i) / (cos_r * cos_r).max(f32::MIN_POSITIVE) - 1.0;
            let outer = Mat2::from_cols(tangent * tangent.x, tangent * tangent.y);
            self.matrix += outer * (reduced * factor);
        }
    }

    /// Crosses a face into a medium of this relative index of refraction.
    fn refract(&mut self, eta: f32) {
        self.index *= eta;
    }

    /// Area per solid angle, m2/sr: the squared distance where there are no bodies.
    fn area(&self) -> f32 {
        self.matrix.determinant()
    }

    /// The direction whose ray arrives further by a vector: a step of Newton's method.
    fn correct(&self, direction: Vec3, miss: Vec3) -> Vec3 {
        let change = self.matrix.inverse() * self.local(miss);
        (direction + self.axes[0] * change.x + self.axes[1] * change.y).normalize()
    }
}

/// A thin pane as a face.
fn pane_face(
    surface: &SurfaceInteraction,
    material: &TracedMaterial,
    transmission: Vec3,
    direction: Vec3,
) -> ClearFace {
    ClearFace {
        normal: surface.geometric_normal,
        reflectance: fresnel::pane_reflectances(direction.dot(surface.geometric_normal), material.ior()),
        transmission,
    }
}

/// The face of a body; `eta` is the index of the transmitted side over that of the incident side.
fn body_face(surface: &SurfaceInteraction, transmission: Vec3, direction: Vec3, eta: f32) -> ClearFace {
    let (s, p) = fresnel::amplitudes(direction.dot(surface.normal).abs(), eta);
    ClearFace { normal: surface.normal, reflectance: [s * s, p * p], transmission }
}

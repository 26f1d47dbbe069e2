//! The connection of a point with a light sample: shadow rays, and straight transmission through clear bodies.
//!
//! `straight_path` says which light these connections bring. A straight path through a body is displaced sideways: a
//! connection refracts the ray at each face. Towards a sun or an area light the direction is given, and the refracted
//! ray shows whether it arrives. Towards a point the direction is solved by Newton's method; the wavefront between both
//! gives its derivative, and the illuminance (generalised ray tracing: Kneisly 1964, "Local Curvature of Wavefronts in
//! an Optical System").
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

/// Light that arrives at a point from a light sample.
#[derive(Clone, Copy, Debug)]
pub struct Connection {
    /// Unit direction towards the light, in which it arrives.
    pub direction: Vec3,
    /// Luminance over pdf, or illuminance normal to the direction, as [`LightSample::value`].
    pub value: f32,
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
enum Target<'a> {
    /// A sun: every ray arrives.
    Infinity,
    /// A point light, or the centre of a light.
    Point(Vec3),
    /// An area light, which the ray may miss.
    Emitter(&'a TracedLight),
}

impl Target<'_> {
    /// Distance along a ray; none if the target is not ahead.
    fn distance(&self, origin: Vec3, direction: Vec3) -> Option<f32> {
        match self {
            Target::Infinity => Some(f32::INFINITY),
            Target::Point(point) => Some((*point - origin).dot(direction)).filter(|distance| *distance > 0.0),
            Target::Emitter(light) => light.intersect(origin, direction).map(|hit| hit.distance),
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
struct Walk<'a> {
    target: Target<'a>,
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
        let LightSample { direction, distance, value, pdf } = *sample;
        if !self.scene.plan().refraction {
            let connection = Connection { direction, value, transmittance: Vec3::ONE };
            return (!self.occluded(origin, direction, distance)).then_some(connection);
        }
        let target = match pdf {
            _ if distance.is_infinite() => Target::Infinity,
            None => Target::Point(origin + direction * distance),
            Some(_) => Target::Emitter(light),
        };
        let is_approximate = pdf.is_none() && !self.photon_caustics();
        let mut walk = Walk { target, distance, media, mode: BodyMode::Refract, between_bodies: is_approximate };
        match self.solve(&walk, origin, light, sample) {
            Ok(connection) => connection,
            Err(CausticPath) if is_approximate => {
                walk.mode = BodyMode::Ignore;
                let Passage::Arrived(arrival) = self.follow(&walk, origin, direction) else { return None };
                Some(Connection { direction, value, transmittance: arrival.transmittance })
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
        walk: &Walk<'_>,
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
            let transmittance = arrival.transmittance;
            let Target::Point(point) = walk.target else {
                return Ok(Some(Connection { direction, value: sample.value, transmittance }));
            };
            if !arrival.crosses_body {
                // A solution beside the body is none of this sequence of faces.
                let is_straight = direction == sample.direction;
                return Ok(is_straight.then_some(Connection { direction, value: sample.value, transmittance }));
            }
            if arrival.miss.length() < NEWTON_TOLERANCE * sample.distance {
                // The light as it is seen in this direction, from the distance that the wavefront has
                let seen = light.sample_centre(point - direction * sample.distance);
                let value = seen.map_or(0.0, |seen| seen.value * sample.distance * sample.distance);
                let value = value / arrival.wavefront.area().max(f32::MIN_POSITIVE);
                return Ok(Some(Connection { direction, value, transmittance }));
            }
            direction = arrival.wavefront.correct(direction, arrival.miss);
        }
        Ok(None)
    }

    /// Follows a ray through clear surfaces to its target.
    fn follow(&mut self, walk: &Walk<'_>, origin: Vec3, direction: Vec3) -> Passage {
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
            let is_inside = path.open_normal().is_some();
            wavefront.propagate(hit.triangle.t, ray.direction, path.open_normal());

            // Pass a thin pane
            if surface.is_thin {
                faces.push(&pane_face(&surface, material, ray.direction), gap, is_inside);
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
                faces.push(&body_face(&surface, material, ray.direction, eta.max(1.0 / eta)), gap, !from_outside);
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
            faces.push(&body_face(&surface, material, ray.direction, eta), gap, is_inside);
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

impl Arrival {
    fn new(walk: &Walk<'_>, ray: &Ray, transmittance: Vec3, crosses_body: bool, mut wavefront: Wavefront) -> Self {
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
fn pane_face(surface: &SurfaceInteraction, material: &TracedMaterial, direction: Vec3) -> ClearFace {
    ClearFace {
        normal: surface.geometric_normal,
        reflectance: fresnel::pane_reflectances(direction.dot(surface.geometric_normal), material.ior()),
        transmission: Vec3::splat(material.transmission()),
    }
}

/// The face of a body; `eta` is the index of the transmitted side over that of the incident side.
fn body_face(surface: &SurfaceInteraction, material: &TracedMaterial, direction: Vec3, eta: f32) -> ClearFace {
    let (s, p) = fresnel::amplitudes(direction.dot(surface.normal).abs(), eta);
    let transmission = Vec3::splat(material.transmission());
    ClearFace { normal: surface.normal, reflectance: [s * s, p * p], transmission }
}

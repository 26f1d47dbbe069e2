//! Shadow rays through clear surfaces: thin panes, and bodies of glass that the ray crosses on a straight path.

use super::aggregate::Hit;
use super::bsdf::{TracedMaterial, fresnel};
use super::coverage::MAX_PASSED;
use super::face_stack::{ClearFace, FaceStack};
use super::geometry::{PassedBodies, SurfaceInteraction};
use super::medium_stack::MediumStack;
use super::ray_caster::{RayCaster, shadow_ray_end};
use super::ray_filter::RayFilter;
use super::render_scene::RenderScene;
use super::straight_path::StraightPath;
use super::wavefront::Wavefront;
use crate::math::Ray;
use glam::Vec3;

/// Maximum number of clear surfaces on the way to a light.
const MAX_CLEAR_SURFACES: u32 = 64;

/// The treatment of bodies on a shadow ray.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum BodyMode {
    /// Bodies block it.
    Block,
    /// It is refracted while its path is straight.
    Refract,
    /// It passes all of them without refraction.
    Ignore,
}

/// The target of a connection.
#[derive(Clone, Copy, Debug)]
pub enum Target {
    /// A sun: every ray arrives.
    Infinity,
    /// A point light, a point of an area light, or the centre of a light.
    Point(Vec3),
}

impl Target {
    /// Returns the distance along a ray; none if the target is not ahead.
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

/// The end of a shadow ray.
pub enum ShadowRayEnd {
    /// A surface blocks the ray, or it misses the light.
    Blocked,
    /// The path is caustic: light sampling does not bring its light.
    Caustic,
    /// The ray arrives.
    Arrived(Arrival),
}

/// A shadow ray that arrived at a light, or passed beside a point.
pub struct Arrival {
    /// Transmittance of all surfaces and media.
    pub transmittance: Vec3,
    /// True if the ray crossed a body.
    pub crosses_body: bool,
    /// Vector from the ray to the point, perpendicular to the ray.
    pub miss: Vec3,
    /// The wavefront between both ends.
    pub wavefront: Wavefront,
}

/// The target of a shadow ray and what it passes.
pub struct ShadowQuery {
    /// The light, or a point of it.
    pub target: Target,
    /// Distance of the target from the origin, metres.
    pub distance: f32,
    /// The bodies around the origin.
    pub media: MediumStack,
    /// The treatment of bodies.
    pub mode: BodyMode,
    /// Reflections between bodies with parallel faces are included.
    pub between_bodies: bool,
    /// The bodies of lights that it passes: that of its own light.
    pub passed: PassedBodies,
}

impl RayCaster<'_> {
    /// Returns the transmittance of thin panes from a point to a light at `distance`; bodies block it.
    pub fn pane_transmittance(&mut self, origin: Vec3, direction: Vec3, distance: f32, passed: PassedBodies) -> Vec3 {
        let query = ShadowQuery {
            target: Target::Infinity,
            distance,
            media: MediumStack::default(),
            mode: BodyMode::Block,
            between_bodies: false,
            passed,
        };
        match self.trace_shadow_ray(&query, origin, direction) {
            ShadowRayEnd::Arrived(arrival) => arrival.transmittance,
            ShadowRayEnd::Blocked | ShadowRayEnd::Caustic => Vec3::ZERO,
        }
    }

    /// Traces a shadow ray through clear surfaces to its target.
    pub fn trace_shadow_ray(&mut self, query: &ShadowQuery, origin: Vec3, direction: Vec3) -> ShadowRayEnd {
        let mut shadow_ray = ShadowRay::new(self.scene, query, origin, direction);
        for _ in 0..MAX_CLEAR_SURFACES {
            let Some(hit) = self.next_surface(&mut shadow_ray) else { return shadow_ray.arrive() };
            if let Err(end) = shadow_ray.pass(&hit) {
                return end;
            }
        }
        ShadowRayEnd::Blocked
    }
}

impl RayCaster<'_> {
    /// Returns the next surface on a shadow ray, and weights the ray where it passes masked or blended ones.
    fn next_surface(&mut self, shadow_ray: &mut ShadowRay<'_>) -> Option<Hit> {
        let filter = RayFilter::lighting(shadow_ray.query.passed);
        let hit = self.intersect_all(&shadow_ray.ray, filter)?;
        if !self.scene.plan().coverage {
            return Some(hit);
        }
        let (mut next, mut hit, mut travelled) = (shadow_ray.ray, hit, 0.0);
        for _ in 0..MAX_PASSED {
            let surface = self.scene.aggregate.surface(&hit);
            let coverage = self.scene.coverage(&surface);
            if coverage >= 1.0 {
                break;
            }
            shadow_ray.coverage_transmittance *= 1.0 - coverage;
            travelled += hit.t;
            let t_max = next.t_max - hit.t;
            next = Ray { origin: surface.pass_origin(next.direction), t_max, ..next };
            hit = self.scene.aggregate.intersect(&next, filter, &mut self.stack)?;
        }
        Some(Hit { t: travelled + hit.t, ..hit })
    }
}

/// The state of a shadow ray between two clear surfaces.
struct ShadowRay<'a> {
    scene: &'a RenderScene,
    query: &'a ShadowQuery,
    /// Unit direction outside of bodies.
    direction: Vec3,
    ray: Ray,
    media: MediumStack,
    path: StraightPath,
    faces: FaceStack,
    wavefront: Wavefront,
    /// Transmittance of the masked and blended surfaces so far.
    coverage_transmittance: f32,
}

/// A clear surface on a shadow ray.
struct ClearSurface<'a> {
    surface: &'a SurfaceInteraction,
    /// Factor on transmitted light.
    color: Vec3,
    /// Transmittance of the medium before it.
    gap: Vec3,
    /// Distance from the surface before it, metres.
    distance: f32,
    /// The ray is inside of a body that it entered.
    is_inside: bool,
}

impl<'a> ShadowRay<'a> {
    fn new(scene: &'a RenderScene, query: &'a ShadowQuery, origin: Vec3, direction: Vec3) -> Self {
        ShadowRay {
            scene,
            query,
            direction,
            ray: Ray { origin, direction, t_max: shadow_ray_end(origin, query.distance) },
            media: query.media,
            path: StraightPath::default(),
            faces: FaceStack::new(direction, query.between_bodies),
            wavefront: Wavefront::new(direction),
            coverage_transmittance: 1.0,
        }
    }

    /// Ends the ray, which hits nothing before its target.
    fn arrive(self) -> ShadowRayEnd {
        if self.path.open_normal().is_some() {
            return ShadowRayEnd::Blocked;
        }
        // The space beyond the last surface, up to the sun, is not inside of anything.
        let rest = if self.ray.t_max.is_finite() { self.ray.t_max } else { 0.0 };
        let transmittance = self.faces.transmittance(self.media.transmittance(&self.scene.materials, rest))
            * self.coverage_transmittance;
        let mut wavefront = self.wavefront;
        let mut miss = Vec3::ZERO;
        if let Target::Point(point) = self.query.target {
            let to_point = point - self.ray.origin;
            let along = to_point.dot(self.ray.direction);
            wavefront.propagate(along, self.ray.direction, None);
            miss = to_point - self.ray.direction * along;
        }
        ShadowRayEnd::Arrived(Arrival { transmittance, crosses_body: self.path.crosses_body(), miss, wavefront })
    }

    /// Passes a surface, or ends the ray there.
    fn pass(&mut self, hit: &Hit) -> Result<(), ShadowRayEnd> {
        let surface = &self.scene.surface(&self.ray, hit);
        let material = &self.scene.materials[surface.material as usize];
        if !material.is_clear() || (self.query.mode == BodyMode::Block && !surface.is_thin) {
            return Err(ShadowRayEnd::Blocked);
        }
        let clear = ClearSurface {
            surface,
            color: self.scene.material_point(surface).transmission_color(surface.is_thin),
            gap: self.media.transmittance(&self.scene.materials, hit.t),
            distance: hit.t,
            is_inside: self.path.open_normal().is_some(),
        };
        self.wavefront.propagate(clear.distance, self.ray.direction, self.path.open_normal());
        if surface.is_thin {
            self.faces.push(&pane_face(surface, material, clear.color, self.ray.direction), clear.gap, clear.is_inside);
            self.continue_undeviated(&clear);
            return Ok(());
        }
        let from_outside = self.ray.direction.dot(surface.geometric_normal) < 0.0;
        let eta = self.media.interface(&self.scene.materials, surface.material, from_outside).eta;
        self.media.cross(surface.material, from_outside);
        if self.query.mode == BodyMode::Ignore {
            // The angle of incidence is that on the thinner side.
            let face = body_face(surface, clear.color, self.ray.direction, eta.max(1.0 / eta));
            self.faces.push(&face, clear.gap, !from_outside);
            self.continue_undeviated(&clear);
            return Ok(());
        }
        self.refract(&clear, from_outside, eta)
    }

    /// Continues beyond a surface in the same direction.
    fn continue_undeviated(&mut self, clear: &ClearSurface<'_>) {
        let direction = self.ray.direction;
        let t_max = self.ray.t_max - clear.distance;
        self.ray = Ray { origin: clear.surface.spawn_origin(direction), direction, t_max };
    }

    /// Refracts the ray at the face of a body while its path is straight.
    fn refract(&mut self, clear: &ClearSurface<'_>, from_outside: bool, eta: f32) -> Result<(), ShadowRayEnd> {
        let ClearSurface { surface, color, gap, distance, is_inside } = *clear;
        if is_inside && self.query.target.is_point_within(&self.ray, distance) {
            return Err(ShadowRayEnd::Caustic);
        }
        self.path.transmit(surface, from_outside);
        if self.path.is_caustic() {
            return Err(ShadowRayEnd::Caustic);
        }
        self.faces.push(&body_face(surface, color, self.ray.direction, eta), gap, is_inside);
        let side = if from_outside { 1.0 } else { -1.0 };
        let refracted = fresnel::refract_about(-self.ray.direction, surface.normal * side, eta);
        let refracted = refracted.ok_or(ShadowRayEnd::Blocked)?;
        self.wavefront.refract(eta);
        if !self.path.is_straight() {
            let origin = surface.spawn_origin(refracted);
            self.ray = Ray { origin, direction: refracted, t_max: f32::INFINITY };
            return Ok(());
        }
        // Parallel faces restore the direction, here without rounding
        let direction = self.direction;
        let origin = surface.spawn_origin(direction);
        let distance = self.query.target.distance(origin, direction).ok_or(ShadowRayEnd::Blocked)?;
        self.ray = Ray { origin, direction, t_max: shadow_ray_end(origin, distance) };
        Ok(())
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

//! Ray casting against the surfaces of a studio: closest hits, shadow rays and transmittance towards a light.

use super::aggregate::Hit;
use super::bsdf::pane_transmittance;
use super::bvh::TraversalStack;
use super::medium_stack::MediumStack;
use super::render_scene::RenderScene;
use crate::math::Ray;
use glam::Vec3;

/// Maximum number of clear surfaces on the straight line to a light.
const MAX_CLEAR_SURFACES: u32 = 64;

/// Relative tolerance of coordinates and distances to an emitter, larger than their rounding: some 20 micrometres at
/// five metres. An emitter may lie on a surface (a panel on the wall, a lamp on the ceiling) and is visible all the
/// same.
pub(super) const EMITTER_CONTACT: f32 = 32.0 * f32::EPSILON;

/// Casts rays for one thread.
#[derive(Debug)]
pub struct RayCaster<'a> {
    /// The scene.
    pub scene: &'a RenderScene,
    /// Caustics come from photons, so that light sampling must not cross curved glass.
    photon_caustics: bool,
    /// Scratch space of traversals.
    pub stack: TraversalStack,
    /// Rays traced so far.
    pub rays: u64,
}

impl<'a> RayCaster<'a> {
    /// A caster for a scene without photons.
    pub fn new(scene: &'a RenderScene) -> Self {
        Self::with_photon_caustics(scene, false)
    }

    /// A caster for a scene whose caustics come from photons, or do not.
    pub fn with_photon_caustics(scene: &'a RenderScene, photon_caustics: bool) -> Self {
        RayCaster { scene, photon_caustics, stack: TraversalStack::default(), rays: 0 }
    }

    /// Returns the closest hit.
    pub fn intersect(&mut self, ray: &Ray) -> Option<Hit> {
        self.rays += 1;
        self.scene.aggregate.intersect(ray, &mut self.stack)
    }

    /// Returns true if a surface lies between a point and an emitter at `distance` from it.
    pub fn occluded(&mut self, origin: Vec3, direction: Vec3, distance: f32) -> bool {
        self.rays += 1;
        let ray = Ray { origin, direction, t_max: shadow_ray_end(origin, distance) };
        self.scene.aggregate.occluded(&ray, &mut self.stack)
    }

    /// Transmittance from a light at `distance` along a direction to a point inside `media`. Thin panes transmit.
    /// Bodies of glass transmit to a delta light alone; where caustics come from photons, only between parallel faces.
    pub fn visibility(
        &mut self,
        origin: Vec3,
        direction: Vec3,
        distance: f32,
        is_delta: bool,
        mut media: MediumStack,
    ) -> Vec3 {
        let scene = self.scene;
        if !scene.plan().refraction {
            return if self.occluded(origin, direction, distance) { Vec3::ZERO } else { Vec3::ONE };
        }
        let mut ray = Ray { origin, direction, t_max: shadow_ray_end(origin, distance) };
        let mut transmittance = Vec3::ONE;
        let outer = media.innermost();
        let mut last_face: Option<Vec3> = None;
        for _ in 0..MAX_CLEAR_SURFACES {
            let Some(hit) = self.intersect(&ray) else {
                if self.photon_caustics && media.innermost() != outer {
                    return Vec3::ZERO;
                }
                // The space beyond the last surface, up to the sun, is not inside of anything.
                let rest = if ray.t_max.is_finite() { ray.t_max } else { 0.0 };
                return transmittance * media.transmittance(&scene.materials, rest);
            };
            let surface = scene.aggregate.surface(&hit);
            let material = &scene.materials[surface.material as usize];
            if !material.transmits() || !(is_delta || surface.is_thin) {
                return Vec3::ZERO;
            }
            let cos = direction.dot(surface.geometric_normal);
            transmittance *= media.transmittance(&scene.materials, hit.triangle.t) * material.transmission();
            if surface.is_thin {
                transmittance *= pane_transmittance(cos, material.ior());
            } else {
                if self.photon_caustics && last_face.is_some_and(|face| !are_parallel(face, surface.normal)) {
                    return Vec3::ZERO;
                }
                last_face = Some(surface.normal);
                // Each of two parallel faces has the square root of the pane's transmittance.
                let eta = media.interface(&scene.materials, surface.material, cos < 0.0).eta;
                transmittance *= pane_transmittance(cos, eta.max(1.0 / eta)).sqrt();
                media.cross(surface.material, cos < 0.0);
            }
            let rest = ray.t_max - hit.triangle.t;
            ray = Ray { origin: surface.spawn_origin(direction), direction, t_max: rest };
        }
        Vec3::ZERO
    }
}

/// Returns true if directions, or the normals of a pane's faces, are parallel but for rounding (3 microradians). Light
/// that passes without a change of direction is found by light sampling, all other light through glass by photons.
pub(super) fn are_parallel(a: Vec3, b: Vec3) -> bool {
    a.cross(b).length_squared() < 1e-11
}

/// End of a ray towards an emitter that may lie on a surface; infinite towards a sun.
fn shadow_ray_end(origin: Vec3, distance: f32) -> f32 {
    if distance.is_finite() { distance - EMITTER_CONTACT * (distance + origin.abs().max_element()) } else { distance }
}

/// Returns true if an emitter at one distance is not hidden by a surface at another. Sun and surround are met by rays
/// that leave the studio.
pub(super) fn is_before(ray: &Ray, emitter_distance: f32, surface_distance: f32) -> bool {
    if emitter_distance.is_finite() {
        shadow_ray_end(ray.origin, emitter_distance) <= surface_distance
    } else {
        surface_distance.is_infinite()
    }
}

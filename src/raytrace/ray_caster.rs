//! Ray casting against the surfaces of a studio: closest hits and shadow rays.

use super::aggregate::Hit;
use super::bvh::TraversalStack;
use super::geometry::PassedBodies;
use super::ray_filter::RayFilter;
use super::render_scene::RenderScene;
use crate::math::Ray;
use glam::Vec3;

/// Relative tolerance of coordinates and distances to an emitter, larger than their rounding: some 20 micrometres at
/// five metres. An emitter may lie on a surface (a panel on the wall, a lamp on the ceiling) and is visible all the
/// same.
pub(super) const EMITTER_CONTACT: f32 = 32.0 * f32::EPSILON;

/// Casts rays for one thread.
#[derive(Debug)]
pub struct RayCaster<'a> {
    /// The scene.
    pub scene: &'a RenderScene,
    /// Caustics come from photons, so that light sampling must not approximate them.
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
        self.intersect_filtered(ray, RayFilter::default())
    }

    /// Returns the closest hit of a camera ray, which passes the bodies of lights that are hidden from the camera.
    pub fn intersect_from_camera(&mut self, ray: &Ray) -> Option<Hit> {
        self.intersect_filtered(ray, RayFilter::seen(PassedBodies::Hidden))
    }

    /// Returns the closest hit of a ray with what its filter leaves.
    pub fn intersect_filtered(&mut self, ray: &Ray, filter: RayFilter) -> Option<Hit> {
        if !self.scene.plan().coverage {
            return self.intersect_all(ray, filter);
        }
        let hit = self.intersect_all(ray, filter)?;
        self.skip_uncovered(ray, hit, filter)
    }

    /// Returns the closest hit, also of a surface that is not there.
    pub(super) fn intersect_all(&mut self, ray: &Ray, filter: RayFilter) -> Option<Hit> {
        self.rays += 1;
        self.scene.aggregate.intersect(ray, filter, &mut self.stack)
    }

    /// Returns true if a surface lies between a point and an emitter at `distance` from it. Light passes the body of
    /// its own light.
    pub fn occluded(&mut self, origin: Vec3, direction: Vec3, distance: f32, passed: PassedBodies) -> bool {
        let ray = Ray { origin, direction, t_max: shadow_ray_end(origin, distance) };
        let filter = RayFilter::lighting(passed);
        if self.scene.plan().coverage {
            return self.intersect_filtered(&ray, filter).is_some();
        }
        self.rays += 1;
        self.scene.aggregate.occluded(&ray, filter, &mut self.stack)
    }

    /// Returns true if caustics come from photons.
    pub fn photon_caustics(&self) -> bool {
        self.photon_caustics
    }
}

/// End of a ray towards an emitter that may lie on a surface; infinite towards a sun.
pub(super) fn shadow_ray_end(origin: Vec3, distance: f32) -> f32 {
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

//! Straight ways through the studio: what a ray meets first, and how much of a light comes through to a point.

use super::aggregate::Hit;
use super::bsdf::pane_transmittance;
use super::medium_stack::MediumStack;
use super::path_tracer::Tracer;
use crate::math::Ray;
use glam::Vec3;

/// Surfaces that light on its straight way through glass may cross.
const CLEAR_SURFACES: u32 = 64;

/// A share of coordinates and distances that is more than their rounding on the way to an emitter: some 20 micrometres
/// at five metres. Emitters may lie on a surface (a panel on the wall, a lamp on the ceiling) and are seen all the same.
pub(super) const TOUCHING: f32 = 32.0 * f32::EPSILON;

/// Whether directions, or the normals of a pane's faces, lie on one line but for rounding (3 microradians): photons do not
/// bring what goes on as it came, and light sampling nothing else.
pub(super) fn are_parallel(a: Vec3, b: Vec3) -> bool {
    a.cross(b).length_squared() < 1e-11
}

impl Tracer<'_> {
    /// The closest surface.
    pub fn closest(&mut self, ray: &Ray) -> Option<Hit> {
        self.rays += 1;
        self.scene.aggregate.intersect(ray, &mut self.stack)
    }

    /// Whether anything but emitters lies between a point and one at `distance` from it.
    pub fn blocked(&mut self, origin: Vec3, direction: Vec3, distance: f32) -> bool {
        self.rays += 1;
        let ray = Ray { origin, direction, t_max: short_of(origin, distance) };
        self.scene.aggregate.occluded(&ray, &mut self.stack)
    }

    /// Share of a light that reaches a point inside `media`, from `distance` away along a direction. Thin panes let it
    /// through; bodies of glass do for a light without a size, where photons are about only between parallel faces.
    pub fn visibility(
        &mut self,
        origin: Vec3,
        direction: Vec3,
        distance: f32,
        sized: bool,
        mut media: MediumStack,
    ) -> Vec3 {
        let scene = self.scene;
        if !scene.plan().refraction {
            return if self.blocked(origin, direction, distance) { Vec3::ZERO } else { Vec3::ONE };
        }
        let mut ray = Ray { origin, direction, t_max: short_of(origin, distance) };
        let mut passed = Vec3::ONE;
        let outer = media.innermost();
        let mut last_face: Option<Vec3> = None;
        for _ in 0..CLEAR_SURFACES {
            let Some(hit) = self.closest(&ray) else {
                if self.has_caustics() && media.innermost() != outer {
                    return Vec3::ZERO;
                }
                // A sun beyond the last surface is not inside of anything.
                let rest = if ray.t_max.is_finite() { ray.t_max } else { 0.0 };
                return passed * media.transmittance(&scene.materials, rest);
            };
            let surface = scene.aggregate.surface(&hit);
            let material = &scene.materials[surface.material as usize];
            if !material.transmits() || (sized && !surface.is_thin) {
                return Vec3::ZERO;
            }
            let cos = direction.dot(surface.geometric_normal);
            passed *= media.transmittance(&scene.materials, hit.triangle.t) * material.transmission();
            if surface.is_thin {
                passed *= pane_transmittance(cos, material.ior());
            } else {
                if self.has_caustics() && last_face.is_some_and(|face| !are_parallel(face, surface.normal)) {
                    return Vec3::ZERO;
                }
                last_face = Some(surface.normal);
                // Each of two parallel faces takes its half of what the pane takes, in stops.
                let eta = media.interface(&scene.materials, surface.material, cos < 0.0).eta;
                passed *= pane_transmittance(cos, eta.max(1.0 / eta)).sqrt();
                media.cross(surface.material, cos < 0.0);
            }
            let rest = ray.t_max - hit.triangle.t;
            ray = Ray { origin: surface.spawn_origin(direction), direction, t_max: rest };
        }
        Vec3::ZERO
    }
}

/// End of a ray towards an emitter that may lie on a surface; none before a sun, whose distance less a share of it would be
/// no number.
fn short_of(origin: Vec3, distance: f32) -> f32 {
    if distance.is_finite() { distance - TOUCHING * (distance + origin.abs().max_element()) } else { distance }
}

/// Whether an emitter at one distance is seen before a surface at another. Sun and surround are seen by rays that leave
/// the studio.
pub(super) fn reaches(ray: &Ray, emitter: f32, surface: f32) -> bool {
    if emitter.is_finite() { short_of(ray.origin, emitter) <= surface } else { surface.is_infinite() }
}

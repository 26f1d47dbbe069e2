//! Rays through masked or blended surfaces.
//!
//! Where a surface covers a part of a point, a path meets it with that probability: by a number that is a hash of the
//! ray and the triangle, so that the result does not depend on the order of work. Shadow rays are weighted instead.

use super::aggregate::{Hit, Primitive};
use super::geometry::PassedBodies;
use super::ray_caster::{RayCaster, shadow_ray_end};
use super::ray_filter::RayFilter;
use crate::math::Ray;
use glam::Vec3;

/// Maximum number of masked or blended surfaces that a ray passes between two others; the next one stops it.
pub(super) const MAX_PASSED: u32 = 4096;
/// Transmittance so far below which a shadow ray counts as blocked.
const NEGLIGIBLE: f32 = 1e-4;

impl RayCaster<'_> {
    /// Returns the first surface from `hit` on that covers the ray.
    pub(super) fn skip_uncovered(&mut self, ray: &Ray, hit: Hit, filter: RayFilter) -> Option<Hit> {
        let (mut next, mut hit, mut travelled) = (*ray, hit, 0.0);
        for _ in 0..MAX_PASSED {
            let surface = self.scene.aggregate.surface(&hit);
            let coverage = self.scene.coverage(&surface);
            if coverage >= 1.0 || (coverage > 0.0 && unit_hash(ray, &hit) < coverage) {
                break;
            }
            travelled += hit.t;
            next = Ray { origin: surface.pass_origin(ray.direction), t_max: ray.t_max - travelled, ..next };
            hit = self.scene.aggregate.intersect(&next, filter, &mut self.stack)?;
        }
        Some(Hit { t: travelled + hit.t, ..hit })
    }

    /// Returns the part of the light that passes from a point to an emitter at `distance`, 0 to 1, where masked or
    /// blended surfaces alone let light pass.
    pub(super) fn passed_light(&mut self, origin: Vec3, direction: Vec3, distance: f32, passed: PassedBodies) -> f32 {
        self.rays += 1;
        let mut ray = Ray { origin, direction, t_max: shadow_ray_end(origin, distance) };
        let mut transmittance = 1.0;
        for _ in 0..MAX_PASSED {
            let Some(hit) = self.scene.aggregate.intersect(&ray, RayFilter::lighting(passed), &mut self.stack) else {
                return transmittance;
            };
            let surface = self.scene.aggregate.surface(&hit);
            transmittance *= 1.0 - self.scene.coverage(&surface);
            if transmittance < NEGLIGIBLE {
                return 0.0;
            }
            ray = Ray { origin: surface.pass_origin(direction), t_max: ray.t_max - hit.t, ..ray };
        }
        0.0
    }
}

/// Returns a number in 0..1 that is a hash of a ray and the triangle that it hits.
fn unit_hash(ray: &Ray, hit: &Hit) -> f32 {
    let triangle = match hit.primitive {
        Primitive::Triangle(triangle) => triangle.triangle,
        Primitive::Strand(strand) => strand.segment.segment,
    };
    let [x, y, z] = ray.origin.to_array().map(f32::to_bits);
    let [u, v, w] = ray.direction.to_array().map(f32::to_bits);
    let words = [x, y, z, u, v, w, hit.instance, triangle];
    // The finaliser of MurmurHash3 after each word
    let hash = words.into_iter().fold(0x9e37_79b9_7f4a_7c15_u64, |hash, word| {
        let mixed = (hash ^ u64::from(word)).wrapping_mul(0xff51_afd7_ed55_8ccd);
        let mixed = (mixed ^ (mixed >> 33)).wrapping_mul(0xc4ce_b9fe_1a85_ec53);
        mixed ^ (mixed >> 33)
    });
    (hash >> 40) as f32 / (1_u32 << 24) as f32
}

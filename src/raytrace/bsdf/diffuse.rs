//! The diffuse lobe under the coat: Lambertian, scaled by the energy that the coat transmits.

use crate::math::warp;
use glam::{Vec2, Vec3};

/// The diffuse lobe for one outgoing direction.
#[derive(Clone, Copy, Debug)]
pub struct DiffuseLobe {
    /// BSDF without its factor for the incident direction.
    pub factor: Vec3,
}

impl DiffuseLobe {
    /// Returns BSDF times cosine, and the pdf times the lobe's `probability`. `coat_albedo` is that of the incident
    /// direction `wi` (local frame).
    #[inline(always)]
    pub fn eval(&self, wi: Vec3, coat_albedo: f32, probability: f32) -> (Vec3, f32) {
        (self.factor * ((1.0 - coat_albedo) * wi.z), probability * warp::cosine_hemisphere_pdf(wi.z))
    }

    /// Samples an incident direction, local frame.
    pub fn sample(u: Vec2) -> Vec3 {
        warp::cosine_hemisphere(u)
    }
}

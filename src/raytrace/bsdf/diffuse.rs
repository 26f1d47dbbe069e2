//! The diffuse lobe under the coat: Lambertian, scaled by the energy that the coat transmits.

use crate::math::{orthonormal_basis, warp};
use glam::{Vec2, Vec3};

/// The diffuse lobe for one outgoing direction.
#[derive(Clone, Copy, Debug)]
pub struct DiffuseLobe {
    /// BSDF without its factor for the incident direction.
    pub factor: Vec3,
    /// Its own unit normal, local frame; none for +Z.
    pub normal: Option<Vec3>,
}

impl DiffuseLobe {
    /// Returns the cosine of an incident direction (local frame).
    #[inline(always)]
    pub fn cosine(&self, wi: Vec3) -> f32 {
        self.normal.map_or(wi.z, |normal| wi.dot(normal))
    }

    /// Returns BSDF times cosine, and the pdf times the lobe's `probability`, for an incident direction of a positive
    /// `cosine`. `coat_albedo` is that of the incident direction.
    #[inline(always)]
    pub fn eval(&self, cosine: f32, coat_albedo: f32, probability: f32) -> (Vec3, f32) {
        (self.factor * ((1.0 - coat_albedo) * cosine), probability * warp::cosine_hemisphere_pdf(cosine))
    }

    /// Samples an incident direction, local frame.
    #[inline(always)]
    pub fn sample(&self, u: Vec2) -> Vec3 {
        let w = warp::cosine_hemisphere(u);
        self.normal.map_or(w, |normal| {
            let (tangent, bitangent) = orthonormal_basis(normal);
            tangent * w.x + bitangent * w.y + normal * w.z
        })
    }
}

//! The microfacet lobe: GGX reflection by the metal and by the dielectric coat. A delta lobe where the surface is
//! smooth.

use super::material_point::MaterialPoint;
use super::{fresnel, ggx};
use glam::{Vec2, Vec3};

/// The microfacet lobe for one outgoing direction.
#[derive(Clone, Copy, Debug)]
pub struct MicrofacetLobe {
    /// Smith's Lambda of the outgoing direction.
    lambda_o: f32,
    /// Factor of the reflectance.
    factor: f32,
    /// Factor of the metal's reflectance: its part, scaled for light that is reflected between facets (Turquin 2019).
    metal: Vec3,
}

impl MicrofacetLobe {
    /// A lobe that reflects nothing: all of it is masked.
    pub const NONE: Self = MicrofacetLobe { lambda_o: f32::INFINITY, factor: 0.0, metal: Vec3::ZERO };

    /// Returns true if it reflects light.
    pub fn reflects(&self) -> bool {
        self.factor > 0.0
    }

    /// Returns the lobe of a material for an outgoing direction, local frame.
    #[inline(always)]
    pub fn new(material: &MaterialPoint<'_>, wo: Vec3) -> Self {
        let lambda_o = if material.has_microfacets() { ggx::lambda(wo, material.alpha) } else { 0.0 };
        let gloss = material.blurred_gloss;
        let factor = gloss.map_or(1.0, |gloss| gloss.factor(material.coat_albedo(wo.z), wo.z));
        let metal = if material.metallic > 0.0 {
            let missing = 1.0 / material.metal_albedo(wo.z).max(1e-3) - 1.0;
            (Vec3::ONE + material.base_color * missing) * material.metallic
        } else {
            Vec3::ZERO
        };
        MicrofacetLobe { lambda_o, factor, metal }
    }

    /// Returns BSDF times cosine, and the pdf times the lobe's `probability`, of a rough lobe.
    #[inline(always)]
    pub fn eval(&self, material: &MaterialPoint<'_>, wo: Vec3, wi: Vec3, probability: f32) -> (Vec3, f32) {
        let m = (wo + wi).normalize_or(Vec3::Z);
        let cos_half = wo.dot(m).clamp(0.0, 1.0);
        // D / (4 cos_o): times G1(o) it is the density of visible normals, times F G2 the BSDF times cosine
        let shape = ggx::distribution(m, material.alpha) / (4.0 * wo.z);
        let shadowed = shape / (1.0 + self.lambda_o + ggx::lambda(wi, material.alpha));
        let value = self.reflectance(material, cos_half) * (shadowed * self.factor);
        (value, probability * shape / (1.0 + self.lambda_o))
    }

    /// Samples an incident direction of a rough lobe by visible normals, local frame.
    #[inline(always)]
    pub fn sample(material: &MaterialPoint<'_>, wo: Vec3, u: Vec2) -> Vec3 {
        ggx::reflect(wo, ggx::sample_visible_normal(wo, material.alpha, u))
    }

    /// Returns the Fresnel reflectance, mixed from metal and coat.
    #[inline(always)]
    pub fn reflectance(&self, material: &MaterialPoint<'_>, cos_half: f32) -> Vec3 {
        let coat = (1.0 - material.metallic) * fresnel::dielectric(cos_half, material.material.ior);
        Vec3::splat(coat) + fresnel::schlick(material.base_color, cos_half) * self.metal
    }
}

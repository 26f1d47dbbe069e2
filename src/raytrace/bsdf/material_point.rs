//! The parameters of a material at a point: its constants times what its textures give there.

use super::albedo::AlbedoTables;
use super::blurred_gloss::BlurredGloss;
use super::ggx;
use super::material::TracedMaterial;
use crate::color::luminance;
use crate::math::simd::LANES;
use glam::Vec3;
use std::f32::consts::PI;

/// The factors that textures and vertex colours give to a material at a point.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct TextureFactors {
    /// Factor of the base colour.
    pub color: Vec3,
    /// Factor of the roughness. Only materials with mapped roughness use it.
    pub roughness: f32,
    /// Factor of the metal. As the roughness.
    pub metallic: f32,
}

impl TextureFactors {
    /// A point without textures.
    pub const ONE: Self = TextureFactors { color: Vec3::ONE, roughness: 1.0, metallic: 1.0 };
}

impl From<Vec3> for TextureFactors {
    /// A point where only the base colour has a texture.
    fn from(color: Vec3) -> Self {
        TextureFactors { color, ..TextureFactors::ONE }
    }
}

/// The parameters of a material at a point.
#[derive(Clone, Copy, Debug)]
pub struct MaterialPoint<'a> {
    /// The material.
    pub material: &'a TracedMaterial,
    /// Of the material, times its texture.
    pub base_color: Vec3,
    /// Metallic part of the opaque lobes.
    pub metallic: f32,
    /// GGX roughness: the square of the user's roughness, or that of a blurred gloss.
    pub alpha: f32,
    /// The blurred gloss, if it is rougher than the material's own, of which the albedos below are.
    pub blurred_gloss: Option<&'a BlurredGloss>,
    /// Weight of the dielectric lobe.
    pub transmission: f32,
    /// Directional albedos at the roughness below.
    lower: &'a AlbedoTables,
    /// Directional albedos at the roughness above, and how near to it the point is, 0 to 1.
    upper: Option<(&'a AlbedoTables, f32)>,
}

impl<'a> MaterialPoint<'a> {
    /// Returns the parameters where textures give these factors.
    pub fn new(material: &'a TracedMaterial, factors: TextureFactors) -> Self {
        let base_color = material.base_color * factors.color;
        let Some(mapped) = &material.mapped_gloss else {
            let TracedMaterial { metallic, transmission, .. } = *material;
            let (alpha, blurred_gloss) = blurred(material, material.alpha);
            let (lower, upper) = (&material.tables, None);
            return MaterialPoint { material, base_color, metallic, alpha, blurred_gloss, transmission, lower, upper };
        };
        let roughness = (mapped.roughness * factors.roughness).clamp(0.0, 1.0);
        let (transmission, metallic) =
            TracedMaterial::divide(mapped.transmission, (mapped.metallic * factors.metallic).clamp(0.0, 1.0));
        let (lower, upper, fraction) = mapped.tables.around(roughness);
        // Never a delta lobe: whether light sampling applies must not change from point to point
        let (alpha, blurred_gloss) = blurred(material, (roughness * roughness).max(ggx::MIN_ALPHA));
        let upper = Some((upper, fraction));
        MaterialPoint { material, base_color, metallic, alpha, blurred_gloss, transmission, lower, upper }
    }

    /// Returns true if the point has a metal or a coat.
    #[inline]
    pub fn has_microfacets(&self) -> bool {
        self.material.has_microfacets
    }

    /// Returns true if the point has a microfacet lobe that is not a delta function.
    pub fn has_rough_microfacets(&self) -> bool {
        self.has_microfacets() && !self.is_smooth()
    }

    /// Returns true if the microfacet lobe is a delta function.
    pub fn is_smooth(&self) -> bool {
        self.alpha < ggx::MIN_ALPHA
    }

    /// Returns true if the BSDF has a lobe that is not a delta function, apart from frosting: see
    /// [`TracedMaterial::has_non_specular_lobe`].
    pub fn has_non_specular_lobe(&self) -> bool {
        let has_diffuse = self.metallic < 1.0 && self.material.base_color.max_element() > 0.0;
        self.transmission < 1.0 && (has_diffuse || !self.is_smooth())
    }

    /// Returns the factor on light that is transmitted at a surface, besides Fresnel's equations: the weight of the
    /// dielectric lobe times [`transmission_tint`](super::transmission_tint::transmission_tint).
    pub fn transmission_color(&self, is_thin: bool) -> Vec3 {
        super::transmission_tint::transmission_tint(self.base_color, is_thin) * self.transmission
    }

    /// Returns the directional albedo of the coat.
    #[inline]
    pub(super) fn coat_albedo(&self, cos: f32) -> f32 {
        if self.has_microfacets() { self.blend(|tables| tables.coat.at(cos)) } else { 0.0 }
    }

    /// Returns the directional albedo of the coat for a cosine a lane.
    #[inline(always)]
    pub(super) fn coat_albedo_lanes(&self, cosines: &[f32; LANES]) -> [f32; LANES] {
        if !self.has_microfacets() {
            return [0.0; LANES];
        }
        let lower = self.lower.coat.at_lanes(cosines);
        self.upper.map_or(lower, |(upper, fraction)| {
            let upper = upper.coat.at_lanes(cosines);
            std::array::from_fn(|i| lower[i] + (upper[i] - lower[i]) * fraction)
        })
    }

    /// Returns the directional albedo of the metal for a reflectance of 1.
    #[inline]
    pub(super) fn metal_albedo(&self, cos: f32) -> f32 {
        self.blend(|tables| tables.perfect_reflector.at(cos))
    }

    /// Returns the probability of sampling the microfacet lobe rather than the diffuse one: its part of the albedo.
    pub(super) fn microfacet_probability(&self, coat_albedo: f32) -> f32 {
        let color = luminance(self.base_color);
        let microfacet = (1.0 - self.metallic) * coat_albedo + self.metallic * color.max(0.04);
        let diffuse = (1.0 - self.metallic) * (1.0 - coat_albedo) * color;
        if diffuse <= 0.0 { 1.0 } else { microfacet / (microfacet + diffuse) }
    }

    /// Returns the diffuse BSDF of a base colour without its factor for the incident direction (Kelemen and
    /// Szirmay-Kalos 2001).
    pub(super) fn diffuse_factor(&self, base_color: Vec3, coat_albedo: f32) -> Vec3 {
        let mean = self.blend(|tables| tables.coat.mean);
        base_color * ((1.0 - self.metallic) * (1.0 - coat_albedo) / (PI * (1.0 - mean).max(1e-4)))
    }

    #[inline]
    fn blend(&self, value: impl Fn(&AlbedoTables) -> f32) -> f32 {
        let lower = value(self.lower);
        match self.upper {
            Some((upper, fraction)) => lower + (value(upper) - lower) * fraction,
            None => lower,
        }
    }
}

/// Returns the GGX roughness of a material's gloss where its own is `alpha`, and the blurred gloss if it is rougher.
fn blurred(material: &TracedMaterial, alpha: f32) -> (f32, Option<&BlurredGloss>) {
    match &material.blurred_gloss {
        Some(gloss) if gloss.alpha > alpha => (gloss.alpha, Some(gloss)),
        _ => (alpha, None),
    }
}

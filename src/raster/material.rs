//! Materials for shading: Lambert's diffuse lobe and the normalized Blinn-Phong specular lobe.

use super::gbuffer_row::{PADDED_WIDTH, RowScalar, RowVec3, WIDTH, splat};
use super::surface_texture::PixelFactors;
use crate::math::approx::{self, max, min};
use crate::scene::Material;
use glam::Vec3;
use std::f32::consts::PI;
use std::ops::Range;

/// Diffuse fraction of a transmissive surface, so that glass stays visible.
const GLASS_DIFFUSE: f32 = 0.15;

/// Reflectance of lacquer at normal incidence.
const LACQUER_F0: f32 = 0.04;

/// A material with the factors of its lobes.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct ShadingMaterial {
    /// BRDF of the diffuse lobe, 1/sr.
    diffuse: Vec3,
    /// Reflectance at normal incidence.
    f0: Vec3,
    /// Exponent of the specular lobe.
    exponent: f32,
    /// Normalization of the specular lobe.
    normalization: f32,
    /// Emitted radiance, picture units.
    emission: Vec3,
}

impl ShadingMaterial {
    /// Converts a material where textures give these factors; `emission_scale` is the picture value of 1 cd/m2.
    pub fn new(material: &Material, factors: &PixelFactors, emission_scale: f32) -> Self {
        let plain = material.plain_base();
        let base = Vec3::from(plain.base_color) * factors.color;
        let (metallic, mut roughness) = (material.metallic * factors.metallic, plain.roughness * factors.roughness);
        let mut dielectric = ((material.ior - 1.0) / (material.ior + 1.0)).powi(2);
        // Lacquer over plastic and paint takes the place of their highlight; that of metal stays
        if let Some(coat) = material.clearcoat.filter(|_| metallic < 0.5) {
            roughness += (coat.roughness - roughness) * coat.amount;
            dielectric += LACQUER_F0 * coat.amount * (1.0 - dielectric);
        }
        // Exponent of a lobe as wide as GGX of this roughness: 2 / alpha2 - 2. Mirrors are blurred to what a pixel can
        // still show.
        let alpha2 = roughness.max(0.1).powi(4);
        let exponent = (2.0 / alpha2 - 2.0).max(0.0);
        let far_side = if material.is_translucent() { material.translucency } else { 0.0 };
        let opaque = (1.0 - material.transmission * (1.0 - GLASS_DIFFUSE)) * (1.0 - far_side);
        let diffuse = (1.0 - metallic) * opaque * (1.0 - dielectric);
        ShadingMaterial {
            diffuse: base * (diffuse / PI),
            f0: Vec3::splat(dielectric).lerp(base, metallic),
            exponent,
            // Akenine-Moller, Real-Time Rendering, section 9.8: (n + 8) / 8 pi.
            normalization: (exponent + 8.0) / (8.0 * PI),
            emission: Vec3::from(material.emission_cd_m2) * factors.emission * emission_scale,
        }
    }
}

/// The materials of a row's pixels.
#[derive(Debug)]
pub(super) struct RowMaterials {
    pub diffuse: RowVec3,
    pub f0: RowVec3,
    exponent: RowScalar,
    normalization: RowScalar,
    pub emission: RowVec3,
}

/// Unit directions and cosines of a row's shading points and of the light from one source.
#[derive(Clone, Copy, Debug)]
pub(super) struct SpecularGeometry<'a> {
    pub view_dir: &'a RowVec3,
    pub light_dir: &'a RowVec3,
    pub n_dot_v: &'a RowScalar,
    pub n_dot_l: &'a RowScalar,
}

impl RowMaterials {
    pub const ZERO: Self = RowMaterials {
        diffuse: RowVec3::ZERO,
        f0: RowVec3::ZERO,
        exponent: [0.0; PADDED_WIDTH],
        normalization: [0.0; PADDED_WIDTH],
        emission: RowVec3::ZERO,
    };

    #[inline(always)]
    pub fn set(&mut self, pixels: &Range<usize>, material: &ShadingMaterial) {
        self.diffuse.splat(pixels, material.diffuse);
        self.f0.splat(pixels, material.f0);
        self.emission.splat(pixels, material.emission);
        splat(&mut self.exponent, pixels, material.exponent);
        splat(&mut self.normalization, pixels, material.normalization);
    }

    /// Adds the Blinn-Phong lobe with Schlick's Fresnel term, for light of this strength of which each point receives
    /// the part `received`. Three short loops: the CPU overlaps more iterations of short loops.
    #[inline(always)]
    pub fn add_specular(
        &self,
        strength: Vec3,
        received: &RowScalar,
        geometry: SpecularGeometry<'_>,
        specular: &mut RowVec3,
    ) {
        let (mut n_dot_h_squared, mut one_minus_l_dot_h) = ([0.0; PADDED_WIDTH], [0.0; PADDED_WIDTH]);
        for i in 0..WIDTH {
            // For unit vectors |l + v|2 = 2 + 2 l.v, which gives the half vector's cosines without the vector itself
            let squared = 2.0 * max(1.0 + geometry.light_dir.at(i).dot(geometry.view_dir.at(i)), 1e-12);
            let cos = max(geometry.n_dot_l[i] + geometry.n_dot_v[i], 0.0);
            n_dot_h_squared[i] = min(max(cos * cos / squared, f32::MIN_POSITIVE), 1.0);
            one_minus_l_dot_h[i] = max(1.0 - 0.5 * squared.sqrt(), 0.0);
        }
        let mut lobe = [0.0; PADDED_WIDTH];
        for i in 0..WIDTH {
            lobe[i] = received[i] * self.normalization[i] * approx::pow(n_dot_h_squared[i], 0.5 * self.exponent[i]);
        }
        for i in 0..WIDTH {
            let squared = one_minus_l_dot_h[i] * one_minus_l_dot_h[i];
            let fifth = squared * squared * one_minus_l_dot_h[i];
            let f0 = self.f0.at(i);
            let reflected = (f0 + (Vec3::ONE - f0) * fifth) * lobe[i];
            specular.set(i, specular.at(i) + strength * reflected);
        }
    }
}

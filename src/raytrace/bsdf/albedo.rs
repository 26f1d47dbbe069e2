//! Directional albedo of the microfacet lobes, tabulated once a material. Coat and diffuse base share the energy by it.

use super::{fresnel, ggx};
use glam::{Vec2, Vec3};

/// Number of table entries, uniform over the square root of the cosine: denser at grazing angles, where the reflectance
/// rises.
const ENTRIES: usize = 48;
/// Edge of the grid of facet normals that are integrated for an entry.
const GRID: u32 = 16;

/// The directional albedo of a lobe by cosine, and its cosine-weighted mean.
#[derive(Clone, Debug)]
pub struct AlbedoTable {
    entries: [f32; ENTRIES],
    /// Mean albedo: the integral of 2 E(mu) mu dmu.
    pub mean: f32,
}

impl AlbedoTable {
    /// Tabulates a dielectric coat of this index of refraction.
    pub fn dielectric(ior: f32, alpha: f32) -> Self {
        AlbedoTable::tabulate(alpha, |cos| fresnel::dielectric(cos, ior))
    }

    /// Tabulates a rough surface of reflectance 1, with single scattering.
    pub fn perfect_reflector(alpha: f32) -> Self {
        AlbedoTable::tabulate(alpha, |_| 1.0)
    }

    fn tabulate(alpha: f32, reflectance: impl Fn(f32) -> f32) -> Self {
        // Integrate the directional albedo of each entry
        let entries = std::array::from_fn(|i| {
            let root = i as f32 / (ENTRIES - 1) as f32;
            directional_albedo((root * root).max(1e-4), alpha, &reflectance)
        });
        let mut table = AlbedoTable { entries, mean: 0.0 };
        // Integrate the mean by the midpoint rule
        let steps = 512;
        let sum: f32 = (0..steps).map(|i| (i as f32 + 0.5) / steps as f32).map(|mu| 2.0 * mu * table.at(mu)).sum();
        table.mean = sum / steps as f32;
        table
    }

    /// Returns the albedo for a cosine, interpolated linearly.
    pub fn at(&self, cos: f32) -> f32 {
        let x = cos.clamp(0.0, 1.0).sqrt() * (ENTRIES - 1) as f32;
        let i = (x as usize).min(ENTRIES - 2);
        let fraction = x - i as f32;
        self.entries[i] + (self.entries[i + 1] - self.entries[i]) * fraction
    }
}

/// Integrates the lobe times cosine by sampling visible normals: the mean of F G2 / G1 (Heitz 2018, equation 19).
fn directional_albedo(cos: f32, alpha: f32, reflectance: &impl Fn(f32) -> f32) -> f32 {
    if alpha < ggx::MIN_ALPHA {
        return reflectance(cos);
    }
    let wo = Vec3::new((1.0 - cos * cos).max(0.0).sqrt(), 0.0, cos);
    let mut sum = 0.0;
    for i in 0..GRID * GRID {
        let u = Vec2::new((i % GRID) as f32 + 0.5, (i / GRID) as f32 + 0.5) / GRID as f32;
        let m = ggx::sample_visible_normal(wo, alpha, u);
        let wi = ggx::reflect(wo, m);
        if wi.z > 0.0 {
            let shadowing = ggx::masking_shadowing(wo, wi, alpha) / ggx::masking(wo, alpha);
            sum += reflectance(wo.dot(m)) * shadowing;
        }
    }
    sum / (GRID * GRID) as f32
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_smooth_reflector_has_albedo_one_and_a_rough_one_less() {
        assert!((AlbedoTable::perfect_reflector(0.0).mean - 1.0).abs() < 1e-4);
        let rough = AlbedoTable::perfect_reflector(1.0);
        // Published single-scattering albedo of GGX at alpha 1: about 0.5 on average.
        assert!(rough.mean > 0.4 && rough.mean < 0.65, "{}", rough.mean);
        assert!(rough.at(1.0) <= 1.0);
    }

    #[test]
    fn smooth_glass_reflects_nine_percent_of_diffuse_light() {
        // Diffuse Fresnel reflectance of n = 1.5: 0.092 (Walsh's closed form).
        assert!((AlbedoTable::dielectric(1.5, 0.0).mean - 0.0918).abs() < 1e-3);
    }
}

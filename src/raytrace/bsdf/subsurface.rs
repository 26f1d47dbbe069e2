//! The two ends of a walk under the surface: the BSDF where the path arrives, and that where the walk comes out.
//!
//! Together they are the BSSRDF (1 - E(o)) R (1 - E(i)) / (pi (1 - mean E)), with the directional albedo E of the coat
//! and the walk's weight R, in place of the diffuse lobe of that form, whose R is the base colour.

use super::diffuse::DiffuseLobe;
use super::lobe::{Lobe, LobeProbabilities};
use super::material::TracedMaterial;
use super::microfacet::MicrofacetLobe;
use super::surface::SurfaceBsdf;
use glam::Vec3;

impl<'a> SurfaceBsdf<'a> {
    /// Returns the same BSDF with scattering under the surface in place of the diffuse lobe.
    pub fn with_subsurface(self) -> Self {
        let probabilities = LobeProbabilities { base: Lobe::Subsurface, ..self.probabilities };
        SurfaceBsdf { diffuse: DiffuseLobe { factor: Vec3::ZERO }, probabilities, ..self }
    }

    /// Returns true if this lobe number samples scattering under the surface; [`SurfaceBsdf::sample`] returns none for it.
    pub fn samples_subsurface(&self, u_lobe: f32) -> bool {
        self.probabilities.sample(u_lobe).0 == Lobe::Subsurface
    }

    /// Returns the part of the light that the coat transmits towards the outgoing direction, over the probability of
    /// sampling a walk.
    pub fn entry_weight(&self) -> f32 {
        let probability = (1.0 - self.probabilities.dielectric) * (1.0 - self.probabilities.microfacet);
        (1.0 - self.material.coat_albedo(self.geometry.wo.z)) / probability.max(f32::MIN_POSITIVE)
    }

    /// Returns the base colour: of the material, times its texture.
    pub fn base_color(&self) -> Vec3 {
        self.base_color
    }

    /// Returns the BSDF where a walk comes out: a diffuse lobe under the coat, for any outgoing direction.
    pub fn at_exit(material: &'a TracedMaterial, normal: Vec3, geometric_normal: Vec3) -> Self {
        let bsdf = SurfaceBsdf::new(material, Vec3::ONE, normal, geometric_normal, normal);
        SurfaceBsdf {
            probabilities: LobeProbabilities { dielectric: 0.0, microfacet: 0.0, base: Lobe::Diffuse },
            microfacet: MicrofacetLobe::NONE,
            diffuse: DiffuseLobe { factor: material.diffuse_factor(Vec3::ONE, 0.0) },
            ..bsdf
        }
    }
}

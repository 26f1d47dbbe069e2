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
    /// Puts scattering under the surface in the place of the diffuse lobe.
    pub fn set_subsurface(&mut self) {
        (self.probabilities.base, self.diffuse.factor) = (Lobe::Subsurface, Vec3::ZERO);
    }

    /// Returns true if some lobe number samples scattering under the surface.
    pub fn samples_walks(&self) -> bool {
        self.probabilities.base == Lobe::Subsurface && self.walk_probability() > 0.0
    }

    /// Returns true if this lobe number samples scattering under the surface; [`SurfaceBsdf::sample`] returns none for it.
    pub fn samples_walk(&self, u_lobe: f32) -> bool {
        self.probabilities.sample(u_lobe).0 == Lobe::Subsurface
    }

    /// Returns the probability with which a lobe number samples scattering under the surface.
    pub fn walk_probability(&self) -> f32 {
        (1.0 - self.probabilities.dielectric) * (1.0 - self.probabilities.microfacet)
    }

    /// Returns the part of the light that the coat transmits towards the outgoing direction.
    pub fn coat_transmission(&self) -> f32 {
        1.0 - self.point.coat_albedo(self.geometry.wo.z)
    }

    /// Returns the base colour: of the material, times its texture.
    pub fn base_color(&self) -> Vec3 {
        self.point.base_color
    }

    /// Returns the BSDF where a walk comes out: a diffuse lobe under the coat, for any outgoing direction.
    pub fn at_exit(material: &'a TracedMaterial, normal: Vec3, geometric_normal: Vec3) -> Self {
        let bsdf = SurfaceBsdf::new(material, Vec3::ONE, normal, geometric_normal, normal);
        let factor = bsdf.point.diffuse_factor(Vec3::ONE, 0.0);
        bsdf.with_diffuse_lobe_alone(factor)
    }

    /// Returns the BSDF of a diffuse lobe under the coat, with a base colour that may be negative, at the same point.
    pub fn with_diffuse_base(self, base_color: Vec3) -> Self {
        self.with_diffuse_lobe_alone(self.point.diffuse_factor(base_color, 1.0 - self.coat_transmission()))
    }

    fn with_diffuse_lobe_alone(self, factor: Vec3) -> Self {
        SurfaceBsdf {
            probabilities: LobeProbabilities { dielectric: 0.0, microfacet: 0.0, base: Lobe::Diffuse },
            microfacet: MicrofacetLobe::NONE,
            diffuse: DiffuseLobe { factor, ..self.diffuse },
            ..self
        }
    }
}

//! The BSDF of surfaces: a mix of metal, coated diffuse base and clear glass. Its head in [`super`] names the sources.
//! `surface_lanes.rs` evaluates and samples it for several directions at once.

use super::dielectric::{Boundary, DielectricInterface, DielectricLobe};
use super::diffuse::DiffuseLobe;
use super::lobe::{Lobe, LobeProbabilities};
use super::material::TracedMaterial;
use super::material_point::{MaterialPoint, TextureFactors};
use super::microfacet::MicrofacetLobe;
use super::polarisation::Polarisation;
use super::sample::BsdfSample;
use super::shading_geometry::ShadingGeometry;
use glam::{Vec2, Vec3};

/// The BSDF at a point of a surface for one outgoing direction.
#[derive(Clone, Copy, Debug)]
pub struct SurfaceBsdf<'a> {
    pub(super) point: MaterialPoint<'a>,
    pub(super) geometry: ShadingGeometry,
    pub(super) probabilities: LobeProbabilities,
    pub(super) dielectric: DielectricLobe,
    pub(super) microfacet: MicrofacetLobe,
    pub(super) diffuse: DiffuseLobe,
}

impl<'a> SurfaceBsdf<'a> {
    /// Returns the BSDF for the outgoing direction `wo` (unit, world space), outward normals and texture values. A
    /// clear material is a body in air; its boundary is set for others.
    #[inline(always)]
    pub fn new(
        material: &'a TracedMaterial,
        textures: impl Into<TextureFactors>,
        normal: Vec3,
        geometric_normal: Vec3,
        wo: Vec3,
    ) -> Self {
        let is_outside = wo.dot(geometric_normal) >= 0.0;
        let geometry = ShadingGeometry::new(normal, geometric_normal, wo);
        let point = MaterialPoint::new(material, textures.into());
        let base_color = point.base_color;
        let eta = if is_outside { material.ior } else { 1.0 / material.ior };
        let boundary = Boundary::Interface(DielectricInterface { eta, starts_inside: false });
        let coat_albedo = point.coat_albedo(geometry.wo.z);
        SurfaceBsdf {
            point,
            geometry,
            probabilities: LobeProbabilities {
                dielectric: point.transmission,
                microfacet: point.microfacet_probability(coat_albedo),
                base: Lobe::Diffuse,
            },
            dielectric: DielectricLobe { ior: material.ior, base_color, boundary, polarisation: Polarisation::NONE },
            microfacet: MicrofacetLobe::new(&point, geometry.wo),
            diffuse: DiffuseLobe { factor: point.diffuse_factor(base_color, coat_albedo), normal: None },
        }
    }

    /// Gives the diffuse lobe an outward normal of its own, world space.
    pub fn set_relief(&mut self, normal: Vec3) {
        self.diffuse.normal = Some(self.geometry.to_local(normal * self.geometry.side()));
    }

    /// Returns true if the diffuse lobe has a normal of its own.
    pub fn has_relief(&self) -> bool {
        self.diffuse.normal.is_some()
    }

    /// Returns true if a direction, in the local frame and in world space, is above the surface of a lobe.
    #[inline(always)]
    pub(super) fn is_in_front(&self, wi: Vec3, direction: Vec3) -> bool {
        let is_above_lobe = (wi.z > 0.0) | (self.has_relief() & (self.diffuse.cosine(wi) > 0.0));
        is_above_lobe & self.geometry.is_above(direction)
    }

    /// Returns the shading normal on the side of the outgoing direction.
    pub fn normal(&self) -> Vec3 {
        self.geometry.normal
    }

    /// Returns the Fresnel reflectance of clear glass, which is the probability that [`SurfaceBsdf::sample`] samples
    /// reflection: for lobe numbers below it. Returns none for materials with other lobes.
    pub fn dielectric_reflectance(&self) -> Option<f32> {
        (self.point.transmission >= 1.0).then(|| self.dielectric.reflectance(&self.geometry))
    }

    /// Returns true if it has a lobe that is not a delta function.
    pub fn has_non_specular_lobe(&self) -> bool {
        self.point.has_non_specular_lobe()
    }

    /// Returns the diffuse reflectance of a plain matte base under its coat, towards the outgoing direction.
    pub fn matte_factor(&self) -> Option<Vec3> {
        let MaterialPoint { material, metallic, transmission, base_color, .. } = self.point;
        let is_plain =
            self.probabilities.base == Lobe::Diffuse && !self.has_relief() && material.mapped_gloss.is_none();
        (is_plain && metallic < 1.0 && transmission <= 0.0).then(|| base_color * self.coat_transmission())
    }

    /// Removes the diffuse lobe. Returns true if there is a coat or metal left.
    pub fn remove_matte_base(&mut self) -> bool {
        self.diffuse.factor = Vec3::ZERO;
        self.probabilities.microfacet = 1.0;
        self.point.has_microfacets()
    }

    /// Returns BSDF times cosine, and the density of [`SurfaceBsdf::sample`] (1/sr), for a unit world direction. Delta lobes
    /// are left out of both.
    pub fn eval(&self, direction: Vec3) -> (Vec3, f32) {
        let wi = self.geometry.to_local(direction);
        if !self.is_in_front(wi, direction) || self.point.transmission >= 1.0 {
            return (Vec3::ZERO, 0.0);
        }
        self.eval_local(wi)
    }

    /// Sums the non-specular lobes for a direction in the local frame.
    fn eval_local(&self, wi: Vec3) -> (Vec3, f32) {
        let mut sum = self.eval_diffuse(wi, self.point.coat_albedo(self.diffuse.cosine(wi)));
        if self.has_gloss() {
            let gloss = self.eval_gloss(wi);
            sum = (sum.0 + gloss.0, sum.1 + gloss.1);
        }
        let opaque = 1.0 - self.point.transmission;
        (sum.0 * opaque, sum.1 * opaque)
    }

    /// Returns BSDF times cosine and pdf times probability of the diffuse lobe, from the coat's albedo for the direction.
    #[inline(always)]
    pub(super) fn eval_diffuse(&self, wi: Vec3, coat_albedo: f32) -> (Vec3, f32) {
        let cosine = self.diffuse.cosine(wi);
        let (value, pdf) = self.diffuse.eval(cosine, coat_albedo, self.probabilities.opaque(Lobe::Diffuse));
        if cosine > 0.0 { (value, pdf) } else { (Vec3::ZERO, 0.0) }
    }

    /// Returns true if it has a microfacet lobe that is not a delta function.
    pub(super) fn has_gloss(&self) -> bool {
        self.point.has_rough_microfacets() && self.microfacet.reflects()
    }

    /// Returns BSDF times cosine and pdf times probability of the microfacet lobe, which is rough.
    #[inline(always)]
    pub(super) fn eval_gloss(&self, wi: Vec3) -> (Vec3, f32) {
        let probability = self.probabilities.opaque(Lobe::Microfacet);
        let (value, pdf) = self.microfacet.eval(&self.point, self.geometry.wo, wi, probability);
        if wi.z > 0.0 { (value, pdf) } else { (Vec3::ZERO, 0.0) }
    }

    /// Samples a direction for a lobe number in 0..1 and a point of the unit square. Returns none for samples without
    /// contribution.
    pub fn sample(&self, u_lobe: f32, u: Vec2) -> Option<BsdfSample> {
        // Sample a lobe, and a direction from it
        let (lobe, u_lobe) = self.probabilities.sample(u_lobe);
        let wi = match lobe {
            Lobe::Dielectric => return self.dielectric.sample(&self.geometry, u_lobe),
            Lobe::Microfacet if self.point.is_smooth() => return self.sample_smooth_microfacet(),
            Lobe::Microfacet => MicrofacetLobe::sample(&self.point, self.geometry.wo, u),
            Lobe::Diffuse => self.diffuse.sample(u),
            Lobe::Subsurface => return None,
        };
        // Discard directions below the surface
        let direction = self.geometry.to_world(wi);
        if !self.is_in_front(wi, direction) {
            return None;
        }
        // Evaluate all lobes in that direction
        let (value, pdf) = self.eval_local(wi);
        (pdf > 0.0).then(|| BsdfSample::non_specular(direction, value / pdf, pdf))
    }

    /// Samples the microfacet lobe of a smooth surface: specular reflection.
    fn sample_smooth_microfacet(&self) -> Option<BsdfSample> {
        let wo = self.geometry.wo;
        let reflectance = self.microfacet.reflectance(&self.point, wo.z);
        let weight = reflectance / self.probabilities.microfacet;
        Some(BsdfSample { weight, ..BsdfSample::specular(self.geometry.specular_reflection()?) })
    }
}

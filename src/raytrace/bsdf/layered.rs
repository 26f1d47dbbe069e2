//! The BSDF of a surface with layers: lacquer, sheen, a brushed or plain base, light to the far side, frosted glass.
//!
//! From the top: lacquer reflects its directional albedo C, sheen S of what is left, metal and coat B of what is left
//! under both; the diffuse base gets the rest. With the transmission `T(w) = (1 - C)(1 - S)(1 - B)` of a direction, the
//! diffuse base is scaled by `T(o) T(i) / mean T` (Kelemen and Szirmay-Kalos 2001), and what lies over it by the smaller
//! of the transmissions of both directions. Every factor is the same for exchanged directions, except the compensation
//! for light between the facets of metal and of frosted glass, which depends on the outgoing direction. No surface
//! reflects more than arrives: a white diffuse base reflects all light whatever lies on it, while metal under rough
//! lacquer loses a few percent between both.
//!
//! Of a translucent sheet, a part of the diffuse light leaves by the same law on the far side.

use super::dielectric::{Boundary, DielectricInterface, DielectricLobe};
use super::facets::Facets;
use super::frost::radiance_scale;
use super::layers::SurfaceLayers;
use super::material::TracedMaterial;
use super::material_point::{MaterialPoint, TextureFactors};
use super::polarisation::Polarisation;
use super::sample::BsdfSample;
use super::shading_geometry::ShadingGeometry;
use super::{fresnel, ggx};
use crate::color::luminance;
use crate::math::warp;
use crate::scene::Clearcoat;
use glam::{Vec2, Vec3};
use std::f32::consts::PI;

/// The BSDF at a point of a surface with layers for one outgoing direction.
#[derive(Clone, Copy, Debug)]
pub struct LayeredBsdf<'a> {
    point: MaterialPoint<'a>,
    layers: &'a SurfaceLayers,
    geometry: ShadingGeometry,
    dielectric: DielectricLobe,
    facets: Facets,
    /// Transmission towards the outgoing direction: of the lacquer, of the sheen, of metal and coat.
    past: [f32; 3],
    /// Compensation for light between facets of the metal.
    metal_scale: Vec3,
    probabilities: LayerProbabilities,
}

/// The probabilities with which the opaque lobes are sampled; they sum to 1.
#[derive(Clone, Copy, Debug)]
struct LayerProbabilities {
    clearcoat: f32,
    sheen: f32,
    facets: f32,
    diffuse: f32,
    transmitted: f32,
}

impl<'a> LayeredBsdf<'a> {
    /// Returns the BSDF for the outgoing direction `wo` (unit, world space), outward normals and texture values. The
    /// frame's X axis is arbitrary: see [`LayeredBsdf::set_tangent`].
    pub fn new(
        (material, layers): (&'a TracedMaterial, &'a SurfaceLayers),
        textures: TextureFactors,
        normal: Vec3,
        geometric_normal: Vec3,
        wo: Vec3,
    ) -> Self {
        let is_outside = wo.dot(geometric_normal) >= 0.0;
        let point = MaterialPoint::new(material, textures);
        let eta = if is_outside { material.ior } else { 1.0 / material.ior };
        let boundary = Boundary::Interface(DielectricInterface { eta, starts_inside: false });
        let alphas = layers.brushing.as_ref().map_or([point.alpha; 2], |b| b.anisotropy.alphas(point.alpha));
        let dielectric = DielectricLobe {
            ior: material.ior,
            base_color: point.base_color,
            boundary,
            polarisation: Polarisation::NONE,
        };
        LayeredBsdf {
            point,
            layers,
            geometry: ShadingGeometry::new(normal, geometric_normal, wo),
            dielectric,
            facets: Facets::new(alphas),
            past: [1.0; 3],
            metal_scale: Vec3::ONE,
            probabilities: LayerProbabilities {
                clearcoat: 0.0,
                sheen: 0.0,
                facets: 0.0,
                diffuse: 1.0,
                transmitted: 0.0,
            },
        }
        .prepared()
    }

    /// Lays the brushing across `tangent`, world space.
    pub fn set_tangent(&mut self, tangent: Vec3) {
        *self = LayeredBsdf { geometry: self.geometry.with_tangent(tangent), ..*self }.prepared();
    }

    /// Returns the dielectric lobe.
    pub fn dielectric_mut(&mut self) -> &mut DielectricLobe {
        &mut self.dielectric
    }

    /// Computes what depends on the outgoing direction alone.
    fn prepared(mut self) -> Self {
        let wo = self.geometry.wo;
        self.past = self.past(wo);
        let [clearcoat, sheen, base] = self.past;
        let color = luminance(self.point.base_color);
        let metallic = self.point.metallic;
        if metallic > 0.0 {
            let albedo = match self.layers.brushed_albedos() {
                Some(albedos) => albedos.metal.at(wo),
                None => self.point.metal_albedo(wo.z),
            };
            self.metal_scale = Vec3::ONE + self.point.base_color * (1.0 / albedo.max(1e-3) - 1.0);
        }
        // Sample each lobe by its part of the albedo
        let (under, facets) = (clearcoat * sheen, (1.0 - metallic) * (1.0 - base) + metallic * color.max(0.04));
        let diffuse = under * (1.0 - metallic) * base * color;
        let parts = [1.0 - clearcoat, clearcoat * (1.0 - sheen), under * facets, diffuse];
        let sum: f32 = parts.iter().sum();
        let [clearcoat, sheen, facets, diffuse] =
            if sum > 0.0 { parts.map(|part| part / sum) } else { [0.0, 0.0, 0.0, 1.0] };
        let translucency = self.layers.translucency;
        self.probabilities = LayerProbabilities {
            clearcoat,
            sheen,
            facets,
            diffuse: diffuse * (1.0 - translucency),
            transmitted: diffuse * translucency,
        };
        self
    }

    /// Returns what lacquer, sheen, and metal and coat let through towards a direction of either side.
    fn past(&self, w: Vec3) -> [f32; 3] {
        let coat = match self.layers.brushed_albedos() {
            Some(albedos) => albedos.coat.at(w),
            None => self.point.coat_albedo(w.z.abs()),
        };
        [self.layers.past_clearcoat(w), self.layers.past_sheen(w), 1.0 - coat]
    }

    /// Returns the shading normal on the side of the outgoing direction.
    pub fn normal(&self) -> Vec3 {
        self.geometry.normal
    }

    /// Returns true if light from the far side is scattered, too, other than by a delta lobe.
    pub fn is_two_sided(&self) -> bool {
        self.layers.translucency > 0.0 || self.layers.frost.is_some()
    }

    /// Returns true if it has a lobe that is not a delta function.
    pub fn has_non_specular_lobe(&self) -> bool {
        self.layers.frost.is_some() || self.point.has_non_specular_lobe()
    }

    /// Returns true if light from a direction reaches the path through the face of a body of frosted glass.
    pub fn enters_body(&self, direction: Vec3) -> bool {
        let is_body = matches!(self.dielectric.boundary, Boundary::Interface(_));
        is_body && self.layers.frost.is_some() && !self.geometry.is_above(direction)
    }

    /// Returns BSDF times cosine, and the density of [`LayeredBsdf::sample`] (1/sr), for a unit world direction. Delta
    /// lobes are left out of both.
    pub fn eval(&self, direction: Vec3) -> (Vec3, f32) {
        let wi = self.geometry.to_local(direction);
        // Both normals agree on the side
        if wi.z == 0.0 || (wi.z > 0.0) != self.geometry.is_above(direction) {
            return (Vec3::ZERO, 0.0);
        }
        self.eval_local(wi)
    }

    /// Sums the non-specular lobes for a direction in the local frame.
    fn eval_local(&self, wi: Vec3) -> (Vec3, f32) {
        let transmission = self.point.transmission;
        let (mut value, mut pdf) = (Vec3::ZERO, 0.0);
        if transmission < 1.0 {
            let (opaque, opaque_pdf) = if wi.z > 0.0 { self.eval_reflection(wi) } else { self.eval_far_side(wi) };
            (value, pdf) = (opaque * (1.0 - transmission), opaque_pdf * (1.0 - transmission));
        }
        if let Some(frost) = self.layers.frost.as_ref().filter(|_| transmission > 0.0) {
            let (clear, clear_pdf) = frost.eval(&self.dielectric, self.geometry.wo, wi);
            value += clear * transmission;
            pdf += clear_pdf * transmission;
        }
        (value, pdf)
    }

    /// Evaluates the opaque lobes above the surface.
    fn eval_reflection(&self, wi: Vec3) -> (Vec3, f32) {
        let (wo, probabilities) = (self.geometry.wo, self.probabilities);
        let (past_o, past_i) = (self.past, self.past(wi));
        let past_clearcoat = past_o[0].min(past_i[0]);
        let m = (wo + wi).normalize_or(Vec3::Z);
        let cos_half = wo.dot(m).clamp(0.0, 1.0);
        let (mut value, mut pdf) = (Vec3::ZERO, 0.0);

        // Lacquer
        if let Some(coat) = &self.layers.clearcoat {
            let (shape, lobe_pdf) = coat.facets.eval_reflection(wo, wi, m, 1.0);
            value += Vec3::splat(coat.amount * fresnel::dielectric(cos_half, Clearcoat::IOR) * shape);
            pdf += probabilities.clearcoat * lobe_pdf;
        }
        // Sheen
        if let Some(sheen) = &self.layers.sheen {
            value += sheen.eval(wo, wi) * past_clearcoat;
            pdf += probabilities.sheen / (2.0 * PI);
        }
        // Metal and coat
        if self.point.has_microfacets() {
            let (shape, lobe_pdf) = self.facets.eval_reflection(wo, wi, m, 1.0);
            value += self.facet_reflectance(cos_half) * (shape * past_clearcoat * past_o[1].min(past_i[1]));
            pdf += probabilities.facets * lobe_pdf;
        }
        // Diffuse base
        value += self.diffuse(past_i) * ((1.0 - self.layers.translucency) * wi.z);
        (value, pdf + probabilities.diffuse * warp::cosine_hemisphere_pdf(wi.z))
    }

    /// Evaluates the diffuse light on the far side.
    fn eval_far_side(&self, wi: Vec3) -> (Vec3, f32) {
        if self.layers.translucency <= 0.0 {
            return (Vec3::ZERO, 0.0);
        }
        let value = self.diffuse(self.past(wi)) * (self.layers.translucency * -wi.z);
        (value, self.probabilities.transmitted * warp::cosine_hemisphere_pdf(-wi.z))
    }

    /// Returns the diffuse BSDF of both sides together, for what lies over the base towards the incident direction.
    fn diffuse(&self, past_i: [f32; 3]) -> Vec3 {
        let through = |[clearcoat, sheen, base]: [f32; 3]| clearcoat * sheen * base;
        let mean = self.layers.base_mean(self.point.alpha).max(1e-4);
        self.point.base_color * ((1.0 - self.point.metallic) * through(self.past) * through(past_i) / (PI * mean))
    }

    /// Returns the Fresnel reflectance of the base, mixed from metal and coat.
    fn facet_reflectance(&self, cos_half: f32) -> Vec3 {
        let metallic = self.point.metallic;
        let coat = Vec3::splat((1.0 - metallic) * fresnel::dielectric(cos_half, self.point.material.ior));
        if metallic <= 0.0 {
            return coat;
        }
        coat + fresnel::schlick(self.point.base_color, cos_half) * self.metal_scale * metallic
    }

    /// Samples a direction for a lobe number in 0..1 and a point of the unit square. Returns none for samples without
    /// contribution.
    pub fn sample(&self, u_lobe: f32, u: Vec2) -> Option<BsdfSample> {
        let transmission = self.point.transmission;
        let wi = if u_lobe < transmission {
            let u_lobe = u_lobe / transmission;
            match &self.layers.frost {
                Some(frost) => frost.sample(&self.dielectric, self.geometry.wo, u_lobe, u)?,
                None => return self.dielectric.sample(&self.geometry, u_lobe),
            }
        } else {
            self.sample_opaque((u_lobe - transmission) / (1.0 - transmission), u)?
        };
        let direction = self.geometry.to_world(wi).normalize_or_zero();
        if wi.z == 0.0 || (wi.z > 0.0) != self.geometry.is_above(direction) {
            return None;
        }
        // Evaluate all lobes in that direction
        let (value, pdf) = self.eval_local(wi);
        if pdf <= 0.0 {
            return None;
        }
        let sample = BsdfSample::non_specular(direction, value / pdf, pdf);
        match self.dielectric.boundary {
            Boundary::Interface(interface) if self.enters_body(direction) => {
                Some(BsdfSample { is_transmission: true, eta_scale: radiance_scale(interface), ..sample })
            }
            Boundary::Interface(_) | Boundary::ThinPane => Some(sample),
        }
    }

    /// Samples a direction from the opaque lobes, local frame. Returns none for a facet that reflects below the surface.
    fn sample_opaque(&self, u_lobe: f32, u: Vec2) -> Option<Vec3> {
        let LayerProbabilities { clearcoat, sheen, facets, diffuse, .. } = self.probabilities;
        let wo = self.geometry.wo;
        let mut u_lobe = u_lobe;
        let mut is_below = |probability: f32| {
            let below = u_lobe < probability;
            u_lobe -= probability;
            below
        };
        let reflect = |facets: &Facets| {
            let wi = ggx::reflect(wo, facets.sample_visible_normal(wo, u));
            (wi.z > 0.0).then_some(wi)
        };
        if let Some(coat) = self.layers.clearcoat.as_ref().filter(|_| is_below(clearcoat)) {
            return reflect(&coat.facets);
        }
        if is_below(sheen) {
            return Some(warp::uniform_cone(u, 1.0));
        }
        if is_below(facets) {
            return reflect(&self.facets);
        }
        let wi = warp::cosine_hemisphere(u);
        Some(if self.layers.translucency > 0.0 && !is_below(diffuse) { -wi } else { wi })
    }
}

//! BSDFs: the scattering of light at surfaces.
//!
//! A surface is a mix of a metal (GGX with Schlick's Fresnel), a dielectric (GGX gloss over a diffuse body) and clear
//! glass (smooth, Fresnel-weighted). Gloss and body share the energy through the gloss's directional albedo E:
//! the body gets (1 - E(o))(1 - E(i)) / (1 - mean E) (Kelemen and Szirmay-Kalos 2001), so that a white body under gloss
//! gives back all light; metals are scaled by 1 + F0 (1 / E - 1) for light that bounces between facets (Turquin 2019).

mod albedo;
mod dielectric;
pub mod fresnel;
mod ggx;
mod phong;
mod polarisation;

use crate::color::luminance;
use crate::math::{orthonormal_basis, warp};
use crate::scene::{Material, TextureSlot};
use albedo::AlbedoTable;
pub use dielectric::{Boundary, DielectricInterface, pane_transmittance};
use glam::{Vec2, Vec3};
pub use polarisation::Polarisation;
use std::f32::consts::PI;

/// A metal smoother than this throws light as a mirror does, a little blurred.
const POLISHED_ALPHA: f32 = 0.05;

/// A gloss that takes less of the light than this is none: rounding leaves 1e-13 of it to an index of refraction of 1.
const NO_GLOSS: f32 = 1e-6;

/// A material prepared for tracing.
#[derive(Clone, Debug)]
pub struct TracedMaterial {
    base_color: Vec3,
    /// Indices into the scene's textures, by slot.
    pub textures: [Option<u32>; TextureSlot::COUNT],
    metallic: f32,
    alpha: f32,
    ior: f32,
    transmission: f32,
    /// Per metre, inside clear glass.
    absorption_per_m: Vec3,
    /// Luminance times colour that the surface gives off, cd/m2.
    pub emission: Vec3,
    gloss: AlbedoTable,
    metal: AlbedoTable,
    /// There is a metal or a gloss on the body: light is reflected at the surface itself.
    reflects: bool,
}

impl TracedMaterial {
    /// Tabulates the directional albedos of a material. Its textures are set by the caller.
    pub fn new(material: &Material) -> Self {
        let alpha = material.roughness * material.roughness;
        // A metal is opaque: only the rest lets light through, and the metal is a larger part of what does not.
        let transmission = material.transmission * (1.0 - material.metallic);
        let opaque = 1.0 - transmission;
        let metallic = if opaque > 0.0 { (material.metallic / opaque).min(1.0) } else { 0.0 };
        let gloss = AlbedoTable::dielectric(material.ior, alpha);
        TracedMaterial {
            base_color: material.base_color.into(),
            textures: [None; TextureSlot::COUNT],
            metallic,
            alpha,
            ior: material.ior,
            transmission,
            absorption_per_m: material.absorption_per_m.into(),
            emission: material.emission_cd_m2.into(),
            reflects: metallic > 0.0 || gloss.mean > NO_GLOSS,
            gloss,
            metal: AlbedoTable::perfect_reflector(alpha),
        }
    }

    /// Returns the texture of a slot, an index into the scene's textures.
    pub fn texture(&self, slot: TextureSlot) -> Option<u32> {
        self.textures[slot as usize]
    }

    /// Returns true if the surface emits light.
    pub fn is_emissive(&self) -> bool {
        self.emission != Vec3::ZERO
    }

    /// Returns true if the material transmits light.
    pub fn transmits(&self) -> bool {
        self.transmission > 0.0
    }

    /// Returns the weight of the dielectric lobe, which transmits light.
    pub fn transmission(&self) -> f32 {
        self.transmission
    }

    /// Reflectance at normal incidence, for the albedo AOV: the base colour; white as far as the material transmits.
    pub fn albedo(&self, texture: Vec3) -> Vec3 {
        (self.base_color * texture).lerp(Vec3::ONE, self.transmission)
    }

    /// Returns the GGX roughness alpha: the square of the user's roughness.
    pub fn alpha(&self) -> f32 {
        self.alpha
    }

    /// Returns the index of refraction.
    pub fn ior(&self) -> f32 {
        self.ior
    }

    /// Returns the transmittance over a distance inside of the body, metres (Beer-Lambert law).
    pub fn transmittance(&self, distance: f32) -> Vec3 {
        (-self.absorption_per_m * distance).exp()
    }

    fn is_smooth(&self) -> bool {
        self.alpha < ggx::MIN_ALPHA
    }

    /// Returns an upper bound of the albedo. Textures only darken.
    pub fn max_albedo(&self) -> f32 {
        let body = self.base_color.max_element();
        if self.transmission > 0.0 { 1.0_f32.max(body) } else { body + (1.0 - body) * self.gloss.mean }
    }

    /// Returns true if nearly all light is scattered into one direction: clear glass, mirrors and polished metal.
    pub fn is_nearly_specular(&self) -> bool {
        self.transmits() || (self.metallic > 0.5 && self.alpha < POLISHED_ALPHA)
    }

    /// Returns true for clear glass and perfect mirrors, which cast caustics.
    pub fn is_caustic_caster(&self) -> bool {
        self.transmits() || (self.metallic > 0.5 && self.is_smooth())
    }

    /// Returns the directional albedo of the gloss.
    #[inline]
    fn gloss_albedo(&self, cos: f32) -> f32 {
        if self.reflects { self.gloss.at(cos) } else { 0.0 }
    }

    /// Returns the probability of sampling the gloss rather than the diffuse body: its part of the albedo.
    fn gloss_choice(&self, base_color: Vec3, gloss_albedo: f32) -> f32 {
        let color = luminance(base_color);
        let gloss = (1.0 - self.metallic) * gloss_albedo + self.metallic * color.max(0.04);
        let body = (1.0 - self.metallic) * (1.0 - gloss_albedo) * color;
        if body <= 0.0 { 1.0 } else { gloss / (gloss + body) }
    }

    /// The diffuse body under the gloss, as far as the viewer's side goes.
    fn body(&self, base_color: Vec3, gloss_albedo: f32) -> Vec3 {
        base_color * ((1.0 - self.metallic) * (1.0 - gloss_albedo) / (PI * (1.0 - self.gloss.mean).max(1e-4)))
    }

    /// Returns true if the BSDF has a lobe that is not a delta function, so that light sampling can contribute.
    pub fn has_non_specular_lobe(&self) -> bool {
        let body = self.metallic < 1.0 && self.base_color.max_element() > 0.0;
        self.transmission < 1.0 && (body || !self.is_smooth())
    }
}

/// A direction sampled from a BSDF.
#[derive(Clone, Copy, Debug)]
pub struct BsdfSample {
    /// Unit direction, world space.
    pub direction: Vec3,
    /// BSDF times cosine over density.
    pub weight: Vec3,
    /// Density in solid angle; meaningless for `specular`.
    pub pdf: f32,
    /// True for samples of a delta lobe, which no other technique can find.
    pub specular: bool,
    /// Square of the relative index crossed: radiance grows by it inside glass, and roulette must not see that.
    pub eta_scale: f32,
    /// Polarisation that is accepted from there on.
    pub polarisation: Polarisation,
    /// True if the direction is on the other side of the surface.
    pub is_transmission: bool,
    /// Through a thin pane, straight on: other techniques can find it as if the pane were not there.
    pub is_undeviated: bool,
}

impl BsdfSample {
    /// Returns a sample of a lobe that is not a delta function.
    pub fn non_specular(direction: Vec3, weight: Vec3, pdf: f32) -> Self {
        BsdfSample { weight, pdf, specular: false, ..BsdfSample::specular(direction) }
    }

    /// Returns a sample of a delta lobe, of weight 1.
    fn specular(direction: Vec3) -> Self {
        BsdfSample {
            direction,
            weight: Vec3::ONE,
            pdf: 0.0,
            specular: true,
            eta_scale: 1.0,
            polarisation: Polarisation::NONE,
            is_transmission: false,
            is_undeviated: false,
        }
    }
}

/// The BSDF at a shading point for one outgoing direction.
#[derive(Clone, Copy, Debug)]
pub struct Bsdf<'a> {
    material: &'a TracedMaterial,
    base_color: Vec3,
    /// Shading frame; `normal` is on the side of `wo`.
    tangent: Vec3,
    bitangent: Vec3,
    normal: Vec3,
    /// On the side of `wo`.
    geometric_normal: Vec3,
    /// Towards the viewer, in the shading frame.
    wo: Vec3,
    /// Smith's Lambda of `wo`.
    lambda_o: f32,
    /// Probability of sampling the gloss rather than the diffuse body.
    gloss_choice: f32,
    /// The body's share of the BSDF, but for what the gloss keeps from the incoming light.
    body: Vec3,
    /// The same, world space.
    wo_world: Vec3,
    /// What light that goes through comes to.
    boundary: Boundary,
    /// Polarisation that the viewer accepts.
    polarisation: Polarisation,
}

impl<'a> Bsdf<'a> {
    /// Scattering towards `wo` (unit, world) of a surface with these normals (outward) and texture value.
    pub fn new(material: &'a TracedMaterial, texture: Vec3, normal: Vec3, geometric_normal: Vec3, wo: Vec3) -> Self {
        let outside = wo.dot(geometric_normal) >= 0.0;
        let side = if outside { 1.0 } else { -1.0 };
        let geometric_normal = geometric_normal * side;
        // An interpolated normal that looks away from the viewer would show the surface's back: take the triangle's.
        let normal = if normal.dot(wo) * side > 1e-4 { normal * side } else { geometric_normal };
        let (tangent, bitangent) = orthonormal_basis(normal);
        let wo_world = wo;
        let wo = Vec3::new(wo.dot(tangent), wo.dot(bitangent), wo.dot(normal).max(1e-6));
        let base_color = material.base_color * texture;
        // A body in air, unless `through` says otherwise.
        let eta = if outside { material.ior } else { 1.0 / material.ior };
        let boundary = Boundary::Interface(DielectricInterface { eta, starts_inside: false });
        let polarisation = Polarisation::NONE;
        let gloss_albedo = material.gloss_albedo(wo.z);
        Bsdf {
            material,
            base_color,
            tangent,
            bitangent,
            normal,
            geometric_normal,
            wo,
            lambda_o: if material.reflects { ggx::lambda(wo, material.alpha) } else { 0.0 },
            gloss_choice: material.gloss_choice(base_color, gloss_albedo),
            body: material.body(base_color, gloss_albedo),
            wo_world,
            boundary,
            polarisation,
        }
    }

    /// The same surface with this behind it, for a viewer who accepts this polarisation.
    pub fn with_boundary(self, boundary: Boundary, polarisation: Polarisation) -> Self {
        Bsdf { boundary, polarisation, ..self }
    }

    /// Normal on the viewer's side.
    pub fn normal(&self) -> Vec3 {
        self.normal
    }

    fn to_world(self, w: Vec3) -> Vec3 {
        self.tangent * w.x + self.bitangent * w.y + self.normal * w.z
    }

    /// BSDF times cosine, and the density of [`Bsdf::sample`], for a unit world direction. Perfect mirrors and glass are
    /// left out of both.
    pub fn eval(&self, direction: Vec3) -> (Vec3, f32) {
        let wi = Vec3::new(direction.dot(self.tangent), direction.dot(self.bitangent), direction.dot(self.normal));
        if wi.z <= 0.0 || direction.dot(self.geometric_normal) <= 0.0 || self.material.transmission >= 1.0 {
            return (Vec3::ZERO, 0.0);
        }
        self.eval_local(wi)
    }

    fn eval_local(&self, wi: Vec3) -> (Vec3, f32) {
        let s = self.material;
        let mut value = self.body * ((1.0 - s.gloss_albedo(wi.z)) * wi.z);
        let mut pdf = (1.0 - self.gloss_choice) * warp::cosine_hemisphere_pdf(wi.z);
        if s.reflects && !s.is_smooth() {
            let m = (self.wo + wi).normalize_or(Vec3::Z);
            let cos_half = self.wo.dot(m).clamp(0.0, 1.0);
            // The density of visible normals is this times the masking of `wo`; the BSDF, times that of both.
            let shape = ggx::distribution(m, s.alpha) / (4.0 * self.wo.z);
            value += self.gloss_color(cos_half) * (shape / (1.0 + self.lambda_o + ggx::lambda(wi, s.alpha)));
            pdf += self.gloss_choice * shape / (1.0 + self.lambda_o);
        }
        let opaque = 1.0 - s.transmission;
        (value * opaque, pdf * opaque)
    }

    /// Fresnel colour of the gloss, metal and dielectric mixed.
    fn gloss_color(&self, cos_half: f32) -> Vec3 {
        let s = self.material;
        let mut color = Vec3::ZERO;
        if s.metallic < 1.0 {
            color += Vec3::splat((1.0 - s.metallic) * fresnel::dielectric(cos_half, s.ior));
        }
        if s.metallic > 0.0 {
            let lost = 1.0 / s.metal.at(self.wo.z).max(1e-3) - 1.0;
            let bounced = Vec3::ONE + self.base_color * lost;
            color += fresnel::schlick(self.base_color, cos_half) * bounced * s.metallic;
        }
        color
    }

    /// Chooses a direction. None where the choice fell on one that carries nothing.
    pub fn sample(&self, lobe: f32, u: Vec2) -> Option<BsdfSample> {
        let s = self.material;
        if lobe < s.transmission {
            return self.sample_glass(lobe / s.transmission);
        }
        let lobe = if s.transmission > 0.0 { (lobe - s.transmission) / (1.0 - s.transmission) } else { lobe };
        let choice = self.gloss_choice;
        let wi = if lobe < choice {
            if s.is_smooth() {
                return self.mirrored(self.gloss_color(self.wo.z) / choice);
            }
            let m = ggx::sample_visible_normal(self.wo, s.alpha, u);
            ggx::reflect(self.wo, m)
        } else {
            warp::cosine_hemisphere(u)
        };
        let direction = self.to_world(wi);
        if wi.z <= 0.0 || direction.dot(self.geometric_normal) <= 0.0 {
            return None;
        }
        let (value, pdf) = self.eval_local(wi);
        (pdf > 0.0).then(|| BsdfSample::non_specular(direction, value / pdf, pdf))
    }

    /// The mirror direction about the shading normal; about the triangle's where that would go below the surface.
    fn mirrored(&self, weight: Vec3) -> Option<BsdfSample> {
        let about = |normal: Vec3| (2.0 * self.wo_world.dot(normal) * normal - self.wo_world).normalize_or_zero();
        let above = |direction: &Vec3| direction.dot(self.geometric_normal) > 0.0;
        let direction = Some(about(self.normal)).filter(above).or(Some(about(self.geometric_normal)).filter(above))?;
        Some(BsdfSample { weight, ..BsdfSample::specular(direction) })
    }
}

#[cfg(test)]
mod tests;

//! A material prepared for tracing: its parameters and the directional albedo tables of its lobes.

use super::albedo::{AlbedoTable, AlbedoTables};
use super::fibre::TracedFibre;
use super::ggx;
use crate::color::luminance;
use crate::math::safe_sqrt;
use crate::scene::{Material, TextureSlot};
use glam::Vec3;
use std::f32::consts::PI;

/// Roughness alpha below which a metal counts as nearly specular.
const POLISHED_ALPHA: f32 = 0.05;

/// Mean albedo below which a coat is left out: rounding gives 1e-13 to an index of refraction of 1.
const MIN_COAT_ALBEDO: f32 = 1e-6;

/// A material prepared for tracing.
#[derive(Clone, Debug)]
pub struct TracedMaterial {
    pub(super) base_color: Vec3,
    /// Indices into the scene's textures, by slot.
    pub textures: [Option<u32>; TextureSlot::COUNT],
    /// Metallic part of the opaque lobes.
    pub(super) metallic: f32,
    /// GGX roughness: the square of the user's roughness.
    pub(super) alpha: f32,
    pub(super) ior: f32,
    /// Weight of the dielectric lobe.
    pub(super) transmission: f32,
    /// Absorption coefficient inside of the body, 1/m.
    absorption_per_m: Vec3,
    /// Extinction coefficient under the surface, 1/m; none where light does not scatter there.
    extinction_per_m: Option<Vec3>,
    /// Emitted luminance times colour, cd/m2.
    pub emission: Vec3,
    /// Directional albedo of the dielectric coat.
    pub(super) coat_albedo: AlbedoTable,
    /// Directional albedo of the metal for a reflectance of 1.
    pub(super) metal_albedo: AlbedoTable,
    /// True if the material has a metal or a coat.
    pub(super) has_microfacets: bool,
    /// The fibre that strands of the material are.
    fibre: Option<TracedFibre>,
}

impl TracedMaterial {
    /// Tabulates the directional albedos of a material. The caller sets its textures.
    pub fn new(material: &Material) -> Self {
        let alpha = material.roughness * material.roughness;
        // Metals are opaque: only the rest transmits, and the metal is a larger part of the opaque lobes.
        let transmission =
            if material.fibre.is_some() { 0.0 } else { material.transmission * (1.0 - material.metallic) };
        let opaque = 1.0 - transmission;
        let metallic = if opaque > 0.0 { (material.metallic / opaque).min(1.0) } else { 0.0 };
        let AlbedoTables { coat, perfect_reflector } = AlbedoTables::new(material.ior, alpha);
        TracedMaterial {
            base_color: material.base_color.into(),
            textures: [None; TextureSlot::COUNT],
            metallic,
            alpha,
            ior: material.ior,
            transmission,
            absorption_per_m: material.absorption_per_m.into(),
            extinction_per_m: extinction_per_m(material),
            emission: material.emission_cd_m2.into(),
            has_microfacets: metallic > 0.0 || coat.mean > MIN_COAT_ALBEDO,
            coat_albedo: coat,
            metal_albedo: perfect_reflector,
            fibre: material.fibre.as_ref().map(TracedFibre::new),
        }
    }

    /// Returns the texture of a slot, an index into the scene's textures.
    pub fn texture(&self, slot: TextureSlot) -> Option<u32> {
        self.textures[slot as usize]
    }

    /// Returns the fibre that strands of the material are; none for materials of surfaces.
    pub fn fibre(&self) -> Option<&TracedFibre> {
        self.fibre.as_ref()
    }

    /// Returns true if the surface emits light.
    pub fn is_emissive(&self) -> bool {
        self.emission != Vec3::ZERO
    }

    /// Returns true if the material transmits light.
    pub fn transmits(&self) -> bool {
        self.transmission > 0.0
    }

    /// Returns the factor on light that is transmitted at a surface, besides Fresnel's equations: the weight of the
    /// dielectric lobe times [`transmission_tint`].
    pub fn transmission_color(&self, texture: Vec3, is_thin: bool) -> Vec3 {
        transmission_tint(self.base_color * texture, is_thin) * self.transmission
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

    /// Returns the extinction coefficient under the surface, 1/m, if light scatters there: the inverse mean free path.
    pub fn extinction_per_m(&self) -> Option<Vec3> {
        self.extinction_per_m
    }

    /// Returns true if the microfacet lobe is a delta function.
    pub(super) fn is_smooth(&self) -> bool {
        self.alpha < ggx::MIN_ALPHA
    }

    /// Returns the reflectance for the albedo AOV: the base colour, which is also that of transmitted light.
    pub fn albedo(&self, texture: Vec3) -> Vec3 {
        self.base_color * texture
    }

    /// Returns an upper bound of the albedo; of a fibre, the mean over all directions. Textures only darken.
    pub fn max_albedo(&self) -> f32 {
        if let Some(fibre) = &self.fibre {
            return fibre.albedo().max_element().max(self.base_color.max_element());
        }
        let base = self.base_color.max_element();
        if self.transmission > 0.0 { 1.0_f32.max(base) } else { base + (1.0 - base) * self.coat_albedo.mean }
    }

    /// Returns true if nearly all light is scattered into one direction: clear glass, mirrors and polished metal.
    pub fn is_nearly_specular(&self) -> bool {
        self.transmits() || (self.metallic > 0.5 && self.alpha < POLISHED_ALPHA)
    }

    /// Returns true for clear glass and perfect mirrors, which cast caustics.
    pub fn is_caustic_caster(&self) -> bool {
        self.transmits() || (self.metallic > 0.5 && self.is_smooth())
    }

    /// Returns true if the BSDF has a lobe that is not a delta function, so that light sampling can contribute.
    pub fn has_non_specular_lobe(&self) -> bool {
        let has_diffuse = self.metallic < 1.0 && self.base_color.max_element() > 0.0;
        self.transmission < 1.0 && (has_diffuse || !self.is_smooth())
    }

    /// Returns the directional albedo of the coat.
    #[inline]
    pub(super) fn coat_albedo(&self, cos: f32) -> f32 {
        if self.has_microfacets { self.coat_albedo.at(cos) } else { 0.0 }
    }

    /// Returns the probability of sampling the microfacet lobe rather than the diffuse one: its part of the albedo.
    pub(super) fn microfacet_probability(&self, base_color: Vec3, coat_albedo: f32) -> f32 {
        let color = luminance(base_color);
        let microfacet = (1.0 - self.metallic) * coat_albedo + self.metallic * color.max(0.04);
        let diffuse = (1.0 - self.metallic) * (1.0 - coat_albedo) * color;
        if diffuse <= 0.0 { 1.0 } else { microfacet / (microfacet + diffuse) }
    }

    /// Returns the diffuse BSDF without its factor for the incident direction (Kelemen and Szirmay-Kalos 2001).
    pub(super) fn diffuse_factor(&self, base_color: Vec3, coat_albedo: f32) -> Vec3 {
        base_color * ((1.0 - self.metallic) * (1.0 - coat_albedo) / (PI * (1.0 - self.coat_albedo.mean).max(1e-4)))
    }
}

/// Returns the extinction coefficient under the surface, 1/m. Clear materials and metals scatter no light there.
fn extinction_per_m(material: &Material) -> Option<Vec3> {
    let is_opaque = material.transmission == 0.0 && material.metallic < 1.0;
    let subsurface = material.subsurface.filter(|_| is_opaque)?;
    Some(1000.0 / Vec3::from(subsurface.mean_free_path_mm))
}

/// Returns the colour of light that is transmitted at a surface of this base colour: the base colour at a thin pane, its
/// square root at each face of a body, so that both faces together have the base colour (Burley 2015, "Extending the
/// Disney BRDF to a BSDF with Integrated Subsurface Scattering", section 5). Reflected light has no colour.
pub(super) fn transmission_tint(base_color: Vec3, is_thin: bool) -> Vec3 {
    if is_thin { base_color } else { base_color.map(safe_sqrt) }
}

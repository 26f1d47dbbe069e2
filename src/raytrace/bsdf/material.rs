//! A material prepared for tracing: its parameters and the directional albedo tables of its lobes.

use super::albedo::AlbedoTables;
use super::blurred_gloss::BlurredGloss;
use super::fibre::TracedFibre;
use super::ggx;
use super::layers::SurfaceLayers;
use super::roughness_tables::RoughnessTables;
use crate::math::Dome;
use crate::scene::{Alpha, Material, TextureSlot};
use glam::Vec3;
use std::sync::Arc;

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
    /// Directional albedos of the dielectric coat, and of the metal for a reflectance of 1.
    pub(super) tables: AlbedoTables,
    /// True if the material has a metal or a coat.
    pub(super) has_microfacets: bool,
    /// Roughness and metal where a texture varies them.
    pub(super) mapped_gloss: Option<MappedGloss>,
    /// Factor of the tilt of the normal map.
    pub normal_scale: f32,
    /// The normal texture is below the gloss, which has the normal of the mesh.
    pub smooth_gloss: bool,
    /// The clear dome over the textures.
    pub dome: Option<Dome>,
    /// How the surface is masked or blended. Glass is neither.
    pub coverage: Alpha,
    /// The fibre that strands of the material are.
    fibre: Option<TracedFibre>,
    /// What the surface has besides its base.
    layers: Option<Arc<SurfaceLayers>>,
    /// A rougher gloss in place of a smoother one.
    pub(super) blurred_gloss: Option<Arc<BlurredGloss>>,
}

/// Roughness and metal that a texture varies.
#[derive(Clone, Debug)]
pub(super) struct MappedGloss {
    /// The user's roughness, a factor of the texture's.
    pub roughness: f32,
    /// The user's metal, a factor of the texture's.
    pub metallic: f32,
    /// The user's transmission.
    pub transmission: f32,
    /// Directional albedos for every roughness.
    pub tables: Arc<RoughnessTables>,
}

impl TracedMaterial {
    /// Tabulates the directional albedos of a material. The caller sets its textures.
    pub fn new(material: &Material) -> Self {
        let alpha = material.roughness * material.roughness;
        let clear = if material.fibre.is_some() { 0.0 } else { material.transmission };
        let (transmission, metallic) = Self::divide(clear, material.metallic);
        let tables = AlbedoTables::new(material.ior, alpha);
        let layers = SurfaceLayers::new(material, alpha, &tables).map(Arc::new);
        // Layers lie over a base that is never a delta lobe
        let alpha = if layers.is_some() { alpha.max(ggx::MIN_ALPHA) } else { alpha };
        TracedMaterial {
            base_color: material.base_color.into(),
            textures: [None; TextureSlot::COUNT],
            metallic,
            alpha,
            ior: material.ior,
            transmission,
            absorption_per_m: material.absorption_per_m.into(),
            extinction_per_m: extinction_per_m(material).filter(|_| layers.is_none()),
            emission: material.emission_cd_m2.into(),
            has_microfacets: metallic > 0.0 || tables.coat.mean > MIN_COAT_ALBEDO,
            tables,
            mapped_gloss: None,
            normal_scale: material.textures.normal_scale,
            smooth_gloss: material.has_smooth_gloss(),
            dome: material.dome(),
            coverage: if clear > 0.0 { Alpha::Opaque } else { material.alpha },
            fibre: material.fibre.as_ref().map(TracedFibre::new),
            layers,
            blurred_gloss: None,
        }
    }

    /// Lets the texture of roughness and metal vary a material. `tables` are those of its index of refraction.
    pub fn map_gloss(&mut self, material: &Material, tables: Arc<RoughnessTables>) {
        let Material { roughness, metallic, .. } = *material;
        let transmission = if material.fibre.is_some() { 0.0 } else { material.transmission };
        // Where the texture has no metal, all of the transmission is there
        self.transmission = transmission;
        self.has_microfacets = true;
        self.layers = self.layers.as_ref().map(|layers| Arc::new(layers.over_mapped_base(&tables)));
        self.mapped_gloss = Some(MappedGloss { roughness, metallic, transmission, tables });
    }

    /// Returns true if the material is a coat over a matte base, somewhere smoother than this roughness, and nothing
    /// else: no metal, glass, fibre or layer.
    pub fn has_gloss_below(&self, roughness: f32) -> bool {
        let is_smoother = self.mapped_gloss.is_some() || self.alpha < roughness * roughness;
        let is_metal = self.mapped_gloss.as_ref().map_or(self.metallic, |mapped| mapped.metallic) > 0.0;
        let is_plain = self.fibre.is_none() && self.layers.is_none() && !self.transmits();
        is_plain && !is_metal && self.has_microfacets && is_smoother
    }

    /// Returns the material with a gloss that is blurred where it is smoother.
    pub fn with_blurred_gloss(&self, gloss: &Arc<BlurredGloss>) -> Self {
        TracedMaterial { blurred_gloss: Some(gloss.clone()), ..self.clone() }
    }

    /// Returns the tables of a material with mapped roughness.
    pub fn roughness_tables(&self) -> Option<&Arc<RoughnessTables>> {
        self.mapped_gloss.as_ref().map(|mapped| &mapped.tables)
    }

    /// Returns the weight of the dielectric lobe and the metallic part of the opaque lobes. Metals are opaque: only the
    /// rest transmits, and the metal is a larger part of the opaque lobes.
    pub(super) fn divide(transmission: f32, metallic: f32) -> (f32, f32) {
        let transmission = transmission * (1.0 - metallic);
        let opaque = 1.0 - transmission;
        (transmission, if opaque > 0.0 { (metallic / opaque).min(1.0) } else { 0.0 })
    }

    /// Returns the texture of a slot, an index into the scene's textures.
    pub fn texture(&self, slot: TextureSlot) -> Option<u32> {
        self.textures[slot as usize]
    }

    /// Returns the fibre that strands of the material are; none for materials of surfaces.
    pub fn fibre(&self) -> Option<&TracedFibre> {
        self.fibre.as_ref()
    }

    /// Returns what the surface has besides its base.
    pub fn layers(&self) -> Option<&SurfaceLayers> {
        self.layers.as_deref()
    }

    /// Returns true if the surface is brushed, so that its tangent matters.
    pub fn is_brushed(&self) -> bool {
        self.layers().is_some_and(|layers| layers.brushing.is_some())
    }

    /// Returns the direction across the grooves of a brushed surface, radians from its tangent.
    pub fn brushing_angle(&self) -> f32 {
        let brushing = self.layers().and_then(|layers| layers.brushing.as_ref());
        brushing.map_or(0.0, |brushing| brushing.anisotropy.rotation_deg.to_radians())
    }

    /// Returns true if the faces of what transmits are smooth: light passes them by refraction or straight.
    pub fn is_clear(&self) -> bool {
        self.transmits() && self.layers().is_none_or(|layers| layers.frost.is_none())
    }

    /// Returns true if the surface emits light.
    pub fn is_emissive(&self) -> bool {
        self.emission != Vec3::ZERO
    }

    /// Returns true if the material transmits light.
    pub fn transmits(&self) -> bool {
        self.transmission > 0.0
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

    /// Returns true if the microfacet lobe is a delta function. One with a map never is.
    fn is_smooth(&self) -> bool {
        self.mapped_gloss.is_none() && self.alpha < ggx::MIN_ALPHA
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
        let coat = self.roughness_tables().map_or(self.tables.coat.mean, |tables| tables.largest_coat_mean());
        let layered = self.layers().map_or(0.0, SurfaceLayers::largest_albedo);
        let coat = coat + (1.0 - coat) * layered;
        if self.transmission > 0.0 { 1.0_f32.max(base) } else { base + (1.0 - base) * coat }
    }

    /// Returns true if nearly all light is scattered into one direction: clear glass, mirrors and polished metal.
    pub fn is_nearly_specular(&self) -> bool {
        let is_polished = self.mapped_gloss.is_none() && self.metallic > 0.5 && self.alpha < POLISHED_ALPHA;
        self.is_clear() || is_polished
    }

    /// Returns true for clear glass and perfect mirrors, which cast caustics.
    pub fn is_caustic_caster(&self) -> bool {
        self.is_clear() || (self.metallic > 0.5 && self.is_smooth())
    }

    /// Returns true if the BSDF has a lobe that is not a delta function at any point, so that light sampling can
    /// contribute. [`MaterialPoint::has_non_specular_lobe`](super::MaterialPoint::has_non_specular_lobe) is the same at
    /// one point, without frosting.
    pub fn has_non_specular_lobe(&self) -> bool {
        let has_diffuse = self.metallic < 1.0 && self.base_color.max_element() > 0.0;
        let is_metal_in_places = self.mapped_gloss.as_ref().is_some_and(|mapped| mapped.metallic > 0.0);
        let is_frosted = self.layers().is_some_and(|layers| layers.frost.is_some());
        is_metal_in_places || is_frosted || (self.transmission < 1.0 && (has_diffuse || !self.is_smooth()))
    }
}

/// Returns the extinction coefficient under the surface, 1/m. Clear materials and metals scatter no light there.
fn extinction_per_m(material: &Material) -> Option<Vec3> {
    let is_opaque = material.transmission == 0.0 && material.metallic < 1.0;
    let subsurface = material.subsurface.filter(|_| is_opaque)?;
    Some(1000.0 / Vec3::from(subsurface.mean_free_path_mm))
}

//! The layers of a material besides its base, prepared for tracing. Only materials that have some pay for them.

use super::albedo::{AlbedoTable, AlbedoTables};
use super::direction_table::DirectionTable;
use super::facets::Facets;
use super::fresnel;
use super::frost::Frost;
use super::roughness_tables::RoughnessTables;
use super::sheen::SheenLobe;
use crate::scene::{Anisotropy, Clearcoat, Material};
use glam::Vec3;

/// Steps of the mean over the hemisphere.
const MEAN_STEPS: u32 = 48;
/// Azimuths of that mean for a brushed surface.
const MEAN_AZIMUTHS: u32 = 4;

/// The layers of a material.
#[derive(Clone, Debug)]
pub struct SurfaceLayers {
    /// Lacquer over all of the opaque lobes.
    pub clearcoat: Option<ClearcoatLobe>,
    /// Sheen under the lacquer.
    pub sheen: Option<SheenLobe>,
    /// Brushing of metal and coat.
    pub brushing: Option<Brushing>,
    /// Faces of frosted glass.
    pub frost: Option<Frost>,
    /// Part of the diffuse light that leaves on the far side.
    pub translucency: f32,
    /// Mean transmission of all that lies over the diffuse base, cosine-weighted: by the user's roughness from 0 to 1
    /// where it is mapped, else one.
    base_means: Vec<f32>,
}

/// A layer of lacquer.
#[derive(Clone, Debug)]
pub struct ClearcoatLobe {
    /// Part of the surface that has it.
    pub amount: f32,
    /// Facets of the layer.
    pub facets: Facets,
    albedo: AlbedoTable,
}

impl ClearcoatLobe {
    fn new(&Clearcoat { amount, roughness }: &Clearcoat) -> Self {
        let alpha = (roughness * roughness).max(super::ggx::MIN_ALPHA);
        let albedo = AlbedoTables::new(Clearcoat::IOR, alpha).coat;
        ClearcoatLobe { amount, facets: Facets::new([alpha; 2]), albedo }
    }

    /// Returns the directional albedo.
    pub fn albedo(&self, cos: f32) -> f32 {
        self.amount * self.albedo.at(cos)
    }

    /// Returns the mean albedo, cosine-weighted.
    fn mean_albedo(&self) -> f32 {
        self.amount * self.albedo.mean
    }
}

/// A brushed surface.
#[derive(Clone, Debug)]
pub struct Brushing {
    /// Its strength.
    pub anisotropy: Anisotropy,
    /// Directional albedos of coat and metal. None where a texture varies the roughness: the tables of the smoother
    /// direction serve then, and some light between facets is lost.
    pub albedos: Option<BrushedAlbedos>,
}

/// Directional albedos of a brushed surface.
#[derive(Clone, Debug)]
pub struct BrushedAlbedos {
    /// Of the dielectric coat.
    pub coat: DirectionTable,
    /// Of a reflector of reflectance 1.
    pub metal: DirectionTable,
}

impl SurfaceLayers {
    /// Prepares the layers of a material whose opaque base has these albedos and this GGX alpha; none without any.
    pub fn new(material: &Material, alpha: f32, tables: &AlbedoTables) -> Option<Self> {
        if material.fibre.is_some() {
            return None;
        }
        let sheen = material.sheen.filter(|sheen| sheen.color != [0.0; 3]);
        let brushing = material.anisotropy.filter(|anisotropy| anisotropy.strength > 0.0);
        let clear = material.transmission > 0.0;
        let is_needed = sheen.is_some()
            || brushing.is_some()
            || material.clearcoat.is_some_and(|coat| coat.amount > 0.0)
            || (clear && material.frosting > 0.0)
            || material.is_translucent();
        is_needed.then(|| {
            let mut layers = SurfaceLayers {
                clearcoat: material.clearcoat.as_ref().filter(|coat| coat.amount > 0.0).map(ClearcoatLobe::new),
                sheen: sheen.as_ref().map(SheenLobe::new),
                brushing: brushing.map(|anisotropy| Brushing {
                    anisotropy,
                    albedos: Some(BrushedAlbedos::new(&Facets::new(anisotropy.alphas(alpha)), material.ior)),
                }),
                frost: (clear && material.frosting > 0.0).then(|| Frost::new(material.ior, material.frosting)),
                translucency: if material.is_translucent() { material.translucency } else { 0.0 },
                base_means: Vec::new(),
            };
            layers.base_means = vec![layers.mean_base_transmission(tables)];
            layers
        })
    }

    /// Returns the same layers over a base whose roughness a texture varies.
    pub fn over_mapped_base(&self, tables: &RoughnessTables) -> Self {
        let mut layers = self.clone();
        if let Some(brushing) = &mut layers.brushing {
            brushing.albedos = None;
        }
        layers.base_means = tables.levels().iter().map(|level| layers.mean_base_transmission(level)).collect();
        layers
    }

    /// Returns the part of the light that the lacquer lets through towards a direction, local frame.
    pub fn past_clearcoat(&self, w: Vec3) -> f32 {
        self.clearcoat.as_ref().map_or(1.0, |coat| 1.0 - coat.albedo(w.z.abs()))
    }

    /// Returns the part that the sheen lets through.
    pub fn past_sheen(&self, w: Vec3) -> f32 {
        self.sheen.as_ref().map_or(1.0, |sheen| 1.0 - sheen.albedo(w))
    }

    /// Returns the mean transmission of all that lies over the diffuse base, for an alpha of the base.
    pub fn base_mean(&self, alpha: f32) -> f32 {
        let last = self.base_means.len() - 1;
        let x = alpha.max(0.0).sqrt().min(1.0) * last as f32;
        let i = (x as usize).min(last.saturating_sub(1));
        let (low, high) = (self.base_means[i], self.base_means[(i + 1).min(last)]);
        low + (high - low) * (x - i as f32)
    }

    /// Returns the albedos of a brushed surface whose roughness is the same everywhere.
    pub fn brushed_albedos(&self) -> Option<&BrushedAlbedos> {
        self.brushing.as_ref().and_then(|brushing| brushing.albedos.as_ref())
    }

    /// Returns an upper bound of the mean albedo of lacquer and sheen.
    pub fn largest_albedo(&self) -> f32 {
        let clearcoat = self.clearcoat.as_ref().map_or(0.0, ClearcoatLobe::mean_albedo);
        clearcoat + (1.0 - clearcoat) * self.sheen.as_ref().map_or(0.0, SheenLobe::mean_albedo)
    }

    /// Integrates the cosine-weighted mean by the midpoint rule over the square root of the cosine: 2 mu dmu = 4 r3 dr.
    fn mean_base_transmission(&self, tables: &AlbedoTables) -> f32 {
        let brushed = self.brushed_albedos();
        let azimuths = if brushed.is_some() { MEAN_AZIMUTHS } else { 1 };
        let mut sum = 0.0;
        for i in 0..MEAN_STEPS {
            let r = (i as f32 + 0.5) / MEAN_STEPS as f32;
            let cos = r * r;
            let sin = (1.0 - cos * cos).sqrt();
            for k in 0..azimuths {
                let (y, x) = (std::f32::consts::FRAC_PI_2 * (k as f32 + 0.5) / azimuths as f32).sin_cos();
                let w = Vec3::new(sin * x, sin * y, cos);
                let coat = brushed.map_or_else(|| tables.coat.at(cos), |albedos| albedos.coat.at(w));
                sum += 4.0 * r * r * r * self.past_clearcoat(w) * self.past_sheen(w) * (1.0 - coat);
            }
        }
        sum / (MEAN_STEPS * azimuths) as f32
    }
}

impl BrushedAlbedos {
    fn new(facets: &Facets, ior: f32) -> Self {
        BrushedAlbedos {
            coat: DirectionTable::by_direction(|wo| facets.reflected(wo, |cos| fresnel::dielectric(cos, ior))),
            metal: DirectionTable::by_direction(|wo| facets.reflected(wo, |_| 1.0)),
        }
    }
}

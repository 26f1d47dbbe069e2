//! The approximations at a path's vertex: its diffuse light from the irradiance cache, and blurred gloss.

use super::bsdf::{Bsdf, TracedMaterial};
use super::events::{PathEnd, PathEvent};
use super::geometry::SurfaceInteraction;
use super::irradiance_cache::{CachedLight, Footprint};
use super::path_tracer::{PathState, PathTracer};
use super::sink::RadianceSink;
use glam::Vec3;

impl<'a> PathTracer<'a> {
    /// Returns the material of a surface with blurred gloss, if regularisation blurs it for the path.
    pub fn blurred_material(
        &self,
        path: &PathState,
        surface: &SurfaceInteraction,
        sink: &mut impl RadianceSink,
    ) -> Option<&'a TracedMaterial> {
        let (material, roughness) = self.blurred_materials?.material(surface.material, path.sample_solid_angle)?;
        sink.record(|| PathEvent::BlurredGloss { roughness });
        Some(material)
    }

    /// Adds the cached diffuse light of a surface that a path meets from `wo` after so many metres, and leaves the rest
    /// of its BSDF. Without a cache, or where the path has to find that light itself, nothing changes. Returns false if
    /// the path ends.
    pub fn take_cached_light(
        &self,
        path: &PathState,
        surface: &SurfaceInteraction,
        (wo, distance): (Vec3, f32),
        bsdf: &mut Bsdf<'_>,
        sink: &mut impl RadianceSink,
    ) -> bool {
        let cached = self.cached_light(path, surface, wo, distance, bsdf);
        let Some(CachedLight { factor, light, cell_m }) = cached else { return true };
        sink.record(|| PathEvent::CachedLight { cell_m });
        let factor = path.throughput * factor;
        for (layer, light) in light.iter().enumerate().filter(|(_, light)| **light != Vec3::ZERO) {
            sink.add(layer, factor * *light);
        }
        let goes_on = bsdf.remove_matte_base();
        if !goes_on {
            sink.record(|| PathEvent::End(PathEnd::Cached));
        }
        goes_on
    }

    /// Returns the cached light of a surface, if the path may take it.
    pub fn cached_light(
        &self,
        path: &PathState,
        surface: &SurfaceInteraction,
        wo: Vec3,
        distance: f32,
        bsdf: &Bsdf<'_>,
    ) -> Option<CachedLight<'a>> {
        let cache = self.irradiance_cache.filter(|_| path.non_specular_depth > 0)?;
        let cos = wo.dot(surface.geometric_normal);
        let footprint = Footprint::new(path.sample_solid_angle, distance, cos);
        cache.light_at(surface, footprint, bsdf)
    }
}

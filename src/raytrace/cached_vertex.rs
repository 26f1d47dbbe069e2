//! A path's vertex whose diffuse light comes from the irradiance cache.

use super::bsdf::Bsdf;
use super::events::{PathEnd, PathEvent};
use super::geometry::SurfaceInteraction;
use super::irradiance_cache::Footprint;
use super::path_tracer::{PathState, PathTracer};
use super::sink::RadianceSink;
use glam::Vec3;

impl<'a> PathTracer<'a> {
    /// Adds the cached diffuse light of a surface that a path meets from `wo` after so many metres, and leaves the rest of
    /// its BSDF. Without a cache, or where the path has to find that light itself, nothing changes. Returns false if the
    /// path ends.
    pub fn take_cached_light(
        &self,
        path: &PathState,
        surface: &SurfaceInteraction,
        (wo, distance): (Vec3, f32),
        bsdf: &mut Bsdf<'_>,
        sink: &mut impl RadianceSink,
    ) -> bool {
        let Some((factor, light)) = self.cached_light(path, surface, wo, distance, bsdf) else { return true };
        sink.record(|| PathEvent::CachedLight { cell_m: self.irradiance_cache.map_or(0.0, |cache| cache.cell_m) });
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

    /// Returns the cached light of a surface and its factor towards the path, if the path may take it.
    pub fn cached_light(
        &self,
        path: &PathState,
        surface: &SurfaceInteraction,
        wo: Vec3,
        distance: f32,
        bsdf: &Bsdf<'_>,
    ) -> Option<(Vec3, &'a [Vec3])> {
        let cache = self.irradiance_cache.filter(|_| path.non_specular_depth > 0)?;
        let cos = wo.dot(surface.geometric_normal);
        let footprint = Footprint::new(path.sample_solid_angle, distance, cos);
        if footprint.covers_cells(cache.cell_m) { cache.light_at(surface, bsdf) } else { None }
    }
}

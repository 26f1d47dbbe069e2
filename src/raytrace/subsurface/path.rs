//! The continuation of a path under the surface.

use super::medium::Medium;
use super::walk::Walk;
use crate::raytrace::bsdf::Bsdf;
use crate::raytrace::events::PathEvent;
use crate::raytrace::geometry::SurfaceInteraction;
use crate::raytrace::limits::PathLimits;
use crate::raytrace::path_tracer::{PathState, PathTracer, ShadingPoint};
use crate::raytrace::sampler::{Dimensions, Sampler, Set};
use crate::raytrace::simd;
use crate::raytrace::sink::RadianceSink;

impl<'a> PathTracer<'a> {
    /// Walks under the surface at a vertex, and adds the light that arrives where the walk comes out. Returns the
    /// surface and the BSDF there, or none for a walk that is absorbed.
    pub fn walk_under_surface(
        &mut self,
        path: &mut PathState,
        point: &ShadingPoint<'_>,
        sampler: &Sampler,
        light_set: &Set,
        limits: PathLimits,
        sink: &mut impl RadianceSink,
    ) -> Option<(SurfaceInteraction, Bsdf<'a>)> {
        let scene = self.caster.scene;
        let Bsdf::Surface(entry) = point.bsdf else { return None };

        // Walk from the vertex to where the light enters
        let material = &scene.materials[point.surface.material as usize];
        let (set, numbers) = sampler.set_and_stream(Dimensions::Subsurface { depth: path.depth });
        let end = simd::dispatch(Walk {
            instance: &scene.aggregate.instances()[point.instance as usize],
            materials: &scene.materials,
            medium: Medium::new(material.extinction_per_m()?, entry.base_color()),
            entry: point.surface,
            set,
            numbers,
            stack: &mut self.caster.stack,
        })?;
        self.caster.rays += u64::from(end.rays);
        path.throughput *= end.weight * entry.entry_weight();
        sink.record(|| PathEvent::Subsurface {
            position: end.surface.position,
            rays: end.rays,
            at_entry: end.is_entry,
            weight: end.weight,
            throughput: path.throughput,
        });

        // Gather photons and sample the lights there, for this path alone
        let surface = end.surface;
        let exit = &scene.materials[surface.material as usize];
        let bsdf = Bsdf::at_exit(exit, surface.normal, surface.geometric_normal);
        path.split_factor = 1.0;
        self.gather_photons(path, &surface, &bsdf, limits, sink);
        let point = ShadingPoint { surface: &surface, bsdf: &bsdf, importances: None, ..*point };
        self.sample_lights(path, &point, sampler, light_set, 1.0, sink);
        Some((surface, bsdf))
    }
}

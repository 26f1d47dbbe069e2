//! The split of a path: into several from the first non-specular surface, or into reflection and transmission.

use super::events::PathEvent;
use super::limits::PathLimits;
use super::path_tracer::{LightSampling, PathState, PathTracer, ShadingPoint};
use super::sampler::{Dimensions, Sampler};
use super::sink::RadianceSink;

/// Part of the throughput below which a path after a dielectric split is not split again.
const MIN_SPLIT_THROUGHPUT: f32 = 0.25;
/// The largest lobe choice below 1.
const BELOW_ONE: f32 = 1.0 - f32::EPSILON / 2.0;

impl PathTracer<'_> {
    /// Continues with several paths from a vertex. Where all lights are sampled, one light sample serves all paths.
    pub fn split_path(
        &mut self,
        path: &mut PathState,
        point: &ShadingPoint<'_>,
        paths: u32,
        sampler: &Sampler,
        limits: PathLimits,
        sink: &mut impl RadianceSink,
    ) {
        sink.record(|| PathEvent::PathSplit { paths });
        let split_factor = paths as f32;

        // Sample all lights once, or compute their importances once
        let mut importances = None;
        let lights = if self.samples_all_lights(path) {
            let set = sampler.set(Dimensions::Light { slot: 0, depth: path.depth });
            self.sample_lights(path, point, sampler, &set, split_factor, sink);
            LightSampling::Shared { paths: split_factor }
        } else {
            importances = self.light_importances(point);
            LightSampling::Sample
        };

        // Divide the throughput among the paths
        let point = &ShadingPoint { importances: importances.as_ref(), ..*point };
        path.throughput /= split_factor;
        path.roulette_scale /= split_factor;
        for index in 0..paths {
            sink.record(|| PathEvent::Branch { index });
            let (mut path, sampler) = (*path, sampler.split(index, paths));
            if self.scatter(&mut path, point, lights, &sampler, limits, sink) {
                self.extend(&mut path, &sampler, PathLimits { split_factor: 1, ..limits }, sink);
            }
        }
    }

    /// Continues with both reflection and transmission at clear glass.
    pub fn split_dielectric(
        &mut self,
        path: &PathState,
        point: &ShadingPoint<'_>,
        reflectance: f32,
        sampler: &Sampler,
        limits: PathLimits,
        sink: &mut impl RadianceSink,
    ) {
        sink.record(|| PathEvent::DielectricSplit { reflectance });
        for (index, (lobe_choice, part)) in [(0.0, reflectance), (BELOW_ONE, 1.0 - reflectance)].into_iter().enumerate()
        {
            sink.record(|| PathEvent::Branch { index: index as u32 });
            let split_factor = if part < MIN_SPLIT_THROUGHPUT { 1 } else { limits.split_factor };
            let mut path = *path;
            path.throughput *= part;
            path.roulette_scale *= part;
            let point = &ShadingPoint { lobe_choice: Some(lobe_choice), ..*point };
            if part > 0.0 && self.scatter(&mut path, point, LightSampling::Skip, sampler, limits, sink) {
                self.extend(&mut path, sampler, PathLimits { split_factor, ..limits }, sink);
            }
        }
    }
}

//! The split of a path: into several from the first non-specular surface, or into reflection and transmission.

use super::bsdf::{Bsdf, BsdfNumbers, BsdfSample, BsdfSampleLanes};
use super::events::PathEvent;
use super::limits::PathLimits;
use super::path_tracer::{PathState, PathTracer, ShadingPoint};
use super::sampler::{self, Dimensions, Sampler};
use super::sink::RadianceSink;
use crate::math::simd::LANES;
use glam::Vec2;

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
        let samples_each = !self.samples_all_lights(path);
        if samples_each {
            importances = self.light_importances(point);
        } else {
            let set = sampler.set(Dimensions::Light { slot: 0, depth: path.depth });
            self.sample_lights(path, point, sampler, &set, split_factor, sink);
        }
        let paths_per_light_sample = if samples_each { 1.0 } else { split_factor };

        // Sample the BSDF for all paths
        let samples = SplitSamples::new(point.bsdf, path.depth, sampler, paths);

        // Divide the throughput among the paths
        let point = &ShadingPoint { importances: importances.as_ref(), ..*point };
        path.throughput /= split_factor;
        path.roulette_scale /= split_factor;
        for index in 0..paths {
            sink.record(|| PathEvent::Branch { index });
            let (mut path, sampler) = (*path, sampler.split(index, paths));
            if samples_each {
                let set = sampler.set(Dimensions::Light { slot: 0, depth: path.depth });
                self.sample_lights(&path, point, &sampler, &set, 1.0, sink);
            }
            let sample = (&samples.sample(point.bsdf, index), samples.roulette[index as usize]);
            if self.leave_along(&mut path, point, paths_per_light_sample, sample, limits, sink) {
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
            // No lobe can use light samples
            let set = sampler.set(Dimensions::Bsdf { depth: path.depth });
            if part > 0.0 && self.leave(&mut path, point, 1.0, &set, limits, sink) {
                self.extend(&mut path, sampler, PathLimits { split_factor, ..limits }, sink);
            }
        }
    }
}

/// The samples of a BSDF with which several paths leave a vertex.
struct SplitSamples {
    numbers: BsdfNumbers,
    /// Random numbers of the paths' Russian roulette.
    roulette: [f32; LANES],
    /// The samples, if they could be made at once.
    lanes: Option<BsdfSampleLanes>,
}

impl SplitSamples {
    /// Samples the BSDF for so many paths from a vertex of this depth.
    fn new(bsdf: &Bsdf<'_>, depth: u32, sampler: &Sampler, paths: u32) -> Self {
        let mut numbers = BsdfNumbers { lobe: [0.0; LANES], u: [[0.0; LANES]; 2] };
        let mut roulette = [0.0; LANES];
        let dimensions = Dimensions::Bsdf { depth };
        for index in (0..paths).step_by(2) {
            let [first, second] = [index, index + 1].map(|index| sampler.split(index, paths));
            for (lane, set) in (index as usize..LANES).zip(first.pair_with(dimensions, &second, dimensions)) {
                let u = sampler::first_pair(&set);
                (numbers.u[0][lane], numbers.u[1][lane]) = (u.x, u.y);
                [numbers.lobe[lane], roulette[lane]] = sampler::last_pair(&set);
            }
        }
        let lanes = bsdf.sample_lanes(&numbers);
        SplitSamples { numbers, roulette, lanes }
    }

    /// Returns the sample of a path; none for one that contributes nothing.
    fn sample(&self, bsdf: &Bsdf<'_>, path: u32) -> Option<BsdfSample> {
        let lane = path as usize;
        match &self.lanes {
            Some(lanes) => lanes.lane(lane),
            None => {
                let BsdfNumbers { lobe, u } = &self.numbers;
                bsdf.sample(lobe[lane], Vec2::new(u[0][lane], u[1][lane]))
            }
        }
    }
}

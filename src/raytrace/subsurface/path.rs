//! The continuation of paths under the surface.
//!
//! Walks have weights of their own, which would be noise. The weight of the same walk in a half-space has a known mean,
//! the base colour. Times the direct light at the entry, the difference between mean and weight is a control variate
//! (Glasserman 2003, "Monte Carlo Methods in Financial Engineering", section 4.1): it is zero on average, and cancels the
//! noise where the light at the exit is about that at the entry. Samples may be negative; films show negative means
//! black.

use super::medium::Medium;
use super::walk::{Walk, WalkEnd, WalkPair};
use crate::raytrace::bsdf::Bsdf;
use crate::raytrace::events::{PathEnd, PathEvent};
use crate::raytrace::limits::PathLimits;
use crate::raytrace::path_tracer::{PathState, PathTracer, ShadingPoint, SoftPoint};
use crate::raytrace::sampler::{self, Dimensions, Sampler};
use crate::raytrace::simd;
use crate::raytrace::sink::RadianceSink;
use glam::Vec3;

impl PathTracer<'_> {
    /// Continues at a soft surface with so many paths, each reflected by the coat or under the surface. Returns true if
    /// `path` is to be extended: several paths are extended here.
    pub fn scatter_soft(
        &mut self,
        path: &mut PathState,
        soft: SoftPoint<'_>,
        paths: u32,
        sampler: &Sampler,
        limits: PathLimits,
        sink: &mut impl RadianceSink,
    ) -> bool {
        let medium = self.medium_at(soft);
        if paths == 1 {
            return self.continue_alone(path, soft, &medium, sampler, limits, sink);
        }
        sink.record(|| PathEvent::PathSplit { paths });
        let split_factor = paths as f32;
        let samplers: Vec<Sampler> = (0..paths).map(|index| sampler.split(index, paths)).collect();
        let limits = PathLimits { split_factor: 1, ..limits };

        // Where all lights are sampled, walk along all paths first: one light sample at the entry serves all of them
        let walks_first = self.samples_all_lights(path);
        let (mut walks, mut importances) = (Vec::new(), None);
        if walks_first {
            walks.extend(samplers.iter().map(|sampler| self.sample_walk(path.depth, soft, &medium, sampler)));
            self.sample_entry_lights(path, soft, &walks, sampler, sink);
        } else {
            importances = self.light_importances(soft.point);
        }

        // Divide the throughput among the paths
        let soft = SoftPoint { point: &ShadingPoint { importances: importances.as_ref(), ..*soft.point }, ..soft };
        path.throughput /= split_factor;
        path.roulette_scale /= split_factor;
        for (index, own) in samplers.iter().enumerate() {
            sink.record(|| PathEvent::Branch { index: index as u32 });
            let mut path = *path;
            let goes_on = match walks.get(index) {
                Some(walk) => self.continue_soft(&mut path, soft, walk, split_factor, (own, sampler), limits, sink),
                None => self.continue_alone(&mut path, soft, &medium, own, limits, sink),
            };
            if goes_on {
                self.extend(&mut path, own, limits, sink);
            }
        }
        false
    }

    /// Continues one path, with light samples of its own.
    fn continue_alone(
        &mut self,
        path: &mut PathState,
        soft: SoftPoint<'_>,
        medium: &Medium,
        sampler: &Sampler,
        limits: PathLimits,
        sink: &mut impl RadianceSink,
    ) -> bool {
        let walk = self.sample_walk(path.depth, soft, medium, sampler);
        self.sample_entry_lights(path, soft, &[walk], sampler, sink);
        self.continue_soft(path, soft, &walk, 1.0, (sampler, sampler), limits, sink)
    }

    /// Returns the medium under a soft surface.
    fn medium_at(&self, soft: SoftPoint<'_>) -> Medium {
        let material = &self.caster.scene.materials[soft.point.surface.material as usize];
        Medium::new(material.extinction_per_m().unwrap_or(Vec3::ONE), soft.bsdf.base_color())
    }

    /// Samples a lobe at a soft surface, and a walk if it is that under the surface.
    fn sample_walk(&mut self, depth: u32, soft: SoftPoint<'_>, medium: &Medium, sampler: &Sampler) -> Option<WalkPair> {
        let scene = self.caster.scene;
        let [lobe, _] = sampler::last_pair(&sampler.set(Dimensions::Bsdf { depth }));
        if !soft.bsdf.samples_walk(lobe) {
            return None;
        }
        let (set, numbers) = sampler.set_and_stream(Dimensions::Subsurface { depth });
        let pair = simd::dispatch(Walk {
            instance: &scene.aggregate.instances()[soft.point.hit.instance as usize],
            materials: &scene.materials,
            medium,
            entry: soft.point.surface,
            set,
            numbers,
            stack: &mut self.caster.stack,
        });
        self.caster.rays += u64::from(pair.rays);
        Some(pair)
    }

    /// Samples the lights where walks enter: for the coat, and for the control variate.
    fn sample_entry_lights(
        &mut self,
        path: &PathState,
        soft: SoftPoint<'_>,
        walks: &[Option<WalkPair>],
        sampler: &Sampler,
        sink: &mut impl RadianceSink,
    ) {
        let paths = walks.len() as f32;
        let sum: Vec3 = walks.iter().flatten().map(|walk| walk.flat_weight).sum();
        let residual = soft.bsdf.base_color() - sum / (paths * soft.bsdf.walk_probability());
        let control = Bsdf::Surface(soft.bsdf.with_diffuse_base(residual));
        let point = ShadingPoint { control: Some(&control), ..*soft.point };
        let set = sampler.set(Dimensions::Light { slot: 0, depth: path.depth });
        self.sample_lights(path, &point, sampler, &set, paths, sink);
    }

    /// Continues one of the paths that share a light sample, by the coat or from the end of its walk. There, lights are
    /// sampled with the numbers of `light_sampler`: those of the entry. Returns false if the path ends.
    #[expect(clippy::too_many_arguments, reason = "those of `leave`, the walk and the numbers for lights")]
    fn continue_soft(
        &mut self,
        path: &mut PathState,
        soft: SoftPoint<'_>,
        walk: &Option<WalkPair>,
        paths_per_light_sample: f32,
        (sampler, light_sampler): (&Sampler, &Sampler),
        limits: PathLimits,
        sink: &mut impl RadianceSink,
    ) -> bool {
        let depth = path.depth;
        let bsdf_set = sampler.set(Dimensions::Bsdf { depth });
        let Some(walk) = walk else {
            return self.leave(path, soft.point, paths_per_light_sample, &bsdf_set, limits, sink);
        };
        let Some(WalkEnd { surface, weight, is_entry }) = walk.end else {
            sink.record(|| PathEvent::End(PathEnd::Absorbed));
            return false;
        };

        // Update the throughput
        path.throughput *= weight * (soft.bsdf.coat_transmission() / soft.bsdf.walk_probability());
        sink.record(|| PathEvent::Subsurface {
            position: surface.position,
            rays: walk.rays,
            at_entry: is_entry,
            weight,
            throughput: path.throughput,
        });

        // Gather photons and sample the lights at the exit, for this path alone
        let material = &self.caster.scene.materials[surface.material as usize];
        let bsdf = Bsdf::at_exit(material, surface.relief_normal, surface.geometric_normal);
        let point = ShadingPoint { surface: &surface, bsdf: &bsdf, importances: None, control: None, ..*soft.point };
        path.split_factor = 1.0;
        self.gather_photons(path, &surface, &bsdf, limits, sink);
        let light_set = light_sampler.set(Dimensions::Light { slot: 0, depth });
        self.sample_lights(path, &point, light_sampler, &light_set, 1.0, sink);
        self.leave(path, &point, 1.0, &bsdf_set, limits, sink)
    }
}

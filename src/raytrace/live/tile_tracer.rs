//! Traces the refinement steps of live tiles.

use super::camera::LiveCamera;
use super::history::ReprojectionHistory;
use super::live_tile::{ConvergenceTarget, LiveTile};
use super::primary_hit::PrimaryHit;
use super::refinement::RefinementStep;
use crate::color::luminance;
use crate::math::Ray;
use crate::raytrace::RenderControl;
use crate::raytrace::caustics::PhotonMap;
use crate::raytrace::film::{LayerSums, MAX_LIGHT_LAYERS, NonFiniteGate};
use crate::raytrace::lens::camera_ray;
use crate::raytrace::lights::TracedLight;
use crate::raytrace::limits::PathLimits;
use crate::raytrace::path_tracer::PathTracer;
use crate::raytrace::pixel_sampler::PixelSampler;
use crate::raytrace::render_scene::RenderScene;
use crate::raytrace::sampler::{SampleId, Sampler};
use crate::raytrace::settings::Method;
use crate::raytrace::sink::RadianceSink;
use glam::{Vec3, Vec4};

/// Largest number of layers: one per light, and emissive surfaces.
const MAX_LAYERS: usize = MAX_LIGHT_LAYERS + 1;
/// Seed of all live views.
const SEED: u32 = 0;

/// The scene, the view and the layers of a refinement step.
#[derive(Clone, Copy, Debug)]
pub struct RefinementContext<'a> {
    /// The scene that is traced: all lights, or the retraced ones alone.
    pub scene: &'a RenderScene,
    /// The film's layer of each of the scene's; `None` for layers that are not needed.
    pub film_layers: &'a [Option<usize>],
    /// Seconds for which each of the film's layers counts in the exposure.
    pub layer_times: &'a [f32],
    /// The view.
    pub camera: &'a LiveCamera,
    /// The scene's photons.
    pub photons: Option<&'a PhotonMap>,
    /// The picture from before the camera moved.
    pub history: Option<&'a ReprojectionHistory>,
    /// Noise at which a tile takes no more samples, stops.
    pub noise_stops: f32,
    /// Cancels the work and counts rays.
    pub control: &'a RenderControl,
}

/// Traces the next step of a tile. A cancelled step leaves the tile as it was or partly done; tracing it again
/// completes it.
pub fn refine(tile: &mut LiveTile, context: &RefinementContext<'_>) {
    if context.control.is_cancelled() {
        return;
    }
    let is_retracing = tile.progress.is_retracing();
    let mut tracer = TileTracer::new(context);
    match RefinementStep::after(tile.progress.completed()) {
        RefinementStep::Paths { stride } => tile.grid(stride).for_each(|pixel| tracer.trace_if_empty(tile, pixel)),
        RefinementStep::PrimaryHits { .. } if is_retracing => {}
        RefinementStep::PrimaryHits { stride } => tile.grid(stride).for_each(|pixel| tracer.find_hit(tile, pixel)),
        RefinementStep::SamplePass { sample } => tracer.trace_pass(tile, sample, is_retracing),
    }
    context.control.count(tracer.sampler.tracer.caster.rays, tracer.paths);
    let RefinementContext { scene, layer_times, noise_stops, .. } = *context;
    tile.finish_step(is_retracing, &ConvergenceTarget { noise_stops, exposure: scene.exposure, layer_times });
}

/// A path tracer that writes to live tiles.
struct TileTracer<'a> {
    context: &'a RefinementContext<'a>,
    sampler: PixelSampler<'a, LiveCamera>,
    /// The film's layers that a path adds to.
    layers: Vec<usize>,
    paths: u64,
}

impl<'a> TileTracer<'a> {
    fn new(context: &'a RefinementContext<'a>) -> Self {
        let depth = context.scene.plan().max_depth;
        TileTracer {
            context,
            sampler: PixelSampler {
                tracer: PathTracer::new(context.scene, context.photons),
                camera: context.camera,
                method: Method::Path,
                limits: PathLimits { max_non_specular_depth: depth, max_depth: depth, split_factor: 1 },
            },
            layers: context.film_layers.iter().filter_map(|layer| *layer).collect(),
            paths: 0,
        }
    }

    /// Traces the first path of a pixel that has neither a sample nor a value from the history.
    fn trace_if_empty(&mut self, tile: &mut LiveTile, pixel: usize) {
        let Some(&layer) = self.layers.first() else { return };
        self.find_hit(tile, pixel);
        if tile.sums.at(layer, pixel).w <= 0.0 {
            self.trace_sample(tile, pixel, 0);
        }
    }

    /// Finds the primary hit of a pixel, and takes its value from the history.
    fn find_hit(&mut self, tile: &mut LiveTile, pixel: usize) {
        if tile.primary_hits[pixel].is_traced() {
            return;
        }
        let hit = self.primary_hit(tile.position(pixel));
        tile.primary_hits[pixel] = hit;
        let Some(history) = self.context.history else { return };
        let mut values = [Vec4::ZERO; MAX_LAYERS];
        let values = &mut values[..tile.sums.layers().len()];
        if history.reproject(&hit, self.context.camera.eye(), values) {
            tile.reprojected += 1;
            for (layer, value) in values.iter().enumerate() {
                tile.sums.set(layer, pixel, *value);
            }
        }
    }

    /// Traces one sample of every pixel.
    fn trace_pass(&mut self, tile: &mut LiveTile, sample: u32, is_retracing: bool) {
        tile.begin_sample_pass(is_retracing);
        tile.blocks.begin_pass();
        for pixel in 0..tile.pixels() {
            let exposed = self.trace_sample(tile, pixel, sample);
            tile.blocks.add(pixel, exposed);
        }
        tile.blocks.finish_pass(1);
    }

    /// Traces one sample of a pixel; returns its exposed luminance.
    fn trace_sample(&mut self, tile: &mut LiveTile, pixel: usize, sample: u32) -> f32 {
        let context = self.context;
        let (x, y) = tile.position(pixel);
        let id = SampleId { x, y, index: sample, seed: SEED };
        for layer in &self.layers {
            tile.sums.add(*layer, pixel, Vec4::W);
        }
        let sink = LiveSink { sums: &mut tile.sums, pixel, context, luminance: 0.0 };
        let mut gate = NonFiniteGate { sink, sample: id, report: &mut tile.nonfinite };
        // The first sample does not split: it is to be shown soon. Later ones share the way to the first surface.
        self.sampler.limits.split_factor = if sample == 0 { 1 } else { context.scene.plan().split_factor };
        self.sampler.sample(id, &mut gate);
        self.paths += 1;
        gate.sink.luminance * context.scene.exposure
    }

    /// Intersects the primary ray of a pixel's first sample.
    fn primary_hit(&mut self, (x, y): (u32, u32)) -> PrimaryHit {
        let scene = self.context.scene;
        let (origin, direction) = camera_ray(self.context.camera, &Sampler::new(x, y, 0, SEED));
        let ray = Ray { origin, direction, t_max: f32::INFINITY };
        let Some(hit) = self.sampler.tracer.caster.intersect_from_camera(&ray) else {
            return PrimaryHit::BACKGROUND;
        };
        let surface = scene.surface(&ray, &hit);
        let material = &scene.materials[surface.material as usize];
        let is_in_front =
            |light: &TracedLight| light.intersect(origin, direction).is_some_and(|emitter| emitter.distance < hit.t);
        let shows_emitter = || scene.lights.iter().any(|light| light.is_seen() && is_in_front(light));
        let is_view_dependent = material.transmits() || shows_emitter();
        PrimaryHit {
            position: surface.position,
            normal: surface.facing_normal(direction),
            object: scene.aggregate.instances()[hit.instance as usize].object,
            material: surface.material,
            alpha: if is_view_dependent { PrimaryHit::VIEW_DEPENDENT } else { scene.material_point(&surface).alpha },
            texture: scene.texture_value(&surface),
        }
    }
}

/// Adds the contributions of one sample to a pixel, in the film's layers.
struct LiveSink<'a> {
    sums: &'a mut LayerSums<Vec4>,
    pixel: usize,
    context: &'a RefinementContext<'a>,
    /// Time-integrated luminance of the sample, cd s/m2.
    luminance: f32,
}

impl RadianceSink for LiveSink<'_> {
    fn add(&mut self, layer: usize, value: Vec3) {
        let Some(film_layer) = self.context.film_layers.get(layer).copied().flatten() else { return };
        self.sums.add(film_layer, self.pixel, value.extend(0.0));
        self.luminance += luminance(value) * self.context.scene.layer_times[layer];
    }
}

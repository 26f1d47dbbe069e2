//! The render loop: sample passes over the tiles of a film.

use super::control::RenderControl;
use super::film::{Film, FilmTile};
use super::lens::FilmCamera;
use super::limits::PathLimits;
use super::noise_target::NoiseTarget;
use super::passes::{self, PassSchedule, SharedLight, SharedLightTracer};
use super::pixel_sampler::PixelSampler;
use super::render_scene::RenderScene;
use super::sample_pass::SamplePass;
use super::sampler::{SampleId, Sampler};
use super::settings::Settings;
use rayon::prelude::*;
use std::ops::ControlFlow;
use std::sync::Arc;

/// Returns the film of a render before its first sample.
pub fn empty_film(scene: &RenderScene, settings: &Settings) -> Film {
    Film::new(settings, scene.layers.clone(), passes::approximations(scene, settings))
}

/// Renders on rayon's current pool. After each pass `on_pass` receives the film and may end the render; a clone of the
/// film is a cheap snapshot. With [`Settings::noise_stops`], tiles below that noise take no more samples. A cancelled
/// render keeps each tile's complete passes; before the first pass is complete, the film has 0 samples.
pub fn render(
    scene: &RenderScene,
    settings: &Settings,
    control: &RenderControl,
    on_pass: &mut dyn FnMut(&Film) -> ControlFlow<()>,
) -> Film {
    resume(scene, settings, empty_film(scene, settings), control, on_pass)
}

/// Goes on with a film as [`render`] has it after a pass, to the same bits as one render from the beginning.
pub fn resume(
    scene: &RenderScene,
    settings: &Settings,
    mut film: Film,
    control: &RenderControl,
    on_pass: &mut dyn FnMut(&Film) -> ControlFlow<()>,
) -> Film {
    let camera = scene.lens.film_camera(settings.width, settings.height);
    let light_tracer = SharedLightTracer::new(scene, settings, film.approximations(), control);
    let target = NoiseTarget::of(settings);
    // Each pass adds samples to the noisiest tile.
    let taken = film.most_spp();
    for pass in PassSchedule::new(scene, settings).passes().skip_while(|pass| pass.first_sample < taken) {
        let shared_light = &light_tracer.trace(pass, control);
        let job = TileJob { scene, shared_light, camera: &camera, settings, control, pass };
        let needs_samples = |tile: &&mut Arc<FilmTile>| target.is_none_or(|target| !target.is_met(tile));
        let mut noisy: Vec<&mut Arc<FilmTile>> = film.tiles_mut().iter_mut().filter(needs_samples).collect();
        if noisy.is_empty() || !noisy.par_iter_mut().with_max_len(1).all(|tile| job.run(Arc::make_mut(tile))) {
            break;
        }
        if on_pass(&film).is_break() {
            break;
        }
    }
    film
}

/// A pass of one tile.
pub(super) struct TileJob<'a> {
    pub scene: &'a RenderScene,
    pub shared_light: &'a SharedLight,
    pub camera: &'a FilmCamera,
    pub settings: &'a Settings,
    pub control: &'a RenderControl,
    pub pass: SamplePass,
}

impl TileJob<'_> {
    /// Adds the pass to the tile. Returns false if the render is cancelled.
    pub fn run(&self, tile: &mut FilmTile) -> bool {
        if self.control.is_cancelled() {
            return false;
        }
        tile.blocks.begin_pass();
        let mut bands = tile.bands();
        bands.par_iter_mut().with_max_len(1).for_each(|band| self.trace(band));
        tile.set_bands(&bands);
        tile.blocks.finish_pass(self.pass.samples);
        true
    }

    /// Traces the samples of a band of a tile.
    fn trace(&self, band: &mut FilmTile) {
        let Settings { method, max_depth, seed, .. } = *self.settings;
        let SamplePass { first_sample, samples } = self.pass;
        let view_axis = self.camera.forward();
        let limits = PathLimits::new(method, self.scene.plan(), max_depth);
        let in_moment = |scene| {
            let tracer = self.shared_light.tracer(scene);
            PixelSampler { tracer, camera: self.camera, method, limits }
        };
        let mut pixel_samplers: Vec<_> = self.scene.moments().iter().map(in_moment).collect();
        for pixel in 0..band.pixels() {
            let (x, y) = band.position(pixel);
            for index in first_sample..first_sample + samples {
                let sample = SampleId { x, y, index, seed };
                let mut gate = band.sample_sink(pixel, sample, &self.scene.layer_times, view_axis);
                let moment = self.scene.moment_of(&Sampler::of(sample));
                pixel_samplers[moment].sample(sample, &mut gate);
                let luminance = gate.sink.luminance * self.scene.exposure;
                band.blocks.add(pixel, luminance);
            }
        }
        band.rays = pixel_samplers.iter().map(|sampler| sampler.tracer.caster.rays).sum();
        band.traced_samples = band.pixels() as u64 * u64::from(samples);
        self.control.count(band.rays, band.traced_samples);
    }
}

//! The render loop: sample passes over the tiles of a film.

use super::coarse::{CoarseFilm, CoarseGrid, PassPixels};
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
    film: Film,
    control: &RenderControl,
    on_pass: &mut dyn FnMut(&Film) -> ControlFlow<()>,
) -> Film {
    trace_passes(scene, settings, film, None, control, &mut |traced| match traced {
        TracedFilm::Pass(film) => on_pass(film),
        TracedFilm::Coarse(_) => ControlFlow::Continue(()),
    })
}

/// A film that has been traced.
#[derive(Clone, Copy, Debug)]
pub enum TracedFilm<'a> {
    /// The coarse version of a large picture, with one sample a pixel.
    Coarse(&'a Film),
    /// The picture after a pass.
    Pass(&'a Film),
}

/// As [`resume`], but a large picture without samples shows its coarse version first, whose samples are its own.
pub fn resume_coarse_first(
    scene: &RenderScene,
    settings: &Settings,
    film: Film,
    control: &RenderControl,
    observe: &mut dyn FnMut(TracedFilm<'_>) -> ControlFlow<()>,
) -> Film {
    trace_passes(scene, settings, film, CoarseGrid::of(settings), control, observe)
}

/// Traces the passes that a film lacks; before the first one the coarse version, if there is a grid for it.
fn trace_passes(
    scene: &RenderScene,
    settings: &Settings,
    mut film: Film,
    grid: Option<CoarseGrid>,
    control: &RenderControl,
    observe: &mut dyn FnMut(TracedFilm<'_>) -> ControlFlow<()>,
) -> Film {
    let camera = scene.lens.film_camera(settings.width, settings.height);
    let light_tracer = SharedLightTracer::new(scene, settings, film.approximations(), control);
    let target = NoiseTarget::of(settings);
    // Each pass adds samples to the noisiest tile.
    let taken = film.most_spp();
    for pass in PassSchedule::new(scene, settings).passes().skip_while(|pass| pass.first_sample < taken) {
        let shared_light = &light_tracer.trace(pass, control);
        let job = TileJob { scene, shared_light, camera: &camera, settings, control, pass, pixels: PassPixels::All };

        // Trace the coarse version of the picture before all its pixels
        let coarse_film = grid.filter(|_| pass.first_sample == 0).and_then(|grid| job.trace_coarse(grid, &film));
        let coarse = grid.zip(coarse_film.as_ref()).map(|(grid, film)| CoarseFilm { grid, film });
        if coarse.is_some_and(|coarse| observe(TracedFilm::Coarse(coarse.film)).is_break()) {
            break;
        }
        let job = TileJob { pixels: coarse.map_or(PassPixels::All, PassPixels::Rest), ..job };

        let needs_samples = |tile: &&mut Arc<FilmTile>| target.is_none_or(|target| !target.is_met(tile));
        let mut noisy: Vec<&mut Arc<FilmTile>> = film.tiles_mut().iter_mut().filter(needs_samples).collect();
        if noisy.is_empty() || !job.run_all(&mut noisy) {
            break;
        }
        if let Some(coarse) = coarse {
            film.report_nonfinite(&coarse.film.nonfinite());
        }
        if observe(TracedFilm::Pass(&film)).is_break() {
            break;
        }
    }
    film
}

/// A pass of one tile.
#[derive(Clone, Copy)]
pub(super) struct TileJob<'a> {
    pub scene: &'a RenderScene,
    pub shared_light: &'a SharedLight,
    pub camera: &'a FilmCamera,
    pub settings: &'a Settings,
    pub control: &'a RenderControl,
    pub pass: SamplePass,
    pub pixels: PassPixels<'a>,
}

impl TileJob<'_> {
    /// Returns the coarse version on a grid of a picture; none if the render is cancelled.
    fn trace_coarse(&self, grid: CoarseGrid, picture: &Film) -> Option<Film> {
        let layers = self.scene.layers.clone();
        let mut film = Film::new(&grid.settings(self.settings), layers, picture.approximations());
        let mut tiles: Vec<_> = film.tiles_mut().iter_mut().collect();
        TileJob { pixels: PassPixels::Coarse(grid), ..*self }.run_all(&mut tiles).then_some(film)
    }

    /// Adds the pass to all tiles, unless the render is cancelled: then returns false.
    fn run_all(&self, tiles: &mut [&mut Arc<FilmTile>]) -> bool {
        tiles.par_iter_mut().with_max_len(1).all(|tile| self.run(Arc::make_mut(tile)))
    }

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
            let (x, y) = match self.pixels {
                PassPixels::Rest(coarse) if coarse.copy_to(band, pixel) => continue,
                PassPixels::All | PassPixels::Rest(_) => band.position(pixel),
                PassPixels::Coarse(grid) => grid.pixel(band.position(pixel)),
            };
            band.traced_samples += u64::from(samples);
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
        self.control.count(band.rays, band.traced_samples);
    }
}

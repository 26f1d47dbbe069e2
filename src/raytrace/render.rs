//! Waves of samples over all tiles, with snapshots, cancel and progress.

use super::caustics::{PhotonMap, USUAL_PHOTONS, Wave};
use super::control::RenderControl;
use super::film::{Film, FilmTile};
use super::path_tracer::{Limits, Tracer};
use super::prepare::RenderScene;
use super::sampler::{self, Purpose, Sampler};
use super::settings::{Method, Settings};
use crate::math::Ray;
use glam::{Vec2, Vec3};
use rayon::prelude::*;
use std::ops::ControlFlow;
use std::sync::Arc;

/// Waves grow 1, 1, 2, 4 ... up to this many samples.
const LARGEST_WAVE: u32 = 16;

/// Samples before a tile may be called quiet: fewer tell too little about its noise.
const JUDGED_FROM: u32 = 8;

/// Renders on rayon's current pool. After each wave `on_wave` sees the film so far and may stop the render. Where
/// [`Settings::noise_stops`] is set, tiles that are as quiet take no more samples. A cancelled render keeps every tile's
/// complete waves; before the first wave is complete, the film has 0 samples.
pub fn render(
    scene: &RenderScene,
    settings: &Settings,
    control: &RenderControl,
    on_wave: &mut dyn FnMut(&Film) -> ControlFlow<()>,
) -> Film {
    let photons = settings.takes_photons(scene);
    let mut film = Film::new(settings.width, settings.height, scene.layers(), settings.method, photons);
    let mut taken = 0;
    while taken < settings.spp {
        let wave = taken.clamp(1, settings.largest_wave(scene)).min(settings.spp - taken);
        let caustics = settings.caustics(scene, taken, wave, control);
        let job = TileJob { scene, caustics: caustics.as_ref(), settings, control, wave };
        let mut noisy: Vec<&mut Arc<FilmTile>> =
            film.tiles_mut().iter_mut().filter(|tile| !settings.is_quiet(tile)).collect();
        if noisy.is_empty() || !noisy.par_iter_mut().with_max_len(1).all(|tile| job.run(Arc::make_mut(tile))) {
            break;
        }
        taken += wave;
        if on_wave(&film).is_break() {
            break;
        }
    }
    film
}

impl Settings {
    fn takes_photons(&self, scene: &RenderScene) -> bool {
        scene.plan().photons && self.method != Method::Whitted
    }

    fn largest_wave(&self, scene: &RenderScene) -> u32 {
        let most = if self.takes_photons(scene) { Wave::most_samples(self.pixels()) } else { LARGEST_WAVE };
        most.min(LARGEST_WAVE)
    }

    /// The photons of a wave of samples, where any are of use.
    fn caustics(
        &self,
        scene: &RenderScene,
        first_sample: u32,
        samples: u32,
        control: &RenderControl,
    ) -> Option<PhotonMap> {
        let frame = scene.lens.frame(self.width as f32 / self.height as f32);
        let pixel_m = 2.0 * frame.half_extent.x / self.width as f32;
        let photons = USUAL_PHOTONS.max(self.pixels() * u64::from(samples));
        let wave = Wave { first_sample, samples, photons, pixel_m, eye: Vec3::ZERO, seed: self.seed };
        self.takes_photons(scene).then(|| PhotonMap::trace(scene, &wave, control))
    }

    /// Whether a tile needs no more samples.
    fn is_quiet(&self, tile: &FilmTile) -> bool {
        let within = |limit: f32| tile.noise_stops().is_none_or(|noise| noise <= limit);
        tile.spp() >= JUDGED_FROM && self.noise_stops.is_some_and(within)
    }
}

/// A wave's work on one tile.
struct TileJob<'a> {
    scene: &'a RenderScene,
    caustics: Option<&'a PhotonMap>,
    settings: &'a Settings,
    control: &'a RenderControl,
    wave: u32,
}

impl TileJob<'_> {
    fn run(&self, tile: &mut FilmTile) -> bool {
        if self.control.is_cancelled() {
            return false;
        }
        let (first_sample, half) = (tile.spp(), tile.halves.next_half());
        let mut tracer = Tracer::with_caustics(self.scene, self.caustics);
        let limits = limits(self.scene, self.settings);
        let size = Vec2::new(self.settings.width as f32, self.settings.height as f32);
        let frame = self.scene.lens.frame(size.x / size.y);
        for pixel in 0..tile.pixels() {
            let (x, y) = tile.position(pixel);
            for sample in first_sample..first_sample + self.wave {
                let sampler = Sampler::new(x, y, sample, self.settings.seed);
                let set = sampler.set(Purpose::Camera);
                let film_point = (Vec2::new(x as f32, y as f32) + sampler::point(&set)) / size;
                let (origin, direction) = self.scene.lens.ray(&frame, film_point, sampler::rest(&set).into());
                let mut gate = tile.sample_sink(pixel, sampler.id(), &self.scene.layer_times);
                match self.settings.method {
                    Method::Whitted => tracer.whitted(origin, direction, limits.all_bounces, &mut gate),
                    Method::Direct | Method::Path => tracer.trace(origin, direction, &sampler, limits, &mut gate),
                }
                let luminance = gate.sink.luminance * self.scene.exposure;
                tile.halves.add(half, pixel, luminance);
            }
        }
        tile.halves.finish_pass(half, self.wave);
        self.control.count(tracer.rays, tile.pixels() as u64 * u64::from(self.wave));
        true
    }
}

/// Mirrors and glass that Whitted's method follows: enough to look through a bottle and back.
const WHITTED_DEPTH: u32 = 10;

fn limits(scene: &RenderScene, settings: &Settings) -> Limits {
    let plan = scene.plan();
    match settings.method {
        Method::Whitted => {
            Limits { wide_bounces: 1, all_bounces: settings.max_depth.unwrap_or(WHITTED_DEPTH), branches: 1 }
        }
        Method::Direct => Limits {
            wide_bounces: 1,
            all_bounces: settings.max_depth.unwrap_or(plan.max_bounces.max(16)),
            // Without emitters to meet nothing lies beyond the first surface.
            branches: if plan.emitters_have_size { plan.branches } else { 1 },
        },
        Method::Path => {
            let depth = settings.max_depth.unwrap_or(plan.max_bounces);
            Limits { wide_bounces: depth, all_bounces: depth, branches: plan.branches }
        }
    }
}

/// Index into the scene's objects of what each pixel's centre shows; `u32::MAX` for the room and for nothing.
pub fn primary_objects(scene: &RenderScene, width: u32, height: u32) -> Vec<u32> {
    let frame = scene.lens.frame(width as f32 / height as f32);
    let at = |y: u32| {
        let mut tracer = Tracer::new(scene);
        (0..width)
            .map(|x| {
                let point = Vec2::new(x as f32 + 0.5, y as f32 + 0.5) / Vec2::new(width as f32, height as f32);
                let direction = frame.direction(point).normalize();
                let hit = tracer.closest(&Ray { origin: Vec3::ZERO, direction, t_max: f32::INFINITY });
                hit.map_or(u32::MAX, |hit| scene.aggregate.instances()[hit.instance as usize].object)
            })
            .collect::<Vec<u32>>()
    };
    (0..height).into_par_iter().flat_map_iter(at).collect()
}

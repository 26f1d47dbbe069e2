//! Waves of samples over all tiles, with snapshots, cancel and progress.

use super::caustics::{PhotonMap, USUAL_PHOTONS, Wave};
use super::film::{Film, TileFilm};
use super::path_tracer::{Limits, RadianceSink, Tracer};
use super::prepare::RenderScene;
use super::sampler::{self, Purpose, Sampler};
use crate::color::luminance;
use crate::math::Ray;
use glam::{Vec2, Vec3};
use rayon::prelude::*;
use std::ops::ControlFlow;
use std::sync::atomic::{AtomicBool, AtomicU64, Ordering};

/// How light is followed.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Default)]
pub enum Method {
    /// Phong lobes, hard shadows, mirrors and glass: Whitted's recursion, to compare with.
    Whitted,
    /// One scattering event: soft shadows and gloss, no bounce light. Mirrors and glass are passed through.
    Direct,
    /// Everything: the reference.
    #[default]
    Path,
}

/// What to render.
#[derive(Clone, Debug, PartialEq)]
pub struct Settings {
    /// Pixels across.
    pub width: u32,
    /// Pixels down.
    pub height: u32,
    /// How light is followed.
    pub method: Method,
    /// Samples a pixel at most.
    pub spp: u32,
    /// Bounces at most; none takes what the plan says.
    pub max_depth: Option<u32>,
    /// Another seed gives other noise.
    pub seed: u32,
    /// Stop where the estimated noise of a tile is under this many stops.
    pub noise_stops: Option<f32>,
}

impl Default for Settings {
    fn default() -> Self {
        Settings { width: 960, height: 640, method: Method::Path, spp: 64, max_depth: None, seed: 0, noise_stops: None }
    }
}

/// Pixels from which on a small picture comes first: the first wave of a large one takes its time.
const LARGE: u64 = 150_000;

impl Settings {
    /// One sample of a small version of a large picture, to be shown until the first wave is done.
    pub fn coarse(&self) -> Option<Settings> {
        let is_large = self.pixels() > LARGE;
        let small = |edge: u32| edge.div_ceil(4);
        is_large.then(|| Settings { width: small(self.width), height: small(self.height), spp: 1, ..self.clone() })
    }
}

/// Shared between a render and whoever watches it.
#[derive(Debug, Default)]
pub struct RenderControl {
    cancelled: AtomicBool,
    rays: AtomicU64,
    samples: AtomicU64,
}

impl RenderControl {
    /// A control that nobody has cancelled yet.
    pub fn new() -> Self {
        RenderControl::default()
    }

    /// Asks the render to stop; it ends within a tile's time.
    pub fn cancel(&self) {
        self.cancelled.store(true, Ordering::Relaxed);
    }

    /// Whether a stop was asked for.
    pub fn is_cancelled(&self) -> bool {
        self.cancelled.load(Ordering::Relaxed)
    }

    /// Rays traced so far.
    pub fn rays(&self) -> u64 {
        self.rays.load(Ordering::Relaxed)
    }

    /// Books work that was done.
    pub(super) fn count(&self, rays: u64, samples: u64) {
        self.rays.fetch_add(rays, Ordering::Relaxed);
        self.samples.fetch_add(samples, Ordering::Relaxed);
    }

    /// Pixel samples taken so far; `width * height * spp` when done.
    pub fn samples_done(&self) -> u64 {
        self.samples.load(Ordering::Relaxed)
    }
}

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
    let mut film = Film::new(settings.width, settings.height, scene.layers());
    (film.method, film.photons) = (settings.method, settings.takes_photons(scene));
    let mut taken = 0;
    while taken < settings.spp {
        let wave = taken.clamp(1, settings.largest_wave(scene)).min(settings.spp - taken);
        let caustics = settings.caustics(scene, taken, wave, control);
        let job = TileJob { scene, caustics: caustics.as_ref(), settings, control, wave };
        let mut noisy: Vec<&mut TileFilm> = film.tiles.iter_mut().filter(|tile| !settings.is_quiet(tile)).collect();
        if noisy.is_empty() || !noisy.par_iter_mut().with_max_len(1).all(|tile| job.run(tile)) {
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
    fn pixels(&self) -> u64 {
        u64::from(self.width) * u64::from(self.height)
    }

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
    fn is_quiet(&self, tile: &TileFilm) -> bool {
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
    fn run(&self, tile: &mut TileFilm) -> bool {
        if self.control.is_cancelled() {
            return false;
        }
        let (first_sample, half) = (tile.spp(), tile.next_half());
        let mut tracer = Tracer::with_caustics(self.scene, self.caustics);
        let limits = limits(self.scene, self.settings);
        let size = Vec2::new(self.settings.width as f32, self.settings.height as f32);
        let frame = self.scene.lens.frame(size.x / size.y);
        for pixel in 0..tile.pixels() {
            let (x, y) = (tile.x + pixel as u32 % tile.width, tile.y + pixel as u32 / tile.width);
            for sample in first_sample..first_sample + self.wave {
                let sampler = Sampler::new(x, y, sample, self.settings.seed);
                let set = sampler.set(Purpose::Camera);
                let film_point = (Vec2::new(x as f32, y as f32) + sampler::point(&set)) / size;
                let (origin, direction) = self.scene.lens.ray(&frame, film_point, sampler::rest(&set).into());
                let mut gate = Gate { tile, pixel, place: (x, y, sample), luminance: 0.0, scene: self.scene };
                match self.settings.method {
                    Method::Whitted => tracer.whitted(origin, direction, limits.all_bounces, &mut gate),
                    Method::Direct | Method::Path => tracer.trace(origin, direction, &sampler, limits, &mut gate),
                }
                let value = gate.luminance * self.scene.exposure;
                tile.add_luminance(half, pixel, value);
            }
        }
        tile.finish_wave(half, self.wave);
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

/// The one place where non-finite values are stopped: counted, reported with pixel and sample, shown black.
struct Gate<'a> {
    scene: &'a RenderScene,
    tile: &'a mut TileFilm,
    pixel: usize,
    place: (u32, u32, u32),
    luminance: f32,
}

impl RadianceSink for Gate<'_> {
    fn add(&mut self, layer: usize, value: Vec3) {
        if value.is_finite() {
            self.tile.add(layer, self.pixel, value);
            self.luminance += luminance(value) * self.scene.layer_times[layer];
        } else {
            let (x, y, sample) = self.place;
            self.tile.report_nonfinite(x, y, sample);
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

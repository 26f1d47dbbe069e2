//! One tile of a live picture: sums a layer, what its pixels show, and how far it is.
//!
//! A tile goes through [`Step`]s: a path at one pixel of 256, then of 64, then what every pixel shows (and what the
//! picture before the camera moved knows of it), then the pixels between, then wave after wave of samples.

use super::camera::LiveCamera;
use super::history::History;
use crate::color::luminance;
use crate::math::Ray;
use crate::raytrace::RenderControl;
use crate::raytrace::caustics::PhotonMap;
use crate::raytrace::film::{MAX_LIGHT_LAYERS, TILE};
use crate::raytrace::limits::PathLimits;
use crate::raytrace::path_tracer::PathTracer;
use crate::raytrace::render_scene::RenderScene;
use crate::raytrace::sampler::{self, Purpose, Sampler};
use crate::raytrace::sink::RadianceSink;
use glam::{Vec2, Vec3, Vec4};

/// Layers of a live picture at most: one a light, and the glow.
pub const MAX_LAYERS: usize = MAX_LIGHT_LAYERS + 1;

/// What lies behind a pixel. Positions are relative to the tracer's origin.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Shown {
    /// Where its first ray met a surface.
    pub position: Vec3,
    /// Of the surface there.
    pub normal: Vec3,
    /// Index into the scene's objects, `u32::MAX` for the room; [`Shown::UNKNOWN`] before anyone looked.
    pub object: u32,
    /// Index into the material table.
    pub material: u32,
    /// Width of the surface's gloss: while the view turns by less, what was seen is still about right. Negative for what
    /// another view says nothing of: glass, emitters, the void, edges.
    pub alpha: f32,
    /// What the texture multiplies the colour by there.
    pub texture: Vec3,
}

impl Shown {
    /// Nobody has looked yet.
    const UNKNOWN: u32 = u32::MAX - 2;
    /// The rays leave the studio.
    pub const NOTHING: u32 = u32::MAX - 1;
    /// The [`Shown::alpha`] of what is never taken over from another view.
    pub const NEVER: f32 = -1.0;

    const fn nothing(object: u32) -> Self {
        let (position, normal, texture) = (Vec3::ZERO, Vec3::ZERO, Vec3::ONE);
        Shown { position, normal, object, material: 0, alpha: Self::NEVER, texture }
    }

    /// What lies outside of a picture.
    pub const VOID: Self = Self::nothing(Self::NOTHING);

    /// Whether a ray has found what the pixel shows.
    pub fn is_known(&self) -> bool {
        self.object != Self::UNKNOWN
    }

    /// Whether two pixels show the same smooth surface: object, material, normal and depth agree. `scale` is
    /// their distance from the eye, metres, or less where the lens is long.
    pub fn agrees(&self, other: &Shown, scale: f32) -> bool {
        const COSINE: f32 = 0.9;
        const OFF_PLANE: f32 = 0.01;
        let aside = (other.position - self.position).dot(self.normal).abs();
        self.object == other.object
            && self.material == other.material
            && (self.object == Self::NOTHING || (self.normal.dot(other.normal) > COSINE && aside < OFF_PLANE * scale))
    }
}

/// What is done to a tile next.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Step {
    /// A path at each pixel of a grid that has none yet.
    Paths {
        /// Pixels between them.
        stride: u32,
    },
    /// What each pixel of a grid shows, and what is known of it from before.
    Surfaces {
        /// Pixels between them.
        stride: u32,
    },
    /// One more sample of every pixel.
    Wave {
        /// Which one, from 1.
        sample: u32,
    },
}

/// The steps until every pixel has a path.
const FIRST_STEPS: [Step; 8] = [
    Step::Paths { stride: 16 },
    Step::Paths { stride: 8 },
    Step::Surfaces { stride: 4 },
    Step::Surfaces { stride: 2 },
    Step::Surfaces { stride: 1 },
    Step::Paths { stride: 4 },
    Step::Paths { stride: 2 },
    Step::Paths { stride: 1 },
];

impl Step {
    /// The step after so many.
    pub fn after(steps: u32) -> Step {
        let first = FIRST_STEPS.get(steps as usize);
        first.copied().unwrap_or(Step::Wave { sample: (steps + 1).saturating_sub(FIRST_STEPS.len() as u32) })
    }

    /// Pixels between those that have a path after so many steps; none before the first.
    pub fn stride(steps: u32) -> Option<u32> {
        let done = &FIRST_STEPS[..FIRST_STEPS.len().min(steps as usize)];
        done.iter().rev().find_map(|step| match step {
            Step::Paths { stride } => Some(*stride),
            Step::Surfaces { .. } | Step::Wave { .. } => None,
        })
    }

    /// Samples that every pixel has after so many steps.
    pub fn samples(steps: u32) -> u32 {
        (steps + 1).saturating_sub(FIRST_STEPS.len() as u32)
    }

    /// About what it costs, in paths.
    pub fn cost(self, pixels: usize) -> u64 {
        let grid = |stride: u32| (pixels as u64).div_ceil(u64::from(stride * stride));
        match self {
            Step::Paths { stride } => grid(stride),
            Step::Surfaces { stride } => grid(stride).div_ceil(8),
            Step::Wave { .. } => pixels as u64,
        }
    }
}

/// Steps of a tile so far: all layers, and those that are behind because their lights changed.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Progress {
    /// Of the layers that nothing happened to.
    pub main: u32,
    /// Of the layers that are behind; never more than `main`.
    pub lagging: u32,
}

impl Progress {
    /// Whether some layers have to catch up.
    pub fn lags(self) -> bool {
        self.lagging < self.main
    }

    /// Steps of the layers that come next.
    pub fn next(self) -> u32 {
        self.main.min(self.lagging)
    }
}

/// What a step needs.
#[derive(Clone, Copy, Debug)]
pub struct Job<'a> {
    pub scene: &'a RenderScene,
    /// The picture's layer of each of the scene's; none for what is not wanted.
    pub layers: &'a [Option<usize>],
    /// Seconds for which the picture's layers count in the exposure.
    pub times: &'a [f32],
    pub camera: &'a LiveCamera,
    /// The scene's photons.
    pub caustics: Option<&'a PhotonMap>,
    pub history: Option<&'a History>,
    /// A tile is done when its noise is under this, stops.
    pub noise_stops: f32,
    pub control: &'a RenderControl,
}

/// Sums and progress.
#[derive(Clone, Debug)]
pub struct LiveTile {
    /// Left edge, pixels.
    pub x: u32,
    /// Upper edge, pixels.
    pub y: u32,
    /// Pixels across.
    pub width: u32,
    /// Pixels down.
    pub height: u32,
    /// Sum and, as w, its weight in samples; layer by layer, pixels in rows.
    pub sums: Vec<Vec4>,
    /// What each pixel shows.
    pub shown: Vec<Shown>,
    pub progress: Progress,
    /// Quiet, or sampled enough.
    done: bool,
    /// Sums of the exposed luminance of even and odd waves, and how many: their difference tells the noise.
    halves: [Vec<f32>; 2],
    waves: [u32; 2],
    /// Whether the halves are of the lagging layers alone.
    halves_lag: bool,
    /// Non-finite contributions that were dropped.
    pub nonfinite: u64,
    /// Pixels that took over what was known of them.
    pub reused: u32,
}

/// Waves of each half before the noise is judged.
const JUDGED_FROM: u32 = 4;
/// Samples a pixel after which a tile is left as it is.
const MOST_SAMPLES: u32 = 512;
/// All live pictures have the same noise.
const SEED: u32 = 0;

impl LiveTile {
    pub fn new(x: u32, y: u32, size: (u32, u32), layers: usize) -> Self {
        let (width, height) = (TILE.min(size.0 - x), TILE.min(size.1 - y));
        let pixels = (width * height) as usize;
        LiveTile {
            x,
            y,
            width,
            height,
            sums: vec![Vec4::ZERO; pixels * layers],
            shown: vec![Shown::nothing(Shown::UNKNOWN); pixels],
            progress: Progress::default(),
            done: false,
            halves: [vec![0.0; pixels], vec![0.0; pixels]],
            waves: [0; 2],
            halves_lag: false,
            nonfinite: 0,
            reused: 0,
        }
    }

    pub fn pixels(&self) -> usize {
        self.shown.len()
    }

    /// Whether there is something left to do.
    pub fn is_active(&self) -> bool {
        self.progress.lags() || !self.done
    }

    /// Goes on although it is quiet.
    #[cfg(test)]
    pub fn wake(&mut self) {
        self.done = false;
    }

    /// Sum and weight of a layer at a pixel.
    pub fn sum(&self, layer: usize, pixel: usize) -> Vec4 {
        self.sums[layer * self.pixels() + pixel]
    }

    /// As if nothing had happened yet.
    pub fn clear(&mut self) {
        self.sums.fill(Vec4::ZERO);
        self.shown.fill(Shown::nothing(Shown::UNKNOWN));
        self.measure_anew(false);
        (self.progress, self.done, self.nonfinite, self.reused) = (Progress::default(), false, 0, 0);
    }

    /// Takes layers over: each from where it was, or empty.
    pub fn remap(&mut self, from: &[Option<usize>]) {
        let pixels = self.pixels();
        let stays = |(layer, from): (usize, &Option<usize>)| from.is_none_or(|old| old == layer);
        if from.len() * pixels == self.sums.len() && from.iter().enumerate().all(stays) {
            for (sums, _) in self.sums.chunks_exact_mut(pixels).zip(from).filter(|(_, from)| from.is_none()) {
                sums.fill(Vec4::ZERO);
            }
        } else {
            let layer = |from: &Option<usize>| match from {
                Some(old) => self.sums[old * pixels..(old + 1) * pixels].to_vec(),
                None => vec![Vec4::ZERO; pixels],
            };
            self.sums = from.iter().flat_map(layer).collect();
        }
        if from.iter().any(Option::is_none) {
            self.progress.lagging = 0;
        }
        self.measure_anew(true);
    }

    /// Does the next step of the layers whose turn it is. A cancelled step leaves the tile as it was, or begun: doing it
    /// again does the rest.
    pub fn advance(&mut self, job: &Job<'_>) {
        if job.control.is_cancelled() {
            return;
        }
        let lags = self.progress.lags();
        let mut brush = Brush::new(job);
        match Step::after(self.progress.next()) {
            Step::Paths { stride } => self.grid(stride, |tile, pixel| tile.first_path(&mut brush, pixel)),
            Step::Surfaces { .. } if lags => {}
            Step::Surfaces { stride } => self.grid(stride, |tile, pixel| tile.look(&mut brush, pixel)),
            Step::Wave { sample } => self.wave(&mut brush, sample, lags),
        }
        job.control.count(brush.tracer.caster.rays, brush.paths);
        self.step_done(job, lags);
    }

    fn grid(&mut self, stride: u32, mut each: impl FnMut(&mut Self, usize)) {
        for y in (0..self.height).step_by(stride as usize) {
            for x in (0..self.width).step_by(stride as usize) {
                each(self, (y * self.width + x) as usize);
            }
        }
    }

    /// A path where there is no value yet, neither traced nor known from before.
    fn first_path(&mut self, brush: &mut Brush<'_>, pixel: usize) {
        let Some(&layer) = brush.layers.first() else { return };
        self.look(brush, pixel);
        if self.sum(layer, pixel).w <= 0.0 {
            brush.path(self, pixel, 0);
        }
    }

    /// Finds what a pixel shows, and takes over what is known of it.
    fn look(&mut self, brush: &mut Brush<'_>, pixel: usize) {
        if self.shown[pixel].is_known() {
            return;
        }
        let shown = brush.look(self.place(pixel));
        self.shown[pixel] = shown;
        let (Some(history), pixels) = (brush.job.history, self.pixels()) else { return };
        let mut known = [Vec4::ZERO; MAX_LAYERS];
        let known = &mut known[..self.sums.len() / pixels];
        if history.recall(&shown, brush.job.camera.eye(), known) {
            self.reused += 1;
            for (layer, value) in known.iter().enumerate() {
                self.sums[layer * pixels + pixel] = *value;
            }
        }
    }

    fn wave(&mut self, brush: &mut Brush<'_>, sample: u32, lags: bool) {
        if self.halves_lag != lags {
            self.measure_anew(lags);
        }
        let half = (sample & 1) as usize;
        for pixel in 0..self.pixels() {
            let exposed = brush.path(self, pixel, sample);
            self.halves[half][pixel] += exposed;
        }
        self.waves[half] += 1;
    }

    /// What the halves hold is of no use any more.
    fn measure_anew(&mut self, lags: bool) {
        self.halves.iter_mut().for_each(|half| half.fill(0.0));
        (self.waves, self.halves_lag) = ([0; 2], lags);
    }

    fn step_done(&mut self, job: &Job<'_>, lags: bool) {
        let quiet = self.waves.iter().all(|n| *n >= JUDGED_FROM)
            && self.noise_stops(job).is_none_or(|noise| noise <= job.noise_stops);
        let Progress { main, lagging } = &mut self.progress;
        if lags {
            *lagging = if quiet && self.halves_lag { *main } else { *lagging + 1 };
        } else {
            *main += 1;
            *lagging = *main;
            self.done = (quiet && !self.halves_lag) || Step::samples(*main) >= MOST_SAMPLES;
        }
    }

    /// Estimated noise of what the halves hold: root mean square error of the pixels over the mean brightness of the
    /// whole tile, in stops. None for tiles darker than eight stops under grey.
    fn noise_stops(&self, job: &Job<'_>) -> Option<f32> {
        let [a, b] = self.waves.map(|n| n as f32);
        let scale = a * b / ((a + b) * (a + b));
        let square = |(first, second): (&f32, &f32)| (first / a - second / b).powi(2) * scale;
        let sum: f32 = self.halves[0].iter().zip(&self.halves[1]).map(square).sum();
        let mean = self.mean_brightness(job);
        (mean > 0.18 / 256.0).then(|| (1.0 + (sum / self.pixels() as f32).sqrt() / mean).log2())
    }

    /// Mean exposed luminance of all layers.
    fn mean_brightness(&self, job: &Job<'_>) -> f32 {
        let pixels = self.pixels();
        let of_layer = |(layer, sums): (usize, &[Vec4])| {
            let mean = |sum: &Vec4| if sum.w > 0.0 { luminance(sum.truncate()) / sum.w } else { 0.0 };
            sums.iter().map(mean).sum::<f32>() * job.times[layer]
        };
        self.sums.chunks_exact(pixels).enumerate().map(of_layer).sum::<f32>() * job.scene.exposure / pixels as f32
    }

    /// Picture coordinates of a pixel.
    pub fn place(&self, pixel: usize) -> (u32, u32) {
        (self.x + pixel as u32 % self.width, self.y + pixel as u32 / self.width)
    }
}

/// What puts paths on a tile.
struct Brush<'a> {
    job: &'a Job<'a>,
    tracer: PathTracer<'a>,
    limits: PathLimits,
    /// The picture's layers that a path adds to.
    layers: Vec<usize>,
    paths: u64,
}

impl<'a> Brush<'a> {
    fn new(job: &'a Job<'a>) -> Self {
        let depth = job.scene.plan().max_depth;
        Brush {
            job,
            tracer: PathTracer::new(job.scene, job.caustics),
            limits: PathLimits { max_non_specular_depth: depth, max_depth: depth, split_factor: 1 },
            layers: job.layers.iter().filter_map(|layer| *layer).collect(),
            paths: 0,
        }
    }

    fn ray(&self, (x, y): (u32, u32), sampler: &Sampler) -> (Vec3, Vec3) {
        let set = sampler.set(Purpose::Camera);
        self.job.camera.ray(Vec2::new(x as f32, y as f32) + sampler::point(&set), sampler::rest(&set).into())
    }

    /// One sample of a pixel; returns its exposed luminance.
    fn path(&mut self, tile: &mut LiveTile, pixel: usize, sample: u32) -> f32 {
        let (x, y) = tile.place(pixel);
        let sampler = Sampler::new(x, y, sample, SEED);
        let (origin, direction) = self.ray((x, y), &sampler);
        let pixels = tile.pixels();
        for layer in &self.layers {
            tile.sums[layer * pixels + pixel].w += 1.0;
        }
        let mut gate = Gate { tile, pixel, job: self.job, luminance: 0.0 };
        // The first sample is soon there; those after it share the way to the surface, which is less noise for the time.
        let split_factor = if sample == 0 { 1 } else { self.job.scene.plan().split_factor };
        self.tracer.trace(origin, direction, &sampler, PathLimits { split_factor, ..self.limits }, &mut gate);
        self.paths += 1;
        gate.luminance * self.job.scene.exposure
    }

    /// What the first sample's ray meets.
    fn look(&mut self, (x, y): (u32, u32)) -> Shown {
        let scene = self.job.scene;
        let (origin, direction) = self.ray((x, y), &Sampler::new(x, y, 0, SEED));
        let Some(hit) = self.tracer.caster.intersect(&Ray { origin, direction, t_max: f32::INFINITY }) else {
            return Shown::nothing(Shown::NOTHING);
        };
        let surface = scene.aggregate.surface(&hit);
        let material = &scene.materials[surface.material as usize];
        let seen = |light: &crate::raytrace::lights::TracedLight| {
            light.intersect(origin, direction).is_some_and(|seen| seen.distance < hit.triangle.t)
        };
        let fixed = material.transmits() || scene.lights.iter().any(|light| light.visible_to_camera && seen(light));
        Shown {
            position: surface.position,
            normal: if surface.normal.dot(direction) > 0.0 { -surface.normal } else { surface.normal },
            object: scene.aggregate.instances()[hit.instance as usize].object,
            material: surface.material,
            alpha: if fixed { Shown::NEVER } else { material.alpha() },
            texture: material.texture.map_or(Vec3::ONE, |t| scene.textures[t as usize].at(surface.uv)),
        }
    }
}

/// The gate for non-finite values: counted, shown black.
struct Gate<'a> {
    tile: &'a mut LiveTile,
    pixel: usize,
    job: &'a Job<'a>,
    luminance: f32,
}

impl RadianceSink for Gate<'_> {
    fn add(&mut self, layer: usize, value: Vec3) {
        let Some(own) = self.job.layers.get(layer).copied().flatten() else { return };
        if value.is_finite() {
            let pixels = self.tile.pixels();
            self.tile.sums[own * pixels + self.pixel] += value.extend(0.0);
            self.luminance += luminance(value) * self.job.scene.layer_times[layer];
        } else {
            self.tile.nonfinite += 1;
        }
    }
}

//! Three estimates of one picture, and the t-tests between them.
//!
//! A picture is divided into 3 x 2 blocks. The whole picture and each block are tested in red, green and blue.
//!
//! - Brute force: independent samples, stratified by pixel, so that the standard error comes from each pixel's samples.
//!   A region that few of them light is left out ([`MIN_HITS`]): their mean is not normally distributed.
//! - Paths: renders without photons of several seeds. Their means of a block are independent.
//! - Photons: the same with photons. They share photons within a render, not between seeds. Photons are gathered
//!   within a radius of about two pixels, which moves light across edges of surfaces (an error proportional to the
//!   radius) and smooths what is curved (proportional to its square). The radius is proportional to the pixel:
//!   renders of half the size have twice the radius, hence at least twice the error, and the difference between the two
//!   is an upper bound of the error of the larger one. The test subtracts this measured bound from the difference.

use crate::brute_force::BruteForce;
use crate::studio::statistics::{SampleMean, TestRng, student_tails};
use catchlight::photo::Picture;
use catchlight::raytrace::{self, RenderControl, RenderScene, Settings, Shortcut};
use catchlight::scene::Scene;
use glam::{DVec3, Vec2};
use rayon::prelude::*;
use std::ops::ControlFlow;

/// Width over height of the pictures.
pub const ASPECT: f32 = 1.5;
/// Blocks of a picture, and the whole picture before them.
const COLUMNS: usize = 3;
const ROWS: usize = 2;
const REGIONS: usize = 1 + COLUMNS * ROWS;
/// Tests of one estimate: regions times colour channels.
pub const TESTS: usize = REGIONS * 3;
/// Size of brute-force pictures and of renders without photons.
const SMALL: (u32, u32) = (24, 16);
/// Size of renders with photons. Those that measure the blur have half of it.
const LARGE: (u32, u32) = (96, 64);

/// Relative error of the tracer that no number of samples reduces: single precision, and the bounces after which less
/// than 1/512 of the light is left, of which open scenes use few.
const BIAS: f64 = 5e-4;

/// Effective number of brute-force samples that light a region, (sum x)2 / sum x2, below which it is not tested. The
/// skewness of the mean is the inverse of its square root, and at five standard errors it multiplies the false-alarm
/// rate by less than 3.
const MIN_HITS: f64 = 400.0;

/// The work of a comparison.
#[derive(Clone, Copy, PartialEq, Eq)]
pub struct Effort {
    /// Brute-force samples of each of the small picture's pixels.
    pub brute_force_spp: u32,
    /// Renders of each kind.
    pub seeds: u32,
    pub paths_spp: u32,
    pub photons_spp: u32,
}

impl Effort {
    /// The effort for a scene in the gate.
    pub const GATE: Effort = Effort { brute_force_spp: 2400, seeds: 10, paths_spp: 24, photons_spp: 4 };

    /// Returns so many times the effort.
    pub fn times(self, factor: u32) -> Self {
        Effort { brute_force_spp: self.brute_force_spp * factor, seeds: self.seeds * factor, ..self }
    }
}

/// The mean value of a region in a channel.
#[derive(Clone, Copy, Debug)]
pub struct Estimate {
    pub mean: f64,
    pub standard_error: f64,
    /// Degrees of freedom of the standard error.
    degrees: f64,
    /// Effective number of samples that found light; infinite for renders.
    hits: f64,
}

/// The estimates of all regions, and the mean of each pixel of the small picture.
pub struct Measured {
    /// Channel by channel for each region, the whole picture first.
    pub regions: Vec<[Estimate; 3]>,
    pixels: Vec<DVec3>,
}

/// A tested difference between a render and brute force.
pub struct Difference {
    pub region: usize,
    pub channel: usize,
    pub ours: Estimate,
    pub expected: Estimate,
    /// Upper bound of the error that is known, the photons' blur included.
    pub bias: f64,
    pub p_value: f64,
    /// Pixel of the small picture with the largest difference in the region.
    pub pixel: (u32, u32),
}

impl Difference {
    /// Returns the relative difference.
    pub fn relative(&self) -> f64 {
        self.ours.mean / self.expected.mean - 1.0
    }

    /// Returns the relative error that the test would find, at a critical number of standard errors.
    pub fn resolution(&self, critical: f64) -> f64 {
        (critical * self.ours.standard_error.hypot(self.expected.standard_error) + self.bias) / self.expected.mean
    }
}

/// Returns the region's pixels of a picture of so many columns and rows.
fn pixels_of(region: usize, (width, height): (u32, u32)) -> impl Iterator<Item = (u32, u32)> {
    let (columns, rows) = match region.checked_sub(1) {
        None => (0..width, 0..height),
        Some(block) => {
            let (w, h) = (width / COLUMNS as u32, height / ROWS as u32);
            let (column, row) = ((block % COLUMNS) as u32, (block / COLUMNS) as u32);
            (column * w..(column + 1) * w, row * h..(row + 1) * h)
        }
    };
    rows.flat_map(move |y| columns.clone().map(move |x| (x, y)))
}

/// Estimates the picture by brute force.
pub fn brute_force(tracer: &BruteForce, spp: u32, seed: u64) -> Measured {
    let size = Vec2::new(SMALL.0 as f32, SMALL.1 as f32);
    let pixels: Vec<[SampleMean; 3]> = (0..SMALL.0 * SMALL.1)
        .into_par_iter()
        .map(|index| {
            let corner = Vec2::new((index % SMALL.0) as f32, (index / SMALL.0) as f32);
            let mut rng = TestRng::new(seed << 16 | u64::from(index));
            let samples: Vec<DVec3> =
                (0..spp).map(|_| tracer.sample((corner + rng.unit_square()) / size, &mut rng)).collect();
            [0, 1, 2].map(|channel| SampleMean::of(samples.iter().map(|sample| sample[channel])))
        })
        .collect();
    let region = |region| {
        let means: Vec<_> = pixels_of(region, SMALL).map(|(x, y)| pixels[(y * SMALL.0 + x) as usize]).collect();
        let n = means.len() as f64;
        [0, 1, 2].map(|channel| {
            let variances = || means.iter().map(|pixel| pixel[channel].standard_error.powi(2));
            // Welch 1947, as for a sum of pixels with standard errors of their own
            let fourth = variances().map(|variance| variance * variance / f64::from(spp - 1)).sum::<f64>();
            let variance: f64 = variances().sum();
            let sum = means.iter().map(|pixel| pixel[channel].mean).sum::<f64>();
            let squares = variances().sum::<f64>() * f64::from(spp - 1)
                + means.iter().map(|pixel| pixel[channel].mean.powi(2)).sum::<f64>();
            Estimate {
                mean: sum / n,
                hits: if squares > 0.0 { sum * sum / squares * f64::from(spp) } else { 0.0 },
                standard_error: variance.sqrt() / n,
                degrees: if fourth > 0.0 { variance * variance / fourth } else { 1.0 },
            }
        })
    };
    let regions = (0..REGIONS).map(region).collect();
    Measured { regions, pixels: pixels.iter().map(|p| DVec3::from(p.map(|channel| channel.mean))).collect() }
}

/// Renders a prepared scene with several seeds.
fn rendered(prepared: &RenderScene, scene: &Scene, (width, height): (u32, u32), spp: u32, seeds: u32) -> Measured {
    let pictures: Vec<Picture> = (0..seeds)
        .into_par_iter()
        .map(|seed| {
            let settings = Settings { width, height, spp, seed, ..Settings::default() };
            let film = raytrace::render(prepared, &settings, &RenderControl::new(), &mut |_| ControlFlow::Continue(()));
            assert_eq!(film.nonfinite().count, 0, "{:?}", film.nonfinite().first);
            film.develop(scene)
        })
        .collect();
    let value = |picture: &Picture, (x, y): (u32, u32)| picture.rgb[(y * width + x) as usize].map(f64::from);
    let region = |region| {
        let mean = |picture: &Picture, channel: usize| {
            let values = pixels_of(region, (width, height)).map(|pixel| value(picture, pixel)[channel]);
            values.sum::<f64>() / pixels_of(region, (width, height)).count() as f64
        };
        [0, 1, 2].map(|channel| {
            let over_seeds = SampleMean::of(pictures.iter().map(|picture| mean(picture, channel)));
            let SampleMean { mean, standard_error } = over_seeds;
            Estimate { mean, standard_error, degrees: f64::from(seeds - 1), hits: f64::INFINITY }
        })
    };
    let scale = width / SMALL.0;
    let small_pixel = |(x, y): (u32, u32)| {
        let parts = (0..scale * scale).map(|i| (x * scale + i % scale, y * scale + i / scale));
        let values = parts.flat_map(|part| pictures.iter().map(move |picture| DVec3::from(value(picture, part))));
        values.sum::<DVec3>() / f64::from(scale * scale * seeds)
    };
    Measured { regions: (0..REGIONS).map(region).collect(), pixels: pixels_of(0, SMALL).map(small_pixel).collect() }
}

/// Renders without photons and compares.
pub fn compare_paths(
    prepared: &mut RenderScene,
    scene: &Scene,
    expected: &Measured,
    effort: Effort,
) -> Vec<Difference> {
    prepared.set_plan(prepared.plan().clone().without(Shortcut::Photons));
    let ours = rendered(prepared, scene, SMALL, effort.paths_spp, effort.seeds);
    differences(&ours, expected, None)
}

/// Renders with photons and compares.
pub fn compare_photons(prepared: &RenderScene, scene: &Scene, expected: &Measured, effort: Effort) -> Vec<Difference> {
    let ours = rendered(prepared, scene, LARGE, effort.photons_spp, effort.seeds);
    let blurred = rendered(prepared, scene, (LARGE.0 / 2, LARGE.1 / 2), effort.photons_spp, effort.seeds);
    differences(&ours, expected, Some(&blurred))
}

/// Tests every region and channel that is lit: Welch's t-test of a difference less its known bound.
fn differences(ours: &Measured, expected: &Measured, blurred: Option<&Measured>) -> Vec<Difference> {
    let mut found = Vec::new();
    for (region, channel) in (0..REGIONS).flat_map(|region| [0, 1, 2].map(|channel| (region, channel))) {
        let [ours_here, expected_here] = [ours, expected].map(|measured| measured.regions[region][channel]);
        if expected_here.hits < MIN_HITS {
            continue;
        }
        let blur = blurred.map_or(0.0, |blurred| (blurred.regions[region][channel].mean - ours_here.mean).abs());
        let bias = blur + BIAS * expected_here.mean;
        let variances = [ours_here, expected_here].map(|estimate| estimate.standard_error.powi(2));
        let variance = variances[0] + variances[1];
        let fourth = variances[0].powi(2) / ours_here.degrees + variances[1].powi(2) / expected_here.degrees;
        let excess = (ours_here.mean - expected_here.mean).abs() - bias;
        // A region without noise shows an emitter alone: any excess is an error
        let p_value = match (excess > 0.0, variance > 0.0) {
            (false, _) => 1.0,
            (true, false) => 0.0,
            (true, true) => student_tails(excess / variance.sqrt(), variance.powi(2) / fourth),
        };
        let gap = |&(x, y): &(u32, u32)| {
            let index = (y * SMALL.0 + x) as usize;
            (ours.pixels[index] - expected.pixels[index])[channel].abs()
        };
        let pixel = pixels_of(region, SMALL).max_by(|a, b| gap(a).total_cmp(&gap(b))).unwrap();
        found.push(Difference { region, channel, ours: ours_here, expected: expected_here, bias, p_value, pixel });
    }
    found
}

impl Difference {
    /// Returns the sizes and the command that replays a sample of the pixel with the largest difference.
    pub fn report(&self, file: &str, with_photons: bool, effort: Effort) -> String {
        let Difference { region, channel, ours, expected, bias, p_value, pixel: (x, y) } = self;
        let place = if *region == 0 { "the whole picture".to_owned() } else { format!("block {region} of 3 x 2") };
        let color = ["red", "green", "blue"][*channel];
        let ((width, height), spp, caustics) =
            if with_photons { (LARGE, effort.photons_spp, "") } else { (SMALL, effort.paths_spp, " --caustics paths") };
        let (x, y) = (x * width / SMALL.0, y * height / SMALL.1);
        let relative = 100.0 * self.relative();
        format!(
            "{color} of {place}: {:.5} +- {:.5}, expected {:.5} +- {:.5} (bias at most {bias:.5}): {relative:+.2} %, p {p_value:.1e}\n    \
             catchlight render '{file}' --size {width}x{height} --spp {spp}{caustics} --seed 0 --explain-pixel {x},{y} --sample 0",
            ours.mean, ours.standard_error, expected.mean, expected.standard_error
        )
    }
}

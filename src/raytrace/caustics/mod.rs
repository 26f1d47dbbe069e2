//! Caustics: light that comes to a surface by mirrors and clear glass alone, gathered from photons.
//!
//! A path from the camera meets such light only by luck: the narrow cone in which a glass shows the lamp is one direction
//! of thousands, and a lamp without a size is never met. So photons start where the light meets mirrors and glass, and
//! are kept where they come to a surface that scatters widely (Jensen 1996). There, every path takes those within a small
//! circle for the density of the light, and leaves out what it meets of the same light by itself.
//!
//! Each wave of samples has photons of its own and a smaller circle, as (samples so far)^(-1/6): what the circle blurs
//! vanishes, slower than the noise (Knaus and Zwicker 2011, "Progressive Photon Mapping: A Probabilistic Approach").
//! Where paths meet a light well by themselves, by a narrow gloss or a large softbox in a mirror, they keep most of it: both
//! techniques are weighted by their densities (Georgiev et al. 2012, "Light Transport Simulation with Vertex Connection and
//! Merging").

mod casters;
mod grid;
mod photon;
#[cfg(test)]
mod tests;
mod weights;

use super::bsdf::Bsdf;
use super::control::RenderControl;
use super::geometry::SurfaceInteraction;
use super::path_tracer::Tracer;
use super::prepare::RenderScene;
use super::sampler::Sampler;
pub use casters::Casters;
use glam::Vec3;
use grid::Grid;
pub use photon::Photon;
use rayon::prelude::*;
use std::f32::consts::PI;
pub use weights::{Gathered, Rival};

/// Circle of the first wave, in pixels at the distance of most photons: no more is blurred than the eye may miss.
const FIRST_RADIUS_PX: f32 = 2.0;
/// It holds so many photons of one sample a pixel, at least in the mean, and is no wider than this, metres.
const FEWEST: usize = 10;
const WIDEST_M: f32 = 0.05;
/// Photons a wave at most: some 120 MB while they are sorted.
const MOST_PHOTONS: u64 = 1 << 20;
/// A wave of a render has at least so many.
pub const USUAL_PHOTONS: u64 = 1 << 14;
/// For what is seen by bounced light alone, one photon of so many is taken, from a circle so many times as wide.
const SPARSE: usize = 16;
const SPARSE_RADIUS: f32 = 2.0;
/// Cosine between normals of one surface within a circle.
const SAME_SIDE: f32 = 0.5;
/// Photons that one task follows; as many share a sequence of random numbers.
const CHUNK: u32 = 1 << 12;
/// Keeps the photons' random numbers apart from the pixels'.
const SEED: u32 = 0x70_68_6f_74;

/// The wave that photons are for.
#[derive(Clone, Copy, Debug)]
pub struct Wave {
    /// Samples of each pixel before it.
    pub first_sample: u32,
    /// Samples of each pixel in it.
    pub samples: u32,
    /// Photons to send, about.
    pub photons: u64,
    /// Width of a pixel at 1 m, metres.
    pub pixel_m: f32,
    /// The lens centre, relative to the tracer's origin.
    pub eye: Vec3,
    /// Of the render.
    pub seed: u32,
}

/// Photons where they arrived.
#[derive(Debug)]
pub struct PhotonMap {
    /// For what the camera sees, directly or in mirrors and glass.
    full: Photons,
    /// A few from a wider circle, for what is seen by bounced light alone.
    sparse: Photons,
}

/// Photons and the circle from which they are gathered.
#[derive(Debug)]
pub struct Photons {
    grid: Grid,
    /// Of the circle, times the number of photons that were sent for it, square metres.
    area: f32,
}

impl Wave {
    /// Samples a pixel that a wave may have: each gets one photon.
    pub fn most_samples(pixels: u64) -> u32 {
        (MOST_PHOTONS / pixels.max(1)).clamp(1, 1 << 16) as u32
    }

    /// Of the circle in which photons are gathered, metres.
    fn radius(&self, photons: &[Photon]) -> f32 {
        let blurred = FIRST_RADIUS_PX * self.pixel_m * median_distance(photons, self.eye);
        let filled = neighbours_within(photons) * (self.samples as f32).sqrt();
        let shrink = ((self.first_sample + 1) as f32).powf(-1.0 / 6.0);
        (blurred.max(filled.min(WIDEST_M)) * shrink).max(f32::MIN_POSITIVE)
    }
}

impl PhotonMap {
    /// Sends out the photons of a wave, on rayon's current pool. Incomplete once `control` is cancelled.
    pub fn trace(scene: &RenderScene, wave: &Wave, control: &RenderControl) -> Self {
        let chunks = (wave.photons.clamp(1, MOST_PHOTONS) as u32).div_ceil(CHUNK);
        let sent = chunks * CHUNK;
        let chunk = |chunk: u32| {
            let mut found = Vec::new();
            if !control.is_cancelled() {
                let mut tracer = Tracer::new(scene);
                for index in 0..CHUNK {
                    let sampler = Sampler::new(chunk, wave.first_sample, index, wave.seed ^ SEED);
                    tracer.send_photon(&sampler, sent, &mut found);
                }
                control.count(tracer.rays, 0);
            }
            found
        };
        let photons: Vec<Vec<Photon>> = (0..chunks).into_par_iter().map(chunk).collect();
        let photons = photons.concat();
        let radius = wave.radius(&photons);
        let few = photons.iter().step_by(SPARSE).map(|photon| Photon { flux: photon.flux * SPARSE as f32, ..*photon });
        let sparse = Photons::new(few.collect(), SPARSE_RADIUS * radius, sent as f32 / SPARSE as f32);
        PhotonMap { full: Photons::new(photons, radius, sent as f32), sparse }
    }

    /// The photons for a surface after so many that scatter widely.
    pub fn of(&self, wide_bounces: u32) -> &Photons {
        if wide_bounces == 0 { &self.full } else { &self.sparse }
    }
}

impl Photons {
    fn new(photons: Vec<Photon>, radius: f32, sent: f32) -> Self {
        Photons { grid: Grid::new(photons, radius), area: PI * radius * radius * sent }
    }

    /// Photons expected on the circle where the density of each is one on a square metre, square metres.
    pub fn area(&self) -> f32 {
        self.area
    }

    /// Gives `sink` what comes by at most so many `bends` from a surface, layer by layer, less what `ways` that are followed
    /// from it find by themselves.
    pub fn gather(
        &self,
        surface: &SurfaceInteraction,
        bsdf: &Bsdf<'_>,
        ways: f32,
        bends: u32,
        mut sink: impl FnMut(usize, Vec3),
    ) {
        let radius2 = self.grid.radius() * self.grid.radius();
        let peak = 2.0 / (PI * radius2);
        let (mut layer, mut sum) = (0, Vec3::ZERO);
        self.grid.near(surface.position, |photon, distance2| {
            if u32::from(photon.bends) > bends || photon.normal.dot(bsdf.normal()) < SAME_SIDE {
                return;
            }
            let (value, pdf) = bsdf.eval(photon.direction);
            if value == Vec3::ZERO {
                return;
            }
            let cos = photon.direction.dot(photon.normal);
            let gathered = Gathered { paths: pdf * ways, photons: self.area * cos };
            // Epanechnikov's kernel: it falls to nothing at the circle.
            let kernel = peak * (1.0 - distance2 / radius2);
            let value = value * photon.flux * (kernel * (1.0 - gathered.weight_of_path(photon.density)));
            if photon.layer != layer {
                sink(usize::from(layer), std::mem::take(&mut sum));
                layer = photon.layer;
            }
            sum += value;
        });
        sink(usize::from(layer), sum);
    }
}

/// Of the photons from the eye, metres.
fn median_distance(photons: &[Photon], eye: Vec3) -> f32 {
    nth(photons.iter().map(|photon| photon.position.distance(eye)).collect(), photons.len() / 2)
}

/// Distance from a typical photon within which there are [`FEWEST`] others, metres. From a few of them: on surfaces, it
/// falls with the root of their number.
fn neighbours_within(photons: &[Photon]) -> f32 {
    const ASKED: usize = 64;
    const OTHERS: usize = 4096;
    let others: Vec<Vec3> = every(photons, OTHERS).map(|photon| photon.position).collect();
    let to_others = |photon: &Photon| {
        let distances = others.iter().map(|other| other.distance_squared(photon.position)).collect();
        nth(distances, FEWEST).sqrt()
    };
    let typical = nth(every(photons, ASKED).map(to_others).collect(), ASKED / 2);
    typical * (others.len() as f32 / photons.len().max(1) as f32).sqrt()
}

/// About so many, evenly spread.
fn every(photons: &[Photon], count: usize) -> impl Iterator<Item = &Photon> {
    photons.iter().step_by((photons.len() / count).max(1))
}

/// The `n`th smallest value, or the largest; 0 where there is none.
fn nth(mut values: Vec<f32>, n: usize) -> f32 {
    let n = n.min(values.len().saturating_sub(1));
    if values.is_empty() { 0.0 } else { *values.select_nth_unstable_by(n, f32::total_cmp).1 }
}

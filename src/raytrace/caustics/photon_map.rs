//! The photon map of one sample pass.

use super::grid::PhotonGrid;
use super::mis::GatherDensities;
use super::photon::Photon;
use super::photon_tracer::PhotonTracer;
use crate::raytrace::bsdf::Bsdf;
use crate::raytrace::control::RenderControl;
use crate::raytrace::geometry::SurfaceInteraction;
use crate::raytrace::render_scene::RenderScene;
use crate::raytrace::sampler::Sampler;
use glam::Vec3;
use rayon::prelude::*;
use std::f32::consts::PI;

/// Gather radius of the first pass, in pixels at the distance of most photons: little enough blur for the eye to miss.
const FIRST_RADIUS_PX: f32 = 2.0;
/// Photons per sample of a pixel that the gather radius holds at least, on average, up to [`MAX_FILLED_RADIUS_M`].
const MIN_NEIGHBOURS: usize = 10;
/// Maximum gather radius due to [`MIN_NEIGHBOURS`], metres.
const MAX_FILLED_RADIUS_M: f32 = 0.05;
/// Maximum number of photons of a pass: some 120 MB while they are sorted.
const MAX_PHOTONS: u64 = 1 << 20;
/// Minimum number of photons of a render's pass.
pub const MIN_PHOTONS: u64 = 1 << 14;
/// One of so many photons is kept for vertices that are seen by indirect light alone,
const SPARSE_STRIDE: usize = 16;
/// with a gather radius that is wider by this factor.
const SPARSE_RADIUS: f32 = 2.0;
/// Minimum cosine between the normals of a photon and of the vertex that gathers it.
const MIN_NORMAL_COSINE: f32 = 0.5;
/// Photons per task, which share a sequence of random numbers.
const CHUNK: u32 = 1 << 12;
/// Added to the seed, so that photons and pixels have different random numbers.
const SEED: u32 = 0x70_68_6f_74;

/// The sample pass for which photons are traced.
#[derive(Clone, Copy, Debug)]
pub struct PhotonPass {
    /// Samples per pixel before the pass.
    pub first_sample: u32,
    /// Samples per pixel in the pass.
    pub samples: u32,
    /// Number of photons, rounded up to whole tasks.
    pub photons: u64,
    /// Width of a pixel at 1 m, metres.
    pub pixel_m: f32,
    /// The lens centre, in the tracer's space.
    pub eye: Vec3,
    /// Seed of the render.
    pub seed: u32,
}

/// The photons of a pass.
#[derive(Debug)]
pub struct PhotonMap {
    /// For vertices that the camera sees directly or through specular surfaces.
    pub(super) full: PhotonLookup,
    /// For vertices that are seen by indirect light.
    sparse: PhotonLookup,
}

/// Photons with their gather radius.
#[derive(Debug)]
pub struct PhotonLookup {
    pub(super) grid: PhotonGrid,
    /// Gather area times the number of emitted photons, square metres.
    area: f32,
}

impl PhotonPass {
    /// Maximum samples per pixel of a pass: each has one photon.
    pub fn max_samples(pixels: u64) -> u32 {
        (MAX_PHOTONS / pixels.max(1)).clamp(1, 1 << 16) as u32
    }

    /// Gather radius, metres.
    fn radius(&self, photons: &[Photon]) -> f32 {
        let blurred = FIRST_RADIUS_PX * self.pixel_m * median_distance(photons, self.eye);
        let filled = filled_radius(photons, self.samples);
        let shrink = ((self.first_sample + 1) as f32).powf(-1.0 / 6.0);
        blurred.max(filled) * shrink
    }
}

impl PhotonMap {
    /// Traces the photons of a pass on rayon's current pool. Incomplete if `control` is cancelled.
    pub fn trace(scene: &RenderScene, pass: &PhotonPass, control: &RenderControl) -> Self {
        let chunks = (pass.photons.clamp(1, MAX_PHOTONS) as u32).div_ceil(CHUNK);
        let emitted = chunks * CHUNK;
        let trace_chunk = |chunk: u32| {
            let mut stored = Vec::new();
            if !control.is_cancelled() {
                let mut tracer = PhotonTracer::new(scene);
                for index in 0..CHUNK {
                    let sampler = Sampler::new(chunk, pass.first_sample, index, pass.seed ^ SEED);
                    tracer.trace(&sampler, emitted, &mut stored);
                }
                control.count(tracer.caster.rays, 0);
            }
            stored
        };
        let photons: Vec<Vec<Photon>> = (0..chunks).into_par_iter().map(trace_chunk).collect();
        let photons = photons.concat();
        let radius = pass.radius(&photons);
        Self::new(photons, emitted, radius)
    }

    /// The map of photons of which so many were emitted, with a gather radius in metres.
    pub fn new(photons: Vec<Photon>, emitted: u32, radius: f32) -> Self {
        let radius = radius.max(f32::MIN_POSITIVE);
        let brighter = |photon: &Photon| Photon { flux: photon.flux * SPARSE_STRIDE as f32, ..*photon };
        let sparse = photons.iter().step_by(SPARSE_STRIDE).map(brighter).collect();
        PhotonMap {
            sparse: PhotonLookup::new(sparse, SPARSE_RADIUS * radius, emitted as f32 / SPARSE_STRIDE as f32),
            full: PhotonLookup::new(photons, radius, emitted as f32),
        }
    }

    /// The photons for a vertex after so many non-specular ones.
    pub fn for_depth(&self, non_specular_depth: u32) -> &PhotonLookup {
        if non_specular_depth == 0 { &self.full } else { &self.sparse }
    }
}

impl PhotonLookup {
    fn new(photons: Vec<Photon>, radius: f32, emitted: f32) -> Self {
        PhotonLookup { grid: PhotonGrid::new(photons, radius), area: PI * radius * radius * emitted }
    }

    /// Gather area times the number of emitted photons, square metres: the expected number of gathered photons where
    /// the density of each is 1/m2.
    pub fn area(&self) -> f32 {
        self.area
    }

    /// Gather radius, metres.
    pub fn radius(&self) -> f32 {
        self.grid.radius()
    }

    /// Estimates the radiance that leaves a surface due to photons of at most `max_specular_depth`, layer by layer,
    /// weighted against the `paths` that leave the surface and may find the same light.
    pub fn gather(
        &self,
        surface: &SurfaceInteraction,
        bsdf: &Bsdf<'_>,
        paths: f32,
        max_specular_depth: u32,
        mut add: impl FnMut(usize, Vec3),
    ) {
        let radius2 = self.grid.radius() * self.grid.radius();
        let peak = 2.0 / (PI * radius2);
        let (mut layer, mut sum) = (0, Vec3::ZERO);
        self.grid.for_each_near(surface.position, |photon, distance2| {
            if u32::from(photon.specular_depth) > max_specular_depth
                || photon.normal.dot(bsdf.normal()) < MIN_NORMAL_COSINE
            {
                return;
            }
            let (value, pdf) = bsdf.eval(photon.direction);
            if value == Vec3::ZERO {
                return;
            }
            let cos = photon.direction.dot(photon.normal);
            let densities = GatherDensities { path_pdf: pdf * paths, photon_area: self.area * cos };
            // Epanechnikov's kernel: 0 at the radius.
            let kernel = peak * (1.0 - distance2 / radius2);
            let value = value * photon.flux * (kernel * (1.0 - densities.path_weight(photon.density)));
            if photon.layer != layer {
                add(usize::from(layer), std::mem::take(&mut sum));
                layer = photon.layer;
            }
            sum += value;
        });
        add(usize::from(layer), sum);
    }
}

/// Gather radius that holds enough photons of a pass with so many samples per pixel, up to [`MAX_FILLED_RADIUS_M`],
/// metres.
pub fn filled_radius(photons: &[Photon], samples: u32) -> f32 {
    (neighbour_distance(photons) * (samples as f32).sqrt()).min(MAX_FILLED_RADIUS_M)
}

/// Median distance of the photons from the eye, metres.
fn median_distance(photons: &[Photon], eye: Vec3) -> f32 {
    nth(photons.iter().map(|photon| photon.position.distance(eye)).collect(), photons.len() / 2)
}

/// Distance from a typical photon within which there are [`MIN_NEIGHBOURS`] others, metres. Estimated from a subset: on
/// surfaces, it falls with the square root of the number of photons.
fn neighbour_distance(photons: &[Photon]) -> f32 {
    const QUERIES: usize = 64;
    const OTHERS: usize = 4096;
    let others: Vec<Vec3> = every(photons, OTHERS).map(|photon| photon.position).collect();
    let to_others = |photon: &Photon| {
        let distances = others.iter().map(|other| other.distance_squared(photon.position)).collect();
        nth(distances, MIN_NEIGHBOURS).sqrt()
    };
    let typical = nth(every(photons, QUERIES).map(to_others).collect(), QUERIES / 2);
    typical * (others.len() as f32 / photons.len().max(1) as f32).sqrt()
}

/// About `count` photons, evenly spaced in their order.
fn every(photons: &[Photon], count: usize) -> impl Iterator<Item = &Photon> {
    photons.iter().step_by((photons.len() / count).max(1))
}

/// The `n`th smallest value, or the largest; 0 where there is none.
fn nth(mut values: Vec<f32>, n: usize) -> f32 {
    let n = n.min(values.len().saturating_sub(1));
    if values.is_empty() { 0.0 } else { *values.select_nth_unstable_by(n, f32::total_cmp).1 }
}

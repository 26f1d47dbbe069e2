//! The random walk under a surface.
//!
//! A walk is sampled by one of several techniques: for one of the colour channels, classical (exponential distances,
//! uniform directions) or guided towards the surface (Dwivedi's scheme: Křivánek and d'Eon 2014, "A Zero-Variance-Based
//! Sampling Scheme for Monte Carlo Subsurface Scattering"). The weight is the contribution of each channel over the
//! density of the walk under all techniques (balance heuristic, Veach 1997), so that guided walks have about the same
//! weight on a flat surface, and classical ones bound it where the body is thin or curved.

use super::medium::Medium;
use crate::math::{Ray, orthonormal_basis, warp};
use crate::raytrace::bsdf::TracedMaterial;
use crate::raytrace::bvh::TraversalStack;
use crate::raytrace::geometry::{Instance, SurfaceInteraction};
use crate::raytrace::sampler::{self, NumberStream, Set};
use crate::raytrace::simd::{KernelTask, Kernels};
use glam::Vec3;

/// Scattering events after which a walk ends at its entry. In a white half-space, one of 110 walks takes more.
pub const MAX_STEPS: u32 = 4096;
/// Part of the walks that are classical.
const CLASSICAL: f32 = 0.1;
/// Probabilities of the channels: about their parts of luminance, less uneven.
const CHANNELS: Vec3 = Vec3::new(0.3, 0.5, 0.2);
/// Largest weight of walks that Russian roulette ends.
const ROULETTE_WEIGHT: f32 = 0.05;
/// Least mean free path, in error bounds of the position.
const MIN_FREE_PATH: f32 = 16.0;
/// Least cosine of the direction of entry that counts for the offset of its origin.
const MIN_COSINE: f32 = 1e-2;

/// The task of a walk from a point on the surface of an instance.
#[derive(Debug)]
pub struct Walk<'a> {
    /// The object.
    pub instance: &'a Instance,
    /// The scene's materials.
    pub materials: &'a [TracedMaterial],
    /// Inside of the object.
    pub medium: Medium,
    /// Where the walk enters.
    pub entry: &'a SurfaceInteraction,
    /// Stratified numbers for its start.
    pub set: Set,
    /// Numbers for the rest.
    pub numbers: NumberStream,
    /// Scratch space of traversals.
    pub stack: &'a mut TraversalStack,
}

/// The end of a walk.
#[derive(Clone, Copy, Debug)]
pub struct WalkEnd {
    /// The surface at which light leaves to the outside.
    pub surface: SurfaceInteraction,
    /// Contribution over density, for an entry with a cosine distribution.
    pub weight: Vec3,
    /// Number of rays.
    pub rays: u32,
    /// True if the walk did not find the surface and ends at its entry.
    pub is_entry: bool,
}

/// The sampling technique of a walk.
#[derive(Clone, Copy, Debug)]
struct Technique {
    channel: usize,
    is_guided: bool,
}

impl Technique {
    #[inline(always)]
    fn sample(u: f32) -> Self {
        let is_guided = u >= CLASSICAL;
        let u = if is_guided { (u - CLASSICAL) / (1.0 - CLASSICAL) } else { u / CLASSICAL };
        let channel = usize::from(u >= CHANNELS.x) + usize::from(u >= CHANNELS.x + CHANNELS.y);
        Technique { channel, is_guided }
    }
}

/// The contribution of a walk and its densities under the techniques, all divided by the density of their mixture.
#[derive(Clone, Copy, Debug)]
struct Weights {
    contribution: Vec3,
    classical: Vec3,
    guided: Vec3,
}

impl Weights {
    /// Divides by the density of the mixture.
    #[inline(always)]
    fn normalize(&mut self) {
        let density = CHANNELS.dot(self.classical * CLASSICAL + self.guided * (1.0 - CLASSICAL));
        let scale = 1.0 / density.max(f32::MIN_POSITIVE);
        self.contribution *= scale;
        self.classical *= scale;
        self.guided *= scale;
    }
}

/// The densities by which a walk is guided, for one direction.
#[derive(Clone, Copy, Debug)]
struct Guide {
    /// Ratio of the densities of guided and of uniform directions, without its dependence on the direction:
    /// 2 k / ln((1 + k) / (1 - k)) for a decay k.
    direction: Vec3,
    log_ratio: Vec3,
}

impl Guide {
    #[inline(always)]
    fn new(decay: Vec3) -> Self {
        let log_ratio = decay.map(|k| k.ln_1p() - (-k).ln_1p());
        Guide { direction: 2.0 * decay / log_ratio, log_ratio }
    }

    /// Samples the cosine to the outward normal, with density proportional to 1 / (1 - k cos).
    #[inline(always)]
    fn sample_cos(&self, decay: Vec3, channel: usize, u: f32) -> f32 {
        let (k, log_ratio) = (decay[channel], self.log_ratio[channel]);
        let e = (-u * log_ratio).exp_m1();
        ((-e - k * (1.0 + e)) / k).clamp(-1.0, 1.0)
    }
}

impl KernelTask for Walk<'_> {
    /// None for a walk that is absorbed.
    type Output = Option<WalkEnd>;

    #[inline(always)]
    fn run<K: Kernels>(mut self) -> Option<WalkEnd> {
        let Medium { extinction, albedo, decay } = self.medium;
        let min_free_path = 1.0 / extinction.max_element();
        if min_free_path < MIN_FREE_PATH * self.entry.position_error.max_element() {
            return self.end_at_entry(Vec3::ONE, 0);
        }

        // Sample the technique, and a direction of entry about the geometric normal
        let normal = self.entry.geometric_normal;
        let (tangent, bitangent) = orthonormal_basis(normal);
        let to_world = |w: Vec3| tangent * w.x + bitangent * w.y + normal * w.z;
        let [mut u_distance, u_technique] = sampler::last_pair(&self.set);
        let technique = Technique::sample(u_technique);
        let guide = Guide::new(decay);
        let mut direction = -to_world(warp::cosine_hemisphere(sampler::first_pair(&self.set)));
        let mut origin = self.entry.spawn_origin(direction);
        // Rays start inside by the error bound of the position: count the way to there as travelled
        let mut travelled = (self.entry.position - origin).dot(normal) / (-direction.dot(normal)).max(MIN_COSINE);
        let mut weights = Weights { contribution: Vec3::ONE, classical: Vec3::ONE, guided: Vec3::ONE };

        for step in 1..=MAX_STEPS {
            // Sample a distance
            let stretched = extinction * (Vec3::ONE - decay * direction.dot(normal));
            let rates = if technique.is_guided { stretched } else { extinction };
            let distance = -(1.0 - u_distance).ln() / rates[technique.channel];

            // Leave the body, if its surface is nearer
            let ray = Ray { origin, direction, t_max: (distance - travelled).max(0.0) };
            let hit = self.instance.intersect::<K>(&ray, self.stack);
            let t = hit.map_or(distance, |hit| hit.t + travelled);
            let (transmittance, guided) = ((-extinction * t).exp(), (-stretched * t).exp());
            weights.contribution *= transmittance;
            weights.classical *= transmittance;
            weights.guided *= guided;
            if let Some(hit) = hit {
                weights.normalize();
                let surface = self.instance.surface(&hit);
                let is_soft = self.materials[surface.material as usize].extinction_per_m().is_some();
                if is_soft && direction.dot(surface.geometric_normal) > 0.0 {
                    return Some(WalkEnd { surface, weight: weights.contribution, rays: step, is_entry: false });
                }
                return self.end_at_entry(weights.contribution, step);
            }

            // Scatter
            let u = self.numbers.unit_square();
            let local = if technique.is_guided {
                let cos = guide.sample_cos(decay, technique.channel, u.x);
                warp::about_z(cos, u.y)
            } else {
                warp::uniform_sphere(u)
            };
            direction = to_world(local);
            origin += ray.direction * ray.t_max;
            travelled = 0.0;
            weights.contribution *= extinction * albedo;
            weights.classical *= extinction;
            weights.guided *= stretched * guide.direction / (Vec3::ONE - decay * local.z);
            weights.normalize();

            // Play Russian roulette
            let largest = weights.contribution.max_element();
            if largest < ROULETTE_WEIGHT {
                if self.numbers.next() * ROULETTE_WEIGHT >= largest {
                    return None;
                }
                weights.contribution *= ROULETTE_WEIGHT / largest;
            }
            u_distance = self.numbers.next();
        }
        self.end_at_entry(weights.contribution, MAX_STEPS)
    }
}

impl Walk<'_> {
    #[inline(always)]
    fn end_at_entry(&self, weight: Vec3, rays: u32) -> Option<WalkEnd> {
        Some(WalkEnd { surface: *self.entry, weight, rays, is_entry: true })
    }
}

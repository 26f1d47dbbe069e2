//! The random walk under a surface.
//!
//! A walk is sampled by one of several techniques: for one of the colour channels, classical (exponential distances,
//! uniform directions) or guided towards the surface (Dwivedi's scheme: Křivánek and d'Eon 2014, "A Zero-Variance-Based
//! Sampling Scheme for Monte Carlo Subsurface Scattering"). The weight is the contribution of each channel over the
//! density of the walk under all techniques (balance heuristic, Veach 1997), so that guided walks have about the same
//! weight on a flat surface, and classical ones bound it where the body is thin or curved.
//!
//! The same walk is followed under the tangent plane of its entry, without rays. Its expected weight is known, which
//! makes it a control variate: see `path`. A walk that the body stops where it cannot leave has that weight, too.

use super::medium::Medium;
use crate::math::{Ray, orthonormal_basis, warp};
use crate::raytrace::bsdf::TracedMaterial;
use crate::raytrace::bvh::TraversalStack;
use crate::raytrace::geometry::{Instance, SurfaceInteraction};
use crate::raytrace::sampler::{self, NumberStream, Set};
use crate::raytrace::simd::{KernelTask, Kernels, TriangleHit};
use glam::Vec3;

/// Scattering events after which a walk ends at its entry. In a white half-space, one of 110 walks takes more.
pub const MAX_STEPS: u32 = 4096;
/// Part of the walks that are classical: enough of them that light through ears has no outliers. The control variate of
/// `path` cancels the noise that they have on flat surfaces.
const CLASSICAL: f32 = 0.4;
/// Probabilities of the channels: about their parts of luminance, less uneven.
const CHANNELS: Vec3 = Vec3::new(0.3, 0.5, 0.2);
/// Weight under which Russian roulette ends walks, relative to the albedo of the body.
const ROULETTE_WEIGHT: f32 = 0.1;
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
    pub medium: &'a Medium,
    /// Where the walk enters.
    pub entry: &'a SurfaceInteraction,
    /// Stratified numbers for its start.
    pub set: Set,
    /// Numbers for the rest.
    pub numbers: NumberStream,
    /// Scratch space of traversals.
    pub stack: &'a mut TraversalStack,
}

/// The end of a walk that is not absorbed.
#[derive(Clone, Copy, Debug)]
pub struct WalkEnd {
    /// The surface at which light leaves to the outside.
    pub surface: SurfaceInteraction,
    /// Contribution over density, for an entry with a cosine distribution.
    pub weight: Vec3,
    /// True if the walk cannot leave by the body's soft surface, and ends at its entry.
    pub is_entry: bool,
}

/// A walk in the body, and the same walk under the tangent plane of its entry.
#[derive(Clone, Copy, Debug)]
pub struct WalkPair {
    /// The end of the walk in the body; none if it is absorbed.
    pub end: Option<WalkEnd>,
    /// Weight of the walk under the plane; its expected value is the diffuse albedo of the medium.
    pub flat_weight: Vec3,
    /// Number of rays.
    pub rays: u32,
}

/// The state of a pair of walks.
#[derive(Clone, Copy, Debug, Default)]
struct Ends {
    body: Option<BodyEnd>,
    flat_weight: Option<Vec3>,
    rays: u32,
}

/// The end of the walk in the body.
#[derive(Clone, Copy, Debug)]
enum BodyEnd {
    /// At its soft surface, or at the entry after the last step.
    Arrived(WalkEnd),
    /// At a surface by which no light leaves.
    Stopped,
}

impl Ends {
    fn is_complete(&self) -> bool {
        self.body.is_some() && self.flat_weight.is_some()
    }
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
    /// The weights after a flight by a distance, of transmittances `exp(-rate distance)`.
    #[inline(always)]
    fn after_flight(mut self, extinction: Vec3, stretched: Vec3, distance: f32) -> Self {
        let transmittance = (-extinction * distance).exp();
        self.contribution *= transmittance;
        self.classical *= transmittance;
        self.guided *= (-stretched * distance).exp();
        self
    }

    /// Returns the contribution over the density of the mixture.
    #[inline(always)]
    fn weight(mut self) -> Vec3 {
        self.normalize();
        self.contribution
    }

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

impl KernelTask for Walk<'_> {
    type Output = WalkPair;

    #[inline(always)]
    fn run<K: Kernels>(mut self) -> WalkPair {
        let Medium { diffuse_albedo, extinction, albedo, decay, guide } = *self.medium;
        let mut ends = Ends::default();
        if 1.0 / extinction.max_element() < MIN_FREE_PATH * self.entry.position_error.max_element() {
            (ends.body, ends.flat_weight) = (Some(BodyEnd::Stopped), Some(diffuse_albedo));
            return self.finish(ends);
        }

        // Sample the technique, and a direction of entry about the geometric normal
        let normal = self.entry.geometric_normal;
        let (tangent, bitangent) = orthonormal_basis(normal);
        let to_world = |w: Vec3| tangent * w.x + bitangent * w.y + normal * w.z;
        let [mut u_distance, u_technique] = sampler::last_pair(&self.set);
        let technique = Technique::sample(u_technique);
        let mut local = -warp::cosine_hemisphere(sampler::first_pair(&self.set));
        let mut direction = to_world(local);
        let mut origin = self.entry.spawn_origin(direction);
        // Rays start inside by the error bound of the position: count the way to there as travelled
        let mut travelled = (self.entry.position - origin).dot(normal) / (-local.z).max(MIN_COSINE);
        let mut height = 0.0;
        let mut weights = Weights { contribution: Vec3::ONE, classical: Vec3::ONE, guided: Vec3::ONE };
        let threshold = ROULETTE_WEIGHT * diffuse_albedo.max_element();

        for _ in 0..MAX_STEPS {
            // Sample a distance
            let stretched = extinction * (Vec3::ONE - decay * local.z);
            let rates = if technique.is_guided { stretched } else { extinction };
            let distance = -(1.0 - u_distance).ln() / rates[technique.channel];

            // Leave the body by its surface and the half-space by its plane
            let t_max = (distance - travelled).max(0.0);
            if ends.body.is_none() {
                ends.rays += 1;
                if let Some(hit) = self.instance.intersect::<K>(&Ray { origin, direction, t_max }, self.stack) {
                    let weight = weights.after_flight(extinction, stretched, hit.t + travelled).weight();
                    ends.body = Some(self.end_at(&hit, direction, weight));
                }
            }
            let next_height = height + local.z * distance;
            if ends.flat_weight.is_none() && next_height > 0.0 {
                ends.flat_weight = Some(weights.after_flight(extinction, stretched, -height / local.z).weight());
            }
            if ends.is_complete() {
                return self.finish(ends);
            }

            // Scatter
            let u = self.numbers.unit_square();
            (origin, travelled, height) = (origin + direction * t_max, 0.0, next_height);
            local = if technique.is_guided {
                warp::about_z(guide.sample_cos(decay, technique.channel, u.x), u.y)
            } else {
                warp::uniform_sphere(u)
            };
            direction = to_world(local);
            weights = weights.after_flight(extinction, stretched, distance);
            weights.contribution *= extinction * albedo;
            weights.classical *= extinction;
            weights.guided *= stretched * guide.direction / (Vec3::ONE - decay * local.z);
            weights.normalize();

            // Play Russian roulette
            let largest = weights.contribution.max_element();
            if largest.is_nan() || largest <= self.numbers.next() * threshold {
                return self.finish(ends);
            }
            if largest < threshold {
                weights.contribution *= threshold / largest;
            }
            u_distance = self.numbers.next();
        }
        ends.body.get_or_insert(BodyEnd::Arrived(self.end_at_entry(weights.contribution)));
        ends.flat_weight.get_or_insert(weights.contribution);
        self.finish(ends)
    }
}

impl Walk<'_> {
    /// Returns the end of a walk whose ray hits the object.
    #[inline(always)]
    fn end_at(&self, hit: &TriangleHit, direction: Vec3, weight: Vec3) -> BodyEnd {
        let surface = self.instance.surface(hit);
        let is_soft = self.materials[surface.material as usize].extinction_per_m().is_some();
        let leaves = is_soft && direction.dot(surface.geometric_normal) > 0.0;
        if leaves { BodyEnd::Arrived(WalkEnd { surface, weight, is_entry: false }) } else { BodyEnd::Stopped }
    }

    #[inline(always)]
    fn end_at_entry(&self, weight: Vec3) -> WalkEnd {
        WalkEnd { surface: *self.entry, weight, is_entry: true }
    }

    /// Returns the pair where no walk goes on: light that has not left is absorbed. A walk that was stopped has the
    /// light of the half-space: what was left of its own lacks the absorption of the way that it did not take.
    #[inline(always)]
    fn finish(&self, ends: Ends) -> WalkPair {
        let end = match ends.body {
            Some(BodyEnd::Arrived(end)) => Some(end),
            Some(BodyEnd::Stopped) => ends.flat_weight.map(|weight| self.end_at_entry(weight)),
            None => None,
        };
        WalkPair { end, flat_weight: ends.flat_weight.unwrap_or(Vec3::ZERO), rays: ends.rays }
    }
}

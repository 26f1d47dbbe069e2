//! Random numbers that are no accident: Owen-scrambled Sobol points (Burley 2020), one sequence a pixel.
//!
//! A value is a function of (pixel, sample, dimension, seed) alone, so that a picture has the same bits for any number
//! of threads and a single pixel can be replayed. Dimensions come in sets of four; each set is the best four-dimensional
//! Sobol sequence under its own scramble ("padding"): within a set all samples of a pixel are stratified together.
//!
//! The sequence is the one of the crate `sobol_burley`, bit by bit; here two sets come at once, in eight lanes.

use super::simd::{self, KernelTask, Kernels};
use glam::Vec2;

/// Four stratified numbers in [0, 1).
pub type Set = [f32; 4];

/// The sets of a path, in the order in which the integrator asks.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Purpose {
    /// Place in the pixel, place on the lens.
    Camera,
    /// Choice of a light, place on it.
    Light {
        /// Which of the lights, where several are sampled at one vertex.
        slot: u32,
        /// Vertex of the path, from 0.
        bounce: u32,
    },
    /// Choice of a lobe, direction, roulette.
    Bsdf {
        /// Vertex of the path, from 0.
        bounce: u32,
    },
}

/// One sample of one pixel.
#[derive(Clone, Copy, Debug)]
pub struct Sampler {
    id: SampleId,
    pixel_seed: u32,
    /// Index within the sequence.
    index: u32,
}

/// The identity of a sample; all its random numbers are a function of it and their dimension.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct SampleId {
    /// Pixel across.
    pub x: u32,
    /// Pixel down.
    pub y: u32,
    /// Index among the pixel's samples.
    pub index: u32,
    /// Seed of the render.
    pub seed: u32,
}

/// Mixes the bits of a number (Wellons' lowbias32).
fn hash(mut x: u32) -> u32 {
    x ^= x >> 16;
    x = x.wrapping_mul(0x7feb_352d);
    x ^= x >> 15;
    x = x.wrapping_mul(0x846c_a68b);
    x ^ (x >> 16)
}

impl Sampler {
    /// The random numbers of a sample.
    pub fn of(sample: SampleId) -> Self {
        Sampler::new(sample.x, sample.y, sample.index, sample.seed)
    }

    /// The random numbers of the sample `index` of a pixel.
    pub fn new(x: u32, y: u32, index: u32, seed: u32) -> Self {
        // The sequence has 2^16 points; further ones come from a fresh scramble.
        let epoch = index >> 16;
        let pixel_seed = hash(x ^ hash(y ^ hash(seed ^ hash(epoch))));
        Sampler { id: SampleId { x, y, index, seed }, pixel_seed, index: index & 0xffff }
    }

    /// The sample.
    pub fn id(&self) -> SampleId {
        self.id
    }

    /// One of `count` ways on from this sample. The ways of all samples of a pixel are stratified together.
    pub fn branch(&self, branch: u32, count: u32) -> Self {
        let SampleId { x, y, index, seed } = self.id;
        Sampler::new(x, y, index.wrapping_mul(count).wrapping_add(branch), seed)
    }

    /// The numbers for a purpose.
    #[inline]
    pub fn set(&self, purpose: Purpose) -> Set {
        self.pair(purpose, purpose)[0]
    }

    /// The numbers for two purposes, for the price of one.
    #[inline]
    pub fn pair(&self, first: Purpose, second: Purpose) -> [Set; 2] {
        let seed = |purpose: Purpose| hash(self.pixel_seed ^ hash(purpose.key()));
        simd::dispatch(Pair { index: self.index, seeds: [seed(first), seed(second)] })
    }
}

impl Purpose {
    /// A number of its own.
    fn key(self) -> u32 {
        match self {
            Purpose::Camera => 0,
            Purpose::Bsdf { bounce } => 1 + 2 * bounce,
            Purpose::Light { slot, bounce } => (2 + 2 * bounce) | (slot << 16),
        }
    }
}

/// See [`Sampler::pair`].
struct Pair {
    index: u32,
    seeds: [u32; 2],
}

impl KernelTask for Pair {
    type Output = [Set; 2];

    #[inline(always)]
    fn run<K: Kernels>(self) -> [Set; 2] {
        K::sobol_4d(self.index, self.seeds)
    }
}

/// The first two numbers of a set, as a point of the unit square: the best pair of the sequence, with a point in each
/// elementary interval.
pub fn point(set: &Set) -> Vec2 {
    Vec2::new(set[0], set[1])
}

/// The two numbers of a set beside its [`point`].
pub fn rest(set: &Set) -> [f32; 2] {
    [set[2], set[3]]
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_value_depends_on_pixel_sample_purpose_and_seed_alone() {
        let a = Sampler::new(3, 4, 5, 6).set(Purpose::Camera);
        assert_eq!(a, Sampler::new(3, 4, 5, 6).set(Purpose::Camera));
        for other in [Sampler::new(4, 3, 5, 6), Sampler::new(3, 4, 6, 6), Sampler::new(3, 4, 5, 7)] {
            assert_ne!(a, other.set(Purpose::Camera));
        }
        assert_ne!(a, Sampler::new(3, 4, 5, 6).set(Purpose::Bsdf { bounce: 0 }));
    }

    #[test]
    fn every_set_is_stratified_over_the_samples_of_a_pixel() {
        for purpose in [Purpose::Camera, Purpose::Light { slot: 1, bounce: 2 }, Purpose::Bsdf { bounce: 3 }] {
            for dimension in 0..4 {
                let mut seen = [false; 64];
                for index in 0..64 {
                    let x = Sampler::new(10, 20, index, 1).set(purpose)[dimension];
                    seen[(x * 64.0) as usize] = true;
                }
                assert!(seen.iter().all(|&s| s), "one sample in each of 64 strata");
            }
        }
    }

    #[test]
    fn long_renders_go_on_past_the_sequence() {
        let x = Sampler::new(0, 0, 1 << 16, 1).set(Purpose::Camera);
        assert_ne!(x, Sampler::new(0, 0, 0, 1).set(Purpose::Camera));
    }
}

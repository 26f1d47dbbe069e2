//! The sampler: Owen-scrambled Sobol points (Burley 2020, "Practical Hash-based Owen Scrambling"), one sequence per
//! pixel.
//!
//! A value is a function of (pixel, sample, dimension, seed) alone, so that a picture has the same bits for any number
//! of threads and a single sample can be replayed. Dimensions come in sets of four; each set is the four-dimensional
//! Sobol sequence under its own scramble (padding): within a set, all samples of a pixel are stratified together.
//!
//! The sequence is that of the crate `sobol_burley`, to the bit; here two sets are computed at once, in eight lanes.

use super::simd::{self, KernelTask, Kernels};
use glam::Vec2;

/// Four stratified numbers in [0, 1): a sample of four dimensions.
pub type Set = [f32; 4];

/// The sets of dimensions of a path.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Dimensions {
    /// Point in the pixel, point on the lens.
    Camera,
    /// Point on a light, choice of the light.
    Light {
        /// Index among the lights that are sampled at the vertex.
        slot: u32,
        /// Depth of the vertex, from 0.
        depth: u32,
    },
    /// Direction, choice of a lobe, Russian roulette.
    Bsdf {
        /// Depth of the vertex, from 0.
        depth: u32,
    },
    /// The moment of the exposure.
    Time,
    /// Start of a walk under the surface: direction, distance, technique; and the stream of numbers for the rest of it.
    Subsurface {
        /// Depth of the vertex, from 0.
        depth: u32,
    },
}

/// Independent random numbers, for computations of unknown length.
#[derive(Clone, Debug)]
pub struct NumberStream(u64);

impl NumberStream {
    /// Returns the next number in [0, 1) (PCG-XSH-RR: O'Neill 2014, "PCG: A Family of Simple Fast Space-Efficient
    /// Statistically Good Algorithms for Random Number Generation").
    #[inline(always)]
    pub fn next(&mut self) -> f32 {
        let state = self.0;
        self.0 = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        let bits = ((((state >> 18) ^ state) >> 27) as u32).rotate_right((state >> 59) as u32);
        (bits >> 8) as f32 * (1.0 / (1 << 24) as f32)
    }

    /// Returns the next two numbers.
    #[inline(always)]
    pub fn unit_square(&mut self) -> Vec2 {
        Vec2::new(self.next(), self.next())
    }
}

/// The random numbers of one sample of one pixel.
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

/// Hashes a number (Wellons' lowbias32).
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
        // The sequence has 2^16 points; later samples have another scramble.
        let epoch = index >> 16;
        let pixel_seed = hash(x ^ hash(y ^ hash(seed ^ hash(epoch))));
        Sampler { id: SampleId { x, y, index, seed }, pixel_seed, index: index & 0xffff }
    }

    /// The sample.
    pub fn id(&self) -> SampleId {
        self.id
    }

    /// The random numbers of one of `count` paths into which the sample's path splits. The paths of all samples of a
    /// pixel are stratified together.
    pub fn split(&self, path: u32, count: u32) -> Self {
        let SampleId { x, y, index, seed } = self.id;
        Sampler::new(x, y, index.wrapping_mul(count).wrapping_add(path), seed)
    }

    /// The numbers of a set of dimensions.
    #[inline]
    pub fn set(&self, dimensions: Dimensions) -> Set {
        self.pair(dimensions, dimensions)[0]
    }

    /// The numbers of a set of dimensions, and a stream of others.
    pub fn set_and_stream(&self, dimensions: Dimensions) -> (Set, NumberStream) {
        let seed = hash(self.pixel_seed ^ hash(!dimensions.key()));
        let mut stream = NumberStream(u64::from(seed) << 32 | u64::from(hash(seed ^ self.index)));
        stream.next();
        (self.set(dimensions), stream)
    }

    /// The numbers of two sets of dimensions, at the cost of one.
    #[inline]
    pub fn pair(&self, first: Dimensions, second: Dimensions) -> [Set; 2] {
        self.pair_with(first, self, second)
    }

    /// The numbers of a set of dimensions, and those of a set of another sample, at the cost of one.
    #[inline]
    pub fn pair_with(&self, dimensions: Dimensions, other: &Sampler, others: Dimensions) -> [Set; 2] {
        let seed = |sampler: &Sampler, dimensions: Dimensions| hash(sampler.pixel_seed ^ hash(dimensions.key()));
        let seeds = [seed(self, dimensions), seed(other, others)];
        simd::dispatch(Pair { indices: [self.index, other.index], seeds })
    }
}

impl Dimensions {
    /// A number that identifies the set.
    fn key(self) -> u32 {
        match self {
            Dimensions::Camera => 0,
            Dimensions::Time => 1 << 31,
            Dimensions::Bsdf { depth } => 1 + 2 * depth,
            Dimensions::Light { slot, depth } => (2 + 2 * depth) | (slot << 16),
            Dimensions::Subsurface { depth } => (1 + 2 * depth) | (1 << 16),
        }
    }
}

/// The computation of [`Sampler::pair_with`].
struct Pair {
    indices: [u32; 2],
    seeds: [u32; 2],
}

impl KernelTask for Pair {
    type Output = [Set; 2];

    #[inline(always)]
    fn run<K: Kernels>(self) -> [Set; 2] {
        K::sobol_4d(self.indices, self.seeds)
    }
}

/// The first two numbers of a set, as a point of the unit square: the best stratified pair of the sequence, with a
/// point in each elementary interval.
pub fn first_pair(set: &Set) -> Vec2 {
    Vec2::new(set[0], set[1])
}

/// The last two numbers of a set.
pub fn last_pair(set: &Set) -> [f32; 2] {
    [set[2], set[3]]
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_value_depends_on_pixel_sample_dimensions_and_seed_alone() {
        let a = Sampler::new(3, 4, 5, 6).set(Dimensions::Camera);
        assert_eq!(a, Sampler::new(3, 4, 5, 6).set(Dimensions::Camera));
        for other in [Sampler::new(4, 3, 5, 6), Sampler::new(3, 4, 6, 6), Sampler::new(3, 4, 5, 7)] {
            assert_ne!(a, other.set(Dimensions::Camera));
        }
        assert_ne!(a, Sampler::new(3, 4, 5, 6).set(Dimensions::Bsdf { depth: 0 }));
    }

    #[test]
    fn every_set_is_stratified_over_the_samples_of_a_pixel() {
        for dimensions in [Dimensions::Camera, Dimensions::Light { slot: 1, depth: 2 }, Dimensions::Bsdf { depth: 3 }] {
            for index_in_set in 0..4 {
                let mut is_sampled = [false; 64];
                for index in 0..64 {
                    let x = Sampler::new(10, 20, index, 1).set(dimensions)[index_in_set];
                    is_sampled[(x * 64.0) as usize] = true;
                }
                assert!(is_sampled.iter().all(|&s| s), "one sample in each of 64 strata");
            }
        }
    }

    #[test]
    fn samples_beyond_the_sequence_have_another_scramble() {
        let x = Sampler::new(0, 0, 1 << 16, 1).set(Dimensions::Camera);
        assert_ne!(x, Sampler::new(0, 0, 0, 1).set(Dimensions::Camera));
    }
}

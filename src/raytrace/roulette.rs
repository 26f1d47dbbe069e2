//! Russian roulette.

use crate::color::luminance;
use glam::Vec3;

/// Depth from which dim paths may be ended.
const MIN_DEPTH: u32 = 1;
/// Survival probability from there on, per throughput. With 1 in place of 2, matte and glossy bodies have 25 % more
/// variance times rays, with depth 3 in place of 1 portraits have up to 35 % more: paths in hair are long and dim.
const SURVIVAL_PER_THROUGHPUT: f32 = 2.0;
/// Depth from which bright paths may be ended, too.
const MIN_DEPTH_OF_BRIGHT: u32 = 3;
/// The largest survival probability from there on.
const MAX_SURVIVAL: f32 = 0.95;

/// Survival probability of a path. `scale` is the part of the throughput that does not affect it. 0 for black and NaN.
#[inline]
pub fn survival_probability(throughput: Vec3, scale: f32, depth: u32) -> f32 {
    let relative = throughput.max_element() / scale;
    if relative.is_nan() || relative <= 0.0 {
        0.0
    } else if depth < MIN_DEPTH {
        1.0
    } else {
        let largest = if depth < MIN_DEPTH_OF_BRIGHT { 1.0 } else { MAX_SURVIVAL };
        (relative * SURVIVAL_PER_THROUGHPUT).min(largest)
    }
}

/// Ends a path, or divides its throughput by the survival probability, for a random number in [0, 1). Returns true if
/// the path survives with a finite throughput.
#[inline]
pub fn survives(throughput: &mut Vec3, survival: f32, u: f32) -> bool {
    if u >= survival {
        return false;
    }
    if survival != 1.0 {
        *throughput /= survival;
    }
    luminance(*throughput).is_finite()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn black_nan_and_infinite_paths_end_and_bright_ones_keep_their_mean() {
        for dark in [Vec3::ZERO, Vec3::NAN, Vec3::NEG_ONE] {
            assert!(!survives(&mut dark.clone(), survival_probability(dark, 1.0, 0), 0.0));
        }
        assert!(!survives(&mut Vec3::INFINITY.clone(), survival_probability(Vec3::INFINITY, 1.0, 0), 0.0));
        assert_eq!(survival_probability(Vec3::splat(0.01), 1.0, 0), 1.0);
        assert_eq!(survival_probability(Vec3::splat(0.01), 1.0, 1), 0.02);
        assert_eq!(survival_probability(Vec3::splat(4.0), 1.0, 2), 1.0);
        assert_eq!(survival_probability(Vec3::splat(4.0), 1.0, 3), 0.95);
        let (half, mut throughput) = (survival_probability(Vec3::splat(2.0), 8.0, 9), Vec3::splat(2.0));
        assert!(!survives(&mut throughput, half, 0.5) && survives(&mut throughput, half, 0.49));
        assert_eq!((half, throughput), (0.5, Vec3::splat(4.0)));
    }
}

//! Russian roulette.

use crate::color::luminance;
use glam::Vec3;

/// Depth from which paths may be ended.
const MIN_DEPTH: u32 = 3;
/// Non-specular vertices from which camera paths may be ended: the first one of a picture's surface always goes on.
const MIN_NON_SPECULAR_DEPTH: u32 = 2;
/// Survival probability of a camera path over the part of its light that it still carries. With it, and from the second
/// non-specular vertex on, three_point needs 23 % fewer rays for the same noise than with 1 and from the third vertex
/// on; rembrandt and high_key 5 and 2 %.
const SURVIVAL_OVER_THROUGHPUT: f32 = 2.0;
/// The largest survival probability from there on.
const MAX_SURVIVAL: f32 = 0.95;

/// Returns the survival probability of a camera path. `scale` is the part of the throughput that does not affect it. 0
/// for black and NaN.
#[inline]
pub fn path_survival(throughput: Vec3, scale: f32, depth: u32, non_specular_depth: u32) -> f32 {
    let may_end = depth >= MIN_DEPTH || non_specular_depth >= MIN_NON_SPECULAR_DEPTH;
    survival_probability(SURVIVAL_OVER_THROUGHPUT * throughput.max_element() / scale, may_end)
}

/// Returns the survival probability of a photon. 0 for black and NaN.
#[inline]
pub fn photon_survival(throughput: Vec3, depth: u32) -> f32 {
    survival_probability(throughput.max_element(), depth >= MIN_DEPTH)
}

fn survival_probability(relative: f32, may_end: bool) -> f32 {
    if relative.is_nan() || relative <= 0.0 {
        0.0
    } else if may_end {
        relative.min(MAX_SURVIVAL)
    } else {
        1.0
    }
}

/// Ends a path, or divides its throughput by the survival probability, for a random number in [0, 1). Returns true if
/// the path survives with a finite throughput.
#[inline]
pub fn survives(throughput: &mut Vec3, survival: f32, u: f32) -> bool {
    if u >= survival {
        return false;
    }
    if survival == 1.0 {
        return true;
    }
    *throughput /= survival;
    luminance(*throughput).is_finite()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn black_and_nan_paths_end_and_bright_ones_keep_their_mean() {
        for dark in [Vec3::ZERO, Vec3::NAN, Vec3::NEG_ONE] {
            assert!(!survives(&mut dark.clone(), path_survival(dark, 1.0, 0, 1), 0.0));
        }
        assert_eq!(path_survival(Vec3::splat(0.01), 1.0, 2, 1), 1.0, "few vertices");
        assert_eq!(path_survival(Vec3::splat(4.0), 1.0, 1, 2), 0.95);
        assert_eq!((photon_survival(Vec3::splat(0.5), 2), photon_survival(Vec3::splat(0.5), 3)), (1.0, 0.5));
        let (half, mut throughput) = (path_survival(Vec3::splat(1.0), 4.0, 9, 0), Vec3::splat(2.0));
        assert!(!survives(&mut throughput, half, 0.5) && survives(&mut throughput, half, 0.49));
        assert_eq!((half, throughput), (0.5, Vec3::splat(4.0)));
    }
}

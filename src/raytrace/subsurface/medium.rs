//! The participating medium under a surface.

use crate::math::safe_sqrt;
use glam::Vec3;

/// Decay rate by which walks are guided, relative to that of the asymptotic solution: less, since light through thin
/// parts goes the other way.
const GUIDED_PART: f32 = 0.8;
/// Range of that rate. Most light of a dark medium scatters once, and does not follow the asymptotic solution.
const GUIDED_DECAY: (f32, f32) = (1e-3, 0.8);

/// A medium that scatters isotropically, per colour channel.
#[derive(Clone, Copy, Debug)]
pub struct Medium {
    /// Albedo of a thick flat body under diffuse light.
    pub diffuse_albedo: Vec3,
    /// Extinction coefficient, 1/m: the inverse mean free path.
    pub extinction: Vec3,
    /// Single-scattering albedo.
    pub albedo: Vec3,
    /// Rate by which walks are guided, relative to the extinction: [`GUIDED_PART`] of the inverse of the asymptotic
    /// relaxation length in mean free paths. Its precision does not matter.
    pub decay: Vec3,
    /// The directions of guided walks.
    pub guide: Guide,
}

/// The directions of guided walks.
#[derive(Clone, Copy, Debug)]
pub struct Guide {
    /// Ratio of the densities of guided and of uniform directions, without its dependence on the direction:
    /// 2 k / ln((1 + k) / (1 - k)) for a decay k.
    pub direction: Vec3,
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
    pub fn sample_cos(&self, decay: Vec3, channel: usize, u: f32) -> f32 {
        let (k, log_ratio) = (decay[channel], self.log_ratio[channel]);
        let e = (-u * log_ratio).exp_m1();
        ((-e - k * (1.0 + e)) / k).clamp(-1.0, 1.0)
    }
}

impl Medium {
    /// Returns the medium whose thick flat body has this diffuse albedo.
    pub fn new(extinction: Vec3, diffuse_albedo: Vec3) -> Self {
        let s = diffuse_albedo.map(similarity_parameter);
        // The relaxation length is the root of k = tanh(k / a) (Case and Zweifel 1967, "Linear Transport Theory",
        // section 4.4), here a fit within 2 %
        let sqrt3 = 3.0_f32.sqrt();
        let decay = s * (Vec3::splat(sqrt3) - s * s * (sqrt3 - 1.0));
        let (low, high) = GUIDED_DECAY;
        let decay = (GUIDED_PART * decay).clamp(Vec3::splat(low), Vec3::splat(high));
        Medium { diffuse_albedo, extinction, albedo: Vec3::ONE - s * s, decay, guide: Guide::new(decay) }
    }
}

/// Returns sqrt(1 - a) of the single-scattering albedo a with which a half-space has a diffuse albedo.
///
/// The albedo of a half-space under diffuse light, with isotropic scattering and a matched boundary, is
/// 1 - 2 sqrt(1 - a) times the first moment of Chandrasekhar's H function (Chandrasekhar 1960, "Radiative Transfer",
/// chapter V). This rational function is our fit of its inverse; the albedo of the result is within 0.003 %. (The
/// better-known one by van de Hulst is 1.4 % too low at 0.15.)
fn similarity_parameter(diffuse_albedo: f32) -> f32 {
    let a = diffuse_albedo.clamp(0.0, 1.0);
    let ratio = (1.0 + a * (0.960_26 + a * 0.016_821)) / (1.0 + a * (2.403_93 + a * 1.161_88));
    safe_sqrt(((1.0 - a) * ratio).powi(2)).min(1.0)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::math::gauss_legendre;

    /// Returns the albedo of a half-space under diffuse light from Chandrasekhar's H function, by iteration of its
    /// integral equation.
    fn half_space_albedo(albedo: f64) -> f64 {
        let nodes = gauss_legendre::<48>();
        let root = (1.0 - albedo).sqrt();
        let mut h = vec![1.0; nodes.len()];
        for _ in 0..4000 {
            let integral = |mu: f64| nodes.iter().zip(&h).map(|((x, w), h)| w * x * h / (mu + x)).sum::<f64>();
            let next: Vec<f64> = nodes.iter().map(|(mu, _)| 1.0 / (root + 0.5 * albedo * integral(*mu))).collect();
            let change = next.iter().zip(&h).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max);
            h = next;
            if change < 1e-10 {
                break;
            }
        }
        1.0 - 2.0 * root * nodes.iter().zip(&h).map(|((x, w), h)| w * x * h).sum::<f64>()
    }

    #[test]
    fn the_albedo_inversion_agrees_with_chandrasekhars_h_function() {
        for diffuse in [0.02, 0.05, 0.1, 0.2, 0.3, 0.4, 0.5, 0.6, 0.7, 0.8, 0.9, 0.95] {
            let medium = Medium::new(Vec3::ONE, Vec3::splat(diffuse));
            let albedo = half_space_albedo(f64::from(medium.albedo.x));
            assert!((albedo / f64::from(diffuse) - 1.0).abs() < 2e-4, "{albedo} for {diffuse}");
        }
        assert_eq!(Medium::new(Vec3::ONE, Vec3::ONE).albedo, Vec3::ONE);
        assert_eq!(Medium::new(Vec3::ONE, Vec3::ZERO).albedo, Vec3::ZERO);
    }

    #[test]
    fn walks_are_guided_by_the_decay_of_the_asymptotic_solution() {
        for diffuse in [0.4, 0.6, 0.8, 0.95] {
            let Medium { albedo, decay, .. } = Medium::new(Vec3::ONE, Vec3::splat(diffuse));
            let exact = (0..10_000).fold(0.999, |k: f32, _| (k / albedo.x).tanh());
            assert!((decay.x / (GUIDED_PART * exact) - 1.0).abs() < 0.03, "{} for {exact}", decay.x);
        }
    }
}

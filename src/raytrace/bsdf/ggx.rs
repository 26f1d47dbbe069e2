//! The GGX microfacet distribution with Smith's height-correlated masking (Walter et al. 2007, Heitz 2014), in a frame
//! whose +Z is the normal. Isotropic; `alpha` is the square of the user's roughness.

use crate::math::{safe_sqrt, sin_cos_turn};
use glam::{Vec2, Vec3};
use std::f32::consts::PI;

/// Alpha below which the lobe is a delta function: single precision does not resolve it.
pub const MIN_ALPHA: f32 = 1e-3;

/// Returns the distribution of normals D(m), 1/sr (Walter et al. 2007, equation 33).
#[inline(always)]
pub fn distribution(m: Vec3, alpha: f32) -> f32 {
    let a2 = alpha * alpha;
    // x2 + y2 is precise near the pole, where 1 - z2 is not.
    let sin2 = m.x * m.x + m.y * m.y;
    let d = m.z * m.z * a2 + sin2;
    if m.z > 0.0 && d > 0.0 { a2 / (PI * d * d) } else { 0.0 }
}

/// Returns Smith's Lambda (Heitz 2014, equation 72). The masking G1 is 1 / (1 + Lambda(o)), the height-correlated
/// masking-shadowing G2 is 1 / (1 + Lambda(o) + Lambda(i)) (equations 43 and 99).
#[inline(always)]
pub fn lambda(w: Vec3, alpha: f32) -> f32 {
    let cos2 = w.z * w.z;
    let tan2 = (1.0 - cos2).max(0.0) / cos2.max(f32::MIN_POSITIVE);
    0.5 * (safe_sqrt(1.0 + alpha * alpha * tan2) - 1.0)
}

/// Samples a facet normal among those that are visible from `wo` (Dupuy and Benyoub 2023, "Sampling Visible GGX Normals
/// with Spherical Caps").
#[inline(always)]
pub fn sample_visible_normal(wo: Vec3, alpha: f32, u: Vec2) -> Vec3 {
    sample_visible_normal_of(wo, Vec2::splat(alpha), u)
}

/// The same for the alphas along X and Y of brushed facets.
#[inline(always)]
pub fn sample_visible_normal_of(wo: Vec3, alpha: Vec2, u: Vec2) -> Vec3 {
    // Warp to the hemisphere configuration
    let stretched = Vec3::new(wo.x * alpha.x, wo.y * alpha.y, wo.z).normalize_or(Vec3::Z);
    // Sample a spherical cap and compute the half vector
    let z = (1.0 - u.y) * (1.0 + stretched.z) - stretched.z;
    let radius = safe_sqrt(1.0 - z * z);
    let (sin, cos) = sin_cos_turn(u.x);
    let h = Vec3::new(radius * cos, radius * sin, z) + stretched;
    // Warp back to the ellipsoid configuration
    Vec3::new(h.x * alpha.x, h.y * alpha.y, h.z.max(0.0)).normalize_or(Vec3::Z)
}

/// Reflects a direction about a facet normal.
#[inline(always)]
pub fn reflect(wo: Vec3, m: Vec3) -> Vec3 {
    2.0 * wo.dot(m) * m - wo
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_projected_area_of_all_facets_is_one() {
        // The integral of D(m) cos(m) over the hemisphere is 1. The tangent is substituted, to resolve the peak.
        for alpha in [0.01_f32, 0.1, 0.5, 1.0] {
            let steps = 4000;
            let mut sum = 0.0_f64;
            for i in 0..steps {
                let s = (f64::from(i) + 0.5) / f64::from(steps);
                let tan = f64::from(alpha) * (s / (1.0 - s)).sqrt();
                let theta = tan.atan();
                let m = Vec3::new(theta.sin() as f32, 0.0, theta.cos() as f32);
                // d(tan2)/ds = alpha2 / (1 - s)2, dw cos = pi cos4 d(tan2).
                let jacobian = f64::from(alpha * alpha) / (1.0 - s).powi(2);
                sum += f64::from(distribution(m, alpha)) * std::f64::consts::PI * theta.cos().powi(4) * jacobian;
            }
            assert!((sum / f64::from(steps) - 1.0).abs() < 1e-3, "alpha {alpha}: {}", sum / f64::from(steps));
        }
    }

    #[test]
    fn sampled_facets_are_visible() {
        for alpha in [0.001, 0.3, 1.0] {
            for wo in [Vec3::Z, Vec3::new(0.999, 0.0, 0.0447), Vec3::new(0.6, 0.0, 0.8)] {
                for i in 0..100 {
                    let u = Vec2::new((i % 10) as f32 / 10.0, (i / 10) as f32 / 10.0);
                    let m = sample_visible_normal(wo, alpha, u);
                    assert!(m.is_finite() && m.z >= 0.0 && m.dot(wo) > -1e-5);
                }
            }
        }
    }
}

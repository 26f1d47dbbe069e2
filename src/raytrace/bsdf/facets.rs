//! The GGX distribution of facets with a roughness for each of two directions along the surface (Burley 2012,
//! "Physically-Based Shading at Disney"; Heitz 2014), in a frame whose +X and +Y are these directions and whose +Z is the
//! normal. With equal alphas it is that of `ggx.rs`.

use super::ggx::{self, MIN_ALPHA};
use crate::math::safe_sqrt;
use glam::{Vec2, Vec3};
use std::f32::consts::PI;

/// Samples along each axis of the unit square of [`Facets::mean_visible`].
const STEPS: [u32; 2] = [32, 24];

/// A distribution of facets. It is never a delta function.
#[derive(Clone, Copy, Debug)]
pub struct Facets {
    alpha: Vec2,
}

impl Facets {
    /// Returns the distribution with these GGX alphas along X and Y.
    pub fn new(alpha: [f32; 2]) -> Self {
        Facets { alpha: Vec2::from(alpha).max(Vec2::splat(MIN_ALPHA)) }
    }

    /// Returns the distribution of normals D(m), 1/sr.
    pub fn distribution(&self, m: Vec3) -> f32 {
        let tilt = Vec2::new(m.x, m.y) / self.alpha;
        let d = tilt.length_squared() + m.z * m.z;
        if m.z > 0.0 { 1.0 / (PI * self.alpha.x * self.alpha.y * d * d) } else { 0.0 }
    }

    /// Returns Smith's Lambda: see [`super::ggx::lambda`].
    pub fn lambda(&self, w: Vec3) -> f32 {
        let projected = (Vec2::new(w.x, w.y) * self.alpha).length_squared();
        0.5 * (safe_sqrt(1.0 + projected / (w.z * w.z).max(f32::MIN_POSITIVE)) - 1.0)
    }

    /// Samples a facet normal among those visible from `wo`: see [`super::ggx::sample_visible_normal`].
    pub fn sample_visible_normal(&self, wo: Vec3, u: Vec2) -> Vec3 {
        ggx::sample_visible_normal_of(wo, self.alpha, u)
    }

    /// Returns BSDF times cosine of reflection by facets, and the density of the reflection of a sampled one, without
    /// rejected samples. `m` is the half vector, `reflectance` that of a facet there; both are scaled by it.
    pub fn eval_reflection(&self, wo: Vec3, wi: Vec3, m: Vec3, reflectance: f32) -> (f32, f32) {
        let (lambda_o, lambda_i) = (self.lambda(wo), self.lambda(wi));
        let shape = self.distribution(m) / (4.0 * wo.z) * reflectance;
        (shape / (1.0 + lambda_o + lambda_i), shape / (1.0 + lambda_o))
    }

    /// Returns the mean of a value over the facets visible from `wo`, by stratified samples.
    pub fn mean_visible(&self, wo: Vec3, value: impl Fn(Vec3) -> f32) -> f32 {
        let [across, up] = STEPS;
        let at = |i: u32, j: u32| Vec2::new((i as f32 + 0.5) / across as f32, (j as f32 + 0.5) / up as f32);
        let sum: f32 = (0..up)
            .flat_map(|j| (0..across).map(move |i| (i, j)))
            .map(|(i, j)| value(self.sample_visible_normal(wo, at(i, j))))
            .sum();
        sum / (across * up) as f32
    }

    /// Returns the directional albedo of reflection by facets of this reflectance, a function of the cosine at a facet.
    pub fn reflected(&self, wo: Vec3, reflectance: impl Fn(f32) -> f32) -> f32 {
        let lambda_o = self.lambda(wo);
        self.mean_visible(wo, |m| {
            let wi = ggx::reflect(wo, m);
            let visible = (1.0 + lambda_o) / (1.0 + lambda_o + self.lambda(wi));
            if wi.z > 0.0 { reflectance(wo.dot(m)) * visible } else { 0.0 }
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::math::warp;
    use crate::statistics::TestRng;

    #[test]
    fn equal_alphas_are_the_isotropic_distribution() {
        let mut rng = TestRng::new(81);
        for alpha in [0.05, 0.3, 1.0] {
            let facets = Facets::new([alpha; 2]);
            for _ in 0..50 {
                let (w, u) = (warp::cosine_hemisphere(rng.unit_square()), rng.unit_square());
                let close = |a: f32, b: f32| assert!((a - b).abs() < 1e-3 * (1e-3 + b), "{alpha}: {a} for {b}");
                close(facets.distribution(w), ggx::distribution(w, alpha));
                close(facets.lambda(w), ggx::lambda(w, alpha));
                let m = facets.sample_visible_normal(w, u);
                assert!((m - ggx::sample_visible_normal(w, alpha, u)).length() < 1e-5);
            }
        }
    }

    #[test]
    fn the_projected_area_of_brushed_facets_is_one() {
        // The integral of D(m) cos(m) over the hemisphere, with cosine-weighted stratified directions: pi times the mean
        let facets = Facets::new([0.6, 0.25]);
        let n = 300;
        let at = |i: u32| (i as f32 + 0.5) / n as f32;
        let directions = (0..n * n).map(|i| warp::cosine_hemisphere(Vec2::new(at(i % n), at(i / n))));
        let mean = directions.map(|m| f64::from(facets.distribution(m))).sum::<f64>() / f64::from(n * n);
        assert!((mean * std::f64::consts::PI - 1.0).abs() < 2e-3, "{}", mean * std::f64::consts::PI);
    }
}

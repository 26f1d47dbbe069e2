//! Sampling warps from the unit square to discs and directions, with their densities.

use super::{sin_cos_eighth, sin_cos_turn};
use glam::{Vec2, Vec3};
use std::f32::consts::{FRAC_PI_4, PI, TAU};

/// Samples a point uniformly in the unit disc. The map is area preserving and continuous (Shirley and Chiu 1997, "A Low
/// Distortion Map Between Disk and Square"). Density 1 / pi.
#[inline(always)]
pub fn concentric_disc(u: Vec2) -> Vec2 {
    let offset = 2.0 * u - Vec2::ONE;
    let is_x_major = offset.x.abs() > offset.y.abs();
    let (radius, other) = if is_x_major { (offset.x, offset.y) } else { (offset.y, offset.x) };
    let ratio = if radius == 0.0 { 0.0 } else { other / radius };
    let (sin, cos) = sin_cos_eighth(FRAC_PI_4 * ratio);
    let (major, minor) = (radius * cos, radius * sin);
    if is_x_major { Vec2::new(major, minor) } else { Vec2::new(minor, major) }
}

/// Samples a cosine-weighted direction about +Z (Malley's method). Density cos / pi, 1/sr.
#[inline(always)]
pub fn cosine_hemisphere(u: Vec2) -> Vec3 {
    let disc = concentric_disc(u);
    Vec3::new(disc.x, disc.y, (1.0 - disc.length_squared()).max(0.0).sqrt())
}

/// Returns the density of [`cosine_hemisphere`], 1/sr.
#[inline(always)]
pub fn cosine_hemisphere_pdf(cos_theta: f32) -> f32 {
    cos_theta.max(0.0) / PI
}

/// Samples a direction uniformly on the sphere. Density 1 / 4 pi, 1/sr.
pub fn uniform_sphere(u: Vec2) -> Vec3 {
    about_z(1.0 - 2.0 * u.x, u.y)
}

/// Returns the unit vector with this Z, at a turn in [0, 1) about +Z.
#[inline(always)]
pub fn about_z(z: f32, turn: f32) -> Vec3 {
    let radius = (1.0 - z * z).max(0.0).sqrt();
    let (sin, cos) = sin_cos_turn(turn);
    Vec3::new(radius * cos, radius * sin, z)
}

/// Samples a direction uniformly in a cone about +Z, given `1 - cos` of its half angle, which is precise for narrow
/// cones. Density 1 / (2 pi (1 - cos)), 1/sr.
pub fn uniform_cone(u: Vec2, one_minus_cos: f32) -> Vec3 {
    let drop = u.x * one_minus_cos;
    let sin_theta = (drop * (2.0 - drop)).max(0.0).sqrt();
    let (sin, cos) = sin_cos_turn(u.y);
    Vec3::new(sin_theta * cos, sin_theta * sin, 1.0 - drop)
}

/// Returns the density of [`uniform_cone`], 1/sr.
pub fn uniform_cone_pdf(one_minus_cos: f32) -> f32 {
    1.0 / (TAU * one_minus_cos)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::statistics::{ChiSquare, TestRng, sidak_level};

    #[test]
    fn samples_are_unit_vectors_in_range() {
        for i in 0..64 {
            for j in 0..64 {
                let u = Vec2::new(i as f32 / 63.0, j as f32 / 63.0);
                assert!(concentric_disc(u).length() <= 1.0 + 1e-6);
                assert!((cosine_hemisphere(u).length() - 1.0).abs() < 1e-5);
                assert!((uniform_sphere(u).length() - 1.0).abs() < 1e-5);
                let cone = uniform_cone(u, 0.25);
                assert!((cone.length() - 1.0).abs() < 1e-5 && cone.z >= 0.75 - 1e-6);
            }
        }
    }

    /// Returns the p-value of a chi-square test for uniform samples in the unit square.
    fn uniformity_p_value(seed: u64, cell: impl Fn(Vec2) -> (f32, f32)) -> f64 {
        const CELLS: usize = 16;
        const SAMPLES: usize = 100_000;
        let mut rng = TestRng::new(seed);
        let mut counts = vec![0.0; CELLS * CELLS];
        for _ in 0..SAMPLES {
            let (u, v) = cell(rng.unit_square());
            let index = |x: f32| ((x * CELLS as f32) as usize).min(CELLS - 1);
            counts[index(v) * CELLS + index(u)] += 1.0;
        }
        let mut test = ChiSquare::default();
        counts.iter().for_each(|&c| test.add_bin(c, SAMPLES as f64 / (CELLS * CELLS) as f64));
        test.p_value()
    }

    fn turn(x: f32, y: f32) -> f32 {
        let turn = y.atan2(x) / TAU;
        turn - turn.floor()
    }

    #[test]
    fn every_warp_follows_its_density() {
        // Each sample is mapped back to the unit square by the cumulative distribution (squared radius, sin2, height, 1
        // - cos) and the azimuth.
        let broad_cone = |w: Vec3| ((1.0 - w.z) / 0.5, turn(w.x, w.y));
        // 1 - cos of a narrow cone from the sine: its cosine rounds to 1.
        let narrow_cone = |w: Vec3| ((w.x * w.x + w.y * w.y) / 2e-8, turn(w.x, w.y));
        let results = [
            uniformity_p_value(1, |u| {
                (concentric_disc(u).length_squared(), turn(concentric_disc(u).x, concentric_disc(u).y))
            }),
            uniformity_p_value(2, |u| {
                let w = cosine_hemisphere(u);
                (w.x * w.x + w.y * w.y, turn(w.x, w.y))
            }),
            uniformity_p_value(3, |u| {
                (0.5 - 0.5 * uniform_sphere(u).z, turn(uniform_sphere(u).x, uniform_sphere(u).y))
            }),
            uniformity_p_value(4, |u| broad_cone(uniform_cone(u, 0.5))),
            uniformity_p_value(5, |u| narrow_cone(uniform_cone(u, 1e-8))),
        ];
        for (warp, p) in results.iter().enumerate() {
            assert!(*p > sidak_level(results.len()), "warp {warp}: p = {p}");
        }
    }

    #[test]
    fn pdfs_have_their_closed_forms() {
        for cos in [0.0, 0.3, 1.0] {
            assert_eq!(cosine_hemisphere_pdf(cos), cos / PI);
        }
        assert_eq!(cosine_hemisphere_pdf(-0.1), 0.0);
        assert!((uniform_cone_pdf(2.0) - 1.0 / (4.0 * PI)).abs() < 1e-8);
    }
}

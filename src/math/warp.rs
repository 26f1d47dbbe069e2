//! Maps from the unit square to directions and discs, with the densities they have.

use super::{sin_cos_eighth, sin_cos_turn};
use glam::{Vec2, Vec3};
use std::f32::consts::{FRAC_PI_4, PI, TAU};

/// Uniform point of the unit disc, area preserving and continuous (Shirley and Chiu 1997). Density 1 / pi.
pub fn concentric_disc(u: Vec2) -> Vec2 {
    let offset = 2.0 * u - Vec2::ONE;
    let wide = offset.x.abs() > offset.y.abs();
    let (radius, other) = if wide { (offset.x, offset.y) } else { (offset.y, offset.x) };
    let ratio = if radius == 0.0 { 0.0 } else { other / radius };
    let (sin, cos) = sin_cos_eighth(FRAC_PI_4 * ratio);
    let (along, across) = (radius * cos, radius * sin);
    if wide { Vec2::new(along, across) } else { Vec2::new(across, along) }
}

/// Cosine-weighted direction about +Z. Density cos / pi in solid angle.
pub fn cosine_hemisphere(u: Vec2) -> Vec3 {
    let disc = concentric_disc(u);
    Vec3::new(disc.x, disc.y, (1.0 - disc.length_squared()).max(0.0).sqrt())
}

/// Density of [`cosine_hemisphere`], 1/sr.
pub fn cosine_hemisphere_pdf(cos_theta: f32) -> f32 {
    cos_theta.max(0.0) / PI
}

/// Uniform direction on the sphere. Density 1 / 4 pi.
pub fn uniform_sphere(u: Vec2) -> Vec3 {
    let z = 1.0 - 2.0 * u.x;
    let radius = (1.0 - z * z).max(0.0).sqrt();
    let (sin, cos) = sin_cos_turn(u.y);
    Vec3::new(radius * cos, radius * sin, z)
}

/// Uniform direction in a cone about +Z, given `1 - cos` of its half angle (which keeps its digits for thin cones).
/// Density 1 / (2 pi (1 - cos)).
pub fn uniform_cone(u: Vec2, one_minus_cos: f32) -> Vec3 {
    let drop = u.x * one_minus_cos;
    let sin_theta = (drop * (2.0 - drop)).max(0.0).sqrt();
    let (sin, cos) = sin_cos_turn(u.y);
    Vec3::new(sin_theta * cos, sin_theta * sin, 1.0 - drop)
}

/// Density of [`uniform_cone`], 1/sr.
pub fn uniform_cone_pdf(one_minus_cos: f32) -> f32 {
    1.0 / (TAU * one_minus_cos)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::statistics::{ChiSquare, TestRng, sidak_level};

    #[test]
    fn directions_are_unit_and_in_range() {
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

    /// p-value of samples that should fall evenly into the cells of a unit square.
    fn evenly(seed: u64, cell: impl Fn(Vec2) -> (f32, f32)) -> f64 {
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
        // Each maps back to the unit square by its cumulative density: radius squared, sin2, height, drop; azimuth.
        let wide_cone = |w: Vec3| ((1.0 - w.z) / 0.5, turn(w.x, w.y));
        // 1 - cos of a thin cone from the sine: its cosine has no digits.
        let thin_cone = |w: Vec3| ((w.x * w.x + w.y * w.y) / 2e-8, turn(w.x, w.y));
        let results = [
            evenly(1, |u| (concentric_disc(u).length_squared(), turn(concentric_disc(u).x, concentric_disc(u).y))),
            evenly(2, |u| {
                let w = cosine_hemisphere(u);
                (w.x * w.x + w.y * w.y, turn(w.x, w.y))
            }),
            evenly(3, |u| (0.5 - 0.5 * uniform_sphere(u).z, turn(uniform_sphere(u).x, uniform_sphere(u).y))),
            evenly(4, |u| wide_cone(uniform_cone(u, 0.5))),
            evenly(5, |u| thin_cone(uniform_cone(u, 1e-8))),
        ];
        for (warp, p) in results.iter().enumerate() {
            assert!(*p > sidak_level(results.len()), "warp {warp}: p = {p}");
        }
    }

    #[test]
    fn densities_are_those_of_the_shapes() {
        for cos in [0.0, 0.3, 1.0] {
            assert_eq!(cosine_hemisphere_pdf(cos), cos / PI);
        }
        assert_eq!(cosine_hemisphere_pdf(-0.1), 0.0);
        assert!((uniform_cone_pdf(2.0) - 1.0 / (4.0 * PI)).abs() < 1e-8);
    }
}

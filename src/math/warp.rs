//! Maps from the unit square to directions and discs, with the densities they have.

use glam::{Vec2, Vec3};
use std::f32::consts::{FRAC_PI_2, FRAC_PI_4, PI, TAU};

/// Uniform point of the unit disc, area preserving and continuous (Shirley and Chiu 1997). Density 1 / pi.
pub fn concentric_disc(u: Vec2) -> Vec2 {
    let offset = 2.0 * u - Vec2::ONE;
    if offset == Vec2::ZERO {
        return Vec2::ZERO;
    }
    let (radius, angle) = if offset.x.abs() > offset.y.abs() {
        (offset.x, FRAC_PI_4 * (offset.y / offset.x))
    } else {
        (offset.y, FRAC_PI_2 - FRAC_PI_4 * (offset.x / offset.y))
    };
    radius * Vec2::new(angle.cos(), angle.sin())
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
    let (sin, cos) = (TAU * u.y).sin_cos();
    Vec3::new(radius * cos, radius * sin, z)
}

/// Uniform direction in a cone about +Z, given `1 - cos` of its half angle (which keeps its digits for thin cones).
/// Density 1 / (2 pi (1 - cos)).
pub fn uniform_cone(u: Vec2, one_minus_cos: f32) -> Vec3 {
    let drop = u.x * one_minus_cos;
    let sin_theta = (drop * (2.0 - drop)).max(0.0).sqrt();
    let (sin, cos) = (TAU * u.y).sin_cos();
    Vec3::new(sin_theta * cos, sin_theta * sin, 1.0 - drop)
}

/// Density of [`uniform_cone`], 1/sr.
pub fn uniform_cone_pdf(one_minus_cos: f32) -> f32 {
    1.0 / (TAU * one_minus_cos)
}

#[cfg(test)]
mod tests {
    use super::*;

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

    #[test]
    fn the_disc_is_filled_evenly() {
        let n = 200;
        let inside = (0..n * n)
            .filter(|i| {
                let u = Vec2::new((i % n) as f32 + 0.5, (i / n) as f32 + 0.5) / n as f32;
                concentric_disc(u).length() < 0.5
            })
            .count();
        // A quarter of the area lies within half the radius; the grid errs by its boundary cells.
        assert!((inside as f32 / (n * n) as f32 - 0.25).abs() < 0.01);
    }
}

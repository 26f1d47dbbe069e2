//! A spherical emitter of uniform luminance, sampled uniformly in the cone that it subtends.

use crate::math::{orthonormal_basis, safe_sqrt, warp};
use glam::{Vec2, Vec3};

/// A sphere that emits outwards.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Sphere {
    /// Centre.
    pub centre: Vec3,
    /// Radius, metres.
    pub radius: f32,
}

impl Sphere {
    /// Returns 1 - cos of the half angle of the cone that the sphere subtends; none from inside, as it emits outwards.
    fn one_minus_cos(&self, from: Vec3) -> Option<f32> {
        let sin2 = self.radius * self.radius / (self.centre - from).length_squared();
        // 1 - cos without cancellation for small spheres.
        (sin2 < 1.0).then(|| sin2 / (1.0 + safe_sqrt(1.0 - sin2)))
    }

    /// Returns the distance at which a ray from outside enters the sphere, in multiples of `direction`.
    pub fn intersect(&self, origin: Vec3, direction: Vec3) -> Option<f32> {
        let to = self.centre - origin;
        let length2 = direction.length_squared();
        let along = to.dot(direction) / length2;
        // Vector from the ray to the centre, by rejection: no cancellation of large squares.
        let rejection = to - direction * along;
        let half_chord2 = self.radius * self.radius - rejection.length_squared();
        let is_outside = to.length_squared() > self.radius * self.radius;
        (half_chord2 >= 0.0 && along > 0.0 && is_outside).then(|| along - (half_chord2 / length2).sqrt())
    }

    /// Samples a unit direction uniformly in the subtended cone. Returns it with the distance to the surface and the
    /// density, 1/sr.
    pub fn sample(&self, from: Vec3, u: Vec2) -> Option<(Vec3, f32, f32)> {
        let one_minus_cos = self.one_minus_cos(from)?;
        let axis = (self.centre - from).try_normalize()?;
        let (tangent, bitangent) = orthonormal_basis(axis);
        let local = warp::uniform_cone(u, one_minus_cos);
        let direction = (tangent * local.x + bitangent * local.y + axis * local.z).normalize();
        // At the limb, rounding may make the direction miss: use the distance of the tangent point.
        let limb = safe_sqrt((self.centre - from).length_squared() - self.radius * self.radius);
        let distance = self.intersect(from, direction).unwrap_or(limb);
        Some((direction, distance, warp::uniform_cone_pdf(one_minus_cos)))
    }

    /// Returns the density of [`Sphere::sample`] for a direction that hits the sphere, 1/sr.
    pub fn pdf(&self, from: Vec3) -> f32 {
        self.one_minus_cos(from).map_or(0.0, warp::uniform_cone_pdf)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn samples_hit_the_sphere() {
        let sphere = Sphere { centre: Vec3::new(1.0, 2.0, 3.0), radius: 0.05 };
        for i in 0..256 {
            let u = Vec2::new((i % 16) as f32 + 0.5, (i / 16) as f32 + 0.5) / 16.0;
            let (direction, distance, pdf) = sphere.sample(Vec3::ZERO, u).unwrap();
            let surface = direction * distance - sphere.centre;
            assert!((surface.length() - 0.05).abs() < 1e-4 && pdf == sphere.pdf(Vec3::ZERO));
        }
    }

    #[test]
    fn a_sphere_is_invisible_from_inside() {
        let sphere = Sphere { centre: Vec3::ZERO, radius: 1.0 };
        assert!(sphere.sample(Vec3::X * 0.5, Vec2::splat(0.5)).is_none());
        assert!(sphere.intersect(Vec3::X * 0.5, Vec3::X).is_none());
    }
}

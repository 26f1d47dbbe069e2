//! A ball that shines evenly: sampled by the cone under which it is seen.

use crate::math::{orthonormal_basis, safe_sqrt, warp};
use glam::{Vec2, Vec3};

/// A luminous ball.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Ball {
    /// Centre.
    pub centre: Vec3,
    /// Radius, metres.
    pub radius: f32,
}

impl Ball {
    /// 1 - cos of half the cone under which the ball is seen; none from inside, where there is nothing to see: it
    /// shines outwards.
    fn one_minus_cos(&self, from: Vec3) -> Option<f32> {
        let sin2 = self.radius * self.radius / (self.centre - from).length_squared();
        // 1 - cos without cancellation for small balls.
        (sin2 < 1.0).then(|| sin2 / (1.0 + safe_sqrt(1.0 - sin2)))
    }

    /// Distance at which a ray from outside enters the ball, in multiples of `direction`.
    pub fn intersect(&self, origin: Vec3, direction: Vec3) -> Option<f32> {
        let to = self.centre - origin;
        let length2 = direction.length_squared();
        let along = to.dot(direction) / length2;
        // Distance of the centre from the line, by the rejected part: no cancellation of large squares.
        let aside = to - direction * along;
        let inside2 = self.radius * self.radius - aside.length_squared();
        let outside = to.length_squared() > self.radius * self.radius;
        (inside2 >= 0.0 && along > 0.0 && outside).then(|| along - (inside2 / length2).sqrt())
    }

    /// A unit direction towards the ball, uniform in its cone, the distance to the surface, and the density, 1/sr.
    pub fn sample(&self, from: Vec3, u: Vec2) -> Option<(Vec3, f32, f32)> {
        let one_minus_cos = self.one_minus_cos(from)?;
        let axis = (self.centre - from).try_normalize()?;
        let (tangent, bitangent) = orthonormal_basis(axis);
        let local = warp::uniform_cone(u, one_minus_cos);
        let direction = (tangent * local.x + bitangent * local.y + axis * local.z).normalize();
        // At the very rim rounding may miss the ball: the tangent point is as far as the limb.
        let limb = safe_sqrt((self.centre - from).length_squared() - self.radius * self.radius);
        let distance = self.intersect(from, direction).unwrap_or(limb);
        Some((direction, distance, warp::uniform_cone_pdf(one_minus_cos)))
    }

    /// Density of [`Ball::sample`] for a direction that meets the ball, 1/sr.
    pub fn pdf(&self, from: Vec3) -> f32 {
        self.one_minus_cos(from).map_or(0.0, warp::uniform_cone_pdf)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn samples_hit_the_ball() {
        let ball = Ball { centre: Vec3::new(1.0, 2.0, 3.0), radius: 0.05 };
        for i in 0..256 {
            let u = Vec2::new((i % 16) as f32 + 0.5, (i / 16) as f32 + 0.5) / 16.0;
            let (direction, distance, pdf) = ball.sample(Vec3::ZERO, u).unwrap();
            let surface = direction * distance - ball.centre;
            assert!((surface.length() - 0.05).abs() < 1e-4 && pdf == ball.pdf(Vec3::ZERO));
        }
    }

    #[test]
    fn nothing_is_seen_from_inside() {
        let ball = Ball { centre: Vec3::ZERO, radius: 1.0 };
        assert!(ball.sample(Vec3::X * 0.5, Vec2::splat(0.5)).is_none());
        assert!(ball.intersect(Vec3::X * 0.5, Vec3::X).is_none());
    }
}

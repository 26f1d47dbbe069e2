//! A flat round emitter.
//!
//! From afar its points are chosen evenly by area. From near by that would miss the little of it that gives nearly all
//! the light: there, directions are chosen evenly in solid angle over the square around it, and those beside it lost.

use super::rect::Rect;
use crate::math::{safe_sqrt, warp};
use glam::{Vec2, Vec3};
use std::f32::consts::PI;

/// A flat disc: centre, unit axes, radius. It shines along `right x up`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Disc {
    /// Centre.
    pub centre: Vec3,
    /// Unit vector in the plane.
    pub right: Vec3,
    /// Unit vector in the plane, at right angles.
    pub up: Vec3,
    /// Radius, metres.
    pub radius: f32,
    /// The direction it faces.
    normal: Vec3,
}

impl Disc {
    /// From its centre, unit axes and radius.
    pub fn new(centre: Vec3, right: Vec3, up: Vec3, radius: f32) -> Self {
        Disc { centre, right, up, radius, normal: right.cross(up) }
    }

    /// The direction it faces.
    pub fn normal(&self) -> Vec3 {
        self.normal
    }

    /// Area, m2.
    pub fn area(&self) -> f32 {
        PI * self.radius * self.radius
    }

    /// Distance at which a ray crosses it, in multiples of `direction`.
    pub fn intersect(&self, origin: Vec3, direction: Vec3) -> Option<f32> {
        let normal = self.normal();
        let slope = direction.dot(normal);
        let t = (self.centre - origin).dot(normal) / slope;
        let local = origin + direction * t - self.centre;
        (slope != 0.0 && t > 0.0 && local.length_squared() <= self.radius * self.radius).then_some(t)
    }

    /// The square around the disc.
    fn square(&self) -> Rect {
        Rect::new(self.centre, self.right, self.up, Vec2::splat(self.radius))
    }

    /// Whether some of the disc is nearer than half its radius.
    fn is_near(&self, from: Vec3) -> bool {
        let offset = from - self.centre;
        let height = offset.dot(self.normal());
        let beside = (safe_sqrt(offset.length_squared() - height * height) - self.radius).max(0.0);
        height * height + beside * beside < 0.25 * self.radius * self.radius
    }

    /// A point of the disc and the density of its direction, 1/sr. None now and then from near by, and edge-on.
    pub fn sample(&self, from: Vec3, u: Vec2) -> Option<(Vec3, f32)> {
        if self.is_near(from) {
            let hit = self.square().seen_from(from).sample(from, u)?;
            return ((hit.0 - self.centre).length_squared() <= self.radius * self.radius).then_some(hit);
        }
        let offset = warp::concentric_disc(u) * self.radius;
        let target = self.centre + self.right * offset.x + self.up * offset.y;
        let pdf = self.pdf(from, target);
        (pdf > 0.0 && pdf.is_finite()).then_some((target, pdf))
    }

    /// Density of a direction towards `target` on the disc, 1/sr.
    pub fn pdf(&self, from: Vec3, target: Vec3) -> f32 {
        if self.is_near(from) {
            return self.square().seen_from(from).pdf(from, target);
        }
        let to = target - from;
        let cos = to.normalize_or_zero().dot(self.normal()).abs();
        to.length_squared() / (cos * self.area())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_light_of_a_disc_is_found_from_a_millimetre_to_metres_and_beside_its_edge() {
        let disc = Disc::new(Vec3::ZERO, Vec3::X, Vec3::Y, 0.6);
        for (height, beside) in
            [(0.001, 0.0), (0.01, 0.3), (0.1, 0.0), (0.29, 0.0), (0.31, 0.0), (0.8, 0.5), (3.0, 2.0)]
        {
            let from = Vec3::new(beside, 0.0, height);
            let n = 256;
            let mut sum = 0.0;
            for i in 0..n * n {
                let u = Vec2::new((i % n) as f32 + 0.5, (i / n) as f32 + 0.5) / n as f32;
                let Some((target, pdf)) = disc.sample(from, u) else { continue };
                assert!((disc.pdf(from, target) / pdf - 1.0).abs() < 1e-3);
                let direction = (target - from).normalize();
                sum += -direction.z / pdf / (n * n) as f32;
            }
            // A receiver parallel to a disc of luminance 1 (Walsh 1958): E = pi / 2 (1 - (h2 + b2 - R2) / root),
            // root = sqrt((h2 + b2 + R2)^2 - 4 b2 R2).
            let (h2, b2, r2) = (height * height, beside * beside, 0.36_f32);
            let root = ((h2 + b2 + r2).powi(2) - 4.0 * b2 * r2).sqrt();
            let truth = 0.5 * PI * (1.0 - (h2 + b2 - r2) / root);
            // The grid errs by the cells on the disc's edge: 4 n of n^2, half of them wrong by half.
            assert!((sum / truth - 1.0).abs() < 0.004, "{height} m before, {beside} m beside: {sum} for {truth}");
        }
    }
}

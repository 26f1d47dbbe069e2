//! A flat round emitter.
//!
//! Points are sampled uniformly by area from far away. From near by, nearly all light comes from a small part of the
//! disc: there, directions are sampled uniformly in solid angle over the circumscribed square, and those that miss the
//! disc are rejected.

use super::flat;
use super::rect::Rect;
use crate::math::{safe_sqrt, warp};
use glam::{Vec2, Vec3};
use std::f32::consts::PI;

/// A flat disc. It emits along `right x up`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Disc {
    /// Centre.
    pub centre: Vec3,
    /// Unit vector in the plane.
    pub right: Vec3,
    /// Unit vector in the plane, perpendicular to `right`.
    pub up: Vec3,
    /// Radius, metres.
    pub radius: f32,
    /// Unit normal of the emitting side.
    normal: Vec3,
}

impl Disc {
    /// Returns the disc of a centre, unit axes and radius.
    pub fn new(centre: Vec3, right: Vec3, up: Vec3, radius: f32) -> Self {
        Disc { centre, right, up, radius, normal: right.cross(up) }
    }

    /// Returns the unit normal of the emitting side.
    pub fn normal(&self) -> Vec3 {
        self.normal
    }

    /// Returns the area, m2.
    pub fn area(&self) -> f32 {
        PI * self.radius * self.radius
    }

    /// Returns the distance at which a ray hits the disc, in multiples of `direction`.
    pub fn intersect(&self, origin: Vec3, direction: Vec3) -> Option<f32> {
        let normal = self.normal();
        let slope = direction.dot(normal);
        let t = (self.centre - origin).dot(normal) / slope;
        let local = origin + direction * t - self.centre;
        (slope != 0.0 && t > 0.0 && local.length_squared() <= self.radius * self.radius).then_some(t)
    }

    /// Returns the circumscribed square.
    fn bounding_square(&self) -> Rect {
        Rect::new(self.centre, self.right, self.up, Vec2::splat(self.radius))
    }

    /// Returns true if part of the disc is nearer than half its radius.
    fn is_near(&self, from: Vec3) -> bool {
        let offset = from - self.centre;
        let height = offset.dot(self.normal());
        let lateral = (safe_sqrt(offset.length_squared() - height * height) - self.radius).max(0.0);
        height * height + lateral * lateral < 0.25 * self.radius * self.radius
    }

    /// Samples a point of the disc, seen from `from`. Returns the vector to it and the density of its direction, 1/sr;
    /// none for rejected samples and for a disc seen edge-on.
    pub fn sample(&self, from: Vec3, u: Vec2) -> Option<(Vec3, f32)> {
        if self.is_near(from) {
            let (to, pdf) = self.bounding_square().seen_from(from).sample(from, u)?;
            let is_on_disc = (from + to - self.centre).length_squared() <= self.radius * self.radius;
            return is_on_disc.then_some((to, pdf));
        }
        let offset = warp::concentric_disc(u) * self.radius;
        let to = self.centre + self.right * offset.x + self.up * offset.y - from;
        let pdf = self.area_pdf(to);
        (pdf > 0.0 && pdf.is_finite()).then_some((to, pdf))
    }

    /// Returns the density of the direction of the vector `to` a point of the disc, 1/sr.
    pub fn pdf(&self, from: Vec3, to: Vec3) -> f32 {
        if self.is_near(from) { self.bounding_square().seen_from(from).pdf(to) } else { self.area_pdf(to) }
    }

    fn area_pdf(&self, to: Vec3) -> f32 {
        flat::area_pdf(to, self.normal(), self.area())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_illuminance_of_a_disc_is_right_from_millimetres_to_metres_and_beside_its_edge() {
        let disc = Disc::new(Vec3::ZERO, Vec3::X, Vec3::Y, 0.6);
        for (height, lateral) in
            [(0.001, 0.0), (0.01, 0.3), (0.1, 0.0), (0.29, 0.0), (0.31, 0.0), (0.8, 0.5), (3.0, 2.0)]
        {
            let from = Vec3::new(lateral, 0.0, height);
            let n = 256;
            let mut sum = 0.0;
            for i in 0..n * n {
                let u = Vec2::new((i % n) as f32 + 0.5, (i / n) as f32 + 0.5) / n as f32;
                let Some((to, pdf)) = disc.sample(from, u) else { continue };
                assert!((disc.pdf(from, to) / pdf - 1.0).abs() < 1e-3);
                let direction = to.normalize();
                sum += -direction.z / pdf / (n * n) as f32;
            }
            // A receiver parallel to a disc of luminance 1 (Walsh 1958): E = pi / 2 (1 - (h2 + b2 - R2) / root),
            // root = sqrt((h2 + b2 + R2)^2 - 4 b2 R2).
            let (h2, b2, r2) = (height * height, lateral * lateral, 0.36_f32);
            let root = ((h2 + b2 + r2).powi(2) - 4.0 * b2 * r2).sqrt();
            let truth = 0.5 * PI * (1.0 - (h2 + b2 - r2) / root);
            // Error of the grid: 4 n of n^2 cells lie on the edge, half of them are wrong by half.
            assert!((sum / truth - 1.0).abs() < 0.004, "{height} m in front, {lateral} m off axis: {sum} for {truth}");
        }
    }
}

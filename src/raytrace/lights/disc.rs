//! A flat round emitter.

use crate::math::warp;
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
}

impl Disc {
    /// The direction it faces.
    pub fn normal(&self) -> Vec3 {
        self.right.cross(self.up)
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

    /// A point of the disc, uniform by area, and the density of its direction, 1/sr.
    pub fn sample(&self, from: Vec3, u: Vec2) -> Option<(Vec3, f32)> {
        let offset = warp::concentric_disc(u) * self.radius;
        let target = self.centre + self.right * offset.x + self.up * offset.y;
        let pdf = self.pdf(from, target);
        (pdf > 0.0 && pdf.is_finite()).then_some((target, pdf))
    }

    /// Density of a direction towards `target` on the disc, 1/sr.
    pub fn pdf(&self, from: Vec3, target: Vec3) -> f32 {
        let to = target - from;
        let cos = to.normalize_or_zero().dot(self.normal()).abs();
        to.length_squared() / (cos * self.area())
    }
}

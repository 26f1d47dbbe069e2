//! The sun: a cone of directions of uniform luminance.

use crate::math::{orthonormal_basis, warp};
use glam::{Vec2, Vec3};
use std::f32::consts::PI;

/// The sun as a cone of directions.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SunDisc {
    /// Unit direction towards the centre.
    pub towards: Vec3,
    /// Illuminance normal to `towards`, lx.
    pub illuminance: f32,
    /// `1 - cos` of the half angle, which keeps its digits for small angles; 0 for a delta light.
    pub one_minus_cos: f32,
}

impl SunDisc {
    /// Returns the sun of a half angle.
    pub fn new(towards: Vec3, illuminance: f32, half_angle_rad: f32) -> Self {
        // 1 - cos a = 2 sin2(a / 2).
        let one_minus_cos = 2.0 * (half_angle_rad * 0.5).sin().powi(2);
        SunDisc { towards, illuminance, one_minus_cos }
    }

    /// Returns true if the sun has no extent.
    pub fn is_delta(&self) -> bool {
        self.one_minus_cos <= 0.0
    }

    /// Returns the luminance that gives the illuminance E: E / (pi sin2 a), cd/m2.
    pub fn luminance(&self) -> f32 {
        self.illuminance / (PI * self.one_minus_cos * (2.0 - self.one_minus_cos))
    }

    /// Returns true if a unit direction lies in the cone. A delta light contains none.
    pub fn contains(&self, direction: Vec3) -> bool {
        // |d - t|2 / 2 is 1 - cos without cancellation.
        let is_inside = 0.5 * (direction - self.towards).length_squared() <= self.one_minus_cos;
        is_inside && self.one_minus_cos > 0.0
    }

    /// Samples a direction uniformly in the cone. Returns it with its density, 1/sr.
    pub fn sample(&self, u: Vec2) -> (Vec3, f32) {
        let (tangent, bitangent) = orthonormal_basis(self.towards);
        let local = warp::uniform_cone(u, self.one_minus_cos);
        let direction = (tangent * local.x + bitangent * local.y + self.towards * local.z).normalize();
        (direction, self.pdf())
    }

    /// Returns the density of [`SunDisc::sample`], 1/sr.
    pub fn pdf(&self) -> f32 {
        warp::uniform_cone_pdf(self.one_minus_cos)
    }
}

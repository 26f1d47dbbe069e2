//! The receptor of the light meter, in the tracer's space.

use super::point::MeterPoint;
use crate::math::{orthonormal_basis, safe_sqrt, sin_cos_turn, warp};
use crate::photo::meter::Receptor;
use glam::{Vec2, Vec3};
use std::f32::consts::{PI, TAU};

/// Offset of the receptor along its direction, metres, so that a meter laid on a surface measures what falls on it.
/// Larger than the rounding of positions within some ten metres; an error of 0.01 % half a metre from a light.
const LIFT_M: f32 = 2e-5;

/// A receptor with its coordinate frame.
#[derive(Clone, Copy, Debug)]
pub struct ReceptorFrame {
    /// Origin of its rays, in the tracer's space.
    pub origin: Vec3,
    /// Unit direction that it faces.
    pub facing: Vec3,
    tangent: Vec3,
    bitangent: Vec3,
    /// Flat or dome.
    pub receptor: Receptor,
}

impl ReceptorFrame {
    /// The receptor at a point, for a tracer with this world origin.
    pub fn new(point: &MeterPoint, tracer_origin: Vec3) -> Self {
        let (tangent, bitangent) = orthonormal_basis(point.facing);
        let origin = (point.position - tracer_origin) + point.facing * LIFT_M;
        ReceptorFrame { origin, facing: point.facing, tangent, bitangent, receptor: point.receptor }
    }

    /// Samples a unit direction with a density proportional to the receptor's response.
    pub fn sample(&self, u: Vec2) -> Vec3 {
        let local = match self.receptor {
            Receptor::Flat => warp::cosine_hemisphere(u),
            Receptor::Dome => {
                // Density (1 + cos) / (4 pi), whose cumulative distribution over the cosine is ((1 + cos) / 2)^2.
                let cos = 2.0 * safe_sqrt(u.x) - 1.0;
                let (sin_turn, cos_turn) = sin_cos_turn(u.y);
                let radius = safe_sqrt(1.0 - cos * cos);
                Vec3::new(radius * cos_turn, radius * sin_turn, cos)
            }
        };
        self.tangent * local.x + self.bitangent * local.y + self.facing * local.z
    }

    /// Integral of the response over all directions, sr: the weight of a sampled direction of luminance 1.
    pub fn response_integral(&self) -> f32 {
        match self.receptor {
            Receptor::Flat => PI,
            Receptor::Dome => TAU,
        }
    }
}

//! The light meter's receptor: where it stands, and how it answers to directions.

use super::MeterPoint;
use crate::math::{orthonormal_basis, safe_sqrt, sin_cos_turn, warp};
use crate::photo::meter::Receptor;
use glam::{Vec2, Vec3};
use std::f32::consts::{PI, TAU};

/// A meter that is laid on a surface measures what falls on it: its receptor stands this far before the place. Surfaces
/// of objects of some ten metres are off by less from rounding; it matters by 0.01 % half a metre from a light.
const LIFT_M: f32 = 2e-5;

/// A receptor in the tracer's space.
#[derive(Clone, Copy, Debug)]
pub struct Receiver {
    /// Where rays start, a hair before the place.
    pub origin: Vec3,
    /// Unit direction that it faces.
    pub facing: Vec3,
    tangent: Vec3,
    bitangent: Vec3,
    /// Flat or dome.
    pub receptor: Receptor,
}

impl Receiver {
    /// At a place, with the tracer's origin at `eye`.
    pub fn new(place: &MeterPoint, eye: Vec3) -> Self {
        let (tangent, bitangent) = orthonormal_basis(place.facing);
        let origin = (place.position - eye) + place.facing * LIFT_M;
        Receiver { origin, facing: place.facing, tangent, bitangent, receptor: place.receptor }
    }

    /// A direction, with the density of the receptor's response up to a factor.
    pub fn direction(&self, u: Vec2) -> Vec3 {
        let local = match self.receptor {
            Receptor::Flat => warp::cosine_hemisphere(u),
            Receptor::Dome => {
                // Density (1 + cos) / (4 pi): the cumulated share below a cosine is ((1 + cos) / 2)^2.
                let cos = 2.0 * safe_sqrt(u.x) - 1.0;
                let (sin_turn, cos_turn) = sin_cos_turn(u.y);
                let radius = safe_sqrt(1.0 - cos * cos);
                Vec3::new(radius * cos_turn, radius * sin_turn, cos)
            }
        };
        self.tangent * local.x + self.bitangent * local.y + self.facing * local.z
    }

    /// What one sample of [`Receiver::direction`] with luminance 1 counts: the integral of the response over all
    /// directions, sr.
    pub fn weight(&self) -> f32 {
        match self.receptor {
            Receptor::Flat => PI,
            Receptor::Dome => TAU,
        }
    }
}

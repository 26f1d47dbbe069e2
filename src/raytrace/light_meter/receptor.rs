//! The receptor of the light meter, in the tracer's space.

use super::point::MeterPoint;
use crate::math::{Ray, gamma, orthonormal_basis, safe_sqrt, sin_cos_turn, warp};
use crate::photo::meter::Receptor;
use crate::raytrace::ray_caster::RayCaster;
use crate::raytrace::render_scene::RenderScene;
use glam::{Vec2, Vec3};
use std::f32::consts::{PI, TAU};

/// Distance from a surface, metres, within which a receptor lies on it: larger than the rounding of positions within
/// some ten metres.
const CONTACT_M: f32 = 2e-5;

/// A receptor with its coordinate frame.
#[derive(Clone, Copy, Debug)]
pub struct ReceptorFrame {
    /// Position, in the tracer's space.
    pub position: Vec3,
    /// Origin of its rays: the position, or just above the surface on which the meter lies.
    pub origin: Vec3,
    /// Unit direction that it faces.
    pub facing: Vec3,
    tangent: Vec3,
    bitangent: Vec3,
    /// Flat or dome.
    pub receptor: Receptor,
}

impl ReceptorFrame {
    /// The receptor at a point of a scene. A meter laid on a surface measures what falls on it: its rays start above the
    /// surface by no more than its rounding. Elsewhere they start at the point.
    pub fn new(point: &MeterPoint, scene: &RenderScene) -> Self {
        let (tangent, bitangent) = orthonormal_basis(point.facing);
        let position = point.position - scene.origin;
        let contact_m = CONTACT_M.max(gamma(4) * point.position.abs().max_element());
        let above = position + point.facing * contact_m;
        let ray = Ray { origin: above, direction: -point.facing, t_max: 2.0 * contact_m };
        let hit = RayCaster::new(scene).intersect(&ray);
        let origin = hit.map_or(position, |hit| scene.aggregate.surface(&hit).spawn_origin(point.facing));
        ReceptorFrame { position, origin, facing: point.facing, tangent, bitangent, receptor: point.receptor }
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

//! The photon: light that arrives at a surface.

use super::grid::Positioned;
use crate::raytrace::geometry::SurfaceInteraction;
use glam::Vec3;

/// Light that arrives at a surface through caustic casters.
#[derive(Clone, Copy, Debug)]
pub struct Photon {
    /// Position, in the tracer's space.
    pub position: Vec3,
    /// Unit direction towards its origin.
    pub direction: Vec3,
    /// Geometric normal of the surface, on the side of `direction`.
    pub normal: Vec3,
    /// Luminous flux (lm of white light, or lm s, as the layer counts) over its cosine to the surface.
    pub flux: Vec3,
    /// Film layer of its light.
    pub layer: u16,
    /// Density of its start in perpendicular area and solid angle, 1/(m2 sr), which specular scattering does not
    /// change; infinite for a delta light.
    pub density: f32,
    /// Number of reflections and refractions so far.
    pub specular_depth: u16,
}

impl Positioned for Photon {
    fn position(&self) -> Vec3 {
        self.position
    }
}

/// Probability with which photons start on the inner side of a closed body, which only a light inside of it reaches.
const INNER_SIDE: f32 = 0.1;

/// Probability with which a photon starts on the inner side of a caster; both sides of a thin one are alike.
pub fn inner_side_probability(surface: &SurfaceInteraction) -> f32 {
    if surface.is_thin { 0.5 } else { INNER_SIDE }
}

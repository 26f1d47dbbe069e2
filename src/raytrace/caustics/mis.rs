//! MIS weights of paths against photons.

use super::casters::CausticCasters;
use super::photon::inner_side_probability;
use crate::raytrace::geometry::SurfaceInteraction;
use glam::Vec3;

/// Densities with which both techniques find light from a direction at a non-specular vertex.
#[derive(Clone, Copy, Debug)]
pub struct GatherDensities {
    /// Density of the paths' directions times the number of paths, 1/sr.
    pub path_pdf: f32,
    /// Gather area times number of photons times cosine, square metres: the factor from a photon's density
    /// (perpendicular area and solid angle) to the density of gathered photons.
    pub photon_area: f32,
}

impl GatherDensities {
    /// MIS weight of the path (balance heuristic, Veach 1997) against photons of this density, 1/(m2 sr).
    pub fn path_weight(&self, photon_density: f32) -> f32 {
        // In this form, right for infinite densities.
        1.0 / (1.0 + self.photon_area * photon_density / self.path_pdf)
    }
}

/// The photons that take the way of a path which left a non-specular vertex through caustic casters.
#[derive(Clone, Copy, Debug)]
pub struct CausticMis {
    gather: GatherDensities,
    /// Position on the last caster.
    pub position: Vec3,
    /// Origin of the ray that left it.
    pub ray_origin: Vec3,
    /// Geometric normal of the last caster, on the side where the path leaves.
    pub normal: Vec3,
    /// Probability with which a photon starts on that side, times the density of starts relative to a uniform one.
    start_density: f32,
}

impl CausticMis {
    /// The photons for a path that leaves a caster in this direction, where they start with a density relative to a
    /// uniform one.
    pub fn new(gather: GatherDensities, surface: &SurfaceInteraction, direction: Vec3, relative_density: f32) -> Self {
        let outside = direction.dot(surface.geometric_normal) > 0.0;
        let normal = if outside { surface.geometric_normal } else { -surface.geometric_normal };
        let inner = inner_side_probability(surface);
        let side_probability = if outside { 1.0 - inner } else { inner };
        let ray_origin = surface.spawn_origin(direction);
        let start_density = side_probability * relative_density;
        CausticMis { gather, position: surface.position, ray_origin, normal, start_density }
    }

    /// MIS weight of a path that hits an emitter in a direction which photons sample with density `pdf`, 1/sr.
    pub fn path_weight(&self, casters: &CausticCasters, direction: Vec3, pdf: f32) -> f32 {
        self.gather.path_weight(casters.density(self.start_density * pdf, direction.dot(self.normal)))
    }
}

//! Which share of the light that both photons and paths find is whose.

use super::casters::Casters;
use super::photon::inside;
use crate::raytrace::geometry::SurfaceInteraction;
use glam::Vec3;

/// How well both techniques find light from a direction at a surface.
#[derive(Clone, Copy, Debug)]
pub struct Gathered {
    /// Density of the paths' directions, times the ways that are followed, 1/sr.
    pub paths: f32,
    /// The factor by which a photon's density in area (square to the direction) and solid angle becomes that of those which
    /// are gathered, square metres.
    pub photons: f32,
}

impl Gathered {
    /// Of what both find, the paths' share (Veach's balance heuristic), for this density of photons, 1/(m2 sr).
    pub fn weight_of_path(&self, density: f32) -> f32 {
        // Unlike the difference, right for infinite densities.
        1.0 / (1.0 + self.photons * density / self.paths)
    }
}

/// The photons that come the way a path went, by mirrors and glass.
#[derive(Clone, Copy, Debug)]
pub struct Rival {
    gathered: Gathered,
    /// Of the last surface, on the side where the path goes on.
    normal: Vec3,
    /// Chance that a photon begins on that side.
    side: f32,
}

impl Rival {
    /// For a path that leaves a mirror or glass in this direction.
    pub fn new(gathered: Gathered, surface: &SurfaceInteraction, direction: Vec3) -> Self {
        let outside = direction.dot(surface.geometric_normal) > 0.0;
        let normal = if outside { surface.geometric_normal } else { -surface.geometric_normal };
        let inside = inside(surface);
        Rival { gathered, normal, side: if outside { 1.0 - inside } else { inside } }
    }

    /// Geometric normal on the side where the path goes on.
    pub fn normal(&self) -> Vec3 {
        self.normal
    }

    /// The path's share of the light that it meets in a direction in which photons are sent with this density, 1/sr.
    pub fn weight_of_path(&self, casters: &Casters, direction: Vec3, pdf: f32) -> f32 {
        self.gathered.weight_of_path(casters.density(self.side * pdf, direction.dot(self.normal)))
    }
}

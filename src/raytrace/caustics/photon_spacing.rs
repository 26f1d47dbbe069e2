//! The spacing of photons, from which follows how many a radius holds.

use super::grid::Positioned;
use crate::math::quantile;
use glam::Vec3;

/// Photons per sample of a pixel that the gather radius holds at least, on average, up to a maximum radius.
const MIN_NEIGHBOURS: usize = 10;
/// Maximum gather radius due to [`MIN_NEIGHBOURS`], metres.
pub const MAX_FILLED_RADIUS_M: f32 = 0.05;

/// Spacing of photons on surfaces.
#[derive(Clone, Copy, Debug)]
pub struct PhotonSpacing {
    /// Radius around a typical photon that holds [`MIN_NEIGHBOURS`] others, metres.
    radius: f32,
    /// Number of emitted photons.
    emitted: u32,
}

impl PhotonSpacing {
    /// The spacing of photons of which so many were emitted.
    pub fn new(photons: &[impl Positioned], emitted: u32) -> Self {
        PhotonSpacing { radius: neighbour_radius(photons), emitted }
    }

    /// Returns the radius that holds enough photons of a pass with so many emitted photons and samples per pixel,
    /// metres.
    pub fn filled_radius(&self, emitted: u32, samples: u32) -> f32 {
        let fewer = self.emitted as f32 / emitted as f32;
        self.radius * (fewer * samples as f32).sqrt()
    }
}

/// Returns the radius around a typical photon that holds [`MIN_NEIGHBOURS`] others, metres. Estimated from a subset: on
/// surfaces, it falls with the square root of the number of photons.
fn neighbour_radius(photons: &[impl Positioned]) -> f32 {
    const QUERIES: usize = 64;
    const OTHERS: usize = 4096;
    let others: Vec<Vec3> = every(photons, OTHERS).collect();
    let to_others = |from: Vec3| {
        let mut distances: Vec<f32> = others.iter().map(|other| other.distance_squared(from)).collect();
        let n = MIN_NEIGHBOURS.min(distances.len() - 1);
        distances.select_nth_unstable_by(n, f32::total_cmp).1.sqrt()
    };
    let mut typical: Vec<f32> = every(photons, QUERIES).map(to_others).collect();
    quantile(&mut typical, 0.5) * (others.len() as f32 / photons.len().max(1) as f32).sqrt()
}

/// Returns the positions of about `count` photons, evenly spaced in their order.
fn every(photons: &[impl Positioned], count: usize) -> impl Iterator<Item = Vec3> {
    photons.iter().step_by((photons.len() / count).max(1)).map(Positioned::position)
}

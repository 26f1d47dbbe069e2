//! The distance between photons, from which follows how many a radius holds.

use super::photon::Photon;
use glam::Vec3;

/// Photons per sample of a pixel that the gather radius holds at least, on average, up to a maximum radius.
const MIN_NEIGHBOURS: usize = 10;
/// Maximum gather radius due to [`MIN_NEIGHBOURS`], metres.
pub const MAX_FILLED_RADIUS_M: f32 = 0.05;

/// How far photons are apart that arrive where the camera sees them.
#[derive(Clone, Copy, Debug)]
pub struct PhotonSpacing {
    /// Radius around a typical photon that holds [`MIN_NEIGHBOURS`] others, metres.
    radius: f32,
    /// Number of emitted photons.
    emitted: u32,
}

impl PhotonSpacing {
    /// The spacing of photons at these positions, of which so many were emitted.
    pub fn new(positions: &[Vec3], emitted: u32) -> Self {
        PhotonSpacing { radius: neighbour_radius(positions), emitted }
    }

    /// Radius that holds enough of another number of photons; see [`filled_radius`].
    pub fn filled_radius(&self, emitted: u32, samples: u32) -> f32 {
        let fewer = self.emitted as f32 / emitted as f32;
        self.radius * (fewer * samples as f32).sqrt()
    }
}

/// Radius that holds enough photons of a pass with so many samples per pixel, metres.
pub fn filled_radius(photons: &[Photon], samples: u32) -> f32 {
    let positions: Vec<Vec3> = photons.iter().map(|photon| photon.position).collect();
    neighbour_radius(&positions) * (samples as f32).sqrt()
}

/// Radius around a typical position that holds [`MIN_NEIGHBOURS`] others, metres. Estimated from a subset: on surfaces, it
/// falls with the square root of the number of positions.
fn neighbour_radius(positions: &[Vec3]) -> f32 {
    const QUERIES: usize = 64;
    const OTHERS: usize = 4096;
    let others: Vec<Vec3> = every(positions, OTHERS).copied().collect();
    let to_others = |from: &Vec3| {
        let mut distances: Vec<f32> = others.iter().map(|other| other.distance_squared(*from)).collect();
        let n = MIN_NEIGHBOURS.min(distances.len() - 1);
        distances.select_nth_unstable_by(n, f32::total_cmp).1.sqrt()
    };
    let mut typical: Vec<f32> = every(positions, QUERIES).map(to_others).collect();
    let middle = typical.len() / 2;
    let typical = if typical.is_empty() { 0.0 } else { *typical.select_nth_unstable_by(middle, f32::total_cmp).1 };
    typical * (others.len() as f32 / positions.len().max(1) as f32).sqrt()
}

/// About `count` items, evenly spaced in their order.
fn every<T>(items: &[T], count: usize) -> impl Iterator<Item = &T> {
    items.iter().step_by((items.len() / count).max(1))
}

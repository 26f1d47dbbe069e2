//! Gather radii: a blur of a few pixels, wider where there are few photons, that shrinks as the picture converges.

use super::photon::Photon;
use super::photon_pass::PhotonPass;
use super::photon_spacing::{MAX_FILLED_RADIUS_M, PhotonSpacing};
use super::view::CausticView;

/// Gather radius of the first pass, in pixels: little enough blur for the eye to miss.
const FIRST_RADIUS_PX: f32 = 2.0;
/// Factor of the radius for indirect light, which holds a quarter as many photons for it.
pub const INDIRECT_SCALE: f32 = 0.5;
/// Maximum gather radius for indirect light, metres.
const MAX_INDIRECT_RADIUS_M: f32 = 2.0 * MAX_FILLED_RADIUS_M;
/// Greatest ratio of the radii of a map: a query visits all photons within the widest one.
const MAX_RATIO: f32 = 8.0;
/// Share of the visible surfaces that are nearer than the one whose radius is the widest.
const FAR_SHARE: f32 = 0.9;

/// Gather radii by the distance from the camera.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct GatherRadius {
    /// Radius at 1 m, metres.
    per_m: f32,
    /// Least and greatest radius, metres.
    least: f32,
    most: f32,
}

impl GatherRadius {
    /// The same radius everywhere, metres.
    pub fn constant(radius: f32) -> Self {
        let radius = radius.max(f32::MIN_POSITIVE);
        GatherRadius { per_m: 0.0, least: radius, most: radius }
    }

    /// The radii for surfaces that the camera sees, by the `photons` of a pass, of which so many were emitted.
    pub fn of_view(photons: &[Photon], emitted: u32, view: &CausticView, pass: &PhotonPass) -> Self {
        let far_m = view.visible.distance_quantile(FAR_SHARE);
        // A radius that followed the same photons would be smaller where there are more of them by chance
        let spacing = view.spacing.unwrap_or_else(|| PhotonSpacing::new(photons, emitted));
        let filled = spacing.filled_radius(emitted, pass.samples).min(MAX_FILLED_RADIUS_M);
        let shrink = pass.shrink();
        let per_m = FIRST_RADIUS_PX * view.pixel_m * shrink;
        let most = (per_m * far_m).max(filled * shrink).max(f32::MIN_POSITIVE);
        GatherRadius { per_m, least: (filled * shrink).max(most / MAX_RATIO), most }
    }

    /// The radius for surfaces that indirect light sees, by the photons of a pass, of which so many were emitted.
    pub fn of_indirect_light(photons: &[Photon], emitted: u32, pass: &PhotonPass) -> Self {
        let filled = INDIRECT_SCALE * PhotonSpacing::new(photons, emitted).filled_radius(emitted, pass.samples);
        Self::constant(filled.min(MAX_INDIRECT_RADIUS_M) * pass.shrink())
    }

    /// Returns the radius on a surface at so many metres from the camera, metres.
    pub fn at(&self, distance: f32) -> f32 {
        (self.per_m * distance).clamp(self.least, self.most)
    }

    /// Returns the greatest radius, metres.
    pub fn greatest(&self) -> f32 {
        self.most
    }
}

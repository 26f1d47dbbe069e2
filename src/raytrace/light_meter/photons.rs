//! Photons at the receptor: light that mirrors and curved glass throw on it.
//!
//! A photon counts if it passes within [`RADIUS_M`] of the receptor's centre, the size of a hand-held meter's receptor:
//! caustics are averaged over it. Photons and paths from the receptor are weighted by their densities, as at the
//! surfaces of a render.

use super::receptor::ReceptorFrame;
use crate::raytrace::bsdf::TracedMaterial;
use crate::raytrace::caustics::{GatherDensities, Photon, PhotonReceiver, PhotonSegment};
use crate::raytrace::film::NonFiniteReport;
use crate::raytrace::sampler::SampleId;
use crate::scene::Receptor;
use glam::{DVec3, Vec3};
use std::f32::consts::PI;

/// Radius of the receptor for photons, metres.
const RADIUS_M: f32 = 0.01;
/// Photons per path.
pub const PHOTONS_PER_PATH: u32 = 4;
/// Cosine to the receptor's plane below which a dome receives photons on a disc across their direction.
const MIN_PLANE_COSINE: f32 = 0.2;

/// The paths and photons of one round of a replicate.
#[derive(Clone, Copy, Debug)]
pub struct RoundDensities {
    /// Number of paths.
    pub paths: u32,
    /// Number of emitted photons.
    pub photons: u32,
}

/// Sums over the photons of a layer, each times the number of emitted photons, over all rounds.
#[derive(Clone, Copy, Debug, Default)]
pub struct PhotonSum {
    /// Illuminance at the receptor.
    pub illuminance: DVec3,
    /// Flux of the photons that reached a caster, lm, and their number.
    flux: DVec3,
    started: u32,
}

impl PhotonSum {
    /// Illuminance that one of `emitted` photons would add: what may be missed where none was found.
    pub fn illuminance_of_one(&self, emitted: u32) -> DVec3 {
        let area = f64::from(PI * RADIUS_M * RADIUS_M);
        self.flux / (f64::from(self.started.max(1)) * f64::from(emitted.max(1)) * area)
    }

    /// The sum of both.
    pub fn plus(&self, other: &PhotonSum) -> PhotonSum {
        PhotonSum {
            illuminance: self.illuminance + other.illuminance,
            flux: self.flux + other.flux,
            started: self.started + other.started,
        }
    }
}

impl ReceptorFrame {
    /// Returns true if photons from this direction are received on a disc in the receptor's plane rather than across
    /// their direction.
    fn receives_in_plane(&self, cos: f32) -> bool {
        self.receptor == Receptor::Flat || cos.abs() >= MIN_PLANE_COSINE
    }

    /// Densities with which paths and photons find light from a direction towards it.
    pub fn densities(&self, direction: Vec3, round: RoundDensities) -> GatherDensities {
        let cos = direction.dot(self.facing);
        let perpendicular = if self.receives_in_plane(cos) { cos.abs() } else { 1.0 };
        GatherDensities {
            path_pdf: self.receptor.response(cos) / self.response_integral() * round.paths as f32,
            photon_area: PI * RADIUS_M * RADIUS_M * perpendicular * round.photons as f32,
        }
    }

    /// Distance along a photon's ray at which it passes the receptor; none if it misses.
    fn crossing(&self, segment: &PhotonSegment<'_>) -> Option<f32> {
        let ray = &segment.ray;
        let to_centre = self.origin - ray.origin;
        let cos = ray.direction.dot(self.facing);
        let (distance, end) = if self.receives_in_plane(cos) {
            (to_centre.dot(self.facing) / cos, ray.t_max)
        } else {
            // A surface under the receptor ends the ray before it passes the middle of the disc.
            (to_centre.dot(ray.direction), ray.t_max + RADIUS_M / MIN_PLANE_COSINE)
        };
        let offset = ray.direction * distance - to_centre;
        (distance > 0.0 && distance <= end && offset.length_squared() < RADIUS_M * RADIUS_M).then_some(distance)
    }
}

/// Collects the photons of a round: those that arrive at surfaces, and the illuminance of those at the receptor.
pub struct ReceptorPhotons<'a> {
    /// The receptor.
    pub receptor: &'a ReceptorFrame,
    /// Numbers of paths and photons.
    pub round: RoundDensities,
    /// The scene's materials.
    pub materials: &'a [TracedMaterial],
    /// Photons at surfaces.
    pub stored: Vec<Photon>,
    /// What the photons of each layer bring.
    pub sums: &'a mut [PhotonSum],
    /// The present photon.
    pub sample: SampleId,
    /// Discarded non-finite contributions.
    pub nonfinite: &'a mut NonFiniteReport,
}

impl PhotonReceiver for ReceptorPhotons<'_> {
    fn start(&mut self, photon: &Photon, _curve_position: f64) {
        let sum = &mut self.sums[usize::from(photon.layer)];
        sum.flux += (photon.flux * self.round.photons as f32).as_dvec3();
        sum.started += 1;
    }

    fn arrive(&mut self, photon: Photon) {
        self.stored.push(photon);
    }

    fn travel(&mut self, segment: &PhotonSegment<'_>) {
        let photon = &segment.photon;
        let response = self.receptor.receptor.response(photon.direction.dot(self.receptor.facing));
        if response <= 0.0 {
            return;
        }
        let Some(distance) = self.receptor.crossing(segment) else { return };
        let densities = self.receptor.densities(photon.direction, self.round);
        let mis_weight = 1.0 - densities.path_weight(photon.density);
        // Flux over the area across the direction, weighted by the response
        let area = densities.photon_area / self.round.photons as f32;
        let transmittance = segment.media.transmittance(self.materials, distance);
        let value = photon.flux * transmittance * (mis_weight * response / area * self.round.photons as f32);
        if let Some(value) = self.nonfinite.admit(self.sample, value) {
            self.sums[usize::from(photon.layer)].illuminance += value.as_dvec3();
        }
    }
}

//! Rounds of samples: the numbers double until the errors are small.

use super::point::MeterEffort;
use super::replicate::{REPLICATES, Replicate, light_sampling_error, path_error};
use super::studio::MeteredStudio;
use crate::photo::meter::LightReading;
use std::ops::Range;

/// First round of a replicate: emitter points of each light.
const FIRST_POINTS: u32 = 64;
/// First round of a replicate: paths.
const FIRST_PATHS: u32 = 1024;
/// Maximum number of emitter points of a light in a replicate.
const MAX_POINTS: u32 = 16_384;

/// The samples of one round, for each replicate.
#[derive(Debug)]
pub struct SamplingRound {
    /// Emitter points of each light.
    pub points: Vec<Range<u32>>,
    /// Paths.
    pub paths: Range<u32>,
}

impl SamplingRound {
    /// The first round.
    pub fn first(effort: &MeterEffort, lights: usize) -> Self {
        let (points, paths) = match effort.paths {
            Some(paths) => {
                let each = paths.div_ceil(REPLICATES).max(1);
                (each.min(MAX_POINTS), each)
            }
            None => (FIRST_POINTS, FIRST_PATHS),
        };
        SamplingRound { points: vec![0..points; lights], paths: 0..paths }
    }

    /// The round after this one, which doubles the samples of every estimate whose error is too large; none when the
    /// readings are good enough or the budget is spent. `rays` were traced so far.
    pub fn next(
        &self,
        studio: &MeteredStudio,
        replicates: &[Replicate],
        readings: &[LightReading],
        effort: &MeterEffort,
        rays: u64,
    ) -> Option<Self> {
        if effort.paths.is_some() || rays >= effort.rays {
            return None;
        }
        // Allowed standard error of each light, by its share of the exposure
        let seconds = |reading: &LightReading| if reading.flash { 1.0 } else { studio.shutter_s };
        let total: f32 = readings.iter().map(|reading| reading.sum() * seconds(reading)).sum();
        let allowed = |reading: &LightReading| effort.tolerance * reading.sum().max(0.01 * total / seconds(reading));

        // Double the emitter points of each light, and the paths, where the error is larger
        let doubled = |range: &Range<u32>| range.end..2 * range.end;
        let mut next = SamplingRound {
            points: self.points.iter().map(|points| points.end..points.end).collect(),
            paths: self.paths.end..self.paths.end,
        };
        for (layer, light) in studio.lights.iter().enumerate() {
            let allowed = allowed(&readings[layer]);
            // Half of the allowed error, as bounced light has its own.
            if light_sampling_error(replicates, layer) > 0.5 * allowed && self.points[layer].end < MAX_POINTS {
                next.points[layer] = doubled(&self.points[layer]);
            }
            if path_error(replicates, layer, light.rgb) > 0.8 * allowed {
                next.paths = doubled(&self.paths);
            }
        }
        let emission = readings.last().filter(|_| studio.has_emission);
        if emission.is_some_and(|reading| reading.standard_error > allowed(reading)) {
            next.paths = doubled(&self.paths);
        }
        let has_samples = !next.paths.is_empty() || next.points.iter().any(|points| !points.is_empty());
        has_samples.then_some(next)
    }
}

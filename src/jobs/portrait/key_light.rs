//! The key light of a face, and its light on the skin.

use super::face_scan::{CELL_M, COLUMNS, FaceScan, TOP_M};
use crate::photo::portrait_pattern::{FaceMap, SkinLight};
use crate::raytrace::{LightMeter, MeterPoint};
use rayon::prelude::*;

/// Cells a cell of which is read to compare the lights.
const SPARSE: usize = 7;
/// Points of each emitter, to compare the lights and for the shadows of the key: a step of visibility of 1/48.
const SPARSE_SAMPLES: u32 = 8;
const SAMPLES: u32 = 48;

/// The light that gives a face the most direct light.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct KeyLight {
    /// Index into the meter's sources.
    pub source: usize,
    /// Its part of the direct light on the face, 0 to 1.
    pub part: f32,
}

/// Finds the key light of a face, by luminous exposure; none without direct light. Surrounds and emissive surfaces do not
/// count.
pub fn find_key(meter: &LightMeter, scan: &FaceScan) -> Option<KeyLight> {
    let points: Vec<(usize, &MeterPoint)> = scan.cells.iter().flatten().enumerate().step_by(SPARSE).collect();
    let exposure = |(source, time_s): (usize, f32)| -> f32 {
        let read = |&(stream, point): &(usize, &MeterPoint)| {
            meter.direct_light(source, point, SPARSE_SAMPLES, stream as u32).arriving
        };
        points.iter().map(read).sum::<f32>() * time_s
    };
    let sources: Vec<(usize, f32)> = meter.sources().map(|source| source.exposure_time_s).enumerate().collect();
    let exposures: Vec<f32> = sources.into_par_iter().map(exposure).collect();
    let total: f32 = exposures.iter().sum();
    let (source, most) = exposures.into_iter().enumerate().max_by(|a, b| a.1.total_cmp(&b.1))?;
    (most > 0.0).then_some(KeyLight { source, part: most / total })
}

/// Reads the light of one source, at an angle above the direction of the face, on every cell of the face.
pub fn map_face(meter: &LightMeter, scan: &FaceScan, source: usize, key_above_deg: f32) -> FaceMap {
    let read = |(stream, point): (usize, &Option<MeterPoint>)| {
        let light = meter.direct_light(source, point.as_ref()?, SAMPLES, stream as u32);
        Some(SkinLight { arriving: light.arriving, unshadowed: light.unshadowed })
    };
    let cells = scan.cells.par_iter().enumerate().map(read).collect();
    FaceMap { columns: COLUMNS, top_m: TOP_M, cell_m: CELL_M, cells, key_above_deg, features: scan.features }
}

//! The skin of a face, in cells as seen from straight before it.

use crate::figures::head_frame;
use crate::photo::meter::Receptor;
use crate::photo::portrait_pattern::FaceFeatures;
use crate::raytrace::{LightMeter, MeterPoint};
use crate::scene::{Figure, Object};
use glam::{Affine3A, Vec3};
use rayon::prelude::*;

/// Columns and rows of cells: 160 mm by 155 mm, an adult's face.
pub const COLUMNS: usize = 64;
const ROWS: usize = 62;
/// Edge of a cell, metres.
pub const CELL_M: f32 = 0.0025;
/// Height of the first row above the eyes, metres.
pub const TOP_M: f32 = 0.04;
/// Rays start this far before the eyeballs' middles and end so far behind them, metres: before the tip of the nose, and
/// before the ears.
const FRONT_M: f32 = 0.075;
const BACK_M: f32 = 0.06;
/// Cosine to the direction of the face under which skin is seen edge on, and belongs to the outline.
const EDGE_ON: f32 = 0.2;
/// Half of the width in which the tip of the nose is looked for, and the range of its depth below the eyes, metres.
const NOSE_HALF_WIDTH_M: f32 = 0.012;
const NOSE_BELOW_M: [f32; 2] = [0.015, 0.075];
/// Fewest cells of skin that make a face.
const FEWEST_CELLS: usize = 400;

/// The visible skin of a face.
#[derive(Clone, Debug)]
pub struct FaceScan {
    /// World from the head: origin between the eyes, +X to the person's left, +Y up, +Z the direction of the face.
    pub world_from_head: Affine3A,
    /// Points of the skin, row by row from the top, from the person's right to the left.
    pub cells: Vec<Option<MeterPoint>>,
    /// Places of nose and lips.
    pub features: FaceFeatures,
}

/// A point of the face.
struct FacePoint {
    point: MeterPoint,
    is_lips: bool,
    /// Place in the head's frame, metres.
    local: Vec3,
}

impl FaceScan {
    /// Scans the face of a figure, an object of the meter's scene at `index`. None where hair or something else covers
    /// most of it.
    pub fn new(meter: &LightMeter, index: u32, object: &Object, figure: &Figure) -> Option<FaceScan> {
        let world_from_head = object.transform.world_from_object() * head_frame(figure);
        let scan = |cell: usize| scan_cell(meter, index, world_from_head, cell);
        let points: Vec<Option<FacePoint>> = (0..COLUMNS * ROWS).into_par_iter().map(scan).collect();
        let features = features(&points)?;
        let cells: Vec<Option<MeterPoint>> = points.iter().map(|p| p.as_ref().map(|p| p.point)).collect();
        let skin = cells.iter().flatten().count();
        (skin >= FEWEST_CELLS).then_some(FaceScan { world_from_head, cells, features })
    }
}

/// Finds the skin in a cell.
fn scan_cell(meter: &LightMeter, index: u32, world_from_head: Affine3A, cell: usize) -> Option<FacePoint> {
    let across = ((cell % COLUMNS) as f32 + 0.5 - COLUMNS as f32 / 2.0) * CELL_M;
    let up = TOP_M - (cell / COLUMNS) as f32 * CELL_M;
    let origin = world_from_head.transform_point3(Vec3::new(across, up, FRONT_M));
    let way = world_from_head.transform_vector3(Vec3::NEG_Z * (FRONT_M + BACK_M));
    let direction = way.try_normalize()?;
    let surface = meter.first_surface(origin, direction, way.length())?;
    let is_lips = surface.part == "lips";
    if surface.object != Some(index) || !(is_lips || surface.part == "skin") || -surface.normal.dot(direction) < EDGE_ON
    {
        return None;
    }
    let local = world_from_head.inverse().transform_point3(surface.position);
    let point = MeterPoint { position: surface.position, facing: surface.normal, receptor: Receptor::Flat };
    Some(FacePoint { point, is_lips, local })
}

/// Finds nose and lips. None where they are covered.
fn features(points: &[Option<FacePoint>]) -> Option<FaceFeatures> {
    let heights = || points.iter().flatten().filter(|p| p.is_lips).map(|p| p.local.y);
    let lips_top = heights().max_by(f32::total_cmp)?;
    let lips_bottom = heights().min_by(f32::total_cmp)?;
    let is_nose = |p: &&FacePoint| {
        let [least, most] = NOSE_BELOW_M;
        p.local.x.abs() <= NOSE_HALF_WIDTH_M && (least..=most).contains(&-p.local.y) && p.local.y > lips_top
    };
    let tip = points.iter().flatten().filter(is_nose).max_by(|a, b| a.local.z.total_cmp(&b.local.z))?;
    Some(FaceFeatures { nose_tip_m: -tip.local.y, lips_top_m: -lips_top, lips_bottom_m: -lips_bottom })
}

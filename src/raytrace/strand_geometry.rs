//! The strands of a mesh prepared for tracing.

use super::simd::SegmentHit;
use super::strand_blas::{StrandBlas, strand_blas};
use super::strand_detail::{StrandLevel, StrandLevels, StrandUse, is_thinned};
use crate::scene::{StrandPart, Strands};
use glam::Vec3;
use std::ops::Range;
use std::sync::{Arc, Mutex, PoisonError};

/// The strands of a mesh, if it has any, with the BLASes of their levels of detail that were asked for.
#[derive(Debug)]
pub struct StrandGeometry {
    /// By level, in object space.
    blases: Mutex<[Option<Arc<StrandBlas>>; StrandLevel::COUNT]>,
    /// Mean width of the strands that levels of detail thin; none without such strands.
    thinned_width_m: Option<f32>,
    /// Bounding box at any level of detail.
    bounds: Option<(Vec3, Vec3)>,
    /// A bit for each point that starts a strand.
    starts: Vec<u64>,
    /// Points of each part.
    parts: Vec<Range<u32>>,
}

/// The intersection of a ray with a strand.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct StrandHit {
    /// The segment, and the position on it.
    pub segment: SegmentHit,
    /// Direction of the ray in world space, which the ribbon faces.
    pub ray_direction: Vec3,
    /// The level of detail of the strand.
    pub level: StrandLevel,
}

impl StrandGeometry {
    /// Prepares a mesh's strands. Their BLASes are built on first use.
    pub fn new(strands: &Strands) -> Self {
        let mut starts = vec![0; strands.points().len() / 64 + 1];
        strands.starts().iter().for_each(|&start| starts[start as usize / 64] |= 1 << (start % 64));
        let points_of = |range: &Range<u32>| {
            strands.range(range.start as usize).start as u32..strands.range(range.end as usize - 1).end as u32
        };
        let parts = strands.parts().iter().map(|part| points_of(&part.strands)).collect();
        StrandGeometry {
            blases: Mutex::default(),
            thinned_width_m: thinned_width_m(strands),
            bounds: widest_bounds(strands),
            starts,
            parts,
        }
    }

    /// Returns the mean width of the strands that levels of detail thin, metres; none without such strands.
    pub fn thinned_width_m(&self) -> Option<f32> {
        self.thinned_width_m
    }

    /// Returns the bounding box at any level of detail, in object space; none without strands.
    pub fn bounds(&self) -> Option<(Vec3, Vec3)> {
        self.bounds
    }

    /// Returns the BLAS of a level of detail.
    fn blas(&self, strands: &Strands, level: StrandLevel) -> Arc<StrandBlas> {
        let lock = || self.blases.lock().unwrap_or_else(PoisonError::into_inner);
        let known = lock()[level.index()].clone();
        known.unwrap_or_else(|| {
            // Not under the lock: the build may run other tasks on this thread, which may want the same BLAS
            let built = Arc::new(strand_blas(strands, level));
            lock()[level.index()].get_or_insert(built).clone()
        })
    }

    /// Returns the BLASes of two levels of detail.
    pub fn blases(&self, strands: &Strands, levels: StrandLevels) -> StrandBlases {
        let of = |level| self.blas(strands, level);
        if levels.seen == levels.lighting {
            let both = of(levels.seen);
            return StrandBlases { levels, seen: both.clone(), lighting: both };
        }
        // Parts of each build run on one thread: side by side they keep two busy
        let (seen, lighting) = rayon::join(|| of(levels.seen), || of(levels.lighting));
        StrandBlases { levels, seen, lighting }
    }

    /// Returns the index of the part of a segment, among the strands' parts.
    pub fn part(&self, segment: u32) -> usize {
        self.parts.iter().position(|points| points.contains(&segment)).unwrap_or(0)
    }

    fn is_start(&self, point: u32) -> bool {
        self.starts.get(point as usize / 64).is_some_and(|word| word >> (point % 64) & 1 == 1)
    }

    /// Returns the first point of the strand that a point belongs to.
    pub fn start_of(&self, point: u32) -> u32 {
        let mut word = point as usize / 64;
        let mut bits = self.starts[word] << (63 - point % 64);
        if bits != 0 {
            return point - bits.leading_zeros();
        }
        while bits == 0 && word > 0 {
            word -= 1;
            bits = self.starts[word];
        }
        word as u32 * 64 + 63 - bits.leading_zeros()
    }

    /// Returns the point after the last one of the strand that a point belongs to.
    pub fn end_of(&self, point: u32, point_count: u32) -> u32 {
        (point + 1..point_count).find(|&next| self.is_start(next)).unwrap_or(point_count)
    }

    /// Returns the unit direction of a strand at a position on a segment, interpolated between those at its points.
    pub fn tangent(&self, strands: &Strands, segment: u32, s: f32) -> Vec3 {
        let points = strands.points();
        let position = |point: u32| points[point as usize].position;
        let chord = position(segment + 1) - position(segment);
        let before = if self.is_start(segment) { chord } else { position(segment + 1) - position(segment - 1) };
        let is_last = segment + 2 >= points.len() as u32 || self.is_start(segment + 2);
        let after = if is_last { chord } else { position(segment + 2) - position(segment) };
        let chord = chord.normalize_or(Vec3::Y);
        before.normalize_or(chord).lerp(after.normalize_or(chord), s).normalize_or(chord)
    }
}

/// The BLASes over the strands that rays of an instance meet.
#[derive(Clone, Debug)]
pub struct StrandBlases {
    levels: StrandLevels,
    seen: Arc<StrandBlas>,
    lighting: Arc<StrandBlas>,
}

impl StrandBlases {
    /// Returns the levels of detail.
    pub fn levels(&self) -> StrandLevels {
        self.levels
    }

    /// Returns the BLAS for a use, and its level of detail.
    #[inline(always)]
    pub fn of(&self, strand_use: StrandUse) -> (&StrandBlas, StrandLevel) {
        match strand_use {
            StrandUse::Seen => (&self.seen, self.levels.seen),
            StrandUse::Lighting => (&self.lighting, self.levels.lighting),
        }
    }
}

/// Returns the bounding box of strands as wide as they are at the coarsest level of detail; none without strands.
fn widest_bounds(strands: &Strands) -> Option<(Vec3, Vec3)> {
    let (low, high) = strands.bounds()?;
    let most_radius_m = strands.points().iter().map(|point| point.radius_m).fold(0.0, f32::max);
    let wider = most_radius_m * (StrandLevel::COARSEST.width() - 1.0);
    Some((low - wider, high + wider))
}

/// Returns the mean width of the strands that levels of detail thin, the widest part's; none without such strands.
fn thinned_width_m(strands: &Strands) -> Option<f32> {
    let of_part = |part: &StrandPart| {
        let first = strands.range(part.strands.start as usize).start;
        let points = &strands.points()[first..strands.range(part.strands.end as usize - 1).end];
        2.0 * points.iter().map(|point| point.radius_m).sum::<f32>() / points.len() as f32
    };
    strands.parts().iter().filter(|part| is_thinned(strands, part)).map(of_part).reduce(f32::max)
}

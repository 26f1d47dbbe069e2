//! The strands of a mesh prepared for tracing.

use super::simd::SegmentHit;
use super::strand_blas::{StrandBlas, strand_blas};
use crate::scene::Strands;
use glam::Vec3;
use std::ops::Range;

/// The strands of a mesh, if it has any, with their BLAS.
#[derive(Debug)]
pub struct StrandGeometry {
    /// Over all segments, in object space.
    pub blas: StrandBlas,
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
}

impl StrandGeometry {
    /// Builds the BLAS of a mesh's strands.
    pub fn new(strands: &Strands) -> Self {
        let mut starts = vec![0; strands.points().len() / 64 + 1];
        strands.starts().iter().for_each(|&start| starts[start as usize / 64] |= 1 << (start % 64));
        let points_of = |range: &Range<u32>| {
            strands.range(range.start as usize).start as u32..strands.range(range.end as usize - 1).end as u32
        };
        let parts = strands.parts().iter().map(|part| points_of(&part.strands)).collect();
        StrandGeometry { blas: strand_blas(strands), starts, parts }
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

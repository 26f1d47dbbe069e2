//! The BLAS of strands: a BVH over their segments.
//!
//! A segment has one box along the axes of object space; leaves hold the points of their segments in single precision.

use super::blas::{Blas, LeafPacket};
use super::bvh::BuildEffort;
use super::simd::{Kernels, RibbonRay, SegmentHit, SegmentPacket};
use super::strand_detail::{StrandLevel, is_thinned};
use crate::math::Ray;
use crate::scene::{StrandPoint, Strands};
use glam::Vec3;
use rayon::prelude::*;

/// Segments and the BVH over them, in object space.
pub type StrandBlas = Blas<SegmentPacket>;

impl LeafPacket for SegmentPacket {
    type PreparedRay = RibbonRay;
    type Hit = SegmentHit;
    // Reinsertion takes a quarter of the build, and rays are no faster for it
    const BUILD_EFFORT: BuildEffort = BuildEffort::Clustering;

    #[inline(always)]
    fn prepare(ray: &Ray) -> RibbonRay {
        RibbonRay::new(ray.origin, ray.direction)
    }

    #[inline(always)]
    fn intersect<K: Kernels>(&self, ray: &RibbonRay, t_max: f32) -> Option<SegmentHit> {
        K::intersect_segments(ray, self, t_max)
    }

    #[inline(always)]
    fn distance(hit: &SegmentHit) -> f32 {
        hit.t
    }
}

/// Builds the BVH over the segments of the strands that a level of detail keeps.
pub fn strand_blas(strands: &Strands, level: StrandLevel) -> StrandBlas {
    // The first point of each segment, with the factor on its radius
    let mut segments: Vec<(u32, f32)> = Vec::with_capacity(strands.points().len() / level.every());
    for part in strands.parts() {
        let level = if is_thinned(strands, part) { level } else { StrandLevel::ALL };
        for strand in part.strands.clone().step_by(level.every()) {
            let points = strands.range(strand as usize);
            segments.extend((points.start as u32..points.end as u32 - 1).map(|first| (first, level.width())));
        }
    }
    let ends = |(first, width): (u32, f32)| {
        let point = |index: u32| strands.points()[index as usize];
        [point(first), point(first + 1)].map(|end| StrandPoint { radius_m: end.radius_m * width, ..end })
    };
    let bounds = |&segment: &(u32, f32)| {
        let [(a_low, a_high), (b_low, b_high)] =
            ends(segment).map(|end| (end.position - end.radius_m, end.position + end.radius_m));
        (a_low.min(b_low), a_high.max(b_high))
    };
    let boxes: Vec<(Vec3, Vec3)> = segments.par_iter().map(bounds).collect();
    Blas::build(&boxes, |leaf| {
        let of_leaf = leaf.iter().map(|&i| segments[i as usize]);
        SegmentPacket::new(of_leaf.map(|segment| (segment.0, ends(segment))))
    })
}

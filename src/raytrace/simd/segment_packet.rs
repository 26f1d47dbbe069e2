//! Eight strand segments as a structure of arrays, and a ray prepared for the test against them.
//!
//! A segment is a flat ribbon that faces the ray: its axis is a straight line, its width falls linearly, and its ends
//! are round, so that there is no gap at a bend. In the plane perpendicular to the ray, a ray hits where it passes the
//! axis at less than the radius (the ray-centric test of PBRT, 4th ed., section 6.7, for straight curves). A ribbon is as
//! good as a round fibre for hair, whose BSDF includes all light inside of the fibre.
//!
//! Error: the perpendicular distance has the rounding error of the coordinates, some 1 um at 5 m.

use crate::math::orthonormal_basis;
use crate::math::simd::LANES;
use crate::scene::StrandPoint;
use glam::Vec3;

/// Up to eight segments. Unused lanes hold NaN, which fails every comparison.
#[derive(Clone, Copy, Debug)]
#[repr(C, align(64))]
pub struct SegmentPacket {
    /// X, Y, Z and radius, by end, coordinate and lane.
    pub(super) ends: [[[f32; LANES]; 4]; 2],
    /// Indices of the first points of the segments in the mesh.
    segments: [u32; LANES],
}

/// A ray prepared for the segment test: a frame whose Z axis is the ray.
#[derive(Clone, Copy, Debug)]
pub struct RibbonRay {
    pub(super) origin: [f32; 3],
    /// X and Y axis of the frame, unit; Z axis in units of the ray's `t`.
    pub(super) axes: [[f32; 3]; 3],
}

/// The intersection of a ray with a segment.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SegmentHit {
    /// Distance in multiples of the ray's direction vector.
    pub t: f32,
    /// Index of the first point of the segment.
    pub segment: u32,
    /// Position on the segment: 0 at its first point, 1 at its second.
    pub s: f32,
    /// Offset of the ray across the width, -1 to 1. With T along the segment and N towards the ray's origin, it points
    /// along N x T: the sign of Chiang et al. 2016.
    pub h: f32,
}

/// What the kernels find out about the nearest of eight segments.
pub(super) struct NearestSegment {
    pub lane: usize,
    pub t: f32,
    pub s: f32,
    /// From the first to the second end, in the ray's frame.
    pub along: [f32; 2],
    /// From the ray to the axis, in the ray's frame.
    pub to_axis: [f32; 2],
    pub radius: f32,
}

impl RibbonRay {
    /// Prepares a ray. The direction must not be zero.
    #[inline(always)]
    pub fn new(origin: Vec3, direction: Vec3) -> Self {
        let inverse = 1.0 / direction.length();
        let unit = direction * inverse;
        let (x, y) = orthonormal_basis(unit);
        RibbonRay { origin: origin.to_array(), axes: [x.to_array(), y.to_array(), (unit * inverse).to_array()] }
    }
}

impl SegmentPacket {
    /// Packs up to eight segments, given by the index of the first point and both points.
    pub fn new(segments: impl IntoIterator<Item = (u32, [StrandPoint; 2])>) -> Self {
        let mut packet = SegmentPacket { ends: [[[f32::NAN; LANES]; 4]; 2], segments: [u32::MAX; LANES] };
        for (lane, (index, points)) in segments.into_iter().take(LANES).enumerate() {
            packet.segments[lane] = index;
            for (end, point) in points.iter().enumerate() {
                let coordinates = point.position.extend(point.radius_m).to_array();
                for (axis, coordinate) in coordinates.into_iter().enumerate() {
                    packet.ends[end][axis][lane] = coordinate;
                }
            }
        }
        packet
    }

    /// Returns the hit of the nearest segment.
    #[inline(always)]
    pub(super) fn hit(&self, nearest: &NearestSegment) -> SegmentHit {
        let ([ex, ey], [cx, cy]) = (nearest.along, nearest.to_axis);
        // The cross product of both is the offset across the width times the length, 0 for a ray along the fibre.
        let width = nearest.radius * (ex * ex + ey * ey).sqrt();
        let h = if width > 0.0 { ((ex * cy - ey * cx) / width).clamp(-1.0, 1.0) } else { 0.0 };
        SegmentHit { t: nearest.t, segment: self.segments[nearest.lane], s: nearest.s, h }
    }
}

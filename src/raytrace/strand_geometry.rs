//! The strands of a mesh prepared for tracing, and the surface interaction at a hit of one.

use super::geometry::{Instance, SurfaceInteraction};
use super::simd::SegmentHit;
use super::strand_blas::StrandBlas;
use crate::math::orthonormal_basis;
use crate::scene::Strands;
use glam::{Mat3A, Vec2, Vec3, Vec3A};
use std::ops::Range;

/// Ray origins are offset by this many radii, so that a ray leaves the fibre that it starts on: 1, and a margin for the
/// rounding of a narrow ribbon's width.
const SPAWN_RADII: f32 = 1.05;

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

/// The position on a strand, in world space.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct StrandCoordinates {
    /// Unit direction of the strand towards its tip, interpolated between segments.
    pub tangent: Vec3,
    /// Offset across the width, -1 to 1, along N x T for the direction N towards the ray's origin.
    pub h: f32,
    /// Position along the strand: 0 at its root, 1 at its tip.
    pub u: f32,
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
        StrandGeometry { blas: StrandBlas::new(strands), starts, parts }
    }

    /// Returns the index of the part of a segment, among the strands' parts.
    pub fn part(&self, segment: u32) -> usize {
        self.parts.iter().position(|points| points.contains(&segment)).unwrap_or(0)
    }

    fn is_start(&self, point: u32) -> bool {
        self.starts.get(point as usize / 64).is_some_and(|word| word >> (point % 64) & 1 == 1)
    }

    /// Returns the first point of the strand that a point belongs to.
    fn start_of(&self, point: u32) -> u32 {
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
    fn end_of(&self, point: u32, point_count: u32) -> u32 {
        (point + 1..point_count).find(|&next| self.is_start(next)).unwrap_or(point_count)
    }

    /// Returns the unit direction of a strand at a position on a segment, interpolated between those at its points.
    fn tangent(&self, strands: &Strands, segment: u32, s: f32) -> Vec3 {
        let points = strands.points();
        let position = |point: u32| points[point as usize].position;
        let chord = position(segment + 1) - position(segment);
        let before = if self.is_start(segment) { chord } else { position(segment + 1) - position(segment - 1) };
        let is_last = segment + 2 >= points.len() as u32 || self.is_start(segment + 2);
        let after = if is_last { chord } else { position(segment + 2) - position(segment) };
        let chord = chord.normalize_or(Vec3::Y);
        before.normalize_or(chord).lerp(after.normalize_or(chord), s).normalize_or(chord)
    }

    /// Returns the surface interaction at a hit, in world space.
    pub fn surface(&self, instance: &Instance, hit: &StrandHit) -> SurfaceInteraction {
        let mesh = instance.geometry.mesh();
        let SegmentHit { segment, s, h, .. } = hit.segment;
        let [a, b] = [0, 1].map(|end| mesh.strands.points()[segment as usize + end]);
        let local = Vec3A::from(a.position.lerp(b.position, s));
        let matrix = instance.world_from_object().matrix3;

        // Build the frame of the ribbon, which faces the ray
        let along = matrix * Vec3A::from(b.position - a.position);
        let (facing, along) = frame(along.into(), hit.ray_direction);
        // A mirrored instance swaps the sides of the ribbon.
        let h = if matrix.determinant() < 0.0 { -h } else { h };
        let across = facing.cross(along) * h;

        // Bound the error so that rays which leave in any direction clear the fibre
        let radius = (a.radius_m + s * (b.radius_m - a.radius_m)) * largest_scale(&matrix);
        let rounding = instance.world_error(local, local.abs() * crate::math::gamma(8));
        let position_error = Vec3::from(rounding) + SPAWN_RADII * radius;

        // A round fibre, for materials that are not fibres
        let normal = across + facing * (1.0 - h * h).max(0.0).sqrt();
        let tangent: Vec3 = (matrix * Vec3A::from(self.tangent(&mesh.strands, segment, s))).into();
        let (start, end) = (self.start_of(segment), self.end_of(segment, mesh.strands.points().len() as u32));
        let u = ((segment - start) as f32 + s) / (end - start - 1).max(1) as f32;
        let part = mesh.parts.len() + self.part(segment);
        let position: Vec3 = instance.world_from_object().transform_point3a(local).into();
        SurfaceInteraction {
            position: position + across * radius,
            position_error,
            smooth_offset: Vec3::ZERO,
            geometric_normal: facing,
            normal: normal.normalize_or(facing),
            uv: Vec2::new(u, 0.5 + 0.5 * h),
            material: instance.materials.get(part).copied().unwrap_or(0),
            is_thin: true,
            strand: Some(StrandCoordinates { tangent: tangent.normalize_or(along), h, u }),
        }
    }
}

/// Returns the unit directions towards the origin of a ray, perpendicular to a fibre, and along the fibre.
fn frame(along: Vec3, ray_direction: Vec3) -> (Vec3, Vec3) {
    let along = along.normalize_or(Vec3::Y);
    let perpendicular = along * along.dot(ray_direction) - ray_direction;
    // A ray along the fibre hits its end from no side in particular.
    (perpendicular.try_normalize().unwrap_or_else(|| orthonormal_basis(along).0), along)
}

fn largest_scale(matrix: &Mat3A) -> f32 {
    let columns = [matrix.x_axis, matrix.y_axis, matrix.z_axis];
    columns.into_iter().map(Vec3A::length_squared).fold(0.0, f32::max).sqrt()
}

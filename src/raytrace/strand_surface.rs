//! The surface interaction at a hit of a strand.

use super::geometry::{Instance, StrandCoordinates, SurfaceInteraction};
use super::simd::SegmentHit;
use super::strand_detail::StrandLevel;
use super::strand_geometry::StrandHit;
use crate::math::orthonormal_basis;
use glam::{Vec2, Vec3, Vec3A};

/// Ray origins are offset by this many radii, so that a ray leaves the fibre that it starts on: 1, and a margin for the
/// rounding of a narrow ribbon's width.
const SPAWN_RADII: f32 = 1.05;

/// Returns the surface interaction at a hit of a strand, in world space.
pub fn surface(instance: &Instance, hit: &StrandHit) -> SurfaceInteraction {
    let strands = &instance.geometry.strands;
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

    // Bound the error so that rays which leave in any direction clear the fibre. Where strands are widened, rays leave
    // from the axis: they have the strand's ribbon behind them however wide it is. From its edge they would skip a part
    // of the hair around.
    let radius = (a.radius_m + s * (b.radius_m - a.radius_m)) * instance.largest_scale();
    let from_axis = if hit.level == StrandLevel::ALL { across * radius } else { Vec3::ZERO };
    let rounding = instance.world_error(local, local.abs() * crate::math::gamma(8));
    let position_error = Vec3::from(rounding) + SPAWN_RADII * radius;

    // A round fibre, for materials that are not fibres
    let normal = across + facing * (1.0 - h * h).max(0.0).sqrt();
    let tangent: Vec3 = (matrix * Vec3A::from(strands.tangent(&mesh.strands, segment, s))).into();
    let (start, end) = (strands.start_of(segment), strands.end_of(segment, mesh.strands.points().len() as u32));
    let u = ((segment - start) as f32 + s) / (end - start - 1).max(1) as f32;
    let part = mesh.parts.len() + strands.part(segment);
    let position: Vec3 = instance.world_from_object().transform_point3a(local).into();
    SurfaceInteraction {
        position: position + from_axis,
        position_error,
        smooth_offset: Vec3::ZERO,
        geometric_normal: facing,
        normal: normal.normalize_or(facing),
        relief_normal: normal.normalize_or(facing),
        uv: Vec2::new(u, 0.5 + 0.5 * h),
        second_uv: Vec2::ZERO,
        color: Vec3::ONE,
        material: instance.materials.get(part).copied().unwrap_or(0),
        is_thin: true,
        tangent: Vec3::ZERO,
        strand: Some(StrandCoordinates { tangent: tangent.normalize_or(along), h, u }),
    }
}

/// Returns the unit directions towards the origin of a ray, perpendicular to a fibre, and along the fibre.
fn frame(along: Vec3, ray_direction: Vec3) -> (Vec3, Vec3) {
    let along = along.normalize_or(Vec3::Y);
    let perpendicular = along * along.dot(ray_direction) - ray_direction;
    // A ray along the fibre hits its end from no side in particular.
    (perpendicular.try_normalize().unwrap_or_else(|| orthonormal_basis(along).0), along)
}

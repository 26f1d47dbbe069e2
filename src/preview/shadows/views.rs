//! Fitting of shadow map views: one view that contains all casters where they fit, a cube map for a light among them.

use super::focus::VisibleReceivers;
use super::slots::{GpuShadowSlot, Projection};
use crate::preview::geometry::oriented_box::OrientedBox;
use crate::preview::lights::light_table::{GpuLight, LightKind};
use bytemuck::Zeroable;
use glam::{Affine3A, Mat4, Quat, Vec2, Vec3, Vec4};

/// Tangent of the largest half angle of a single view, 75 degrees; a light with casters beyond it gets a cube map.
const MAX_TANGENT: f32 = 3.73;
/// Tangent of the half angle of a cube face, slightly over 1 so that the filter kernel may cross the edge.
const CUBE_FACE: f32 = 1.04;
/// Tangent of the half angle of a cube face that is used alone, in close-ups: receivers near a cube edge fit into it.
const SINGLE_FACE: f32 = 1.6;
/// Number of faces of cube maps, around a light and before a panel.
const CUBE_FACES: usize = 6;
const PANEL_CUBE_FACES: usize = 5;
/// Near plane, metres.
const NEAR_M: f32 = 0.01;

/// Returns a light's slot and the clip-from-world matrices of its views, at most `max_views`; an empty slot and none if
/// it casts no shadow.
pub(crate) fn fit_views(
    light: &GpuLight,
    casters: &[OrientedBox],
    receivers: &VisibleReceivers,
    max_views: usize,
) -> (GpuShadowSlot, Vec<Mat4>) {
    let corners: Vec<Vec3> = casters.iter().flat_map(OrientedBox::corners).collect();
    if corners.is_empty() {
        return (GpuShadowSlot::zeroed(), Vec::new());
    }
    // Bound the casters and the penumbra
    let frame = light_frame(light);
    let spot_limit = light.outer_rad.min(1.3).tan().min(MAX_TANGENT);
    let nearest = casters.iter().map(|caster| caster.distance(light.position.into())).fold(f32::INFINITY, f32::min);
    // The largest penumbra, as tangents, is the margin around visible receivers
    let focus = (light.softness() / nearest.max(NEAR_M), receivers);
    // Fit one view by the kind of light, or a cube if some casters do not fit
    let single = match light.kind {
        kind if kind == LightKind::Sun as u32 => parallel(&frame, &corners, light.softness(), receivers),
        kind if kind == LightKind::Spot as u32 => perspective(&frame, &corners, spot_limit, focus),
        kind if kind == LightKind::Rect as u32 || kind == LightKind::Disc as u32 => {
            if max_views >= PANEL_CUBE_FACES && corners.iter().any(|corner| !is_within(&frame, *corner)) {
                return cube(&frame, Projection::PanelCube, focus);
            }
            perspective(&frame, &corners, MAX_TANGENT, focus)
        }
        _ => {
            let centre = corners.iter().sum::<Vec3>() / corners.len() as f32;
            let towards = crate::math::look_at(frame.translation.into(), centre, 0.0);
            if max_views >= CUBE_FACES && corners.iter().any(|corner| !is_within(&towards, *corner)) {
                return cube(&Affine3A::from_translation(light.position.into()), Projection::Cube, focus);
            }
            perspective(&towards, &corners, MAX_TANGENT, focus)
        }
    };
    match single.filter(|_| max_views >= 1) {
        Some((slot, view)) => (slot, vec![view]),
        None => (GpuShadowSlot::zeroed(), Vec::new()),
    }
}

/// Returns true if a box is inside of the largest single view that a light can have of the casters; a sun has no view of
/// more than those.
pub(crate) fn is_in_one_view(light: &GpuLight, casters: &[OrientedBox], added: &OrientedBox) -> bool {
    let all_within = |frame: &Affine3A| added.corners().iter().all(|corner| is_within(frame, *corner));
    match light.kind {
        kind if kind == LightKind::Sun as u32 => false,
        kind if [LightKind::Spot, LightKind::Rect, LightKind::Disc].iter().any(|each| *each as u32 == kind) => {
            all_within(&light_frame(light))
        }
        _ => {
            let count = (8 * casters.len()) as f32;
            let middle = casters.iter().flat_map(OrientedBox::corners).sum::<Vec3>() / count;
            let position = Vec3::from(light.position);
            casters.is_empty() || all_within(&crate::math::look_at(position, middle, 0.0))
        }
    }
}

/// Returns the frame of a light.
fn light_frame(light: &GpuLight) -> Affine3A {
    Affine3A::from_mat3_translation(
        glam::Mat3::from_cols(
            Vec3::from(light.right).normalize_or(Vec3::X),
            Vec3::from(light.up).normalize_or(Vec3::Y),
            -Vec3::from(light.axis),
        ),
        light.position.into(),
    )
}

/// Returns true if a point is inside of the largest single view of a frame.
fn is_within(frame: &Affine3A, point: Vec3) -> bool {
    let local = frame.inverse().transform_point3(point);
    local.z < -NEAR_M && local.x.abs().max(local.y.abs()) < -local.z * MAX_TANGENT
}

/// Returns a slot with a frame, a projection and an image plane extent.
fn slot(frame: &Affine3A, kind: Projection, low: Vec2, field: Vec2) -> GpuShadowSlot {
    GpuShadowSlot {
        position: frame.translation.into(),
        right: frame.matrix3.x_axis.into(),
        up: frame.matrix3.y_axis.into(),
        forward: (-frame.matrix3.z_axis).into(),
        kind: kind as u32,
        near_m: NEAR_M,
        low: low.into(),
        field: field.into(),
        ..GpuShadowSlot::zeroed()
    }
}

/// Fits a perspective view along the -Z of `frame` to the corners, up to a half angle of tangent `limit`, and focuses
/// it on the receivers with a margin; none if all corners are behind it.
fn perspective(
    frame: &Affine3A,
    corners: &[Vec3],
    limit: f32,
    (margin, receivers): (Vec2, &VisibleReceivers),
) -> Option<(GpuShadowSlot, Mat4)> {
    let inverse = frame.inverse();
    // Compute the tangents of the corners
    let (mut low, mut high) = (Vec2::INFINITY, Vec2::NEG_INFINITY);
    let mut reaches_behind = false;
    for corner in corners {
        match tangents(&inverse, *corner) {
            Some(tangent) => (low, high) = (low.min(tangent), high.max(tangent)),
            None => reaches_behind = true,
        }
    }
    if !low.is_finite() || !high.is_finite() {
        return None;
    }
    // A caster that extends behind the light may cover any part of the view
    let limit = Vec2::splat(limit);
    let (low, high) = if reaches_behind { (-limit, limit) } else { (low, high) };
    let edge = (high - low) * 0.01 + 1e-3;
    let whole = ((low - edge).clamp(-limit, limit), (high + edge).clamp(-limit, limit));
    // Focus on the visible receivers
    let (low, high) = receivers.focused(whole, margin, |point| tangents(&inverse, point));
    let field = high - low;
    ((whole.1 - whole.0).min_element() > 1e-4).then(|| {
        (slot(frame, Projection::Perspective, low, field), perspective_matrix(low, high) * Mat4::from(inverse))
    })
}

/// Projects a point to tangents in a view; none behind the near plane.
fn tangents(view_from_world: &Affine3A, point: Vec3) -> Option<Vec2> {
    let local = view_from_world.transform_point3(point);
    (local.z < -NEAR_M).then(|| local.truncate() / -local.z)
}

/// Returns clip from view for tangents from `low` to `high`, with reversed infinite depth.
fn perspective_matrix(low: Vec2, high: Vec2) -> Mat4 {
    let (size, sum) = (high - low, high + low);
    Mat4::from_cols(
        Vec4::new(2.0 / size.x, 0.0, 0.0, 0.0),
        Vec4::new(0.0, 2.0 / size.y, 0.0, 0.0),
        Vec4::new(sum.x / size.x, sum.y / size.y, 0.0, -1.0),
        Vec4::new(0.0, 0.0, NEAR_M, 0.0),
    )
}

/// Fits a parallel view along the -Z of `frame` to the corners and focuses it on the receivers, with the penumbra of a
/// sun of angular radius `softness` (tangents) as margin.
fn parallel(
    frame: &Affine3A,
    corners: &[Vec3],
    softness: Vec2,
    receivers: &VisibleReceivers,
) -> Option<(GpuShadowSlot, Mat4)> {
    let inverse = frame.inverse();
    let (low, high) = corners
        .iter()
        .map(|corner| inverse.transform_point3(*corner))
        .fold((Vec3::INFINITY, Vec3::NEG_INFINITY), |(low, high), p| (low.min(p), high.max(p)));
    let (low, high) = (low - 0.01, high + 0.01);
    let project = |point| Some(inverse.transform_point3(point).truncate());
    let focused = receivers.focused((low.truncate(), high.truncate()), softness * (high.z - low.z), project);
    let (low, high) = (focused.0.extend(low.z), focused.1.extend(high.z));
    let size = high - low;
    size.is_finite().then(|| {
        // Depth is 1 towards the light and 0 behind the last caster
        let scale = Vec3::new(2.0 / size.x, 2.0 / size.y, 1.0 / size.z);
        let offset = Vec3::new(-(low.x + high.x) / size.x, -(low.y + high.y) / size.y, -low.z / size.z);
        let projection = Mat4::from_translation(offset) * Mat4::from_scale(scale);
        let slot = slot(frame, Projection::Parallel, low.truncate(), size.truncate());
        (GpuShadowSlot { near_m: size.z, far_m: -low.z, ..slot }, projection * Mat4::from(inverse))
    })
}

/// Returns the views of a cube map in the order +X, -X, +Y, -Y, -Z (forwards), +Z of the frame, oriented as in
/// `shadow_mask.wgsl`, without the last before a panel; or a single face where a focused part of it contains all receivers
/// with their margin.
fn cube(
    frame: &Affine3A,
    kind: Projection,
    (margin, receivers): (Vec2, &VisibleReceivers),
) -> (GpuShadowSlot, Vec<Mat4>) {
    let quarter = std::f32::consts::FRAC_PI_2;
    // Rotations of the faces
    let turns = [
        Quat::from_rotation_y(-quarter),
        Quat::from_rotation_y(quarter),
        Quat::from_rotation_x(quarter),
        Quat::from_rotation_x(-quarter),
        Quat::IDENTITY,
        Quat::from_rotation_y(2.0 * quarter),
    ];
    let single = Vec2::splat(SINGLE_FACE);
    // Use a single face if it contains all receivers
    for frame in turns.map(|turn| *frame * Affine3A::from_quat(turn)) {
        let project = |point| tangents(&frame.inverse(), point);
        let (low, high) = receivers.focused((-single, single), margin, project);
        if receivers.is_within((-single, single), margin, project) && high - low != 2.0 * single {
            let view = perspective_matrix(low, high) * Mat4::from(frame.inverse());
            return (slot(&frame, Projection::Perspective, low, high - low), vec![view]);
        }
    }
    // Otherwise all faces
    let face = Vec2::splat(CUBE_FACE);
    let view = |turn| {
        let inverse = (*frame * Affine3A::from_quat(turn)).inverse();
        perspective_matrix(-face, face) * Mat4::from(inverse)
    };
    let faces = if kind == Projection::PanelCube { PANEL_CUBE_FACES } else { CUBE_FACES };
    (slot(frame, kind, -face, 2.0 * face), turns.into_iter().take(faces).map(view).collect())
}

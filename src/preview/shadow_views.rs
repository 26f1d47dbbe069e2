//! From where each light sees the studio: one view that covers all casters where they fit, six for a light among them.

use super::draw_list::Caster;
use super::light_table::{GpuLight, Kind, MAX_LIGHTS};
use bytemuck::{Pod, Zeroable};
use glam::{Affine3A, Mat4, Quat, Vec3, Vec4};

/// Shadow maps in use at once; lights beyond cast no shadow.
pub(super) const MAX_VIEWS: usize = 32;
/// Tangent of the widest half angle of one view, 75 degrees.
const WIDEST: f32 = 3.73;
/// Half width of a cube face at distance 1, a little over 1 so that the kernel may reach over the edge.
const CUBE_FACE: f32 = 1.04;
/// Nearest caster, metres.
const NEAR_M: f32 = 0.01;

/// One shadow map's view in a storage buffer; twin of `ShadowView` in `scene.wgsl`.
#[repr(C)]
#[derive(Clone, Copy, Debug, PartialEq, Pod, Zeroable)]
pub(super) struct GpuShadowView {
    pub clip_from_world: [[f32; 4]; 4],
    pub world_from_clip: [[f32; 4]; 4],
    /// Width of the map's field at distance 1 (perspective), or in metres (parallel).
    pub field: [f32; 2],
    /// Depth is near over distance (perspective); 0 marks a parallel view.
    pub near_m: f32,
    /// Distance that depth 0..1 spans in a parallel view, metres.
    pub range_m: f32,
}

/// Assigns views to lights (`first_view`, `view_count`) and returns them in order.
pub(super) fn plan(lights: &mut [GpuLight], casters: &[Caster]) -> Vec<GpuShadowView> {
    debug_assert!(lights.len() <= MAX_LIGHTS);
    let corners: Vec<[Vec3; 8]> = casters.iter().map(Caster::corners).collect();
    let mut views = Vec::new();
    for light in lights {
        let own = if corners.is_empty() { Vec::new() } else { views_of(light, &corners) };
        if own.is_empty() || views.len() + own.len() > MAX_VIEWS {
            continue;
        }
        (light.first_view, light.view_count) = (views.len() as u32, own.len() as u32);
        views.extend(own);
    }
    views
}

fn views_of(light: &GpuLight, corners: &[[Vec3; 8]]) -> Vec<GpuShadowView> {
    let position = Vec3::from(light.position);
    let right = Vec3::from(light.right).normalize_or(Vec3::X);
    let up = Vec3::from(light.up).normalize_or(Vec3::Y);
    let back = -Vec3::from(light.axis);
    let frame = Affine3A::from_mat3_translation(glam::Mat3::from_cols(right, up, back), position);
    let all = corners.iter().flatten();
    if light.kind == Kind::Sun as u32 {
        return parallel(&frame, all).into_iter().collect();
    }
    if light.kind == Kind::Spot as u32 {
        let limit = light.outer_rad.min(1.3).tan().min(WIDEST);
        return perspective(&frame, all, limit).into_iter().collect();
    }
    if light.kind == Kind::Rect as u32 || light.kind == Kind::Disc as u32 {
        return perspective(&frame, all, WIDEST).into_iter().collect();
    }
    let centre = corners.iter().flatten().sum::<Vec3>() / (8 * corners.len()) as f32;
    let towards = crate::math::look_at(position, centre, 0.0);
    let fits = corners.iter().flatten().all(|corner| is_within(&towards, *corner));
    if fits { perspective(&towards, all, WIDEST).into_iter().collect() } else { cube(position).to_vec() }
}

fn is_within(frame: &Affine3A, point: Vec3) -> bool {
    let local = frame.inverse().transform_point3(point);
    local.z < -NEAR_M && local.x.abs().max(local.y.abs()) < -local.z * WIDEST
}

/// The view from `frame` along its -Z that covers the corners, no wider than `limit` (a tangent); none if it sees none.
fn perspective<'a>(frame: &Affine3A, corners: impl Iterator<Item = &'a Vec3>, limit: f32) -> Option<GpuShadowView> {
    let inverse = frame.inverse();
    let (mut low, mut high) = (Vec3::INFINITY.truncate(), Vec3::NEG_INFINITY.truncate());
    let (mut any_before, mut any_behind) = (false, false);
    for corner in corners {
        let local = inverse.transform_point3(*corner);
        if local.z < -NEAR_M {
            any_before = true;
            let tangent = local.truncate() / -local.z;
            (low, high) = (low.min(tangent), high.max(tangent));
        } else {
            any_behind = true;
        }
    }
    if !any_before || !low.is_finite() || !high.is_finite() {
        return None;
    }
    // A caster that reaches past the light's plane may reach the edge of the view anywhere.
    let reach = glam::Vec2::splat(limit);
    let (low, high) = if any_behind { (-reach, reach) } else { (low, high) };
    let margin = (high - low) * 0.01 + 1e-3;
    let (low, high) = ((low - margin).clamp(-reach, reach), (high + margin).clamp(-reach, reach));
    let size = high - low;
    (size.min_element() > 1e-4).then(|| {
        let centre = low + high;
        let projection = Mat4::from_cols(
            Vec4::new(2.0 / size.x, 0.0, 0.0, 0.0),
            Vec4::new(0.0, 2.0 / size.y, 0.0, 0.0),
            Vec4::new(centre.x / size.x, centre.y / size.y, 0.0, -1.0),
            Vec4::new(0.0, 0.0, NEAR_M, 0.0),
        );
        view(projection * Mat4::from(inverse), size.into(), NEAR_M, 0.0)
    })
}

fn parallel<'a>(frame: &Affine3A, corners: impl Iterator<Item = &'a Vec3>) -> Option<GpuShadowView> {
    let inverse = frame.inverse();
    let (low, high) = corners
        .map(|corner| inverse.transform_point3(*corner))
        .fold((Vec3::INFINITY, Vec3::NEG_INFINITY), |(low, high), p| (low.min(p), high.max(p)));
    let (low, high) = (low - 0.01, high + 0.01);
    let size = high - low;
    size.is_finite().then(|| {
        // Depth 1 at the side of the light, 0 behind the last caster.
        let scale = Vec3::new(2.0 / size.x, 2.0 / size.y, 1.0 / size.z);
        let offset = Vec3::new(-(low.x + high.x) / size.x, -(low.y + high.y) / size.y, -low.z / size.z);
        let projection = Mat4::from_translation(offset) * Mat4::from_scale(scale);
        view(projection * Mat4::from(inverse), [size.x, size.y], 0.0, size.z)
    })
}

/// Six views in the order +X, -X, +Y, -Y, +Z, -Z, which `shadow.wgsl` repeats.
fn cube(position: Vec3) -> [GpuShadowView; 6] {
    let quarter = std::f32::consts::FRAC_PI_2;
    let turns = [
        Quat::from_rotation_y(-quarter),
        Quat::from_rotation_y(quarter),
        Quat::from_rotation_x(quarter),
        Quat::from_rotation_x(-quarter),
        Quat::from_rotation_y(2.0 * quarter),
        Quat::IDENTITY,
    ];
    turns.map(|turn| {
        let inverse = Affine3A::from_rotation_translation(turn, position).inverse();
        let projection = Mat4::from_cols(
            Vec4::new(1.0 / CUBE_FACE, 0.0, 0.0, 0.0),
            Vec4::new(0.0, 1.0 / CUBE_FACE, 0.0, 0.0),
            Vec4::new(0.0, 0.0, 0.0, -1.0),
            Vec4::new(0.0, 0.0, NEAR_M, 0.0),
        );
        view(projection * Mat4::from(inverse), [2.0 * CUBE_FACE; 2], NEAR_M, 0.0)
    })
}

fn view(clip_from_world: Mat4, field: [f32; 2], near_m: f32, range_m: f32) -> GpuShadowView {
    let world_from_clip = clip_from_world.as_dmat4().inverse().as_mat4();
    GpuShadowView {
        clip_from_world: clip_from_world.to_cols_array_2d(),
        world_from_clip: world_from_clip.to_cols_array_2d(),
        field,
        near_m,
        range_m,
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use glam::Vec2;

    fn unit_box_at(place: Vec3) -> Caster {
        Caster { world_from_object: Affine3A::from_translation(place), low: Vec3::splat(-0.5), high: Vec3::splat(0.5) }
    }

    fn light(kind: Kind) -> GpuLight {
        GpuLight {
            kind: kind as u32,
            position: [0.0, 4.0, 0.0],
            right: [1.0, 0.0, 0.0],
            up: [0.0, 0.0, -1.0],
            axis: [0.0, -1.0, 0.0],
            outer_rad: 0.7,
            ..GpuLight::zeroed()
        }
    }

    fn project(view: &GpuShadowView, point: Vec3) -> Vec3 {
        let clip = Mat4::from_cols_array_2d(&view.clip_from_world) * point.extend(1.0);
        clip.truncate() / clip.w
    }

    #[test]
    fn one_view_holds_every_caster_and_depth_falls_with_distance() {
        for kind in [Kind::Point, Kind::Spot, Kind::Sphere, Kind::Rect, Kind::Sun] {
            let mut lights = [light(kind)];
            let caster = unit_box_at(Vec3::new(0.3, 1.0, 0.2));
            let views = plan(&mut lights, &[caster]);
            assert_eq!((views.len(), lights[0].view_count), (1, 1), "{kind:?}");
            for corner in caster.corners() {
                let p = project(&views[0], corner);
                assert!(p.truncate().abs().max_element() <= 1.0 && (0.0..=1.0).contains(&p.z), "{kind:?}: {p}");
                let farther = project(&views[0], corner - Vec3::Y * 0.1);
                assert!(farther.z < p.z, "{kind:?}");
            }
        }
    }

    #[test]
    fn a_bulb_among_things_gets_a_cube_that_sees_all_round() {
        let mut lights = [light(Kind::Point)];
        let casters = [unit_box_at(Vec3::ZERO), unit_box_at(Vec3::Y * 8.0)];
        let views = plan(&mut lights, &casters);
        assert_eq!(views.len(), 6);
        let axes = [Vec3::X, Vec3::NEG_X, Vec3::Y, Vec3::NEG_Y, Vec3::Z, Vec3::NEG_Z];
        for (view, axis) in views.iter().zip(axes) {
            let p = project(view, Vec3::from(lights[0].position) + axis * 2.0);
            assert!(p.truncate().length() < 1e-5 && p.z > 0.0, "{axis}: {p}");
        }
    }

    #[test]
    fn depth_is_affine_across_a_plane() {
        // The shader's receiver plane rests on it: the middle of two points' maps lies on the plane's depth.
        let view = views_of(&light(Kind::Rect), &[unit_box_at(Vec3::Y).corners()])[0];
        let (a, b) = (project(&view, Vec3::new(-0.3, 0.2, 0.1)), project(&view, Vec3::new(0.4, 0.9, -0.2)));
        let on_line = project(&view, Vec3::new(-0.3, 0.2, 0.1).lerp(Vec3::new(0.4, 0.9, -0.2), 0.25));
        let along = (on_line.truncate() - a.truncate()).length() / (b.truncate() - a.truncate()).length();
        assert!((a.z + (b.z - a.z) * along - on_line.z).abs() < 1e-6);
        assert!(Vec2::new(along, 0.0).is_finite());
    }

    #[test]
    fn too_many_lights_go_without_shadow_and_no_caster_needs_no_map() {
        let mut lights = [light(Kind::Rect); 40];
        assert_eq!(plan(&mut lights, &[unit_box_at(Vec3::ZERO)]).len(), MAX_VIEWS);
        assert_eq!(lights[39].view_count, 0);
        assert!(plan(&mut [light(Kind::Rect)], &[]).is_empty());
    }
}

//! From where each light sees the studio: one view that covers all casters where they fit, six for a light among them;
//! the same for each part of an emitter that is taken in parts.

use super::focus::Seen;
use super::layers::{Owner, Run, View};
use super::parts::{MOST_PARTS, parts};
use crate::preview::geometry::draw_list::Caster;
use crate::preview::lights::light_table::{GpuLight, Kind, LightTable};
use bytemuck::{Pod, Zeroable};
use glam::{Affine3A, Mat4, Quat, Vec2, Vec3, Vec4};

/// Shadow maps in use at once.
pub(crate) const MAX_VIEWS: usize = 48;
/// Lights that cast shadows, four a mask; lights beyond cast none.
pub(crate) const MAX_SHADOWS: usize = 16;
/// Tangent of the widest half angle of one view, 75 degrees; a light whose casters reach farther gets a cube.
const WIDEST: f32 = 3.73;
/// Half width of a cube face at distance 1, a little over 1 so that the kernel may reach over the edge.
const CUBE_FACE: f32 = 1.04;
/// The same of a face that serves alone, close up: what lies about an edge of the cube fits into one, too.
const LONE_FACE: f32 = 1.6;
/// Nearest caster, metres.
const NEAR_M: f32 = 0.01;

/// How a slot's map is projected; twin of the numbers in `shadow_mask.wgsl`.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[repr(u32)]
enum Projection {
    Perspective = 1,
    Parallel = 2,
    Cube = 3,
}

/// View of a light or of a part of it; twin of `Slot` in `shadow_mask.wgsl`. All zero: no shadow.
#[repr(C)]
#[derive(Clone, Copy, Debug, PartialEq, Pod, Zeroable)]
pub(crate) struct GpuShadowSlot {
    pub position: [f32; 3],
    pub layer: u32,
    pub right: [f32; 3],
    pub kind: u32,
    pub up: [f32; 3],
    /// Depth is near over distance; in a parallel view the depth of the field, metres.
    pub near_m: f32,
    pub forward: [f32; 3],
    /// Distance of depth 0 in a parallel view, metres.
    pub far_m: f32,
    /// Corner and size of the field: tangents, or metres in a parallel view.
    pub low: [f32; 2],
    pub field: [f32; 2],
    pub softness: [f32; 2],
    pub unused: [f32; 2],
}

/// Four lights' views; twin of `Shadows` in `shadow_mask.wgsl`.
#[repr(C)]
#[derive(Clone, Copy, Debug, PartialEq, Pod, Zeroable)]
pub(crate) struct GpuShadows {
    /// Of each light, the parts in which it is taken.
    pub counts: [u32; 4],
    pub slots: [[GpuShadowSlot; MOST_PARTS]; 4],
}

/// The views to draw, and how each light reads them.
#[derive(Clone, Debug, Default, PartialEq)]
pub(crate) struct ShadowPlan {
    /// The views that this frame reads, light by light.
    pub runs: Vec<Run>,
    /// Four lights each, in their order. Slots count `runs` until `set_layers` has said where those are.
    pub masks: Vec<GpuShadows>,
    /// Views of this plan and of the draft that comes before it in motion.
    pub views: usize,
}

impl ShadowPlan {
    /// Views of the lights, as fine as what is `seen` needs them; `in_parts` takes wide emitters in parts.
    pub fn new(table: &LightTable, casters: &[Caster], seen: &Seen, in_parts: bool) -> Self {
        let mut plan = ShadowPlan::default();
        if casters.is_empty() {
            return plan;
        }
        let count = table.lights.len().min(MAX_SHADOWS);
        plan.masks = vec![GpuShadows::zeroed(); count.div_ceil(4)];
        let reached: Vec<Vec<Caster>> =
            table.lights[..count].iter().map(|light| within_reach(light, casters)).collect();
        // The middles first, so that all lights have a shadow before one has it in parts.
        for (index, casters) in reached.iter().enumerate() {
            let slot = plan.add(&table.lights[index], (table.ids[index].0, 0), casters, seen);
            plan.set(index, &[slot]);
        }
        if in_parts {
            for (index, casters) in reached.iter().enumerate() {
                plan.take_in_parts(index, &table.lights[index], casters, seen);
            }
        }
        plan.views = plan.view_count();
        plan.drop_unread();
        plan
    }

    /// Leaves out runs that no slot reads: the middles of lights that are taken in parts.
    fn drop_unread(&mut self) {
        let slots = self.masks.iter().flat_map(|mask| mask.slots.as_flattened()).filter(|slot| slot.kind != 0);
        let mut is_read = vec![false; self.runs.len()];
        slots.for_each(|slot| is_read[slot.layer as usize] = true);
        let places: Vec<usize> =
            is_read.iter().scan(0, |next, read| Some(std::mem::replace(next, *next + usize::from(*read)))).collect();
        self.set_layers(&places);
        let mut read = is_read.into_iter();
        self.runs.retain(|_| read.next() == Some(true));
    }

    /// Whether a light is taken in several parts.
    pub fn is_in_parts(&self) -> bool {
        self.masks.iter().flat_map(|mask| mask.counts).any(|count| count > 1)
    }

    /// Tells each slot the first layer of its run.
    pub fn set_layers(&mut self, firsts: &[usize]) {
        for slot in self.masks.iter_mut().flat_map(|mask| mask.slots.as_flattened_mut()).filter(|slot| slot.kind != 0) {
            slot.layer = firsts[slot.layer as usize] as u32;
        }
    }

    fn view_count(&self) -> usize {
        self.runs.iter().map(|run| run.views.len()).sum()
    }

    /// Adds a light's views as far as there is room.
    fn add(&mut self, light: &GpuLight, owner: Owner, casters: &[Caster], seen: &Seen) -> GpuShadowSlot {
        let (mut slot, views) = views_of(light, casters, seen, MAX_VIEWS - self.view_count());
        if !views.is_empty() {
            (slot.layer, slot.softness) = (self.runs.len() as u32, light.softness().into());
            let (eye, reach_m) = (light.position.into(), light.reach_m);
            let view = |clip_from_world| View { clip_from_world, eye, reach_m };
            self.runs.push(Run { owner, views: views.into_iter().map(view).collect() });
        }
        slot
    }

    fn set(&mut self, light: usize, slots: &[GpuShadowSlot]) {
        let mask = &mut self.masks[light / 4];
        mask.counts[light % 4] = slots.len() as u32;
        mask.slots[light % 4][..slots.len()].copy_from_slice(slots);
    }

    /// Replaces a light's one view by views of its parts, if it has any and there is room for them all.
    fn take_in_parts(&mut self, index: usize, light: &GpuLight, casters: &[Caster], seen: &Seen) {
        let parts = parts(light, casters);
        let middle = self.masks[index / 4].slots[index % 4][0];
        if parts.len() == 1 || middle.kind == 0 {
            return;
        }
        let before = self.runs.len();
        let id = self.runs[middle.layer as usize].owner.0;
        let slots: Vec<GpuShadowSlot> = (1..)
            .zip(&parts)
            .map(|(number, part)| {
                let offset = part.at.x * Vec3::from(light.right) + part.at.y * Vec3::from(light.up);
                let moved = GpuLight { position: (Vec3::from(light.position) + offset).into(), ..*light };
                let slot = if part.at == Vec2::ZERO { middle } else { self.add(&moved, (id, number), casters, seen) };
                GpuShadowSlot { softness: part.softness.into(), ..slot }
            })
            .collect();
        if slots.iter().any(|slot| slot.kind != middle.kind) {
            self.runs.truncate(before);
            return;
        }
        self.set(index, &slots);
    }
}

/// The casters whose shadow can be seen: beyond its reach a light is dark anyway.
fn within_reach(light: &GpuLight, casters: &[Caster]) -> Vec<Caster> {
    let reaches = |caster: &&Caster| light.reach_m == 0.0 || caster.distance(light.position.into()) < light.reach_m;
    casters.iter().filter(reaches).copied().collect()
}

/// How a light reads its shadow, and up to `room` views; an empty slot and none if it casts no shadow.
fn views_of(light: &GpuLight, casters: &[Caster], seen: &Seen, room: usize) -> (GpuShadowSlot, Vec<Mat4>) {
    let corners: Vec<Vec3> = casters.iter().flat_map(Caster::corners).collect();
    if corners.is_empty() {
        return (GpuShadowSlot::zeroed(), Vec::new());
    }
    let frame = Affine3A::from_mat3_translation(
        glam::Mat3::from_cols(
            Vec3::from(light.right).normalize_or(Vec3::X),
            Vec3::from(light.up).normalize_or(Vec3::Y),
            -Vec3::from(light.axis),
        ),
        light.position.into(),
    );
    let spot_limit = light.outer_rad.min(1.3).tan().min(WIDEST);
    let nearest = casters.iter().map(|caster| caster.distance(light.position.into())).fold(f32::INFINITY, f32::min);
    // No penumbra is wider, as tangents.
    let focus = (light.softness() / nearest.max(NEAR_M), seen);
    let one = match light.kind {
        kind if kind == Kind::Sun as u32 => parallel(&frame, &corners, light.softness(), seen),
        kind if kind == Kind::Spot as u32 => perspective(&frame, &corners, spot_limit, focus),
        kind if kind == Kind::Rect as u32 || kind == Kind::Disc as u32 => {
            if room >= 6 && corners.iter().any(|corner| !is_within(&frame, *corner)) {
                return cube(&frame, focus);
            }
            perspective(&frame, &corners, WIDEST, focus)
        }
        _ => {
            let centre = corners.iter().sum::<Vec3>() / corners.len() as f32;
            let towards = crate::math::look_at(frame.translation.into(), centre, 0.0);
            if room >= 6 && corners.iter().any(|corner| !is_within(&towards, *corner)) {
                return cube(&Affine3A::from_translation(light.position.into()), focus);
            }
            perspective(&towards, &corners, WIDEST, focus)
        }
    };
    match one.filter(|_| room >= 1) {
        Some((slot, view)) => (slot, vec![view]),
        None => (GpuShadowSlot::zeroed(), Vec::new()),
    }
}

fn is_within(frame: &Affine3A, point: Vec3) -> bool {
    let local = frame.inverse().transform_point3(point);
    local.z < -NEAR_M && local.x.abs().max(local.y.abs()) < -local.z * WIDEST
}

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

/// The view from `frame` along its -Z that covers the corners, no wider than `limit` (a tangent), or what is seen of them
/// with a margin; none if it sees none.
fn perspective(
    frame: &Affine3A,
    corners: &[Vec3],
    limit: f32,
    (margin, seen): (Vec2, &Seen),
) -> Option<(GpuShadowSlot, Mat4)> {
    let inverse = frame.inverse();
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
    // A caster that reaches past the light's plane may reach the edge of the view anywhere.
    let reach = Vec2::splat(limit);
    let (low, high) = if reaches_behind { (-reach, reach) } else { (low, high) };
    let edge = (high - low) * 0.01 + 1e-3;
    let whole = ((low - edge).clamp(-reach, reach), (high + edge).clamp(-reach, reach));
    let (low, high) = seen.narrowed(whole, margin, |point| tangents(&inverse, point));
    let field = high - low;
    ((whole.1 - whole.0).min_element() > 1e-4).then(|| {
        (slot(frame, Projection::Perspective, low, field), perspective_matrix(low, high) * Mat4::from(inverse))
    })
}

/// Where a view sees a point, as tangents; none behind it.
fn tangents(view_from_world: &Affine3A, point: Vec3) -> Option<Vec2> {
    let local = view_from_world.transform_point3(point);
    (local.z < -NEAR_M).then(|| local.truncate() / -local.z)
}

/// Clip from view for tangents from `low` to `high`, depth reversed and endless.
fn perspective_matrix(low: Vec2, high: Vec2) -> Mat4 {
    let (size, sum) = (high - low, high + low);
    Mat4::from_cols(
        Vec4::new(2.0 / size.x, 0.0, 0.0, 0.0),
        Vec4::new(0.0, 2.0 / size.y, 0.0, 0.0),
        Vec4::new(sum.x / size.x, sum.y / size.y, 0.0, -1.0),
        Vec4::new(0.0, 0.0, NEAR_M, 0.0),
    )
}

/// The view along the -Z of `frame` that covers the corners, or what is seen of them with the penumbra of a sun whose
/// half width is `softness` (tangents).
fn parallel(frame: &Affine3A, corners: &[Vec3], softness: Vec2, seen: &Seen) -> Option<(GpuShadowSlot, Mat4)> {
    let inverse = frame.inverse();
    let (low, high) = corners
        .iter()
        .map(|corner| inverse.transform_point3(*corner))
        .fold((Vec3::INFINITY, Vec3::NEG_INFINITY), |(low, high), p| (low.min(p), high.max(p)));
    let (low, high) = (low - 0.01, high + 0.01);
    let place = |point| Some(inverse.transform_point3(point).truncate());
    let narrowed = seen.narrowed((low.truncate(), high.truncate()), softness * (high.z - low.z), place);
    let (low, high) = (narrowed.0.extend(low.z), narrowed.1.extend(high.z));
    let size = high - low;
    size.is_finite().then(|| {
        // Depth 1 at the side of the light, 0 behind the last caster.
        let scale = Vec3::new(2.0 / size.x, 2.0 / size.y, 1.0 / size.z);
        let offset = Vec3::new(-(low.x + high.x) / size.x, -(low.y + high.y) / size.y, -low.z / size.z);
        let projection = Mat4::from_translation(offset) * Mat4::from_scale(scale);
        let slot = slot(frame, Projection::Parallel, low.truncate(), size.truncate());
        (GpuShadowSlot { near_m: size.z, far_m: -low.z, ..slot }, projection * Mat4::from(inverse))
    })
}

/// Six views in the order +X, -X, +Y, -Y, +Z, -Z of the frame, turned as `shadow_mask.wgsl` repeats; or one of them, where
/// a part of it holds all that is seen with its margin.
fn cube(frame: &Affine3A, (margin, seen): (Vec2, &Seen)) -> (GpuShadowSlot, Vec<Mat4>) {
    let quarter = std::f32::consts::FRAC_PI_2;
    let turns = [
        Quat::from_rotation_y(-quarter),
        Quat::from_rotation_y(quarter),
        Quat::from_rotation_x(quarter),
        Quat::from_rotation_x(-quarter),
        Quat::from_rotation_y(2.0 * quarter),
        Quat::IDENTITY,
    ];
    let lone = Vec2::splat(LONE_FACE);
    for frame in turns.map(|turn| *frame * Affine3A::from_quat(turn)) {
        let place = |point| tangents(&frame.inverse(), point);
        let (low, high) = seen.narrowed((-lone, lone), margin, place);
        if seen.is_within((-lone, lone), margin, place) && high - low != 2.0 * lone {
            let view = perspective_matrix(low, high) * Mat4::from(frame.inverse());
            return (slot(&frame, Projection::Perspective, low, high - low), vec![view]);
        }
    }
    let face = Vec2::splat(CUBE_FACE);
    let view = |turn| {
        let inverse = (*frame * Affine3A::from_quat(turn)).inverse();
        perspective_matrix(-face, face) * Mat4::from(inverse)
    };
    (slot(frame, Projection::Cube, -face, 2.0 * face), turns.map(view).to_vec())
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scene::LightId;

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

    fn table(lights: &[GpuLight]) -> LightTable {
        let ids = (0..lights.len() as u32).map(LightId).collect();
        LightTable { lights: lights.to_vec(), ids, ..LightTable::default() }
    }

    fn project(view: &Mat4, point: Vec3) -> Vec3 {
        view.project_point3(point)
    }

    #[test]
    fn one_view_holds_every_caster_and_depth_falls_with_distance() {
        for kind in [Kind::Point, Kind::Spot, Kind::Sphere, Kind::Rect, Kind::Sun] {
            let caster = unit_box_at(Vec3::new(0.3, 1.0, 0.2));
            let plan = ShadowPlan::new(&table(&[light(kind)]), &[caster], &Seen::default(), false);
            assert_eq!((plan.views, plan.masks.len()), (1, 1), "{kind:?}");
            for corner in caster.corners() {
                let p = project(&plan.runs[0].views[0].clip_from_world, corner);
                assert!(p.truncate().abs().max_element() <= 1.0 && (0.0..=1.0).contains(&p.z), "{kind:?}: {p}");
                let farther = project(&plan.runs[0].views[0].clip_from_world, corner - Vec3::Y * 0.1);
                assert!(farther.z < p.z, "{kind:?}");
            }
        }
    }

    #[test]
    fn a_bulb_among_things_gets_a_cube_that_sees_all_round() {
        let bulb = light(Kind::Point);
        let casters = [unit_box_at(Vec3::ZERO), unit_box_at(Vec3::Y * 8.0)];
        let plan = ShadowPlan::new(&table(&[bulb]), &casters, &Seen::default(), false);
        assert_eq!((plan.views, plan.masks[0].slots[0][0].kind), (6, Projection::Cube as u32));
        let axes = [Vec3::X, Vec3::NEG_X, Vec3::Y, Vec3::NEG_Y, Vec3::Z, Vec3::NEG_Z];
        for (view, axis) in plan.runs[0].views.iter().zip(axes) {
            let p = project(&view.clip_from_world, Vec3::from(bulb.position) + axis * 2.0);
            assert!(p.truncate().length() < 1e-5 && p.z > 0.0, "{axis}: {p}");
        }
    }

    #[test]
    fn depth_is_affine_across_a_plane() {
        // The shader's receiver plane rests on it: the middle of two points' maps lies on the plane's depth.
        let view = ShadowPlan::new(&table(&[light(Kind::Rect)]), &[unit_box_at(Vec3::Y)], &Seen::default(), false).runs
            [0]
        .views[0]
            .clip_from_world;
        let (a, b) = (project(&view, Vec3::new(-0.3, 0.2, 0.1)), project(&view, Vec3::new(0.4, 0.9, -0.2)));
        let on_line = project(&view, Vec3::new(-0.3, 0.2, 0.1).lerp(Vec3::new(0.4, 0.9, -0.2), 0.25));
        let along = (on_line.truncate() - a.truncate()).length() / (b.truncate() - a.truncate()).length();
        assert!((a.z + (b.z - a.z) * along - on_line.z).abs() < 1e-6);
    }

    #[test]
    fn too_many_lights_go_without_shadow_and_no_caster_needs_no_map() {
        let plan =
            ShadowPlan::new(&table(&[light(Kind::Rect); 40]), &[unit_box_at(Vec3::ZERO)], &Seen::default(), false);
        assert_eq!((plan.views, plan.masks.len()), (MAX_SHADOWS, MAX_SHADOWS / 4));
        let all_round = [unit_box_at(Vec3::ZERO), unit_box_at(Vec3::Y * 8.0)];
        let plan = ShadowPlan::new(&table(&[light(Kind::Rect); 16]), &all_round, &Seen::default(), false);
        // Eight cubes, and no room for more.
        let kind = |light: usize| plan.masks[light / 4].slots[light % 4][0].kind;
        assert_eq!((plan.views, kind(7), kind(8)), (MAX_VIEWS, Projection::Cube as u32, 0));
        assert_eq!(ShadowPlan::new(&table(&[light(Kind::Rect)]), &[], &Seen::default(), false), ShadowPlan::default());
    }
}

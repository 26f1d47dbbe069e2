//! The shadow plan of a frame: the shadow map views of each light and the slots through which they are read.

use super::focus::VisibleReceivers;
use super::layers::{LightViews, ShadowView, ViewOwner};
use super::parts::emitter_parts;
use super::slots::{GpuShadowSlot, GpuShadows};
use super::views::{fit_views, is_in_one_view};
use crate::preview::geometry::oriented_box::OrientedBox;
use crate::preview::lights::light_table::{GpuLight, LightTable};
use crate::scene::LightId;
use bytemuck::Zeroable;
use glam::{Vec2, Vec3};

/// Maximum number of shadow map views in a frame.
pub(crate) const MAX_VIEWS: usize = 48;
/// Maximum number of lights with shadows, four per mask; further lights cast none.
pub(crate) const MAX_SHADOWS: usize = 16;
/// The shadow map views of a frame and the slots of each light.
#[derive(Clone, Debug, Default, PartialEq)]
pub(crate) struct ShadowPlan {
    /// Views of the lights and emitter parts that this frame reads.
    pub lights: Vec<LightViews>,
    /// Four lights each, in the order of the light table. A slot's layer is an index into `lights` until `set_layers`
    /// replaces it by the first layer of those views.
    pub masks: Vec<GpuShadows>,
    /// Number of views including the unsubdivided ones that a draft of this frame would read.
    pub views: usize,
}

impl ShadowPlan {
    /// Plans the shadows of a table's lights. `subdivide` splits large emitters into parts.
    pub fn new(table: &LightTable, casters: &[OrientedBox], receivers: &VisibleReceivers, subdivide: bool) -> Self {
        let mut plan = ShadowPlan::default();
        if casters.is_empty() {
            return plan;
        }
        let count = table.lights.len().min(MAX_SHADOWS);
        plan.masks = vec![GpuShadows::zeroed(); count.div_ceil(4)];
        // Cull casters by light radius
        let lights = table.lights[..count].iter().zip(&table.ids);
        let reached: Vec<Vec<OrientedBox>> =
            lights.map(|(light, id)| with_bodies_in_view(light, *id, casters_in_radius(light, casters))).collect();
        // Fit a view at the centre of each emitter first, so that every light has a shadow before one is subdivided
        for (index, casters) in reached.iter().enumerate() {
            let slot = plan.add(&table.lights[index], (table.ids[index].0, 0), casters, receivers);
            plan.set(index, &[slot]);
        }
        // Replace the views of large emitters by views of their parts
        if subdivide {
            for (index, casters) in reached.iter().enumerate() {
                plan.subdivide(index, &table.lights[index], casters, receivers);
            }
        }
        plan.views = plan.view_count();
        plan.drop_unread();
        plan
    }

    /// Removes views that no slot reads: those at the centres of subdivided emitters.
    fn drop_unread(&mut self) {
        let slots = self.masks.iter().flat_map(|mask| mask.slots.as_flattened()).filter(|slot| slot.kind != 0);
        let mut is_read = vec![false; self.lights.len()];
        slots.for_each(|slot| is_read[slot.layer as usize] = true);
        let new_indices: Vec<usize> =
            is_read.iter().scan(0, |next, read| Some(std::mem::replace(next, *next + usize::from(*read)))).collect();
        self.set_layers(&new_indices);
        let mut read = is_read.into_iter();
        self.lights.retain(|_| read.next() == Some(true));
    }

    /// Returns true if an emitter is subdivided.
    pub fn is_subdivided(&self) -> bool {
        self.masks.iter().flat_map(|mask| mask.counts).any(|count| count > 1)
    }

    /// Replaces each slot's index into `lights` by `firsts` at that index.
    pub fn set_layers(&mut self, firsts: &[usize]) {
        for slot in self.masks.iter_mut().flat_map(|mask| mask.slots.as_flattened_mut()).filter(|slot| slot.kind != 0) {
            slot.layer = firsts[slot.layer as usize] as u32;
        }
    }

    fn view_count(&self) -> usize {
        self.lights.iter().map(|light| light.views.len()).sum()
    }

    /// Adds a light's views and returns its slot; the slot is empty if the light casts no shadow or the views are full.
    fn add(
        &mut self,
        light: &GpuLight,
        owner: ViewOwner,
        casters: &[OrientedBox],
        receivers: &VisibleReceivers,
    ) -> GpuShadowSlot {
        let (mut slot, views) = fit_views(light, casters, receivers, MAX_VIEWS - self.view_count());
        if !views.is_empty() {
            (slot.layer, slot.softness) = (self.lights.len() as u32, light.softness().into());
            let (eye, cull_radius_m) = (light.position.into(), light.cull_radius_m);
            let view = |clip_from_world| ShadowView { clip_from_world, eye, cull_radius_m, light: LightId(owner.0) };
            self.lights.push(LightViews { owner, views: views.into_iter().map(view).collect() });
        }
        slot
    }

    /// Stores the slots of a light.
    fn set(&mut self, light: usize, slots: &[GpuShadowSlot]) {
        let mask = &mut self.masks[light / 4];
        mask.counts[light % 4] = slots.len() as u32;
        mask.slots[light % 4][..slots.len()].copy_from_slice(slots);
    }

    /// Replaces the view of a light by views of its emitter's parts, if it has several and all fit.
    fn subdivide(&mut self, index: usize, light: &GpuLight, casters: &[OrientedBox], receivers: &VisibleReceivers) {
        let parts = emitter_parts(light, casters);
        let centre = self.masks[index / 4].slots[index % 4][0];
        if parts.len() == 1 || centre.kind == 0 {
            return;
        }
        let len_before = self.lights.len();
        let id = self.lights[centre.layer as usize].owner.0;
        let slots: Vec<GpuShadowSlot> = (1..)
            .zip(&parts)
            .map(|(number, part)| {
                let offset = part.at.x * Vec3::from(light.right) + part.at.y * Vec3::from(light.up);
                let moved = GpuLight { position: (Vec3::from(light.position) + offset).into(), ..*light };
                let slot =
                    if part.at == Vec2::ZERO { centre } else { self.add(&moved, (id, number), casters, receivers) };
                GpuShadowSlot { softness: part.softness.into(), ..slot }
            })
            .collect();
        if slots.iter().any(|slot| slot.kind != centre.kind) {
            self.lights.truncate(len_before);
            return;
        }
        self.set(index, &slots);
    }
}

/// Returns the casters within the light radius.
fn casters_in_radius(light: &GpuLight, casters: &[OrientedBox]) -> Vec<OrientedBox> {
    let reaches = |caster: &&OrientedBox| {
        light.cull_radius_m == 0.0 || caster.distance(light.position.into()) < light.cull_radius_m
    };
    casters.iter().filter(reaches).copied().collect()
}

/// Removes the bodies of lights for which a light's map would have to be larger: a map is fitted to the objects and to the
/// bodies in its view. Others cast a shadow only where they reach into it.
fn with_bodies_in_view(light: &GpuLight, id: LightId, casters: Vec<OrientedBox>) -> Vec<OrientedBox> {
    let objects: Vec<OrientedBox> = casters.iter().filter(|caster| caster.body_of.is_none()).copied().collect();
    let is_other = |caster: &&OrientedBox| caster.body_of.is_some_and(|owner| owner != id);
    let bodies: Vec<OrientedBox> = casters.iter().filter(is_other).copied().collect();
    let bodies = bodies.into_iter().filter(|body| is_in_one_view(light, &objects, body));
    objects.iter().copied().chain(bodies).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::preview::lights::light_table::LightKind;
    use crate::preview::shadows::slots::Projection;
    use glam::{Affine3A, Mat4};

    fn unit_box_at(centre: Vec3) -> OrientedBox {
        OrientedBox {
            world_from_object: Affine3A::from_translation(centre),
            low: Vec3::splat(-0.5),
            high: Vec3::splat(0.5),
            body_of: None,
        }
    }

    fn light(kind: LightKind) -> GpuLight {
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
    fn one_view_contains_every_caster_and_depth_falls_with_distance() {
        for kind in [LightKind::Point, LightKind::Spot, LightKind::Sphere, LightKind::Rect, LightKind::Sun] {
            let caster = unit_box_at(Vec3::new(0.3, 1.0, 0.2));
            let plan = ShadowPlan::new(&table(&[light(kind)]), &[caster], &VisibleReceivers::default(), false);
            assert_eq!((plan.views, plan.masks.len()), (1, 1), "{kind:?}");
            for corner in caster.corners() {
                let p = project(&plan.lights[0].views[0].clip_from_world, corner);
                assert!(p.truncate().abs().max_element() <= 1.0 && (0.0..=1.0).contains(&p.z), "{kind:?}: {p}");
                let farther = project(&plan.lights[0].views[0].clip_from_world, corner - Vec3::Y * 0.1);
                assert!(farther.z < p.z, "{kind:?}");
            }
        }
    }

    #[test]
    fn a_point_light_among_casters_gets_a_cube_map() {
        let point = light(LightKind::Point);
        let casters = [unit_box_at(Vec3::ZERO), unit_box_at(Vec3::Y * 8.0)];
        let plan = ShadowPlan::new(&table(&[point]), &casters, &VisibleReceivers::default(), false);
        assert_eq!((plan.views, plan.masks[0].slots[0][0].kind), (6, Projection::Cube as u32));
        let axes = [Vec3::X, Vec3::NEG_X, Vec3::Y, Vec3::NEG_Y, Vec3::NEG_Z, Vec3::Z];
        for (view, axis) in plan.lights[0].views.iter().zip(axes) {
            let p = project(&view.clip_from_world, Vec3::from(point.position) + axis * 2.0);
            assert!(p.truncate().length() < 1e-5 && p.z > 0.0, "{axis}: {p}");
        }
    }

    #[test]
    fn a_strip_beside_two_large_panels_among_casters_is_subdivided() {
        // With maps of six faces, of which one looks back through the panel, there were too few for the strip.
        let half_axes = |right_m: f32, up_m: f32| GpuLight {
            right: [right_m, 0.0, 0.0],
            up: [0.0, 0.0, -up_m],
            ..light(LightKind::Rect)
        };
        let casters = [unit_box_at(Vec3::Y * 2.5), unit_box_at(Vec3::Y * 8.0)];
        let panels = [
            half_axes(0.5, 0.5),
            half_axes(0.15, 0.6),
            GpuLight { kind: LightKind::Disc as u32, ..half_axes(0.3, 0.3) },
        ];
        let plan = ShadowPlan::new(&table(&panels), &casters, &VisibleReceivers::default(), true);
        let kinds = plan.masks[0].slots.map(|slots| slots[0].kind);
        assert_eq!((kinds[1], plan.masks[0].counts), (Projection::PanelCube as u32, [4, 3, 1, 0]));
    }

    #[test]
    fn depth_is_affine_across_a_plane() {
        // The shader's receiver plane depth requires that depth is linear along a line on the map
        let view = ShadowPlan::new(
            &table(&[light(LightKind::Rect)]),
            &[unit_box_at(Vec3::Y)],
            &VisibleReceivers::default(),
            false,
        )
        .lights[0]
            .views[0]
            .clip_from_world;
        let (a, b) = (project(&view, Vec3::new(-0.3, 0.2, 0.1)), project(&view, Vec3::new(0.4, 0.9, -0.2)));
        let on_line = project(&view, Vec3::new(-0.3, 0.2, 0.1).lerp(Vec3::new(0.4, 0.9, -0.2), 0.25));
        let along = (on_line.truncate() - a.truncate()).length() / (b.truncate() - a.truncate()).length();
        assert!((a.z + (b.z - a.z) * along - on_line.z).abs() < 1e-6);
    }

    #[test]
    fn lights_beyond_the_limit_have_no_shadow_and_no_caster_needs_no_map() {
        let plan = ShadowPlan::new(
            &table(&[light(LightKind::Rect); 40]),
            &[unit_box_at(Vec3::ZERO)],
            &VisibleReceivers::default(),
            false,
        );
        assert_eq!((plan.views, plan.masks.len()), (MAX_SHADOWS, MAX_SHADOWS / 4));
        let all_round = [unit_box_at(Vec3::ZERO), unit_box_at(Vec3::Y * 8.0)];
        let plan =
            ShadowPlan::new(&table(&[light(LightKind::Rect); 16]), &all_round, &VisibleReceivers::default(), false);
        // Nine cubes of five faces leave three views
        let kind = |light: usize| plan.masks[light / 4].slots[light % 4][0].kind;
        let kinds = [8, 9, 11, 12].map(kind);
        let [cube, single] = [Projection::PanelCube, Projection::Perspective].map(|kind| kind as u32);
        assert_eq!((plan.views, kinds), (MAX_VIEWS, [cube, single, single, 0]));
        assert_eq!(
            ShadowPlan::new(&table(&[light(LightKind::Rect)]), &[], &VisibleReceivers::default(), false),
            ShadowPlan::default()
        );
    }
}

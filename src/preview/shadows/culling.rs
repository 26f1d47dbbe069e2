//! Culling of shadow casters by shadow map views.

use super::layers::ShadowView;
use crate::preview::geometry::draw_item::ShadowCasting;
use crate::preview::geometry::draw_list::DrawList;
use glam::Vec4;
use std::hash::{DefaultHasher, Hash, Hasher};

/// Returns a hash of the meshes and transforms of the casters that a view may contain.
pub(crate) fn caster_signature(list: &DrawList, view: &ShadowView) -> u64 {
    let mut hasher = DefaultHasher::new();
    for item in
        list.items.iter().filter(|item| item.shadow != ShadowCasting::None && is_visible(list, item.caster, view))
    {
        (item.mesh, &item.indices, item.shadow as u32).hash(&mut hasher);
        list.casters[item.caster].world_from_object.to_cols_array().map(f32::to_bits).hash(&mut hasher);
    }
    hasher.finish()
}

/// Returns true if a caster's box may intersect the view's frustum and is closer than the light's radius, and is not that
/// of the light's own body.
pub(crate) fn is_visible(list: &DrawList, caster: usize, view: &ShadowView) -> bool {
    let Some(caster) = list.casters.get(caster) else { return false };
    if caster.body_of == Some(view.light) || !view.is_in_radius(caster.distance(view.eye)) {
        return false;
    }
    let corners = caster.corners().map(|corner| view.clip_from_world * corner.extend(1.0));
    let outside = |plane: fn(Vec4) -> bool| corners.iter().all(|corner| plane(*corner));
    !(outside(|c| c.x > c.w) || outside(|c| c.x < -c.w) || outside(|c| c.y > c.w) || outside(|c| c.y < -c.w))
}

//! How much room things take up.

use crate::editor::document::item::Item;
use crate::editor::document::selection::Selection;
use crate::editor::document::studio_document::Document;
use crate::scene::{Assets, Object, Shape};
use glam::Vec3;

/// The box around the selection, or around all figures, props and lights where nothing with a place is selected.
pub fn bounds(document: &Document, selection: &Selection) -> Option<(Vec3, Vec3)> {
    let scene = document.scene();
    let point = |p: Vec3| (p - Vec3::splat(0.4), p + Vec3::splat(0.4));
    let of_item = |item: &Item| match *item {
        Item::Object(id) => scene.object(id).and_then(|object| object_bounds(object, document.assets())),
        item => item.position(scene).map(point),
    };
    join(selection.items().iter().filter_map(of_item)).or_else(|| {
        let things = scene.objects.iter().filter(|o| !matches!(o.shape, Shape::Sweep { .. } | Shape::Plane { .. }));
        let things = things.filter_map(|object| object_bounds(object, document.assets()));
        join(things.chain(scene.lights.iter().filter(|l| !l.emitter.is_infinite()).map(|l| point(l.position))))
    })
}

/// The box around an object, along the room's axes; none while its mesh is not there.
pub fn object_bounds(object: &Object, assets: &Assets) -> Option<(Vec3, Vec3)> {
    let (low, high) = assets.mesh_of(&object.shape)?.bounds();
    let world = object.transform.world_from_object();
    let corners =
        (0..8).map(|i| Vec3::new([low.x, high.x][i & 1], [low.y, high.y][i >> 1 & 1], [low.z, high.z][i >> 2]));
    join(corners.map(|corner| world.transform_point3(corner)).map(|p| (p, p)))
}

fn join(boxes: impl Iterator<Item = (Vec3, Vec3)>) -> Option<(Vec3, Vec3)> {
    boxes.reduce(|(low, high), (l, h)| (low.min(l), high.max(h)))
}

//! World-space bounding boxes of objects and selections.

use crate::editor::document::item::Item;
use crate::editor::document::selection::Selection;
use crate::editor::document::studio_document::Document;
use glam::Vec3;

/// Returns the bounding box of the selection, or of all figures, props and lights if no selected item has a position.
pub fn bounds(document: &Document, selection: &Selection) -> Option<(Vec3, Vec3)> {
    let scene = document.scene();
    let point = |p: Vec3| (p - Vec3::splat(0.4), p + Vec3::splat(0.4));
    let of_item = |item: &Item| match *item {
        Item::Object(id) => scene.object(id).and_then(|object| document.assets().object_bounds(object)),
        item => item.position(scene).map(point),
    };
    join(selection.items().iter().filter_map(of_item)).or_else(|| {
        let things = scene.objects.iter().filter(|o| !o.shape.is_sheet());
        let things = things.filter_map(|object| document.assets().object_bounds(object));
        join(things.chain(scene.lights.iter().filter(|l| !l.emitter.is_infinite()).map(|l| point(l.position))))
    })
}

fn join(boxes: impl Iterator<Item = (Vec3, Vec3)>) -> Option<(Vec3, Vec3)> {
    boxes.reduce(|(low, high), (l, h)| (low.min(l), high.max(h)))
}

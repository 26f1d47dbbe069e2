//! The item that a click in the viewport selects.

use crate::editor::document::item::Item;
use crate::editor::viewport::overlays::markers::{light_at, meter_at};
use crate::preview::Pick;
use crate::scene::{CameraFrame, Scene};
use eframe::egui::{Pos2, Rect};

/// Returns the item that a click at `position` selects, given the id buffer's `picked`. Locked items are skipped.
pub fn item_at(scene: &Scene, frame: &CameraFrame, rect: Rect, position: Pos2, picked: Option<Pick>) -> Option<Item> {
    if meter_at(scene, frame, rect, position) {
        return Some(Item::Meter);
    }
    let item = match picked {
        Some(Pick::Light(id)) => Some(Item::Light(id)),
        Some(Pick::Camera) => Some(Item::Camera),
        Some(Pick::Object(id)) => Some(light_at(scene, frame, rect, position).unwrap_or(Item::Object(id))),
        None => light_at(scene, frame, rect, position),
    };
    item.filter(|item| !item.is_locked(scene))
}

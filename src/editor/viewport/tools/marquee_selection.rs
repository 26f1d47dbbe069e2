//! The marquee: a box drawn in the viewport that selects the items in it.

use crate::editor::document::item::Item;
use crate::editor::document::studio_document::Document;
use crate::editor::ui::theme;
use crate::editor::viewport::overlays::markers::place_of;
use crate::scene::CameraFrame;
use eframe::egui::{Color32, CornerRadius, Painter, PointerButton, Pos2, Rect, Response, Stroke, StrokeKind, Ui};

/// A selection box that is drawn with the left button.
#[derive(Clone, Copy, Debug)]
pub struct MarqueeSelection {
    from: Pos2,
    to: Pos2,
}

impl MarqueeSelection {
    /// Handles the mouse. Returns the items in the box when the drag ends. `taken` is true if a handle has the button.
    pub fn drag(
        marquee: &mut Option<MarqueeSelection>,
        ui: &Ui,
        response: &Response,
        taken: bool,
        frame: &CameraFrame,
        document: &Document,
    ) -> Option<Vec<Item>> {
        let (alt, origin, position) =
            ui.input(|i| (i.modifiers.alt, i.pointer.press_origin(), i.pointer.interact_pos()));
        if response.drag_started_by(PointerButton::Primary)
            && !taken
            && !alt
            && let Some(from) = origin
        {
            *marquee = Some(MarqueeSelection { from, to: from });
        }
        let drawn = marquee.as_mut()?;
        drawn.to = position.unwrap_or(drawn.to);
        if response.dragged_by(PointerButton::Primary) {
            return None;
        }
        let ended = Rect::from_two_pos(drawn.from, drawn.to);
        *marquee = None;
        Some(items_in(document, frame, response.rect, ended))
    }

    /// Draws the box.
    pub fn paint(&self, painter: &Painter) {
        let rect = Rect::from_two_pos(self.from, self.to);
        painter.rect_filled(rect, 0.0, theme::ACCENT.gamma_multiply(0.07));
        painter.rect_stroke(rect, CornerRadius::ZERO, Stroke::new(1.0, Color32::from_gray(220)), StrokeKind::Inside);
    }
}

/// Returns the visible, unlocked items whose middle lies in a box on the screen.
fn items_in(document: &Document, frame: &CameraFrame, view: Rect, marquee: Rect) -> Vec<Item> {
    let scene = document.scene();
    let objects = scene.objects.iter().filter(|o| o.visible).filter_map(|object| {
        let (low, high) = document.assets().object_bounds(object)?;
        Some((Item::Object(object.id), 0.5 * (low + high)))
    });
    let lights = scene.lights.iter().filter(|l| !l.emitter.is_infinite()).map(|l| (Item::Light(l.id), l.position));
    let inside = |point| place_of(frame, view, point).is_some_and(|place| marquee.contains(place));
    let held = objects.chain(lights).filter(|(item, middle)| inside(*middle) && !item.is_locked(scene));
    held.map(|(item, _)| item).collect()
}

//! The inspector of the room.

use super::material::material_group;
use super::{InspectorContext, title};
use crate::editor::commands::command::Command;
use crate::editor::document::action::Action;
use crate::editor::document::item::Item;
use crate::editor::ui::widgets::{NumberField, row};
use crate::scene::Room;
use eframe::egui::{RichText, Ui};

/// Draws the inspector of the room.
pub(super) fn room_ui(ui: &mut Ui, context: &mut InspectorContext<'_>) {
    let original = &context.document.scene().room;
    title(ui, "Room", "");
    let mut is_there = original.is_some();
    ui.checkbox(&mut is_there, "Floor, walls and ceiling")
        .on_hover_text("They bounce light around. Without them the studio is an endless black void.");
    if !is_there {
        ui.label(RichText::new("No room: nothing bounces light but the things in the studio.").weak());
        if original.is_some() {
            context.out.push(Command::Apply(Action::SetRoom(None)));
        }
        return;
    }
    let mut room = original.clone().unwrap_or_default();
    ui.add_space(4.0);
    const SIDE: NumberField = NumberField::new(0.02, 0.5, 200.0, 2, " m");
    let sides = [("Width", "Left to right", 0), ("Height", "Floor to ceiling", 1), ("Depth", "Back to front", 2)];
    for (label, tip, axis) in sides {
        row(ui, label, tip, |ui| SIDE.ui(ui, &mut room.size_m[axis]));
    }
    ui.add_space(4.0);
    let Room { floor, walls, ceiling, .. } = &mut room;
    for (label, part, material) in
        [("Floor", "floor", floor), ("Walls", "walls", walls), ("Ceiling", "ceiling", ceiling)]
    {
        if let Some(slot) = material_group(ui, label, material) {
            context.out.push(Command::ChooseTexture(Item::Room, Some(part.to_owned()), slot));
        }
    }
    if original.as_ref() != Some(&room) {
        context.out.push(Command::Apply(Action::SetRoom(Some(Box::new(room)))));
    }
}

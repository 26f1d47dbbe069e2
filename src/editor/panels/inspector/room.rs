//! The inspector of the room.

use super::material::material_group;
use super::{InspectorContext, title};
use crate::editor::commands::command::Command;
use crate::editor::document::action::Action;
use crate::editor::document::item::Item;
use crate::editor::ui::widgets::{NumberField, row};
use crate::scene::{Bodies, Room};
use eframe::egui::{ComboBox, RichText, Ui};

/// Draws the inspector of the room.
pub(super) fn room_ui(ui: &mut Ui, context: &mut InspectorContext<'_>) {
    let original = &context.document.scene().room;
    title(ui, "Room", "");
    bodies_row(ui, context);
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

/// Draws the row of the bodies of all lights.
fn bodies_row(ui: &mut Ui, context: &mut InspectorContext<'_>) {
    let mut bodies = context.document.scene().bodies;
    let tip = "Modifiers, heads and stands of all lights. They block the light of others and show in chrome; meter and \
               light of their own stay as they are. A light may differ.";
    row(ui, "Bodies", tip, |ui| {
        let list = ComboBox::from_id_salt("bodies").selected_text(bodies.label()).width(ui.available_width() - 8.0);
        list.show_ui(ui, |ui| {
            for each in Bodies::ALL {
                ui.selectable_value(&mut bodies, each, each.label());
            }
        });
    });
    if bodies != context.document.scene().bodies {
        context.out.push(Command::Apply(Action::SetBodies(bodies)));
    }
}

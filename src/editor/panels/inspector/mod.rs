//! The inspector: the properties of the selected item, in photographers' units.

mod aim;
mod camera;
mod environment;
mod fibre;
mod figure;
mod fluid;
mod gel;
mod head;
mod light;
mod material;
mod measured;
mod meter;
mod modifier;
mod object;
mod power;
mod room;
mod surface_layers;
mod tank;
mod unit_slider;

use crate::editor::commands::choices::Brush;
use crate::editor::commands::command::Command;
use crate::editor::document::action::Action;
use crate::editor::document::dials_together::turned_together;
use crate::editor::document::item::{Item, name_of_all};
use crate::editor::document::selection::Selection;
use crate::editor::document::studio_document::Document;
use crate::editor::document::tank_player::TankPlayer;
use crate::editor::ui::widgets::{row, small_button};
use crate::gear::GearList;
use crate::jobs::PatternJob;
use crate::scene::Light;
use eframe::egui::{self, RichText, ScrollArea, TextEdit, Ui};

/// What works on water tanks in the window.
#[derive(Clone, Copy, Debug)]
pub struct TankTools<'a> {
    /// Lets their water run.
    pub player: &'a TankPlayer,
    /// The brush, while it is in use.
    pub brush: Option<Brush>,
}

/// The input of a section of the inspector and its commands.
struct InspectorContext<'a> {
    document: &'a Document,
    patterns: &'a PatternJob,
    gear: &'a GearList,
    tank_tools: TankTools<'a>,
    out: &'a mut Vec<Command>,
}

/// Draws the inspector of the selection.
pub fn inspector_ui(
    ui: &mut Ui,
    document: &Document,
    selection: &Selection,
    patterns: &PatternJob,
    gear: &GearList,
    tank_tools: TankTools<'_>,
    out: &mut Vec<Command>,
) {
    ScrollArea::vertical().id_salt("inspector").auto_shrink([false, false]).show(ui, |ui| {
        ui.add_space(4.0);
        let mut context = InspectorContext { document, patterns, gear, tank_tools, out };
        if selection.len() > 1 {
            several_ui(ui, &mut context, selection);
        }
        // The state of fields belongs to the item, not to the position on the screen.
        ui.push_id(selection.last(), |ui| match selection.last() {
            Some(Item::Light(id)) => light::light_ui(ui, &mut context, id),
            Some(Item::Object(id)) => object::object_ui(ui, &mut context, id),
            Some(Item::Camera) => camera::camera_ui(ui, &mut context),
            Some(Item::Meter) => meter::meter_ui(ui, &mut context),
            Some(Item::Room) => room::room_ui(ui, &mut context),
            None => studio_ui(ui, &mut context),
        });
    });
}

/// Draws the head for several selected items: their number, and commands for all of them.
fn several_ui(ui: &mut Ui, context: &mut InspectorContext<'_>, selection: &Selection) {
    let scene = context.document.scene();
    title(ui, &format!("{} selected", name_of_all(selection.items(), scene)), "");
    ui.horizontal_wrapped(|ui| {
        let lights = !selection.lights().is_empty();
        let all = [
            (
                true,
                "Hide or mute",
                "Hides things and mutes lights; once more brings them back (H)",
                Command::HideSelected,
            ),
            (lights, "Solo", "Only these lights; once more brings back what was on before (O)", Command::SoloSelected),
            (true, "Lock", "In their places; once more: unlock (K)", Command::LockSelected),
            (true, "Duplicate", "Copies beside them (Ctrl+D)", Command::DuplicateSelected),
            (true, "Mirror", "To the other side of the subject's face (X)", Command::MirrorSelected { copies: false }),
            (true, "Delete", "Take them away (Delete)", Command::DeleteSelected),
        ];
        for (_, text, tip, command) in all.into_iter().filter(|(shown, ..)| *shown) {
            if ui.button(text).on_hover_text(tip).clicked() {
                context.out.push(command);
            }
        }
    });
    let lights: Vec<&Light> = selection.lights().iter().filter_map(|id| scene.light(*id)).collect();
    if lights.len() > 1 {
        several_lights_ui(ui, context.out, &lights);
    }
    let last = selection.last().map(|item| item.name(scene)).unwrap_or_default();
    ui.add_space(4.0);
    ui.label(RichText::new(format!("Below: {last} alone, which was chosen last.")).weak().small());
    ui.separator();
}

/// Draws the buttons that change the power of several lights and keep their ratios.
fn several_lights_ui(ui: &mut Ui, out: &mut Vec<Command>, lights: &[&Light]) {
    row(ui, "Dials", "All of them together: the ratios between the lights stay", |ui| {
        ui.spacing_mut().item_spacing.x = 2.0;
        let third = 1.0 / 3.0;
        for (text, name, stops) in [
            ("\u{2212}1", "All a stop less", -1.0),
            ("\u{2212}\u{2153}", "All a third of a stop less", -third),
            ("+\u{2153}", "All a third of a stop more", third),
            ("+1", "All a stop more", 1.0),
        ] {
            let turned = turned_together(lights, stops);
            let button = ui.add_enabled_ui(turned.is_some(), |ui| small_button(ui, text, name)).inner;
            let button = button.on_disabled_hover_text("One of the heads can't be set so far: the ratios would change");
            if let Some(turned) = turned.filter(|_| button.on_hover_text(name).clicked()) {
                let actions = turned.into_iter().map(|light| Action::SetLight(Box::new(light))).collect();
                out.push(Command::Apply(Action::Together { label: format!("Turn {} lights", lights.len()), actions }));
            }
        }
    });
}

/// Draws title and description of the studio, without a selection.
fn studio_ui(ui: &mut Ui, context: &mut InspectorContext<'_>) {
    let scene = context.document.scene();
    title(ui, "Studio", "");
    let mut notes = (scene.name.clone(), scene.description.clone());
    for (label, text, is_long) in [("Title", &mut notes.0, false), ("Description", &mut notes.1, true)] {
        ui.label(RichText::new(label).weak());
        let changed = ui.name_inputs(label, |ui| text_ui(ui, label, text, is_long));
        *text = changed.unwrap_or_else(|| text.clone());
    }
    let (name, description) = notes;
    if name != scene.name || description != scene.description {
        context.out.push(Command::Apply(Action::SetNotes { name, description }));
    }
    ui.add_space(8.0);
    let (lights, on) = (scene.lights.len(), scene.lights.iter().filter(|l| l.on).count());
    ui.label(RichText::new(format!("{lights} lights, {on} on. {} figures and things.", scene.objects.len())).weak());
    ui.add_space(8.0);
    ui.label(
        RichText::new("Click a light, a figure or the camera, in the view or in the list, to see and change it here.")
            .weak(),
    );
}

/// Draws the head of the inspector: name and kind of the item.
fn title(ui: &mut Ui, name: &str, kind: &str) {
    ui.horizontal(|ui| {
        ui.add(egui::Label::new(RichText::new(name).heading().strong()).truncate());
        if !kind.is_empty() && kind != name {
            ui.label(RichText::new(kind).weak());
        }
    });
    ui.separator();
}

/// Draws a text field; returns its text when it loses the focus, as one undo step.
fn text_ui(ui: &mut Ui, salt: &str, text: &str, is_long: bool) -> Option<String> {
    let id = ui.scope_id().with(salt);
    let mut edited = ui.data(|d| d.get_temp::<String>(id)).unwrap_or_else(|| text.to_owned());
    let field =
        if is_long { TextEdit::multiline(&mut edited).desired_rows(3) } else { TextEdit::singleline(&mut edited) };
    let field = ui.add(field.desired_width(f32::INFINITY));
    if field.has_focus() {
        ui.data_mut(|d| d.insert_temp(id, edited));
        return None;
    }
    ui.data_mut(|d| d.remove::<String>(id));
    (field.lost_focus() && edited != text).then_some(edited)
}

//! The inspector: everything about the selected thing, in photographers' units.

mod aim;
mod camera;
mod gel;
mod light;
mod material;
mod meter;
mod modifier;
mod object;
mod power;
mod room;

use crate::editor::action::{Action, Item};
use crate::editor::command::Command;
use crate::editor::document::Document;
use eframe::egui::{self, RichText, ScrollArea, TextEdit, Ui};

/// What a section of the inspector reads and where it puts its requests.
struct Context<'a> {
    document: &'a Document,
    out: &'a mut Vec<Command>,
}

/// Draws the inspector of the selection.
pub fn inspector_ui(ui: &mut Ui, document: &Document, selection: Option<Item>, out: &mut Vec<Command>) {
    ScrollArea::vertical().id_salt("inspector").auto_shrink([false, false]).show(ui, |ui| {
        ui.add_space(4.0);
        let mut context = Context { document, out };
        // Fields keep their state for the thing that they show, not for the place on the screen.
        ui.push_id(selection, |ui| match selection {
            Some(Item::Light(id)) => light::light_ui(ui, &mut context, id),
            Some(Item::Object(id)) => object::object_ui(ui, &mut context, id),
            Some(Item::Camera) => camera::camera_ui(ui, &mut context),
            Some(Item::Meter) => meter::meter_ui(ui, &mut context),
            Some(Item::Room) => room::room_ui(ui, &mut context),
            None => studio_ui(ui, &mut context),
        });
    });
}

/// Shown when nothing is selected: what the studio is about.
fn studio_ui(ui: &mut Ui, context: &mut Context<'_>) {
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
        context.out.push(Command::Do(Action::SetNotes { name, description }));
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

/// The head of the inspector: name of the thing and what it is.
fn title(ui: &mut Ui, name: &str, kind: &str) {
    ui.horizontal(|ui| {
        ui.add(egui::Label::new(RichText::new(name).heading().strong()).truncate());
        if !kind.is_empty() && kind != name {
            ui.label(RichText::new(kind).weak());
        }
    });
    ui.separator();
}

/// A field that gives its text when it is left, not at every key: one undo step.
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

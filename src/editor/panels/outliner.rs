//! The list of everything in the studio, with lamps, eyes, names and a context menu.

use crate::color::light_rgb;
use crate::editor::action::{Action, Item};
use crate::editor::command::Command;
use crate::editor::document::Document;
use crate::editor::{theme, widgets};
use crate::scene::{Light, Object};
use eframe::egui::{self, Button, Key, RichText, ScrollArea, Sense, TextEdit, Ui, vec2};

/// What the list remembers between frames.
#[derive(Clone, Debug, Default)]
pub struct OutlinerState {
    /// The thing being renamed, the text so far, and whether the field has had the keyboard yet.
    rename: Option<(Item, String, bool)>,
}

impl OutlinerState {
    /// Opens the name field of a thing.
    pub fn begin_rename(&mut self, item: Item, name: String) {
        self.rename = Some((item, name, false));
    }
}

/// Draws the list.
pub fn outliner_ui(
    ui: &mut Ui,
    document: &Document,
    selection: Option<Item>,
    state: &mut OutlinerState,
    out: &mut Vec<Command>,
) {
    ui.add_space(4.0);
    ui.label(RichText::new("In the studio").strong());
    ui.separator();
    ScrollArea::vertical().id_salt("outliner").auto_shrink([false, false]).show(ui, |ui| {
        ui.spacing_mut().item_spacing.y = 1.0;
        let scene = document.scene();
        fixed_row(ui, Item::Camera, "Camera", "Lens, exposure and framing", selection, out);
        let room_tip =
            if scene.room.is_some() { "Floor, walls and ceiling" } else { "Switched off: an endless black void" };
        fixed_row(ui, Item::Room, "Room", room_tip, selection, out);
        if scene.meter.is_some() {
            fixed_row(ui, Item::Meter, "Light meter", "Reads every light where it stands", selection, out);
        }
        heading(ui, "Lights", scene.lights.len());
        for light in &scene.lights {
            light_row(ui, document, light, selection, state, out);
        }
        heading(ui, "Figures and things", scene.objects.len());
        for object in &scene.objects {
            object_row(ui, object, selection, state, out);
        }
    });
}

fn heading(ui: &mut Ui, title: &str, count: usize) {
    ui.add_space(6.0);
    let text = if count == 0 { format!("{title}: none yet") } else { title.to_owned() };
    ui.label(RichText::new(text).weak().small());
}

fn fixed_row(ui: &mut Ui, item: Item, name: &str, tip: &str, selection: Option<Item>, out: &mut Vec<Command>) {
    ui.horizontal(|ui| {
        ui.add_space(16.0);
        if name_button(ui, name, selection == Some(item), false).on_hover_text(tip).clicked() {
            out.push(Command::Select(Some(item)));
        }
    });
}

fn light_row(
    ui: &mut Ui,
    document: &Document,
    light: &Light,
    selection: Option<Item>,
    state: &mut OutlinerState,
    out: &mut Vec<Command>,
) {
    let item = Item::Light(light.id);
    ui.horizontal(|ui| {
        ui.spacing_mut().item_spacing.x = 4.0;
        let chip = widgets::swatch(ui, theme::role_color(light.role), vec2(8.0, 16.0));
        chip.on_hover_text(format!("{} light", light.role.label()));
        row_name(ui, item, &light.name, light_tip(light), !light.on, selection, state, out);
        right(ui, |ui| {
            let seen = light.visible_to_camera;
            let name = format!("{} seen by the camera", light.name);
            let tip =
                if seen { "The camera sees the light itself" } else { "The camera does not see the light itself" };
            if widgets::eye_toggle(ui, seen, &name).on_hover_text(tip).clicked() {
                let changed = Light { visible_to_camera: !seen, ..light.clone() };
                out.push(Command::Do(Action::SetLight(Box::new(changed))));
            }
            let glow = widgets::display_color(light_rgb(&light.color, document.scene().camera.white_balance_k));
            let tip = if light.on { "On: click to switch off" } else { "Off: click to switch on" };
            if widgets::lamp_toggle(ui, light.on, glow, &format!("{} on", light.name)).on_hover_text(tip).clicked() {
                let changed = Light { on: !light.on, ..light.clone() };
                out.push(Command::Do(Action::SetLight(Box::new(changed))));
            }
        });
    });
}

fn light_tip(light: &Light) -> String {
    format!("{}, {} light", light.emitter.label(), light.role.label().to_lowercase())
}

fn object_row(
    ui: &mut Ui,
    object: &Object,
    selection: Option<Item>,
    state: &mut OutlinerState,
    out: &mut Vec<Command>,
) {
    let item = Item::Object(object.id);
    ui.horizontal(|ui| {
        ui.spacing_mut().item_spacing.x = 4.0;
        ui.add_space(12.0);
        row_name(ui, item, &object.name, object.shape.label().to_owned(), !object.visible, selection, state, out);
        right(ui, |ui| {
            let tip = if object.visible { "Visible: click to hide" } else { "Hidden: click to show" };
            let name = format!("{} visible", object.name);
            if widgets::eye_toggle(ui, object.visible, &name).on_hover_text(tip).clicked() {
                let changed = Object { visible: !object.visible, ..object.clone() };
                out.push(Command::Do(Action::SetObject(Box::new(changed))));
            }
        });
    });
}

fn right(ui: &mut Ui, add: impl FnOnce(&mut Ui)) {
    ui.with_layout(egui::Layout::right_to_left(egui::Align::Center), add);
}

fn name_button(ui: &mut Ui, name: &str, selected: bool, faded: bool) -> egui::Response {
    let text = if faded { RichText::new(name).weak() } else { RichText::new(name) };
    // Room on the right for a lamp and an eye.
    let width = (ui.available_width() - 56.0).max(40.0);
    let button = Button::selectable(selected, text).right_text("").truncate().min_size(vec2(width, 22.0));
    let response = ui.allocate_ui(vec2(width, 22.0), |ui| ui.add(button.sense(Sense::click()))).inner;
    widgets::named(ui, &response, name);
    response
}

/// The name of a thing: click selects, double click renames, the other button opens the menu.
#[expect(clippy::too_many_arguments, reason = "one row of the list needs all of them once")]
fn row_name(
    ui: &mut Ui,
    item: Item,
    name: &str,
    tip: String,
    faded: bool,
    selection: Option<Item>,
    state: &mut OutlinerState,
    out: &mut Vec<Command>,
) {
    if state.rename.as_ref().is_some_and(|(renamed, ..)| *renamed == item) {
        rename_ui(ui, state, out);
        return;
    }
    let response = name_button(ui, name, selection == Some(item), faded);
    if response.clicked() {
        out.push(Command::Select(Some(item)));
    }
    if response.double_clicked() {
        out.push(Command::BeginRename(item));
    }
    response.context_menu(|ui| item_menu_ui(ui, item, out));
    response.on_hover_text(format!("{tip}. Double-click to rename; right-click for more."));
}

fn rename_ui(ui: &mut Ui, state: &mut OutlinerState, out: &mut Vec<Command>) {
    let Some((item, text, had_focus)) = &mut state.rename else { return };
    let width = (ui.available_width() - 56.0).max(40.0);
    let field = ui.name_inputs("New name", |ui| ui.add(TextEdit::singleline(text).desired_width(width)));
    if !*had_focus {
        field.request_focus();
        *had_focus = true;
    }
    if field.lost_focus() {
        if !ui.input(|i| i.key_pressed(Key::Escape)) {
            out.push(Command::Do(Action::Rename(*item, text.clone())));
        }
        state.rename = None;
    }
}

/// The entries of a thing's context menu.
pub fn item_menu_ui(ui: &mut Ui, item: Item, out: &mut Vec<Command>) {
    if ui.button("Rename").clicked() {
        out.push(Command::BeginRename(item));
    }
    if ui.add(Button::new("Duplicate").shortcut_text("Ctrl+D")).clicked() {
        out.push(Command::Do(Action::Duplicate(item)));
    }
    if ui.add(Button::new("Bring into view").shortcut_text("F")).clicked() {
        out.push(Command::Select(Some(item)));
        out.push(Command::FrameSelection);
    }
    ui.separator();
    if ui.add(Button::new("Delete").shortcut_text("Delete")).clicked() {
        out.push(Command::Do(Action::Delete(item)));
    }
}

//! The list of the studio's items, with names, switches and context menus.

use crate::editor::commands::command::Command;
use crate::editor::commands::item_menu::item_menu_ui;
use crate::editor::document::action::Action;
use crate::editor::document::item::Item;
use crate::editor::document::selection::Selection;
use crate::editor::document::studio_document::Document;
use crate::editor::ui::name_field::{NameAnswer, NameField};
use crate::editor::ui::theme;
use crate::editor::ui::widgets;
use crate::photo::light_rgb;
use crate::scene::{Light, Object, Scene};
use eframe::egui::{self, Button, Response, RichText, ScrollArea, Sense, Ui, vec2};

/// The state of the list.
#[derive(Clone, Debug, Default)]
pub struct OutlinerState {
    /// The name field of the item that is being renamed.
    rename: Option<NameField<Item>>,
}

impl OutlinerState {
    /// Opens the name field of an item.
    pub fn begin_rename(&mut self, item: Item, name: String) {
        self.rename = Some(NameField::new(item, name));
    }
}

/// The input of the rows and their commands.
struct OutlinerRows<'a> {
    document: &'a Document,
    selection: &'a Selection,
    state: &'a mut OutlinerState,
    out: &'a mut Vec<Command>,
}

/// Draws the list.
pub fn outliner_ui(
    ui: &mut Ui,
    document: &Document,
    selection: &Selection,
    state: &mut OutlinerState,
    out: &mut Vec<Command>,
) {
    ui.add_space(4.0);
    ui.label(RichText::new("In the studio").strong());
    ui.separator();
    ScrollArea::vertical().id_salt("outliner").auto_shrink([false, false]).show(ui, |ui| {
        ui.spacing_mut().item_spacing.y = 1.0;
        let scene = document.scene();
        let mut rows = OutlinerRows { document, selection, state, out };
        rows.fixed(ui, Item::Camera, "Camera", "Lens, exposure and framing");
        let room_tip =
            if scene.room.is_some() { "Floor, walls and ceiling" } else { "Switched off: an endless black void" };
        rows.fixed(ui, Item::Room, "Room", room_tip);
        if scene.meter.is_some() {
            rows.fixed(ui, Item::Meter, "Light meter", "Reads every light where it stands");
        }
        rows.lights_heading(ui);
        for light in &scene.lights {
            rows.light(ui, light);
        }
        heading(ui, "Figures and things", scene.objects.len());
        for object in &scene.objects {
            rows.object(ui, object);
        }
    });
}

fn heading(ui: &mut Ui, title: &str, count: usize) {
    ui.add_space(6.0);
    let text = if count == 0 { format!("{title}: none yet") } else { title.to_owned() };
    ui.label(RichText::new(text).weak().small());
}

/// Returns the items of the rows from top to bottom.
fn listed(scene: &Scene) -> Vec<Item> {
    let fixed = [Item::Camera, Item::Room].into_iter().chain(scene.meter.map(|_| Item::Meter));
    let lights = scene.lights.iter().map(|l| Item::Light(l.id));
    fixed.chain(lights).chain(scene.objects.iter().map(|o| Item::Object(o.id))).collect()
}

/// Returns the items between two rows, `to` last.
fn between(scene: &Scene, from: Item, to: Item) -> Vec<Item> {
    let rows = listed(scene);
    let place = |item| rows.iter().position(|row| *row == item);
    match (place(from), place(to)) {
        (Some(a), Some(b)) if a <= b => rows[a..=b].to_vec(),
        (Some(a), Some(b)) => rows[b..=a].iter().rev().copied().collect(),
        _ => vec![to],
    }
}

impl OutlinerRows<'_> {
    fn fixed(&mut self, ui: &mut Ui, item: Item, name: &str, tip: &str) {
        ui.horizontal(|ui| {
            ui.add_space(16.0);
            let response = name_button(ui, name, self.selection.contains(item), false, 0.0).on_hover_text(tip);
            self.clicked(ui, &response, item);
        });
    }

    /// Handles a click: it selects; with Ctrl it toggles, with Shift it adds all rows from the last selected one.
    fn clicked(&mut self, ui: &Ui, response: &Response, item: Item) {
        if !response.clicked() {
            return;
        }
        let modifiers = ui.input(|i| i.modifiers);
        self.out.push(match self.selection.last() {
            Some(last) if modifiers.shift => Command::SelectAlso(between(self.document.scene(), last, item)),
            _ if modifiers.command => Command::ToggleSelected(item),
            _ => Command::Select(Some(item)),
        });
    }

    fn lights_heading(&mut self, ui: &mut Ui) {
        let scene = self.document.scene();
        let Some(solo) = &scene.solo else {
            heading(ui, "Lights", scene.lights.len());
            return;
        };
        ui.add_space(6.0);
        ui.horizontal(|ui| {
            let text = format!("Lights: {} of {} alone", solo.lights.len(), scene.lights.len());
            ui.label(RichText::new(text).color(theme::accent(ui)).small());
            let button = ui.small_button("End solo");
            if button.on_hover_text("Bring back what was on before (O)").clicked() {
                self.out.push(Command::Apply(Action::Solo(Vec::new())));
            }
        });
    }

    fn light(&mut self, ui: &mut Ui, light: &Light) {
        let item = Item::Light(light.id);
        let scene = self.document.scene();
        ui.horizontal(|ui| {
            ui.spacing_mut().item_spacing.x = 4.0;
            let chip = widgets::swatch(ui, theme::role_color(light.role), vec2(8.0, 16.0));
            chip.on_hover_text(format!("{} light", light.role.label()));
            self.name(ui, item, &light.name, light_tip(light), !light.on, 4.0);
            right(ui, |ui| {
                self.lock_toggle(ui, item, &light.name, light.locked);
                let alone = scene.solo.as_ref().is_some_and(|solo| solo.lights.contains(&light.id));
                let tip = if alone {
                    "Shines alone, in pictures too: click to bring back what was on before (O)"
                } else {
                    "Solo: switches the others off, in pictures too, until you click again (O)"
                };
                let name = format!("{} alone", light.name);
                if widgets::letter_toggle(ui, "S", alone, theme::ACCENT, &name).on_hover_text(tip).clicked() {
                    let lights = if alone { Vec::new() } else { vec![light.id] };
                    self.out.push(Command::Apply(Action::Solo(lights)));
                }
                let muted = light.muted && !light.on;
                let tip = if muted {
                    "Muted: click to bring it back as it was (H)"
                } else {
                    "Mute: dark for now, nothing about it is changed (H)"
                };
                let name = format!("{} muted", light.name);
                if widgets::letter_toggle(ui, "M", muted, theme::MUTED, &name).on_hover_text(tip).clicked() {
                    self.out.push(Command::Apply(Action::Mute(vec![light.id], !muted)));
                }
                let glow = widgets::display_color(light_rgb(&light.color, scene.camera.white_balance_k));
                let tip = match (light.on, muted, scene.is_silenced(light)) {
                    (true, ..) => "On: click to switch off",
                    (false, true, _) => "Muted: click to switch on",
                    (false, _, true) => "Silent while others shine alone: click to switch on",
                    (false, false, false) => "Off: click to switch on",
                };
                let lamp = widgets::lamp_toggle(ui, light.on, glow, &format!("{} on", light.name));
                if lamp.on_hover_text(tip).clicked() {
                    let changed = Light { on: !light.on, ..light.clone() };
                    self.out.push(Command::Apply(Action::SetLight(Box::new(changed))));
                }
            });
        });
    }

    fn object(&mut self, ui: &mut Ui, object: &Object) {
        let item = Item::Object(object.id);
        ui.horizontal(|ui| {
            ui.spacing_mut().item_spacing.x = 4.0;
            ui.add_space(12.0);
            self.name(ui, item, &object.name, object.shape.label().to_owned(), !object.visible, 2.0);
            right(ui, |ui| {
                self.lock_toggle(ui, item, &object.name, object.locked);
                let tip = if object.visible { "Visible: click to hide (H)" } else { "Hidden: click to show (H)" };
                let name = format!("{} visible", object.name);
                if widgets::eye_toggle(ui, object.visible, &name).on_hover_text(tip).clicked() {
                    let changed = Object { visible: !object.visible, ..object.clone() };
                    self.out.push(Command::Apply(Action::SetObject(Box::new(changed))));
                }
            });
        });
    }

    fn lock_toggle(&mut self, ui: &mut Ui, item: Item, name: &str, locked: bool) {
        let tip = if locked {
            "Locked: cannot be moved, and clicks in the view go past it. Click to unlock (K)"
        } else {
            "Lock it in its place (K)"
        };
        if widgets::lock_toggle(ui, locked, &format!("{name} locked")).on_hover_text(tip).clicked() {
            self.out.push(Command::Apply(Action::Lock(vec![item], !locked)));
        }
    }

    /// Draws the name of an item: click selects, double click renames, right click opens the menu.
    fn name(&mut self, ui: &mut Ui, item: Item, name: &str, tip: String, faded: bool, icons: f32) {
        if self.state.rename.as_ref().is_some_and(|field| field.target == item) {
            rename_ui(ui, self.state, icons, self.out);
            return;
        }
        let response = name_button(ui, name, self.selection.contains(item), faded, icons);
        self.clicked(ui, &response, item);
        if response.double_clicked() {
            self.out.push(Command::BeginRename(item));
        }
        let selection = self.selection;
        response.context_menu(|ui| item_menu_ui(ui, self.document.scene(), item, selection, self.out));
        response.on_hover_text(format!("{tip}. Double-click to rename; right-click for more."));
    }
}

fn light_tip(light: &Light) -> String {
    format!("{}, {} light", light.emitter.label(), light.role.label().to_lowercase())
}

fn right(ui: &mut Ui, add: impl FnOnce(&mut Ui)) {
    ui.with_layout(egui::Layout::right_to_left(egui::Align::Center), add);
}

/// Returns the width of a name next to this number of icons.
fn name_width(ui: &Ui, icons: f32) -> f32 {
    (ui.available_width() - 24.0 * icons - 6.0).max(40.0)
}

fn name_button(ui: &mut Ui, name: &str, selected: bool, faded: bool, icons: f32) -> Response {
    let text = if faded { RichText::new(name).weak() } else { RichText::new(name) };
    let width = name_width(ui, icons);
    let button = Button::selectable(selected, text).right_text("").truncate().min_size(vec2(width, 22.0));
    let response = ui.allocate_ui(vec2(width, 22.0), |ui| ui.add(button.sense(Sense::click()))).inner;
    widgets::named(ui, &response, name);
    response
}

/// Draws the name field in the place of an item.
fn rename_ui(ui: &mut Ui, state: &mut OutlinerState, icons: f32, out: &mut Vec<Command>) {
    let Some(field) = &mut state.rename else { return };
    let Some(answer) = field.ui(ui, "New name", name_width(ui, icons)) else { return };
    if let NameAnswer::Named(name) = answer {
        out.push(Command::Apply(Action::Rename(field.target, name)));
    }
    state.rename = None;
}

//! The list of shipped studios.

use crate::editor::commands::command::Command;
use crate::editor::document::files::PresetInfo;
use crate::editor::panels::thumbnails::{STUDIO_POINTS, Thumbnail, Thumbnails};
use crate::editor::ui::search::{is_match, search_ui};
use crate::editor::ui::widgets;
use crate::io::PresetGroup;
use eframe::egui::{self, Atom, Button, Key, Modifiers, RichText, ScrollArea, Ui, vec2};

/// Height of the list, points. It is the same from the first frame on, so that the buttons below it do not move.
const LIST_POINTS: f32 = 520.0;

/// The list of studios: which one is marked, and what is searched for.
#[derive(Clone, Debug, Default)]
pub struct PresetPicker {
    /// None while the list is closed.
    marked: Option<usize>,
    query: String,
}

impl PresetPicker {
    /// Opens the list.
    pub fn open(&mut self) {
        *self = PresetPicker { marked: Some(0), query: String::new() };
    }

    /// Returns true while the list is open.
    pub fn is_open(&self) -> bool {
        self.marked.is_some()
    }

    /// Draws the list.
    pub fn ui(
        &mut self,
        ctx: &egui::Context,
        presets: &[PresetInfo],
        thumbnails: &mut Thumbnails,
        out: &mut Vec<Command>,
    ) {
        let Some(marked) = self.marked else { return };
        // Take the arrow keys and Enter, for the list as it was drawn last
        let before = found(presets, &self.query);
        let mut marked = moved_by_key(ctx, &before, marked);
        let by_key = Some(marked) != self.marked;
        let mut choice = ctx
            .input_mut(|i| i.consume_key(Modifiers::NONE, Key::Enter))
            .then_some(marked)
            .filter(|_| !before.is_empty());
        let modal = widgets::dialog(ctx, "presets").show(ctx, |ui| {
            ui.set_width(560.0);
            ui.heading("New from preset");
            ui.label(
                RichText::new("Each is a lit studio to start from. Your own file comes into being when you save.")
                    .weak(),
            );
            // Draw the search field, which has the focus unless something else has it
            let field = search_ui(ui, "Search studios", &mut self.query);
            if ui.memory(|memory| memory.focused().is_none()) {
                field.request_focus();
            }
            ui.separator();
            // Draw the list, by group; a search that hides the marked studio marks the first
            let shown = found(presets, &self.query);
            if !shown.contains(&marked) {
                marked = shown.first().copied().unwrap_or(0);
            }
            ScrollArea::vertical().max_height(LIST_POINTS).min_scrolled_height(LIST_POINTS).show(ui, |ui| {
                ui.set_min_height(LIST_POINTS);
                if shown.is_empty() {
                    ui.label(RichText::new("No studio has these words.").weak());
                }
                let mut group = None;
                for &i in &shown {
                    let preset = &presets[i];
                    if group.replace(preset.group) != Some(preset.group) {
                        ui.add_space(4.0);
                        ui.label(RichText::new(preset.group.label()).strong());
                    }
                    let response = preset_row(ui, preset, thumbnails.studio(ctx, i), i == marked);
                    if response.clicked() {
                        marked = i;
                    }
                    if by_key && i == marked {
                        response.scroll_to_me(None);
                    }
                    if response.double_clicked() {
                        choice = Some(i);
                    }
                }
            });
            // Draw the buttons
            ui.separator();
            ui.horizontal(|ui| {
                if ui.add_enabled(!shown.is_empty(), Button::new("Open this studio")).clicked() {
                    choice = Some(marked);
                }
                let tip = "A room without lights and figures";
                if ui.button("Empty studio").on_hover_text(tip).clicked() {
                    out.push(Command::NewEmpty);
                    ui.close();
                }
                if ui.button("Cancel").clicked() {
                    ui.close();
                }
            });
        });
        // Close the list after a choice, and open the chosen studio
        let closes = choice.is_some() || modal.should_close();
        self.marked = (!closes).then_some(marked);
        if let Some(index) = choice {
            out.push(Command::NewFromPreset(index));
        }
    }
}

/// Returns the studios that have the words of a query, by group.
fn found(presets: &[PresetInfo], query: &str) -> Vec<usize> {
    let is_found = |preset: &PresetInfo| is_match(query, &[preset.group.label(), &preset.name, &preset.description]);
    let in_group =
        |group: PresetGroup| (0..presets.len()).filter(move |i| presets[*i].group == group && is_found(&presets[*i]));
    PresetGroup::ALL.into_iter().flat_map(in_group).collect()
}

/// Returns the studio that the arrow keys lead to from the marked one.
fn moved_by_key(ctx: &egui::Context, shown: &[usize], marked: usize) -> usize {
    let Some(place) = shown.iter().position(|i| *i == marked) else { return marked };
    let pressed = |key| ctx.input_mut(|i| i.consume_key(Modifiers::NONE, key));
    let down = if pressed(Key::ArrowDown) { place + 1 } else { place };
    let place = if pressed(Key::ArrowUp) { down.saturating_sub(1) } else { down };
    shown.get(place).copied().unwrap_or(marked)
}

/// Draws a row with thumbnail, name and description of a studio.
fn preset_row(ui: &mut Ui, preset: &PresetInfo, picture: Option<Thumbnail>, marked: bool) -> egui::Response {
    let (name, line) = (egui::TextStyle::Button.resolve(ui.style()), egui::TextStyle::Small.resolve(ui.style()));
    let visuals = ui.visuals();
    let name_color = if marked { visuals.selection.stroke.color } else { visuals.strong_text_color() };
    let mut text = egui::text::LayoutJob::default();
    text.append(&preset.name, 0.0, egui::TextFormat::simple(name, name_color));
    text.append("\n", 0.0, egui::TextFormat::default());
    text.append(&preset.description, 0.0, egui::TextFormat::simple(line, visuals.weak_text_color()));
    text.wrap.max_width = ui.available_width() - STUDIO_POINTS - 40.0;
    // Thumbnails are centred in squares of one size, so that the names are aligned.
    let picture = Atom::paint(egui::Vec2::splat(STUDIO_POINTS), move |ui, place| {
        picture.iter().for_each(|picture| picture.paint(ui, place.rect));
    });
    let size = vec2(ui.available_width(), STUDIO_POINTS + 8.0);
    let response = ui.add(Button::selectable(marked, (picture, text)).min_size(size));
    widgets::named(ui, &response, &preset.name);
    response
}

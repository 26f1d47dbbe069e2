//! The list of shipped studios.

use crate::editor::commands::command::Command;
use crate::editor::document::files::PresetInfo;
use crate::editor::panels::thumbnails::{STUDIO_POINTS, Thumbnail, Thumbnails};
use crate::editor::ui::widgets;
use eframe::egui::{self, Atom, Button, Key, Modifiers, RichText, ScrollArea, Ui, vec2};

/// Height of the list, points. It is the same from the first frame on, so that the buttons below it do not move.
const LIST_POINTS: f32 = 520.0;

/// The marked studio of the list; none while the list is closed.
#[derive(Clone, Copy, Debug, Default)]
pub struct PresetPicker {
    marked: Option<usize>,
}

impl PresetPicker {
    /// Opens the list.
    pub fn open(&mut self) {
        self.marked = Some(0);
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
        let Some(mut marked) = self.marked else { return };
        let before = marked;
        let mut choice = None;
        let pressed = |key| ctx.input_mut(|i| i.consume_key(Modifiers::NONE, key));
        if pressed(Key::ArrowDown) {
            marked = (marked + 1).min(presets.len().saturating_sub(1));
        }
        if pressed(Key::ArrowUp) {
            marked = marked.saturating_sub(1);
        }
        if pressed(Key::Enter) {
            choice = Some(marked);
        }
        let by_key = marked != before;
        let modal = widgets::dialog(ctx, "presets").show(ctx, |ui| {
            ui.set_width(560.0);
            ui.heading("New from preset");
            ui.label(
                RichText::new("Each is a lit studio to start from. Your own file comes into being when you save.")
                    .weak(),
            );
            ui.separator();
            ScrollArea::vertical().max_height(LIST_POINTS).min_scrolled_height(LIST_POINTS).show(ui, |ui| {
                for (i, preset) in presets.iter().enumerate() {
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
            ui.separator();
            ui.horizontal(|ui| {
                let enabled = marked < presets.len();
                if ui.add_enabled(enabled, Button::new("Open this studio")).clicked() {
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
        let closes = choice.is_some() || modal.should_close();
        self.marked = (!closes).then_some(marked);
        if let Some(index) = choice {
            out.push(Command::NewFromPreset(index));
        }
    }
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

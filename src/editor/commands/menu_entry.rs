//! An entry of a menu.

use crate::editor::commands::command::Command;
use eframe::egui::{Button, Ui};

/// Draws a menu entry with the shortcut of its command.
pub fn entry(ui: &mut Ui, enabled: bool, text: &str, tip: &str, command: Command, out: &mut Vec<Command>) {
    let shortcut = command.shortcut().map(|s| ui.ctx().format_shortcut(&s)).unwrap_or_default();
    let button = Button::new(text).shortcut_text(shortcut);
    if ui.add_enabled(enabled, button).on_hover_text(tip).clicked() {
        out.push(command);
    }
}

//! The prompt about a studio's file that another program has changed.

use crate::editor::ui::widgets;
use eframe::egui::{self, Button};

/// The answer to the prompt.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum FileChangeAnswer {
    /// Keep the studio of the window; a save overwrites the file.
    KeepMine,
    /// Open the file as it is now.
    TakeTheirs,
    /// Save the studio of the window to another file.
    SaveAs,
    /// Decide later.
    Cancel,
}

/// Draws the prompt.
pub fn file_change_ui(ctx: &egui::Context, title: &str, has_changes: bool) -> Option<FileChangeAnswer> {
    let mut answer = None;
    let modal = widgets::dialog(ctx, "file change").show(ctx, |ui| {
        ui.set_width(520.0);
        ui.heading("The file has changed");
        ui.label(format!("Another program or window has written \"{title}\" since you opened or saved it here."));
        if has_changes {
            ui.label("You have changes of your own in this window that are not saved.");
        }
        ui.add_space(8.0);
        ui.horizontal(|ui| {
            let lost = if has_changes {
                "Open the file as it is now; your changes are lost"
            } else {
                "Open the file as it is now"
            };
            let choices = [
                ("Keep mine", FileChangeAnswer::KeepMine, "Go on with this studio; saving overwrites the other change"),
                ("Take theirs", FileChangeAnswer::TakeTheirs, lost),
                ("Save as\u{2026}", FileChangeAnswer::SaveAs, "Save this studio to another file and keep both"),
                ("Cancel", FileChangeAnswer::Cancel, "Decide before the next save (Esc)"),
            ];
            for (text, each, tip) in choices {
                if ui.add(Button::new(text).min_size(egui::vec2(96.0, 26.0))).on_hover_text(tip).clicked() {
                    answer = Some(each);
                }
            }
        });
    });
    if answer.is_none() && modal.should_close() {
        answer = Some(FileChangeAnswer::Cancel);
    }
    answer
}

//! The prompt about a studio's file that another program has changed.

use crate::editor::ui::widgets::{self, Question};
use eframe::egui;

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
    let lost =
        if has_changes { "Open the file as it is now; your changes are lost" } else { "Open the file as it is now" };
    let question = Question {
        name: "file change",
        width: 520.0,
        heading: "The file has changed",
        answers: &[
            ("Keep mine", FileChangeAnswer::KeepMine, "Go on with this studio; saving overwrites the other change"),
            ("Take theirs", FileChangeAnswer::TakeTheirs, lost),
            ("Save as\u{2026}", FileChangeAnswer::SaveAs, "Save this studio to another file and keep both"),
            ("Cancel", FileChangeAnswer::Cancel, "Decide before the next save (Esc)"),
        ],
        on_enter: None,
    };
    widgets::question_dialog(ctx, &question, |ui| {
        ui.label(format!("Another program or window has written \"{title}\" since you opened or saved it here."));
        if has_changes {
            ui.label("You have changes of your own in this window that are not saved.");
        }
    })
}

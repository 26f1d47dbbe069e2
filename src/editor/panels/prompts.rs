//! Modal prompts: what would be lost or replaced, panoramas, and a path on desktops without file dialogs.

use crate::editor::commands::file_purpose::FilePurpose;
use crate::editor::ui::widgets::{self, Question};
use eframe::egui::{self, Button, Key, RichText, TextEdit};
use std::path::{Path, PathBuf};

/// The answer to the prompt for unsaved changes.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum UnsavedAnswer {
    /// Save, then continue.
    Save,
    /// Continue without saving.
    Discard,
    /// Cancel the operation.
    Cancel,
}

/// Draws the prompt to save before `what`.
pub fn unsaved_changes_ui(ctx: &egui::Context, title: &str, what: &str) -> Option<UnsavedAnswer> {
    let question = Question {
        name: "unsaved changes",
        width: 420.0,
        heading: "Unsaved changes",
        answers: &[
            ("Save", UnsavedAnswer::Save, "Write the studio to its file first (Enter)"),
            ("Don't save", UnsavedAnswer::Discard, "The changes are lost"),
            ("Cancel", UnsavedAnswer::Cancel, "Stay here (Esc)"),
        ],
        on_enter: Some(UnsavedAnswer::Save),
    };
    widgets::question_dialog(ctx, &question, |ui| {
        ui.label(format!("\"{title}\" has changes that are not saved. Save them before {what}?"));
    })
}

/// The answer to the prompt about a picture that is not exported.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum PictureAnswer {
    /// Export it, and stay.
    Export,
    /// Continue without it.
    Discard,
    /// Cancel the operation.
    Cancel,
}

/// Draws the prompt to export a rendered picture before `what`.
pub fn unexported_picture_ui(ctx: &egui::Context, what: &str) -> Option<PictureAnswer> {
    let question = Question {
        name: "unexported picture",
        width: 420.0,
        heading: "The picture is not exported",
        answers: &[
            ("Export\u{2026}", PictureAnswer::Export, "Choose a file for the picture, and stay here (Enter)"),
            ("Don't export", PictureAnswer::Discard, "The picture is lost"),
            ("Cancel", PictureAnswer::Cancel, "Stay here (Esc)"),
        ],
        on_enter: Some(PictureAnswer::Export),
    };
    widgets::question_dialog(ctx, &question, |ui| {
        ui.label(format!("The rendered picture is in no file. Export it before {what}?"));
    })
}

/// The answer to the prompt about a panorama.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum PanoramaAnswer {
    /// Light the studio with it.
    LightTheStudio,
    /// Leave it out.
    Cancel,
}

/// Draws the prompt about a picture without a studio that is twice as wide as high.
pub fn panorama_ui(ctx: &egui::Context, path: &Path) -> Option<PanoramaAnswer> {
    let question = Question {
        name: "panorama",
        width: 460.0,
        heading: "Light the studio by a panorama?",
        answers: &[
            ("As environment", PanoramaAnswer::LightTheStudio, "The surround shines as this picture (Enter)"),
            ("Cancel", PanoramaAnswer::Cancel, "Leave it out (Esc)"),
        ],
        on_enter: Some(PanoramaAnswer::LightTheStudio),
    };
    let name = path.file_name().unwrap_or_default().to_string_lossy().into_owned();
    widgets::question_dialog(ctx, &question, |ui| {
        ui.label(format!("{name} holds no studio, and it is twice as wide as high, as panoramas are."));
    })
}

/// The answer to the prompt about a file that is there already.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum ReplaceAnswer {
    /// Replace it.
    Replace,
    /// Keep it.
    Cancel,
}

/// Draws the prompt about a file that would be replaced.
pub fn replace_ui(ctx: &egui::Context, path: &Path) -> Option<ReplaceAnswer> {
    let question = Question {
        name: "replace file",
        width: 460.0,
        heading: "Replace the file?",
        answers: &[
            ("Replace", ReplaceAnswer::Replace, "What the file holds now is lost"),
            ("Cancel", ReplaceAnswer::Cancel, "Keep the file (Esc)"),
        ],
        on_enter: None,
    };
    widgets::question_dialog(ctx, &question, |ui| {
        ui.label(format!("{} is there already.", path.display()));
    })
}

/// A prompt for a path.
#[derive(Clone, Debug)]
pub struct PathPrompt {
    /// The purpose of the path.
    pub purpose: FilePurpose,
    text: String,
    had_focus: bool,
}

/// The answer to a path prompt.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum PathAnswer {
    /// This path.
    Chosen(PathBuf),
    /// Cancelled.
    Cancelled,
}

impl PathPrompt {
    /// Returns a prompt that suggests a file in a folder.
    pub fn new(purpose: FilePurpose, folder: Option<&Path>, file_name: &str) -> Self {
        let folder = folder.map(Path::to_owned).or_else(|| std::env::current_dir().ok()).unwrap_or_default();
        let path = if purpose.is_save() { folder.join(file_name) } else { folder.join("") };
        PathPrompt { purpose, text: path.to_string_lossy().into_owned(), had_focus: false }
    }

    /// Draws the prompt.
    pub fn ui(&mut self, ctx: &egui::Context) -> Option<PathAnswer> {
        let mut answer = None;
        let modal = widgets::dialog(ctx, "path prompt").show(ctx, |ui| {
            ui.set_width(560.0);
            ui.heading(self.purpose.title());
            ui.label(RichText::new("This desktop offers no file dialog, so please type the path.").weak());
            let field =
                ui.name_inputs("Path", |ui| ui.add(TextEdit::singleline(&mut self.text).desired_width(f32::INFINITY)));
            if !self.had_focus {
                field.request_focus();
                self.had_focus = true;
            }
            let entered = field.lost_focus() && ui.input(|i| i.key_pressed(Key::Enter));
            ui.add_space(6.0);
            ui.horizontal(|ui| {
                let text = self.text.trim();
                let word = if self.purpose.is_save() { "Save here" } else { "Open" };
                let pressed = ui.add_enabled(!text.is_empty(), Button::new(word)).clicked();
                if (pressed || entered) && !text.is_empty() {
                    answer = Some(PathAnswer::Chosen(PathBuf::from(text)));
                }
                if ui.button("Cancel").clicked() {
                    answer = Some(PathAnswer::Cancelled);
                }
            });
        });
        if answer.is_none() && modal.should_close() {
            answer = Some(PathAnswer::Cancelled);
        }
        answer
    }
}

//! The prompt about a model that comes in: its size where that is in doubt, its lamps and its camera.

use crate::editor::document::files::ImportedModel;
use crate::editor::document::model_import::{self, ModelChoice};
use crate::editor::ui::widgets::{self, Question};
use crate::io::MODEL_UNITS;
use eframe::egui::{self, Ui};

/// A model about which the user is asked.
#[derive(Clone, Debug)]
pub struct PendingModel {
    /// The model.
    pub model: Box<ImportedModel>,
    /// What is chosen so far.
    pub choice: ModelChoice,
}

/// The answer to the prompt.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum ImportAnswer {
    /// Bring the model in as it is chosen.
    BringIn,
    /// Leave it out.
    Cancel,
}

/// Draws the prompt.
pub fn import_ui(ctx: &egui::Context, PendingModel { model, choice }: &mut PendingModel) -> Option<ImportAnswer> {
    let question = Question {
        name: "model import",
        width: 460.0,
        heading: "Bring in a model",
        answers: &[
            ("Bring in", ImportAnswer::BringIn, "Add it to the studio, in one step that can be undone (Enter)"),
            ("Cancel", ImportAnswer::Cancel, "Leave it out (Esc)"),
        ],
        on_enter: Some(ImportAnswer::BringIn),
    };
    widgets::question_dialog(ctx, &question, |ui| {
        let name = model.file.file_name().unwrap_or_default().to_string_lossy();
        if model_import::is_size_asked(model) {
            size_ui(ui, &name, model, &mut choice.metres);
        } else {
            ui.label(format!("{name} has more than a model:"));
        }
        let lamps = model.set_up.lights.len();
        if lamps > 0 {
            let text = if lamps == 1 { "Its lamp".to_owned() } else { format!("Its {lamps} lamps") };
            ui.checkbox(&mut choice.lamps, text).on_hover_text("With the candela and lux of the file");
        }
        if model.set_up.camera.is_some() {
            let tip = "Moves the studio's camera, with the angle of view of the file";
            ui.checkbox(&mut choice.camera, "Look through its camera").on_hover_text(tip);
        }
    })
}

/// Draws the heights that a model has by the unit of its file.
fn size_ui(ui: &mut Ui, name: &str, model: &ImportedModel, metres: &mut f32) {
    let (low, high) = model.mesh.bounds();
    let size = (high - low).max_element();
    let stated = if model.states_metres { "Its format states metres. " } else { "" };
    ui.label(format!("{name} is {} units long at most. {stated}How large is it?", length_text(size)));
    for (unit, length) in MODEL_UNITS {
        ui.radio_value(metres, length, format!("{} m long: its unit is {unit}", length_text(size * length)));
    }
}

/// Returns a length with three digits.
fn length_text(length: f32) -> String {
    match length {
        0.0..1.0 if length < 1e-3 => format!("{length:.1e}"),
        0.0..1.0 => format!("{length:.3}"),
        1.0..100.0 => format!("{length:.1}"),
        _ if length < 1e6 => format!("{length:.0}"),
        _ => format!("{length:.1e}"),
    }
}

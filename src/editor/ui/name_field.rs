//! A text field in the place of a name, to rename a thing in a list.

use eframe::egui::{Key, TextEdit, Ui};

/// The name of a thing while it is typed.
#[derive(Clone, Debug)]
pub struct NameField<T> {
    /// The thing.
    pub target: T,
    text: String,
    had_focus: bool,
}

/// The end of a [`NameField`].
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum NameAnswer {
    /// This name.
    Named(String),
    /// The name stays (Esc).
    Cancelled,
}

impl<T> NameField<T> {
    /// Returns a field with the present name.
    pub fn new(target: T, name: String) -> Self {
        NameField { target, text: name, had_focus: false }
    }

    /// Draws the field, named `label` for screen readers and tests. Returns the answer once the field has lost the focus.
    pub fn ui(&mut self, ui: &mut Ui, label: &str, width: f32) -> Option<NameAnswer> {
        let field = ui.name_inputs(label, |ui| ui.add(TextEdit::singleline(&mut self.text).desired_width(width)));
        if !self.had_focus {
            field.request_focus();
            self.had_focus = true;
        }
        field.lost_focus().then(|| match ui.input(|i| i.key_pressed(Key::Escape)) {
            true => NameAnswer::Cancelled,
            false => NameAnswer::Named(self.text.clone()),
        })
    }
}

//! The list of keys and what the mouse does.

use eframe::egui::{self, Grid, RichText};

const KEYS: [(&str, &str); 22] = [
    ("Left click", "Select what is under the pointer"),
    ("Left drag on a handle", "Move, turn or size the selected thing; with Ctrl in steps"),
    ("Middle drag, Alt + left drag", "Orbit"),
    ("Shift + middle drag, Shift + Alt + left drag", "Pan"),
    ("Wheel, Ctrl + middle drag", "Closer and farther"),
    ("Right drag", "Look around"),
    ("W A S D, arrows", "Fly ahead, left, back, right (Shift: faster)"),
    ("Q E", "Fly down and up"),
    ("F", "Bring the selection into view"),
    ("1", "Camera view on or off"),
    ("3", "The rendered picture"),
    ("M  T  Z", "Handles: move, turn, size"),
    ("R", "Render"),
    ("Delete", "Delete the selected thing"),
    ("Ctrl+D", "Duplicate it"),
    ("Ctrl+Z, Ctrl+Shift+Z", "Undo, redo"),
    ("Ctrl+N, Ctrl+O", "New from preset, open"),
    ("Ctrl+S, Ctrl+Shift+S", "Save, save as"),
    ("Ctrl+I, Ctrl+E", "Import OBJ, export picture"),
    ("Esc", "Close a dialog"),
    ("Drag a number", "Change it; Shift: finely. Click: type it"),
    ("Drop a file", "A studio (.ron) opens, a model (.obj) comes in"),
];

/// Draws the window; `open` is cleared when it is closed.
pub fn help_ui(ctx: &egui::Context, open: &mut bool) {
    egui::Window::new("Keys and mouse")
        .open(open)
        .resizable(false)
        .collapsible(false)
        .default_width(480.0)
        .pivot(egui::Align2::CENTER_CENTER)
        .default_pos(ctx.content_rect().center())
        .show(ctx, |ui| {
            Grid::new("keys").num_columns(2).spacing([24.0, 5.0]).show(ui, |ui| {
                for (keys, meaning) in KEYS {
                    ui.label(RichText::new(keys).strong());
                    ui.label(meaning);
                    ui.end_row();
                }
            });
        });
}

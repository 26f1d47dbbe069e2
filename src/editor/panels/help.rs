//! The list of keys and mouse actions.

use crate::editor::commands::shortcuts::{KEY_BINDINGS, KeyBinding};
use crate::io;
use eframe::egui::{self, Grid, RichText, ScrollArea, Ui, vec2};

/// The action whose files [`mouse`] lists.
const DROP: &str = "Drop a file";
/// Mouse actions and held keys.
const MOUSE: [(&str, &str); 19] = [
    ("Left click", "Select what is under the pointer"),
    ("Shift or Ctrl + click", "Take it in or out; in the list Shift takes all from the last to here"),
    ("Left drag", "Select what lies in a box; with Shift or Ctrl: too"),
    ("Left drag on a handle", "Move, turn or size what is selected"),
    ("\u{2026} then 1.5 and Enter", "By exactly that: metres, degrees, times"),
    ("\u{2026} then Esc", "Give the drag up"),
    ("Right click", "All that can be done to a thing, in the view and in the list"),
    ("Middle drag, Alt + left drag", "Orbit about the selection; through a light: swing it"),
    ("Shift + middle drag", "Pan (also Shift + Alt + left drag)"),
    ("Wheel, Ctrl + middle drag", "Closer and farther; through a light: move it so"),
    ("Right drag", "Look around"),
    ("W A S D, arrows", "Fly ahead, left, back, right (Shift: faster)"),
    ("Q E", "Fly down and up"),
    ("Click an end of the axes", "Look from there, without perspective"),
    ("Drag a number", "Change it; Shift: finely"),
    ("Click a number", "Type it, with any unit: 150 cm, 1.5 m, 5 ft"),
    (DROP, "A studio (.ron) or a rendered picture (.exr) opens"),
    ("Esc in a dialog", "Close it"),
    ("Ctrl + plus, minus, 0", "Larger, smaller or usual texts and buttons"),
];

/// Draws the list; `open` becomes false when it is closed.
pub fn help_ui(ctx: &egui::Context, open: &mut bool) {
    let room = ctx.content_rect().size() - vec2(60.0, 120.0);
    egui::Window::new("Keys and mouse")
        .open(open)
        .resizable(false)
        .collapsible(false)
        .pivot(egui::Align2::CENTER_CENTER)
        .default_pos(ctx.content_rect().center())
        .default_size(room.min(vec2(1000.0, 760.0)))
        .show(ctx, |ui| {
            ScrollArea::both().show(ui, |ui| {
                ui.horizontal_top(|ui| {
                    let mouse = mouse();
                    let format = |binding: &KeyBinding| {
                        (ui.ctx().format_shortcut(&binding.shortcut), binding.meaning.to_owned())
                    };
                    let listed = KEY_BINDINGS.iter().filter(|binding| !binding.meaning.is_empty());
                    let keys: Vec<_> = listed.map(format).collect();
                    // Two columns of about the same length.
                    let (left, right) = keys.split_at((keys.len().saturating_sub(mouse.len())).div_ceil(2));
                    list(ui, "left", mouse.iter().chain(left));
                    ui.add_space(28.0);
                    list(ui, "right", right);
                });
            });
        });
}

/// Returns the mouse actions; that of a dropped file names the formats that are read.
fn mouse() -> Vec<(String, String)> {
    let mut lines = MOUSE.map(|(keys, meaning)| (keys.to_owned(), meaning.to_owned())).to_vec();
    if let Some((_, meaning)) = lines.iter_mut().find(|(keys, _)| keys == DROP) {
        // Two lines, as wide as the others
        *meaning += &format!(";\n{} comes in", io::importable_files_text().replace("), ", "),\n"));
    }
    lines
}

fn list<'a>(ui: &mut Ui, name: &str, lines: impl IntoIterator<Item = &'a (String, String)>) {
    Grid::new(name).num_columns(2).spacing([18.0, 3.0]).show(ui, |ui| {
        for (keys, meaning) in lines {
            ui.label(RichText::new(keys).strong());
            ui.label(meaning);
            ui.end_row();
        }
    });
}

//! The status line: the selection, and help on the mouse.

use crate::editor::commands::choices::CentralView;
use crate::editor::commands::command::Command;
use crate::editor::document::item::{Item, name_of_all};
use crate::editor::document::model_import::RunningLoad;
use crate::editor::document::selection::Selection;
use crate::editor::document::studio_document::Document;
use crate::editor::ui::lengths;
use crate::scene::Scene;
use crate::sheet::Units;
use eframe::egui::{self, RichText, Ui};
use std::time::Duration;

/// Time between two looks at the progress of a file.
const PROGRESS_TIME: Duration = Duration::from_millis(100);

/// Draws the status line. `busy` is what the background does, with the files that are read.
pub fn status_ui(
    ui: &mut Ui,
    document: &Document,
    selection: &Selection,
    central_view: CentralView,
    (busy, loads): (Option<&str>, &[RunningLoad]),
    out: &mut Vec<Command>,
) {
    ui.horizontal_centered(|ui| {
        let scene = document.scene();
        match selection.items() {
            [] => ui.label(RichText::new("Nothing selected").weak()),
            [item] => ui.label(selection_line(scene, *item, lengths::units(ui.ctx()))),
            several => ui.label(format!("{} selected", name_of_all(several, scene))),
        };
        let now = ui.input(|i| i.time);
        if let Some(load) = loads.iter().find(|load| load.shown_from_s <= now) {
            ui.separator();
            load_ui(ui, load, out);
        } else if let Some(busy) = busy {
            ui.separator();
            ui.label(RichText::new(busy).weak());
        }
        ui.with_layout(egui::Layout::right_to_left(egui::Align::Center), |ui| {
            ui.add(egui::Label::new(RichText::new(hint(central_view)).weak().small()).truncate());
        });
    });
}

/// Draws how far a file is read, and the button that ends it.
fn load_ui(ui: &mut Ui, load: &RunningLoad, out: &mut Vec<Command>) {
    ui.label(format!("{}: {:.0} %", load.name, 100.0 * load.progress.fraction()));
    let cancel = if load.is_studio { "Cancel opening" } else { "Cancel import" };
    if ui.small_button(cancel).on_hover_text("The studio stays as it is").clicked() {
        out.push(Command::CancelLoads);
    }
    ui.ctx().request_repaint_after(PROGRESS_TIME);
}

fn selection_line(scene: &Scene, item: Item, units: Units) -> String {
    let locked = if item.is_locked(scene) { ", locked" } else { "" };
    match item.position(scene) {
        Some(p) => {
            let [x, y, z] = p.to_array().map(|metres| match units {
                Units::Metres => format!("{metres:.2}"),
                Units::Feet => units.distance(metres),
            });
            let unit = if units == Units::Metres { " m" } else { "" };
            format!("{} at {x}, {y}, {z}{unit}{locked}", item.name(scene))
        }
        None => item.name(scene),
    }
}

fn hint(central_view: CentralView) -> &'static str {
    match central_view {
        CentralView::Studio => {
            "Drag: select in a box    Middle or Alt+left drag: orbit    Shift: pan    Wheel: closer    F1: all keys"
        }
        CentralView::Camera => {
            "What the picture frames. Orbit to leave to the studio view    1: back and forth    F1: all keys"
        }
        CentralView::Light(_) => {
            "What the light sees. Orbit: swing it    Wheel: nearer, farther    V, Esc: back    F1: all keys"
        }
        CentralView::Picture => "Wheel: zoom    Drag: pan    Double-click: fit or 100 %",
    }
}

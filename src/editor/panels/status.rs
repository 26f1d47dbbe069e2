//! The line at the foot of the window: what is selected, what the mouse does here.

use crate::editor::action::Item;
use crate::editor::command::Centre;
use crate::editor::document::Document;
use crate::scene::Scene;
use eframe::egui::{self, RichText, Ui};

/// Draws it.
pub fn status_ui(ui: &mut Ui, document: &Document, selection: Option<Item>, centre: Centre, busy: Option<&str>) {
    ui.horizontal_centered(|ui| {
        let scene = document.scene();
        match selection {
            Some(item) => ui.label(selection_line(scene, item)),
            None => ui.label(RichText::new("Nothing selected").weak()),
        };
        if let Some(busy) = busy {
            ui.separator();
            ui.label(RichText::new(busy).weak());
        }
        ui.with_layout(egui::Layout::right_to_left(egui::Align::Center), |ui| {
            ui.add(egui::Label::new(RichText::new(hint(centre)).weak().small()).truncate());
        });
    });
}

fn selection_line(scene: &Scene, item: Item) -> String {
    let place = match item {
        Item::Light(id) => scene.light(id).filter(|l| !l.emitter.is_infinite()).map(|l| l.position),
        Item::Object(id) => scene.object(id).map(|o| o.transform.position),
        Item::Camera => Some(scene.camera.position),
        Item::Meter => scene.meter.map(|meter| meter.position),
        Item::Room => None,
    };
    match place {
        Some(p) => format!("{} at {:.2}, {:.2}, {:.2} m", item.name(scene), p.x, p.y, p.z),
        None => item.name(scene),
    }
}

fn hint(centre: Centre) -> &'static str {
    match centre {
        Centre::Studio => {
            "Middle or Alt+left drag: orbit    Shift: pan    Wheel: closer    W A S D Q E: fly    F1: all keys"
        }
        Centre::Camera => {
            "What the picture frames. Orbit to leave to the studio view    1: back and forth    F1: all keys"
        }
        Centre::Picture => "Wheel: zoom    Drag: pan    Double-click: fit or 100 %",
    }
}

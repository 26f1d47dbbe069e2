//! Menu entries for the selected items: context menus of item list and viewport, Edit menu.

use crate::editor::commands::choices::PlaceLightBy;
use crate::editor::commands::command::Command;
use crate::editor::commands::menu_entry::entry;
use crate::editor::document::action::Action;
use crate::editor::document::framing::Framing;
use crate::editor::document::item::Item;
use crate::editor::document::selection::Selection;
use crate::scene::{Light, LightId, ObjectId, Scene, Shape};
use crate::sheet::LessonSeries;
use eframe::egui::Ui;

/// Draws the context menu of an item. It applies to the whole selection if the item is part of it, else to the item
/// alone.
pub fn item_menu_ui(ui: &mut Ui, scene: &Scene, item: Item, selection: &Selection, out: &mut Vec<Command>) {
    ui.set_min_width(230.0);
    let mut chosen = Vec::new();
    let alone;
    let about = if selection.contains(item) {
        selection
    } else {
        alone = Selection::of([item]);
        &alone
    };
    if about.len() == 1 && item.can_be_copied() {
        entry(ui, true, "Rename", "Give it another name", Command::BeginRename(item), &mut chosen);
    }
    selection_entries(ui, scene, about, &mut chosen);
    if !chosen.is_empty() {
        if !selection.contains(item) {
            out.push(Command::Select(Some(item)));
        }
        out.extend(chosen);
    }
}

/// Draws the context menu of the viewport without a selection.
pub fn empty_selection_menu_ui(ui: &mut Ui, out: &mut Vec<Command>) {
    ui.set_min_width(230.0);
    entry(ui, true, "Select all", "All lights and things that are not locked", Command::SelectAll, out);
    entry(ui, true, "Paste", "The lights and things on the clipboard", Command::RequestPaste, out);
    entry(ui, true, "Bring everything into view", "Figures, things and lights", Command::FrameSelection, out);
    entry(ui, true, "Show and unmute all", "Nothing is hidden or muted any more", Command::ShowAll, out);
}

pub const FACE_TIP: &str = "The camera aims and focuses at the face; the meter is held before it";

/// Draws the entries that move the camera before a person.
fn framing_entries(ui: &mut Ui, id: ObjectId, out: &mut Vec<Command>) {
    for framing in Framing::ALL {
        entry(ui, true, framing.label(), FRAMING_TIP, Command::FrameFigure(id, framing), out);
    }
}

pub const FRAMING_TIP: &str =
    "Moves the camera, from the side on which it is, so far away that this part fills the picture";

/// Label of the command that hides lights from the camera.
pub const HIDE_FROM_CAMERA: &str = "Hide from camera";
pub const HIDE_TIP: &str = "Front, modifier, head and stand: mirrors show them, and they cast shadows";

/// Draws the entry that hides the selected lights from the camera, if it sees some of them.
fn hide_entry(ui: &mut Ui, scene: &Scene, selection: &Selection, out: &mut Vec<Command>) {
    let lights = selection.lights();
    let seen = lights.iter().filter_map(|id| scene.light(*id)).filter(|light| scene.camera_sees_light(light));
    let hide = |light: &Light| {
        let mut light = light.clone();
        light.hide_from_camera();
        Action::SetLight(Box::new(light))
    };
    let actions: Vec<Action> = seen.map(hide).collect();
    if !actions.is_empty() {
        let command = Command::Apply(Action::Together { label: HIDE_FROM_CAMERA.to_owned(), actions });
        entry(ui, true, HIDE_FROM_CAMERA, HIDE_TIP, command, out);
    }
}

/// Draws the entries that write lesson sheets about a light, the key for none.
pub fn lesson_entries(ui: &mut Ui, light: Option<LightId>, out: &mut Vec<Command>) {
    ui.set_min_width(200.0);
    for series in LessonSeries::ALL {
        let text = format!("{}\u{2026}", series.label());
        entry(ui, true, &text, series.tip(), Command::ExportLesson(series, light), out);
    }
}

/// Draws the entries that apply to a selection.
pub fn selection_entries(ui: &mut Ui, scene: &Scene, selection: &Selection, out: &mut Vec<Command>) {
    let copyable = selection.items().iter().any(|item| item.can_be_copied());
    let lights = !selection.lights().is_empty();
    entry(ui, copyable, "Cut", "Moves them to the clipboard", Command::CutSelected, out);
    entry(ui, copyable, "Copy", "To the clipboard, for this studio or another", Command::CopySelected, out);
    entry(ui, copyable, "Duplicate", "Put a copy beside it", Command::DuplicateSelected, out);
    let tip = "To the other side of the subject's face: place, aim, turn and flaps";
    entry(ui, copyable, "Mirror", tip, Command::MirrorSelected { copies: false }, out);
    let tip = "A copy on the other side of the subject's face";
    entry(ui, copyable, "Mirrored copy", tip, Command::MirrorSelected { copies: true }, out);
    entry(ui, !selection.is_empty(), "Bring into view", "Frames it in the studio view", Command::FrameSelection, out);
    ui.separator();
    for by in PlaceLightBy::ALL {
        let text = format!("{}\u{2026}", by.label());
        entry(ui, lights, &text, by.tip(), Command::TogglePlaceLight(by), out);
    }
    entry(
        ui,
        lights,
        "Look through it",
        "See what the light sees, and swing it by that",
        Command::ToggleLightView,
        out,
    );
    if let [Item::Object(id)] = selection.items()
        && scene.object(*id).is_some_and(|object| matches!(object.shape, Shape::Figure(_)))
    {
        ui.menu_button("Frame in the picture", |ui| framing_entries(ui, *id, out));
        entry(ui, true, "Aim, focus and meter at the face", FACE_TIP, Command::SetUpAtFace(*id), out);
    }
    hide_entry(ui, scene, selection, out);
    if let [Item::Light(light)] = selection.items() {
        ui.menu_button("Lesson sheet", |ui| lesson_entries(ui, Some(*light), out));
    }
    ui.separator();
    let solo = if scene.solo.is_some() { "Solo, or end solo" } else { "Solo" };
    let tip = "Only these lights; once more brings back what was on before";
    entry(ui, lights || scene.solo.is_some(), solo, tip, Command::SoloSelected, out);
    let tip = "Hides things and mutes lights; once more brings them back as they were";
    entry(ui, copyable, "Hide or mute", tip, Command::HideSelected, out);
    let locked = selection.items().iter().any(|item| item.can_be_copied() && !item.is_locked(scene));
    let text = if locked || !copyable { "Lock in place" } else { "Unlock" };
    let tip = "What is locked cannot be moved, and clicks in the view go past it";
    entry(ui, copyable, text, tip, Command::LockSelected, out);
    ui.separator();
    entry(ui, copyable, "Delete", "Take it away", Command::DeleteSelected, out);
}

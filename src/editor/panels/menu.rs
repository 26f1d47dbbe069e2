//! The menu bar.

use crate::editor::commands::choices::LiveMode;
use crate::editor::commands::choices::ViewSide;
use crate::editor::commands::choices::{CentralView, HandleMode};
use crate::editor::commands::command::Command;
use crate::editor::commands::item_menu::{lesson_entries, selection_entries};
use crate::editor::commands::menu_entry::entry;
use crate::editor::document::selection::Selection;
use crate::editor::document::studio_document::Document;
use crate::editor::panels::variants;
use crate::editor::ui::lengths;
use crate::io;
use crate::scene::Scene;
use crate::sheet::Units;
use eframe::egui::{MenuBar, Ui};
use std::path::PathBuf;

/// The state that menus and view bar show.
#[derive(Clone, Copy, Debug)]
pub struct MenuState<'a> {
    /// The open studio.
    pub document: &'a Document,
    /// The selection.
    pub selection: &'a Selection,
    /// Recent studios.
    pub recent: &'a [PathBuf],
    /// The central view.
    pub central_view: CentralView,
    /// The kind of transform handles.
    pub handles: HandleMode,
    /// True if the handles snap.
    pub snap: bool,
    /// The renderer of the live view.
    pub live: LiveMode,
    /// True if there is a picture to export.
    pub has_picture: bool,
    /// True during a render.
    pub rendering: bool,
}

/// Draws the menu bar.
pub fn menu_ui(ui: &mut Ui, state: MenuState<'_>, out: &mut Vec<Command>) {
    MenuBar::new().ui(ui, |ui| {
        ui.menu_button("File", |ui| file_menu(ui, state, out));
        ui.menu_button("Edit", |ui| edit_menu(ui, state, out));
        ui.menu_button("View", |ui| view_menu(ui, state, out));
        ui.menu_button("Light", |ui| light_menu(ui, state, out));
        ui.menu_button("Variants", |ui| variants_menu(ui, state.document.scene(), out));
        ui.menu_button("Render", |ui| render_menu(ui, state, out));
        ui.menu_button("Help", |ui| help_menu(ui, out));
    });
}

fn file_menu(ui: &mut Ui, state: MenuState<'_>, out: &mut Vec<Command>) {
    ui.set_min_width(220.0);
    entry(ui, true, "New from preset\u{2026}", "Start from a set-up a photographer would name", Command::New, out);
    entry(ui, true, "Open\u{2026}", OPEN_TIP, Command::Open, out);
    recent_menu(ui, state, out);
    ui.separator();
    entry(ui, true, "Save", "Write the studio to its file", Command::Save, out);
    entry(ui, true, "Save as\u{2026}", "Write the studio to another file", Command::SaveAs, out);
    ui.separator();
    let import = format!("Import {}\u{2026}", io::model_format_names());
    entry(ui, true, &import, "Bring in a model", Command::Import, out);
    let measured = Command::MeasuredLight(None);
    entry(ui, true, "Measured light (IES, EULUMDAT)\u{2026}", "Add a light from a photometric file", measured, out);
    let panorama = Command::EnvironmentMap(None);
    entry(ui, true, "Environment (HDR, EXR)\u{2026}", "Light the studio by a panorama", panorama, out);
    entry(
        ui,
        state.has_picture,
        "Export picture\u{2026}",
        "Write the rendered picture as PNG, JPEG, 16-bit TIFF or EXR",
        Command::ExportPicture,
        out,
    );
    let units = lengths::units(ui.ctx());
    let (other, in_other) = match units {
        Units::Metres => (Units::Feet, "Export set-up sheet in feet\u{2026}"),
        Units::Feet => (Units::Metres, "Export set-up sheet in metres\u{2026}"),
    };
    for (units, text) in [(units, "Export set-up sheet\u{2026}"), (other, in_other)] {
        entry(ui, true, text, SHEET_TIP, Command::ExportSheet(units), out);
    }
    ui.separator();
    entry(ui, true, "Quit", "Close the window", Command::Quit, out);
}

fn light_menu(ui: &mut Ui, state: MenuState<'_>, out: &mut Vec<Command>) {
    ui.set_min_width(200.0);
    entry(ui, true, "Set dials by wish\u{2026}", DIALS_TIP, Command::ToggleDials, out);
    entry(ui, true, "What the room adds\u{2026}", AUDIT_TIP, Command::ToggleRoomAudit, out);
    entry(ui, true, "My gear\u{2026}", GEAR_TIP, Command::ToggleGear, out);
    ui.separator();
    ui.menu_button("Lesson sheet", |ui| lesson_entries(ui, state.selection.lights().last().copied(), out));
}

fn variants_menu(ui: &mut Ui, scene: &Scene, out: &mut Vec<Command>) {
    ui.set_min_width(220.0);
    let add = "Another light, camera or visibility beside what is shown, in the same file";
    entry(ui, true, "Add variant", add, Command::AddVariant, out);
    if scene.variants.is_empty() {
        return;
    }
    ui.separator();
    for (index, (id, name)) in scene.variants.list().enumerate() {
        let text = if id == scene.variants.shown() { format!("{name} (shown)") } else { name.to_owned() };
        let show = if index < 9 { Command::ShowVariantAt(index) } else { Command::ShowVariant(id) };
        entry(ui, true, &text, &variants::difference_text(scene, id), show, out);
    }
    ui.separator();
    variants::entries(ui, scene, scene.variants.shown(), out);
}

const OPEN_TIP: &str = "Open a studio (.ron), or a rendered picture with its studio (.exr)";
const DIALS_TIP: &str = "Name the f-number of the key and stops of the others; the dials follow from the meter";
const AUDIT_TIP: &str = "How much of the light comes by walls, ceiling, floor and backdrops; spill and flare";
const GEAR_TIP: &str = "The heads, modifiers and stands that you own: first on the shelf, and counted";
const PREFERENCES_TIP: &str = "Size of texts, dark or light, metres or feet, meter constant";
const SHEET_TIP: &str = "One page to build the studio again from: picture, plan, list of lights; PDF, SVG or HTML";

fn recent_menu(ui: &mut Ui, state: MenuState<'_>, out: &mut Vec<Command>) {
    let paths = state.recent;
    ui.add_enabled_ui(!paths.is_empty(), |ui| {
        ui.menu_button("Open recent", |ui| {
            for path in paths {
                let name = path.file_name().map_or_else(|| path.to_string_lossy(), |name| name.to_string_lossy());
                if ui.button(name).on_hover_text(path.display().to_string()).clicked() {
                    out.push(Command::OpenPath(path.clone()));
                }
            }
            ui.separator();
            entry(ui, true, "Clear this list", "The files stay where they are", Command::ClearRecent, out);
        });
    });
}

fn edit_menu(ui: &mut Ui, state: MenuState<'_>, out: &mut Vec<Command>) {
    ui.set_min_width(220.0);
    let history = state.document.history();
    let undo = history.undo_label().map_or_else(|| "Undo".to_owned(), |label| format!("Undo: {label}"));
    let redo = history.redo_label().map_or_else(|| "Redo".to_owned(), |label| format!("Redo: {label}"));
    entry(ui, history.undo_label().is_some(), &undo, "Take the last step back", Command::Undo, out);
    entry(ui, history.redo_label().is_some(), &redo, "Do the step again", Command::Redo, out);
    ui.separator();
    entry(ui, true, "Select all", "All lights and things that are not locked", Command::SelectAll, out);
    if let [item] = state.selection.items()
        && item.can_be_copied()
    {
        entry(ui, true, "Rename", "Give the selected thing another name", Command::BeginRename(*item), out);
    }
    entry(ui, true, "Paste", "The lights and things on the clipboard", Command::RequestPaste, out);
    selection_entries(ui, state.document.scene(), state.selection, out);
    entry(ui, true, "Show and unmute all", "Nothing is hidden or muted any more", Command::ShowAll, out);
    ui.separator();
    entry(ui, true, "Preferences\u{2026}", PREFERENCES_TIP, Command::TogglePreferences, out);
}

fn view_menu(ui: &mut Ui, state: MenuState<'_>, out: &mut Vec<Command>) {
    ui.set_min_width(240.0);
    entry(ui, true, "Camera view on or off", "What the picture will frame", Command::ToggleCameraView, out);
    entry(ui, true, "Rendered picture", "The last render, large", Command::ShowView(CentralView::Picture), out);
    ui.menu_button("Look from", |ui| {
        ui.set_min_width(150.0);
        for side in ViewSide::ALL {
            entry(ui, true, side.label(), "Without perspective, with a metre grid", Command::LookFrom(side), out);
        }
    });
    entry(ui, true, "Perspective on or off", "Whether what is far looks small", Command::ToggleParallel, out);
    let light = !state.selection.lights().is_empty() || matches!(state.central_view, CentralView::Light(_));
    entry(
        ui,
        light,
        "Through the selected light",
        "What the light sees; once more: back",
        Command::ToggleLightView,
        out,
    );
    ui.separator();
    let other = match state.live {
        LiveMode::Quick => "Live view: trace it (True)",
        LiveMode::True => "Live view: estimate it (Quick)",
    };
    entry(ui, true, other, "Quick is drawn at once; True is what the picture will be", Command::ToggleLiveMode, out);
    ui.separator();
    entry(ui, true, "Bring selection into view", "Everything, when nothing is selected", Command::FrameSelection, out);
    let in_studio = state.central_view == CentralView::Studio;
    let tip = "Puts the camera where the studio view looks from";
    entry(ui, in_studio, "Camera to this view", tip, Command::CameraFromView, out);
    ui.separator();
    for (handle, text, tip) in HANDLES {
        let text = if state.handles == handle { format!("{text} (on)") } else { text.to_owned() };
        entry(ui, true, &text, tip, Command::SetHandles(handle), out);
    }
    let text = if state.snap { "Snap (on)" } else { "Snap" };
    entry(ui, true, text, SNAP_TIP, Command::ToggleSnap, out);
}

/// Tooltip of the snap button.
pub const SNAP_TIP: &str = "Handles go in steps of 0.1 m and 15\u{b0}; with Ctrl the other way round";

/// The kinds of transform handles, with label and tooltip.
pub const HANDLES: [(HandleMode, &str, &str); 4] = [
    (HandleMode::Move, "Move", "Handles that move the selected thing"),
    (HandleMode::Rotate, "Turn", "Handles that turn the selected thing; a light aimed at a thing swings round it"),
    (HandleMode::Scale, "Size", "Handles that scale the selected thing"),
    (HandleMode::Pose, "Pose", "Joints of the selected person: drag a hand, a foot, the head"),
];

fn help_menu(ui: &mut Ui, out: &mut Vec<Command>) {
    ui.set_min_width(200.0);
    entry(ui, true, "Keys and mouse", "How to move around", Command::ToggleHelp, out);
    entry(ui, true, "Tour", "Six cards about the parts of the window", Command::StartTour, out);
    ui.separator();
    entry(ui, true, "About Catchlight", "Version and licences", Command::ToggleAbout, out);
}

fn render_menu(ui: &mut Ui, state: MenuState<'_>, out: &mut Vec<Command>) {
    ui.set_min_width(200.0);
    entry(ui, !state.rendering, "Render", "Trace the picture that the camera would take", Command::Render, out);
    entry(ui, state.rendering, "Cancel", "Stop, and keep what is there", Command::CancelRender, out);
}

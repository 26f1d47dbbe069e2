//! The row of buttons over the viewport: central view, renderer of the live view, handles.

use super::menu::{HANDLES, MenuState, SNAP_TIP};
use crate::editor::commands::choices::CentralView;
use crate::editor::commands::choices::LiveMode;
use crate::editor::commands::command::Command;
use crate::editor::document::action::Action;
use crate::editor::document::item::Item;
use crate::editor::ui::widgets;
use crate::editor::ui::window_part::WindowPart;
use crate::scene::{Facing, Meter, Receptor, Scene};
use eframe::egui::{Button, Rect, Ui};

/// Width below which tools and actions move into a menu, points.
const NARROW: f32 = 660.0;
/// Distance of a new light meter from the camera's aim point, metres, to clear a face.
const METER_CLEARANCE_M: f32 = 0.12;

/// Draws the row.
pub fn view_bar_ui(ui: &mut Ui, state: MenuState<'_>, camera_follows: &mut bool, out: &mut Vec<Command>) {
    let is_narrow = ui.available_width() < NARROW;
    ui.horizontal_wrapped(|ui| {
        ui.spacing_mut().item_spacing.x = 3.0;
        centre_ui(ui, state, out);
        ui.separator();
        // A picture has nothing to drag; the tools stay where they are
        let is_live = state.central_view != CentralView::Picture;
        live_ui(ui, state.live, is_live, out);
        ui.separator();
        if is_narrow {
            let tools = ui.menu_button("Tools", |ui| {
                handles_ui(ui, state, is_live, out);
                ui.separator();
                actions_ui(ui, state, camera_follows, out);
            });
            WindowPart::Meter.note(ui.ctx(), tools.response.rect);
            tools.response.on_hover_text("Handles, snap, light meter, camera");
        } else {
            handles_ui(ui, state, is_live, out);
            ui.separator();
            actions_ui(ui, state, camera_follows, out);
        }
    });
}

/// Draws the choice of the central view.
fn centre_ui(ui: &mut Ui, state: MenuState<'_>, out: &mut Vec<Command>) {
    let mut centre = state.central_view;
    let views = [
        (CentralView::Studio, "Studio", "Look at the studio from anywhere (1 switches to the camera and back)"),
        (CentralView::Camera, "Camera", "What the picture will frame (1)"),
        (CentralView::Picture, "Picture", "The rendered picture (3)"),
    ];
    let before = ui.cursor().min;
    widgets::choice(ui, &mut centre, &views);
    WindowPart::Picture.note(ui.ctx(), Rect::from_min_max(before, ui.min_rect().right_bottom()));
    if let CentralView::Light(id) = state.central_view
        && let Some(light) = state.document.scene().light(id)
    {
        let button = Button::selectable(true, format!("Through {}", light.name));
        if ui.add(button).on_hover_text("What this light sees. Click to go back (V, Esc)").clicked() {
            out.push(Command::ToggleLightView);
        }
    }
    if centre != state.central_view {
        out.push(Command::ShowView(centre));
    }
}

/// Draws the choice of the live view's renderer. Its buttons wrap with the row: a layout of their own would not.
fn live_ui(ui: &mut Ui, mode: LiveMode, is_enabled: bool, out: &mut Vec<Command>) {
    ui.spacing_mut().item_spacing.x = 2.0;
    let modes = [
        (LiveMode::Quick, "Quick", "Live: drawn at once; bounced light, mirrors and glass are estimated (2)"),
        (LiveMode::True, "True", "Live: traced as the picture will be, the noise clears within moments (2)"),
    ];
    for (each, text, tip) in modes {
        let button = ui.add_enabled(is_enabled, Button::selectable(mode == each, text));
        if button.on_hover_text(tip).clicked() && mode != each {
            out.push(Command::SetLiveMode(each));
        }
    }
}

fn handles_ui(ui: &mut Ui, state: MenuState<'_>, is_enabled: bool, out: &mut Vec<Command>) {
    for (handle, text, tip) in HANDLES {
        let key = Command::SetHandles(handle).shortcut().map(|s| ui.ctx().format_shortcut(&s)).unwrap_or_default();
        let button = Button::selectable(state.handles == handle, text);
        if ui.add_enabled(is_enabled, button).on_hover_text(format!("{tip} ({key})")).clicked() {
            out.push(Command::SetHandles(handle));
        }
    }
    let snap = ui.add_enabled(is_enabled, Button::selectable(state.snap, "Snap"));
    if snap.on_hover_text(format!("{SNAP_TIP} (G)")).clicked() {
        out.push(Command::ToggleSnap);
    }
}

fn actions_ui(ui: &mut Ui, state: MenuState<'_>, camera_follows: &mut bool, out: &mut Vec<Command>) {
    if ui.button("Frame").on_hover_text("Bring the selection, or everything, into view (F)").clicked() {
        out.push(Command::FrameSelection);
    }
    let meter = ui.add(Button::selectable(state.document.scene().meter.is_some(), "Light meter"));
    WindowPart::Meter.note(ui.ctx(), meter.rect);
    if meter.on_hover_text("Puts a light meter where the camera aims, or selects it").clicked() {
        out.push(put_meter_up(state.document.scene()));
    }
    ui.separator();
    if state.central_view == CentralView::Camera {
        ui.checkbox(camera_follows, "Move the camera").on_hover_text(
            "On: orbit, pan, wheel and W A S D move the camera itself. Off: they leave to the studio view.",
        );
    } else if state.central_view == CentralView::Studio
        && ui.button("Camera here").on_hover_text("Puts the camera where you look from now").clicked()
    {
        out.push(Command::CameraFromView);
        out.push(Command::ShowView(CentralView::Camera));
    }
}

fn put_meter_up(scene: &Scene) -> Command {
    if scene.meter.is_some() {
        return Command::Select(Some(Item::Meter));
    }
    let target = scene.aim_point(&scene.camera.aim, scene.camera.position);
    let towards = (scene.camera.position - target).normalize_or_zero();
    let position = target + towards * METER_CLEARANCE_M;
    Command::Apply(Action::SetMeter(Some(Meter { position, facing: Facing::Camera, receptor: Receptor::Dome })))
}

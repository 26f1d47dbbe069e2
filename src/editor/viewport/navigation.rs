//! Navigation with mouse and keys: it moves the studio view, or the camera or light that is looked through.

use crate::editor::document::placement::angles_towards;
use crate::editor::viewport::studio_view::StudioView;
use crate::scene::{Aim, Camera, Light, Scene};
use eframe::egui::{Key, PointerButton, Response, Ui};
use glam::{Vec2, Vec3};

/// Speed of flying, metres per second; four times with Shift.
const FLY_M_S: f32 = 1.8;

/// Updates a view from mouse and keys. Returns true if the target is unchanged (orbit, zoom). `pivot` is the centre of
/// an orbit, if not the target; the left button orbits with Alt unless a handle has it.
pub fn steer(
    ui: &Ui,
    response: &Response,
    view: &mut StudioView,
    pivot: Option<Vec3>,
    left_button_taken: bool,
) -> bool {
    let modifiers = ui.input(|i| i.modifiers);
    let travel = Vec2::new(response.drag_delta().x, response.drag_delta().y);
    let height = response.rect.height();
    let middle = response.dragged_by(PointerButton::Middle)
        || (response.dragged_by(PointerButton::Primary) && modifiers.alt && !left_button_taken);
    let mut keeps_target = true;
    if middle && modifiers.shift {
        view.pan(travel, height);
        keeps_target = false;
    } else if middle && modifiers.command {
        view.zoom(-travel.y * 0.05);
    } else if middle {
        view.orbit_about(pivot.unwrap_or(view.target), travel);
    } else if response.dragged_by(PointerButton::Secondary) {
        view.look(travel, height);
        keeps_target = false;
    }
    if response.contains_pointer() {
        let (scroll, pinch) = ui.input(|i| (i.smooth_scroll_delta().y, i.zoom_delta()));
        view.zoom(scroll * 0.02 + pinch.ln() * 8.0);
    }
    let flown = fly_step(ui, response);
    if flown != Vec3::ZERO {
        view.fly(flown);
        keeps_target = false;
    }
    keeps_target
}

/// Returns the flight of this frame (right, up, ahead), metres, while its keys are held and no field has the focus.
fn fly_step(ui: &Ui, response: &Response) -> Vec3 {
    let focused = ui.memory(|m| m.focused());
    let listens = response.has_focus() || (focused.is_none() && response.contains_pointer());
    if !listens {
        return Vec3::ZERO;
    }
    let (step, dt, fast) = ui.input(|i| {
        let plain = !i.modifiers.command && !i.modifiers.alt;
        let held = |a: Key, b: Key| f32::from(u8::from(plain && (i.key_down(a) || i.key_down(b))));
        let right = held(Key::D, Key::ArrowRight) - held(Key::A, Key::ArrowLeft);
        let ahead = held(Key::W, Key::ArrowUp) - held(Key::S, Key::ArrowDown);
        let up = held(Key::E, Key::PageUp) - held(Key::Q, Key::PageDown);
        (Vec3::new(right, up, ahead), i.stable_dt.min(0.1), i.modifiers.shift)
    });
    if step != Vec3::ZERO {
        ui.ctx().request_repaint();
    }
    step * FLY_M_S * dt * if fast { 4.0 } else { 1.0 }
}

/// Returns the camera as a view for navigation.
pub fn camera_as_view(scene: &Scene) -> StudioView {
    let camera = &scene.camera;
    StudioView::looking(camera.position, scene.aim_point(&camera.aim, camera.position))
}

/// Returns the camera moved to a view. Its aim is kept if the target is unchanged.
pub fn moved_camera(scene: &Scene, view: &StudioView, kept_aim: bool) -> Camera {
    let mut camera = scene.camera.clone();
    camera.position = view.eye();
    if !kept_aim || matches!(camera.aim, Aim::Angles { .. }) {
        camera.aim = Aim::Point(view.target);
    }
    camera
}

/// Returns a light as a view for navigation.
pub fn light_as_view(scene: &Scene, light: &Light) -> StudioView {
    StudioView::looking(light.position, scene.aim_point(&light.aim, light.position))
}

/// Returns the light moved to a view. Its aim is kept if the target is unchanged.
pub fn moved_light(light: &Light, view: &StudioView, kept_aim: bool) -> Light {
    let position = view.eye();
    let aim = match light.aim {
        Aim::Angles { .. } => angles_towards(view.target - position),
        aim if kept_aim => aim,
        Aim::Point(_) | Aim::Object { .. } => Aim::Point(view.target),
    };
    Light { position, aim, ..light.clone() }
}

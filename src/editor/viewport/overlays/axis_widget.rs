//! The axis widget in the corner of the view: it shows the orientation; its ends are buttons for the views from the
//! sides.

use crate::editor::commands::choices::ViewSide;
use crate::editor::commands::command::Command;
use crate::editor::ui::widgets;
use crate::editor::viewport::studio_view::StudioView;
use crate::scene::CameraFrame;
use eframe::egui::{Align2, Color32, FontId, Pos2, Rect, Sense, Stroke, Ui, vec2};
use glam::Vec3;

/// Distance of the ends from the middle, points.
const ARM: f32 = 34.0;
/// Radius of an end with a letter, points.
const END: f32 = 9.5;

/// Returns the rectangle of the widget.
pub fn place(view: Rect) -> Rect {
    let size = vec2(2.0 * (ARM + END) + 8.0, 2.0 * (ARM + END) + 34.0);
    Rect::from_min_size(view.right_top() + vec2(-size.x - 8.0, 8.0), size)
}

/// Returns colour and letter of an end; sides with a shortcut have a letter.
fn color_and_letter(side: ViewSide) -> (Color32, &'static str) {
    match side {
        ViewSide::Right => (Color32::from_rgb(222, 104, 96), "R"),
        ViewSide::Left => (Color32::from_rgb(222, 104, 96), ""),
        ViewSide::Top => (Color32::from_rgb(128, 190, 96), "T"),
        ViewSide::Bottom => (Color32::from_rgb(128, 190, 96), ""),
        ViewSide::Front => (Color32::from_rgb(96, 148, 222), "F"),
        ViewSide::Back => (Color32::from_rgb(96, 148, 222), ""),
    }
}

/// Draws the widget and handles clicks.
pub fn axis_widget_ui(ui: &mut Ui, view: Rect, studio: &StudioView, frame: &CameraFrame, out: &mut Vec<Command>) {
    let place = place(view);
    let middle = Pos2::new(place.center().x, place.min.y + ARM + END + 2.0);
    let axes = frame.world_from_camera.matrix3;
    let seen = |side: ViewSide| {
        let away = side.away();
        Vec3::new(away.dot(axes.x_axis.into()), away.dot(axes.y_axis.into()), away.dot(axes.z_axis.into()))
    };
    let mut sides = ViewSide::ALL;
    // Back to front.
    sides.sort_by(|a, b| seen(*a).z.total_cmp(&seen(*b).z));
    ui.painter().circle_filled(middle, ARM + END + 2.0, Color32::from_black_alpha(90));
    for side in sides {
        let (towards, (color, letter)) = (seen(side), color_and_letter(side));
        let end = middle + ARM * vec2(towards.x, -towards.y);
        let radius = if letter.is_empty() { 0.62 * END } else { END };
        let response = ui.interact(
            Rect::from_center_size(end, vec2(2.0 * radius, 2.0 * radius)),
            ui.scope_id().with(("look from", side)),
            Sense::click(),
        );
        let name = format!("Look from: {}", side.label());
        widgets::named(ui, &response, &name);
        let shade = if response.hovered() { 1.0 } else { 0.55 + 0.25 * (towards.z + 1.0) * 0.5 };
        let color = if response.hovered() { Color32::WHITE } else { color.gamma_multiply(shade) };
        let painter = ui.painter();
        if letter.is_empty() {
            painter.circle(end, radius, Color32::from_black_alpha(160), Stroke::new(1.5, color));
        } else {
            painter.line_segment([middle, end], Stroke::new(2.0, color));
            painter.circle_filled(end, radius, color);
            painter.text(end, Align2::CENTER_CENTER, letter, FontId::proportional(12.0), Color32::from_gray(16));
        }
        let key = Command::LookFrom(side).shortcut().map(|key| ui.ctx().format_shortcut(&key));
        let key = key.map(|key| format!(" ({key})")).unwrap_or_default();
        if response.on_hover_text(format!("{name}{key}, without perspective, with a metre grid")).clicked() {
            out.push(Command::LookFrom(side));
        }
    }
    perspective_ui(ui, place, studio, out);
}

fn perspective_ui(ui: &mut Ui, place: Rect, studio: &StudioView, out: &mut Vec<Command>) {
    let text = match (studio.side, studio.parallel) {
        (Some(side), _) => side.label(),
        (None, true) => "Parallel",
        (None, false) => "Perspective",
    };
    let rect = Rect::from_center_size(Pos2::new(place.center().x, place.max.y - 11.0), vec2(place.width(), 20.0));
    let button = eframe::egui::Button::new(eframe::egui::RichText::new(text).small()).frame(true);
    let tip = if studio.parallel { "Back to perspective (5)" } else { "Look without perspective (5)" };
    let response = ui.put(rect, button);
    if response.on_hover_text(tip).clicked() {
        out.push(Command::ToggleParallel);
    }
}

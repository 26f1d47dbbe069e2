//! Markers over the live view: picture frame, light names, distances, light meter; and the projection of points to the
//! screen.

use crate::editor::document::item::Item;
use crate::editor::document::selection::Selection;
use crate::editor::ui::lengths;
use crate::editor::ui::theme;
use crate::scene::{CameraFrame, Light, Scene};
use eframe::egui::{Align2, Color32, CornerRadius, FontId, Painter, Pos2, Rect, Shape, Stroke, StrokeKind, vec2};
use glam::Vec3;

/// Radius of a click on a light or the meter, points.
const CLICK_RADIUS: f32 = 9.0;
/// Length of the line along the meter's facing direction, metres.
const METER_NEEDLE_M: f32 = 0.15;

/// Returns the screen position of a world-space point; none behind the eye or far outside of the view.
pub fn place_of(frame: &CameraFrame, rect: Rect, point: Vec3) -> Option<Pos2> {
    let place = frame.project(point)?;
    let inside = (-0.2..1.2).contains(&place.x) && (-0.2..1.2).contains(&place.y);
    inside.then(|| rect.min + vec2(place.x * rect.width(), place.y * rect.height()))
}

/// Returns the light at a screen position.
pub fn light_at(scene: &Scene, frame: &CameraFrame, rect: Rect, position: Pos2) -> Option<Item> {
    let lights = scene.lights.iter().filter(|light| !light.emitter.is_infinite());
    let near = lights.filter_map(|light| {
        let distance = place_of(frame, rect, light.position)?.distance(position);
        (distance < CLICK_RADIUS).then_some((distance, light.id))
    });
    near.min_by(|a, b| a.0.total_cmp(&b.0)).map(|(_, id)| Item::Light(id))
}

/// Returns true if the light meter is at a screen position.
pub fn meter_at(scene: &Scene, frame: &CameraFrame, rect: Rect, position: Pos2) -> bool {
    let place = scene.meter.and_then(|meter| place_of(frame, rect, meter.position));
    place.is_some_and(|place| place.distance(position) < CLICK_RADIUS)
}

/// Paints the light meter: a white receptor and a line along its facing direction.
pub fn paint_meter(painter: &Painter, scene: &Scene, frame: &CameraFrame, rect: Rect) {
    let Some(meter) = scene.meter else { return };
    let Some(place) = place_of(frame, rect, meter.position) else { return };
    let white = Color32::from_gray(240);
    let tip = meter.position + meter.direction(scene) * METER_NEEDLE_M;
    if let Some(tip) = place_of(frame, rect, tip) {
        painter.line_segment([place, tip], Stroke::new(1.5, white));
    }
    painter.circle_filled(place, 5.0, white);
    painter.circle_stroke(place, 5.0, Stroke::new(1.5, Color32::from_black_alpha(200)));
    paint_text(painter, place + vec2(0.0, 8.0), Align2::CENTER_TOP, "meter", white);
}

/// Dims the view outside of the picture and draws the picture's edge.
pub fn paint_picture_frame(painter: &Painter, view: Rect, picture: Rect) {
    let dim = Color32::from_black_alpha(150);
    let bands = [
        Rect::from_min_max(view.min, Pos2::new(view.max.x, picture.min.y)),
        Rect::from_min_max(Pos2::new(view.min.x, picture.max.y), view.max),
        Rect::from_min_max(Pos2::new(view.min.x, picture.min.y), Pos2::new(picture.min.x, picture.max.y)),
        Rect::from_min_max(Pos2::new(picture.max.x, picture.min.y), Pos2::new(view.max.x, picture.max.y)),
    ];
    for band in bands {
        painter.rect_filled(band, 0.0, dim);
    }
    painter.rect_stroke(picture, CornerRadius::ZERO, Stroke::new(1.0, Color32::from_gray(200)), StrokeKind::Outside);
}

/// Paints the names of all or only the selected lights, and with `aims` the distances of the selected ones to their aim
/// points.
pub fn paint_labels(
    painter: &Painter,
    scene: &Scene,
    frame: &CameraFrame,
    rect: Rect,
    selection: &Selection,
    all: bool,
    aims: bool,
) {
    for light in scene.lights.iter().filter(|light| !light.emitter.is_infinite()) {
        let selected = selection.contains(Item::Light(light.id));
        if !(all || selected) {
            continue;
        }
        // The label leaves room for the handles of a single selected light.
        let silent = scene.is_silenced(light);
        paint_light_label(painter, frame, rect, light, silent, selected, selection.len() == 1 && selected);
        if selected && aims {
            paint_aim(painter, scene, frame, rect, light);
        }
    }
}

fn paint_light_label(
    painter: &Painter,
    frame: &CameraFrame,
    rect: Rect,
    light: &Light,
    silent: bool,
    selected: bool,
    has_handles: bool,
) {
    let Some(place) = place_of(frame, rect, light.position) else { return };
    let color = if light.on { theme::role_color(light.role) } else { Color32::from_gray(110) };
    painter.circle_filled(place, if selected { 4.5 } else { 3.5 }, color);
    painter.circle_stroke(place, if selected { 4.5 } else { 3.5 }, Stroke::new(1.0, Color32::from_black_alpha(160)));
    let state = match (light.on, light.muted, silent) {
        (true, ..) if light.locked => " (locked)",
        (true, ..) => "",
        (false, true, _) => " (muted)",
        (false, _, true) => " (silent)",
        (false, false, false) => " (off)",
    };
    let text = format!("{}{state}", light.name);
    let (offset, align) = label_place(place, rect, has_handles);
    paint_text(painter, place + offset, align, &text, color);
}

/// Returns offset and alignment of the name of a light at `place`: outwards from the middle of the view, or above its
/// handles.
pub fn label_place(place: Pos2, view: Rect, has_handles: bool) -> (eframe::egui::Vec2, Align2) {
    match (has_handles, place.x < view.center().x) {
        (true, _) => (vec2(0.0, -84.0), Align2::CENTER_BOTTOM),
        (false, true) => (vec2(-9.0, 0.0), Align2::RIGHT_CENTER),
        (false, false) => (vec2(9.0, 0.0), Align2::LEFT_CENTER),
    }
}

fn paint_aim(painter: &Painter, scene: &Scene, frame: &CameraFrame, rect: Rect, light: &Light) {
    let target = scene.aim_point(&light.aim, light.position);
    let color = theme::role_color(light.role);
    paint_aim_line(painter, frame, rect, light.position, target, color);
    let (Some(from), Some(to)) = (place_of(frame, rect, light.position), place_of(frame, rect, target)) else { return };
    let text = lengths::shown(painter.ctx(), (target - light.position).length());
    let place = from.lerp(to, 0.6) + vec2(8.0, 0.0);
    paint_text(painter, place, Align2::LEFT_CENTER, &text, color.gamma_multiply(0.7));
}

/// Paints a dashed line from a light or the camera to its aim point.
pub fn paint_aim_line(painter: &Painter, frame: &CameraFrame, rect: Rect, from: Vec3, target: Vec3, color: Color32) {
    let (Some(from), Some(to)) = (place_of(frame, rect, from), place_of(frame, rect, target)) else { return };
    let stroke = Stroke::new(1.0, color.gamma_multiply(0.7));
    painter.extend(Shape::dashed_line(&[from, to], stroke, 6.0, 4.0));
    painter.circle_stroke(to, 4.0, stroke);
}

/// Paints a line of text in the lower left corner of the view; clear of the grid's numbers if it `has_rulers`.
pub fn paint_note(painter: &Painter, view: Rect, text: &str, has_rulers: bool) {
    let place = view.left_bottom() + if has_rulers { vec2(52.0, -28.0) } else { vec2(10.0, -8.0) };
    paint_text(painter, place, Align2::LEFT_BOTTOM, text, Color32::from_gray(200));
}

/// Paints small text on a dark background.
pub fn paint_text(painter: &Painter, place: Pos2, align: Align2, text: &str, color: Color32) {
    let galley = painter.layout_no_wrap(text.to_owned(), FontId::proportional(11.5), color);
    let rect = align.anchor_size(place, galley.size());
    painter.rect_filled(rect.expand2(vec2(3.0, 0.0)), CornerRadius::same(3), Color32::from_black_alpha(130));
    painter.galley(rect.min, galley, color);
}

/// Paints a line of help at the lower edge of the view.
pub fn paint_banner(painter: &Painter, rect: Rect, text: &str) {
    let width = (rect.width() - 40.0).max(120.0);
    let galley = painter.layout(text.to_owned(), FontId::proportional(13.0), Color32::WHITE, width);
    let size = galley.size() + vec2(20.0, 10.0);
    let place = Rect::from_min_size(Pos2::new(rect.center().x - 0.5 * size.x, rect.max.y - size.y - 28.0), size);
    painter.rect_filled(place, 5.0, Color32::from_black_alpha(190));
    painter.galley(place.min + vec2(10.0, 5.0), galley, Color32::WHITE);
}

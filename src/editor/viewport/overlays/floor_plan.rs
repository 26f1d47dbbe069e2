//! Overlays of a view from a side: a grid of metres or feet with numbers, and the distances of lights and camera from their aim
//! points.

use crate::editor::commands::choices::ViewSide;
use crate::editor::document::item::Item;
use crate::editor::document::readout;
use crate::editor::document::selection::Selection;
use crate::editor::document::studio_document::Document;
use crate::editor::ui::lengths;
use crate::editor::ui::theme;
use crate::editor::viewport::overlays::markers::{label_place, paint_aim_line, paint_text, place_of};
use crate::photo::meter::FOOT_M;
use crate::photo::text::signed_stops;
use crate::scene::{Assets, CameraFrame, Light, Role, Scene};
use crate::sheet::Units;
use eframe::egui::{Align2, Color32, Painter, Rect, Stroke, vec2};
use glam::Vec3;

/// Spacings of the grid, metres or feet.
const STEPS: [f32; 10] = [0.05, 0.1, 0.25, 0.5, 1.0, 2.0, 5.0, 10.0, 20.0, 50.0];
/// Least spacing on the screen, points.
const MIN_SPACING: f32 = 46.0;
/// Most lines of a view.
const MAX_LINES: i32 = 200;

/// The room's axes with their letters.
const AXES: [(Vec3, &str); 3] = [(Vec3::X, "x"), (Vec3::Y, "height"), (Vec3::Z, "z")];

/// Paints the grid and its numbers, for a view from `side` centred on `target` that shows `half_height_m` above it.
pub fn paint_grid(
    painter: &Painter,
    frame: &CameraFrame,
    rect: Rect,
    side: ViewSide,
    target: Vec3,
    half_height_m: f32,
) {
    let (unit, unit_m) = match lengths::units(painter.ctx()) {
        Units::Metres => ("m", 1.0),
        Units::Feet => ("ft", FOOT_M),
    };
    let points_per_unit = 0.5 * rect.height() * unit_m / half_height_m.max(1e-6);
    let Some(step) = STEPS.into_iter().find(|step| step * points_per_unit >= MIN_SPACING) else { return };
    let half = vec2(0.5 * rect.width(), 0.5 * rect.height()) / points_per_unit;
    for (axis, name) in AXES.into_iter().filter(|(axis, _)| axis.dot(side.away()).abs() < 0.5) {
        let upright = Vec3::from(frame.world_from_camera.matrix3.y_axis).dot(axis).abs() > 0.5;
        let reach = if upright { half.y } else { half.x };
        let middle = target.dot(axis) / unit_m;
        let [first, last] = [middle - reach, middle + reach].map(|at| (at / step).round() as i32);
        for line in first..=last.min(first.saturating_add(MAX_LINES)) {
            let length = line as f32 * step;
            let Some(at) = place_of(frame, rect, target + axis * (unit_m * (length - middle))) else { continue };
            let whole = length == length.round();
            let color = Color32::from_white_alpha(match (line, whole) {
                (0, _) => 90,
                (_, true) => 38,
                (_, false) => 16,
            });
            let text = label(length, step);
            if upright {
                painter.hline(rect.x_range(), at.y, Stroke::new(1.0, color));
                let place = rect.left_top() + vec2(6.0, at.y - rect.min.y - 1.0);
                paint_text(painter, place, Align2::LEFT_BOTTOM, &text, Color32::from_gray(170));
            } else {
                painter.vline(at.x, rect.y_range(), Stroke::new(1.0, color));
                let place = rect.left_bottom() + vec2(at.x - rect.min.x + 3.0, -4.0);
                paint_text(painter, place, Align2::LEFT_BOTTOM, &text, Color32::from_gray(170));
            }
        }
        let (place, align) = if upright {
            (rect.left_top() + vec2(6.0, 44.0), Align2::LEFT_TOP)
        } else {
            (rect.right_bottom() + vec2(-8.0, -22.0), Align2::RIGHT_BOTTOM)
        };
        paint_text(painter, place, align, &format!("{name}, {unit}"), Color32::from_gray(210));
    }
}

/// Formats a coordinate with the digits of the spacing: `1.5`.
fn label(length: f32, step: f32) -> String {
    let text = match step {
        s if s < 0.5 && s != 0.1 => format!("{length:.2}"),
        s if s < 1.0 => format!("{length:.1}"),
        _ => format!("{length:.0}"),
    };
    text.replace('-', "\u{2212}")
}

/// Paints lines from lights and camera to their aim points, with the distance under each name and, for lights that are
/// on, the stops against the key at the aim point.
pub fn paint_distances(painter: &Painter, document: &Document, frame: &CameraFrame, rect: Rect, selection: &Selection) {
    let (scene, assets) = (document.scene(), document.assets());
    let key = key_light(scene);
    for light in scene.lights.iter().filter(|light| !light.emitter.is_infinite()) {
        let target = scene.aim_point(&light.aim, light.position);
        let color = if light.on { theme::role_color(light.role) } else { Color32::from_gray(110) };
        paint_aim_line(painter, frame, rect, light.position, target, color);
        let Some(place) = place_of(frame, rect, light.position) else { continue };
        let has_handles = selection.items() == [Item::Light(light.id)];
        let (offset, align) = label_place(place, rect, has_handles);
        let distance = lengths::shown(painter.ctx(), (target - light.position).length());
        let text = distance_label(scene, assets, light, key, &distance);
        paint_text(painter, place + offset + vec2(0.0, 13.0), align, &text, color.gamma_multiply(0.85));
    }
    let camera = &scene.camera;
    let target = scene.aim_point(&camera.aim, camera.position);
    paint_aim_line(painter, frame, rect, camera.position, target, Color32::from_gray(160));
    let Some(place) = place_of(frame, rect, camera.position) else { return };
    let text = format!("Camera\n{}", lengths::shown(painter.ctx(), (target - camera.position).length()));
    paint_text(painter, place + vec2(14.0, 6.0), Align2::LEFT_CENTER, &text, Color32::from_gray(200));
}

/// Returns the reference for stops: the first key light that is on.
fn key_light(scene: &Scene) -> Option<&Light> {
    scene.lights.iter().find(|light| light.on && light.role == Role::Key)
}

fn distance_label(scene: &Scene, assets: &Assets, light: &Light, key: Option<&Light>, distance: &str) -> String {
    let stops = key
        .filter(|key| key.id != light.id && light.on)
        .map(|key| (readout::at_aim(scene, assets, light).lux_s / readout::at_aim(scene, assets, key).lux_s).log2());
    match stops.filter(|stops| stops.is_finite()) {
        Some(stops) => format!("{distance}  {} stops to the key", signed_stops(stops)),
        None => distance.to_owned(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::editor::document::action::Action;
    use crate::editor::document::catalog;
    use crate::scene::Aim;

    #[test]
    fn a_bulb_at_twice_the_distance_is_two_stops_under_the_key() {
        let mut scene = Scene::default();
        for (role, z) in [(Role::Key, 1.0), (Role::Fill, 2.0)] {
            let mut bulb = catalog::light_named("Bare bulb").unwrap();
            (bulb.role, bulb.position, bulb.aim) = (role, Vec3::Z * z, Aim::Point(Vec3::ZERO));
            Action::AddLight(Box::new(bulb)).apply(&mut scene).unwrap();
        }
        let key = key_light(&scene);
        assert_eq!(
            distance_label(&scene, &Assets::default(), &scene.lights[1], key, "2.00 m"),
            "2.00 m  \u{2212}2.0 stops to the key"
        );
        assert_eq!(distance_label(&scene, &Assets::default(), &scene.lights[0], key, "1.00 m"), "1.00 m");
    }

    #[test]
    fn numbers_have_the_digits_of_their_step() {
        assert_eq!([label(-1.0, 1.0), label(0.5, 0.5), label(0.25, 0.25)], ["\u{2212}1", "0.5", "0.25"]);
    }
}

//! The view through a light along its axis, with its beam angles and size.

use crate::editor::ui::theme;
use crate::editor::viewport::overlays::markers::paint_text;
use crate::scene::{CameraFrame, Emitter, Light, Scene};
use eframe::egui::{Align2, Color32, Painter, Pos2, Rect, Stroke, pos2, vec2};
use glam::Vec2;

/// Half the vertical field of view for a light without a cone, degrees.
const WIDE_DEG: f32 = 35.0;

/// Returns the camera frame of the light for a view of `aspect` (width / height): its cone with a margin.
pub fn frame(scene: &Scene, light: &Light, aspect: f32) -> CameraFrame {
    let cone_deg = match (light.emitter, light.modifier.beam) {
        (Emitter::Spot { outer_deg, .. }, _) => Some(outer_deg),
        (_, beam) => beam.map(|cone| cone.outer_deg),
    };
    let half_deg = cone_deg.map_or(WIDE_DEG, |full| (0.5 * full * 1.15).clamp(5.0, 50.0));
    let half_height = half_deg.to_radians().tan();
    CameraFrame {
        world_from_camera: scene.light_frame(light),
        half_extent: Vec2::new(half_height * aspect.max(1e-3), half_height),
    }
}

/// Returns the beam angles of a light: full angle in degrees, and label.
fn rings(light: &Light) -> Vec<(f32, &'static str)> {
    let mut rings = Vec::new();
    if let Emitter::Spot { inner_deg, outer_deg } = light.emitter {
        rings.extend([(inner_deg, "even cone"), (outer_deg, "outer cone")]);
    }
    if let Some(beam) = light.modifier.beam {
        rings.extend([(beam.inner_deg, "even beam"), (beam.outer_deg, "whole beam")]);
    }
    rings.extend(light.modifier.grid_deg.map(|deg| (deg, "grid")));
    rings
}

/// Returns half the size of the emitter, metres, and true if it is round; none for point, spot, sun and surround.
fn half_size(emitter: &Emitter) -> Option<(Vec2, bool)> {
    match *emitter {
        Emitter::RectPanel { width_m, height_m } => Some((0.5 * Vec2::new(width_m, height_m), false)),
        Emitter::RoundPanel { diameter_m } => Some((Vec2::splat(0.5 * diameter_m), true)),
        Emitter::Sphere { radius_m } => Some((Vec2::splat(radius_m), true)),
        Emitter::Point | Emitter::Spot { .. } | Emitter::Sun { .. } | Emitter::Surround => None,
    }
}

/// Returns the projected size of an object of this half size at a distance, points.
fn shown_size(half_m: Vec2, distance_m: f32, frame: &CameraFrame, rect: Rect) -> eframe::egui::Vec2 {
    let part = half_m / distance_m.max(1e-3) / frame.half_extent;
    vec2(part.x * rect.width(), part.y * rect.height())
}

/// Paints the outline of the emitter at its aim point, for comparison with the subject.
fn paint_size(painter: &Painter, light: &Light, distance_m: f32, frame: &CameraFrame, rect: Rect, color: Color32) {
    let Some((half_m, round)) = half_size(&light.emitter) else { return };
    let size = shown_size(half_m, distance_m, frame, rect);
    let place = Rect::from_center_size(rect.center(), size);
    let outline: Vec<Pos2> = if round {
        (0..=64)
            .map(|i| i as f32 / 64.0 * std::f32::consts::TAU)
            .map(|a| place.center() + 0.5 * vec2(size.x * a.cos(), size.y * a.sin()))
            .collect()
    } else {
        [place.left_top(), place.right_top(), place.right_bottom(), place.left_bottom(), place.left_top()].to_vec()
    };
    let stroke = Stroke::new(1.0, color.gamma_multiply(0.6));
    painter.extend(eframe::egui::Shape::dashed_line(&outline, stroke, 6.0, 5.0));
    let [width, height] = (200.0 * half_m).to_array();
    let text =
        if round { format!("its size, {width:.0} cm") } else { format!("its size, {width:.0} \u{d7} {height:.0} cm") };
    let at = Pos2::new(place.center().x, place.max.y.min(rect.max.y - 24.0));
    paint_text(painter, at + vec2(0.0, 4.0), Align2::CENTER_TOP, &text, color.gamma_multiply(0.8));
}

/// Paints a cross-hair on the axis, rings at the beam angles, and the emitter's size at the aim point, `distance_m`
/// away.
pub fn paint(painter: &Painter, light: &Light, distance_m: f32, frame: &CameraFrame, rect: Rect) {
    let color = theme::role_color(light.role);
    let (centre, stroke) = (rect.center(), Stroke::new(1.5, color));
    for (x, y) in [(1.0, 0.0), (-1.0, 0.0), (0.0, 1.0), (0.0, -1.0)] {
        painter.line_segment([centre + 6.0 * vec2(x, y), centre + 16.0 * vec2(x, y)], stroke);
    }
    paint_size(painter, light, distance_m, frame, rect, color);
    for (full_deg, what) in rings(light) {
        // Larger rings lie outside of every view.
        if full_deg > 170.0 {
            continue;
        }
        let radius = 0.5 * rect.height() * (0.5 * full_deg).to_radians().tan() / frame.half_extent.y;
        painter.circle_stroke(centre, radius, Stroke::new(1.0, color.gamma_multiply(0.8)));
        let place = pos2(centre.x, (centre.y - radius).max(rect.min.y + 30.0));
        let text = format!("{what} {full_deg:.0}\u{b0}");
        paint_text(painter, place + vec2(0.0, -4.0), Align2::CENTER_BOTTOM, &text, color);
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::editor::document::catalog;
    use glam::Vec3;

    #[test]
    fn the_view_through_a_light_centres_its_aim_and_shows_its_whole_cone() {
        let scene = Scene::default();
        let mut light = catalog::light_named("Bare bulb").unwrap();
        light.emitter = Emitter::Spot { inner_deg: 20.0, outer_deg: 50.0 };
        let frame = frame(&scene, &light, 1.6);
        let target = scene.aim_point(&light.aim, light.position);
        assert!((frame.project(target).unwrap() - 0.5).length() < 1e-5);
        // The projected size of a panel of 60 x 90 cm at 2 m equals the projection of its corner.
        let rect = Rect::from_min_size(Pos2::ZERO, vec2(1600.0, 1000.0));
        let size = shown_size(Vec2::new(0.3, 0.45), 2.0, &frame, rect);
        let corner = frame.world_from_camera.transform_point3(Vec3::new(0.3, 0.45, -2.0));
        let place = frame.project(corner).unwrap() - 0.5;
        assert!((size - 2.0 * vec2(place.x * 1600.0, -place.y * 1000.0)).length() < 1e-2, "{size} for {place}");
        let edge = frame.world_from_camera.transform_point3(Vec3::new(0.0, 25.0_f32.to_radians().tan(), -1.0));
        let place = frame.project(edge).unwrap();
        assert!(place.y > 0.0 && place.y < 0.1, "the cone's edge is just inside: {place}");
    }
}

//! Legends of false colours.

use eframe::egui::{Align2, Color32, FontId, Painter, Pos2, Rect, vec2};

/// Size of a colour swatch, points.
const SWATCH: (f32, f32) = (22.0, 18.0);
/// Width of the texts, points.
const TEXT: f32 = 168.0;

/// Paints a legend in the lower left corner of a view: a title, and a line for each colour, from the top.
pub fn paint(painter: &Painter, view: Rect, title: &str, lines: &[([u8; 3], String)]) {
    let size = vec2(SWATCH.0 + TEXT, SWATCH.1 * lines.len() as f32 + 30.0);
    let place = Rect::from_min_size(view.left_bottom() + vec2(8.0, -size.y - 8.0), size);
    painter.rect_filled(place, 4.0, Color32::from_black_alpha(190));
    let font = FontId::proportional(12.0);
    let text =
        |at: Pos2, text: &str| painter.text(at, Align2::LEFT_CENTER, text, font.clone(), Color32::from_gray(230));
    text(place.min + vec2(8.0, 12.0), title);
    for (row, ([r, g, b], line)) in lines.iter().enumerate() {
        let corner = place.min + vec2(8.0, 24.0 + SWATCH.1 * row as f32);
        painter.rect_filled(Rect::from_min_size(corner, SWATCH.into()), 0.0, Color32::from_rgb(*r, *g, *b));
        text(corner + vec2(SWATCH.0 + 8.0, 0.5 * SWATCH.1), line);
    }
}

//! The rows of a light's measured distribution: its file, what the file states, and the polar plot.

use crate::editor::commands::command::Command;
use crate::editor::document::measured_light::as_file_says;
use crate::editor::ui::theme;
use crate::editor::ui::widgets::{fact, row};
use crate::photo::text::three_digits;
use crate::scene::{Assets, IntensityTable, Light};
use eframe::egui::{Align2, Color32, FontId, Pos2, RichText, Sense, Shape, Stroke, Ui, pos2, vec2};

/// Height of the plot, points.
const PLOT_HEIGHT: f32 = 150.0;
/// Degrees between two points of a curve.
const CURVE_STEP_DEG: usize = 2;

/// Draws the rows; the file comes from a dialog that a command opens.
pub(super) fn measured_rows(ui: &mut Ui, assets: &Assets, light: &mut Light, out: &mut Vec<Command>) {
    if light.emitter.is_infinite() {
        return;
    }
    let tip = "Its intensity by direction, as a laboratory measured it: an IES or EULUMDAT file of the maker. The file \
               states the light's power, too. A file can be dropped on the window.";
    row(ui, "Measured light", tip, |ui| {
        if let Some(path) = &light.photometric_file {
            let name = path.rsplit('/').next().unwrap_or(path);
            let shown: String = name.chars().take(18).collect();
            ui.label(shown).on_hover_text(path);
        }
        let text = if light.photometric_file.is_some() { "Other\u{2026}" } else { "IES, EULUMDAT\u{2026}" };
        if ui.button(text).on_hover_text("Choose a photometric file").clicked() {
            out.push(Command::MeasuredLight(Some(light.id)));
        }
        if light.photometric_file.is_some() && ui.button("Remove").on_hover_text("Shine as the emitter does").clicked()
        {
            light.photometric_file = None;
        }
    });
    if light.photometric_file.is_none() {
        return;
    }
    let Some(table) = assets.intensity_table(light) else {
        ui.label(RichText::new("The file can't be read; the light shines as its emitter does.").color(theme::bad(ui)));
        return;
    };
    if !table.luminaire.is_empty() {
        fact(ui, "Luminaire", "As the file names it", table.luminaire.clone());
    }
    row(ui, "The file says", "Luminous flux and largest intensity", |ui| {
        ui.label(format!("{} lm, {} cd", three_digits(table.flux_lm()), three_digits(table.peak_cd())));
        let stated = as_file_says(&table);
        let is_as_stated = light.power == stated && !light.modifier.narrows();
        ui.add_enabled_ui(!is_as_stated, |ui| {
            if ui.button("Use").on_hover_text("Set the power to what the file says, at full power").clicked() {
                (light.power, light.head) = (stated, None);
            }
        });
    });
    polar_plot(ui, &table);
}

/// Draws the intensities of the planes C0-C180 and C90-C270 by direction, the axis downwards.
fn polar_plot(ui: &mut Ui, table: &IntensityTable) {
    let size = vec2(ui.available_width().min(260.0), PLOT_HEIGHT);
    let (response, painter) = ui.allocate_painter(size, Sense::hover());
    let rect = response.rect.shrink(4.0);
    let shines_up = (95..=180).step_by(5).any(|v| {
        let at = |h: f32| table.candela_at(v as f32, h);
        [0.0, 90.0, 180.0, 270.0].into_iter().any(|h| at(h) > 0.02 * table.peak_cd())
    });
    let (centre, radius) = if shines_up {
        (rect.center(), 0.5 * rect.height() - 2.0)
    } else {
        (rect.center_top() + vec2(0.0, 6.0), (rect.height() - 10.0).min(0.5 * rect.width()))
    };
    let grid = Stroke::new(1.0, ui.visuals().weak_text_color().gamma_multiply(0.4));
    let clipped = painter.with_clip_rect(response.rect);
    for part in [0.5, 1.0] {
        clipped.circle_stroke(centre, part * radius, grid);
    }
    for degrees in [-90_i32, -60, -30, 0, 30, 60, 90] {
        let (sin, cos) = (degrees as f32).to_radians().sin_cos();
        clipped.line_segment([centre, centre + radius * vec2(sin, cos)], grid);
    }
    let (accent, across) = (theme::accent(ui), ui.visuals().weak_text_color());
    for (planes, color) in [([90.0, 270.0], across), ([0.0, 180.0], accent)] {
        clipped.add(Shape::line(curve(table, planes, centre, radius), Stroke::new(1.5, color)));
    }
    let text = |at: Pos2, align: Align2, text: String, color: Color32| {
        clipped.text(at, align, text, FontId::proportional(10.0), color);
    };
    text(rect.left_bottom(), Align2::LEFT_BOTTOM, format!("{} cd", three_digits(table.peak_cd())), across);
    text(rect.right_bottom() - vec2(0.0, 12.0), Align2::RIGHT_BOTTOM, "C0".to_owned(), accent);
    text(rect.right_bottom(), Align2::RIGHT_BOTTOM, "C90".to_owned(), across);
    response.on_hover_text(
        "Intensity by direction: the axis is down, the outer ring the largest intensity. C0 is the plane to the light's \
         right and left, C90 that up and down.",
    );
}

/// Returns the points of a curve through two opposite planes: from the back along one, over the axis, along the other.
fn curve(table: &IntensityTable, [right, left]: [f32; 2], centre: Pos2, radius: f32) -> Vec<Pos2> {
    let point = |vertical: usize, horizontal: f32, side: f32| {
        let (sin, cos) = (vertical as f32).to_radians().sin_cos();
        let length = radius * table.candela_at(vertical as f32, horizontal) / table.peak_cd();
        pos2(centre.x + side * length * sin, centre.y + length * cos)
    };
    let lefts = (0..=180).rev().step_by(CURVE_STEP_DEG).map(|vertical| point(vertical, left, -1.0));
    lefts.chain((0..=180).step_by(CURVE_STEP_DEG).map(|vertical| point(vertical, right, 1.0))).collect()
}

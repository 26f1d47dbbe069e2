//! The chart of noise against render time, with the draft, good, final and current settings, and the best pictures in
//! a time.

use crate::editor::picture::render_settings::{MOST_SAMPLES, Quality, RenderSettings};
use crate::editor::ui::theme;
use crate::editor::ui::units::duration_text;
use crate::editor::ui::widgets::{named, row};
use crate::jobs::{Estimate, Forecast, Forecaster};
use crate::raytrace::{Method, NoiseTarget};
use crate::scene::Camera;
use eframe::egui::{Align2, Button, Color32, FontId, Painter, Pos2, Rect, RichText, Sense, Stroke, Ui, vec2};
use std::time::Duration;

/// Height of the chart, points.
const HEIGHT: f32 = 110.0;
/// Times in which a picture may be wanted, seconds.
const BUDGETS: [(f64, &str); 4] = [(1.0, "1 s"), (10.0, "10 s"), (60.0, "1 min"), (600.0, "10 min")];
/// Limits of noise of the chart's line, stops.
const LINE: [f32; 11] = [1.0, 0.5, 0.25, 0.125, 0.0625, 0.03, 0.015, 0.008, 0.004, 0.002, 0.001];

/// Draws a line per preset, which selects it, and the chart.
pub fn quality_ui(ui: &mut Ui, settings: &mut RenderSettings, camera: &Camera, forecaster: &Forecaster) {
    let (width, height) = settings.pixels(camera);
    let pixels = u64::from(width) * u64::from(height);
    let Some(forecast) = forecaster.forecast() else {
        let text =
            if forecaster.is_busy() { "A pilot picture is on its way\u{2026}" } else { "There is nothing to see yet." };
        ui.label(RichText::new(text).weak().small());
        return;
    };
    let shown = *settings;
    let denoiser_s = shown.denoiser_s(forecast, pixels);
    let by_noise = |noise_stops: f32, most_samples: u32| {
        let target = NoiseTarget::new(shown.traced_noise_stops(noise_stops));
        shown.shown_estimate(forecast.estimate_by_noise(pixels, target, most_samples), denoiser_s)
    };
    let of = |quality: Quality| match quality.noise_stops().zip(shown.most_samples(quality)) {
        Some((noise, most)) => by_noise(noise, most),
        None => shown.shown_estimate(forecast.estimate(pixels, shown.samples), denoiser_s),
    };
    for (quality, word) in Quality::BY_NOISE {
        let text = format!("{word}: {}", estimate_text(of(quality)));
        let tip = "Estimated from a pilot picture and from what renders took";
        if ui.selectable_label(settings.quality == quality, text).on_hover_text(tip).clicked() {
            settings.quality = quality;
        }
    }
    budget_row(ui, settings, forecast, pixels);
    let chosen = of(settings.quality);
    if settings.quality == Quality::Custom {
        let text = format!("{} samples: {}", settings.samples, estimate_text(chosen));
        ui.label(RichText::new(text).color(theme::accent(ui)));
    }
    let (rect, response) = ui.allocate_exact_size(vec2(ui.available_width(), HEIGHT), Sense::hover());
    let label = format!("Noise against time; chosen: {}", estimate_text(chosen));
    named(ui, &response, &label);
    response.on_hover_text(
        "Line: estimate. Rings: draft, good, final. Dot: your choice. Crosses: renders as they came out.",
    );
    let marks = Quality::BY_NOISE.map(|(quality, _)| of(quality));
    let line = LINE.map(|noise| by_noise(noise, u32::MAX));
    let measured: Vec<Estimate> =
        forecaster.measured().iter().map(|estimate| shown.shown_estimate(*estimate, denoiser_s)).collect();
    QualityChart::around(rect, &line).paint(&ui.painter_at(rect), &line, &marks, chosen, &measured);
}

/// Draws the times in which a picture may be wanted. Each selects the samples that fit into it: of all methods, light
/// paths have the smallest error for their time, with the denoiser where it is on.
fn budget_row(ui: &mut Ui, settings: &mut RenderSettings, forecast: &Forecast, pixels: u64) {
    let denoiser_s = settings.denoiser_s(forecast, pixels);
    row(ui, "Best in", "The most light paths through each pixel that fit into a time", |ui| {
        ui.spacing_mut().item_spacing.x = 2.0;
        for (seconds, label) in BUDGETS {
            let samples = forecast.samples_in(pixels, seconds - denoiser_s).min(MOST_SAMPLES);
            let is_chosen = settings.quality == Quality::Custom && settings.samples == samples;
            let button = ui.add_enabled(samples > 0, Button::selectable(is_chosen, label));
            named(ui, &button, &format!("Best picture in {label}"));
            let estimate = settings.shown_estimate(forecast.estimate(pixels, samples), denoiser_s);
            let button = button.on_hover_text(format!("{samples} samples: {}", estimate_text(estimate)));
            if button.on_disabled_hover_text("One light path through each pixel takes longer").clicked() {
                (settings.quality, settings.samples, settings.method) = (Quality::Custom, samples, Method::Path);
            }
        }
    });
}

/// Formats an estimate: `6 s, 0.10 stops`.
pub fn estimate_text(estimate: Estimate) -> String {
    let duration = Duration::from_secs_f64(estimate.seconds.clamp(0.0, 1e7));
    let digits = if estimate.noise_stops < 0.095 { 3 } else { 2 };
    format!("{}, {:.digits$} stops", duration_text(duration), estimate.noise_stops)
}

/// Grid lines of time, seconds.
const TIMES: [(f64, &str); 8] = [
    (0.1, "0.1 s"),
    (1.0, "1 s"),
    (10.0, "10 s"),
    (60.0, "1 min"),
    (600.0, "10 min"),
    (3600.0, "1 h"),
    (36_000.0, "10 h"),
    (360_000.0, "100 h"),
];
/// Width of the longest time label, points.
const ROOM_FOR_A_TIME: f32 = 30.0;

/// The chart: seconds to the right, stops upwards, both logarithmic.
struct QualityChart {
    rect: Rect,
    /// Ranges of time and noise, as powers of ten.
    time: [f32; 2],
    noise: [f32; 2],
}

fn power_of_ten(x: f64) -> f32 {
    x.max(1e-6).log10() as f32
}

impl QualityChart {
    fn around(rect: Rect, points: &[Estimate]) -> Self {
        let range = |of: &dyn Fn(&Estimate) -> f64| {
            let powers = || points.iter().map(|point| power_of_ten(of(point)));
            [powers().fold(f32::INFINITY, f32::min).floor(), powers().fold(f32::NEG_INFINITY, f32::max).ceil()]
        };
        QualityChart {
            rect: rect.shrink2(vec2(4.0, 4.0)),
            time: range(&|p| p.seconds),
            noise: range(&|p| p.noise_stops),
        }
    }

    fn place(&self, estimate: &Estimate) -> Pos2 {
        let part = |x: f64, [least, most]: [f32; 2]| (power_of_ten(x) - least) / (most - least).max(1.0);
        let (across, up) = (part(estimate.seconds, self.time), part(estimate.noise_stops, self.noise));
        Pos2::new(self.rect.left() + across * self.rect.width(), self.rect.bottom() - up * self.rect.height())
    }

    fn paint(&self, painter: &Painter, line: &[Estimate], marks: &[Estimate], chosen: Estimate, real: &[Estimate]) {
        painter.rect_filled(self.rect.expand(4.0), 3.0, theme::SURROUND);
        self.paint_grid(painter);
        let points: Vec<Pos2> = line.iter().map(|estimate| self.place(estimate)).collect();
        painter.line(points, Stroke::new(1.5, Color32::from_gray(150)));
        for mark in marks {
            painter.circle_stroke(self.place(mark), 4.0, Stroke::new(1.5, Color32::from_gray(210)));
        }
        for render in real {
            let place = self.place(render);
            for side in [vec2(4.0, 4.0), vec2(4.0, -4.0)] {
                painter.line_segment([place - side, place + side], Stroke::new(1.5, theme::GOOD));
            }
        }
        painter.circle_filled(self.place(&chosen), 4.0, theme::ACCENT);
    }

    /// Paints the grid: a line per power of ten of noise and per time, with labels.
    fn paint_grid(&self, painter: &Painter) {
        let (stroke, font) = (Stroke::new(0.5, Color32::from_gray(60)), FontId::proportional(9.5));
        let powers = |[least, most]: [f32; 2]| least as i32..=most as i32;
        let number = |power: i32| 10_f64.powi(power);
        for (seconds, text) in TIMES {
            let place = self.place(&Estimate { seconds, noise_stops: 1e-6 });
            if !self.rect.x_range().contains(place.x) {
                continue;
            }
            painter.vline(place.x, self.rect.y_range(), stroke);
            let at = Pos2::new(place.x + 2.0, self.rect.bottom());
            if at.x + ROOM_FOR_A_TIME < self.rect.right() {
                painter.text(at, Align2::LEFT_BOTTOM, text, font.clone(), Color32::from_gray(120));
            }
        }
        for power in powers(self.noise) {
            let place = self.place(&Estimate { seconds: 1e-6, noise_stops: number(power) });
            painter.hline(self.rect.x_range(), place.y, stroke);
            if power as f32 > self.noise[0] {
                let text = format!("{} stops", number(power));
                let at = Pos2::new(self.rect.right(), place.y);
                painter.text(at, Align2::RIGHT_TOP, text, font.clone(), Color32::from_gray(120));
            }
        }
    }
}

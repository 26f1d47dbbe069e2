//! The render panel: size, quality, the button, progress and a small picture.

use crate::editor::commands::choices::CentralView;
use crate::editor::commands::command::Command;
use crate::editor::document::studio_document::Document;
use crate::editor::panels::quality;
use crate::editor::picture::render_settings::{MOST_SAMPLES, PictureSize, Quality, RenderSettings, method_label};
use crate::editor::picture::rendering::{OUT_OF_DATE, Rendering};
use crate::editor::ui::theme;
use crate::editor::ui::units::duration_text;
use crate::editor::ui::wake::wake;
use crate::editor::ui::widgets::{self, NumberField, row};
use crate::jobs::{ForecastSubject, Forecaster, Progress, RenderPhase};
use crate::raytrace::Method;
use crate::scene::Scene;
use eframe::egui::{self, Button, CollapsingHeader, ComboBox, Image, ProgressBar, RichText, Sense, Ui, vec2};

/// Longest side of a picture, pixels.
const LARGEST: f32 = 16_384.0;

/// Largest height of the small picture, points: the inspector above it keeps its room.
const THUMBNAIL_HEIGHT: f32 = 120.0;

/// Draws the render panel.
pub fn render_ui(
    ui: &mut Ui,
    rendering: &mut Rendering,
    forecaster: &mut Forecaster,
    document: &Document,
    central_view: CentralView,
    out: &mut Vec<Command>,
) {
    let scene = document.scene();
    ui.add_space(4.0);
    ui.label(RichText::new("Render").strong());
    ui.separator();
    if central_view != CentralView::Picture {
        thumbnail_ui(ui, rendering, scene, out);
    }
    size_rows(ui, &mut rendering.settings, scene);
    quality_rows(ui, &mut rendering.settings);
    forecast_ui(ui, rendering, forecaster, document);
    progress_ui(ui, rendering);
    ui.add_space(4.0);
    // The buttons come last, at the lower edge, so that changes above do not move them.
    button_row(ui, rendering, out);
    ui.add_space(4.0);
}

/// Selectable long edges, pixels.
const EDGES: [(u32, &str); 4] = [(640, "small"), (1080, "screen"), (2160, "4K"), (4320, "print")];

fn size_rows(ui: &mut Ui, settings: &mut RenderSettings, scene: &Scene) {
    let (width, height) = settings.pixels(&scene.camera);
    row(ui, "Size", "Pixels; the shape is the sensor's unless it is custom", |ui| {
        let custom = matches!(settings.size, PictureSize::Custom(..));
        let text = if custom { "Custom".to_owned() } else { format!("{width} \u{d7} {height}") };
        ComboBox::from_id_salt("size").selected_text(text).width(ui.available_width() - 8.0).show_ui(ui, |ui| {
            for (edge, word) in EDGES {
                let (w, h) = scene.camera.picture_size(edge);
                let label = format!("{w} \u{d7} {h}  ({word})");
                ui.selectable_value(&mut settings.size, PictureSize::LongEdge(edge), label);
            }
            if ui.selectable_label(custom, "Custom").clicked() {
                settings.size = PictureSize::Custom(width, height);
            }
        });
    });
    if let PictureSize::Custom(width, height) = &mut settings.size {
        row(ui, "", "", |ui| {
            const PIXELS: NumberField = NumberField::new(4.0, 1.0, LARGEST, 0, " px");
            for (name, value) in [("Picture width", width), ("Picture height", height)] {
                let mut pixels = *value as f32;
                ui.name_inputs(name, |ui| PIXELS.ui(ui, &mut pixels));
                *value = pixels as u32;
            }
        });
    }
}

fn quality_rows(ui: &mut Ui, settings: &mut RenderSettings) {
    row(ui, "Quality", "The noise that the picture may have; half the noise takes about four times as long", |ui| {
        let tip = |quality: Quality, words: &str| {
            settings.most_samples(quality).map_or(words.to_owned(), |most| format!("{words}, or {most} samples"))
        };
        let (draft, good, print) = (
            tip(Quality::Draft, "To judge the light: noise of a tenth of a stop"),
            tip(Quality::Good, "To share: noise of 0.03 stops"),
            tip(Quality::Final, "To print: noise of 0.01 stops"),
        );
        let choices = [
            (Quality::Draft, "Draft", draft.as_str()),
            (Quality::Good, "Good", good.as_str()),
            (Quality::Final, "Final", print.as_str()),
            (Quality::Custom, "Custom", "A fixed number of light paths through each pixel"),
        ];
        widgets::choice(ui, &mut settings.quality, &choices);
    });
    if settings.quality == Quality::Custom {
        row(ui, "Samples", "Light paths through each pixel", |ui| {
            let mut samples = settings.samples as f32;
            NumberField::new(1.0, 1.0, MOST_SAMPLES as f32, 0, "").ui(ui, &mut samples);
            settings.samples = samples as u32;
        });
    }
    row(ui, "Light", "What is traced", |ui| {
        ComboBox::from_id_salt("method")
            .selected_text(method_label(settings.method))
            .width(ui.available_width() - 8.0)
            .show_ui(ui, |ui| {
                for method in [Method::Path, Method::Direct] {
                    ui.selectable_value(&mut settings.method, method, method_label(method));
                }
            });
    });
}

/// Draws the forecast of time and noise; the pilot runs only while the section is open.
fn forecast_ui(ui: &mut Ui, rendering: &mut Rendering, forecaster: &mut Forecaster, document: &Document) {
    let header = CollapsingHeader::new("Time and noise").id_salt("time and noise");
    header.show_unindented(ui, |ui| {
        let (running, method) = (rendering.is_running(), rendering.settings.method);
        let (scene, assets) = (document.scene(), document.assets());
        let wake = wake(ui.ctx());
        let subject = ForecastSubject { revision: document.revisions().image, method };
        if let Some(wait) = forecaster.update(subject, scene, assets, running, &wake) {
            ui.ctx().request_repaint_after(wait);
        }
        quality::quality_ui(ui, &mut rendering.settings, &scene.camera, forecaster);
    });
}

fn button_row(ui: &mut Ui, rendering: &Rendering, out: &mut Vec<Command>) {
    ui.horizontal(|ui| {
        let half = (ui.available_width() - 8.0) * 0.6;
        if rendering.is_running() {
            let cancel = ui.add(Button::new("Cancel").min_size(vec2(half, 28.0)));
            if cancel.on_hover_text("Stop, and keep what is there").clicked() {
                out.push(Command::CancelRender);
            }
        } else {
            let render = widgets::primary_button(ui, "Render", half);
            widgets::named(ui, &render, "Render the picture");
            if render.on_hover_text("Trace the picture that the camera would take (R)").clicked() {
                out.push(Command::Render);
            }
        }
        let export = Button::new("Export\u{2026}").min_size(vec2(ui.available_width(), 28.0));
        let export = ui.add_enabled(rendering.developed().is_some(), export);
        let export = export.on_disabled_hover_text("Render first");
        if export.on_hover_text("Write the picture as PNG, JPEG, 16-bit TIFF or EXR (Ctrl+E)").clicked() {
            out.push(Command::ExportPicture);
        }
    });
}

fn progress_ui(ui: &mut Ui, rendering: &Rendering) {
    let Some(job) = rendering.job() else { return };
    let (phase, progress) = (job.phase(), job.progress());
    let bar = ProgressBar::new(progress.fraction).desired_height(16.0).fill(theme::ACCENT.gamma_multiply(0.6));
    let bar = ui.add(bar.text(RichText::new(progress_text(phase, &progress)).small()));
    widgets::named(ui, &bar, "Progress");
    if *phase != RenderPhase::Preparing {
        let samples = match job.settings.noise_stops {
            // A coarse picture is there before the first sample of every pixel
            Some(_) if progress.samples < 0.5 => "First samples".to_owned(),
            Some(_) => format!("{:.1} samples on average", progress.samples),
            None => format!("{:.0} of {} samples", progress.samples.floor(), job.settings.spp),
        };
        // A picture of an earlier run has its samples alone.
        let text = if progress.mrays_s > 0.0 {
            format!("{samples}    {:.1} Mrays/s    {}", progress.mrays_s, duration_text(progress.elapsed))
        } else {
            samples
        };
        ui.label(RichText::new(text).weak().small());
    }
}

fn progress_text(phase: &RenderPhase, progress: &Progress) -> String {
    match phase {
        RenderPhase::Preparing => "Preparing\u{2026}".to_owned(),
        RenderPhase::Tracing => match progress.left {
            Some(left) => format!("{:.0} %, {} left", progress.fraction * 100.0, duration_text(left)),
            None => format!("{:.0} %", progress.fraction * 100.0),
        },
        RenderPhase::Done => "Done".to_owned(),
        RenderPhase::Cancelled => "Cancelled".to_owned(),
        RenderPhase::Failed(_) => "Failed".to_owned(),
    }
}

fn thumbnail_ui(ui: &mut Ui, rendering: &Rendering, scene: &Scene, out: &mut Vec<Command>) {
    let Some(texture) = rendering.texture() else { return };
    let room = vec2(ui.available_width(), THUMBNAIL_HEIGHT);
    let Some((width, height)) = rendering.size() else { return };
    let size = vec2(width as f32, height as f32);
    let size = size * (room.x / size.x).min(room.y / size.y);
    ui.vertical_centered(|ui| {
        let image = Image::new((texture, size)).alt_text("Rendered picture").sense(Sense::click());
        let response =
            ui.add(image).on_hover_text("Click to see it large (3)").on_hover_cursor(egui::CursorIcon::ZoomIn);
        if response.clicked() {
            out.push(Command::ShowView(CentralView::Picture));
        }
    });
    if rendering.is_out_of_date(scene) && !rendering.is_running() {
        ui.label(RichText::new(OUT_OF_DATE).color(theme::accent(ui)).small());
    }
}

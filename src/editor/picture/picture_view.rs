//! The view of the rendered picture: fitted or 1:1, with zoom and pan.

use crate::editor::commands::choices::{CompareMode, Comparison};
use crate::editor::commands::command::Command;
use crate::editor::picture::compare::{self, PicturePane};
use crate::editor::picture::mixer;
use crate::editor::picture::rendering::{OUT_OF_DATE, Rendering};
use crate::editor::ui::scopes::{self, ScopeCharts};
use crate::editor::ui::{spot_readout, theme};
use eframe::egui::{self, Color32, Pos2, Rect, RichText, Sense, Ui, Vec2, vec2};

pub use crate::editor::picture::compare::PictureInput;

/// Zoom and offset of the picture in the view.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PictureView {
    /// Screen pixels per picture pixel; none fits the picture to the view.
    zoom: Option<f32>,
    /// Offset of the picture's middle from the view's middle, points.
    offset: Vec2,
    /// The scopes over the picture.
    charts: ScopeCharts,
    /// The mixer lies over the picture.
    shows_mixer: bool,
    /// The comparison with the picture of another variant.
    pub comparison: Comparison,
    /// Place of the wipe's line, as a share of the picture's width.
    wipe: f32,
}

impl Default for PictureView {
    fn default() -> Self {
        PictureView {
            zoom: None,
            offset: Vec2::ZERO,
            charts: ScopeCharts { histogram: true, waveform: false, spot: true },
            shows_mixer: false,
            comparison: Comparison::default(),
            wipe: 0.5,
        }
    }
}

const ZOOM_RANGE: std::ops::RangeInclusive<f32> = 0.05..=16.0;

impl PictureView {
    /// Draws picture and buttons.
    pub fn ui(&mut self, ui: &mut Ui, input: PictureInput<'_>, out: &mut Vec<Command>) {
        let PictureInput { rendering, scene, .. } = input;
        let (rect, response) = ui.allocate_exact_size(ui.available_size(), Sense::click_and_drag());
        crate::editor::ui::widgets::named(ui, &response, "Picture view");
        let painter = ui.painter_at(rect);
        painter.rect_filled(rect, 0.0, theme::SURROUND);
        let (Some(texture), Some(size)) = (rendering.texture(), rendering.size()) else {
            self.empty_ui(ui, rect, rendering, out);
            return;
        };
        let pixels = vec2(size.0 as f32, size.1 as f32) / ui.pixels_per_point();
        // Beside another picture, the wider one has to fit into half of the view
        let is_halved = self.comparison.mode == CompareMode::SideBySide;
        let beside = input.pictures.other(self.comparison).filter(|_| is_halved).and_then(|(_, other)| other.size());
        let widest = beside.map_or(pixels.x, |(w, h)| 2.0 * pixels.x.max(pixels.y * w as f32 / h as f32));
        let fit = (rect.width() / widest).min(rect.height() / pixels.y) * 0.97;
        self.interact(ui, rect, &response, fit);
        let zoom = self.zoom.unwrap_or(fit);
        let place = Rect::from_center_size(rect.center() + self.offset, pixels * zoom);
        let pane = PicturePane { input, texture, place, comparison: self.comparison };
        let (place, visible) = pane.ui(ui, rect, &mut self.wipe);
        if let Some(developed) = rendering.developed() {
            scopes::legend_ui(ui, rect, developed.image.display);
            scopes::charts_ui(ui, rect, self.charts, rendering.charts());
        }
        let pixel = |pointer: Pos2| {
            let at = (pointer - place.min) / place.size() * vec2(size.0 as f32, size.1 as f32);
            (at.min_elem() >= 0.0).then_some((at.x as u32, at.y as u32))
        };
        let bar = self.bar_ui(ui, rect, input, zoom, out);
        if self.shows_mixer {
            mixer::mixer_ui(ui, rect, rendering, scene, out);
        }
        // Drawn after the bar: a widget before it would change the ids of the bar's widgets, which closes their menus
        let pointer = response.hover_pos().filter(|pointer| !bar.contains(*pointer) && visible.contains(*pointer));
        let pixel = pointer.and_then(pixel).filter(|_| self.charts.spot);
        if let Some((pixel, reading)) = pixel.and_then(|pixel| Some((pixel, rendering.read_spot(pixel, scene)?))) {
            spot_readout::spot_ui(ui, rect, &reading, compare::spot_text(pixel, input, self.comparison));
        }
    }

    fn empty_ui(&self, ui: &mut Ui, rect: Rect, rendering: &Rendering, out: &mut Vec<Command>) {
        let middle = Rect::from_center_size(rect.center(), vec2(320.0, 90.0));
        ui.scope_builder(egui::UiBuilder::new().max_rect(middle), |ui| {
            ui.vertical_centered(|ui| {
                if rendering.is_running() {
                    ui.label(RichText::new("The first samples are on their way\u{2026}").weak());
                } else if rendering.is_busy() {
                    ui.label(RichText::new("The picture is being developed\u{2026}").weak());
                } else {
                    ui.label(RichText::new("There is no picture yet.").weak());
                    ui.add_space(6.0);
                    if crate::editor::ui::widgets::primary_button(ui, "Render now", 140.0).on_hover_text("R").clicked()
                    {
                        out.push(Command::Render);
                    }
                }
            });
        });
    }

    fn interact(&mut self, ui: &Ui, rect: Rect, response: &egui::Response, fit: f32) {
        if response.dragged() {
            self.zoom.get_or_insert(fit);
            self.offset += response.drag_delta();
        }
        if response.double_clicked() {
            let zoom = if self.zoom.is_some() { None } else { Some(1.0) };
            (self.zoom, self.offset) = (zoom, Vec2::ZERO);
        }
        let scroll = ui.input(|i| i.smooth_scroll_delta().y);
        if let Some(pointer) = response.hover_pos().filter(|_| scroll != 0.0) {
            let old = self.zoom.unwrap_or(fit);
            let new = (old * (scroll * 0.003).exp()).clamp(*ZOOM_RANGE.start(), *ZOOM_RANGE.end());
            // Keep the point under the pointer.
            let from_middle = pointer - rect.center() - self.offset;
            self.offset -= from_middle * (new / old - 1.0);
            self.zoom = Some(new);
        }
    }

    /// Draws the bar and returns where it is.
    fn bar_ui(&mut self, ui: &mut Ui, rect: Rect, input: PictureInput<'_>, zoom: f32, out: &mut Vec<Command>) -> Rect {
        let bar =
            Rect::from_min_max(rect.left_top() + vec2(8.0, 8.0), Pos2::new(rect.right() - 8.0, rect.top() + 40.0));
        ui.scope_builder(egui::UiBuilder::new().max_rect(bar), |ui| {
            // The bar lies over the picture
            let dark = egui::Frame::new().fill(Color32::from_black_alpha(170)).inner_margin(4).corner_radius(4);
            dark.show(ui, |ui| ui.horizontal(|ui| self.entries_ui(ui, input, zoom, out))).response.rect
        })
        .inner
    }

    fn entries_ui(&mut self, ui: &mut Ui, input: PictureInput<'_>, zoom: f32, out: &mut Vec<Command>) {
        let PictureInput { rendering, scene, .. } = input;
        let entry = |ui: &mut Ui, is_chosen: bool, text: &str, tip: &str| {
            ui.selectable_label(is_chosen, text).on_hover_text(tip).clicked()
        };
        if entry(ui, self.zoom.is_none(), "Fit", "The whole picture (double-click)") {
            (self.zoom, self.offset) = (None, Vec2::ZERO);
        }
        if entry(ui, self.zoom == Some(1.0), "100 %", "One to one (double-click)") {
            (self.zoom, self.offset) = (Some(1.0), Vec2::ZERO);
        }
        ui.label(RichText::new(format!("{:.0} %", zoom * 100.0)).weak());
        denoise_ui(ui, rendering, out);
        let mut display = rendering.display;
        scopes::scopes_ui(ui, &mut display, &mut self.charts);
        out.extend((display != rendering.display).then_some(Command::DisplayPicture(display)));
        compare::menu_ui(ui, input, self.comparison, out);
        ui.toggle_value(&mut self.shows_mixer, "Mixer")
            .on_hover_text("A fader for each light over the picture, without rendering again");
        if !rendering.mix.is_neutral() {
            ui.label(RichText::new("Mixed").color(theme::ACCENT))
                .on_hover_text("The lights are as in the mixer, not as in the studio: apply or reset them there.");
        }
        if rendering.is_out_of_date(scene) && !rendering.is_running() {
            ui.label(RichText::new("Out of date").color(theme::ACCENT)).on_hover_text(OUT_OF_DATE);
            if ui.button("Render again").on_hover_text("R").clicked() {
                out.push(Command::Render);
            }
        }
    }
}

/// Draws the switch of the denoiser, and the mark of a denoised picture.
fn denoise_ui(ui: &mut Ui, rendering: &Rendering, out: &mut Vec<Command>) {
    let switch = ui.selectable_label(rendering.settings.denoise, "Denoise");
    let switch = switch.on_hover_text(
        "Show and export the picture without its noise, as a neural network estimates it. With few samples, fine detail \
         is lost or guessed: hair, textures, small reflections.",
    );
    if switch.clicked() {
        out.push(Command::ToggleDenoise);
    }
    if rendering.is_denoised() {
        ui.label(RichText::new("Denoised").color(theme::ACCENT))
            .on_hover_text("These pixels are an estimate, not traced light. Lights can still be changed.");
    } else if rendering.settings.denoise && rendering.lacks_aovs() {
        ui.label(RichText::new("Not denoised").color(theme::ACCENT)).on_hover_text(
            "The denoiser reads albedo and normals, and the file of this picture has none. Pictures that are exported from \
             this window have them, those of the command line with --aovs or --denoise.",
        );
    }
}

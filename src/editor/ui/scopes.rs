//! Scopes over a picture or a live view: false colour, zebra, histogram and waveform, and their menu.

use crate::editor::ui::{legend, theme, widgets};
use crate::photo::{FALSE_STOPS, Histogram, PictureDisplay, Waveform, clipping_stops, false_color};
use eframe::egui::containers::menu::{MenuButton, MenuConfig};
use eframe::egui::{
    Align2, Button, Checkbox, Color32, ColorImage, FontId, Painter, PopupCloseBehavior, Pos2, Rect, Response, Sense,
    Shape, Slider, Stroke, TextureId, Ui, Vec2, vec2,
};

/// Size of a chart, points.
const CHART: Vec2 = Vec2::new(224.0, 92.0);
/// Space between the charts and the edges of the view, points.
const MARGIN: f32 = 8.0;
/// Largest zebra threshold, thirds of a stop under clipped white.
const MOST_THIRDS: u8 = 9;

/// The read-outs that lie over a view.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct ScopeCharts {
    /// Numbers of pixels by brightness.
    pub histogram: bool,
    /// Brightness from left to right.
    pub waveform: bool,
    /// The light at the spot under the pointer.
    pub spot: bool,
}

impl ScopeCharts {
    /// Returns true if any of them is shown.
    pub fn any(self) -> bool {
        self.histogram || self.waveform || self.spot
    }
}

/// Draws the switch of false colour and the menu of the scopes, and changes what they show.
pub fn scopes_ui(ui: &mut Ui, display: &mut PictureDisplay, charts: &mut ScopeCharts) {
    let is_on = *display == PictureDisplay::FalseColor;
    let tip = "A colour for each stop about middle grey; clipped white is white";
    if ui.add(Button::new("False colour").selected(is_on)).on_hover_text(tip).clicked() {
        *display = if is_on { PictureDisplay::Plain } else { PictureDisplay::FalseColor };
    }
    // A click inside leaves it open, as for the slider
    let stays = MenuConfig::new().close_behavior(PopupCloseBehavior::CloseOnClickOutside);
    let (button, _) = MenuButton::new("Scopes").config(stays).ui(ui, |ui| menu_ui(ui, display, charts));
    button.on_hover_text("Judge the exposure: false colour, zebra, histogram, waveform, spot");
}

fn menu_ui(ui: &mut Ui, display: &mut PictureDisplay, charts: &mut ScopeCharts) {
    ui.set_min_width(220.0);
    let zebra = match *display {
        PictureDisplay::Zebra { .. } => *display,
        _ => PictureDisplay::Zebra { thirds_under: 1 },
    };
    let choices = [
        (PictureDisplay::Plain, "As a photo", "Without colours or stripes"),
        (PictureDisplay::FalseColor, "Stops in false colour", "A colour for each stop about middle grey"),
        (zebra, "Zebra on highlights", "Stripes where a channel is close to clipped white"),
        (
            PictureDisplay::SkinZebra,
            "Zebra on skin tones",
            "Stripes from half a stop to one and a half above middle grey, where light skin usually lies",
        ),
    ];
    for (choice, name, tip) in choices {
        ui.radio_value(display, choice, name).on_hover_text(tip);
        if let PictureDisplay::Zebra { thirds_under } = display
            && choice == zebra
        {
            let slider = Slider::new(thirds_under, 0..=MOST_THIRDS).text("stops under white");
            ui.add(slider.custom_formatter(|thirds, _| format!("{:.1}", thirds / 3.0)));
        }
    }
    ui.separator();
    let entries = [
        (
            &mut charts.histogram,
            "Histogram",
            "How many pixels are how bright, from black to white, and what is clipped",
        ),
        (&mut charts.waveform, "Waveform", "How bright the picture is from left to right, by channel"),
        (
            &mut charts.spot,
            "Spot under the pointer",
            "Stops from middle grey, RGB, lux, and which light gives how much",
        ),
    ];
    for (is_shown, name, tip) in entries {
        ui.add(Checkbox::new(is_shown, name)).on_hover_text(tip);
    }
}

/// The charts of a picture, as far as they are known.
#[derive(Clone, Copy, Debug, Default)]
pub struct ChartData<'a> {
    /// The histogram.
    pub histogram: Option<&'a Histogram>,
    /// The image of the waveform.
    pub waveform: Option<TextureId>,
}

/// Returns the image of a picture's waveform.
pub fn waveform_image(waveform: &Waveform) -> ColorImage {
    ColorImage::from_rgb(waveform.size(), waveform.to_srgb8().as_flattened())
}

/// Paints the charts that are shown into the lower right corner of the view, one above the other.
pub fn charts_ui(ui: &Ui, view: Rect, charts: ScopeCharts, data: ChartData<'_>) {
    let mut place = Rect::from_min_size(view.right_bottom() - CHART - Vec2::splat(MARGIN), CHART);
    if let Some(histogram) = data.histogram.filter(|_| charts.histogram) {
        histogram_ui(ui, view, place, histogram);
        place = place.translate(vec2(0.0, -CHART.y - MARGIN));
    }
    if let Some(waveform) = data.waveform.filter(|_| charts.waveform) {
        waveform_ui(ui, view, place, waveform);
    }
}

/// Draws the background of a chart, and returns its tooltip's area and the room for its curves.
fn chart_frame(ui: &Ui, view: Rect, place: Rect, name: &str, label: &str) -> (Painter, Response, Rect) {
    let response = ui.interact(place, ui.scope_id().with(name), Sense::hover());
    widgets::named(ui, &response, label);
    let painter = ui.painter_at(view);
    painter.rect_filled(place, 4.0, Color32::from_black_alpha(190));
    (painter, response, Rect::from_min_max(place.min + vec2(6.0, 18.0), place.max - vec2(6.0, 4.0)))
}

fn waveform_ui(ui: &Ui, view: Rect, place: Rect, waveform: TextureId) {
    let (painter, response, chart) = chart_frame(ui, view, place, "waveform", "Waveform of the picture");
    response.on_hover_text(
        "Display values from black at the foot to white at the top, for the columns of the picture from left to right. \
         Red, green and blue together are grey.",
    );
    let uv = Rect::from_min_max(Pos2::ZERO, Pos2::new(1.0, 1.0));
    painter.image(waveform, chart, uv, Color32::WHITE);
    // Lines at middle grey and at clipped white
    let grey = f32::from(crate::color::display_srgb8([crate::photo::MIDDLE_GREY; 3])[0]) / 255.0;
    for (level, alpha) in [(grey, 90), (1.0, 60)] {
        let y = chart.bottom() - chart.height() * level;
        painter.hline(chart.x_range(), y, Stroke::new(1.0, Color32::from_white_alpha(alpha)));
    }
    let title = place.min + vec2(6.0, 9.0);
    let text = "waveform, line at middle grey";
    painter.text(title, Align2::LEFT_CENTER, text, FontId::proportional(11.0), Color32::from_gray(140));
}

fn histogram_ui(ui: &Ui, view: Rect, place: Rect, histogram: &Histogram) {
    let (black, white) = (percent(histogram.black_share()), percent(histogram.white_share()));
    let label = format!("Histogram: {black} black, {white} white");
    let (painter, response, chart) = chart_frame(ui, view, place, "histogram", &label);
    response.on_hover_text(
        "Pixels by display value: luminance in grey, and red, green and blue. Black pixels are black in all channels, \
         white ones are clipped in one at least.",
    );
    // The scale ignores black and white, which may hold most of the pixels
    let inner = |counts: &[u32; 256]| counts[1..255].iter().copied().max().unwrap_or(0);
    let most = histogram.rgb.iter().chain([&histogram.luminance]).map(inner).max().unwrap_or(0).max(1) as f32;
    let height = |count: u32| chart.height() * (count as f32 / most).min(1.0).sqrt();
    let x = |code: usize| chart.left() + chart.width() * code as f32 / 255.0;
    for (code, count) in histogram.luminance.iter().enumerate() {
        let foot = Pos2::new(x(code), chart.bottom());
        let stroke = Stroke::new(chart.width() / 255.0 + 0.2, Color32::from_gray(120));
        painter.line_segment([foot, foot - vec2(0.0, height(*count))], stroke);
    }
    let colors = [Color32::from_rgb(226, 80, 72), Color32::from_rgb(92, 190, 92), Color32::from_rgb(90, 130, 240)];
    for (counts, color) in histogram.rgb.iter().zip(colors) {
        let points = counts.iter().enumerate().map(|(code, count)| Pos2::new(x(code), chart.bottom() - height(*count)));
        painter.add(Shape::line(points.collect(), Stroke::new(1.0, color)));
    }
    let mark = |at: Pos2, align: Align2, text: String, share: f32| {
        let color = if share > 0.0 { theme::ACCENT } else { Color32::from_gray(140) };
        painter.text(at, align, text, FontId::proportional(11.0), color);
    };
    mark(place.min + vec2(6.0, 9.0), Align2::LEFT_CENTER, format!("{black} black"), histogram.black_share());
    let right = place.right_top() + vec2(-6.0, 9.0);
    mark(right, Align2::RIGHT_CENTER, format!("{white} white"), histogram.white_share());
}

/// Paints the legend of the false colours into the lower left corner, if they are shown.
pub fn legend_ui(ui: &Ui, view: Rect, display: PictureDisplay) {
    if display != PictureDisplay::FalseColor {
        return;
    }
    let band = |stops: i32| {
        let text = match stops {
            0 => "middle grey, 18 %".to_owned(),
            -1 | 1 => format!("{stops:+} stop"),
            _ => format!("{stops:+} stops"),
        };
        (false_color(stops as f32), text)
    };
    let white = ([255; 3], format!("clipped, from {:+.1} stops", clipping_stops()));
    let lines: Vec<_> = [white].into_iter().chain((FALSE_STOPS.0..=FALSE_STOPS.1).rev().map(band)).collect();
    legend::paint(&ui.painter_at(view), view, "Stops from middle grey", &lines);
}

fn percent(share: f32) -> String {
    match share * 100.0 {
        0.0 => "0 %".to_owned(),
        percent if percent < 0.1 => "< 0.1 %".to_owned(),
        percent if percent < 10.0 => format!("{percent:.1} %"),
        percent => format!("{percent:.0} %"),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn small_shares_are_not_rounded_to_nothing() {
        assert_eq!([0.0, 2e-4, 0.004, 0.25].map(percent), ["0 %", "< 0.1 %", "0.4 %", "25 %"]);
    }
}

//! Scopes over the rendered picture: histogram, false colour, zebra, and the read-out under the pointer.

use crate::editor::commands::command::Command;
use crate::editor::picture::rendering::{Rendering, SpotReading};
use crate::editor::ui::{legend, theme, widgets};
use crate::photo::{FALSE_STOPS, Histogram, PictureDisplay, clipping_stops, false_color};
use eframe::egui::containers::menu::{MenuButton, MenuConfig};
use eframe::egui::{
    Align2, Checkbox, Color32, FontId, Frame, PopupCloseBehavior, Pos2, Rect, RichText, Sense, Shape, Slider, Stroke,
    Ui, UiBuilder, vec2,
};

/// Size of the histogram, points.
const HISTOGRAM: (f32, f32) = (224.0, 92.0);
/// Largest zebra threshold, thirds of a stop under clipped white.
const MOST_THIRDS: u8 = 9;
/// Share of a light under which the read-out leaves it out.
const LEAST_SHARE: f32 = 0.005;

/// Draws the menu of the scopes.
pub fn menu_ui(ui: &mut Ui, rendering: &Rendering, shows_histogram: &mut bool, out: &mut Vec<Command>) {
    let shown = rendering.display;
    let title = match shown {
        PictureDisplay::Plain => "Exposure",
        PictureDisplay::FalseColor => "False colour",
        PictureDisplay::Zebra { .. } => "Zebra",
        PictureDisplay::SkinZebra => "Skin zebra",
    };
    // A click inside leaves it open, as for the slider
    let stays = MenuConfig::new().close_behavior(PopupCloseBehavior::CloseOnClickOutside);
    let (button, _) = MenuButton::new(title).config(stays).ui(ui, |ui| {
        ui.set_min_width(220.0);
        let zebra = match shown {
            PictureDisplay::Zebra { .. } => shown,
            _ => PictureDisplay::Zebra { thirds_under: 1 },
        };
        let choices = [
            (PictureDisplay::Plain, "As a photo", "The picture as it will be exported"),
            (PictureDisplay::FalseColor, "False colour", "A colour for each stop about middle grey"),
            (zebra, "Zebra on highlights", "Stripes where a channel is close to clipped white"),
            (
                PictureDisplay::SkinZebra,
                "Zebra on skin tones",
                "Stripes from half a stop to one and a half above middle grey, where light skin usually lies",
            ),
        ];
        for (display, name, tip) in choices {
            if ui.radio(shown == display, name).on_hover_text(tip).clicked() {
                out.push(Command::DisplayPicture(display));
            }
            if let PictureDisplay::Zebra { thirds_under } = display
                && display == shown
            {
                threshold_ui(ui, thirds_under, out);
            }
        }
        ui.separator();
        ui.add(Checkbox::new(shows_histogram, "Histogram"))
            .on_hover_text("How many pixels are how bright, from black to white, with the clipped shares");
    });
    button.on_hover_text("Judge the exposure: false colour, zebra, histogram");
}

/// Draws the slider of the zebra's threshold.
fn threshold_ui(ui: &mut Ui, mut thirds_under: u8, out: &mut Vec<Command>) {
    let slider = Slider::new(&mut thirds_under, 0..=MOST_THIRDS).text("stops under white");
    if ui.add(slider.custom_formatter(|thirds, _| format!("{:.1}", thirds / 3.0))).changed() {
        out.push(Command::DisplayPicture(PictureDisplay::Zebra { thirds_under }));
    }
}

/// Paints the histogram into the lower right corner of the view.
pub fn histogram_ui(ui: &Ui, view: Rect, histogram: &Histogram) {
    let size = vec2(HISTOGRAM.0, HISTOGRAM.1);
    let place = Rect::from_min_size(view.right_bottom() - size - vec2(8.0, 8.0), size);
    let response = ui.interact(place, ui.scope_id().with("histogram"), Sense::hover());
    let (black, white) = (percent(histogram.black_share()), percent(histogram.white_share()));
    widgets::named(ui, &response, &format!("Histogram: {black} black, {white} white"));
    response.on_hover_text(
        "Pixels by display value: luminance in grey, and red, green and blue. Black pixels are black in all channels, \
         white ones are clipped in one at least.",
    );

    let painter = ui.painter_at(view);
    painter.rect_filled(place, 4.0, Color32::from_black_alpha(190));
    let chart = Rect::from_min_max(place.min + vec2(6.0, 18.0), place.max - vec2(6.0, 4.0));
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

/// Paints the legend of the false colours, if the picture shows them.
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

/// Draws the light at the spot under the pointer, below the bar of the view.
/// `comparison` is the difference from another picture, in words.
pub fn spot_ui(ui: &mut Ui, view: Rect, reading: &SpotReading, comparison: Option<String>) {
    let comparison = comparison.map_or(String::new(), |text| format!("    {text}"));
    let place = Rect::from_min_max(view.left_top() + vec2(8.0, 46.0), Pos2::new(view.right() - 8.0, view.top() + 76.0));
    ui.scope_builder(UiBuilder::new().max_rect(place), |ui| {
        let dark = Frame::new().fill(Color32::from_black_alpha(170)).inner_margin(4).corner_radius(4);
        dark.show(ui, |ui| ui.label(RichText::new(spot_text(reading) + &comparison).small()));
    });
}

/// Returns the light at a spot in words: `+1.2 stops   RGB 201 180 170   Key 62 %, Fill 30 %`.
fn spot_text(SpotReading { spot, lights }: &SpotReading) -> String {
    let [r, g, b] = spot.codes();
    let stops = match spot.stops() {
        stops if stops.is_finite() => format!("{stops:+.1} stops from middle grey"),
        _ => "black".to_owned(),
    };
    let share = |(name, share): &(String, f32)| format!("{name} {:.0} %", share * 100.0);
    let lights: Vec<String> = lights.iter().filter(|(_, share)| *share >= LEAST_SHARE).map(share).collect();
    format!("{stops}    RGB {r} {g} {b}    {}", lights.join(", "))
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
    use crate::photo::Spot;

    #[test]
    fn a_spot_is_told_in_stops_codes_and_lights() {
        let lights = vec![("Key".to_owned(), 0.7), ("Fill".to_owned(), 0.298), ("Rim".to_owned(), 0.002)];
        let reading = SpotReading { spot: Spot { rgb: [0.36; 3] }, lights };
        assert_eq!(spot_text(&reading), "+1.0 stops from middle grey    RGB 162 162 162    Key 70 %, Fill 30 %");
        let black = SpotReading { spot: Spot { rgb: [0.0; 3] }, lights: Vec::new() };
        assert_eq!(spot_text(&black), "black    RGB 0 0 0    ");
    }

    #[test]
    fn small_shares_are_not_rounded_to_nothing() {
        assert_eq!([0.0, 2e-4, 0.004, 0.25].map(percent), ["0 %", "< 0.1 %", "0.4 %", "25 %"]);
    }
}

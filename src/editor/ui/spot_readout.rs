//! The read-out of the light at the spot under the pointer.

use crate::photo::Spot;
use crate::photo::text::three_digits;
use crate::photo::thirds::Dial;
use eframe::egui::{Color32, Frame, Pos2, Rect, RichText, Ui, UiBuilder, vec2};

/// Share of a light under which the read-out leaves it out.
const LEAST_SHARE: f32 = 0.005;

/// Light on a surface.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SpotLux {
    /// Luminous exposure, lux seconds.
    pub lux_s: f32,
    /// The camera's shutter, seconds.
    pub shutter_s: f32,
}

/// The light at a spot of a picture.
#[derive(Clone, Debug, PartialEq)]
pub struct SpotReading {
    /// The spot.
    pub spot: Spot,
    /// Light on the surface there; none where that is not known.
    pub lux: Option<SpotLux>,
    /// Names of the lights with their share of the light, the largest first.
    pub lights: Vec<(String, f32)>,
}

impl SpotReading {
    /// Returns a reading with the amounts of light of each light, in any unit.
    pub fn new(spot: Spot, lux: Option<SpotLux>, mut lights: Vec<(String, f32)>) -> Self {
        let sum: f32 = lights.iter().map(|(_, light)| light).sum();
        lights.iter_mut().for_each(|(_, light)| *light /= sum.max(f32::MIN_POSITIVE));
        lights.sort_by(|a, b| b.1.total_cmp(&a.1));
        SpotReading { spot, lux, lights }
    }

    /// Returns it in words: `+1.2 stops   RGB 201 180 170   1250 lx over 1/125   Key 62 %, Fill 30 %`.
    pub fn text(&self) -> String {
        let [r, g, b] = self.spot.codes();
        let mut parts = vec![match self.spot.stops() {
            stops if stops.is_finite() => format!("{stops:+.1} stops from middle grey"),
            _ => "black".to_owned(),
        }];
        parts.push(format!("RGB {r} {g} {b}"));
        parts.extend(self.lux.map(|SpotLux { lux_s, shutter_s }| {
            format!("{} lx over {}", three_digits(rounded(lux_s / shutter_s)), Dial::Shutter.label(shutter_s))
        }));
        let shown = self.lights.iter().filter(|(_, share)| *share >= LEAST_SHARE);
        let lights: Vec<String> = shown.map(|(name, share)| format!("{name} {:.0} %", share * 100.0)).collect();
        parts.extend((!lights.is_empty()).then(|| lights.join(", ")));
        parts.join("    ")
    }
}

/// Rounds to three significant digits: the error of a quick reading is about 1 %.
fn rounded(lux: f32) -> f32 {
    let step = 10.0_f32.powf((lux.log10() - 2.0).floor());
    if step.is_normal() { (lux / step).round() * step } else { lux }
}

/// Draws the light at the spot under the pointer, below the bar of the view.
/// `comparison` is the difference from another picture, in words.
pub fn spot_ui(ui: &mut Ui, view: Rect, reading: &SpotReading, comparison: Option<String>) {
    let comparison = comparison.map_or(String::new(), |text| format!("    {text}"));
    let place = Rect::from_min_max(view.left_top() + vec2(8.0, 46.0), Pos2::new(view.right() - 8.0, view.top() + 76.0));
    ui.scope_builder(UiBuilder::new().max_rect(place), |ui| {
        let dark = Frame::new().fill(Color32::from_black_alpha(170)).inner_margin(4).corner_radius(4);
        dark.show(ui, |ui| ui.label(RichText::new(reading.text() + &comparison).small()))
            .response
            .on_hover_text("Lux are those on the surface, as if it were matte, averaged over the time of the shutter");
    });
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_spot_is_told_in_stops_codes_lux_and_lights() {
        let lights = vec![("Fill".to_owned(), 2.98), ("Key".to_owned(), 7.0), ("Rim".to_owned(), 0.02)];
        let lux = Some(SpotLux { lux_s: 10.0, shutter_s: 1.0 / 125.0 });
        let reading = SpotReading::new(Spot { rgb: [0.36; 3] }, lux, lights);
        let text = "+1.0 stops from middle grey    RGB 162 162 162    1250 lx over 1/125    Key 70 %, Fill 30 %";
        assert_eq!(reading.text(), text);
        assert_eq!([13_969.0, 1250.4, 9.876, 0.0].map(rounded), [14_000.0, 1250.0, 9.88, 0.0]);
        let black = SpotReading::new(Spot { rgb: [0.0; 3] }, None, Vec::new());
        assert_eq!(black.text(), "black    RGB 0 0 0");
    }
}

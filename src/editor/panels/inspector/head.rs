//! The rows of a light's head and of its dial.

use crate::editor::document::readout;
use crate::editor::panels::gear::head_text;
use crate::editor::ui::theme;
use crate::editor::ui::widgets::{self, fact, row};
use crate::gear::{GearList, HeadModel, gear_use};
use crate::photo::text::signed_stops;
use crate::photo::thirds::Dial;
use crate::photo::{dial_from_text, dial_text, light_dial_text};
use crate::scene::{Assets, BeyondDial, Head, HeadDial, Light, Output, Scene};
use eframe::egui::{ComboBox, Label, RichText, Slider, SliderClamping, Ui};

/// Draws the list of heads: those that the user owns come first.
pub(super) fn head_row(ui: &mut Ui, scene: &Scene, gear: &GearList, light: &mut Light) {
    let text = light.head.as_ref().map_or("Any", |head| head.name.as_str()).to_owned();
    let mut chosen = None;
    row(ui, "Head", "The lamp behind it: its power, its colour and the scale of its dial", |ui| {
        let list = ComboBox::from_id_salt("head").selected_text(text).width(ui.available_width() - 8.0).height(420.0);
        let list = list.show_ui(ui, |ui| {
            if ui.selectable_label(light.head.is_none(), "Any: power and colour by hand").clicked() {
                chosen = Some(None);
            }
            let (own, others): (Vec<_>, Vec<_>) = gear.heads.iter().partition(|model| model.owned > 0);
            for (heading, models) in [("My gear", own), ("Others", others)] {
                if models.is_empty() {
                    continue;
                }
                ui.separator();
                ui.weak(heading);
                for model in models {
                    let is_it = light.head.as_ref().is_some_and(|head| head.name == model.head.name);
                    let label = ui.selectable_label(is_it, &model.head.name);
                    if label.on_hover_text(model_tip(model)).clicked() {
                        chosen = Some(Some(model));
                    }
                }
            }
        });
        widgets::named(ui, &list.response, "Head");
    });
    match chosen {
        Some(Some(model)) => model.mount(light),
        Some(None) => light.head = None,
        None => {}
    }
    let short = light.head.as_ref().and_then(|head| {
        gear_use(scene, gear).into_iter().find(|each| each.name == head.name && each.owned > 0)?.shortage()
    });
    if let Some(text) = short {
        row(ui, "", "", |ui| ui.add(Label::new(RichText::new(text).color(theme::accent(ui)).small()).wrap()));
    }
}

fn model_tip(model: &HeadModel) -> String {
    format!("{}. {}.\nSource: {}", model.power_text(), head_text(&model.head), model.source)
}

/// Draws what is known of the head of a light.
pub(super) fn head_facts(ui: &mut Ui, gear: &GearList, head: &Head, output: &Output) {
    let model = gear.head(&head.name).filter(|model| model.output == *output);
    let text = match model {
        Some(model) => model.power_text(),
        None => "as in the studio's file".to_owned(),
    };
    let tip = model.map_or_else(|| head_text(head), model_tip);
    fact(ui, "Full power", &tip, text);
}

/// Draws the power dial: a slider in the settings of the head, buttons in thirds, and a button that meters. A head that is
/// not known has tenths of a stop.
pub(super) fn dial_rows(ui: &mut Ui, scene: &Scene, assets: &Assets, light: &mut Light) {
    let head = light.head.as_ref().map(|head| head.dial);
    let tip = match head {
        Some(_) => "As the head displays it",
        None => "Stops from full power: 0 is full, \u{2212}1 half, \u{2212}2 a quarter",
    };
    let stops = &mut light.power.dial_stops;
    row(ui, "Dial", tip, |ui| {
        ui.spacing_mut().slider_width = (ui.available_width() - 84.0).max(60.0);
        let mut shown = *stops;
        let range = head.map_or(-9.0..=1.0, |dial| dial.range());
        let slider = Slider::new(&mut shown, range)
            .clamping(SliderClamping::Never)
            .update_while_editing(false)
            .custom_formatter(move |v, _| match &head {
                Some(dial) => dial_text(dial, v as f32),
                None => signed_stops(v as f32),
            })
            .custom_parser(move |text| match &head {
                Some(dial) => dial_from_text(dial, text).map(f64::from),
                None => text.replace('\u{2212}', "-").trim().parse().ok(),
            });
        let slider = if head.is_none() { slider.step_by(0.1) } else { slider };
        let response = ui.name_inputs("Dial", |ui| ui.add(slider));
        let response = response.on_hover_text("Drag, or click the number and type it");
        if response.changed() && shown.is_finite() {
            *stops = head.map_or(shown, |dial| dial.nearest(shown));
        }
    });
    row(ui, "", "", |ui| {
        let display = light_dial_text(light, light.power.dial_stops);
        let stops = &mut light.power.dial_stops;
        ui.spacing_mut().item_spacing.x = 2.0;
        for (sign, name, thirds) in
            [("\u{2212}\u{2153}", "A third of a stop less", -1.0), ("+\u{2153}", "A third of a stop more", 1.0)]
        {
            if widgets::small_button(ui, sign, name).on_hover_text(name).clicked() {
                let by_thirds = ((*stops * 3.0 + thirds).round()) / 3.0;
                *stops = head.map_or(by_thirds, |dial| dial.moved(*stops, thirds / 3.0));
            }
        }
        ui.add_space(6.0);
        let (part, tip) = match head {
            Some(_) => (format!("{} stops", signed_stops(*stops)), "From full power"),
            None => (display, "As most heads display it"),
        };
        ui.add(Label::new(RichText::new(part).weak())).on_hover_text(tip);
        ui.add_space(6.0);
        let tip = format!(
            "Turns the dial so that a meter at the aim reads the camera's {}",
            Dial::FNumber.label(scene.camera.f_number)
        );
        if ui.button("Meter").on_hover_text(tip).clicked() {
            let metered = readout::dial_for(scene, assets, light, 0.0);
            light.power.dial_stops = head.map_or(metered, |dial| dial.nearest(metered));
        }
    });
    if let Some(text) = beyond_text(head.as_ref(), light.power.dial_stops) {
        row(ui, "", "", |ui| ui.add(Label::new(RichText::new(text).color(theme::accent(ui)).small()).wrap()));
    }
}

/// Returns a sentence about a setting that the head does not have; none if it has it. Of a head that is not known only full
/// power is.
fn beyond_text(head: Option<&HeadDial>, stops: f32) -> Option<String> {
    match (head.unwrap_or(&HeadDial::UNKNOWN).beyond(stops)?, head) {
        (BeyondDial::Full, _) => Some("More than full power".to_owned()),
        (BeyondDial::Lowest, Some(dial)) => {
            Some(format!("Less than {}, the lowest of the head", dial_text(dial, dial.lowest_stops)))
        }
        (BeyondDial::Lowest, None) => None,
    }
}

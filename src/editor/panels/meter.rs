//! The read-out of the light meter over the viewport.

use crate::editor::commands::command::Command;
use crate::editor::document::item::Item;
use crate::editor::ui::theme;
use crate::editor::ui::widgets;
use crate::photo::meter::{LUX_PER_FOOT_CANDLE, LightReading, Reading, nearest_third};
use crate::photo::text::{signed_stops, three_digits};
use crate::photo::thirds::Dial;
use crate::scene::{Meter, Receptor};
use eframe::egui::{self, Context, Frame, Grid, Id, Label, Rect, RichText, Ui, vec2};

/// Width of the read-out, points.
const WIDTH: f32 = 300.0;

/// Draws the read-out: a small movable window, initially in the upper left corner of the view.
pub fn meter_ui(
    ctx: &Context,
    view: Rect,
    meter: &Meter,
    reading: Option<&Result<Reading, String>>,
    out: &mut Vec<Command>,
) {
    let title = match meter.receptor {
        Receptor::Flat => "Light meter, flat",
        Receptor::Dome => "Light meter, dome",
    };
    let window = egui::Window::new(RichText::new(title).size(14.0).strong())
        .id(Id::unique("light meter"))
        .default_pos(view.min + vec2(10.0, 84.0))
        .constrain_to(view)
        .resizable(false)
        .default_width(WIDTH)
        .frame(Frame::window(&ctx.global_style()).inner_margin(8));
    window.show(ctx, |ui| {
        // Readings of other lengths leave the buttons where they are
        ui.set_width(WIDTH);
        match reading {
            Some(Ok(reading)) => reading_ui(ui, reading),
            Some(Err(message)) => drop(ui.label(message)),
            None => drop(ui.label(RichText::new("Reading\u{2026}").weak())),
        }
        ui.horizontal_wrapped(|ui| {
            let button = ui.small_button("Select the meter");
            if button.on_hover_text("Move it with its handles, set it up in the inspector").clicked() {
                out.push(Command::Select(Some(Item::Meter)));
            }
            let button = ui.small_button("Set dials by wish\u{2026}");
            if button.on_hover_text("Name the f-number of the key and stops of the others").clicked() {
                out.push(Command::ToggleDials);
            }
        });
    });
}

fn reading_ui(ui: &mut Ui, reading: &Reading) {
    if reading.total_lux_s() <= 0.0 {
        ui.label("No light reaches the meter.");
        return;
    }
    let n = reading.f_number();
    ui.horizontal(|ui| {
        ui.label(RichText::new(nearest_third(n)).size(26.0).strong());
        ui.vertical(|ui| {
            let settings = format!(
                "at ISO {}, {}{}",
                Dial::Iso.label(reading.iso),
                Dial::Shutter.label(reading.shutter_s),
                reading.compensation()
            );
            ui.add(Label::new(RichText::new(settings).weak()).wrap())
                .on_hover_text("The f-number to set on the lens: it makes up for ND filter and bellows factor");
            ui.label(RichText::new(format!("f/{n:.2} exactly, EV {:.1}", reading.ev100())).weak());
        });
    });
    Grid::new("light meter lights").num_columns(4).spacing([8.0, 2.0]).show(ui, |ui| {
        for light in &reading.lights {
            light_row(ui, reading, light);
        }
    });
    ui.add_space(4.0);
    for ratio in reading.ratios().into_iter().flatten() {
        let text = format!("{}  {}:1  ({:.1} stops)", ratio.name, three_digits(ratio.value), ratio.stops());
        ui.label(text).on_hover_text("By the roles of the lights");
    }
    if let Some(share) = reading.flash_fraction() {
        ui.label(format!("Flash {:.0} %, continuous {:.0} %", 100.0 * share, 100.0 - 100.0 * share))
            .on_hover_text("Parts of the exposure: the continuous one follows the shutter");
    }
    let (direct, bounced) = reading.total_lux();
    let lux = direct + bounced;
    let [lux_s, foot_candles] = [reading.total_lux_s(), lux / LUX_PER_FOOT_CANDLE].map(three_digits);
    let amounts = format!("{lux_s} lx s = {} lx = {foot_candles} fc", three_digits(lux));
    let tip = "In one exposure; in lux and foot-candles as steady light at this shutter would give it";
    ui.label(RichText::new(amounts).weak()).on_hover_text(tip);
    let error = reading.relative_error().unwrap_or(0.0);
    let quality = format!("{:.0} % bounced, good to {:.1} %", 100.0 * bounced / lux, (100.0 * error).max(0.1));
    ui.label(RichText::new(quality).weak());
}

/// Draws a row of a light: role, name, stops against the key, fraction of the exposure.
fn light_row(ui: &mut Ui, reading: &Reading, light: &LightReading) {
    let key = reading.key().is_some_and(|key| key.light == light.light);
    let color = light.role.map_or(egui::Color32::GRAY, theme::role_color);
    widgets::swatch(ui, color, vec2(6.0, 14.0));
    ui.allocate_ui_with_layout(vec2(130.0, 16.0), egui::Layout::left_to_right(egui::Align::Center), |ui| {
        ui.set_min_width(130.0);
        ui.add(Label::new(&light.name).truncate());
    });
    let stops = match reading.stops_over_key(light) {
        _ if key => "key".to_owned(),
        Some(stops) => format!("{} stops", signed_stops(stops)),
        None => "dark".to_owned(),
    };
    let [direct, bounced] = [light.direct, light.bounced].map(three_digits);
    let unit = if light.flash { "lx s" } else { "lx" };
    let tip = format!("Against the key. Direct {direct} {unit}, bounced {bounced} {unit}");
    ui.label(stops).on_hover_text(tip);
    let share = 100.0 * reading.lux_s(light) / reading.total_lux_s();
    ui.label(RichText::new(format!("{share:.0} %")).weak()).on_hover_text("Part of the exposure");
    ui.end_row();
}

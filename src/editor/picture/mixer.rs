//! The mixer over the finished picture: a fader for each light, without tracing.

use crate::editor::commands::command::Command;
use crate::editor::document::light_mix::{Fader, MixerRow};
use crate::editor::picture::rendering::Rendering;
use crate::editor::ui::theme;
use crate::editor::ui::widgets::{self, NumberField};
use crate::photo::text::signed_stops;
use crate::scene::{ColorSource, Scene};
use eframe::egui::{
    Button, Color32, Frame, Grid, Label, Pos2, Rect, RichText, ScrollArea, Slider, Ui, UiBuilder, vec2,
};

/// Travel of a fader to both sides, thirds of a stop.
const TRAVEL: i32 = 9;
const WIDTH: f32 = 440.0;
const ROW_HEIGHT: f32 = 28.0;
/// Height of heading and buttons.
const FRAME_HEIGHT: f32 = 72.0;

/// Draws the mixer into the lower left corner of the view.
pub fn mixer_ui(ui: &mut Ui, view: Rect, rendering: &Rendering, scene: &Scene, out: &mut Vec<Command>) {
    let rows = rendering.mixer_rows(scene);
    let room = view.shrink(8.0);
    let height = (FRAME_HEIGHT + ROW_HEIGHT * rows.len() as f32).min(room.height() - 80.0);
    let size = vec2(WIDTH.min(room.width()), height);
    let place = Rect::from_min_size(Pos2::new(room.left(), room.bottom() - size.y), size);
    ui.scope_builder(UiBuilder::new().max_rect(place).id_salt("mixer"), |ui| {
        let dark = Frame::new().fill(Color32::from_black_alpha(205)).inner_margin(8).corner_radius(4);
        dark.show(ui, |ui| {
            ui.set_min_size(place.shrink(8.0).size());
            ui.horizontal(|ui| {
                ui.label(RichText::new("Mixer").strong());
                ui.label(RichText::new("changes the picture, not the studio, until it is applied").weak().small());
            });
            let rows_height = (ui.available_height() - 34.0).max(ROW_HEIGHT);
            ScrollArea::vertical().max_height(rows_height).show(ui, |ui| {
                Grid::new("faders").num_columns(6).spacing(vec2(8.0, 4.0)).show(ui, |ui| {
                    for row in &rows {
                        row_ui(ui, row, rendering, scene, out);
                        ui.end_row();
                    }
                });
            });
            buttons_ui(ui, rendering, scene, out);
        });
    });
}

fn buttons_ui(ui: &mut Ui, rendering: &Rendering, scene: &Scene, out: &mut Vec<Command>) {
    ui.horizontal(|ui| {
        let can_apply = rendering.mix.action(scene).is_some();
        let apply = ui.add_enabled(can_apply, Button::new("Apply to studio"));
        let tip =
            "Write the faders back to the dials of the heads, as one step that can be undone. A solo is not written.";
        if apply.on_hover_text(tip).clicked() {
            out.push(Command::ApplyMix);
        }
        let reset = ui.add_enabled(!rendering.mix.is_neutral(), Button::new("Reset"));
        if reset.on_hover_text("Forget the faders: the picture shows the studio's lights again").clicked() {
            out.push(Command::ResetMix);
        }
    });
}

/// Draws the fader of a light or of a group.
fn row_ui(ui: &mut Ui, row: &MixerRow, rendering: &Rendering, scene: &Scene, out: &mut Vec<Command>) {
    let Some(first) = row.lights.first().and_then(|id| scene.light(*id)) else { return };
    let (mix, name) = (&rendering.mix, &row.name);
    let before = mix.fader(first.id);
    let mut fader = before;
    widgets::role_name(ui, Some(theme::role_color(first.role)), name, 112.0);
    let slider = ui.add_enabled_ui(row.has_layer, |ui| {
        ui.spacing_mut().slider_width = 104.0;
        let slider = Slider::new(&mut fader.thirds, -TRAVEL..=TRAVEL).show_value(false).trailing_fill(false);
        let slider = ui.add(slider);
        widgets::named(ui, &slider, &format!("Fader of {name}"));
        slider
            .on_hover_text("Thirds of a stop. Double-click: back to the studio's dial")
            .on_disabled_hover_text(NO_LAYER)
    });
    if slider.inner.double_clicked() {
        fader.thirds = 0;
    }
    let stops = RichText::new(format!("{} stops", signed_stops(fader.thirds as f32 / 3.0))).small();
    ui.add_sized(vec2(62.0, 18.0), Label::new(stops));
    kelvin_ui(ui, row, first.color.source, &mut fader);
    ui.horizontal(|ui| {
        ui.spacing_mut().item_spacing.x = 2.0;
        let entries = [(&mut fader.muted, "M", "Mute"), (&mut fader.soloed, "S", "Solo")];
        for (is_on, text, what) in entries {
            let button = Button::selectable(*is_on, text);
            let button = ui.add_enabled(row.has_layer, button);
            widgets::named(ui, &button, &format!("{what} {name} in the mix"));
            if button.on_hover_text(format!("{what} in the picture alone")).clicked() {
                *is_on = !*is_on;
            }
        }
    });
    let lights = row.lights.iter().filter_map(|id| scene.light(*id));
    match { lights }.find_map(|light| mix.out_of_range(light)) {
        Some(why) => {
            ui.label(RichText::new("beyond the dial").color(theme::ACCENT).small()).on_hover_text(why);
        }
        None => {
            ui.label("");
        }
    }
    if fader != before {
        out.push(Command::MixLights(row.lights.clone(), fader));
    }
}

/// Tooltip of a light whose light is not in the film.
const NO_LAYER: &str = "The picture has no light of it: render again to mix it.";
const KELVIN: NumberField = NumberField::new(20.0, 1000.0, 25_000.0, 0, " K");

/// Draws the colour temperature of a light; nothing for groups and coloured lights.
fn kelvin_ui(ui: &mut Ui, row: &MixerRow, source: ColorSource, fader: &mut Fader) {
    let (ColorSource::Kelvin(of_studio), [_]) = (source, &row.lights[..]) else {
        ui.label("");
        return;
    };
    let mut kelvin = fader.kelvin.unwrap_or(of_studio);
    let field = ui.add_enabled_ui(row.has_layer, |ui| KELVIN.ui(ui, &mut kelvin)).inner;
    widgets::named(ui, &field, &format!("Kelvin of {}", row.name));
    field.on_hover_text("Colour temperature of the source: drag or type");
    if kelvin != fader.kelvin.unwrap_or(of_studio) {
        fader.kelvin = (kelvin != of_studio).then_some(kelvin);
    }
}

//! The inspector of a light.

use super::power::{self, PowerUnit};
use super::{InspectorContext, aim, environment, gel, head, measured, modifier, text_ui, title};
use crate::color::rgb_from_kelvin;
use crate::editor::commands::choices::PlaceLightBy;
use crate::editor::commands::command::Command;
use crate::editor::document::action::Action;
use crate::editor::document::item::Item;
use crate::editor::document::readout;
use crate::editor::ui::lengths;
use crate::editor::ui::theme;
use crate::editor::ui::widgets::{self, DEGREES, DISTANCE, METRES, NumberField, fact, row, section};
use crate::gear::GearList;
use crate::photo::light::axial_intensity;
use crate::photo::text::{signed_stops, three_digits};
use crate::photo::thirds::Dial;
use crate::photo::{LightBearing, exposure, light_rgb};
use crate::scene::{Assets, ColorSource, Emitter, Light, LightId, Output, Role, Scene};
use eframe::egui::{ComboBox, RichText, Slider, SliderClamping, Ui, vec2};

/// Draws the inspector of a light.
pub(super) fn light_ui(ui: &mut Ui, context: &mut InspectorContext<'_>, id: LightId) {
    let (scene, assets) = (context.document.scene(), context.document.assets());
    let Some(original) = scene.light(id) else { return };
    let mut light = original.clone();
    title(ui, &original.name, light.emitter.label());
    let mut new_name = None;
    row(ui, "Name", "Names are unique in a studio", |ui| new_name = text_ui(ui, "name", &original.name, false));
    row(ui, "Switch", "Whether it shines", |ui| {
        widgets::choice(ui, &mut light.on, &[(true, "On", "It shines"), (false, "Off", "It is dark")]);
        let why = match (original.on, original.muted, scene.is_silenced(original)) {
            (false, true, _) => "muted for now",
            (false, _, true) => "silent: others shine alone",
            _ => "",
        };
        ui.add_space(6.0);
        ui.label(RichText::new(why).color(theme::bad(ui)).small());
    });
    role_row(ui, &mut light);
    modifier::kind_rows(ui, scene, assets, &mut light);
    measured::measured_rows(ui, assets, &mut light, context.out);
    environment::environment_rows(ui, assets, &mut light, context.out);
    ui.separator();
    section(ui, "Power", true, |ui| power_rows(ui, (scene, assets), context.gear, &mut light));
    section(ui, "Colour", true, |ui| color_rows(ui, scene, &mut light));
    section(ui, "At the subject", true, |ui| readouts(ui, scene, assets, &light));
    section(ui, "Place and aim", true, |ui| {
        if light.emitter == Emitter::Surround {
            ui.label(RichText::new("It shines from everywhere, so it has no place.").weak());
            return;
        }
        aiming_row(ui, &light, context.out);
        // A locked light shows its position but cannot be moved.
        ui.add_enabled_ui(!light.locked, |ui| {
            place_rows(ui, scene, &mut light);
            aim::aim_rows(ui, scene, assets, light.position, &mut light.aim);
            row(ui, "Roll", "Turn about its own axis: a strip from upright to level", |ui| {
                DEGREES.ui(ui, &mut light.roll_deg)
            });
        });
    });
    section(ui, "Loss, grid and flaps", true, |ui| modifier::modifier_rows(ui, scene, &mut light));
    if light != *original {
        context.out.push(Command::Apply(Action::SetLight(Box::new(light))));
    }
    // After the other changes, which have the old name: a click on their controls ends the typing
    context.out.extend(new_name.map(|name| Command::Apply(Action::Rename(Item::Light(id), name))));
}

fn role_row(ui: &mut Ui, light: &mut Light) {
    row(ui, "Role", "Its part in the set-up: a colour in lists and views. It changes nothing in the picture.", |ui| {
        widgets::swatch(ui, theme::role_color(light.role), vec2(8.0, 16.0));
        ComboBox::from_id_salt("role").selected_text(light.role.label()).show_ui(ui, |ui| {
            for role in Role::ALL {
                ui.selectable_value(&mut light.role, role, role.label());
            }
        });
    });
}

const WS: NumberField = NumberField::new(2.0, 0.0, 100_000.0, 1, " Ws");
const EFFICACY: NumberField = NumberField::new(0.2, 1.0, 200.0, 1, " lm s/Ws");
const GUIDE: NumberField = NumberField::new(0.2, 0.0, 10_000.0, 1, "");
const LUMENS: NumberField = NumberField::new(20.0, 0.0, 100_000_000.0, 0, " lm");
const CANDELA: NumberField = NumberField::new(20.0, 0.0, 100_000_000.0, 0, " cd");
const LUX: NumberField = NumberField::new(20.0, 0.0, 100_000_000.0, 0, " lx");

fn power_rows(ui: &mut Ui, (scene, assets): (&Scene, &Assets), gear: &GearList, light: &mut Light) {
    if !light.emitter.is_infinite() {
        head::head_row(ui, scene, gear, light);
    }
    head::dial_rows(ui, scene, assets, light);
    if let Some(head) = &light.head {
        head::head_facts(ui, gear, head, &light.power.output);
        return;
    }
    let unit = PowerUnit::of(&light.power.output);
    row(ui, "Stated as", "The unit of its full power. Changing the unit keeps the exposure.", |ui| {
        let units: &[PowerUnit] = if light.emitter.is_infinite() { &PowerUnit::INFINITE } else { &PowerUnit::FINITE };
        ComboBox::from_id_salt("unit").selected_text(unit.label()).width(ui.available_width() - 8.0).show_ui(
            ui,
            |ui| {
                for &each in units {
                    if ui.selectable_label(unit == each, each.label()).clicked() && unit != each {
                        light.power.output = power::convert(light, assets, &scene.camera, each);
                    }
                }
            },
        );
    });
    row(ui, "Full power", "What it gives with the dial at 0", |ui| match &mut light.power.output {
        Output::Lumens(flux) => drop(LUMENS.ui(ui, flux)),
        Output::Candela(intensity) => drop(CANDELA.ui(ui, intensity)),
        Output::Lux(lux) => drop(LUX.ui(ui, lux)),
        Output::LuxAt { lux, distance_m } => {
            LUX.ui(ui, lux);
            ui.label("at");
            ui.name_inputs("Distance of the reading", |ui| DISTANCE.ui(ui, distance_m));
        }
        Output::FlashWs { energy_ws, efficacy_lm_s_per_ws } => {
            WS.ui(ui, energy_ws);
            ui.name_inputs("Efficacy", |ui| EFFICACY.ui(ui, efficacy_lm_s_per_ws))
                .on_hover_text("Light that a watt second gives: 15 to 50 for real heads");
        }
        Output::FlashGuideNumber(number) => {
            ui.label("GN");
            ui.name_inputs("Guide number", |ui| GUIDE.ui(ui, number)).on_hover_text("Metres at ISO 100");
        }
    });
}

fn color_rows(ui: &mut Ui, scene: &Scene, light: &mut Light) {
    let white = scene.camera.white_balance_k;
    row(ui, "Source", "Where its colour comes from", |ui| {
        let mut is_kelvin = matches!(light.color.source, ColorSource::Kelvin(_));
        widgets::choice(ui, &mut is_kelvin, &[(true, "Kelvin", "A colour temperature"), (false, "RGB", "Any colour")]);
        match (is_kelvin, light.color.source) {
            (true, ColorSource::Rgb(_)) => light.color.source = ColorSource::Kelvin(5500.0),
            (false, ColorSource::Kelvin(k)) => {
                let rgb = rgb_from_kelvin(k, 5500.0);
                light.color.source = ColorSource::Rgb((rgb / rgb.max_element()).into());
            }
            _ => {}
        }
        let swatch = widgets::swatch(ui, widgets::display_color(light_rgb(&light.color, white)), vec2(44.0, 18.0));
        swatch.on_hover_text(format!("Its colour, gel included, as the camera sees it at {white:.0} K"));
    });
    match &mut light.color.source {
        ColorSource::Kelvin(kelvin) => kelvin_row(ui, "Temperature", kelvin),
        ColorSource::Rgb(rgb) => {
            row(ui, "Colour", "Only the hue counts: brightness comes from the power", |ui| widgets::color_ui(ui, rgb));
        }
    }
    gel::gel_rows(ui, &mut light.color);
}

/// Named colour temperatures.
const KELVINS: [(&str, f32); 6] = [
    ("Candle 1900 K", 1900.0),
    ("Tungsten 3200 K", 3200.0),
    ("Fluorescent 4200 K", 4200.0),
    ("Daylight, flash 5500 K", 5500.0),
    ("Overcast 6500 K", 6500.0),
    ("Shade 7500 K", 7500.0),
];

/// Draws a slider of kelvin with a list of named temperatures.
pub(super) fn kelvin_row(ui: &mut Ui, label: &str, kelvin: &mut f32) {
    row(ui, label, "Colour temperature in kelvin: low is warm, high is cool", |ui| {
        ui.spacing_mut().slider_width = (ui.available_width() - 108.0).max(50.0);
        let mut shown = *kelvin;
        let slider = Slider::new(&mut shown, 1800.0..=12_000.0).logarithmic(true).step_by(50.0).suffix(" K");
        let slider = slider.clamping(SliderClamping::Never).update_while_editing(false).max_decimals(0);
        if ui.add(slider).changed() && shown.is_finite() {
            *kelvin = shown;
        }
        let list = ComboBox::from_id_salt("kelvin by name").width(24.0).show_ui(ui, |ui| {
            for (name, value) in KELVINS {
                if ui.selectable_label(*kelvin == value, name).clicked() {
                    *kelvin = value;
                }
            }
        });
        widgets::named(ui, &list.response, &format!("{label} by name"));
        list.response.on_hover_text("By name: tungsten, daylight, shade");
    });
}

fn readouts(ui: &mut Ui, scene: &Scene, assets: &Assets, light: &Light) {
    let at = readout::at_aim(scene, assets, light);
    let camera = &scene.camera;
    let flash = light.power.output.is_flash();
    let n = exposure::f_number_to_set(scene, at.lux_s);
    let over = readout::stops_over_camera(scene, at.lux_s);
    let settings = format!("at ISO {} and {}", Dial::Iso.label(camera.iso), Dial::Shutter.label(camera.shutter_s));
    let tip = format!(
        "The f-number that a meter at the aim asks for, {settings}, from this light alone; it makes up for ND filter and \
         bellows factor"
    );
    fact(ui, "Meter reads", &tip, RichText::new(format!("f/{n:.1}")).strong());
    let reads = if over.is_finite() { format!("{} stops", signed_stops(over)) } else { "no light".to_owned() };
    let tip = format!("Against the camera's {}: positive is brighter", Dial::FNumber.label(camera.f_number));
    fact(ui, "To the camera", &tip, reads);
    let (unit, what) = if flash { ("lx s", "Exposure") } else { ("lx", "Illuminance") };
    fact(ui, what, "On a surface at the aim that faces the light", format!("{} {unit}", three_digits(at.illuminance)));
    if !light.emitter.is_infinite() {
        let unit = if flash { "cd s" } else { "cd" };
        let table = assets.intensity_table(light);
        let intensity = three_digits(axial_intensity(light, table.as_ref()));
        let (label, tip) = match table {
            Some(_) => ("Peak intensity", "The largest of all directions, dial included"),
            None => ("Intensity", "On the light's axis, dial included"),
        };
        fact(ui, label, tip, format!("{intensity} {unit}"));
    }
    if let Some(distance) = at.distance_m {
        fact(ui, "Distance", "From the light to what it aims at", lengths::shown(ui.ctx(), distance));
    }
    if !light.on {
        ui.label(RichText::new("The light is off; these are its values when it is on.").weak().small());
    }
}

/// Draws the buttons that place a light by a feature, the view through it, and its lock.
fn aiming_row(ui: &mut Ui, light: &Light, out: &mut Vec<Command>) {
    row(ui, "Place it by", "Keys P, L and Shift+L do the same for the selected light", |ui| {
        ui.spacing_mut().item_spacing.x = 3.0;
        ui.add_enabled_ui(!light.locked, |ui| {
            for (by, text) in [
                (PlaceLightBy::Highlight, "Highlight"),
                (PlaceLightBy::Light, "Light"),
                (PlaceLightBy::Shadow, "Shadow"),
            ] {
                if ui.button(text).on_hover_text(by.tip()).clicked() {
                    out.push(Command::TogglePlaceLight(by));
                }
            }
        });
    });
    row(ui, "Its view", "What the light sees along its axis", |ui| {
        if ui.button("Look through it").on_hover_text("Orbit then swings the light; Esc goes back (V)").clicked() {
            out.push(Command::ToggleLightView);
        }
    });
    row(ui, "Lock", "Locked it cannot be moved, and clicks in the view go past it (K)", |ui| {
        let mut locked = light.locked;
        ui.checkbox(&mut locked, "In its place");
        if locked != light.locked {
            out.push(Command::Apply(Action::Lock(vec![Item::Light(light.id)], locked)));
        }
    });
}

fn place_rows(ui: &mut Ui, scene: &Scene, light: &mut Light) {
    row(ui, "Position", "Centre of the light, in the room", |ui| {
        widgets::vec3_ui(ui, "Position", METRES, &mut light.position)
    });
    if light.emitter.is_infinite() {
        return;
    }
    let target = scene.aim_point(&light.aim, light.position);
    let away = light.position - target;
    let mut distance = away.length();
    let before = distance;
    row(ui, "Distance", "To what it aims at: changing it moves the light along its axis", |ui| {
        DISTANCE.ui(ui, &mut distance)
    });
    if distance != before && before > 1e-3 {
        light.position = target + away * (distance / before);
    }
    let LightBearing { azimuth_deg, elevation_deg, .. } = LightBearing::new(scene, light.position, target);
    let facts = format!("{azimuth_deg:.0}\u{b0} round, {elevation_deg:.0}\u{b0} up");
    fact(
        ui,
        "From camera",
        "Its direction from the subject: round from the camera (positive to the camera's right), and up",
        facts,
    );
}

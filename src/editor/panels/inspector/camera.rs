//! The inspector of the camera.

use super::light::kelvin_row;
use super::{InspectorContext, aim, title};
use crate::editor::commands::command::Command;
use crate::editor::commands::preferences::METER_CONSTANTS;
use crate::editor::document::action::Action;
use crate::editor::document::placement::aim_offset;
use crate::editor::ui::lengths;
use crate::editor::ui::widgets::{self, DEGREES, DISTANCE, METRES, NumberField, dial_ui, fact, row, section};
use crate::photo::text::three_digits;
use crate::photo::thirds::Dial;
use crate::photo::{exposure, nd_filter};
use crate::scene::{Assets, Camera, Focus, FocusedLens, Orientation, Scene, Sensor};
use crate::sheet::Units;
use eframe::egui::{ComboBox, Ui};

/// Draws the inspector of the camera.
pub(super) fn camera_ui(ui: &mut Ui, context: &mut InspectorContext<'_>) {
    let (scene, assets) = (context.document.scene(), context.document.assets());
    let mut camera = scene.camera.clone();
    title(ui, "Camera", "");
    section(ui, "Exposure", true, |ui| exposure_rows(ui, scene, &mut camera));
    section(ui, "Lens and sensor", true, |ui| lens_rows(ui, scene, &mut camera));
    section(ui, "Place and aim", true, |ui| {
        row(ui, "Position", "Centre of the lens, in the room", |ui| {
            widgets::vec3_ui(ui, "Position", METRES, &mut camera.position)
        });
        distance_row(ui, scene, &mut camera);
        aim::aim_rows(ui, scene, assets, camera.position, &mut camera.aim);
        row(ui, "Roll", "Turn about the lens axis, clockwise", |ui| DEGREES.ui(ui, &mut camera.roll_deg));
    });
    section(ui, "Focus", true, |ui| focus_rows(ui, scene, assets, &mut camera));
    section(ui, "Meter", false, |ui| {
        let field = NumberField::new(1.0, METER_CONSTANTS.0, METER_CONSTANTS.1, 0, " lx s");
        let tip = "Calibration constant C of the incident meter: 250 for a flat receptor, 340 for many domes";
        row(ui, "Constant C", tip, |ui| field.ui(ui, &mut camera.meter_constant));
    });
    if camera != scene.camera {
        context.out.push(Command::Apply(Action::SetCamera(Box::new(camera))));
    }
}

fn exposure_rows(ui: &mut Ui, scene: &Scene, camera: &mut Camera) {
    row(ui, "Aperture", "f-number, in thirds of a stop", |ui| {
        dial_ui(ui, "Aperture", Dial::FNumber, &mut camera.f_number)
    });
    let tip = "Exposure time. It does not change the light of a flash, only continuous light.";
    row(ui, "Shutter", tip, |ui| dial_ui(ui, "Shutter", Dial::Shutter, &mut camera.shutter_s));
    row(ui, "ISO", "Speed of the sensor", |ui| dial_ui(ui, "ISO", Dial::Iso, &mut camera.iso));
    let tip = "Neutral density filter before the lens: it takes so many stops of all light, flash and continuous";
    row(ui, "ND filter", tip, |ui| nd_filter_ui(ui, &mut camera.nd_stops));
    kelvin_row(ui, "White balance", &mut camera.white_balance_k);
    let lux_s = exposure::lux_s_of(camera, &FocusedLens::new(scene, camera), camera.f_number);
    let ev = exposure::ev100(lux_s / camera.shutter_s, camera.meter_constant);
    let tip = "What a grey card needs at these settings: exposure value at ISO 100, lux of continuous light, lux seconds of flash";
    let lux = three_digits(lux_s / camera.shutter_s);
    fact(ui, "Needs", tip, format!("EV {ev:.1}  ({lux} lx, or {} lx s)", three_digits(lux_s)));
}

/// Strongest filter of the field, stops.
const MAX_ND_STOPS: f32 = 20.0;

/// Draws the field of the filter, with buttons in thirds of a stop and a list of filters.
fn nd_filter_ui(ui: &mut Ui, stops: &mut f32) {
    ui.spacing_mut().item_spacing.x = 2.0;
    let third = |stops: f32, step: f32| (((3.0 * stops).round() + step) / 3.0).clamp(0.0, MAX_ND_STOPS);
    if widgets::small_button(ui, "\u{2212}", "ND filter down").on_hover_text("A third of a stop less").clicked() {
        *stops = third(*stops, -1.0);
    }
    NumberField::new(0.02, 0.0, MAX_ND_STOPS, 2, " stops").ui(ui, stops);
    if widgets::small_button(ui, "+", "ND filter up").on_hover_text("A third of a stop more").clicked() {
        *stops = third(*stops, 1.0);
    }
    let menu = ui.menu_button(nd_filter::name(*stops), |ui| {
        for whole in 0..=10 {
            if ui.button(nd_filter::label(whole as f32)).clicked() {
                *stops = whole as f32;
            }
        }
    });
    widgets::named(ui, &menu.response, "ND filter by name");
    menu.response.on_hover_text("Filters by stops, with filter factor and density");
}

/// Focal lengths of prime lenses, millimetres.
const PRIMES: [f32; 12] = [14.0, 20.0, 24.0, 28.0, 35.0, 50.0, 70.0, 85.0, 105.0, 135.0, 200.0, 300.0];

fn lens_rows(ui: &mut Ui, scene: &Scene, camera: &mut Camera) {
    row(ui, "Lens", "Focal length", |ui| {
        NumberField::new(0.5, 4.0, 2000.0, 1, " mm").ui(ui, &mut camera.focal_length_mm);
        let menu = ui.menu_button("Primes", |ui| {
            for mm in PRIMES {
                if ui.button(format!("{mm} mm")).clicked() {
                    camera.focal_length_mm = mm;
                }
            }
        });
        menu.response.on_hover_text("The lengths that lenses come in");
    });
    row(ui, "Sensor", "Size of the picture area", |ui| {
        let named = Sensor::NAMED.iter().find(|(_, each)| *each == camera.sensor);
        let current = named.map_or("Custom", |(name, _)| *name);
        ComboBox::from_id_salt("sensor").selected_text(current).width(ui.available_width() - 8.0).show_ui(ui, |ui| {
            for (name, each) in Sensor::NAMED {
                ui.selectable_value(&mut camera.sensor, each, name);
            }
            if ui.selectable_label(named.is_none(), "Custom").clicked() {
                let size = camera.sensor.size_mm();
                camera.sensor = Sensor::Custom { width_mm: size.x, height_mm: size.y };
            }
        });
    });
    if let Sensor::Custom { width_mm, height_mm } = &mut camera.sensor {
        row(ui, "Size", "Long and short side", |ui| {
            let field = NumberField::new(0.1, 1.0, 300.0, 1, " mm");
            ui.name_inputs("Sensor width", |ui| field.ui(ui, width_mm));
            ui.name_inputs("Sensor height", |ui| field.ui(ui, height_mm));
        });
    }
    let held = [
        (Orientation::Landscape, "Landscape", "Long side level"),
        (Orientation::Portrait, "Portrait", "Turned upright"),
    ];
    row(ui, "Held", "How the camera is held", |ui| widgets::choice(ui, &mut camera.orientation, &held));
    let lens = FocusedLens::new(scene, camera);
    let field = lens.frame(camera, camera.aspect()).half_extent * 2.0 * lens.ahead.length();
    fact(
        ui,
        "Field",
        "What fits into the picture at the distance of the aim",
        match lengths::units(ui.ctx()) {
            Units::Metres => format!("{:.2} \u{d7} {:.2} m", field.x, field.y),
            units => format!("{} \u{d7} {}", units.distance(field.x), units.distance(field.y)),
        },
    );
}

fn distance_row(ui: &mut Ui, scene: &Scene, camera: &mut Camera) {
    let target = scene.aim_point(&camera.aim, camera.position);
    let away = camera.position - target;
    let (before, mut distance) = (away.length(), away.length());
    let tip = "To the subject: changing it moves the camera along the lens axis";
    row(ui, "Distance", tip, |ui| DISTANCE.ui(ui, &mut distance));
    if distance != before && before > 1e-3 {
        camera.position = target + away * (distance / before);
    }
}

fn focus_rows(ui: &mut Ui, scene: &Scene, assets: &Assets, camera: &mut Camera) {
    row(ui, "Blur", "Whether the aperture blurs what is out of focus", |ui| {
        ui.checkbox(&mut camera.depth_of_field, "Depth of field")
            .on_hover_text("On: a real lens. Off: everything is sharp, and renders have less noise.");
    });
    let tip = "Whether the lens moves away from the sensor to focus near";
    row(ui, "Near focus", tip, |ui| {
        ui.checkbox(&mut camera.focus_breathing, "Focus breathing").on_hover_text(BREATHING_TIP);
    });
    let lens = FocusedLens::new(scene, camera);
    let at = lens.focus_m.unwrap_or(NEAREST_M);
    row(ui, "Focus on", "What is sharp", |ui| {
        let current = match camera.focus {
            Focus::OnAim => "The aim".to_owned(),
            Focus::Distance(_) => "A distance".to_owned(),
            Focus::OnObject { object, .. } => scene.object(object).map_or_else(String::new, |o| o.name.clone()),
        };
        ComboBox::from_id_salt("focus").selected_text(current).width(ui.available_width() - 8.0).show_ui(ui, |ui| {
            ui.selectable_value(&mut camera.focus, Focus::OnAim, "The aim");
            if ui.selectable_label(matches!(camera.focus, Focus::Distance(_)), "A distance").clicked() {
                camera.focus = Focus::Distance(at);
            }
            for object in &scene.objects {
                let is_it = matches!(camera.focus, Focus::OnObject { object: on, .. } if on == object.id);
                if ui.selectable_label(is_it, &object.name).clicked() {
                    camera.focus = Focus::OnObject { object: object.id, offset: aim_offset(object, assets) };
                }
            }
        });
    });
    match &mut camera.focus {
        Focus::Distance(distance) => drop(row(ui, "At", AT_TIP, |ui| FOCUS_DISTANCE.ui(ui, distance))),
        Focus::OnAim | Focus::OnObject { .. } => fact(ui, "At", AT_TIP, from_lens(ui, at)),
    }
    lens_facts(ui, camera, &lens);
}

/// Smallest distance of focus that is shown, metres.
const NEAREST_M: f32 = 0.01;
/// Distances of focus, to the millimetre.
const FOCUS_DISTANCE: NumberField = NumberField::new(0.01, NEAREST_M, 1000.0, 3, " m");
const AT_TIP: &str = "From the lens along its axis; the scale on a real lens counts from the sensor";
const BREATHING_TIP: &str = "On: a simple lens, which moves away from the sensor to focus near. At the magnification m \
    the picture shows a field 1 + m times narrower, and 2 log2(1 + m) stops of light are lost: two at 1:1. Meter \
    readings make up for them, as a meter behind the lens does. Off: field and exposure of a lens focused at infinity, \
    which for portraits is within a few percent and a tenth of a stop.";

/// Draws what follows from the focus: magnification, distance from the sensor and depth of field.
fn lens_facts(ui: &mut Ui, camera: &Camera, lens: &FocusedLens) {
    if camera.focus_breathing {
        let (m, stops) = (lens.magnification, exposure::bellows_stops(lens));
        let scale = if m >= 1.0 { format!("{m:.1}:1") } else { format!("1:{:.1}", 1.0 / m) };
        let works_as = Dial::FNumber.label(camera.f_number * (1.0 + m));
        let tip = "Size of the image over that of the subject; the light that near focus costs, and the f-number at \
                   infinity that gives the same exposure";
        let text = if m > 0.0 { format!("{scale}, \u{2212}{stops:.2} stops: as {works_as}") } else { "0".to_owned() };
        fact(ui, "Magnification", tip, text);
        if let Some(focus_m) = lens.focus_m {
            let from_sensor = from_lens(ui, focus_m + lens.image_distance_m());
            fact(ui, "From the sensor", "What the distance scale of a lens shows", from_sensor);
        }
    }
    let sharp =
        lens.depth_of_field_m(camera.f_number, camera.sensor.sharp_circle_m()).filter(|_| camera.depth_of_field);
    if let Some((near, far)) = sharp {
        let far_text = if far.is_finite() { from_lens(ui, far) } else { "infinity".to_owned() };
        let deep = far - near;
        let depth = if deep < 0.1 { format!(", {:.1} mm deep", deep * 1e3) } else { String::new() };
        let tip = "Blur circles up to 1/1500 of the sensor's diagonal";
        fact(ui, "Sharp", tip, format!("{} to {far_text}{depth}", from_lens(ui, near)));
    }
}

/// Formats a distance from the lens: to the millimetre below one metre, else to the centimetre, or in feet and inches.
fn from_lens(ui: &Ui, metres: f32) -> String {
    match lengths::units(ui.ctx()) {
        Units::Metres if metres < 1.0 => format!("{metres:.3} m"),
        units => lengths::text(units, metres),
    }
}

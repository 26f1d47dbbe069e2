//! Checks lights: emitter, power, colour, and their combinations.

use super::aim::check_aim;
use super::check::{Allowed, Check, POSITION, SIZE, TURN};
use crate::scene::{
    BarnDoors, ColorSource, Cone, DialScale, Emitter, Gel, Head, Light, Modifier, Output, Power, Scene,
};

/// Longest name of a head.
const MOST_NAME: usize = 100;
const AMOUNT: Allowed = Allowed::between(0.0, 1e9, "");
/// Upper limit: the luminous efficacy of monochromatic light at 555 nm, 683 lm/W.
const EFFICACY: Allowed = Allowed::between(0.0, 683.0, "lm s per Ws");

pub(super) fn check_light(scene: &Scene, light: &Light, check: &mut Check) {
    check.vector("position", light.position, POSITION);
    let is_even = matches!(light.emitter, Emitter::Point | Emitter::Sphere { .. } | Emitter::Surround);
    let has_direction = !is_even || light.photometric_file.is_some();
    check_aim(scene, &light.aim, light.position, has_direction, check);
    check.number("roll_deg", light.roll_deg, TURN);
    check_emitter(&light.emitter, check);
    if let Some(path) = &light.photometric_file {
        check.asset_path("photometric_file", path);
        if light.emitter.is_infinite() {
            let kind = light.emitter.label().to_lowercase();
            check.error("photometric_file", format!("a {kind} shines from infinity; its light has no distribution"));
        }
    }
    if let Some(path) = &light.environment_map {
        check.asset_path("environment_map", path);
        if light.emitter != Emitter::Surround {
            check.warning("environment_map", "the light is no surround: the picture does nothing".to_owned());
        }
    }
    check_modifier(&light.modifier, check);
    if let Some(head) = &light.head {
        check_head(head, check);
    }
    check_power(&light.power, check);
    check_pairing(light, check);
    match light.color.source {
        ColorSource::Kelvin(kelvin) => check.number("color[0]", kelvin, Allowed::between(1000.0, 25_000.0, "K")),
        ColorSource::Rgb(rgb) => check_light_color("color", rgb, Allowed::between(0.0, 1000.0, ""), check),
    }
    match light.color.gel {
        Gel::None => {}
        Gel::Mired(shift) => check.number("gel[0]", shift, Allowed::between(-1000.0, 1000.0, "mired")),
        Gel::Tint(rgb) => check_light_color("gel", rgb, Allowed::between(0.0, 1.0, ""), check),
    }
}

fn check_light_color(field: &str, rgb: [f32; 3], allowed: Allowed, check: &mut Check) {
    check.color(field, rgb, allowed);
    if rgb == [0.0; 3] {
        check.error(field, "black is no colour of light; one channel must be above 0".to_owned());
    }
}

fn check_emitter(emitter: &Emitter, check: &mut Check) {
    match *emitter {
        Emitter::Point | Emitter::Surround => {}
        Emitter::Sphere { radius_m } => check.number("emitter.radius_m", radius_m, SIZE),
        Emitter::Spot { inner_deg, outer_deg } => {
            check.number("emitter.inner_deg", inner_deg, Allowed::between(0.0, 180.0, "degrees"));
            check.number("emitter.outer_deg", outer_deg, Allowed::between(0.1, 180.0, "degrees"));
            if inner_deg > outer_deg {
                let message = format!("the even cone of {inner_deg} degrees is wider than the whole of {outer_deg}");
                check.error("emitter.inner_deg", message);
            }
        }
        Emitter::RectPanel { width_m, height_m } => {
            check.number("emitter.width_m", width_m, SIZE);
            check.number("emitter.height_m", height_m, SIZE);
        }
        Emitter::RoundPanel { diameter_m } => check.number("emitter.diameter_m", diameter_m, SIZE),
        Emitter::Sun { angular_diameter_deg } => {
            check.number("emitter.angular_diameter_deg", angular_diameter_deg, Allowed::between(0.0, 90.0, "degrees"));
        }
    }
}

fn check_modifier(modifier: &Modifier, check: &mut Check) {
    const LOSS: Allowed = Allowed::between(0.0, 20.0, "stops");
    const FLAP: Allowed = Allowed::between(0.0, 90.0, "degrees");
    check.number("modifier.loss_stops", modifier.loss_stops, LOSS);
    check.number("modifier.scrim_stops", modifier.scrim_stops, LOSS);
    if let Some(Cone { inner_deg, outer_deg }) = modifier.beam {
        check.number("modifier.beam.inner_deg", inner_deg, Allowed::between(0.0, 180.0, "degrees"));
        check.number("modifier.beam.outer_deg", outer_deg, Allowed::between(0.1, 180.0, "degrees"));
        if inner_deg > outer_deg {
            let message = format!("the even beam of {inner_deg} degrees is wider than the whole of {outer_deg}");
            check.error("modifier.beam.inner_deg", message);
        }
    }
    if let Some(grid_deg) = modifier.grid_deg {
        check.number("modifier.grid_deg", grid_deg, Allowed::between(0.1, 180.0, "degrees"));
    }
    if let Some(BarnDoors { left_deg, right_deg, top_deg, bottom_deg }) = modifier.doors {
        check.number("modifier.doors.left_deg", left_deg, FLAP);
        check.number("modifier.doors.right_deg", right_deg, FLAP);
        check.number("modifier.doors.top_deg", top_deg, FLAP);
        check.number("modifier.doors.bottom_deg", bottom_deg, FLAP);
    }
}

fn check_head(head: &Head, check: &mut Check) {
    const TIME: Allowed = Allowed::between(1e-7, 10.0, "s");
    if head.name.is_empty() || head.name.chars().count() > MOST_NAME {
        check.error("head.name", format!("a head has a name of 1 to {MOST_NAME} characters"));
    }
    check.number("head.dial.lowest_stops", head.dial.lowest_stops, Allowed::between(-20.0, 0.0, "stops"));
    if head.dial.steps_per_stop == 0 {
        check.error("head.dial.steps_per_stop", "a dial has at least 1 setting a stop".to_owned());
    }
    match head.dial.scale {
        DialScale::Fractions | DialScale::PerCent => {}
        DialScale::Number { full } => check.number("head.dial.scale.full", full, Allowed::between(-100.0, 1000.0, "")),
        DialScale::WattSeconds { full } => {
            check.number("head.dial.scale.full", full, Allowed::between(0.1, 1e6, "Ws"));
        }
    }
    let times = [("head.sync_s", head.sync_s), ("head.t01_s", head.t01_s)];
    for (field, time_s) in times.into_iter().filter_map(|(field, time_s)| Some((field, time_s?))) {
        check.number(field, time_s, TIME);
    }
    if let Some(loss) = head.hss_loss_stops {
        check.number("head.hss_loss_stops", loss, Allowed::between(0.0, 20.0, "stops"));
    }
}

fn check_power(power: &Power, check: &mut Check) {
    match power.output {
        Output::Lumens(amount) | Output::Candela(amount) | Output::Lux(amount) => {
            check.number("power.output[0]", amount, AMOUNT);
        }
        Output::LuxAt { lux, distance_m } => {
            check.number("power.output.lux", lux, AMOUNT);
            check.number("power.output.distance_m", distance_m, Allowed::between(1e-3, 1e4, "m"));
        }
        Output::FlashWs { energy_ws, efficacy_lm_s_per_ws } => {
            check.number("power.output.energy_ws", energy_ws, Allowed::between(0.0, 1e6, "Ws"));
            check.number("power.output.efficacy_lm_s_per_ws", efficacy_lm_s_per_ws, EFFICACY);
        }
        Output::FlashGuideNumber(guide_number) => {
            check.number("power.output[0]", guide_number, Allowed::between(0.0, 1e4, "m"));
        }
    }
    check.number("power.dial_stops", power.dial_stops, Allowed::between(-20.0, 10.0, "stops"));
}

/// Checks that the output's unit fits the emitter: lux for sun and surround, flux or intensity for all others.
fn check_pairing(light: &Light, check: &mut Check) {
    let kind = light.emitter.label();
    match (light.emitter.is_infinite(), light.power.output) {
        (true, Output::Lux(_)) if light.modifier.narrows() => {
            let message = format!("a {} shines from infinity; only a loss can come before it", kind.to_lowercase());
            check.error("modifier", message);
        }
        (true, Output::Lux(_)) => {}
        (true, _) => {
            let message = format!("a {} shines from infinity and is stated as Lux(...)", kind.to_lowercase());
            check.error("power.output", message);
        }
        (false, Output::Lux(_)) => {
            let message =
                format!("Lux is for sun and surround; a {} needs its distance, too: LuxAt", kind.to_lowercase());
            check.error("power.output", message);
        }
        (false, _) => {}
    }
}

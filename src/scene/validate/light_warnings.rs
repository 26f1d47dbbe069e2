//! Warnings about lights that can be rendered but are hardly intended.

use super::check::Check;
use crate::scene::{Output, Scene};

pub(super) fn warn_of_lights(scene: &Scene, check: &mut Check) {
    let glows = scene
        .objects
        .iter()
        .filter(|o| o.visible)
        .any(|object| object.materials().any(|material| material.is_emissive()));
    if scene.lights.is_empty() && !glows {
        check.warning("lights", "there is no light; the picture will be black".to_owned());
    } else if scene.lights.iter().all(|l| !l.on) && !glows {
        check.warning("lights", "all lights are off; the picture will be black".to_owned());
    }
    match scene.lights.iter().filter(|light| scene.is_silenced(light)).count() {
        0 => {}
        1 => check.warning("solo", "one light is silent while others shine alone".to_owned()),
        silent => check.warning("solo", format!("{silent} lights are silent while others shine alone")),
    }
    for (index, light) in scene.lights.iter().enumerate() {
        check.enter(format!("lights[{index}] {:?} ", light.name));
        if light.on && is_zero(&light.power.output) {
            check.warning("power.output", "it is on but gives 0".to_owned());
        }
        if light.on && light.emitter.is_infinite() && scene.room.is_some() {
            let message = format!("the room's walls keep the {} out", light.emitter.label().to_lowercase());
            check.warning("emitter", message);
        }
    }
    check.enter(String::new());
}

fn is_zero(output: &Output) -> bool {
    match *output {
        Output::Lumens(amount) | Output::Candela(amount) | Output::Lux(amount) => amount == 0.0,
        Output::LuxAt { lux, .. } => lux == 0.0,
        Output::FlashWs { energy_ws, efficacy_lm_s_per_ws } => energy_ws * efficacy_lm_s_per_ws == 0.0,
        Output::FlashGuideNumber(guide_number) => guide_number == 0.0,
    }
}

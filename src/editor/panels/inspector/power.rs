//! Units of power, and the conversion between them at equal exposure.

use crate::editor::document::readout;
use crate::photo::light::transmittance;
use crate::photo::{PhotometricLight, Strength};
use crate::scene::{Assets, Camera, Emitter, Light, LightColor, Modifier, Output, Scene};
use glam::Affine3A;

/// A unit of power.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum PowerUnit {
    /// Lumens.
    Lumens,
    /// Candela on the axis.
    Candela,
    /// Lux at a distance.
    LuxAt,
    /// Lux of sun or sky.
    Lux,
    /// Flash energy.
    FlashWs,
    /// Flash guide number.
    GuideNumber,
}

impl PowerUnit {
    /// The units of lights with a position.
    pub const FINITE: [PowerUnit; 5] =
        [PowerUnit::FlashWs, PowerUnit::GuideNumber, PowerUnit::Lumens, PowerUnit::Candela, PowerUnit::LuxAt];
    /// The units of sun and surround.
    pub const INFINITE: [PowerUnit; 1] = [PowerUnit::Lux];

    /// Returns the label in the list.
    pub fn label(self) -> &'static str {
        match self {
            PowerUnit::Lumens => "Continuous, lumens",
            PowerUnit::Candela => "Continuous, candela",
            PowerUnit::LuxAt => "Continuous, lux at a distance",
            PowerUnit::Lux => "Continuous, lux",
            PowerUnit::FlashWs => "Flash, watt seconds",
            PowerUnit::GuideNumber => "Flash, guide number",
        }
    }

    /// Returns the unit of an output.
    pub fn of(output: &Output) -> PowerUnit {
        match output {
            Output::Lumens(_) => PowerUnit::Lumens,
            Output::Candela(_) => PowerUnit::Candela,
            Output::LuxAt { .. } => PowerUnit::LuxAt,
            Output::Lux(_) => PowerUnit::Lux,
            Output::FlashWs { .. } => PowerUnit::FlashWs,
            Output::FlashGuideNumber(_) => PowerUnit::GuideNumber,
        }
    }
}

/// Returns the output of a light in another unit: at equal intensity, and between flash and continuous light at equal
/// exposure at the camera's shutter.
pub fn convert(light: &Light, assets: &Assets, camera: &Camera, unit: PowerUnit) -> Output {
    // Power is stated before modifier and gel, whatever its unit.
    let full = Light {
        power: crate::scene::Power { dial_stops: 0.0, ..light.power },
        modifier: Modifier::default(),
        color: LightColor { gel_loss_counts: false, ..light.color },
        ..light.clone()
    };
    // The position in which a lamp burns changes all units alike
    let table = assets.intensity_table(light);
    let bare = PhotometricLight::in_frame(&full, table, Affine3A::IDENTITY, camera);
    let per_flux = bare.intensity_per_flux().unwrap_or(1.0);
    let was_flash = light.power.output.is_flash();
    let is_flash = matches!(unit, PowerUnit::FlashWs | PowerUnit::GuideNumber);
    let time = match (was_flash, is_flash) {
        (true, false) => 1.0 / camera.shutter_s,
        (false, true) => camera.shutter_s,
        _ => 1.0,
    };
    let intensity = time
        * match bare.strength {
            Strength::Flux(flux) => flux * per_flux,
            Strength::AxialIntensity(intensity) => intensity,
            Strength::Illuminance(_) => 0.0,
        };
    match unit {
        PowerUnit::Lumens => Output::Lumens(intensity / per_flux),
        PowerUnit::Candela => Output::Candela(intensity),
        PowerUnit::LuxAt => Output::LuxAt { lux: intensity, distance_m: 1.0 },
        PowerUnit::Lux => Output::Lux(10_000.0),
        PowerUnit::FlashWs => {
            let efficacy_lm_s_per_ws = Output::DEFAULT_EFFICACY;
            Output::FlashWs { energy_ws: intensity / per_flux / efficacy_lm_s_per_ws, efficacy_lm_s_per_ws }
        }
        // H(1 m) = 2.5 GN^2 at ISO 100, C = 250 lux s.
        PowerUnit::GuideNumber => Output::FlashGuideNumber((intensity / 2.5).max(0.0).sqrt()),
    }
}

/// Sets emitter and modifier of a light and keeps its power; between finite and infinite emitters it keeps the exposure
/// at the aim. A photometric file is taken off: it is of another luminaire. Sun and surround have no head, and only a
/// surround has an environment map.
pub fn change_emitter(scene: &Scene, assets: &Assets, light: &mut Light, emitter: Emitter, modifier: Modifier) {
    let before = readout::at_aim(scene, assets, light);
    light.photometric_file = None;
    let (was, is) = (light.emitter.is_infinite(), emitter.is_infinite());
    (light.emitter, light.modifier) = (emitter, modifier);
    light.head = light.head.take().filter(|_| !is);
    light.environment_map = light.environment_map.take().filter(|_| emitter == Emitter::Surround);
    if was == is {
        return;
    }
    let passed = (light.power.dial_stops - light.color.loss_stops()).exp2() * transmittance(&modifier);
    let full = before.lux_s / scene.camera.shutter_s / passed;
    light.power.output = if is {
        Output::Lux(full)
    } else {
        let distance_m = scene.aim_vector(&light.aim, light.position).length().max(0.1);
        convert(
            &Light {
                power: crate::scene::Power { output: Output::LuxAt { lux: full, distance_m }, ..light.power },
                ..light.clone()
            },
            assets,
            &scene.camera,
            PowerUnit::FlashWs,
        )
    };
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::editor::document::catalog;
    use crate::scene::Gel;

    #[test]
    fn every_unit_gives_the_same_exposure() {
        let scene = Scene::default();
        let mut light = catalog::light_named("Strip 30 x 120").unwrap();
        light.color.gel = Gel::Mired(159.0);
        let lux_s = readout::at_aim(&scene, &Assets::default(), &light).lux_s;
        for unit in PowerUnit::FINITE.into_iter().chain(PowerUnit::FINITE.into_iter().rev()) {
            light.power.output = convert(&light, &Assets::default(), &scene.camera, unit);
            let now = readout::at_aim(&scene, &Assets::default(), &light).lux_s;
            assert!((now / lux_s - 1.0).abs() < 1e-4, "{unit:?}: {now}, not {lux_s}");
        }
    }

    #[test]
    fn changing_a_bulb_to_sun_and_back_keeps_the_exposure() {
        let scene = Scene::default();
        let mut light = catalog::light_named("Bare bulb").unwrap();
        let lux_s = readout::at_aim(&scene, &Assets::default(), &light).lux_s;
        change_emitter(
            &scene,
            &Assets::default(),
            &mut light,
            Emitter::Sun { angular_diameter_deg: 0.5 },
            Modifier::default(),
        );
        assert!((readout::at_aim(&scene, &Assets::default(), &light).lux_s / lux_s - 1.0).abs() < 1e-3);
        change_emitter(&scene, &Assets::default(), &mut light, Emitter::Point, Modifier::loss(1.0));
        assert!((readout::at_aim(&scene, &Assets::default(), &light).lux_s / lux_s - 1.0).abs() < 1e-3);
    }

    #[test]
    fn a_head_that_became_a_sun_stayed_on_it_and_a_map_stayed_on_what_is_no_surround() {
        let scene = Scene::default();
        let mut light = catalog::light_named("Softbox 60 x 90").unwrap();
        let gear = crate::io::bundled_gear();
        gear.heads[0].mount(&mut light);
        let change = |light: &mut Light, emitter| {
            change_emitter(&scene, &Assets::default(), light, emitter, Modifier::default());
        };
        change(&mut light, Emitter::RoundPanel { diameter_m: 0.9 });
        assert!(light.head.is_some(), "another modifier before the same head");
        change(&mut light, Emitter::Sun { angular_diameter_deg: 0.5 });
        assert_eq!(light.head, None);
        change(&mut light, Emitter::Surround);
        light.environment_map = Some("sky.hdr".to_owned());
        change(&mut light, Emitter::Surround);
        assert!(light.environment_map.is_some());
        change(&mut light, Emitter::Point);
        assert_eq!(light.environment_map, None);
    }
}

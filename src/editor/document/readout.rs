//! The inspector's read-outs of a light at its aim point: closed forms without indirect light and without occlusion.

use crate::photo::beam::Beam;
use crate::photo::emitter::EmitterShape;
use crate::photo::{PhotometricLight, Strength, exposure};
use crate::scene::{Assets, Light, Scene};
use glam::{Vec2, Vec3};
use std::f32::consts::PI;

/// The reading of a light at its aim point, on a surface that faces it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct AimReadout {
    /// Distance to the aim point, metres; none for sun and surround.
    pub distance_m: Option<f32>,
    /// Illuminance in lux for continuous light; luminous exposure in lux seconds for flash.
    pub illuminance: f32,
    /// Luminous exposure, lux seconds.
    pub lux_s: f32,
}

/// Returns the reading of a light at its own aim point, on or off.
pub fn at_aim(scene: &Scene, assets: &Assets, light: &Light) -> AimReadout {
    let distance = scene.aim_vector(&light.aim, light.position).length();
    let light = PhotometricLight::new(scene, assets, light);
    let illuminance = on_axis(&light, distance);
    AimReadout {
        distance_m: (!light.shape.is_distant()).then_some(distance),
        illuminance,
        lux_s: illuminance * light.exposure_time_s,
    }
}

/// Returns the illuminance (lux, or lux seconds for flash) on a surface that faces the light, on its axis.
fn on_axis(light: &PhotometricLight, distance_m: f32) -> f32 {
    if let Strength::Illuminance(lux) = light.strength {
        return lux;
    }
    let intensity = light.axial_intensity();
    let h = distance_m.max(1e-3);
    match light.shape {
        EmitterShape::Point(_) | EmitterShape::Sphere { .. } => {
            let on_axis = light.measured().map_or(1.0, |measured| measured.factor(Vec3::NEG_Z));
            intensity * on_axis / (h * h)
        }
        EmitterShape::Rect { half_size_m } => match &light.beam {
            Some(beam) => intensity * beamed_panel(beam, half_size_m, false, h),
            None => {
                let [a, b] = half_size_m.max(Vec2::splat(0.5e-4)).to_array();
                let luminance = intensity / (4.0 * a * b);
                let (ha, hb) = (h.hypot(a), h.hypot(b));
                // Lambert's polygon formula for a rectangle over its own centre.
                2.0 * luminance * (a / ha * (b / ha).atan() + b / hb * (a / hb).atan())
            }
        },
        EmitterShape::Disc { radius_m } => match &light.beam {
            Some(beam) => intensity * beamed_panel(beam, Vec2::splat(radius_m), true, h),
            None => {
                let radius = radius_m.max(0.5e-4);
                let luminance = intensity / (PI * radius * radius);
                PI * luminance * radius * radius / (radius * radius + h * h)
            }
        },
        EmitterShape::Sun { .. } | EmitterShape::Surround => 0.0,
    }
}

/// Returns the illuminance on the axis of a panel behind a grid or in a dish, for each candela on the axis. Midpoint
/// rule over the panel: the beam cuts more of the light of its rim.
fn beamed_panel(beam: &Beam, half_size_m: Vec2, is_disc: bool, h: f32) -> f32 {
    const CELLS: i32 = 24;
    let (mut sum, mut cells) = (0.0, 0);
    for i in 0..CELLS * CELLS {
        let unit = (Vec2::new((i % CELLS) as f32, (i / CELLS) as f32) + 0.5) * (2.0 / CELLS as f32) - 1.0;
        if is_disc && unit.length_squared() > 1.0 {
            continue;
        }
        // From the cell to the receiver on the axis, in the light's frame.
        let to_receiver = (-(unit * half_size_m)).extend(-h);
        let squared = to_receiver.length_squared();
        sum += beam.transmission(to_receiver / squared.sqrt()) * h * h / (squared * squared);
        cells += 1;
    }
    sum / cells.max(1) as f32
}

/// Returns the exposure over the camera's setting, stops: positive is brighter than a correctly metered grey card.
pub fn stops_over_camera(scene: &Scene, lux_s: f32) -> f32 {
    2.0 * (exposure::f_number_to_set(scene, lux_s) / scene.camera.f_number).log2()
}

/// Returns the power dial, in whole thirds of a stop, that puts this light `stops` over the camera's setting at its
/// aim.
pub fn dial_for(scene: &Scene, assets: &Assets, light: &Light, stops: f32) -> f32 {
    let over = stops_over_camera(scene, at_aim(scene, assets, light).lux_s);
    if over.is_finite() {
        ((light.power.dial_stops + stops - over) * 3.0).round() / 3.0
    } else {
        light.power.dial_stops
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::editor::document::catalog;
    use crate::scene::{Aim, Emitter, Modifier, Output, Power};
    use glam::Vec3;

    fn light(emitter: Emitter) -> Light {
        let modifier = Modifier::default();
        let power = Power { output: Output::Lumens(1000.0), dial_stops: 0.0 };
        Light { emitter, modifier, power, ..catalog::light_named("Bare bulb").unwrap() }
    }

    fn on_axis(light: &Light, distance_m: f32) -> f32 {
        super::on_axis(&PhotometricLight::new(&Scene::default(), &Assets::default(), light), distance_m)
    }

    #[test]
    fn panels_have_the_tabulated_illuminance() {
        // light_and_camera.md: 1000 lm on the axis at 0.5, 1 and 3 m.
        let tables = [
            (Emitter::RectPanel { width_m: 0.6, height_m: 0.9 }, [729.52, 267.05, 34.62]),
            (Emitter::RectPanel { width_m: 0.9, height_m: 1.2 }, [523.91, 232.79, 33.96]),
            (Emitter::RoundPanel { diameter_m: 1.2 }, [521.82, 234.05, 34.01]),
        ];
        for (emitter, expected) in tables {
            for (distance, lux) in [0.5, 1.0, 3.0].into_iter().zip(expected) {
                let ours = on_axis(&light(emitter), distance);
                assert!((ours / lux - 1.0).abs() < 3e-4, "{emitter:?} at {distance}: {ours}, not {lux}");
            }
        }
    }

    #[test]
    fn an_open_beam_leaves_a_panel_unchanged_and_a_grid_cuts_it() {
        for emitter in [Emitter::RectPanel { width_m: 0.6, height_m: 0.9 }, Emitter::RoundPanel { diameter_m: 1.2 }] {
            for distance in [0.5, 1.0, 3.0] {
                let bare = light(emitter);
                let open = crate::scene::Cone { inner_deg: 180.0, outer_deg: 180.0 };
                let cut = |modifier| on_axis(&Light { modifier, ..bare.clone() }, distance);
                let same = cut(Modifier { beam: Some(open), ..Modifier::default() });
                // Midpoints of 24 x 24 cells; a disc's rim has steps.
                assert!((same / on_axis(&bare, distance) - 1.0).abs() < 0.01, "{emitter:?} at {distance}: {same}");
                let grid = cut(Modifier { grid_deg: Some(40.0), ..Modifier::default() });
                assert!(grid < 0.9 * same, "{emitter:?} at {distance}: {grid} of {same}");
            }
        }
    }

    #[test]
    fn the_dial_for_a_reading_gives_that_reading() {
        let mut scene = Scene::default();
        let mut light = light(Emitter::RectPanel { width_m: 0.6, height_m: 0.9 });
        light.aim = Aim::Point(Vec3::ZERO);
        for (stops, nd_stops) in [(0.0, 0.0), (-1.0, 0.0), (1.5, 0.0), (0.0, 3.0)] {
            scene.camera.nd_stops = nd_stops;
            light.power.dial_stops = dial_for(&scene, &Assets::default(), &light, stops);
            let over = stops_over_camera(&scene, at_aim(&scene, &Assets::default(), &light).lux_s);
            assert!((over - stops).abs() < 1.0 / 6.0 + 1e-3, "{over} for {stops}");
        }
        scene.camera.f_number = 0.0;
        assert!(dial_for(&scene, &Assets::default(), &light, 0.0).is_finite());
    }
}

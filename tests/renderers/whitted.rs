//! Whitted's method: exact for point lights, and wrong by design for area lights.

use crate::studio::light;
use crate::studio::measure::{illuminance, meter_card, square};
use catchlight::raytrace::Method;
use catchlight::scene::{Emitter, Output};
use glam::Vec3;

/// Illuminance of a card that faces the light at `height` metres, by a method.
fn lux(method: Method, emitter: Emitter, height: f32) -> f64 {
    let mut scene = meter_card(Vec3::ZERO, Vec3::Z);
    scene.lights.push(light(emitter, Output::Lumens(1000.0), Vec3::Z * height));
    illuminance(&scene, &square(method, 4, 64)).mean
}

#[test]
fn a_point_light_is_exact() {
    // I / d^2 with I = 1000 lm / 4 pi; the card's size and single precision allow 0.05 %.
    let truth = 1000.0 / (4.0 * std::f64::consts::PI) / 4.0;
    let ours = lux(Method::Whitted, Emitter::Point, 2.0);
    assert!((ours / truth - 1.0).abs() < 5e-4, "{ours} for {truth}");
}

#[test]
fn a_near_panel_has_the_far_field_illuminance_which_is_too_high() {
    // light_and_camera.md: 90 x 120 cm, 1000 lm, half a metre away: 523.91 lx; by I / d^2, 1273.24.
    let panel = Emitter::RectPanel { width_m: 0.9, height_m: 1.2 };
    let whitted = lux(Method::Whitted, panel, 0.5);
    let direct = lux(Method::Direct, panel, 0.5);
    assert!((whitted / 1273.24 - 1.0).abs() < 1e-3, "{whitted}");
    assert!((direct / 523.91 - 1.0).abs() < 5e-3, "{direct}");
}

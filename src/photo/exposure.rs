//! Exposure equations (ISO 2720): from time-integrated luminance to picture values, EV and f-number.

use crate::scene::{Camera, FocusedLens, Scene};
use std::f32::consts::PI;

/// Returns the picture value of 1 cd s/m2 of time-integrated luminance: pi S T / (C N^2), with the transmission T of
/// [`lens_transmission`].
pub fn pixel_per_cd_s_m2(scene: &Scene) -> f32 {
    let camera = &scene.camera;
    PI * camera.iso / (camera.meter_constant * camera.f_number * camera.f_number)
        * lens_transmission(camera, &scene.focused_lens())
}

/// Returns the light on the sensor relative to the same f-number without a filter and focused at infinity: 2^-ND of an
/// ND filter of so many stops, and 1 / (1 + m)^2 of a lens that is focused near.
pub fn lens_transmission(camera: &Camera, lens: &FocusedLens) -> f32 {
    (-camera.nd_stops).exp2() * lens.bellows_transmission()
}

/// Returns the stops that a lens loses by near focus: 2 log2(1 + m).
pub fn bellows_stops(lens: &FocusedLens) -> f32 {
    2.0 * (1.0 + lens.magnification).log2()
}

/// Returns EV at ISO 100 of an illuminance, with the meter constant C in lux s.
pub fn ev100(illuminance_lux: f32, meter_constant: f32) -> f32 {
    (100.0 * illuminance_lux / meter_constant).log2()
}

/// Returns the f-number to set for a luminous exposure at the camera's ISO and shutter, behind its ND filter and at its
/// focus.
pub fn f_number_to_set(scene: &Scene, lux_s: f32) -> f32 {
    let camera = &scene.camera;
    let on_sensor = lux_s * lens_transmission(camera, &scene.focused_lens());
    f_number(on_sensor, camera.iso, camera.meter_constant)
}

/// Returns the luminous exposure for which [`f_number_to_set`] is an f-number, lux s.
pub fn lux_s_to_set(scene: &Scene, f_number: f32) -> f32 {
    lux_s_of(&scene.camera, &scene.focused_lens(), f_number)
}

/// Returns the luminous exposure that a camera with a lens needs at an f-number, lux s: C N^2 / (S T).
pub fn lux_s_of(camera: &Camera, lens: &FocusedLens, f_number: f32) -> f32 {
    f_number * f_number * camera.meter_constant / (camera.iso * lens_transmission(camera, lens))
}

/// Returns the f-number for a luminous exposure of continuous light (E t) plus flash (H), lux s: N^2 = (E t + H) S / C.
pub fn f_number(lux_s: f32, iso: f32, meter_constant: f32) -> f32 {
    (lux_s * iso / meter_constant).max(0.0).sqrt()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scene::Focus;

    #[test]
    fn a_metered_grey_card_has_the_picture_value_018() {
        // N from the meter for E t = 250 lux s at ISO 100 is 10; a card of 18 % then has Lt = 0.18 E t / pi.
        let camera = Camera { f_number: f_number(250.0, 100.0, 250.0), ..Camera::default() };
        assert!((camera.f_number - 10.0).abs() < 1e-6);
        let pixel = pixel_per_cd_s_m2(&Scene { camera, ..Scene::default() }) * 0.18 * 250.0 / PI;
        assert!((pixel - 0.18).abs() < 1e-7);
    }

    #[test]
    fn the_exposure_for_an_f_number_is_the_inverse_of_the_f_number_to_set() {
        let camera = Camera { iso: 200.0, nd_stops: 3.0, focus: Focus::Distance(0.4), ..Camera::default() };
        let scene = Scene { camera, ..Scene::default() };
        let lux_s = lux_s_to_set(&scene, 5.6);
        assert!((f_number_to_set(&scene, lux_s) / 5.6 - 1.0).abs() < 1e-6);
        // light_and_camera.md: f/8 at ISO 100 is 160 lux s.
        assert!((lux_s_to_set(&Scene::default(), 8.0) - 160.0).abs() < 1e-3);
    }

    #[test]
    fn filters_lose_their_stops_and_near_focus_loses_the_bellows_factor() {
        let with = |nd_stops: f32, distance_m: f32, focus_breathing: bool| {
            let focus = Focus::Distance(distance_m);
            let camera = Camera { nd_stops, focus, focus_breathing, focal_length_mm: 100.0, ..Camera::default() };
            pixel_per_cd_s_m2(&Scene { camera, ..Scene::default() })
        };
        let plain = with(0.0, 1.0, false);
        for stops in [1.0_f32, 3.0, 10.0, 1.0 / 3.0, 6.6] {
            let loss = -(with(stops, 1.0, false) / plain).log2();
            assert!((loss - stops).abs() < 1e-6, "{loss} for {stops} stops");
        }
        // At 1:1 the f-number counts twice: two stops.
        assert!(((with(0.0, 0.2, true) / plain).log2() + 2.0).abs() < 1e-5);
        assert!(((with(3.0, 0.2, true) / plain).log2() + 5.0).abs() < 1e-5);
        assert_eq!(with(0.0, 0.2, false), plain, "without breathing the focus does not change the exposure");
    }

    #[test]
    fn f_numbers_agree_with_printed_tables() {
        for (lux, n) in [(1000.0, 1.8), (2000.0, 2.5), (5000.0, 4.0), (10000.0, 5.6)] {
            let ours = f_number(lux / 125.0, 100.0, 250.0);
            assert!((ours / n).log2().abs() < 1.0 / 12.0, "{lux} lx: f/{ours}");
        }
        assert!((f_number(160.0, 100.0, 250.0) - 8.0).abs() < 1e-5);
    }
}

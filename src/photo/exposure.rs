//! Exposure equations (ISO 2720): from time-integrated luminance to picture values, EV and f-number.

use crate::scene::Camera;
use std::f32::consts::PI;

/// Returns the picture value of 1 cd s/m2 of time-integrated luminance: pi S / (C N^2).
pub fn pixel_per_cd_s_m2(camera: &Camera) -> f32 {
    PI * camera.iso / (camera.meter_constant * camera.f_number * camera.f_number)
}

/// Returns EV at ISO 100 of an illuminance, with the meter constant C in lux s.
pub fn ev100(illuminance_lux: f32, meter_constant: f32) -> f32 {
    (100.0 * illuminance_lux / meter_constant).log2()
}

/// Returns the f-number for a luminous exposure of continuous light (E t) plus flash (H), lux s: N^2 = (E t + H) S / C.
pub fn f_number(lux_s: f32, iso: f32, meter_constant: f32) -> f32 {
    (lux_s * iso / meter_constant).max(0.0).sqrt()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_metered_grey_card_has_the_picture_value_018() {
        // N from the meter for E t = 250 lux s at ISO 100 is 10; a card of 18 % then has Lt = 0.18 E t / pi.
        let camera = Camera { f_number: f_number(250.0, 100.0, 250.0), ..Camera::default() };
        assert!((camera.f_number - 10.0).abs() < 1e-6);
        let pixel = pixel_per_cd_s_m2(&camera) * 0.18 * 250.0 / PI;
        assert!((pixel - 0.18).abs() < 1e-7);
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

//! Exposure: from time-integrated luminance to picture values, and the meter's equations (ISO 2720).

use crate::scene::{Camera, Emitter, Light, Output};
use std::f32::consts::PI;

/// Picture value for one cd s/m2 of time-integrated luminance: pi S / (C N^2).
pub fn pixel_per_cd_s_m2(camera: &Camera) -> f32 {
    PI * camera.iso / (camera.meter_constant * camera.f_number * camera.f_number)
}

/// Time for which a light counts, seconds: the shutter for continuous light, 1 for flash (whose unit already holds
/// the seconds: lm s, cd s, lux s).
pub fn integration_time_s(output: &Output, camera: &Camera) -> f32 {
    if output.is_flash() { 1.0 } else { camera.shutter_s }
}

/// EV at ISO 100 of an illuminance, with the meter constant C in lux s.
pub fn ev100(illuminance_lux: f32, meter_constant: f32) -> f32 {
    (100.0 * illuminance_lux / meter_constant).log2()
}

/// The f-number for a luminous exposure of continuous light (E t) plus flash (H), lux s: N^2 = (E t + H) S / C.
pub fn f_number(lux_s: f32, iso: f32, meter_constant: f32) -> f32 {
    (lux_s * iso / meter_constant).max(0.0).sqrt()
}

/// How much light an emitter gives in the unit its formula wants, dial included. The unit is a photometric one for
/// continuous light and the same with seconds for flash.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Strength {
    /// Luminous flux, lm; or lm s.
    Flux(f32),
    /// Intensity on the axis, cd; or cd s.
    AxialIntensity(f32),
    /// Illuminance normal to the light (sun) or on a half-covered plane (surround), lx.
    Illuminance(f32),
}

/// Strength of a light with its dial and its modifier's loss applied. What a grid or a snoot cuts off beside the axis
/// is [`super::beam`]'s affair.
pub fn strength(light: &Light) -> Strength {
    let dial = light.power.dial_stops.exp2() * super::beam::transmittance(&light.modifier);
    match light.power.output {
        Output::Lumens(flux) => Strength::Flux(flux * dial),
        Output::Candela(intensity) => Strength::AxialIntensity(intensity * dial),
        Output::LuxAt { lux, distance_m } => Strength::AxialIntensity(lux * distance_m * distance_m * dial),
        Output::Lux(lux) => Strength::Illuminance(lux * dial),
        Output::FlashWs { energy_ws, efficacy_lm_s_per_ws } => Strength::Flux(energy_ws * efficacy_lm_s_per_ws * dial),
        // A guide number is stated for C = 250 lux s at ISO 100: H(1 m) = 2.5 GN^2.
        Output::FlashGuideNumber(guide_number) => Strength::AxialIntensity(2.5 * guide_number * guide_number * dial),
    }
}

/// Ratio of axial intensity to flux of a finite emitter, 1/sr: I = F x this. For point and sphere 1 / 4 pi, for
/// panels 1 / pi, for spots the formula of a cone that falls linearly in angle. None for sun and surround.
pub fn intensity_per_flux(emitter: &Emitter) -> Option<f32> {
    match *emitter {
        Emitter::Point | Emitter::Sphere { .. } => Some(1.0 / (4.0 * PI)),
        Emitter::RectPanel { .. } | Emitter::RoundPanel { .. } => Some(1.0 / PI),
        Emitter::Spot { inner_deg, outer_deg } => Some(1.0 / spot_solid_angle(inner_deg, outer_deg)),
        Emitter::Sun { .. } | Emitter::Surround => None,
    }
}

/// Effective solid angle of a spot: flux over axial intensity, sr. Full angles, degrees.
/// 2 pi (1 - (sin b - sin a) / (b - a)) with half angles a and b; the hard edge is its limit 2 pi (1 - cos a).
pub fn spot_solid_angle(inner_deg: f32, outer_deg: f32) -> f32 {
    let outer = f64::from(outer_deg.min(360.0) * 0.5).to_radians();
    let inner = f64::from(inner_deg.min(outer_deg) * 0.5).to_radians();
    // sin b - sin a = 2 cos((a + b)/2) sin((b - a)/2), so the quotient is cos(mean) sinc(half difference): no 0 / 0.
    let half_difference = 0.5 * (outer - inner);
    let sinc = if half_difference < 1e-9 { 1.0 } else { half_difference.sin() / half_difference };
    let quotient = (0.5 * (inner + outer)).cos() * sinc;
    (2.0 * std::f64::consts::PI * (1.0 - quotient)) as f32
}

/// Axial intensity of a finite light, cd (or cd s), dial included; 0 for sun and surround.
pub fn axial_intensity(light: &Light) -> f32 {
    match strength(light) {
        Strength::Flux(flux) => flux * intensity_per_flux(&light.emitter).unwrap_or(0.0),
        Strength::AxialIntensity(intensity) => intensity,
        Strength::Illuminance(_) => 0.0,
    }
}

/// Falloff of a spot at an angle from its axis, 1 inside, 0 outside, linear in angle between. Full angles, degrees.
pub fn spot_falloff(cos_angle: f32, inner_deg: f32, outer_deg: f32) -> f32 {
    let angle_deg = crate::math::safe_acos(cos_angle).to_degrees();
    let (inner, outer) = (0.5 * inner_deg.min(outer_deg), 0.5 * outer_deg);
    if angle_deg <= inner {
        1.0
    } else if angle_deg < outer {
        (outer - angle_deg) / (outer - inner)
    } else {
        0.0
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn hard_cones_have_the_tabulated_intensity() {
        // light_and_camera.md, 1000 lm.
        for (full_deg, candela) in [(15.0, 18603.0), (30.0, 4671.0), (60.0, 1188.0), (90.0, 543.0), (120.0, 318.0)] {
            let ours = 1000.0 / spot_solid_angle(full_deg, full_deg);
            assert!((ours / candela - 1.0).abs() < 1e-3, "{full_deg}: {ours}");
        }
    }

    #[test]
    fn a_soft_cone_keeps_its_flux() {
        // Integrate intensity over the sphere and get the flux back.
        let (inner, outer) = (30.0, 70.0);
        let steps = 200_000;
        let flux: f64 = (0..steps)
            .map(|i| {
                let theta = (i as f64 + 0.5) / steps as f64 * std::f64::consts::FRAC_PI_2;
                let weight = f64::from(spot_falloff(theta.cos() as f32, inner, outer));
                weight * 2.0 * std::f64::consts::PI * theta.sin() * std::f64::consts::FRAC_PI_2 / steps as f64
            })
            .sum();
        assert!((flux / f64::from(spot_solid_angle(inner, outer)) - 1.0).abs() < 1e-4);
    }

    #[test]
    fn a_metered_grey_card_lands_on_its_value() {
        // N from the meter for E t = 250 lux s at ISO 100 is 10; a card of 18 % then has Lt = 0.18 E t / pi.
        let camera = Camera { f_number: f_number(250.0, 100.0, 250.0), ..Camera::default() };
        assert!((camera.f_number - 10.0).abs() < 1e-6);
        let pixel = pixel_per_cd_s_m2(&camera) * 0.18 * 250.0 / PI;
        assert!((pixel - 0.18).abs() < 1e-7);
    }

    #[test]
    fn the_meter_agrees_with_the_printed_tables() {
        for (lux, n) in [(1000.0, 1.8), (2000.0, 2.5), (5000.0, 4.0), (10000.0, 5.6)] {
            let ours = f_number(lux / 125.0, 100.0, 250.0);
            assert!((ours / n).log2().abs() < 1.0 / 12.0, "{lux} lx: f/{ours}");
        }
        assert!((f_number(160.0, 100.0, 250.0) - 8.0).abs() < 1e-5);
    }
}

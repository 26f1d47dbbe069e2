//! The colour of a light behind its gel, as a camera balanced to some white sees it.

use crate::color::{rgb_from_kelvin, shift_kelvin, unit_luminance};
use crate::scene::{ColorSource, Gel, LightColor};
use glam::Vec3;

/// Returns the RGB of a light for a camera's white balance, scaled to luminance 1. A light stated in RGB has that
/// colour for a camera balanced to 5500 K daylight, and shifts with the balance as others do.
pub fn light_rgb(color: &LightColor, white_balance_k: f32) -> Vec3 {
    let mired = if let Gel::Mired(shift) = color.gel { shift } else { 0.0 };
    let source = match color.source {
        ColorSource::Kelvin(kelvin) => rgb_from_kelvin(shift_kelvin(kelvin, mired), white_balance_k),
        ColorSource::Rgb(rgb) => Vec3::from(rgb) * rgb_from_kelvin(shift_kelvin(5500.0, mired), white_balance_k),
    };
    let tint = if let Gel::Tint(tint) = color.gel { Vec3::from(tint) } else { Vec3::ONE };
    unit_luminance(source * tint)
}

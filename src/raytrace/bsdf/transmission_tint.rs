//! The colour of light that clear surfaces transmit.

use crate::math::safe_sqrt;
use glam::Vec3;

/// Returns the colour of light that is transmitted at a surface of this base colour: the base colour at a thin pane, its
/// square root at each face of a body, so that both faces together have the base colour (Burley 2015, "Extending the
/// Disney BRDF to a BSDF with Integrated Subsurface Scattering", section 5). Reflected light has no colour.
pub fn transmission_tint(base_color: Vec3, is_thin: bool) -> Vec3 {
    if is_thin { base_color } else { base_color.map(safe_sqrt) }
}

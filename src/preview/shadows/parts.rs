//! Subdivision of emitters that are large relative to their distance; each part has its own shadow map.
//!
//! A shadow map is seen from the centre of its emitter. A surface that faces away from the centre may still receive
//! light from one end of a strip light, but seen from the centre the body itself occludes it. The parts' visibilities
//! are weighted by their irradiance.

use crate::preview::geometry::oriented_box::OrientedBox;
use crate::preview::lights::light_table::{GpuLight, LightKind};
use glam::{Vec2, Vec3};
use std::f32::consts::PI;

/// Maximum number of parts of an emitter.
pub(crate) const MAX_PARTS: usize = 4;
/// Half diagonal over the distance to the nearest caster above which an emitter is subdivided.
const SUBDIVISION_RATIO: f32 = 0.4;
/// Aspect ratio above which a panel is split along its length alone.
const LONG_ASPECT: f32 = 2.0;

/// A part of an emitter.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct EmitterPart {
    /// Its centre, in half axes of the emitter.
    pub at: Vec2,
    /// Half axes of the part as the penumbra depends on them, metres.
    pub softness: Vec2,
}

/// Returns the parts of a light's emitter; one for most lights.
pub(crate) fn emitter_parts(light: &GpuLight, casters: &[OrientedBox]) -> Vec<EmitterPart> {
    let softness = light.softness();
    let whole = vec![EmitterPart { at: Vec2::ZERO, softness }];
    let half = Vec2::new(Vec3::from(light.right).length(), Vec3::from(light.up).length());
    let nearest = casters.iter().map(|caster| caster.distance(light.position.into())).fold(f32::INFINITY, f32::min);
    let is_panel = light.kind == LightKind::Rect as u32 || light.kind == LightKind::Disc as u32;
    if !is_panel || half.length() < SUBDIVISION_RATIO * nearest {
        return whole;
    }
    if half.max_element() > LONG_ASPECT * half.min_element() {
        let along = if half.x > half.y { Vec2::X } else { Vec2::Y };
        let softness = softness / (Vec2::ONE + 2.0 * along);
        return [0.0, -2.0 / 3.0, 2.0 / 3.0].map(|step| EmitterPart { at: step * along, softness }).to_vec();
    }
    // Centroids of the quarters of a rectangle, or of a disc
    let step = if light.kind == LightKind::Rect as u32 { 0.5 } else { 4.0 / (3.0 * PI) };
    let corners = [Vec2::new(-1.0, -1.0), Vec2::new(1.0, -1.0), Vec2::new(-1.0, 1.0), Vec2::ONE];
    corners.map(|corner| EmitterPart { at: step * corner, softness: 0.5 * softness }).to_vec()
}

#[cfg(test)]
mod tests {
    use super::*;
    use bytemuck::Zeroable;
    use glam::Affine3A;

    fn panel(kind: LightKind, half_width: f32, half_height: f32) -> GpuLight {
        GpuLight {
            kind: kind as u32,
            right: [half_width, 0.0, 0.0],
            up: [0.0, half_height, 0.0],
            axis: [0.0, 0.0, -1.0],
            ..GpuLight::zeroed()
        }
    }

    fn caster_at(z: f32) -> OrientedBox {
        let world_from_object = Affine3A::from_translation(Vec3::Z * z);
        OrientedBox { world_from_object, low: Vec3::splat(-0.5), high: Vec3::splat(0.5), body_of: None }
    }

    #[test]
    fn only_emitters_large_relative_to_their_distance_are_subdivided() {
        let (near, far) = ([caster_at(-1.5)], [caster_at(-5.5)]);
        for (light, count) in [
            (panel(LightKind::Rect, 0.15, 0.8), 3),
            (panel(LightKind::Rect, 0.8, 0.15), 3),
            (panel(LightKind::Rect, 0.5, 0.7), 4),
            (panel(LightKind::Disc, 0.6, 0.6), 4),
            (panel(LightKind::Sphere, 0.6, 0.6), 1),
        ] {
            assert_eq!(emitter_parts(&light, &near).len(), count);
            assert_eq!(emitter_parts(&light, &far).len(), 1);
        }
    }

    #[test]
    fn the_parts_have_the_centroid_and_the_area_of_the_emitter() {
        for light in
            [panel(LightKind::Rect, 0.15, 0.8), panel(LightKind::Rect, 0.5, 0.7), panel(LightKind::Disc, 0.6, 0.6)]
        {
            let parts = emitter_parts(&light, &[caster_at(-1.0)]);
            let centroid: Vec2 = parts.iter().map(|part| part.at).sum();
            assert!(centroid.length() < 1e-6);
            let area: f32 = parts.iter().map(|part| PI * part.softness.element_product()).sum();
            assert!((area / light.area_m2() - 1.0).abs() < 1e-5, "{area}");
        }
    }
}

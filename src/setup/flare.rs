//! Lights that shine at the lens.

use super::light_shape::LightShape;
use super::metering::MeteredSetup;
use crate::math::angle_between;
use crate::scene::{Emitter, Light};

/// Angle outside of the picture's corners in which a light that shines at the camera flares, degrees.
const FLARE_DEG: f32 = 20.0;
/// Angle from the axis of a panel in which it lights the lens, degrees.
const PANEL_BEAM_DEG: f32 = 60.0;

impl MeteredSetup<'_> {
    /// Returns the lights in the picture, or just outside of it, that shine at the lens with nothing between. Angles
    /// alone: not what a lens makes of it.
    pub fn flaring_lights(&self) -> impl Iterator<Item = &Light> {
        let lights = self.scene.lights.iter().filter(|light| light.on);
        lights.filter(|light| LightShape::new(self.scene, light).is_some_and(|shape| self.flares(light, &shape)))
    }

    fn flares(&self, light: &Light, shape: &LightShape) -> bool {
        let camera = self.scene.camera.position;
        let frame = self.scene.camera_frame(self.scene.camera.aspect());
        let corner_deg = frame.half_extent.length().atan().to_degrees();
        let to_camera = (camera - light.position).normalize_or_zero();
        let beam_deg = match light.emitter {
            Emitter::Spot { outer_deg, .. } if light.photometric_file.is_none() => 0.5 * outer_deg,
            Emitter::Spot { .. } | Emitter::Point | Emitter::Sphere { .. } => 180.0,
            _ => PANEL_BEAM_DEG,
        };
        // Angles of grids and dishes go from edge to edge
        let cuts = [light.modifier.grid_deg, light.modifier.beam.map(|beam| beam.outer_deg)];
        let beam_deg = cuts.into_iter().flatten().fold(beam_deg, |beam_deg, cut| beam_deg.min(0.5 * cut));
        angle_between(shape.axis, to_camera).to_degrees() < beam_deg
            && angle_between(frame.forward(), -to_camera).to_degrees() < corner_deg + FLARE_DEG
            && self.is_clear(light.position, camera)
    }
}

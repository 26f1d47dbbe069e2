//! The lamps and the camera of a model in a studio: moved and scaled with the model.

use super::model::ModelSetUp;
use crate::photo::exposure;
use crate::scene::{Aim, Camera, FocusedLens, Light, Mesh, Output, Transform};
use glam::Vec3;

/// Illuminance that an average picture is exposed for, lx s: where the lamps' light is metered.
const METERED_LUX_S: [f32; 2] = [0.1, 1e6];

impl ModelSetUp {
    /// Returns true if there is nothing to take over.
    pub fn is_empty(&self) -> bool {
        self.lights.is_empty() && self.camera.is_none()
    }

    /// Returns the lights and the camera as they stand around a model with a transform. A model in centimetres is a
    /// hundredth as large, and its lamps give as much light at its surface. The camera aims at the model's middle depth.
    pub fn around(&self, transform: &Transform, mesh: &Mesh) -> (Vec<Light>, Option<Camera>) {
        let scale = transform.scale.x.abs();
        let world_from_model = transform.world_from_object();
        let (low, high) = mesh.bounds();
        let middle = world_from_model.transform_point3(0.5 * (low + high));
        let point = |position: Vec3| world_from_model.transform_point3(position);
        let aim = |position: Vec3, aim: &Aim| match *aim {
            Aim::Point(target) => {
                let forward = (point(target) - point(position)).normalize_or(Vec3::NEG_Z);
                let distance = (middle - point(position)).dot(forward).max(0.1);
                Aim::Point(point(position) + forward * distance)
            }
            other => other,
        };
        let light = |light: &Light| {
            let mut placed =
                Light { position: point(light.position), aim: aim(light.position, &light.aim), ..light.clone() };
            if let Output::Candela(intensity) = &mut placed.power.output {
                *intensity *= scale * scale;
            }
            placed
        };
        let camera = self.camera.as_ref().map(|camera| Camera {
            position: point(camera.position),
            aim: aim(camera.position, &camera.aim),
            ..camera.clone()
        });
        (self.lights.iter().map(light).collect(), camera)
    }
}

/// Sets the shutter of a camera with a lens for the light of lamps at a point that faces them, to its f-number, ISO and
/// filter. Light that is too weak or too strong for a picture leaves it as it is.
pub fn expose_for_lamps(camera: &mut Camera, lens: &FocusedLens, lamps: &[Light], point: Vec3) {
    let lux: f32 = lamps.iter().map(|lamp| lux_at(lamp, point)).sum();
    let seconds = exposure::lux_s_of(camera, lens, camera.f_number) / lux;
    if (METERED_LUX_S[0]..=METERED_LUX_S[1]).contains(&lux) {
        camera.shutter_s = seconds.clamp(1.0 / 8000.0, 30.0);
    }
}

/// Returns the illuminance of a lamp of a model at a point that faces it, lx.
fn lux_at(light: &Light, point: Vec3) -> f32 {
    match (light.power.output, light.emitter) {
        (Output::Lux(lux), _) => lux,
        (Output::Candela(intensity), _) => intensity / light.position.distance_squared(point).max(1e-4),
        _ => 0.0,
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scene::{Emitter, Scene};

    #[test]
    fn a_filter_before_the_lens_was_left_out_of_the_exposure_for_lamps() {
        let lamps = [Light::new(Emitter::Point, Output::Lux(2000.0))];
        let shutter_s = |nd_stops: f32| {
            let scene = Scene { camera: Camera { nd_stops, ..Camera::default() }, ..Scene::default() };
            let mut camera = scene.camera.clone();
            expose_for_lamps(&mut camera, &scene.focused_lens(), &lamps, Vec3::ZERO);
            let exposed = exposure::f_number_to_set(&scene, 2000.0 * camera.shutter_s);
            assert!((exposed / camera.f_number - 1.0).abs() < 1e-5, "f/{exposed} behind {nd_stops} stops");
            camera.shutter_s
        };
        assert!((shutter_s(3.0) / shutter_s(0.0) - 8.0).abs() < 1e-4);
    }
}

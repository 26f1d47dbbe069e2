//! A scene prepared for the light meter.

use crate::photo::light_rgb;
use crate::photo::meter::LightReading;
use crate::raytrace::film::Layer;
use crate::raytrace::geometry_cache::GeometryCache;
use crate::raytrace::lights::TracedLight;
use crate::raytrace::prepare::{PrepareError, Viewpoint, prepare_all};
use crate::raytrace::render_scene::RenderScene;
use crate::scene::{Assets, Light, LightId, Scene};
use glam::Vec3;

/// A scene with one layer per light.
#[derive(Debug)]
pub struct MeteredStudio {
    /// The scene; its layers are those of `lights`, and one of emissive surfaces.
    pub scene: RenderScene,
    /// The lights with any output, in the scene's order.
    pub lights: Vec<MeteredLight>,
    /// Some surface is emissive.
    pub has_emission: bool,
    /// Exposure time of continuous light, seconds.
    pub shutter_s: f32,
}

/// A light with any output.
#[derive(Debug)]
pub struct MeteredLight {
    /// The scene's light.
    pub id: LightId,
    /// Its reading without light.
    pub blank: LightReading,
    /// Its colour.
    pub rgb: Vec3,
}

impl MeteredStudio {
    /// Prepares a scene; points near `around` (world space) are read most precisely.
    pub fn new(scene: &Scene, assets: &Assets, around: Vec3, cache: &GeometryCache) -> Result<Self, PrepareError> {
        let mut prepared = prepare_all(scene, assets, &Viewpoint::at(around), one_layer_per_light, cache)?;
        // Emissive surfaces are read in lux, like any continuous light.
        prepared.emission_time_s = 1.0;
        prepared.aggregate.show_bodies();
        let metered = |layer: &Layer| {
            let light = layer.light.and_then(|id| scene.light(id))?;
            let rgb = light_rgb(&light.color, scene.camera.white_balance_k);
            Some(MeteredLight { id: light.id, blank: blank_reading(light), rgb })
        };
        let lights = prepared.layers.iter().filter_map(metered).collect();
        let has_emission = prepared.materials.iter().any(|material| material.is_emissive());
        Ok(MeteredStudio { scene: prepared, lights, has_emission, shutter_s: scene.camera.shutter_s })
    }

    /// Layer of emissive surfaces.
    pub fn emission_layer(&self) -> usize {
        self.lights.len()
    }
}

/// Assigns each light a layer of its own with white light, however many there are.
fn one_layer_per_light(_scene: &Scene, lights: &mut [(TracedLight, &Light)]) -> Vec<Layer> {
    for (layer, (traced, _)) in lights.iter_mut().enumerate() {
        traced.layer = layer;
        // Make all lights equally important for light sampling: each has a reading with its own relative error, which
        // is proportional to its power, to the last digit.
        traced.time_s = 1.0 / traced.output;
        // A path from the receptor must not see emitters, which are found by light sampling.
        traced.hide_from_camera();
    }
    lights.iter().map(|(_, light)| Layer::of_light(light)).chain([Layer::shared("Glow")]).collect()
}

/// Returns a reading without light.
pub fn blank_reading(light: &Light) -> LightReading {
    LightReading {
        light: Some(light.id),
        name: light.name.clone(),
        role: Some(light.role),
        flash: light.power.output.is_flash(),
        direct: 0.0,
        bounced: 0.0,
        standard_error: 0.0,
    }
}

//! Film layers: one per light, so that lights can be dimmed and coloured after the render.

use crate::photo::{PhotometricLight, Strength};
use crate::raytrace::lights::TracedLight;
use crate::scene::{Light, LightId, Scene};
use glam::Vec3;

/// The largest number of lights with a layer each; above it, lights of one role share a layer.
pub const MAX_LIGHT_LAYERS: usize = 16;

/// The source of a film layer's light, and its output when it was traced.
#[derive(Clone, Debug, PartialEq)]
pub struct Layer {
    /// The light's name, the role of a group, or `Glow` for emissive surfaces.
    pub name: String,
    /// The light of a layer that holds a single one.
    pub light: Option<LightId>,
    /// Output that was traced; the layer scales by it when the light is changed later.
    traced: Option<Strength>,
    /// Colours and times are included in the sums (shared layers).
    finished: bool,
}

impl Layer {
    /// The layer of one light.
    pub fn of_light(light: &Light) -> Self {
        Layer { name: light.name.clone(), light: Some(light.id), traced: Some(Strength::new(light)), finished: false }
    }

    /// A layer that several sources share.
    pub fn shared(name: &str) -> Self {
        Layer { name: name.to_owned(), light: None, traced: None, finished: true }
    }

    /// Factor from the traced white luminance to time-integrated, coloured luminance (cd s/m2) with the light's power,
    /// colour and switch in `scene`.
    pub(in crate::raytrace) fn weight(&self, scene: &Scene) -> Vec3 {
        if self.finished {
            return Vec3::ONE;
        }
        let light = self.light.and_then(|id| scene.light(id)).filter(|light| light.on);
        let (Some(light), Some(traced)) = (light, self.traced) else { return Vec3::ZERO };
        let light = PhotometricLight::new(scene, light);
        light.tint * (light.output_ratio(traced) * light.exposure_time_s)
    }
}

/// Colour times exposure time of a light in a shared layer.
fn shared_layer_tint(light: &Light, scene: &Scene) -> Vec3 {
    let light = PhotometricLight::new(scene, light);
    light.tint * light.exposure_time_s
}

/// Assigns each light its layer: one per light, or one per role above [`MAX_LIGHT_LAYERS`]. The last layer holds
/// emissive surfaces.
pub fn assign_layers(scene: &Scene, lights: &mut [(TracedLight, &Light)]) -> Vec<Layer> {
    if lights.len() > MAX_LIGHT_LAYERS {
        return share_layers(scene, lights);
    }
    let one = |(index, (traced, light)): (usize, &mut (TracedLight, &Light))| {
        traced.layer = index;
        Layer::of_light(light)
    };
    let layers = lights.iter_mut().enumerate().map(one);
    layers.chain([Layer::shared("Glow")]).collect()
}

/// Assigns the lights of each role a layer, for many lights and for little memory. The last layer holds emissive
/// surfaces.
pub fn share_layers(scene: &Scene, lights: &mut [(TracedLight, &Light)]) -> Vec<Layer> {
    let mut layers: Vec<Layer> = Vec::new();
    for (traced, light) in lights {
        let name = format!("{} lights", light.role.label());
        let known = layers.iter().position(|layer| layer.name == name);
        traced.layer = known.unwrap_or(layers.len());
        traced.tint = shared_layer_tint(light, scene);
        if known.is_none() {
            layers.push(Layer::shared(&name));
        }
    }
    layers.push(Layer::shared("Glow"));
    layers
}

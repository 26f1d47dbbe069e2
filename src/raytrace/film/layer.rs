//! Film layers: one per light, so that lights can be dimmed and coloured after the render.

use crate::photo::light::{integration_time_s, output_ratio};
use crate::photo::{Strength, light_rgb};
use crate::raytrace::lights::TracedLight;
use crate::scene::{Light, LightId, Role, Scene};
use glam::Vec3;
use std::collections::HashMap;

/// The largest number of lights with a layer each; above it, lights of one role share a layer.
pub const MAX_LIGHT_LAYERS: usize = 16;

/// The source of a film layer's light, and its output when it was traced.
#[derive(Clone, Debug, PartialEq)]
pub struct Layer {
    /// The light's name, the role of a group, or `Glow` for emissive surfaces.
    pub name: String,
    /// The light of a layer that holds a single one.
    pub light: Option<LightId>,
    /// Output that was traced; the layer scales by it when the light is changed later. None for a shared layer, whose
    /// sums include colours and times.
    traced: Option<Strength>,
    /// The lights of a shared layer.
    members: Vec<Member>,
}

/// A light of a shared layer, as it was traced.
#[derive(Clone, Debug, PartialEq)]
struct Member {
    light: LightId,
    strength: Strength,
    /// Colour times exposure time.
    tint: Vec3,
}

impl Member {
    fn new(light: &Light, tint: Vec3) -> Self {
        Member { light: light.id, strength: Strength::new(light), tint }
    }

    /// Returns the factor of the light from what was traced to what it is in `scene`, by channel; none where it had and
    /// has no light of the channel.
    fn factor(&self, scene: &Scene, lights: &HashMap<LightId, &Light>) -> [Option<f32>; 3] {
        let light = lights.get(&self.light).filter(|light| light.on);
        let now = light.map_or(Vec3::ZERO, |light| exposed_tint(light, scene) * output_ratio(light, self.strength));
        [0, 1, 2]
            .map(|channel| (self.tint[channel] > 0.0 || now[channel] > 0.0).then(|| now[channel] / self.tint[channel]))
    }
}

impl Layer {
    /// The layer of one light.
    pub fn of_light(light: &Light) -> Self {
        let traced = Some(Strength::new(light));
        Layer { name: light.name.clone(), light: Some(light.id), traced, members: Vec::new() }
    }

    /// A layer that several sources share, as yet without lights.
    pub fn shared(name: &str) -> Self {
        Layer { name: name.to_owned(), light: None, traced: None, members: Vec::new() }
    }

    /// Returns the name of the layer that the lights of a role share.
    pub fn name_of_role(role: Role) -> String {
        format!("{} lights", role.label())
    }

    /// The layer that the lights of a role share, of those that are on.
    pub fn of_role(role: Role, scene: &Scene) -> Self {
        let lights = scene.lights.iter().filter(|light| light.on && light.role == role);
        let members = lights.map(|light| Member::new(light, exposed_tint(light, scene))).collect();
        Layer { members, ..Layer::shared(&Self::name_of_role(role)) }
    }

    /// Returns the lights whose light the layer holds; none for that of emissive surfaces.
    pub fn lights(&self) -> impl Iterator<Item = LightId> + '_ {
        self.light.into_iter().chain(self.members.iter().map(|member| member.light))
    }

    /// Returns the factor from the traced light to that of `scene`, if all lights of a shared layer have the same one;
    /// none if they have not, so that they must be traced again.
    pub fn shared_factor(&self, scene: &Scene) -> Option<Vec3> {
        // Relative difference of factors by which they count as different: rounding is far smaller, a third of a stop larger
        const TOLERANCE: f32 = 1e-3;
        if self.members.is_empty() {
            return Some(Vec3::ONE);
        }
        let lights: HashMap<LightId, &Light> = scene.lights.iter().map(|light| (light.id, light)).collect();
        let factors: Vec<[Option<f32>; 3]> = self.members.iter().map(|member| member.factor(scene, &lights)).collect();
        let mut common = [0.0; 3];
        for (channel, common) in common.iter_mut().enumerate() {
            let mut known = factors.iter().filter_map(|factor| factor[channel]);
            let first = known.next().unwrap_or(0.0);
            if !first.is_finite() || !{ known }.all(|factor| (factor - first).abs() <= TOLERANCE * first) {
                return None;
            }
            *common = first;
        }
        Some(Vec3::from(common))
    }

    /// Factor from the traced white luminance to time-integrated, coloured luminance (cd s/m2) with the light's power,
    /// colour and switch in `scene`.
    pub(in crate::raytrace) fn weight(&self, scene: &Scene) -> Vec3 {
        // What a shared layer can't follow is marked as out of date
        let Some(traced) = self.traced else { return self.shared_factor(scene).unwrap_or(Vec3::ONE) };
        let light = self.light.and_then(|id| scene.light(id)).filter(|light| light.on);
        let Some(light) = light else { return Vec3::ZERO };
        exposed_tint(light, scene) * output_ratio(light, traced)
    }
}

/// Colour times exposure time of a light.
fn exposed_tint(light: &Light, scene: &Scene) -> Vec3 {
    light_rgb(&light.color, scene.camera.white_balance_k) * integration_time_s(&light.power.output, &scene.camera)
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
        let name = Layer::name_of_role(light.role);
        let known = layers.iter().position(|layer| layer.name == name);
        traced.layer = known.unwrap_or(layers.len());
        traced.tint = exposed_tint(light, scene);
        if known.is_none() {
            layers.push(Layer::shared(&name));
        }
        layers[traced.layer].members.push(Member::new(light, traced.tint));
    }
    layers.push(Layer::shared("Glow"));
    layers
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::raytrace::{RenderControl, Settings, is_up_to_date, prepare, render};
    use crate::scene::{Assets, Emitter, Output, Room};
    use std::ops::ControlFlow;

    /// Returns a room with so many key lights and fill lights, a warm one among each.
    fn studio(keys: u32, fills: u32) -> Scene {
        let light = |id: u32| {
            let mut light = Light::new(Emitter::Sphere { radius_m: 0.05 }, Output::Lumens(500.0));
            (light.id, light.name) = (LightId(id), format!("Light {id}"));
            light.position = Vec3::new(0.2 * id as f32 - 1.8, 2.0, 0.5);
            light.role = if id < keys { Role::Key } else { Role::Fill };
            if id == 0 || id == keys {
                light.color.source = crate::scene::ColorSource::Rgb([1.0, 0.4, 0.0]);
            }
            light
        };
        Scene { room: Some(Room::default()), lights: (0..keys + fills).map(light).collect(), ..Scene::default() }
    }

    #[test]
    fn lights_of_a_shared_layer_are_dimmed_and_switched_together_without_tracing() {
        let scene = studio(9, 9);
        let settings = Settings { width: 24, height: 16, spp: 4, ..Settings::default() };
        let film = |scene: &Scene| {
            let prepared = prepare(scene, &Assets::default()).unwrap();
            render(&prepared, &settings, &RenderControl::new(), &mut |_| ControlFlow::Continue(()))
        };
        let traced = film(&scene);
        assert_eq!(traced.layers().iter().map(|layer| layer.lights().count()).collect::<Vec<_>>(), [9, 9, 0]);
        assert_eq!(traced.layers()[0].shared_factor(&scene), Some(Vec3::ONE));
        let changed = |change: &dyn Fn(&mut Light)| {
            let mut scene = scene.clone();
            scene.lights.iter_mut().filter(|light| light.role == Role::Key).for_each(change);
            scene
        };
        let dimmed = changed(&|light| light.power.dial_stops -= 1.0);
        let off = changed(&|light| light.on = false);
        let [_, (_, fill), _] = &traced.develop_layers(&scene)[..] else { panic!("three layers") };
        assert!(is_up_to_date(traced.layers(), &scene, &dimmed) && is_up_to_date(traced.layers(), &scene, &off));
        assert_eq!(traced.develop(&off), *fill);
        let mean = |film: &super::super::Film, scene: &Scene| {
            film.develop(scene).rgb.iter().flatten().sum::<f32>() / film.develop(scene).rgb.len() as f32
        };
        let again = mean(&film(&dimmed), &dimmed);
        assert!((mean(&traced, &dimmed) / again - 1.0).abs() < 0.02, "{} {again}", mean(&traced, &dimmed));
        // One light alone, another place, or another colour of some
        let mut one = scene.clone();
        one.lights[3].power.dial_stops -= 1.0;
        assert!(!is_up_to_date(traced.layers(), &scene, &one));
        let moved = changed(&|light| light.position.y += 0.1);
        assert!(!is_up_to_date(traced.layers(), &scene, &moved));
        let warmer = changed(&|light| light.color.source = crate::scene::ColorSource::Kelvin(3000.0));
        assert!(!is_up_to_date(traced.layers(), &scene, &warmer), "one of them was of another colour");
    }
}

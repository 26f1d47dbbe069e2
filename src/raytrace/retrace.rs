//! Decides which part of a traced film a change of the scene makes stale.
//!
//! A film with one layer a light is developed again for free: power, colour and switch of a light are factors of its
//! layer. Everything else is traced again, one light or the whole picture.

use super::film::{Layer, MAX_LIGHT_LAYERS};
use super::moments;
use crate::scene::{LightChange, LightId, Scene, SceneChange};
use std::collections::HashMap;

/// The part of a film that must be traced again, primary rays aside.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Retrace {
    /// Developing the film gives the picture.
    Nothing,
    /// These lights' layers; none where lights with a layer were removed and no other differs.
    Lights(Vec<LightId>),
    /// All layers.
    Everything,
}

impl Retrace {
    /// Returns true if developing the film gives the picture.
    pub fn is_developable(&self) -> bool {
        match self {
            Retrace::Nothing => true,
            Retrace::Lights(lights) => lights.is_empty(),
            Retrace::Everything => false,
        }
    }

    /// Interprets a change from `traced` to `now` for a film of `layers` that was traced from `traced`.
    pub fn after(change: &SceneChange, layers: &[Layer], traced: &Scene, now: &Scene) -> Self {
        // Layers that several lights share have exposure times and colours baked in. Emission has the shutter's time.
        let is_grouped = is_grouped(layers);
        let has_baked_time = is_grouped || traced.has_emissive_material();
        if change.geometry
            || change.materials
            || moments::differ(traced, now)
            || (change.shutter && has_baked_time)
            || (change.white_balance && is_grouped)
        {
            return Retrace::Everything;
        }
        let regroups = is_grouped || now.lights.iter().filter(|light| light.on).count() > MAX_LIGHT_LAYERS;
        // The lights of shared layers, with whether all of their layer have changed alike
        let mut dimmed_alike = HashMap::new();
        for layer in layers.iter().filter(|layer| layer.light.is_none() && !change.lights.is_empty()) {
            let is_alike = layer.shared_factor(now).is_some();
            dimmed_alike.extend(layer.lights().map(|light| (light, is_alike)));
        }
        let mut lights = Vec::new();
        for light in &change.lights {
            let has_layer = layers.iter().any(|layer| layer.light == Some(light.id));
            let hides = light.visible && light.was_on != light.is_on;
            if dimmed_alike.get(&light.id) == Some(&true) && !light.transport && !hides {
                continue;
            }
            match light_retrace(light, has_layer, regroups) {
                LightRetrace::Nothing => {}
                LightRetrace::Light => lights.push(light.id),
                LightRetrace::Everything => return Retrace::Everything,
            }
        }
        let is_pruned = change.lights.iter().any(|light| light.removed && light.was_on);
        if lights.is_empty() && !is_pruned { Retrace::Nothing } else { Retrace::Lights(lights) }
    }
}

/// Returns true if lights share layers. The last layer is that of emissive surfaces.
fn is_grouped(layers: &[Layer]) -> bool {
    layers.iter().filter(|layer| layer.light.is_none()).count() > 1
}

enum LightRetrace {
    Nothing,
    Light,
    Everything,
}

fn light_retrace(light: &LightChange, has_layer: bool, regroups: bool) -> LightRetrace {
    let LightChange { id: _, was_on, is_on, removed: _, visible, weight: _, transport } = *light;
    let is_switched = was_on != is_on;
    if !was_on && !is_on {
        LightRetrace::Nothing
    } else if regroups || (visible && (is_switched || transport)) {
        // An emitter that the camera sees hides what lies behind it, in every layer.
        LightRetrace::Everything
    } else if !is_on || (has_layer && !transport) {
        LightRetrace::Nothing
    } else {
        LightRetrace::Light
    }
}

/// Returns true if developing a film of `layers`, rendered from `rendered`, gives what a render of `now` would show.
pub fn is_up_to_date(layers: &[Layer], rendered: &Scene, now: &Scene) -> bool {
    let change = SceneChange::between(rendered, now);
    !change.moves_camera_rays(now.camera.depth_of_field)
        && Retrace::after(&change, layers, rendered, now).is_developable()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scene::{ColorSource, Emitter, Focus, Light, Material, Output, Room, Solo};

    fn studio(lights: u32) -> Scene {
        let light = |id| Light { id: LightId(id), ..Light::new(Emitter::Point, Output::Lumens(1000.0)) };
        Scene { lights: (0..lights).map(light).collect(), ..Scene::default() }
    }

    /// The layers of a film traced from a scene.
    fn layers(scene: &Scene) -> Vec<Layer> {
        let lit = || scene.lights.iter().filter(|light| light.on);
        let grouped = lit().count() > MAX_LIGHT_LAYERS;
        let of_lights = lit().filter(|_| !grouped).map(Layer::of_light);
        let shared = if grouped { &["Key lights", "Glow"][..] } else { &["Glow"] };
        of_lights.chain(shared.iter().map(|name| Layer::shared(name))).collect()
    }

    fn up_to_date(rendered: &Scene, edit: impl FnOnce(&mut Scene)) -> bool {
        let mut now = rendered.clone();
        edit(&mut now);
        is_up_to_date(&layers(rendered), rendered, &now)
    }

    #[test]
    fn muting_soloing_and_locking_after_a_render_leave_the_picture_up_to_date() {
        // The mark "Out of date" compared mute, solo and lock, although the picture had just been relit rightly.
        let studio = studio(3);
        assert!(up_to_date(&studio, |s| (s.lights[0].on, s.lights[0].muted) = (false, true)));
        assert!(up_to_date(&studio, |s| {
            s.solo = Some(Solo { lights: vec![LightId(1)], restores: vec![LightId(0), LightId(1), LightId(2)] });
            (s.lights[0].on, s.lights[2].on) = (false, false);
        }));
        assert!(up_to_date(&studio, |s| s.lights[0].locked = true));
    }

    #[test]
    fn weights_are_developed_and_the_rest_is_traced() {
        let studio = studio(3);
        assert!(up_to_date(&studio, |s| s.lights[0].power.dial_stops = -2.0));
        assert!(up_to_date(&studio, |s| s.lights[0].color.source = ColorSource::Kelvin(3200.0)));
        assert!(up_to_date(&studio, |s| drop(s.lights.remove(1))), "a removed light has no weight");
        assert!(up_to_date(&studio, |s| (s.camera.shutter_s, s.camera.white_balance_k) = (1.0, 3000.0)));
        assert!(up_to_date(&studio, |s| s.camera.f_number = 1.4));
        assert!(up_to_date(&studio, |s| s.camera.nd_stops = 6.0));
        assert!(up_to_date(&studio, |s| s.camera.focus = Focus::Distance(1.0)), "a pinhole has no focus");
        assert!(!up_to_date(&studio, |s| s.camera.focus_breathing = true));
        assert!(!up_to_date(&studio, |s| s.lights[0].position.x += 1.0));
        assert!(up_to_date(&studio, |s| (s.lights[0].on, s.lights[0].position.x) = (false, 1.0)), "it is off");
        assert!(!up_to_date(&studio, |s| s.camera.position.x += 1.0));
        assert!(!up_to_date(&studio, |s| s.room = Some(Room::default())));
        let added = |s: &mut Scene| s.lights.push(Light { id: LightId(9), ..s.lights[0].clone() });
        assert!(!up_to_date(&studio, added));
    }

    #[test]
    fn lights_without_a_layer_of_their_own_are_traced_again() {
        let many = studio(MAX_LIGHT_LAYERS as u32 + 1);
        let mut studio = studio(2);
        studio.lights[0].on = false;
        assert!(!up_to_date(&studio, |s| s.lights[0].on = true), "it was off when the film was traced");
        assert!(up_to_date(&studio, |s| s.lights[0].position.x += 1.0));
        assert!(!up_to_date(&many, |s| s.lights[0].power.dial_stops = -1.0));
        assert!(!up_to_date(&many, |s| s.camera.shutter_s = 1.0));
        assert!(!up_to_date(&many, |s| s.camera.white_balance_k = 3000.0));
        assert!(up_to_date(&many, |s| s.camera.iso = 400.0));
    }

    #[test]
    fn emission_depth_of_field_and_visible_emitters_bind_what_a_film_can_follow() {
        let mut studio = studio(2);
        let glowing = Material { emission_cd_m2: [100.0; 3], ..Material::default() };
        studio.room = Some(Room { ceiling: glowing, ..Room::default() });
        assert!(!up_to_date(&studio, |s| s.camera.shutter_s = 1.0));
        assert!(up_to_date(&studio, |s| s.camera.white_balance_k = 3000.0));
        studio.room = None;
        studio.camera.depth_of_field = true;
        assert!(!up_to_date(&studio, |s| s.camera.f_number = 1.4));
        studio.lights[0].visible_to_camera = true;
        assert!(!up_to_date(&studio, |s| s.lights[0].on = false), "it hid what lies behind it");
        assert!(up_to_date(&studio, |s| s.lights[0].power.dial_stops = -1.0));
    }
}

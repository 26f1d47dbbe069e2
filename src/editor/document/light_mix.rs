//! Changes of lights over the finished picture, to be tried before they are made in the studio.

use crate::editor::document::action::Action;
use crate::photo::dial_text;
use crate::raytrace::Layer;
use crate::scene::{BeyondDial, ColorSource, Light, LightId, Scene};
use std::borrow::Cow;
use std::collections::{HashMap, HashSet};

/// The change of a light.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Fader {
    /// Thirds of a stop over the studio's dial.
    pub thirds: i32,
    /// Colour temperature, kelvin; none leaves the studio's colour.
    pub kelvin: Option<f32>,
    /// Off.
    pub muted: bool,
    /// On alone, with others that are soloed.
    pub soloed: bool,
}

impl Fader {
    fn is_neutral(&self) -> bool {
        *self == Fader::default()
    }

    /// Returns the light as the fader changes it; whether it is on depends on the others, too.
    fn changed(&self, light: &Light) -> Light {
        let mut light = light.clone();
        light.power.dial_stops += self.thirds as f32 / 3.0;
        if let Some(kelvin) = self.kelvin {
            light.color.source = ColorSource::Kelvin(kelvin);
        }
        light
    }
}

/// A row of the mixer: a light, or the lights that share a layer of the film.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct MixerRow {
    /// Name of the light or of the group.
    pub name: String,
    /// The lights of the studio that it moves.
    pub lights: Vec<LightId>,
    /// The film holds their light.
    pub has_layer: bool,
}

/// The faders of the lights.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Mix {
    faders: HashMap<LightId, Fader>,
}

impl Mix {
    /// Returns the fader of a light.
    pub fn fader(&self, light: LightId) -> Fader {
        self.faders.get(&light).copied().unwrap_or_default()
    }

    /// Sets the faders of lights to the same position.
    pub fn set(&mut self, lights: &[LightId], fader: Fader) {
        for light in lights {
            if fader.is_neutral() {
                self.faders.remove(light);
            } else {
                self.faders.insert(*light, fader);
            }
        }
    }

    /// Returns true if the picture shows the lights of the studio.
    pub fn is_neutral(&self) -> bool {
        self.faders.is_empty()
    }

    /// Drops the faders of lights that are off or not in the studio any more, and of lights that share a layer and are
    /// not moved together.
    pub fn fit(&mut self, scene: &Scene, layers: &[Layer]) {
        if self.is_neutral() {
            return;
        }
        let lit: HashSet<LightId> = scene.lights.iter().filter(|light| light.on).map(|light| light.id).collect();
        self.faders.retain(|light, _| lit.contains(light));
        for layer in layers {
            let lights: Vec<LightId> = layer.lights().filter(|light| lit.contains(light)).collect();
            if lights.windows(2).any(|pair| self.fader(pair[0]) != self.fader(pair[1])) {
                self.set(&lights, Fader::default());
            }
        }
    }

    /// Returns the studio with the lights as they are mixed.
    pub fn mixed<'a>(&self, scene: &'a Scene) -> Cow<'a, Scene> {
        if self.is_neutral() {
            return Cow::Borrowed(scene);
        }
        let has_solo = scene.lights.iter().any(|light| self.fader(light.id).soloed);
        let mut mixed = scene.clone();
        for light in &mut mixed.lights {
            let fader = self.fader(light.id);
            *light = fader.changed(light);
            light.on &= !fader.muted && (fader.soloed || !has_solo);
        }
        Cow::Owned(mixed)
    }

    /// Returns the action that makes the changes in the studio: dials, set to what their heads have, colours and mutes;
    /// none if there is nothing to change. Solos are not applied.
    pub fn action(&self, scene: &Scene) -> Option<Action> {
        let changed = scene.lights.iter().filter_map(|light| {
            let mut changed = self.fader(light.id).changed(light);
            if let Some(head) = changed.head.as_ref().filter(|_| self.fader(light.id).thirds != 0) {
                changed.power.dial_stops = head.dial.nearest(changed.power.dial_stops);
            }
            (changed != *light).then(|| Action::SetLight(Box::new(changed)))
        });
        let mut actions: Vec<Action> = changed.collect();
        let muted = scene.lights.iter().filter(|light| light.on && self.fader(light.id).muted);
        let muted: Vec<LightId> = muted.map(|light| light.id).collect();
        actions.extend((!muted.is_empty()).then_some(Action::Mute(muted, true)));
        (!actions.is_empty()).then(|| Action::Together { label: "Apply light mix".to_owned(), actions })
    }

    /// Returns the reason why the head of a light can't be set as the fader is; none if it can.
    pub fn out_of_range(&self, light: &Light) -> Option<String> {
        let fader = self.fader(light.id);
        let stops = fader.changed(light).power.dial_stops;
        let dial = light.dial();
        Some(match dial.beyond(stops).filter(|_| fader.thirds != 0)? {
            BeyondDial::Full => format!("{stops:.1} stops over the head's full power"),
            BeyondDial::Lowest => {
                let lowest = dial_text(&dial, dial.lowest_stops);
                format!("Under {lowest}, the lowest that the head can be set to")
            }
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scene::{Emitter, Output};

    fn studio() -> Scene {
        let light = |id| {
            let mut light = Light::new(Emitter::Point, Output::Lumens(1000.0));
            (light.id, light.name, light.power.dial_stops) = (LightId(id), format!("Light {id}"), -1.0);
            light
        };
        Scene { lights: (0..3).map(light).collect(), ..Scene::default() }
    }

    #[test]
    fn faders_change_dials_colours_and_switches_and_leave_the_studio() {
        let scene = studio();
        let mut mix = Mix::default();
        assert!(matches!(mix.mixed(&scene), Cow::Borrowed(_)));
        mix.set(&[LightId(0)], Fader { thirds: 2, kelvin: Some(3200.0), ..Fader::default() });
        mix.set(&[LightId(1)], Fader { muted: true, ..Fader::default() });
        let mixed = mix.mixed(&scene).into_owned();
        assert!((mixed.lights[0].power.dial_stops + 1.0 / 3.0).abs() < 1e-6);
        assert_eq!(mixed.lights[0].color.source, ColorSource::Kelvin(3200.0));
        assert_eq!(mixed.lights.iter().map(|light| light.on).collect::<Vec<_>>(), [true, false, true]);
        mix.set(&[LightId(2)], Fader { soloed: true, ..Fader::default() });
        let on = mix.mixed(&scene).lights.iter().map(|light| light.on).collect::<Vec<_>>();
        assert_eq!(on, [false, false, true]);
        mix.set(&[LightId(0), LightId(1), LightId(2)], Fader::default());
        assert!(mix.is_neutral());
    }

    #[test]
    fn a_solo_ends_with_its_light_and_lights_that_share_a_layer_move_together() {
        let mut scene = studio();
        let mut mix = Mix::default();
        mix.set(&[LightId(2)], Fader { soloed: true, ..Fader::default() });
        let gone = scene.lights.pop();
        assert!(mix.mixed(&scene).lights.iter().all(|light| light.on), "no light is on alone any more");
        mix.fit(&scene, &[]);
        scene.lights.extend(gone);
        assert!(mix.is_neutral(), "a new light of its id is not soloed");
        mix.set(&[LightId(0)], Fader { thirds: 1, ..Fader::default() });
        let layers: Vec<Layer> = scene.lights.iter().map(Layer::of_light).collect();
        mix.fit(&scene, &layers);
        assert_eq!(mix.fader(LightId(0)).thirds, 1);
        scene.lights[0].on = false;
        mix.fit(&scene, &layers);
        assert!(mix.is_neutral());
    }

    #[test]
    fn applying_is_one_action_without_the_solo() {
        let mut scene = studio();
        let mut mix = Mix::default();
        mix.set(&[LightId(2)], Fader { soloed: true, ..Fader::default() });
        assert_eq!(mix.action(&scene), None);
        mix.set(&[LightId(0)], Fader { thirds: -3, ..Fader::default() });
        mix.set(&[LightId(1)], Fader { muted: true, ..Fader::default() });
        mix.action(&scene).unwrap().apply(&mut scene).unwrap();
        assert_eq!(scene.lights[0].power.dial_stops, -2.0);
        assert_eq!((scene.lights[0].on, scene.lights[1].on, scene.lights[1].muted), (true, false, true));
    }

    #[test]
    fn faders_beyond_the_dial_of_a_head_are_marked() {
        let mut scene = studio();
        let mut mix = Mix::default();
        let mut told = |thirds, dial_stops| {
            scene.lights[0].power.dial_stops = dial_stops;
            mix.set(&[LightId(0)], Fader { thirds, ..Fader::default() });
            mix.out_of_range(&scene.lights[0])
        };
        assert_eq!(told(3, -1.0), None);
        assert_eq!(told(4, -1.0).unwrap(), "0.3 stops over the head's full power");
        assert!(told(-3, -8.5).unwrap().starts_with("Under 1/512"));
    }
}

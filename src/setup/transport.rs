//! The exposures that the lights of a studio give at the places of a meter, light by light.

use super::metering::{MeteredAt, MeteredSetup};
use crate::color::luminance;
use crate::math::mean;
use crate::photo::exposure;
use crate::photo::meter::Reading;
use crate::photo::{MIDDLE_GREY, PhotometricLight, clipping_stops};
use crate::raytrace::{GeometryCache, PrepareError, RenderControl};
#[cfg(test)]
use crate::scene::Camera;
use crate::scene::{Assets, HeadDial, Light, LightId, Modifier, Role, Scene};
use std::collections::HashSet;
use std::f32::consts::PI;

/// The exposures that a light gives, at its present dial, lux s.
#[derive(Clone, Debug, PartialEq)]
pub struct LightTransport {
    /// The light.
    pub light: LightId,
    /// Its name.
    pub name: String,
    /// Its role.
    pub role: Role,
    /// It is on in the studio. Lights that are off are measured as if they were on.
    pub is_on: bool,
    /// Its output can be set: neither sun nor surround.
    pub has_dial: bool,
    /// The dial of its head.
    pub dial: HeadDial,
    /// The setting of its dial, stops from full power.
    pub dial_stops: f32,
    /// Luminous energy that it gives in one exposure at full power, lm s.
    pub energy_lm_s: f32,
    /// The place at which it is metered by itself.
    pub at: MeteredAt,
    /// Its exposure there.
    pub own_lux_s: f32,
    /// Its exposure at the subject.
    pub subject_lux_s: f32,
    /// Its exposure at each point of the background.
    pub background_lux_s: Vec<f32>,
}

impl LightTransport {
    /// Returns its mean exposure over the points of the background, lux s; 0 without one.
    pub fn mean_background_lux_s(&self) -> f32 {
        mean(&self.background_lux_s)
    }
}

/// The exposures of all lights at all places.
#[derive(Clone, Debug, PartialEq)]
pub struct SetupTransport {
    lights: Vec<LightTransport>,
    /// Exposure by glowing surfaces at the subject, lux s.
    pub(super) glow_subject_lux_s: f32,
    /// Exposure by glowing surfaces at the points of the background, lux s.
    pub(super) glow_background_lux_s: Vec<f32>,
    /// Diffuse reflectances at the points of the background.
    background_albedos: Vec<f32>,
    /// Luminous exposure for f/1 at the camera's settings, lux s.
    f1_lux_s: f32,
    /// Picture value of 1 lux s on a surface of reflectance 1.
    value_per_lux_s: f32,
}

impl SetupTransport {
    /// Meters a studio. None once `control` is cancelled.
    ///
    /// # Errors
    /// If the scene has errors.
    pub fn measure(
        scene: &Scene,
        assets: &Assets,
        cache: &GeometryCache,
        control: &RenderControl,
    ) -> Result<Option<Self>, PrepareError> {
        let mut lit = scene.clone();
        for light in &mut lit.lights {
            // At full power: the error of a reading is relative to the light of all
            (light.on, light.power.dial_stops) = (true, 0.0);
        }
        let Some(setup) = MeteredSetup::new(&lit, assets, cache, control)? else { return Ok(None) };
        let mut background = Vec::new();
        let Some(read) = setup.read_background(control) else { return Ok(None) };
        for (point, reading) in read {
            background.push((reading, luminance(setup.base_color(&point).into())));
        }
        let measured = |(light, present): (&Light, &Light)| {
            let at = setup.metered_at(light);
            let own_lux_s = setup.exposure(light, at, control).map_or(0.0, |exposure| exposure.lux_s);
            let (light_id, power) = (Some(light.id), present.power.dial_stops.exp2());
            LightTransport {
                light: light.id,
                name: light.name.clone(),
                role: light.role,
                is_on: present.on,
                has_dial: !light.emitter.is_infinite(),
                dial: present.dial(),
                dial_stops: present.power.dial_stops,
                energy_lm_s: full_energy_lm_s(scene, assets, light),
                at,
                own_lux_s: own_lux_s * power,
                subject_lux_s: lux_s_of(&setup.reading, light_id) * power,
                background_lux_s: background.iter().map(|(read, _)| lux_s_of(read, light_id) * power).collect(),
            }
        };
        let transport = SetupTransport {
            lights: lit.lights.iter().zip(&scene.lights).map(measured).collect(),
            glow_subject_lux_s: lux_s_of(&setup.reading, None),
            glow_background_lux_s: background.iter().map(|(reading, _)| lux_s_of(reading, None)).collect(),
            background_albedos: background.iter().map(|(_, albedo)| *albedo).collect(),
            f1_lux_s: exposure::lux_s_to_set(scene, 1.0),
            value_per_lux_s: exposure::pixel_per_cd_s_m2(scene) / PI,
        };
        Ok((!control.is_cancelled()).then_some(transport))
    }

    /// Returns the exposures of a studio at ISO 100 and f/8 whose lights give these.
    #[cfg(test)]
    pub(super) fn of_lights(lights: Vec<LightTransport>, background_albedos: &[f32]) -> Self {
        let scene = Scene { camera: Camera { f_number: 8.0, ..Camera::default() }, ..Scene::default() };
        SetupTransport {
            lights,
            glow_subject_lux_s: 0.0,
            glow_background_lux_s: vec![0.0; background_albedos.len()],
            background_albedos: background_albedos.to_vec(),
            f1_lux_s: exposure::lux_s_to_set(&scene, 1.0),
            value_per_lux_s: exposure::pixel_per_cd_s_m2(&scene) / PI,
        }
    }

    /// Returns the lights, in the scene's order.
    pub fn lights(&self) -> &[LightTransport] {
        &self.lights
    }

    /// Returns the light of an id.
    pub fn light(&self, id: LightId) -> Option<&LightTransport> {
        self.lights.iter().find(|light| light.light == id)
    }

    /// Returns the key light of the studio as it is.
    pub fn present_key(&self) -> Option<LightId> {
        self.key_light(&HashSet::new(), &HashSet::new())
    }

    /// Returns the light to which others are relative: the strongest key light at the subject that is on or `named`, else the
    /// strongest other light there that is not itself `relative` to it. None if none of them lights the subject.
    pub(super) fn key_light(&self, named: &HashSet<LightId>, relative: &HashSet<LightId>) -> Option<LightId> {
        let is_used = |light: &&LightTransport| {
            (light.is_on || named.contains(&light.light)) && light.at == MeteredAt::Subject && light.subject_lux_s > 0.0
        };
        let used = || self.lights.iter().filter(is_used);
        let strongest = |lights: &mut dyn Iterator<Item = &LightTransport>| {
            lights.max_by(|a, b| a.subject_lux_s.total_cmp(&b.subject_lux_s)).map(|light| light.light)
        };
        let of_role = strongest(&mut used().filter(|light| light.role == Role::Key));
        of_role.or_else(|| strongest(&mut used().filter(|light| !relative.contains(&light.light))))
    }

    /// Returns the exposure of the key light at the subject, lux s; 0 without one.
    pub fn key_lux_s(&self) -> f32 {
        self.present_key().and_then(|key| self.light(key)).map_or(0.0, |light| light.subject_lux_s)
    }

    fn lit(&self) -> impl Iterator<Item = &LightTransport> {
        self.lights.iter().filter(|light| light.is_on)
    }

    /// Returns the exposure of the subject by all that is on, lux s.
    pub fn subject_lux_s(&self) -> f32 {
        self.glow_subject_lux_s + self.lit().map(|light| light.subject_lux_s).sum::<f32>()
    }

    /// Returns the exposure of the subject by the lights that are on and aim at something else, lux s.
    pub fn spill_lux_s(&self) -> f32 {
        self.lit().filter(|light| light.at == MeteredAt::Aim).map(|light| light.subject_lux_s).sum()
    }

    /// Returns the exposure of the background by all that is on, lux s: the mean of its points. 0 without a background.
    pub fn background_lux_s(&self) -> f32 {
        mean(&self.glow_background_lux_s) + self.lit().map(LightTransport::mean_background_lux_s).sum::<f32>()
    }

    /// Returns true if the picture shows something behind the subject.
    pub fn has_background(&self) -> bool {
        !self.background_albedos.is_empty()
    }

    /// Returns the f-number that a meter shows for an exposure.
    pub fn f_number(&self, lux_s: f32) -> f32 {
        (lux_s / self.f1_lux_s).max(0.0).sqrt()
    }

    /// Returns the exposure at which a meter shows an f-number, lux s.
    pub fn lux_s(&self, f_number: f32) -> f32 {
        f_number * f_number * self.f1_lux_s
    }

    /// Returns the exposures that make each point of the background middle grey in the picture, lux s; infinite for
    /// black surfaces.
    pub fn grey_lux_s(&self) -> impl Iterator<Item = f32> + '_ {
        self.background_albedos.iter().map(|albedo| MIDDLE_GREY / (albedo * self.value_per_lux_s))
    }

    /// Returns the exposures that make each point of the background white in the picture, lux s; infinite for black
    /// surfaces.
    pub fn white_lux_s(&self) -> impl Iterator<Item = f32> + '_ {
        let over_grey = clipping_stops().exp2();
        self.grey_lux_s().map(move |grey| grey * over_grey)
    }
}

/// Returns the exposure of a light in a reading, lux s; that of glowing surfaces for none.
fn lux_s_of(reading: &Reading, light: Option<LightId>) -> f32 {
    reading.lights.iter().find(|read| read.light == light).map_or(0.0, |read| reading.lux_s(read))
}

/// Returns the luminous energy of a light in one exposure at full power, before modifier and gel, lm s; 0 for sun and
/// surround.
fn full_energy_lm_s(scene: &Scene, assets: &Assets, light: &Light) -> f32 {
    let mut bare = light.clone();
    bare.power.dial_stops = 0.0;
    bare.modifier = Modifier::default();
    bare.color.gel_loss_counts = false;
    let photometric = PhotometricLight::new(scene, assets, &bare);
    photometric.flux() * photometric.exposure_time_s
}

//! Readings for a sheet: at the subject, and where lights aim at something else.

use crate::photo::exposure;
use crate::photo::meter::{Reading, Receptor};
use crate::raytrace::{GeometryCache, LightMeter, MeterEffort, MeterPoint, PrepareError, RenderControl};
use crate::scene::{Assets, Light, LightId, Scene, Shape};
use glam::Vec3;

/// Distance from the subject from which a light aims at something else, metres.
const APART_M: f32 = 0.75;
/// Distance behind the camera's aim in which a surface is the subject, metres.
const NEAR_M: f32 = 0.15;
/// Longest way along which a background is looked for, metres.
const FARTHEST_M: f32 = 100.0;
/// Most surfaces that are looked through on the way to a background.
const MOST_SURFACES: u32 = 64;
/// Step behind a surface, metres.
const STEP_M: f32 = 1e-3;

/// Where a light is metered.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum MeteredAt {
    /// At the subject.
    Subject,
    /// Where it falls on the subject from behind, with the meter turned to it: hair and rim lights.
    Rim,
    /// On what it aims at, which is not the subject: background lights.
    Aim,
}

/// The exposure of a light by itself.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LightExposure {
    /// The f-number to set for it, at the camera's ISO and shutter.
    pub f_number: f32,
    /// Its exposure over the key's at the subject, stops.
    pub stops_over_key: Option<f32>,
}

/// What is behind the subject, as seen by the camera.
#[derive(Clone, Debug, PartialEq)]
pub struct Background {
    /// Its name.
    pub name: String,
    /// Its distance from the subject, metres.
    pub distance_m: f32,
}

/// A studio with a light meter at its subject.
#[derive(Debug)]
pub struct MeteredSetup<'a> {
    /// The studio.
    pub scene: &'a Scene,
    /// Where the meter is held: the studio's own meter, or what the camera aims at.
    pub subject: MeterPoint,
    /// The reading there.
    pub reading: Reading,
    meter: LightMeter,
}

impl<'a> MeteredSetup<'a> {
    /// Reads the meter at the subject. None once `control` is cancelled.
    ///
    /// # Errors
    /// If the scene has errors.
    pub fn new(
        scene: &'a Scene,
        assets: &Assets,
        cache: &GeometryCache,
        control: &RenderControl,
    ) -> Result<Option<Self>, PrepareError> {
        let camera = &scene.camera;
        let aim = scene.aim_point(&camera.aim, camera.position);
        let around = scene.meter.map_or(aim, |meter| meter.position);
        let meter = LightMeter::kept(scene, assets, around, cache)?;
        let subject = match scene.meter {
            Some(own) => MeterPoint { position: own.position, facing: own.direction(scene), receptor: own.receptor },
            None => subject_of_camera(scene, &meter, aim),
        };
        let read = meter.read(&subject, &MeterEffort::default(), control);
        Ok(read.map(|result| MeteredSetup { scene, subject, reading: result.reading, meter }))
    }

    /// Returns true if a light aims at something else than the subject.
    pub fn aims_elsewhere(&self, light: &Light) -> bool {
        let away = self.subject.position - light.position;
        // The subject's distance from the light's axis, or from its aim if that is nearer to the light
        let aim = self.scene.aim_vector(&light.aim, light.position);
        let along = away.dot(aim.normalize_or_zero()).max(0.0);
        !light.emitter.is_infinite() && (away - aim.normalize_or_zero() * along).length() > APART_M
    }

    /// Returns where a light is metered.
    pub fn metered_at(&self, light: &Light) -> MeteredAt {
        let from_behind = (light.position - self.subject.position).dot(self.subject.facing) < 0.0;
        match (self.aims_elsewhere(light), from_behind && !light.emitter.is_infinite()) {
            (true, _) => MeteredAt::Aim,
            (false, true) => MeteredAt::Rim,
            (false, false) => MeteredAt::Subject,
        }
    }

    /// Returns what a light gives where it is metered; none if it is off, or if no light of it arrives.
    pub fn exposure(&self, light: &Light, control: &RenderControl) -> Option<LightExposure> {
        let at = self.metered_at(light);
        if at == MeteredAt::Subject || !light.on {
            return exposure_in(&self.reading, &self.reading, self.scene, light.id);
        }
        let axis = self.scene.aim_vector(&light.aim, light.position).try_normalize()?;
        let surface = self.meter.first_surface(light.position, axis, FARTHEST_M)?;
        let facing = if at == MeteredAt::Rim { -axis } else { surface.normal };
        let point = MeterPoint { position: surface.position + facing * STEP_M, facing, receptor: Receptor::Flat };
        let reading = self.meter.read(&point, &MeterEffort::quick(), control)?.reading;
        exposure_in(&reading, &self.reading, self.scene, light.id)
    }

    /// Returns the first thing behind the subject that is no person, at the height of the subject.
    pub fn background(&self) -> Option<Background> {
        let away = self.subject.position - self.scene.camera.position;
        let direction = Vec3::new(away.x, 0.0, away.z).try_normalize()?;
        let mut origin = self.subject.position;
        for _ in 0..MOST_SURFACES {
            let surface = self.meter.first_surface(origin, direction, FARTHEST_M)?;
            let object = surface.object.and_then(|index| self.scene.objects.get(index as usize));
            let is_person = object.is_some_and(|object| matches!(object.shape, Shape::Figure(_)));
            let distance_m = (surface.position - self.subject.position).dot(direction);
            if !is_person && distance_m > 0.3 {
                let name = object.map_or_else(|| "Wall".to_owned(), |object| object.name.clone());
                return Some(Background { name, distance_m });
            }
            origin = surface.position + direction * STEP_M;
        }
        None
    }

    /// Returns true if the camera sees a point: it is in the picture, and nothing is before it.
    pub fn is_seen(&self, point: Vec3) -> bool {
        let frame = self.scene.camera_frame(self.scene.camera.aspect());
        let in_picture = frame.project(point).is_some_and(|p| p.min_element() >= 0.0 && p.max_element() <= 1.0);
        let way = point - frame.position();
        in_picture
            && way.try_normalize().is_some_and(|direction| {
                self.meter.first_surface(frame.position(), direction, way.length() - STEP_M).is_none()
            })
    }
}

/// Returns the first surface before the camera's aim, facing the camera; the aim itself if there is none near it.
fn subject_of_camera(scene: &Scene, meter: &LightMeter, aim: Vec3) -> MeterPoint {
    let way = aim - scene.camera.position;
    let direction = way.normalize_or(Vec3::NEG_Z);
    let surface = meter.first_surface(scene.camera.position, direction, way.length() + NEAR_M);
    let position = surface.map_or(aim, |surface| surface.position);
    MeterPoint { position, facing: -direction, receptor: Receptor::Flat }
}

/// Returns the exposure of a light in a reading, against the key of another one.
fn exposure_in(reading: &Reading, at_subject: &Reading, scene: &Scene, light: LightId) -> Option<LightExposure> {
    let read = reading.lights.iter().find(|read| read.light == Some(light))?;
    let lux_s = reading.lux_s(read);
    let camera = &scene.camera;
    let on_sensor = lux_s * exposure::lens_transmission(camera, &scene.focused_lens());
    let f_number = exposure::f_number(on_sensor, camera.iso, camera.meter_constant);
    let key = at_subject.key().map(|key| at_subject.lux_s(key));
    let stops_over_key = key.map(|key| (lux_s / key).log2()).filter(|stops| stops.is_finite());
    (lux_s > 0.0).then_some(LightExposure { f_number, stops_over_key })
}

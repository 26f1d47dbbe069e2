//! The light meter's readings.

use super::point::{MeterEffort, MeterPoint};
use super::receptor::ReceptorFrame;
use super::replicate::{self, REPLICATES, Replicate};
use super::rounds::SamplingRound;
use super::sampling::RoundSampler;
use super::studio::{MeteredLight, MeteredStudio, blank_reading};
use crate::photo::meter::{LightReading, Reading};
use crate::raytrace::control::RenderControl;
use crate::raytrace::enclosure::back_faces_around;
use crate::raytrace::film::NonFiniteReport;
use crate::raytrace::geometry_cache::GeometryCache;
use crate::raytrace::prepare::PrepareError;
use crate::raytrace::ray_caster::RayCaster;
use crate::raytrace::render_scene::ROOM;
use crate::scene::{Assets, Light, Scene};
use glam::Vec3;
use rayon::prelude::*;

/// A reading with its cost.
#[derive(Clone, Debug, PartialEq)]
pub struct MeterResult {
    /// The reading.
    pub reading: Reading,
    /// Paths traced for the bounced light.
    pub paths: u64,
    /// Rays traced.
    pub rays: u64,
    /// Discarded non-finite contributions. A sample is named by its replicate, 0 for a path or 1 + layer for an emitter
    /// point, its index and the seed.
    pub nonfinite: NonFiniteReport,
    /// Index into the scene's objects of a closed object that encloses the receptor.
    pub inside: Option<u32>,
}

/// A light meter in a studio.
#[derive(Debug)]
pub struct LightMeter {
    pub(super) studio: MeteredStudio,
    /// Blank readings of all lights that are on, in the scene's order, with the layers of those with any output.
    order: Vec<(LightReading, Option<usize>)>,
    /// A reading without lights, at the camera's settings.
    blank: Reading,
}

impl LightMeter {
    /// Prepares a scene; points near `around` (world space) are read most precisely.
    ///
    /// # Errors
    /// When the scene has errors.
    pub fn new(scene: &Scene, assets: &Assets, around: Vec3) -> Result<Self, PrepareError> {
        Self::kept(scene, assets, around, &GeometryCache::default())
    }

    /// As [`LightMeter::new`], with the acceleration structures that an earlier call left in `cache`.
    ///
    /// # Errors
    /// When the scene has errors.
    pub fn kept(scene: &Scene, assets: &Assets, around: Vec3, cache: &GeometryCache) -> Result<Self, PrepareError> {
        let studio = MeteredStudio::new(scene, assets, around, cache)?;
        let layer_of = |light: &Light| studio.lights.iter().position(|metered| metered.id == light.id);
        let on = scene.lights.iter().filter(|light| light.on);
        let order = on.map(|light| (blank_reading(light), layer_of(light))).collect();
        Ok(LightMeter { studio, order, blank: Reading::new(Vec::new(), scene) })
    }

    /// Reads the meter. None if cancelled.
    pub fn read(&self, point: &MeterPoint, effort: &MeterEffort, control: &RenderControl) -> Option<MeterResult> {
        let studio = &self.studio;
        let receptor = ReceptorFrame::new(point, &studio.scene);
        let lights = studio.lights.len();
        let mut replicates: Vec<Replicate> = (0..REPLICATES).map(|index| Replicate::new(index, lights)).collect();
        let mut round = SamplingRound::first(effort, lights);
        loop {
            let sampler = RoundSampler { studio, receptor, round: &round, seed: effort.seed, control };
            replicates.par_iter_mut().for_each(|replicate| sampler.run(replicate));
            if control.is_cancelled() {
                return None;
            }
            let rays: u64 = replicates.iter().map(|replicate| replicate.rays).sum();
            let readings = self.readings(&replicates);
            match round.next(studio, &replicates, &readings, effort, rays) {
                Some(next) => round = next,
                None => {
                    return Some(MeterResult {
                        reading: Reading { lights: self.in_order(readings), ..self.blank.clone() },
                        paths: replicates.iter().map(|replicate| u64::from(replicate.paths)).sum(),
                        rays,
                        nonfinite: replicates.iter().map(|replicate| &replicate.nonfinite).collect(),
                        inside: self.enclosing_object(receptor.origin),
                    });
                }
            }
        }
    }

    /// The readings of all layers.
    fn readings(&self, replicates: &[Replicate]) -> Vec<LightReading> {
        let studio = &self.studio;
        let of_light =
            |(layer, light): (usize, &MeteredLight)| replicate::reading(&light.blank, light.rgb, layer, replicates);
        let mut readings: Vec<LightReading> = studio.lights.iter().enumerate().map(of_light).collect();
        if studio.has_emission {
            let blank = LightReading {
                light: None,
                name: "Glowing surfaces".to_owned(),
                role: None,
                flash: false,
                direct: 0.0,
                bounced: 0.0,
                standard_error: 0.0,
            };
            readings.push(replicate::reading(&blank, Vec3::ONE, studio.emission_layer(), replicates));
        }
        readings
    }

    /// Sorts the readings by the scene's lights, and inserts those of lights without output.
    fn in_order(&self, by_layer: Vec<LightReading>) -> Vec<LightReading> {
        let listed = self.order.iter().map(|(blank, layer)| layer.map_or(blank, |layer| &by_layer[layer]).clone());
        listed.chain(by_layer.get(self.studio.emission_layer()).cloned()).collect()
    }

    /// Returns the object around a point in the tracer's space: nearly every ray from there first hits a back face.
    fn enclosing_object(&self, origin: Vec3) -> Option<u32> {
        const RAYS: u32 = 64;
        let mut caster = RayCaster::new(&self.studio.scene);
        let faces = back_faces_around(&mut caster, origin, RAYS);
        let objects: Vec<u32> = faces.iter().map(|face| face.object).filter(|object| *object != ROOM).collect();
        objects.last().copied().filter(|_| objects.len() >= RAYS as usize - 4)
    }
}

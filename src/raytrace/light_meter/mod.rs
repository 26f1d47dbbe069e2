//! The light meter: what a receptor at a place of the studio gathers, light by light, direct and bounced apart.
//!
//! Direct light comes from stratified points on each emitter with shadow rays (a point, a spot and a sharp sun need
//! one). Bounced light is found by the path tracer, started in directions that the receptor weights. Both are taken in
//! sixteen independently scrambled sequences; their scatter is the error that is reported, and sampling goes on until
//! it is small or the rays are spent. Thin panes let direct light through. What mirrors show counts as bounced, and so
//! does what bodies of glass let through of a light with a size; it is the noisiest part.

mod receptor;

use crate::color::luminance;
use crate::math::{Ray, warp};
use crate::photo::PhotometricLight;
use crate::photo::meter::{LightReading, Reading, Receptor};
use crate::raytrace::control::RenderControl;
use crate::raytrace::film::{Layer, NonFiniteGate, NonFiniteReport};
use crate::raytrace::lights::TracedLight;
use crate::raytrace::limits::PathLimits;
use crate::raytrace::medium_stack::MediumStack;
use crate::raytrace::path_tracer::PathTracer;
use crate::raytrace::prepare::{PrepareError, prepare_around};
use crate::raytrace::ray_caster::RayCaster;
use crate::raytrace::render_scene::{ROOM, RenderScene};
use crate::raytrace::sampler::{self, Purpose, SampleId, Sampler};
use crate::raytrace::sink::RadianceSink;
use crate::scene::{Assets, Camera, Light, LightId, Scene};
use glam::{DVec3, Vec2, Vec3};
use rayon::prelude::*;
use receptor::Receiver;

/// Independent sequences: enough to tell their scatter to a fifth, few enough to stay well stratified each.
const REPLICATES: u32 = 16;
/// Bounces are left to roulette; this only ends what cannot end otherwise.
const LIMITS: PathLimits = PathLimits { max_non_specular_depth: 4096, max_depth: 4096, split_factor: 1 };
/// First round of a sequence: emitter points of each light, and paths.
const FIRST_ROUND: (u32, u32) = (64, 1024);
/// Most emitter points of a light in a sequence.
const MOST_POINTS: u32 = 16_384;

/// Where and how the receptor stands.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct MeterPoint {
    /// Position, metres.
    pub position: Vec3,
    /// Unit direction that the receptor faces.
    pub facing: Vec3,
    /// Flat or dome.
    pub receptor: Receptor,
}

/// When to stop. A result depends on this, on the scene and on the place alone.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct MeterEffort {
    /// Paths, rounded up to sixteenths; none samples until the error is small.
    pub paths: Option<u32>,
    /// Standard error of each light to stop at, relative to it. Lights under 1 % of all are held to 1 % of all.
    pub tolerance: f32,
    /// Rays after which no further round begins; a round at most doubles what was spent.
    pub rays: u64,
    /// Another seed gives another error.
    pub seed: u32,
}

impl Default for MeterEffort {
    /// Good to 0.15 % where that can be had within a few seconds.
    fn default() -> Self {
        MeterEffort { paths: None, tolerance: 0.0015, rays: 1_500_000, seed: 0 }
    }
}

impl MeterEffort {
    /// For a readout that follows the mouse.
    pub fn quick() -> Self {
        MeterEffort { tolerance: 0.01, rays: 100_000, ..MeterEffort::default() }
    }
}

/// A reading with what it cost.
#[derive(Clone, Debug, PartialEq)]
pub struct MeterResult {
    /// What the meter shows.
    pub reading: Reading,
    /// Paths traced for the bounced light.
    pub paths: u64,
    /// Rays traced.
    pub rays: u64,
    /// Discarded non-finite contributions.
    pub nonfinite: NonFiniteReport,
    /// Index into the scene's objects of a closed object that the receptor is inside of.
    pub inside: Option<u32>,
}

/// A studio made ready for the meter.
#[derive(Debug)]
pub struct LightMeter {
    scene: RenderScene,
    /// World place of the tracer's origin.
    eye: Vec3,
    /// The lights that give any light, in the scene's order; film layers count the same.
    lights: Vec<MeteredLight>,
    /// Every light that is on, with its layer if it gives any light.
    order: Vec<(LightReading, Option<usize>)>,
    camera: Camera,
    glows: bool,
}

#[derive(Debug)]
struct MeteredLight {
    id: LightId,
    blank: LightReading,
    rgb: Vec3,
}

/// One layer a light, however many there are, and nothing but the light in it.
fn a_layer_each(scene: &Scene, lights: &mut [(TracedLight, &Light)]) -> Vec<Layer> {
    for (layer, (traced, light)) in lights.iter_mut().enumerate() {
        traced.layer = layer;
        // Where one light of many is chosen, weak ones get more than their share of the choice: each is read for itself.
        let strength = PhotometricLight::new(scene, light).axial_intensity_or_illuminance();
        traced.time_s = (traced.time_s / strength).sqrt();
        // The path tracer shows emitters only to the camera's ray: here, they are met by light sampling.
        traced.visible_to_camera = false;
    }
    lights.iter().map(|(_, light)| Layer::of_light(light)).chain([Layer::shared("Glow")]).collect()
}

impl LightMeter {
    /// Builds trees and tables; places near `around` are read most exactly.
    pub fn new(scene: &Scene, assets: &Assets, around: Vec3) -> Result<Self, PrepareError> {
        let mut prepared = prepare_around(scene, assets, around, a_layer_each)?;
        // Glowing surfaces are read in lux, like any continuous light.
        prepared.emission_time_s = 1.0;
        let metered = |layer: &Layer| {
            let light = layer.light.and_then(|id| scene.light(id))?;
            let rgb = PhotometricLight::new(scene, light).tint;
            Some(MeteredLight { id: light.id, blank: blank(light), rgb })
        };
        let lights: Vec<MeteredLight> = prepared.layers.iter().filter_map(metered).collect();
        let layer_of = |light: &Light| lights.iter().position(|metered| metered.id == light.id);
        let order = scene.lights.iter().filter(|l| l.on).map(|light| (blank(light), layer_of(light))).collect();
        let glows = prepared.materials.iter().any(|m| m.is_emissive());
        Ok(LightMeter { scene: prepared, eye: around, lights, order, camera: scene.camera.clone(), glows })
    }

    /// Reads the meter. None when cancelled.
    pub fn read(&self, place: &MeterPoint, effort: &MeterEffort, control: &RenderControl) -> Option<MeterResult> {
        let receiver = Receiver::new(place, self.eye);
        let mut sequences: Vec<Sequence> = (0..REPLICATES).map(|i| Sequence::new(i, self.lights.len())).collect();
        let mut round = Round::first(effort, self.lights.len());
        loop {
            let job = Job { probe: self, receiver, round: &round, seed: effort.seed, control };
            sequences.par_iter_mut().for_each(|sequence| job.run(sequence));
            if control.is_cancelled() {
                return None;
            }
            let rays: u64 = sequences.iter().map(|s| s.rays).sum();
            let lights = self.readings(&sequences);
            if !round.next(self, &sequences, &lights, effort, rays) {
                return Some(MeterResult {
                    reading: Reading::new(self.in_order(lights), &self.camera),
                    paths: sequences.iter().map(|s| u64::from(s.paths)).sum(),
                    rays,
                    nonfinite: sequences.iter().map(|s| &s.nonfinite).collect(),
                    inside: self.enclosing(receiver.origin),
                });
            }
        }
    }

    /// Means over the sequences, with their scatter.
    fn readings(&self, sequences: &[Sequence]) -> Vec<LightReading> {
        let glow = self.lights.len();
        let mut readings: Vec<LightReading> = Vec::with_capacity(glow + 1);
        for (layer, light) in self.lights.iter().enumerate() {
            readings.push(mean_reading(&light.blank, light.rgb, layer, sequences));
        }
        if self.glows {
            let blank = LightReading {
                light: None,
                name: "Glowing surfaces".to_owned(),
                role: None,
                flash: false,
                direct: 0.0,
                bounced: 0.0,
                standard_error: 0.0,
            };
            readings.push(mean_reading(&blank, Vec3::ONE, glow, sequences));
        }
        readings
    }

    /// The readings as the scene lists its lights, with those that give nothing.
    fn in_order(&self, by_layer: Vec<LightReading>) -> Vec<LightReading> {
        let listed = self.order.iter().map(|(blank, layer)| layer.map_or(blank, |l| &by_layer[l]).clone());
        listed.chain(by_layer.get(self.lights.len()).cloned()).collect()
    }

    /// The closed object around a point: nearly every ray from there meets a back face of an object first.
    fn enclosing(&self, origin: Vec3) -> Option<u32> {
        const RAYS: u32 = 64;
        let mut caster = RayCaster::new(&self.scene);
        let mut backs = 0;
        let mut object = None;
        for i in 0..RAYS {
            let u = Vec2::new((i as f32 + 0.5) / RAYS as f32, (i as f32 * 0.618_034).fract());
            let direction = warp::uniform_sphere(u);
            let hit = caster.intersect(&Ray { origin, direction, t_max: f32::INFINITY })?;
            let index = self.scene.aggregate.instances()[hit.instance as usize].object;
            if index != ROOM && self.scene.aggregate.surface(&hit).geometric_normal.dot(direction) > 0.0 {
                backs += 1;
                object = Some(index);
            }
        }
        object.filter(|_| backs >= RAYS - 4)
    }
}

fn blank(light: &Light) -> LightReading {
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

/// Sums of one sequence.
#[derive(Debug)]
struct Sequence {
    index: u32,
    /// A light's direct illuminance, and how many emitter points it comes from.
    direct: Vec<(f64, u32)>,
    /// Of every layer: light that arrives along the paths by a bounce, and without.
    bounced: Vec<DVec3>,
    straight: Vec<DVec3>,
    paths: u32,
    rays: u64,
    nonfinite: NonFiniteReport,
}

impl Sequence {
    fn new(index: u32, lights: usize) -> Self {
        let none = vec![DVec3::ZERO; lights + 1];
        Sequence {
            index,
            direct: vec![(0.0, 0); lights],
            bounced: none.clone(),
            straight: none,
            paths: 0,
            rays: 0,
            nonfinite: NonFiniteReport::default(),
        }
    }

    /// Direct and bounced light of a layer, in the colour of its light.
    fn of_layer(&self, layer: usize, rgb: Vec3) -> (f64, f64) {
        let mean = |sums: &[DVec3]| {
            let sum = sums[layer] / f64::from(self.paths.max(1));
            f64::from(luminance(sum.as_vec3() * rgb))
        };
        let (sum, points) = self.direct.get(layer).copied().unwrap_or_default();
        (sum / f64::from(points.max(1)) + mean(&self.straight), mean(&self.bounced))
    }
}

/// Mean and the standard error of the mean.
fn mean_and_error(values: impl Iterator<Item = f64> + Clone) -> (f64, f64) {
    let n = f64::from(REPLICATES);
    let mean = values.clone().sum::<f64>() / n;
    let square = values.map(|v| (v - mean) * (v - mean)).sum::<f64>();
    (mean, (square / (n * (n - 1.0))).sqrt())
}

fn mean_reading(blank: &LightReading, rgb: Vec3, layer: usize, sequences: &[Sequence]) -> LightReading {
    let both = sequences.iter().map(|s| s.of_layer(layer, rgb));
    let (direct, _) = mean_and_error(both.clone().map(|(direct, _)| direct));
    let (bounced, _) = mean_and_error(both.clone().map(|(_, bounced)| bounced));
    let (_, error) = mean_and_error(both.map(|(direct, bounced)| direct + bounced));
    let [direct, bounced, standard_error] = [direct, bounced, error].map(|x| x as f32);
    LightReading { direct, bounced, standard_error, ..blank.clone() }
}

/// What to sample next, a sequence.
#[derive(Debug)]
struct Round {
    /// Emitter points so far and after this round, a light.
    points: Vec<(u32, u32)>,
    /// Paths so far and after this round.
    paths: (u32, u32),
}

impl Round {
    fn first(effort: &MeterEffort, lights: usize) -> Self {
        let (points, paths) = match effort.paths {
            Some(paths) => {
                let each = paths.div_ceil(REPLICATES).max(1);
                (each.min(MOST_POINTS), each)
            }
            None => FIRST_ROUND,
        };
        Round { points: vec![(0, points); lights], paths: (0, paths) }
    }

    /// Doubles what is not good enough; false when nothing is left to do.
    fn next(
        &mut self,
        probe: &LightMeter,
        sequences: &[Sequence],
        lights: &[LightReading],
        effort: &MeterEffort,
        rays: u64,
    ) -> bool {
        let seconds = |light: &LightReading| if light.flash { 1.0 } else { probe.camera.shutter_s };
        let total: f32 = lights.iter().map(|l| l.sum() * seconds(l)).sum();
        let allowed = |light: &LightReading| effort.tolerance * light.sum().max(0.01 * total / seconds(light));
        for points in &mut self.points {
            points.0 = points.1;
        }
        self.paths.0 = self.paths.1;
        if effort.paths.is_some() || rays >= effort.rays {
            return false;
        }
        let mut more = false;
        for (layer, light) in probe.lights.iter().enumerate() {
            let reading = &lights[layer];
            let (_, direct_error) = mean_and_error(sequences.iter().map(|s| {
                let (sum, points) = s.direct[layer];
                sum / f64::from(points.max(1))
            }));
            // Half of what is allowed: the bounced light has its own error.
            if direct_error as f32 > 0.5 * allowed(reading) && self.points[layer].1 < MOST_POINTS {
                self.points[layer].1 *= 2;
                more = true;
            }
            let (_, path_error) = path_error(sequences, layer, light.rgb);
            if path_error as f32 > 0.8 * allowed(reading) {
                self.paths.1 = self.paths.0 * 2;
            }
        }
        if probe.glows && lights.last().is_some_and(|glow| glow.standard_error > allowed(glow)) {
            self.paths.1 = self.paths.0 * 2;
        }
        more || self.paths.1 > self.paths.0
    }
}

/// Mean and error of what the paths bring for a layer.
fn path_error(sequences: &[Sequence], layer: usize, rgb: Vec3) -> (f64, f64) {
    mean_and_error(sequences.iter().map(|s| {
        let sum = (s.bounced[layer] + s.straight[layer]) / f64::from(s.paths.max(1));
        f64::from(luminance(sum.as_vec3() * rgb))
    }))
}

/// A round's work on one sequence.
struct Job<'a> {
    probe: &'a LightMeter,
    receiver: Receiver,
    round: &'a Round,
    seed: u32,
    control: &'a RenderControl,
}

/// Samples between two looks at whether the user has cancelled.
const CHECK_EVERY: u32 = 256;

impl Job<'_> {
    fn run(&self, sequence: &mut Sequence) {
        let mut tracer = PathTracer::new(&self.probe.scene, None);
        for (layer, light) in self.probe.scene.lights.iter().enumerate() {
            if self.control.is_cancelled() {
                return;
            }
            self.direct(sequence, &mut tracer, layer, light);
        }
        for i in self.round.paths.0..self.round.paths.1 {
            if i % CHECK_EVERY == 0 && self.control.is_cancelled() {
                return;
            }
            self.path(sequence, &mut tracer, i);
        }
        sequence.rays += tracer.caster.rays;
    }

    /// Next points of an emitter.
    fn direct(&self, sequence: &mut Sequence, tracer: &mut PathTracer<'_>, layer: usize, light: &TracedLight) {
        let receiver = &self.receiver;
        let (from, to) = self.round.points[layer];
        for i in from..to {
            // One point says all about a light without size, and the first round asks for it.
            if !light.is_sampled() || (light.is_delta() && i > 0) {
                return;
            }
            let sampler = Sampler::new(sequence.index, 1 + layer as u32, i, self.seed);
            let set = sampler.set(Purpose::Camera);
            let sample = light.sample(receiver.origin, sampler::point(&set));
            let lit = sample.map_or(0.0, |sample| {
                let response = receiver.receptor.response(sample.direction.dot(receiver.facing));
                let value = sample.value * response;
                if value <= 0.0 {
                    return 0.0;
                }
                let (origin, direction, distance) = (receiver.origin, sample.direction, sample.distance);
                // What bodies of glass let through of a light with a size is found by the paths.
                value
                    * luminance(tracer.caster.visibility(
                        origin,
                        direction,
                        distance,
                        light.is_delta(),
                        MediumStack::default(),
                    ))
            });
            let (sum, points) = &mut sequence.direct[layer];
            *points += 1;
            if let Some(lit) = sequence.nonfinite.admit(sampler.id(), Vec3::splat(lit)) {
                *sum += f64::from(lit.x);
            }
        }
    }

    /// One path for all lights.
    fn path(&self, sequence: &mut Sequence, tracer: &mut PathTracer<'_>, index: u32) {
        let receiver = &self.receiver;
        let sampler = Sampler::new(sequence.index, 0, index, self.seed);
        let direction = receiver.direction(sampler::point(&sampler.set(Purpose::Camera)));
        let weight = receiver.weight();
        sequence.paths += 1;
        let report = &mut sequence.nonfinite;
        let mut sink = WeightedSink::new(&mut sequence.straight, weight, sampler.id(), report);
        self.straight(tracer, direction, &mut sink);
        let mut sink = WeightedSink::new(&mut sequence.bounced, weight, sampler.id(), report);
        tracer.trace_without_direct_light(receiver.origin, direction, &sampler, LIMITS, &mut sink);
        if self.probe.glows {
            // The path has counted the glow of the first surface, too, which is direct light.
            let glow = self.probe.lights.len();
            let mut first = vec![DVec3::ZERO; glow + 1];
            let mut sink = WeightedSink::new(&mut first, weight, sampler.id(), report);
            tracer.trace(receiver.origin, direction, &sampler, NO_BOUNCE, &mut sink);
            sequence.bounced[glow] -= first[glow];
            sequence.straight[glow] += first[glow];
        }
    }

    /// Surrounds are met by the receptor's own choice of direction.
    fn straight(&self, tracer: &mut PathTracer<'_>, direction: Vec3, sink: &mut impl RadianceSink) {
        let origin = self.receiver.origin;
        let unsampled = || self.probe.scene.lights.iter().filter(|light| !light.is_sampled());
        if unsampled().next().is_none() || tracer.caster.occluded(origin, direction, f32::INFINITY) {
            return;
        }
        for light in unsampled() {
            if let Some(seen) = light.intersect(origin, direction) {
                sink.add(light.layer, Vec3::splat(seen.luminance));
            }
        }
    }
}

/// Only what the first surface gives off.
const NO_BOUNCE: PathLimits = PathLimits { max_non_specular_depth: 0, max_depth: 0, split_factor: 1 };

/// Weights the contributions of a path for the receptor, and adds the finite ones to the layers' sums.
struct WeightedSink<'a> {
    gate: NonFiniteGate<'a, LayerTotals<'a>>,
    /// Solid angle of the receptor's response, sr.
    weight: f32,
}

impl<'a> WeightedSink<'a> {
    fn new(sums: &'a mut [DVec3], weight: f32, sample: SampleId, report: &'a mut NonFiniteReport) -> Self {
        WeightedSink { gate: NonFiniteGate { sink: LayerTotals(sums), sample, report }, weight }
    }
}

impl RadianceSink for WeightedSink<'_> {
    fn add(&mut self, layer: usize, value: Vec3) {
        self.gate.add(layer, value * self.weight);
    }
}

/// One sum per layer, in double precision.
struct LayerTotals<'a>(&'a mut [DVec3]);

impl RadianceSink for LayerTotals<'_> {
    fn add(&mut self, layer: usize, value: Vec3) {
        self.0[layer] += value.as_dvec3();
    }
}

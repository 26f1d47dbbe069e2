//! The samples of one round: emitter points with shadow rays, and paths from the receptor.

use super::photons::{PHOTONS_PER_PATH, ReceptorPhotons, RoundDensities};
use super::receptor::ReceptorFrame;
use super::replicate::Replicate;
use super::rounds::SamplingRound;
use super::studio::MeteredStudio;
use crate::color::luminance;
use crate::raytrace::caustics::{PhotonMap, PhotonTracer, StartDensity};
use crate::raytrace::control::RenderControl;
use crate::raytrace::film::{NonFiniteGate, NonFiniteReport};
use crate::raytrace::geometry::PassedBodies;
use crate::raytrace::lights::{LightSample, TracedLight};
use crate::raytrace::limits::PathLimits;
use crate::raytrace::medium_stack::MediumStack;
use crate::raytrace::path_tracer::PathTracer;
use crate::raytrace::ray_caster::RayCaster;
use crate::raytrace::sampler::{self, Dimensions, SampleId, Sampler};
use crate::raytrace::sink::RadianceSink;
use glam::{DVec3, Vec3};

/// Limits of a path that finds the emission of the first surface alone.
const FIRST_SURFACE: PathLimits = PathLimits { max_non_specular_depth: 0, max_depth: 0, split_factor: 1 };
/// Photons have this place in the random numbers of a replicate; lights count upwards from 1.
const PHOTONS: u32 = u32::MAX;
/// Paths between two checks for cancellation.
const CHECK_EVERY: u32 = 256;

/// Direct illuminance of a receptor by one light: lux, or lux seconds for flash.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct DirectLight {
    /// The illuminance, with shadows.
    pub arriving: f32,
    /// The illuminance if nothing lay between the light and the receptor.
    pub unshadowed: f32,
}

/// The sampling of a round, for any replicate.
#[derive(Debug)]
pub struct RoundSampler<'a> {
    /// The studio.
    pub studio: &'a MeteredStudio,
    /// The receptor.
    pub receptor: ReceptorFrame,
    /// The samples to take.
    pub round: &'a SamplingRound,
    /// Seed of the reading.
    pub seed: u32,
    /// Cancellation.
    pub control: &'a RenderControl,
}

impl RoundSampler<'_> {
    /// Adds the round's samples to a replicate. Incomplete if the reading is cancelled.
    pub fn run(&self, replicate: &mut Replicate) {
        let scene = &self.studio.scene;
        let map = self.trace_photons(replicate);
        let mut tracer = PathTracer::new(scene, map.as_ref());
        for (layer, light) in scene.lights.iter().enumerate() {
            if self.control.is_cancelled() {
                return;
            }
            self.sample_light(replicate, &mut tracer.caster, layer, light);
        }
        for index in self.round.paths.clone() {
            if index % CHECK_EVERY == 0 && self.control.is_cancelled() {
                return;
            }
            self.trace_path(replicate, &mut tracer, index);
        }
        replicate.rays += tracer.caster.rays;
    }

    /// Numbers of paths and photons of the round; none where no photons are needed.
    fn densities(&self) -> Option<RoundDensities> {
        let paths = self.round.paths.len() as u32;
        let round = RoundDensities { paths, photons: paths.saturating_mul(PHOTONS_PER_PATH) };
        self.studio.scene.plan().photons.then_some(round)
    }

    /// Traces the round's photons, adds those at the receptor, and returns a map of those at surfaces.
    fn trace_photons(&self, replicate: &mut Replicate) -> Option<PhotonMap> {
        let scene = &self.studio.scene;
        let round = self.densities()?;
        let starts = StartDensity::default();
        let mut tracer = PhotonTracer::new(scene, &starts);
        let first = self.round.paths.start.saturating_mul(PHOTONS_PER_PATH);
        let sampler = |index: u32| Sampler::new(replicate.index, PHOTONS, first + index, self.seed);
        let mut receiver = ReceptorPhotons {
            receptor: &self.receptor,
            round,
            materials: &scene.materials,
            stored: Vec::new(),
            sums: &mut replicate.caustic,
            sample: sampler(0).id(),
            nonfinite: &mut replicate.nonfinite,
        };
        for index in 0..round.photons {
            if index % CHECK_EVERY == 0 && self.control.is_cancelled() {
                break;
            }
            let sampler = sampler(index);
            receiver.sample = sampler.id();
            tracer.trace(&sampler, round.photons, &mut receiver);
        }
        let stored = receiver.stored;
        replicate.photons += round.photons;
        replicate.rays += tracer.caster.rays;
        Some(PhotonMap::uniform(stored, round.photons))
    }

    /// Samples points of a light and adds their direct illuminance.
    fn sample_light(&self, replicate: &mut Replicate, caster: &mut RayCaster<'_>, layer: usize, light: &TracedLight) {
        for index in self.round.points[layer].clone() {
            // One sample of a delta light is exact.
            if !light.is_sampled() || (light.is_delta() && index > 0) {
                return;
            }
            let sampler = Sampler::new(replicate.index, 1 + layer as u32, index, self.seed);
            let illuminance = sample_direct(&self.receptor, caster, light, &sampler).arriving;
            let (sum, points) = &mut replicate.direct[layer];
            *points += 1;
            if let Some(illuminance) = replicate.nonfinite.admit(sampler.id(), Vec3::splat(illuminance)) {
                *sum += f64::from(illuminance.x);
            }
        }
    }

    /// Traces one path for all lights.
    fn trace_path(&self, replicate: &mut Replicate, tracer: &mut PathTracer<'_>, index: u32) {
        let receptor = &self.receptor;
        let sampler = Sampler::new(replicate.index, 0, index, self.seed);
        let direction = receptor.sample(sampler::first_pair(&sampler.set(Dimensions::Camera)));
        let weight = receptor.response_integral();
        replicate.paths += 1;

        // Surrounds by the sampled direction, then bounced light
        let report = &mut replicate.nonfinite;
        let mut sink = WeightedSink::new(&mut replicate.straight, weight, sampler.id(), report);
        self.add_surrounds(&mut tracer.caster, direction, &mut sink);
        let mut sink = WeightedSink::new(&mut replicate.bounced, weight, sampler.id(), report);
        let gather = self.densities().map(|round| receptor.densities(direction, round));
        tracer.trace_without_direct_light(
            receptor.origin,
            direction,
            &sampler,
            PathLimits::UNTIL_ROULETTE,
            gather,
            &mut sink,
        );

        // The emission of the first surface, which the path includes, is direct light
        if self.studio.has_emission {
            let layer = self.studio.emission_layer();
            let mut first = vec![DVec3::ZERO; layer + 1];
            let mut sink = WeightedSink::new(&mut first, weight, sampler.id(), report);
            tracer.trace(receptor.origin, direction, &sampler, FIRST_SURFACE, &mut sink);
            replicate.bounced[layer] -= first[layer];
            replicate.straight[layer] += first[layer];
        }
    }

    /// Adds the surrounds that a ray from the receptor reaches.
    fn add_surrounds(&self, caster: &mut RayCaster<'_>, direction: Vec3, sink: &mut impl RadianceSink) {
        let origin = self.receptor.origin;
        let surrounds = || self.studio.scene.lights.iter().filter(|light| !light.is_sampled());
        if surrounds().next().is_none() || caster.occluded(origin, direction, f32::INFINITY, PassedBodies::None) {
            return;
        }
        for light in surrounds() {
            if let Some(hit) = light.intersect(origin, direction) {
                sink.add(light.layer, Vec3::splat(hit.luminance));
            }
        }
    }
}

/// Estimates the illuminance of a receptor by one sample of a light.
pub fn sample_direct(
    receptor: &ReceptorFrame,
    caster: &mut RayCaster<'_>,
    light: &TracedLight,
    sampler: &Sampler,
) -> DirectLight {
    let ReceptorFrame { position, origin, facing, receptor, .. } = *receptor;
    let set = sampler.set(Dimensions::Camera);
    let Some(sample) = light.sample(position, sampler::first_pair(&set)) else { return DirectLight::default() };
    let response = receptor.response(sample.direction.dot(facing));
    if response <= 0.0 {
        return DirectLight::default();
    }
    let unshadowed = sample.value * response;
    // Shadow rays start at the origin and end where the light is
    let distance = (sample.distance - (origin - position).dot(sample.direction)).max(0.0);
    let sample = LightSample { distance, ..sample };
    let Some(connection) = caster.connect(origin, light, &sample, MediumStack::default()) else {
        return DirectLight { arriving: 0.0, unshadowed };
    };
    let response = receptor.response(connection.direction.dot(facing));
    DirectLight { arriving: connection.value * response * luminance(connection.transmittance), unshadowed }
}

/// Weights the contributions of a path by the receptor's response, and adds the finite ones to the layers' sums.
struct WeightedSink<'a> {
    gate: NonFiniteGate<'a, LayerTotals<'a>>,
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

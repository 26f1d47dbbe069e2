//! Light sampling at the vertices of a path.
//!
//! A few lights are all sampled. At the first non-specular vertex, each has its own shadow ray. At later vertices one
//! sample gets the only shadow ray, chosen in proportion to the light that it brings if nothing is in between
//! (resampled importance sampling: Talbot, Cline and Egbert 2005, "Importance Resampling for Global Illumination").
//!
//! Of many lights, one is chosen by its importance, and sampled. Among 60 of about the same importance, a choice of four
//! such samples has the same variance and takes half as long again.

use super::bsdf::BsdfLanes;
use super::connection::Connection;
use super::emitters::power_heuristic;
use super::events::PathEvent;
use super::lights::{LightImportances, LightLanes, LightSample, LightSampleLanes, TracedLight};
use super::path_tracer::{PathState, PathTracer, ShadingPoint};
use super::render_scene::RenderScene;
use super::sampler::{self, Dimensions, Sampler};
use super::sink::RadianceSink;
use crate::color::luminance;
use crate::math::find_interval;
use crate::math::simd::LANES;
use glam::{Vec2, Vec3};

/// A vertex at which lights are sampled.
struct LitVertex<'v> {
    path: &'v PathState,
    point: &'v ShadingPoint<'v>,
    /// Paths that continue from the vertex for each sample of a light.
    paths: f32,
}

/// A sample of a light, before it is known what is in between.
#[derive(Clone, Copy, Debug)]
struct LightCandidate {
    /// Index of the light.
    light: u32,
    /// Probability with which the light is sampled at the vertex.
    pmf: f32,
    sample: LightSample,
    /// BSDF times cosine, and the density with which the BSDF samples the direction.
    bsdf: (Vec3, f32),
}

impl<'a> PathTracer<'a> {
    /// Returns true if all lights are sampled at the path's vertex, each with a shadow ray.
    pub fn samples_all_lights(&self, path: &PathState) -> bool {
        let scene = self.caster.scene;
        scene.lights.len() == 1 || (path.non_specular_depth == 0 && scene.plan().sample_all_lights)
    }

    /// Returns true if a vertex chooses one of many lights by importance, rather than among samples of all.
    pub fn samples_by_importance(&self) -> bool {
        let scene = self.caster.scene;
        scene.lights.len() > 1 && !scene.plan().sample_all_lights
    }

    /// Samples the lights at a vertex from which so many paths continue.
    pub fn sample_lights(
        &mut self,
        path: &PathState,
        point: &ShadingPoint<'_>,
        sampler: &Sampler,
        first_set: &sampler::Set,
        paths: f32,
        sink: &mut impl RadianceSink,
    ) {
        let scene = self.caster.scene;
        let vertex = LitVertex { path, point, paths };
        if !self.samples_all_lights(path) {
            if let Some((candidate, probability)) = self.choose_light(&vertex, first_set) {
                self.add_light(&vertex, &candidate, probability, sink);
            }
        } else if let Some(lanes) = &scene.light_lanes {
            let u = light_numbers(lanes, path.depth, sampler, first_set);
            let candidates = vertex.candidates(scene, lanes, &u);
            for candidate in candidates.iter(&vertex) {
                self.add_light(&vertex, &candidate, 1.0, sink);
            }
        } else if let Some(candidate) = vertex.only_candidate(scene, sampler::first_pair(first_set)) {
            self.add_light(&vertex, &candidate, 1.0, sink);
        }
    }

    /// Importances of the lights at a vertex, where one is chosen by them.
    pub fn light_importances(&self, point: &ShadingPoint<'_>) -> Option<LightImportances<'a>> {
        let scene = self.caster.scene;
        if !self.samples_by_importance() {
            return None;
        }
        scene.light_sampler.importances(&scene.lights, point.surface.position, point.bsdf.normal())
    }

    /// Chooses the sample that gets the only shadow ray of a vertex. Returns it with its probability among the candidates.
    fn choose_light(&self, vertex: &LitVertex<'_>, set: &sampler::Set) -> Option<(LightCandidate, f32)> {
        let scene = self.caster.scene;
        let (on_light, [u, _]) = (sampler::first_pair(set), sampler::last_pair(set));
        if !self.samples_by_importance() {
            let Some(lanes) = &scene.light_lanes else {
                return Some((vertex.only_candidate(scene, on_light)?, 1.0));
            };
            let candidates = vertex.candidates(scene, lanes, &[[on_light.x; LANES], [on_light.y; LANES]]);
            return choose_in_proportion(candidates.iter(vertex), |candidate| vertex.unshadowed(scene, candidate), u);
        }
        let found = if vertex.point.importances.is_none() { self.light_importances(vertex.point) } else { None };
        let importances = vertex.point.importances.or(found.as_ref())?;
        let (light, pmf) = importances.sample(&scene.lights, u)?;
        Some((vertex.candidate(scene, light, pmf, on_light)?, 1.0))
    }

    /// Connects a candidate that was chosen with this probability, and adds its contribution.
    fn add_light(
        &mut self,
        vertex: &LitVertex<'_>,
        candidate: &LightCandidate,
        probability: f32,
        sink: &mut impl RadianceSink,
    ) {
        let LitVertex { path, point, .. } = *vertex;
        let ShadingPoint { surface, bsdf, .. } = *point;
        let LightCandidate { light: index, pmf, sample, bsdf: evaluated } = *candidate;
        let light = &self.caster.scene.lights[index as usize];
        let event = |pdf, bsdf_pdf, visibility, mis_weight| PathEvent::LightSample {
            light: index,
            pmf: pmf * probability,
            pdf,
            bsdf_pdf,
            visibility,
            mis_weight,
        };

        // Connect with the light, through flat bodies in another direction
        let mut media = path.media;
        if bsdf.enters_body(sample.direction) {
            media.cross(surface.material, point.outside);
        }
        let connection = self.caster.connect(surface.spawn_origin(sample.direction), light, &sample, media);
        let Some(Connection { direction, value: light_value, pdf, transmittance }) = connection else {
            sink.record(|| event(sample.pdf, evaluated.1, Vec3::ZERO, 0.0));
            return;
        };
        let (value, bsdf_pdf) = if direction == sample.direction { evaluated } else { bsdf.eval(direction) };

        // Weight against emitter hits and add the contribution
        let mis_weight = vertex.mis_weight(pdf, pmf, bsdf_pdf);
        sink.record(|| event(pdf, bsdf_pdf, transmittance, mis_weight));
        let per_sample = light_value / (pmf * probability);
        let arriving = path.throughput * transmittance * light.tint_towards(direction) * per_sample;
        sink.add(light.layer, arriving * value * mis_weight);

        // Add the control variate, whose MIS weight is that of one path
        if let Some(control) = point.control {
            let (value, bsdf_pdf) = control.eval(direction);
            let mis_weight = LitVertex { paths: 1.0, ..*vertex }.mis_weight(pdf, pmf, bsdf_pdf);
            sink.add(light.layer, arriving * value * mis_weight);
        }
    }
}

/// Returns the random numbers with which each lane's light is sampled.
fn light_numbers(lanes: &LightLanes, depth: u32, sampler: &Sampler, first_set: &sampler::Set) -> [[f32; LANES]; 2] {
    let mut numbers = [[0.0; LANES]; 2];
    let mut set_lane = |lane: usize, set: &sampler::Set| {
        let u = sampler::first_pair(set);
        (numbers[0][lane], numbers[1][lane]) = (u.x, u.y);
    };
    set_lane(0, first_set);
    let dimensions = |lane: usize| Dimensions::Light { slot: lane as u32, depth };
    for lane in (1..lanes.lights().len()).step_by(2) {
        let sets = sampler.pair(dimensions(lane), dimensions(lane + 1));
        (lane..).zip(&sets).take_while(|(lane, _)| *lane < LANES).for_each(|(lane, set)| set_lane(lane, set));
    }
    numbers
}

/// Chooses one of [`LANES`] candidates at most in proportion to their weights, by `u` in [0, 1). Returns it with its
/// probability. One whose weight is not finite is chosen, so that the film reports it.
fn choose_in_proportion<T: Copy>(
    candidates: impl Iterator<Item = T>,
    weight: impl Fn(&T) -> f32,
    u: f32,
) -> Option<(T, f32)> {
    let (mut kept, mut weights) = ([None; LANES], [0.0; LANES]);
    for (index, candidate) in candidates.enumerate() {
        let weight = weight(&candidate);
        if !weight.is_finite() {
            return Some((candidate, 1.0));
        }
        (kept[index], weights[index]) = (Some(candidate), weight);
    }
    let total: f32 = weights.iter().sum();
    let (index, weight, _) = find_interval(&weights, u * total)?;
    Some((kept[index]?, weight / total))
}

/// Samples of a few lights at a vertex, one a lane.
struct CandidateLanes<'l> {
    lights: &'l [u32],
    samples: LightSampleLanes,
    bsdf: BsdfLanes,
}

impl CandidateLanes<'_> {
    /// Iterates over the candidates that bring light.
    fn iter(&self, vertex: &LitVertex<'_>) -> impl Iterator<Item = LightCandidate> {
        let keeps_dark = vertex.point.control.is_some();
        self.lights.iter().enumerate().filter_map(move |(lane, light)| {
            let (sample, bsdf) = (self.samples.lane(lane)?, self.bsdf.lane(lane));
            let is_lit = bsdf.0 != Vec3::ZERO || keeps_dark;
            is_lit.then_some(LightCandidate { light: *light, pmf: 1.0, sample, bsdf })
        })
    }
}

impl LitVertex<'_> {
    /// Samples all lights at once, each with the two numbers of its lane.
    fn candidates<'l>(&self, scene: &RenderScene, lanes: &'l LightLanes, u: &[[f32; LANES]; 2]) -> CandidateLanes<'l> {
        let lights = lanes.lights();
        let samples = lanes.sample(&scene.lights, self.point.surface.position, u);
        CandidateLanes { lights, samples, bsdf: self.point.bsdf.eval_lanes(&samples.direction, lights.len()) }
    }

    /// Samples the light of a scene that samples one light alone.
    fn only_candidate(&self, scene: &RenderScene, u: Vec2) -> Option<LightCandidate> {
        let light = scene.lights.iter().position(TracedLight::is_sampled)?;
        self.candidate(scene, light as u32, 1.0, u)
    }

    /// Samples a light that is sampled with this probability. Returns none where it brings no light.
    fn candidate(&self, scene: &RenderScene, light: u32, pmf: f32, u: Vec2) -> Option<LightCandidate> {
        let sample = scene.lights[light as usize].sample(self.point.surface.position, u)?;
        let bsdf = self.point.bsdf.eval(sample.direction);
        let is_lit = bsdf.0 != Vec3::ZERO || self.point.control.is_some();
        is_lit.then_some(LightCandidate { light, pmf, sample, bsdf })
    }

    /// Returns the MIS weight of a light sample against emitter hits; 1 for delta lights.
    fn mis_weight(&self, pdf: Option<f32>, pmf: f32, bsdf_pdf: f32) -> f32 {
        pdf.map_or(1.0, |pdf| power_heuristic(pdf * pmf, bsdf_pdf * self.paths))
    }

    /// Returns the time-integrated luminance that a candidate brings if nothing is in between. The control variate counts
    /// by its magnitude: it is divided by the probability of the choice, too.
    fn unshadowed(&self, scene: &RenderScene, candidate: &LightCandidate) -> f32 {
        let LightCandidate { light, pmf, sample, bsdf: (value, bsdf_pdf) } = *candidate;
        let light = &scene.lights[light as usize];
        let control = self.point.control.map_or(Vec3::ZERO, |control| control.eval(sample.direction).0.abs());
        let scattered = luminance(self.path.throughput * (value + control) * light.tint_towards(sample.direction));
        scattered * self.mis_weight(sample.pdf, pmf, bsdf_pdf) * sample.value * light.time_s / pmf
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::raytrace::film::FilmTile;
    use crate::raytrace::{RenderControl, Settings, Shortcut, prepare, render};
    use crate::scene::{
        Aim, Assets, Camera, Emitter, Light, LightId, Material, Object, ObjectId, Output, Scene, Shape, Subsurface,
        Transform,
    };
    use std::ops::ControlFlow;

    #[test]
    fn candidates_are_chosen_in_proportion_to_their_weights() {
        let weights = [0.0, 1.0, 4.0, 0.0, 2.0, 3.0];
        let mut counts = [0; 6];
        for i in 0..1000 {
            let u = (i as f32 + 0.5) / 1000.0;
            let (item, probability) = choose_in_proportion(0..6, |item| weights[*item], u).unwrap();
            assert!((probability - weights[item] / 10.0).abs() < 1e-6, "{item}: {probability}");
            counts[item] += 1;
        }
        for (count, weight) in counts.into_iter().zip(weights) {
            assert!((f64::from(count) - 100.0 * f64::from(weight)).abs() <= 1.0, "{counts:?}");
        }
        assert!(choose_in_proportion(0..6, |_| 0.0, 0.5).is_none());
        assert_eq!(choose_in_proportion(0..6, |item| if *item == 4 { f32::NAN } else { 1.0 }, 0.1), Some((4, 1.0)));
    }

    /// A glossy ball and a screen on a floor; of a wide panel, a small one and a bulb, each lights other sides.
    fn studio() -> Scene {
        let object = |id, position, shape, roughness| Object {
            id: ObjectId(id),
            transform: Transform::at(position),
            material: Material { base_color: [0.7, 0.6, 0.5], roughness, ..Material::default() },
            ..Object::new(format!("Thing {id}"), shape)
        };
        let light = |id, position, emitter, lumens| Light {
            id: LightId(id),
            name: format!("Light {id}"),
            position,
            aim: Aim::Point(Vec3::new(0.0, 0.3, 0.0)),
            ..Light::new(emitter, Output::Lumens(lumens))
        };
        let panel = |width_m, height_m| Emitter::RectPanel { width_m, height_m };
        Scene {
            camera: Camera {
                position: Vec3::new(0.0, 1.2, 2.6),
                aim: Aim::Point(Vec3::new(0.0, 0.2, 0.2)),
                ..Camera::default()
            },
            objects: vec![
                object(1, Vec3::new(0.0, -0.05, 0.0), Shape::Box { size_m: Vec3::new(4.0, 0.1, 4.0) }, 0.7),
                object(2, Vec3::new(0.1, 0.35, 0.0), Shape::Sphere { radius_m: 0.35 }, 0.2),
                object(3, Vec3::new(-0.6, 0.4, 0.0), Shape::Box { size_m: Vec3::new(0.1, 0.8, 1.0) }, 0.5),
            ],
            lights: vec![
                light(1, Vec3::new(-1.4, 1.2, 0.6), panel(0.8, 0.8), 4000.0),
                light(2, Vec3::new(0.9, 1.1, 0.8), panel(0.2, 0.2), 1500.0),
                light(3, Vec3::new(0.2, 1.5, -0.9), Emitter::Point, 500.0),
            ],
            ..Scene::default()
        }
    }

    #[test]
    fn every_light_has_the_same_share_whether_one_is_chosen_among_samples_or_by_importance() {
        let scene = studio();
        // Mean of each light's layer
        let means = |without: Option<Shortcut>| {
            let mut prepared = prepare(&scene, &Assets::default()).unwrap();
            let plan = prepared.plan().clone().without_blur();
            prepared.set_plan(without.into_iter().fold(plan, |plan, shortcut| plan.without(shortcut)));
            let settings = Settings { width: 36, height: 24, spp: 1024, ..Settings::default() };
            let film = render(&prepared, &settings, &RenderControl::new(), &mut |_| ControlFlow::Continue(()));
            let mean = |rgb: &[[f32; 3]]| rgb.iter().map(|rgb| f64::from(luminance(Vec3::from(*rgb)))).sum::<f64>();
            film.develop_layers(&scene).iter().map(|(_, layer)| mean(&layer.rgb)).collect::<Vec<_>>()
        };
        let (among_samples, by_importance) = (means(None), means(Some(Shortcut::AllLights)));
        assert!(among_samples.len() >= 3);
        for (ours, theirs) in among_samples.iter().zip(&by_importance).filter(|(_, theirs)| **theirs > 0.0) {
            assert!((ours / theirs - 1.0).abs() < 0.004, "{among_samples:?} against {by_importance:?}");
        }
    }

    /// Returns a soft, glossy wall beside a matte floor, and two panels: where the gloss reflects one towards the floor,
    /// it reflects next to nothing of the other.
    fn soft_wall() -> Scene {
        let mean_free_path_mm = [1.29, 0.99, 0.79];
        let matte = Material { base_color: [0.6; 3], roughness: 1.0, ior: 1.0, ..Material::default() };
        let skin = Material {
            base_color: [0.8, 0.6, 0.5],
            roughness: 0.15,
            subsurface: Some(Subsurface { mean_free_path_mm }),
            ..Material::default()
        };
        let object = |id, position, size_m, material| Object {
            id: ObjectId(id),
            transform: Transform::at(position),
            material,
            ..Object::new(format!("Thing {id}"), Shape::Box { size_m })
        };
        let Scene { lights, camera, .. } = studio();
        Scene {
            camera: Camera { aim: Aim::Point(Vec3::Y * 0.1), focal_length_mm: 50.0, ..camera },
            objects: vec![
                object(1, Vec3::new(0.0, -0.05, 0.0), Vec3::new(4.0, 0.1, 4.0), matte),
                object(2, Vec3::new(-0.6, 0.4, 0.0), Vec3::new(0.1, 0.8, 2.0), skin),
            ],
            lights: vec![
                Light { position: Vec3::new(1.4, 1.2, 0.6), ..lights[0].clone() },
                Light { position: Vec3::new(0.9, 1.1, -0.8), ..lights[1].clone() },
            ],
            ..studio()
        }
    }

    #[test]
    fn the_choice_of_a_light_at_soft_surfaces_counts_the_control_variate() {
        let scene = soft_wall();
        let prepared = prepare(&scene, &Assets::default()).unwrap();
        let settings = Settings { width: 108, height: 72, spp: 1, ..Settings::default() };
        let film = render(&prepared, &settings, &RenderControl::new(), &mut |_| ControlFlow::Continue(()));
        let sample = |tile: &FilmTile, pixel| {
            (0..film.layers().len()).map(|layer| luminance(tile.sums.at(layer, pixel))).sum::<f32>()
        };
        let of_tile = |tile: &FilmTile| (0..tile.pixels()).map(|pixel| sample(tile, pixel)).collect::<Vec<_>>();
        let samples: Vec<f32> = film.tiles().iter().flat_map(|tile| of_tile(tile)).collect();
        let mean = samples.iter().sum::<f32>() / samples.len() as f32;
        // -0.9 means. Divided by a probability without the variate, it is -16 means
        let least = samples.iter().copied().fold(f32::MAX, f32::min);
        assert!(least > -2.0 * mean, "{least} of a mean of {mean}");
    }
}

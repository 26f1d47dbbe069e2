//! Replay: one sample of one pixel, traced again with every step recorded.

use super::control::RenderControl;
use super::events::PathEvent;
use super::film::{Layer, NonFiniteGate, NonFiniteReport};
use super::lens::FilmCamera;
use super::limits::PathLimits;
use super::passes::{self, PassSchedule, SharedLight, SharedLightTracer};
use super::pixel_sampler::PixelSampler;
use super::render_scene::RenderScene;
use super::sample_pass::SamplePass;
use super::sampler::{SampleId, Sampler};
use super::settings::Settings;
use super::sink::RadianceSink;
use crate::color::luminance;
use crate::photo::exposure;
use crate::scene::Scene;
use glam::Vec3;

/// A sample with all steps of its computation.
#[derive(Clone, Debug)]
pub struct Replay {
    /// The sample.
    pub sample: SampleId,
    /// The steps, in order.
    pub events: Vec<PathEvent>,
    /// Sum of the contributions to each film layer.
    pub sums: Vec<Vec3>,
    /// Non-finite contributions, which are not in the sums.
    pub nonfinite: NonFiniteReport,
}

impl Replay {
    /// Picture value of the sample, with the exposure, white balance and lights of `scene`.
    pub fn picture_value(&self, layers: &[Layer], scene: &Scene) -> Vec3 {
        let scale = exposure::pixel_per_cd_s_m2(scene);
        layers.iter().zip(&self.sums).map(|(layer, sum)| *sum * (layer.weight(scene) * scale)).sum()
    }
}

/// Traces a sample of a pixel as [`super::render()`] does with the same settings, and records every step. None for a
/// sample that the settings do not have.
pub fn replay(scene: &RenderScene, settings: &Settings, (x, y): (u32, u32), index: u32) -> Option<Replay> {
    let pass = PassSchedule::new(scene, settings).passes().find(|pass| pass.contains(index))?;
    let sample = SampleId { x, y, index, seed: settings.seed };
    let mut nonfinite = NonFiniteReport::default();
    let gate = NonFiniteGate { sink: SampleSums::new(scene), sample, report: &mut nonfinite };
    let mut recorder = Recorder { gate, origin: scene.origin, events: Vec::new() };
    let light_tracer = light_tracer(scene, settings);
    PassReplay::new(scene, settings, &light_tracer, pass).trace(sample, &mut recorder);
    let Recorder { gate, events, .. } = recorder;
    let sums = gate.sink.sums;
    Some(Replay { sample, events, sums, nonfinite })
}

/// Returns the tracer of a render's shared light.
fn light_tracer<'a>(scene: &'a RenderScene, settings: &'a Settings) -> SharedLightTracer<'a> {
    let approximations = passes::approximations(scene, settings);
    SharedLightTracer::new(scene, settings, approximations, &RenderControl::new())
}

/// Index of the brightest sample of a pixel; of the first with a non-finite contribution, if there is one.
pub fn brightest_sample(scene: &RenderScene, settings: &Settings, (x, y): (u32, u32)) -> u32 {
    let mut brightest = (0, f32::NEG_INFINITY);
    let light_tracer = light_tracer(scene, settings);
    for pass in PassSchedule::new(scene, settings).passes() {
        let replay = PassReplay::new(scene, settings, &light_tracer, pass);
        for index in pass.first_sample..pass.first_sample + pass.samples {
            let sample = SampleId { x, y, index, seed: settings.seed };
            let mut report = NonFiniteReport::default();
            let mut gate = NonFiniteGate { sink: SampleSums::new(scene), sample, report: &mut report };
            replay.trace(sample, &mut gate);
            let luminance = gate.sink.luminance;
            if report.count > 0 {
                return index;
            }
            if luminance > brightest.1 {
                brightest = (index, luminance);
            }
        }
    }
    brightest.0
}

/// A sample pass of a render, for single samples.
struct PassReplay<'a> {
    scene: &'a RenderScene,
    settings: &'a Settings,
    camera: FilmCamera,
    shared_light: SharedLight,
}

impl<'a> PassReplay<'a> {
    fn new(
        scene: &'a RenderScene,
        settings: &'a Settings,
        light_tracer: &SharedLightTracer<'_>,
        pass: SamplePass,
    ) -> Self {
        let camera = scene.lens.film_camera(settings.width, settings.height);
        let shared_light = light_tracer.trace(pass, &RenderControl::new());
        PassReplay { scene, settings, camera, shared_light }
    }

    fn trace(&self, sample: SampleId, sink: &mut impl RadianceSink) {
        let Settings { method, max_depth, .. } = *self.settings;
        let moment = self.scene.moment_of(&Sampler::of(sample));
        let tracer = self.shared_light.tracer(&self.scene.moments()[moment]);
        let limits = PathLimits::new(method, self.scene.plan(), max_depth);
        PixelSampler { tracer, camera: &self.camera, method, limits }.sample(sample, sink);
    }
}

/// The contributions of one sample, summed layer by layer in the film's order.
struct SampleSums<'a> {
    sums: Vec<Vec3>,
    layer_times: &'a [f32],
    /// Time-integrated luminance, cd s/m2.
    luminance: f32,
}

impl<'a> SampleSums<'a> {
    fn new(scene: &'a RenderScene) -> Self {
        SampleSums { sums: vec![Vec3::ZERO; scene.layers.len()], layer_times: &scene.layer_times, luminance: 0.0 }
    }
}

impl RadianceSink for SampleSums<'_> {
    fn add(&mut self, layer: usize, value: Vec3) {
        self.sums[layer] += value;
        self.luminance += luminance(value) * self.layer_times[layer];
    }
}

/// Records every step, and every contribution before the non-finite gate.
struct Recorder<'a> {
    gate: NonFiniteGate<'a, SampleSums<'a>>,
    /// World position of the tracer's origin.
    origin: Vec3,
    events: Vec<PathEvent>,
}

impl RadianceSink for Recorder<'_> {
    fn add(&mut self, layer: usize, value: Vec3) {
        self.events.push(PathEvent::Contribution { layer, value });
        self.gate.add(layer, value);
    }

    fn record(&mut self, event: impl FnOnce() -> PathEvent) {
        self.events.push(event().into_world(self.origin));
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::raytrace::{Method, prepare, render};
    use crate::scene::{Aim, Assets, Camera, Emitter, Light, LightId, Material, Object, ObjectId, Output, Room, Shape};
    use std::ops::ControlFlow;

    /// A glass ball and a glossy one in a room, under a panel and a spot: splits, photons, MIS and delta lights.
    fn studio() -> Scene {
        let ball = |id, x, material| Object {
            id: ObjectId(id),
            transform: crate::scene::Transform::at(Vec3::new(x, 1.0, 0.0)),
            material,
            ..Object::new(format!("Ball {id}"), Shape::Sphere { radius_m: 0.4 })
        };
        let light = |id, x, emitter| Light {
            id: LightId(id),
            name: format!("Light {id}"),
            position: Vec3::new(x, 2.4, 1.0),
            aim: Aim::Point(Vec3::Y),
            ..Light::new(emitter, Output::Lumens(8000.0))
        };
        Scene {
            camera: Camera { position: Vec3::new(0.0, 1.4, 3.0), aim: Aim::Point(Vec3::Y), ..Camera::default() },
            room: Some(Room::default()),
            objects: vec![
                ball(1, -0.5, Material { transmission: 1.0, roughness: 0.0, ..Material::default() }),
                ball(2, 0.5, Material { roughness: 0.2, ..Material::default() }),
            ],
            lights: vec![
                light(3, -1.0, Emitter::RectPanel { width_m: 0.6, height_m: 0.9 }),
                light(4, 1.0, Emitter::Spot { inner_deg: 40.0, outer_deg: 70.0 }),
            ],
            ..Scene::default()
        }
    }

    #[test]
    fn the_contributions_of_replayed_samples_are_the_films_sums_to_the_bit() {
        let scene = studio();
        let prepared = prepare(&scene, &Assets::default()).unwrap();
        assert!(prepared.plan().photons);
        let settings = Settings { width: 12, height: 8, spp: 3, seed: 3, ..Settings::default() };
        for method in [Method::Path, Method::Direct, Method::Whitted] {
            let settings = Settings { method, ..settings.clone() };
            let mut film = render(&prepared, &settings, &RenderControl::new(), &mut |_| ControlFlow::Continue(()));
            let tile = film.tiles_mut()[0].clone();
            for pixel in (0..tile.pixels()).step_by(19) {
                let mut sums = vec![Vec3::ZERO; prepared.layers.len()];
                for index in 0..settings.spp {
                    let replay = replay(&prepared, &settings, tile.position(pixel), index).unwrap();
                    let mut own = vec![Vec3::ZERO; sums.len()];
                    for event in &replay.events {
                        if let PathEvent::Contribution { layer, value } = *event {
                            sums[layer] += value;
                            own[layer] += value;
                        }
                    }
                    assert_eq!(own, replay.sums);
                }
                let film_sums: Vec<Vec3> = tile.sums.layers().map(|layer| layer[pixel]).collect();
                assert_eq!(sums, film_sums, "{method:?}, pixel {pixel}");
            }
        }
        assert!(replay(&prepared, &settings, (0, 0), 3).is_none());
    }

    #[test]
    fn the_value_of_a_replayed_sample_is_that_of_a_picture_with_one_sample() {
        let scene = studio();
        let prepared = prepare(&scene, &Assets::default()).unwrap();
        let settings = Settings { width: 12, height: 8, spp: 1, ..Settings::default() };
        let film = render(&prepared, &settings, &RenderControl::new(), &mut |_| ControlFlow::Continue(()));
        let picture = film.develop(&scene);
        for (x, y) in [(0, 0), (4, 3), (7, 4), (11, 7)] {
            let replay = replay(&prepared, &settings, (x, y), 0).unwrap();
            assert_eq!(replay.picture_value(&prepared.layers, &scene).to_array(), picture.at(x, y));
        }
    }

    #[test]
    fn the_brightest_sample_is_found_among_all_passes() {
        let scene = studio();
        let prepared = prepare(&scene, &Assets::default()).unwrap();
        let settings = Settings { width: 12, height: 8, spp: 8, ..Settings::default() };
        for pixel in [(4, 3), (7, 4)] {
            let brightness = |index| {
                let replay = replay(&prepared, &settings, pixel, index).unwrap();
                let times = replay.sums.iter().zip(&prepared.layer_times);
                times.map(|(sum, time)| luminance(*sum) * time).sum::<f32>()
            };
            let brightest = brightest_sample(&prepared, &settings, pixel);
            // Sums in another order differ by rounding.
            assert!((0..8).all(|index| brightness(index) <= brightness(brightest) * 1.0001));
        }
    }
}

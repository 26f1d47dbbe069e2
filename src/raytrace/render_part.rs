//! Renders some of the samples of a picture, for farms: parts of it are rendered apart and merged.
//!
//! The samples are those of one render of the whole: a sample is a function of pixel, index and seed, and a pass has
//! the photons and the cache that it has there, however its samples are divided.

use super::coarse::PassPixels;
use super::control::RenderControl;
use super::film_part::FilmPart;
use super::passes::{PassSchedule, SharedLightTracer};
use super::render::{TileJob, empty_film};
use super::render_scene::RenderScene;
use super::sample_pass::SamplePass;
use super::settings::Settings;
use crate::scene::Scene;
use rayon::prelude::*;
use std::ops::Range;
use std::sync::Arc;

/// Renders the samples of `range` of a picture of [`Settings::spp`] samples, on rayon's current pool. `scene` is prepared
/// from `studio`. After each sample of all pixels `on_sample` is called. A cancelled render keeps complete samples.
/// All samples are traced in all parts of the picture: [`Settings::noise_stops`] is ignored.
pub fn render_part(
    scene: &RenderScene,
    studio: &Scene,
    settings: &Settings,
    range: Range<u32>,
    control: &RenderControl,
    on_sample: &mut dyn FnMut(&FilmPart),
) -> FilmPart {
    let camera = scene.lens.film_camera(settings.width, settings.height);
    let empty = empty_film(scene, settings);
    let mut part = FilmPart::new(&empty, studio, settings.aovs);
    let light_tracer = SharedLightTracer::new(scene, settings, empty.approximations(), control);
    for pass in PassSchedule::new(scene, settings).passes() {
        let (first, end) = (pass.first_sample.max(range.start), (pass.first_sample + pass.samples).min(range.end));
        if first >= end {
            continue;
        }
        // Trace the shared light of the whole pass: it is the same in every part that has samples of it
        let shared_light = &light_tracer.trace(pass, control);
        for index in first..end {
            let pass = SamplePass { first_sample: index, samples: 1 };
            let job =
                TileJob { scene, shared_light, camera: &camera, settings, control, pass, pixels: PassPixels::All };
            let mut sample = empty.clone();
            let tiles = sample.tiles_mut();
            if !tiles.par_iter_mut().with_max_len(1).all(|tile| job.run(Arc::make_mut(tile))) {
                return part;
            }
            part.add(&sample);
            on_sample(&part);
        }
    }
    part
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::photo::{AovPicture, Picture};
    use crate::raytrace::{Film, prepare, render};
    use crate::scene::{Assets, Emitter, Light, Material, Object, Output, Room, Shape};
    use glam::Vec3;
    use std::ops::ControlFlow;

    /// A room with a panel, a bulb and a mirror ball: caustics come from photons.
    fn studio() -> Scene {
        let light = |emitter, position| Light { position, ..Light::new(emitter, Output::Lumens(4000.0)) };
        let mut scene = Scene {
            room: Some(Room::default()),
            lights: vec![
                light(Emitter::Point, Vec3::new(1.0, 2.0, 1.0)),
                light(Emitter::RectPanel { width_m: 0.5, height_m: 0.8 }, Vec3::new(-1.0, 1.8, 0.5)),
            ],
            ..Scene::default()
        };
        for (id, light) in scene.lights.iter_mut().enumerate() {
            (light.id, light.name) = (crate::scene::LightId(id as u32 + 1), format!("Light {id}"));
        }
        scene.objects.push(Object {
            id: crate::scene::ObjectId(9),
            transform: crate::scene::Transform::at(Vec3::Y * 0.8),
            material: Material { metallic: 1.0, roughness: 0.0, ..Material::default() },
            ..Object::new("Ball", Shape::Sphere { radius_m: 0.4 })
        });
        scene
    }

    fn part(prepared: &RenderScene, scene: &Scene, settings: &Settings, range: Range<u32>) -> FilmPart {
        render_part(prepared, scene, settings, range, &RenderControl::new(), &mut |_| {})
    }

    /// Returns the largest difference of two pictures, relative to their values.
    fn relative_difference(a: &Picture, b: &Picture) -> f32 {
        let values = a.rgb.as_flattened().iter().zip(b.rgb.as_flattened());
        values.map(|(a, b)| (a - b).abs() / a.max(*b).max(1e-6)).fold(0.0, f32::max)
    }

    #[test]
    fn any_division_of_the_samples_has_the_bits_of_one_part_and_the_samples_of_one_render() {
        let scene = studio();
        let prepared = prepare(&scene, &Assets::default()).unwrap();
        let settings = Settings { width: 70, height: 40, spp: 13, aovs: true, seed: 5, ..Settings::default() };
        let film: Film = render(&prepared, &settings, &RenderControl::new(), &mut |_| ControlFlow::Continue(()));
        assert!(film.approximations().photons);
        let whole = part(&prepared, &scene, &settings, 0..13);
        for cuts in [vec![0, 6, 13], vec![0, 1, 3, 4, 11, 12, 13]] {
            let mut parts: Vec<FilmPart> =
                cuts.windows(2).map(|ends| part(&prepared, &scene, &settings, ends[0]..ends[1])).collect();
            // The last one first: the order is of no account.
            let mut merged = parts.pop().unwrap();
            assert!(parts.iter().all(|part| merged.merge(part)));
            assert!(merged == whole, "{cuts:?}");
            assert_eq!(merged.develop().rgb, whole.develop().rgb);
        }
        // One render adds the same samples as floats of 24 bits, several contributions a sample
        let difference = relative_difference(&whole.develop(), &film.develop(&scene));
        assert!(difference < 13.0 * 8.0 * f32::EPSILON, "{difference}");
        // The denoiser knows the noise of both; the scatter in a part does not see how samples are stratified
        let noise = |aovs: AovPicture| aovs.relative_variance.iter().map(|variance| variance.sqrt()).sum::<f32>();
        let ratio = noise(whole.develop_aovs().unwrap()) / noise(film.aovs().unwrap());
        assert!((1.0..2.0).contains(&ratio), "{ratio}");
        let few = part(&prepared, &scene, &settings, 0..7).develop_aovs().unwrap();
        assert!(few.relative_variance.iter().all(|variance| variance.is_infinite()));
        assert_ne!(part(&prepared, &scene, &settings, 0..6).develop(), whole.develop());
        let (own, films) = (whole.develop_aovs().unwrap(), film.aovs().unwrap());
        assert_eq!((own.depth_m, own.object_id), (films.depth_m, films.object_id));
        let aov = |rgb| Picture { width: 70, height: 40, rgb };
        assert!(relative_difference(&aov(own.albedo), &aov(films.albedo)) < 13.0 * f32::EPSILON);
        assert!(relative_difference(&aov(own.seen_albedo), &aov(films.seen_albedo)) < 13.0 * f32::EPSILON);
        for ((name, layer), (film_name, film_layer)) in whole.lazy_layers().iter().zip(film.develop_layers(&scene)) {
            assert_eq!(*name, film_name);
            assert!(relative_difference(&layer.collect(), &film_layer) < 1e-4, "{name}");
        }
    }

    #[test]
    fn parts_of_pictures_of_another_shape_do_not_merge() {
        let scene = studio();
        let prepared = prepare(&scene, &Assets::default()).unwrap();
        let settings = Settings { width: 8, height: 6, spp: 4, ..Settings::default() };
        let mut first = part(&prepared, &scene, &settings, 0..2);
        let before = first.clone();
        for other in [Settings { width: 6, height: 8, ..settings.clone() }, Settings { aovs: true, ..settings.clone() }]
        {
            assert!(!first.merge(&part(&prepared, &scene, &other, 2..4)));
        }
        let mut dimmed = scene.clone();
        dimmed.camera.iso *= 2.0;
        assert!(!first.merge(&part(&prepared, &dimmed, &settings, 2..4)));
        assert!(first == before);
    }

    #[test]
    fn the_noise_of_a_part_bounds_its_scatter_and_falls_with_the_samples() {
        let scene = studio();
        let prepared = prepare(&scene, &Assets::default()).unwrap();
        let settings = Settings { width: 32, height: 24, spp: 64, ..Settings::default() };
        let noise = |range| part(&prepared, &scene, &settings, range).noise_stops();
        assert_eq!(noise(0..1), None);
        let (few, many) = (noise(0..4).unwrap(), noise(0..64).unwrap());
        assert!(many < 0.5 * few, "{few} {many}");
        // The scatter of two seeds about each other is the root of two times the error
        let pictures = [1, 2].map(|seed| part(&prepared, &scene, &Settings { seed, ..settings.clone() }, 0..16));
        let bound = 2_f64.powf(pictures[0].noise_stops().unwrap()) - 1.0;
        let [a, b] = pictures.map(|part| part.develop());
        let (mut squares, mut sum) = (0.0_f64, 0.0_f64);
        for (a, b) in a.rgb.iter().zip(&b.rgb) {
            let [a, b] = [a, b].map(|rgb| f64::from(crate::color::luminance(Vec3::from(*rgb))));
            squares += (a - b).powi(2) / 2.0;
            sum += (a + b) / 2.0;
        }
        let pixels = a.rgb.len() as f64;
        let scatter = (squares / pixels).sqrt() / (sum / pixels);
        assert!(scatter < 1.1 * bound && scatter > 0.05 * bound, "{scatter} {bound}");
    }

    #[test]
    fn a_cancelled_part_keeps_complete_samples() {
        let scene = studio();
        let prepared = prepare(&scene, &Assets::default()).unwrap();
        let settings = Settings { width: 40, height: 24, spp: 64, ..Settings::default() };
        let control = RenderControl::new();
        let cancelled = render_part(&prepared, &scene, &settings, 10..64, &control, &mut |part| {
            if part.samples == 3 {
                control.cancel();
            }
        });
        assert_eq!(cancelled.samples, 3);
        assert!(cancelled == part(&prepared, &scene, &settings, 10..13));
    }
}

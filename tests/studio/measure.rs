//! Readings from rendered pictures, each with its standard error.
//!
//! Every pixel has its own scramble of the Sobol sequence and, on a tiny card, the same expected value: pixels are
//! independent estimates. Their variance gives the standard error of the mean, and with it the tolerance of a test.

use super::closed_forms::vec3;
use super::statistics::SampleMean;
use super::{REFLECTANCE, looking_at_card, object, replay};
use catchlight::photo::Picture;
use catchlight::raytrace::{self, Film, Method, RenderControl, Settings, Shortcut};
use catchlight::scene::{Assets, Camera, Scene, Shape};
use glam::{DVec3, Quat, Vec3};
use std::ops::ControlFlow;

/// The relative error of a reading from the card's 0.4 mm, single precision and pictures in `f32`.
pub const BIAS: f64 = 2e-4;

/// Renders a film with all samples of `settings`.
pub fn film(scene: &Scene, settings: &Settings) -> Film {
    film_with(scene, &Assets::default(), settings)
}

/// Renders a film of a scene with models.
pub fn film_with(scene: &Scene, assets: &Assets, settings: &Settings) -> Film {
    film_without(&[], scene, assets, settings)
}

/// Renders a film without some shortcuts of the render plan. A failure of the test prints how to trace it again.
fn film_without(without: &'static [Shortcut], scene: &Scene, assets: &Assets, settings: &Settings) -> Film {
    let mut prepared = raytrace::prepare(scene, assets).unwrap();
    prepared.set_plan(without.iter().fold(prepared.plan().clone(), |plan, shortcut| plan.without(*shortcut)));
    let film = raytrace::render(&prepared, settings, &RenderControl::new(), &mut |_| ControlFlow::Continue(()));
    replay::remember(scene, assets, settings, without, &film.develop(scene));
    assert_eq!(film.nonfinite().count, 0, "{:?}", film.nonfinite().first);
    film
}

/// Returns the settings of a square picture.
pub fn square(method: Method, side: u32, spp: u32) -> Settings {
    Settings { width: side, height: side, method, spp, ..Settings::default() }
}

/// Renders and develops a picture; every pixel must be finite and not negative.
pub fn picture(scene: &Scene, settings: &Settings) -> Picture {
    let picture = film(scene, settings).develop(scene);
    assert!(picture.rgb.iter().flatten().all(|v| v.is_finite() && *v >= 0.0), "a pixel is no light");
    picture
}

/// Returns the illuminance of a card of 18 % for a green picture value of 1, lux: the exposure equation solved for it.
pub fn lux_per_value(camera: &Camera) -> f64 {
    let n2 = f64::from(camera.f_number * camera.f_number);
    f64::from(camera.meter_constant) * n2 / f64::from(camera.iso * REFLECTANCE * camera.shutter_s)
}

/// Returns the luminance for a green picture value of 1 of continuous light, cd/m2.
pub fn luminance_per_value(camera: &Camera) -> f64 {
    lux_per_value(camera) * f64::from(REFLECTANCE) / std::f64::consts::PI
}

/// Returns the mean of the green values.
pub fn values(picture: &Picture) -> SampleMean {
    SampleMean::of(picture.rgb.iter().map(|p| f64::from(p[1])))
}

/// Returns the illuminance of the card from a render, lux.
pub fn illuminance(scene: &Scene, settings: &Settings) -> SampleMean {
    values(&picture(scene, settings)).scaled(lux_per_value(&scene.camera))
}

/// Returns the illuminance of the card from a render without photons, lux.
pub fn illuminance_by_paths(scene: &Scene, settings: &Settings) -> SampleMean {
    let film = film_without(&[Shortcut::Photons], scene, &Assets::default(), settings);
    values(&film.develop(scene)).scaled(lux_per_value(&scene.camera))
}

/// Returns the illuminance from renders with several seeds, lux. Pixels share photons and the cache of bounced
/// light, so that only the variance between renders gives the standard error.
pub fn illuminance_over(seeds: u32, scene: &Scene, settings: &Settings) -> SampleMean {
    let reading = |seed| illuminance(scene, &Settings { seed, ..settings.clone() }).mean;
    SampleMean::of((0..seeds).map(reading))
}

/// Returns a scene with a card at `position` that faces `normal`, and a camera that sees 0.4 mm of it and nothing else.
pub fn meter_card(position: Vec3, normal: Vec3) -> Scene {
    let mut card = object("Card", Shape::Plane { width_m: 2e-3, depth_m: 2e-3 }, position);
    card.transform.set_rotation(Quat::from_rotation_arc(Vec3::Y, normal));
    let camera = Camera { focal_length_mm: 5000.0, ..looking_at_card(position, normal) };
    Scene { objects: vec![card], camera, ..Scene::default() }
}

/// Returns a larger [`meter_card`], of which the camera sees 8 mm: an area that many photons reach.
pub fn wide_meter_card(position: Vec3, normal: Vec3) -> Scene {
    let mut scene = meter_card(position, normal);
    scene.objects[0].shape = Shape::Plane { width_m: 0.02, depth_m: 0.02 };
    scene.camera.focal_length_mm = 250.0;
    scene
}

/// Returns the corners of a panel in world space, counter-clockwise as seen from its front.
pub fn corners(scene: &Scene, light: usize, width_m: f32, height_m: f32) -> [DVec3; 4] {
    let frame = scene.light_frame(&scene.lights[light]);
    [(-1.0, -1.0), (-1.0, 1.0), (1.0, 1.0), (1.0, -1.0)]
        .map(|(x, y)| vec3(frame.transform_point3(Vec3::new(x * width_m, y * height_m, 0.0) * 0.5)))
}

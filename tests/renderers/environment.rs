//! Environment maps against closed forms: an even one is a surround, one bright pixel is a sun.

use crate::studio::{self, light};
use catchlight::photo::meter::Receptor;
use catchlight::raytrace::{LightMeter, MeterEffort, MeterPoint, RenderControl, Settings, prepare, render};
use catchlight::scene::{
    Aim, Assets, Camera, Emitter, EnvironmentMap, Light, Material, Output, Scene, Shape, Transform,
};
use glam::Vec3;
use std::ops::ControlFlow;
use std::sync::Arc;

const PATH: &str = "environments/test.hdr";

/// Returns a surround of a map and the assets with it.
fn surround(width: u32, height: u32, lux: f32, pixel: impl Fn(u32, u32) -> [f32; 3]) -> (Light, Assets) {
    let pixels = (0..height).flat_map(|y| (0..width).map(move |x| (x, y))).map(|(x, y)| pixel(x, y)).collect();
    let mut assets = Assets::default();
    assets.insert_environment(PATH, Arc::new(EnvironmentMap::new(width, height, pixels).unwrap()));
    let light = light(Emitter::Surround, Output::Lux(lux), Vec3::ZERO);
    (Light { environment_map: Some(PATH.to_owned()), ..light }, assets)
}

fn lux(scene: &Scene, assets: &Assets, position: Vec3, facing: Vec3) -> f32 {
    let meter = LightMeter::new(scene, assets, position).unwrap();
    let point = MeterPoint { position, facing, receptor: Receptor::Flat };
    let result = meter.read(&point, &MeterEffort::default(), &RenderControl::new()).unwrap();
    assert_eq!(result.nonfinite.count, 0);
    let (direct, bounced) = result.reading.total_lux();
    direct + bounced
}

/// The direction of the middle of a pixel: the picture's middle lies towards -Z, its right half towards +X.
fn towards(x: u32, y: u32, [width, height]: [u32; 2]) -> Vec3 {
    let turn = std::f32::consts::TAU * ((x as f32 + 0.5) / width as f32 - 0.5);
    let polar = std::f32::consts::PI * (y as f32 + 0.5) / height as f32;
    Vec3::new(turn.sin() * polar.sin(), polar.cos(), -turn.cos() * polar.sin())
}

#[test]
fn an_even_map_is_the_surround_of_its_illuminance() {
    let (light, assets) = surround(32, 16, 4000.0, |_, _| [3.0; 3]);
    let plain = Light { environment_map: None, ..light.clone() };
    let floor = studio::object("Floor", Shape::Plane { width_m: 1.0, depth_m: 1.0 }, Vec3::NEG_Y * 0.3);
    for facing in [Vec3::Y, Vec3::new(0.6, 0.0, -0.8)] {
        let scene =
            |light: &Light| Scene { lights: vec![light.clone()], objects: vec![floor.clone()], ..Scene::default() };
        let [mapped, even] = [&light, &plain].map(|light| lux(&scene(light), &assets, Vec3::ZERO, facing));
        assert!((mapped / even - 1.0).abs() < 0.01, "{facing}: {mapped} and {even} lx");
    }
    // In the open, all of it arrives
    let open = lux(&Scene { lights: vec![light], ..Scene::default() }, &assets, Vec3::ZERO, Vec3::X);
    assert!((open / 4000.0 - 1.0).abs() < 0.01, "{open} lx");
}

#[test]
fn a_map_with_one_bright_pixel_is_a_sun_of_its_direction_and_illuminance() {
    let size = [256, 128];
    let (at, turned_deg) = ((170, 40), 30.0);
    let (mut light, assets) = surround(size[0], size[1], 10_000.0, |x, y| [if (x, y) == at { 900.0 } else { 0.0 }; 3]);
    light.roll_deg = turned_deg;
    let sun = glam::Quat::from_rotation_y(turned_deg.to_radians()) * towards(at.0, at.1, size);
    let emitter = Emitter::Sun { angular_diameter_deg: 0.0 };
    let real = Light { aim: Aim::Point(-sun), ..studio::light(emitter, Output::Lux(10_000.0), Vec3::ZERO) };
    let scene = |light: &Light| Scene { lights: vec![light.clone()], ..Scene::default() };
    for facing in [sun, Vec3::Y, Vec3::X, -sun] {
        let [mapped, expected] = [&light, &real].map(|light| lux(&scene(light), &assets, Vec3::ZERO, facing));
        // A pixel of 1.4 degrees instead of a point
        assert!((mapped - expected).abs() < 10.0, "{facing}: {mapped} lx for {expected}");
    }
    // A ball in its way casts a shadow
    let ball = studio::object("Ball", Shape::Sphere { radius_m: 0.2 }, sun);
    let shaded = lux(&Scene { objects: vec![ball], ..scene(&light) }, &assets, Vec3::ZERO, sun);
    assert!(shaded < 5.0, "{shaded} lx in the shadow");
}

#[test]
fn each_direction_has_its_colour() {
    // Red from the right (+X), blue from the left
    let (light, assets) = surround(64, 32, 5000.0, |x, _| if x >= 32 { [1.0, 0.05, 0.05] } else { [0.05, 0.05, 1.0] });
    let mut card = studio::object("Card", Shape::Sphere { radius_m: 0.5 }, Vec3::ZERO);
    card.material = Material { base_color: [0.8; 3], ior: 1.0, roughness: 1.0, ..Material::default() };
    card.transform = Transform::at(Vec3::ZERO);
    let camera = Camera { position: Vec3::Z * 3.0, aim: Aim::Point(Vec3::ZERO), ..Camera::default() };
    let scene = Scene { camera, objects: vec![card], lights: vec![light], ..Scene::default() };
    let prepared = prepare(&scene, &assets).unwrap();
    let settings = Settings { width: 24, height: 16, spp: 16, ..Settings::default() };
    let film = render(&prepared, &settings, &RenderControl::new(), &mut |_| ControlFlow::Continue(()));
    let picture = film.develop(&scene);
    let side = |columns: std::ops::Range<usize>| {
        let pixels = (6..10).flat_map(|y| columns.clone().map(move |x| y * 24 + x)).map(|i| Vec3::from(picture.rgb[i]));
        pixels.sum::<Vec3>()
    };
    // The ball spans columns 7 to 16 or so
    let (left, right) = (side(8..10), side(14..16));
    // These normals are turned by half of a right angle at most: each gets light from both halves
    assert!(right.x > 1.4 * right.z && left.z > 1.4 * left.x, "left {left}, right {right}");
    // White balance apart, both sides get the same amount of green
    assert!((left.y / right.y - 1.0).abs() < 0.3, "left {left}, right {right}");
}

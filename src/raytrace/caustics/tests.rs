use super::grid::PhotonGrid;
use super::photon::Photon;
use super::photon_tracer::shading_correction;
use super::*;
use crate::raytrace::{RenderControl, Settings, prepare, render};
use crate::scene::{Aim, Assets, Camera, Emitter, Light, LightId, Material, Object, ObjectId, Output, Scene, Shape};
use crate::statistics::TestRng;
use glam::{Vec2, Vec3};
use std::collections::HashMap;
use std::f32::consts::PI;
use std::ops::ControlFlow;

fn photon(position: Vec3) -> Photon {
    Photon { position, direction: Vec3::Y, normal: Vec3::Y, flux: Vec3::ONE, layer: 0, density: 1.0, specular_depth: 1 }
}

#[test]
fn grid_queries_match_brute_force() {
    let mut rng = TestRng::new(5);
    // Around the origin, where cell coordinates change sign, and enough for hash collisions.
    let photons: Vec<Photon> = (0..3000).map(|_| photon(rng.direction() * rng.range(0.0, 2.0))).collect();
    for radius in [0.01, 0.2, 5.0] {
        let grid = PhotonGrid::new(photons.clone(), radius);
        let mut most = 0;
        for _ in 0..300 {
            let position = rng.direction() * rng.range(0.0, 2.1);
            let mut found = Vec::new();
            grid.for_each_near(position, |photon, distance2| found.push((photon.position.to_array(), distance2)));
            let near = |p: &&Photon| p.position.distance_squared(position) < radius * radius;
            let mut all: Vec<_> = photons
                .iter()
                .filter(near)
                .map(|p| (p.position.to_array(), p.position.distance_squared(position)))
                .collect();
            let by_position = |a: &([f32; 3], f32), b: &([f32; 3], f32)| a.partial_cmp(b).unwrap();
            found.sort_by(by_position);
            all.sort_by(by_position);
            assert_eq!(found, all);
            most = most.max(all.len());
        }
        assert!(most > 0, "nothing to find within {radius}");
    }
    PhotonGrid::new(Vec::new(), 0.1).for_each_near(Vec3::ZERO, |_, _| panic!("found in nothing"));
}

#[test]
fn the_shading_correction_makes_photons_agree_with_camera_paths() {
    let (from, normal) = (Vec3::new(0.6, 0.8, 0.0), Vec3::new(0.1, 1.0, 0.05).normalize());
    let to = (2.0 * from.dot(normal) * normal - from).normalize();
    assert!((shading_correction(from, to, normal, normal) - 1.0).abs() < 1e-6);
    // Reflection has equal cosines to the shading normal: the triangle's foreshortening remains.
    let expected = to.y / from.y;
    assert!((shading_correction(from, to, normal, Vec3::Y) / expected - 1.0).abs() < 1e-5);
    assert_eq!(shading_correction(Vec3::X, to, normal, Vec3::Y), 0.0);
}

fn object(id: u32, shape: Shape, position: Vec3, material: Material) -> Object {
    let transform = crate::scene::Transform::at(position);
    Object { id: ObjectId(id), transform, material, ..Object::new(format!("Object {id}"), shape) }
}

/// A glass ball and a chrome ball on a floor, with two delta lights.
fn still_life() -> Scene {
    let floor = Shape::Plane { width_m: 4.0, depth_m: 4.0 };
    let ball = Shape::Sphere { radius_m: 0.3 };
    let glass = Material { base_color: [1.0; 3], transmission: 1.0, roughness: 0.0, ..Material::default() };
    let chrome = Material { metallic: 1.0, roughness: 0.0, ..Material::default() };
    let lamp = |id, x| Light {
        id: LightId(id),
        name: format!("Lamp {id}"),
        position: Vec3::new(x, 2.0, 0.5),
        aim: Aim::Point(Vec3::ZERO),
        ..Light::new(Emitter::Point, Output::Lumens(5000.0))
    };
    Scene {
        objects: vec![
            object(1, floor, Vec3::ZERO, Material::default()),
            object(2, ball.clone(), Vec3::new(-0.4, 0.3, 0.0), glass),
            object(3, ball, Vec3::new(0.4, 0.3, 0.0), chrome),
        ],
        lights: vec![lamp(4, -1.0), lamp(5, 1.5)],
        camera: Camera { position: Vec3::new(0.0, 1.5, 3.0), aim: Aim::Point(Vec3::ZERO), ..Camera::default() },
        ..Scene::default()
    }
}

#[test]
fn casters_are_sampled_by_area() {
    let scene = prepare(&still_life(), &Assets::default()).unwrap();
    let sphere = 4.0 * PI * 0.3 * 0.3;
    assert!((scene.casters.area() / (2.0 * sphere) - 1.0).abs() < 0.02, "{} of flat triangles", scene.casters.area());
    let mut rng = TestRng::new(8);
    let mut counts: HashMap<u32, u32> = HashMap::new();
    let mut above = 0;
    for _ in 0..20_000 {
        let hit = scene.casters.sample(rng.uniform(), rng.unit_square()).unwrap();
        let [b, c] = hit.triangle().barycentric;
        assert!(b >= 0.0 && c >= 0.0 && b + c <= 1.0);
        *counts.entry(scene.aggregate.instances()[hit.instance as usize].object).or_default() += 1;
        above += u32::from(scene.aggregate.surface(&hit).geometric_normal.y > 0.0);
    }
    // Two balls of one size; the upper halves of both. Six standard errors of 71.
    assert_eq!(counts.len(), 2, "{counts:?}");
    assert!(counts.values().chain([&above]).all(|count| count.abs_diff(10_000) < 430), "{counts:?}, {above} above");
    assert!(CausticCasters::default().sample(0.5, Vec2::splat(0.5)).is_none());
}

#[test]
fn caustics_have_the_same_bits_for_any_number_of_threads() {
    let scene = prepare(&still_life(), &Assets::default()).unwrap();
    assert!(scene.plan().photons);
    let settings = Settings { width: 40, height: 30, spp: 4, ..Settings::default() };
    let picture = |threads| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
        let trace = || render(&scene, &settings, &RenderControl::new(), &mut |_| ControlFlow::Continue(()));
        pool.install(trace).develop(&still_life())
    };
    let one = picture(1);
    assert!(one == picture(3) && one == picture(5));
}

#[test]
fn caustics_are_on_the_layer_of_their_light() {
    let studio = still_life();
    let settings = Settings { width: 40, height: 30, spp: 8, ..Settings::default() };
    let layers = |lights: &[Light]| {
        let studio = Scene { lights: lights.to_vec(), ..studio.clone() };
        let prepared = prepare(&studio, &Assets::default()).unwrap();
        let film = render(&prepared, &settings, &RenderControl::new(), &mut |_| ControlFlow::Continue(()));
        film.develop_layers(&studio)
    };
    let sum = |layers: &[(String, crate::photo::Picture)], name: &str| -> f32 {
        let of_name = layers.iter().find(|(layer, _)| layer == name).unwrap();
        of_name.1.rgb.iter().flatten().sum()
    };
    let both = layers(&studio.lights);
    for light in &studio.lights {
        let (together, alone) = (sum(&both, &light.name), sum(&layers(std::slice::from_ref(light)), &light.name));
        // Half as many photons each, where there are two.
        assert!((together / alone - 1.0).abs() < 0.02, "{}: {together} beside {alone} alone", light.name);
    }
}

#[test]
fn a_cancelled_photon_pass_traces_nothing() {
    let scene = prepare(&still_life(), &Assets::default()).unwrap();
    let control = RenderControl::new();
    control.cancel();
    let pass = PhotonPass { first_sample: 0, samples: 16, photons: 1 << 20, pixel_m: 1e-3, eye: Vec3::ZERO, seed: 0 };
    let map = PhotonMap::trace(&scene, &pass, &control);
    assert_eq!(control.rays(), 0);
    map.full.grid.for_each_near(Vec3::ZERO, |_, _| panic!("a photon of a cancelled pass"));
}

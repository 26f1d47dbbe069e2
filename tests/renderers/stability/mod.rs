//! Robustness: extreme scenes render finite values, the same for any number of threads, within the stated errors.

mod lights;
mod surfaces;

use crate::studio::measure::{picture, square, values};
use crate::studio::{self, light};
use catchlight::photo::Picture;
use catchlight::raytrace::{self, Method, RenderControl, Settings};
use catchlight::scene::{Aim, Assets, Camera, Emitter, Material, Object, ObjectId, Output, Scene, Sensor, Shape};
use glam::Vec3;
use std::ops::ControlFlow;

fn object_with_id(id: u32, name: &str, shape: Shape, position: Vec3) -> Object {
    Object { id: ObjectId(id), ..studio::object(name, shape, position) }
}

fn grey(reflectance: f32) -> Material {
    Material { base_color: [reflectance; 3], ior: 1.0, roughness: 1.0, ..Material::default() }
}

fn metal(roughness: f32) -> Material {
    Material { base_color: [0.9; 3], metallic: 1.0, roughness, ..Material::default() }
}

fn glass() -> Material {
    Material { base_color: [1.0; 3], transmission: 1.0, roughness: 0.0, ior: 1.5, ..Material::default() }
}

/// Returns a sphere on a floor under a small panel: the base scene of the tests.
fn base_scene() -> Scene {
    let mut floor = object_with_id(0, "Floor", Shape::Plane { width_m: 4.0, depth_m: 4.0 }, Vec3::ZERO);
    floor.material = grey(0.5);
    let mut ball = object_with_id(1, "Ball", Shape::Sphere { radius_m: 0.3 }, Vec3::Y * 0.3);
    ball.material = grey(0.5);
    let mut key =
        light(Emitter::RectPanel { width_m: 0.3, height_m: 0.3 }, Output::Lumens(3000.0), Vec3::new(1.0, 2.0, 1.0));
    key.aim = Aim::Point(Vec3::Y * 0.3);
    let camera = Camera {
        position: Vec3::new(0.0, 1.0, 3.0),
        aim: Aim::Point(Vec3::Y * 0.3),
        focal_length_mm: 50.0,
        ..Camera::default()
    };
    Scene { objects: vec![floor, ball], lights: vec![key], camera, ..Scene::default() }
}

/// Asserts that all methods render finite values that are not negative, with the same bits on one and three threads.
/// Returns the path-traced picture.
fn assert_robust(scene: &Scene, assets: &Assets) -> Picture {
    assert_robust_at((45, 30), scene, assets)
}

/// As `assert_robust`, in a picture of so many pixels.
fn assert_robust_at((width, height): (u32, u32), scene: &Scene, assets: &Assets) -> Picture {
    let prepared = raytrace::prepare(scene, assets).unwrap();
    let settings = Settings { width, height, spp: 4, ..Settings::default() };
    let with = |threads: usize, method: Method| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
        let settings = Settings { method, ..settings.clone() };
        let film = pool.install(|| {
            raytrace::render(&prepared, &settings, &RenderControl::new(), &mut |_| ControlFlow::Continue(()))
        });
        assert_eq!(film.nonfinite().count, 0, "{method:?}: {:?}", film.nonfinite().first);
        film.develop(scene)
    };
    let [_, _, path] = [Method::Whitted, Method::Direct, Method::Path].map(|method| {
        let picture = with(1, method);
        assert!(
            picture.rgb.iter().flatten().all(|v| v.is_finite() && *v >= 0.0),
            "{method:?} has a negative or non-finite pixel"
        );
        assert_eq!(picture, with(3, method), "{method:?} depends on the number of threads");
        picture
    });
    path
}

fn mean(picture: &Picture) -> f64 {
    values(picture).mean
}

#[test]
fn a_studio_far_from_the_origin_renders_the_same() {
    let reference = assert_robust(&base_scene(), &Assets::default());
    for far in [1e3_f32, 1e5] {
        let offset = Vec3::new(far, 0.0, -far);
        let mut scene = base_scene();
        scene.objects.iter_mut().for_each(|o| o.transform.position += offset);
        for light in &mut scene.lights {
            light.position += offset;
            light.aim = Aim::Point(Vec3::Y * 0.3 + offset);
        }
        scene.camera.position += offset;
        scene.camera.aim = Aim::Point(Vec3::Y * 0.3 + offset);
        let moved = assert_robust(&scene, &Assets::default());
        // The samples are the same; at 1e5 m positions are rounded to 8 mm, here all by the same amount.
        assert!(
            (mean(&moved) / mean(&reference) - 1.0).abs() < 0.01,
            "{far}: {} for {}",
            mean(&moved),
            mean(&reference)
        );
    }
}

#[test]
fn a_millimetre_object_on_a_ten_metre_cyclorama_is_lit_and_casts_its_shadow() {
    // The picture is that of a sphere a thousand times larger, seen from a thousand times as far.
    let view = |size: f32| {
        let mut scene = base_scene();
        let cyclorama = Shape::Sweep { width_m: 10.0, height_m: 5.0, depth_m: 10.0, radius_m: 1.0 };
        scene.objects[0] = Object { material: grey(0.5), ..object_with_id(0, "Cyclorama", cyclorama, Vec3::Z * -5.0) };
        scene.objects[1].shape = Shape::Sphere { radius_m: 0.5 * size };
        scene.objects[1].transform.position = Vec3::Y * 0.5 * size;
        let sun = Emitter::Sun { angular_diameter_deg: 0.0 };
        scene.lights[0] = light(sun, Output::Lux(10_000.0), Vec3::new(2.0, 1.0, 0.5));
        scene.camera.position = Vec3::new(0.0, 3.0, 1.0) * size;
        scene.camera.aim = Aim::Point(Vec3::Y * 0.5 * size);
        picture(&scene, &square(Method::Direct, 32, 16))
    };
    let (large, small) = (view(1.0), view(1e-3));
    let difference: f64 = large.rgb.iter().zip(&small.rgb).map(|(a, b)| f64::from((a[1] - b[1]).abs())).sum();
    // A few samples are on the other side of an edge.
    assert!(difference / large.rgb.len() as f64 / mean(&large) < 1e-3, "{difference}");
    let darkest = large.rgb.iter().map(|p| f64::from(p[1])).fold(f64::INFINITY, f64::min);
    assert!(darkest < 0.01 * mean(&large), "the sphere casts no shadow: {darkest}");
}

#[test]
fn cameras_inside_meshes_and_vertical_cameras_are_robust() {
    for (position, aim) in [
        (Vec3::Y * 0.3, Vec3::new(0.0, 0.3, -1.0)),
        (Vec3::new(0.0, 0.01, 0.0), Vec3::Y * 5.0),
        (Vec3::Y * 3.0, Vec3::ZERO),
        (Vec3::new(0.0, 0.3, 0.3), Vec3::Y * 0.3),
        (Vec3::new(0.0, 0.0, 1.0), Vec3::ZERO),
    ] {
        for material in [grey(0.5), glass(), metal(0.0)] {
            let mut scene = base_scene();
            scene.objects[1].material = material;
            scene.camera.position = position;
            scene.camera.aim = Aim::Point(aim);
            assert_robust(&scene, &Assets::default());
        }
    }
}

#[test]
fn odd_picture_sizes_are_robust() {
    let prepared = raytrace::prepare(&base_scene(), &Assets::default()).unwrap();
    for (width, height) in [(1, 1), (1, 100), (100, 1), (33, 31), (65, 1), (32, 32)] {
        let settings = Settings { width, height, spp: 3, ..Settings::default() };
        let film = raytrace::render(&prepared, &settings, &RenderControl::new(), &mut |_| ControlFlow::Continue(()));
        let picture = film.develop(&base_scene());
        assert_eq!(picture.rgb.len(), (width * height) as usize);
        assert!(picture.rgb.iter().flatten().all(|v| v.is_finite()));
    }
}

#[test]
fn the_largest_and_smallest_values_of_a_file_render_finite() {
    for (output, emitter) in [
        (Output::Lumens(1e9), Emitter::RectPanel { width_m: 1e-5, height_m: 1e-5 }),
        (Output::Candela(1e9), Emitter::Sphere { radius_m: 1e-5 }),
        (Output::LuxAt { lux: 1e9, distance_m: 1e4 }, Emitter::Spot { inner_deg: 0.0, outer_deg: 0.1 }),
        (Output::LuxAt { lux: 1e-9, distance_m: 1e-3 }, Emitter::RoundPanel { diameter_m: 1e5 }),
        (Output::FlashWs { energy_ws: 1e6, efficacy_lm_s_per_ws: 683.0 }, Emitter::Point),
    ] {
        for (dial_stops, iso, f_number) in [(10.0, 1e7, 0.5), (-20.0, 1.0, 1000.0)] {
            let mut scene = base_scene();
            scene.lights[0].emitter = emitter;
            scene.lights[0].power = catchlight::scene::Power { output, dial_stops };
            scene.camera = Camera { iso, f_number, meter_constant: 1.0, shutter_s: 1e5, ..scene.camera };
            assert_robust(&scene, &Assets::default());
        }
    }
}

#[test]
fn the_smallest_and_largest_objects_of_a_file_are_robust() {
    for (radius_m, scale) in [(1e-5, 1e-5), (1e5, 1e5), (1e-5, 1.0), (1.0, 1e-5), (1e5, 1.0)] {
        let mut scene = base_scene();
        scene.objects[1].shape = Shape::Sphere { radius_m };
        scene.objects[1].transform.scale = Vec3::new(scale, 1.0, scale);
        assert_robust(&scene, &Assets::default());
        scene.objects[1].transform.scale = Vec3::splat(scale);
        scene.objects[1].material = glass();
        scene.camera.sensor = Sensor::Custom { width_mm: 1000.0, height_mm: 1.0 };
        assert_robust(&scene, &Assets::default());
    }
}

use super::casters::CasterPoint;
use super::grid::HashGrid;
use super::photon::Photon;
use super::photon_tracer::shading_correction;
use super::*;
use crate::raytrace::bsdf::BsdfSample;
use crate::raytrace::{RenderControl, Settings, prepare, render};
use crate::scene::{Aim, Assets, Camera, Emitter, Light, LightId, Material, Object, ObjectId, Output, Scene, Shape};
use crate::statistics::TestRng;
use glam::{Vec2, Vec3};
use std::collections::HashMap;
use std::f32::consts::PI;
use std::ops::ControlFlow;
use std::sync::Arc;

fn photon(position: Vec3) -> Photon {
    Photon { position, direction: Vec3::Y, normal: Vec3::Y, flux: Vec3::ONE, layer: 0, density: 1.0, specular_depth: 1 }
}

#[test]
fn grid_queries_match_brute_force() {
    let mut rng = TestRng::new(5);
    // Around the origin, where cell coordinates change sign, and enough for hash collisions.
    let photons: Vec<Photon> = (0..3000).map(|_| photon(rng.direction() * rng.range(0.0, 2.0))).collect();
    for radius in [0.01, 0.2, 5.0] {
        // Queries may be smaller than the cells
        let grid = HashGrid::new(&photons, 1.5 * radius);
        let mut most = 0;
        for _ in 0..300 {
            let position = rng.direction() * rng.range(0.0, 2.1);
            let mut found: Vec<_> = grid
                .near(position, radius)
                .map(|(photon, distance2)| (photon.position.to_array(), distance2))
                .collect();
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
    assert_eq!(HashGrid::<Photon>::new(&[], 0.1).near(Vec3::ZERO, 0.1).count(), 0);
}

#[test]
fn the_shading_correction_makes_photons_agree_with_camera_paths() {
    let (from, normal) = (Vec3::new(0.6, 0.8, 0.0), Vec3::new(0.1, 1.0, 0.05).normalize());
    let mirrored = |normal: Vec3| BsdfSample::specular((2.0 * from.dot(normal) * normal - from).normalize());
    let to = mirrored(normal);
    assert!((shading_correction(from, &to, 1.0, normal) - 1.0).abs() < 1e-6);
    // Reflection has equal cosines to the shading normal: the triangle's foreshortening remains.
    let expected = to.direction.y / from.y;
    assert!((shading_correction(from, &to, 1.0, Vec3::Y) / expected - 1.0).abs() < 1e-5);
    assert_eq!(shading_correction(Vec3::X, &to, 1.0, Vec3::Y), 0.0);
    // Mirrored about the geometric normal, whatever the interpolated one is
    assert!((shading_correction(from, &mirrored(Vec3::Y), 1.0, Vec3::Y) - 1.0).abs() < 1e-5);
}

#[test]
fn the_shading_correction_of_refraction_is_about_the_normal_that_refracts() {
    let (from, normal) = (Vec3::new(0.6, 0.8, 0.0), Vec3::new(0.3, 1.0, 0.05).normalize());
    for eta in [1.5_f32, 1.0 / 1.1] {
        // Snell's law: the tangential part of `from` is divided by the relative index
        let refracted = |normal: Vec3| {
            let tangential = (normal * from.dot(normal) - from) / eta;
            let direction = tangential - normal * (1.0 - tangential.length_squared()).sqrt();
            BsdfSample { is_transmission: true, eta_scale: 1.0 / (eta * eta), ..BsdfSample::specular(direction) }
        };
        let to = refracted(normal);
        let expected = from.dot(normal) * to.direction.y.abs() / (from.y * to.direction.dot(normal).abs());
        assert!((expected - 1.0).abs() > 0.01);
        assert!((shading_correction(from, &to, eta, Vec3::Y) / expected - 1.0).abs() < 1e-4, "{eta}");
        for normal in [normal, Vec3::Y] {
            assert!((shading_correction(from, &refracted(normal), eta, normal) - 1.0).abs() < 1e-4, "{eta}");
            // Also where the path started inside of the body, so that radiance is not scaled
            let from_inside = BsdfSample { eta_scale: 1.0, ..refracted(normal) };
            assert!((shading_correction(from, &from_inside, eta, normal) - 1.0).abs() < 1e-4, "{eta} from inside");
        }
    }
    let straight = BsdfSample { is_transmission: true, ..BsdfSample::specular(-from) };
    assert_eq!(shading_correction(from, &straight, 1.0, normal), 1.0);
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
        let starts = StartDensity::default();
        let CasterPoint { hit, relative_density, .. } =
            scene.casters.sample(&starts, rng.uniform(), rng.unit_square()).unwrap();
        assert_eq!(relative_density, 1.0);
        let [b, c] = hit.triangle().barycentric;
        assert!(b >= 0.0 && c >= 0.0 && b + c <= 1.0);
        *counts.entry(scene.aggregate.instances()[hit.instance as usize].object).or_default() += 1;
        above += u32::from(scene.aggregate.surface(&hit).geometric_normal.y > 0.0);
    }
    // Two balls of one size; the upper halves of both. Six standard errors of 71.
    assert_eq!(counts.len(), 2, "{counts:?}");
    assert!(counts.values().chain([&above]).all(|count| count.abs_diff(10_000) < 430), "{counts:?}, {above} above");
    assert!(CausticCasters::default().sample(&StartDensity::default(), 0.5, Vec2::splat(0.5)).is_none());
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
    let settings = Settings { width: 40, height: 30, ..Settings::default() };
    let camera = scene.lens.film_camera(40, 30);
    let view = Arc::new(CausticView::learn(&scene, &camera, 1 << 20, settings.seed, &control));
    let pass = PhotonPass { first_sample: 0, samples: 16, photons: 1 << 20, seed: settings.seed };
    let map = PhotonMap::trace(&scene, &pass, &view, &control);
    assert_eq!(control.rays(), 0);
    assert_eq!(map.full.grid.near(Vec3::ZERO, map.full.radius(1.0)).count(), 0);
}

#[test]
fn guided_points_have_the_density_that_their_hits_have() {
    let scene = prepare(&still_life(), &Assets::default()).unwrap();
    // The first half of the curve matters more, and some of the rest
    let importances: Vec<f64> =
        (0..8192).map(|section| f64::from(u8::from(section < 4096 || section % 7 == 0))).collect();
    let starts = StartDensity::new(&importances);
    let mut rng = TestRng::new(12);
    let mut areas = 0.0;
    const POINTS: u32 = 20_000;
    for _ in 0..POINTS {
        let point = scene.casters.sample(&starts, rng.uniform(), rng.unit_square()).unwrap();
        let density = scene.casters.relative_density(&starts, &point.hit);
        let density = density.unwrap();
        assert!((density / point.relative_density - 1.0).abs() < 1e-4, "{point:?}: {density}");
        // The mean of 1 / density is the share of the area that is sampled: all of it
        areas += 1.0 / f64::from(density);
    }
    assert!((areas / f64::from(POINTS) - 1.0).abs() < 0.02, "{}", areas / f64::from(POINTS));
}

/// The still life, seen from near the chrome ball's caustic.
fn close_up() -> Scene {
    let mut scene = still_life();
    scene.camera.aim = Aim::Point(Vec3::new(0.75, 0.0, 0.1));
    scene.camera.position = Vec3::new(0.75, 0.6, 0.4);
    scene.camera.focal_length_mm = 200.0;
    scene
}

#[test]
fn photons_start_where_they_reach_the_picture() {
    let scene = prepare(&close_up(), &Assets::default()).unwrap();
    let camera = scene.lens.film_camera(60, 40);
    let control = RenderControl::new();
    let learned = CausticView::learn(&scene, &camera, 1 << 20, 0, &control);
    let uniform = CausticView::unguided(&scene, &camera);
    let visible = |view: CausticView| {
        let pass = PhotonPass { first_sample: 0, samples: 1, photons: 1 << 15, seed: 7 };
        let view = Arc::new(view);
        let map = PhotonMap::trace(&scene, &pass, &view, &control);
        let mut seen = 0;
        for point in view.visible.points() {
            seen += map.full.grid.near(point.position, map.full.radius(point.distance)).count();
        }
        let area: f32 = map.full.area(view.visible.points()[0].distance);
        seen as f64 / f64::from(area)
    };
    let gain = visible(learned) / visible(uniform);
    assert!(gain > 10.0, "{gain:.1} times the photons in the picture");
}

#[test]
fn a_guided_close_up_has_the_light_of_paths_from_every_start() {
    // The same picture by photons that start uniformly: guiding changes the noise alone
    let studio = close_up();
    let scene = prepare(&studio, &Assets::default()).unwrap();
    let camera = scene.lens.film_camera(24, 16);
    let control = RenderControl::new();
    let flux = |view: CausticView| {
        let surroundings = view.visible.surroundings(1.0);
        let (mut sum, mut squares) = (0.0, 0.0);
        const PASSES: u32 = 16;
        for seed in 0..PASSES {
            let mut stored = Vec::new();
            let mut tracer = PhotonTracer::new(&scene, &view.starts);
            const PHOTONS: u32 = 1 << 15;
            for index in 0..PHOTONS {
                tracer.trace(&crate::raytrace::sampler::Sampler::new(seed, 0, index, 3), PHOTONS, &mut stored);
            }
            let visible = stored.iter().filter(|photon| surroundings.contains(photon.position));
            let flux: f64 = visible.map(|photon| f64::from(photon.flux.y * photon.direction.dot(photon.normal))).sum();
            sum += flux;
            squares += flux * flux;
        }
        let mean = sum / f64::from(PASSES);
        (mean, (squares / f64::from(PASSES) - mean * mean).sqrt() / f64::from(PASSES).sqrt())
    };
    let ((guided, guided_error), (uniform, error)) = (
        flux(CausticView::learn(&scene, &camera, 1 << 20, 0, &control)),
        flux(CausticView {
            starts: StartDensity::default(),
            ..CausticView::learn(&scene, &camera, 1 << 20, 0, &control)
        }),
    );
    assert!(uniform > 0.0 && error / uniform < 0.1, "{uniform} +- {error}");
    assert!(
        (guided - uniform).abs() < 5.0 * error.hypot(guided_error),
        "{guided} +- {guided_error}, {uniform} +- {error}"
    );
    assert!(guided_error < 0.6 * error, "{guided_error}, {error} unguided");
}

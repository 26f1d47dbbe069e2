//! Robustness: extreme scenes render finite values, the same for any number of threads, within the stated errors.
#![allow(clippy::unwrap_used)]

mod studio;

use catchlight::photo::Picture;
use catchlight::raytrace::{self, Method, RenderControl, Settings};
use catchlight::scene::{
    Aim, Assets, Camera, Emitter, Light, LightId, Material, Mesh, Object, ObjectId, Output, Room, Scene, Sensor, Shape,
    Transform,
};
use glam::{Vec2, Vec3};
use std::f64::consts::PI;
use std::ops::ControlFlow;
use std::sync::Arc;
use studio::light;
use studio::measure::{BIAS, film_with, illuminance, meter_card, picture, square, values};

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
    Material { transmission: 1.0, roughness: 0.0, ior: 1.5, ..Material::default() }
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
    let prepared = raytrace::prepare(scene, assets).unwrap();
    let settings = Settings { width: 45, height: 30, spp: 4, ..Settings::default() };
    let with = |threads: usize, method: Method| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
        let settings = Settings { method, ..settings.clone() };
        let film = pool.install(|| {
            raytrace::render(&prepared, &settings, &RenderControl::new(), &mut |_| ControlFlow::Continue(()))
        });
        assert_eq!(film.nonfinite().count, 0, "{method:?}: {:?}", film.nonfinite().first);
        film.develop(scene)
    };
    for method in [Method::Whitted, Method::Direct, Method::Path] {
        let picture = with(1, method);
        assert!(
            picture.rgb.iter().flatten().all(|v| v.is_finite() && *v >= 0.0),
            "{method:?} has a negative or non-finite pixel"
        );
        assert_eq!(picture, with(3, method), "{method:?} depends on the number of threads");
    }
    with(2, Method::Path)
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
fn a_closed_body_leaks_no_light_near_and_far_from_the_origin() {
    // A light inside a closed body: the outside is black at the origin, at 1 km and at 100 km.
    for far in [0.0_f32, 1e3, 1e5] {
        let at = Vec3::new(far, far, -far);
        for shape in [
            Shape::Sphere { radius_m: 0.5 },
            Shape::Box { size_m: Vec3::ONE },
            Shape::Cylinder { radius_m: 0.4, height_m: 1.0 },
        ] {
            let mut body = object_with_id(0, "Body", shape.clone(), at);
            body.transform.rotation_deg = Vec3::new(10.0, 20.0, 30.0);
            body.material = grey(0.8);
            let lamp = Light { aim: Aim::Point(at + Vec3::Z), ..light(Emitter::Point, Output::Lumens(1e6), at) };
            let camera = Camera {
                position: at + Vec3::Z * 3.0,
                aim: Aim::Point(at),
                focal_length_mm: 50.0,
                ..Camera::default()
            };
            let scene = Scene { objects: vec![body], lights: vec![lamp], camera, ..Scene::default() };
            let picture = picture(&scene, &square(Method::Path, 48, 16));
            assert_eq!(mean(&picture), 0.0, "{shape:?} at {at} leaks");
        }
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
fn softboxes_edge_on_facing_away_and_behind_a_card_do_not_light_it() {
    let panel = Emitter::RectPanel { width_m: 0.6, height_m: 0.9 };
    // Edge-on, facing away, behind the card, and edge-on in front of it.
    for (position, aim) in [
        (Vec3::new(1.0, 0.0, 0.0), Vec3::new(1.0, 1.0, 0.0)),
        (Vec3::Z, Vec3::Z * 2.0),
        (Vec3::NEG_Z, Vec3::ZERO),
        (Vec3::new(0.0, 0.0, 1.0), Vec3::new(1.0, 0.0, 1.0)),
    ] {
        let mut scene = meter_card(Vec3::ZERO, Vec3::Z);
        scene.lights.push(Light { aim: Aim::Point(aim), ..light(panel, Output::Lumens(1000.0), position) });
        // A panel that faces the card gives 267 lx. Half of the card's 0.4 mm is in front of the plane of an edge-on
        // panel.
        let reading = illuminance(&scene, &square(Method::Path, 4, 16)).mean;
        assert!(reading < 0.05, "from {position} to {aim}: {reading} lx");
    }
}

#[test]
fn a_panel_in_the_plane_of_a_wall_is_not_occluded_by_it() {
    // Neither light samples nor emitter hits are lost to the wall in the panel's plane.
    for (tilt, origin) in [(0.0_f32, Vec3::ZERO), (33.0, Vec3::ZERO), (33.0, Vec3::new(313.7, 11.3, -77.1))] {
        let (sin, cos) = tilt.to_radians().sin_cos();
        let towards = Vec3::new(sin, 0.0, cos);
        let mut free = meter_card(origin, towards);
        let panel = Emitter::RectPanel { width_m: 1.0, height_m: 1.0 };
        free.lights
            .push(Light { aim: Aim::Point(origin), ..light(panel, Output::Lumens(1000.0), origin + towards * 1.7) });
        let mut flush = free.clone();
        let mut wall = object_with_id(7, "Wall", Shape::Plane { width_m: 6.0, depth_m: 6.0 }, origin + towards * 1.7);
        wall.transform.set_rotation(glam::Quat::from_rotation_arc(Vec3::Y, -towards));
        wall.material = grey(0.0);
        flush.objects.push(wall);
        for method in [Method::Direct, Method::Path] {
            let (reference, ours) =
                (illuminance(&free, &square(method, 16, 64)), illuminance(&flush, &square(method, 16, 64)));
            assert!(
                (ours.mean / reference.mean - 1.0).abs() < 1e-3,
                "{method:?}, {tilt} degrees at {origin}: {ours:?} for {reference:?}"
            );
        }
    }
}

#[test]
fn a_light_on_the_ceiling_lights_the_room_and_one_above_it_does_not() {
    let room = Room { size_m: Vec3::new(4.0, 3.0, 4.0), floor: grey(0.5), walls: grey(0.5), ceiling: grey(0.5) };
    let reading = |emitter: Emitter, at: Vec3| {
        let mut scene = meter_card(Vec3::new(0.0, 1.5, 0.0), Vec3::Y);
        scene.room = Some(room.clone());
        scene.lights.push(Light { aim: Aim::Point(Vec3::Y), ..light(emitter, Output::Lumens(1000.0), at) });
        illuminance(&scene, &square(Method::Direct, 4, 16)).mean
    };
    let truth = 1000.0 / (4.0 * PI) / 1.5_f64.powi(2);
    assert!((reading(Emitter::Point, Vec3::Y * 3.0) / truth - 1.0).abs() < 1e-3);
    assert_eq!(reading(Emitter::Point, Vec3::Y * 3.001), 0.0, "a light a millimetre above the ceiling");
    assert_eq!(reading(Emitter::RectPanel { width_m: 0.5, height_m: 0.5 }, Vec3::Y * 3.001), 0.0);
}

#[test]
fn lights_inside_an_object_and_at_the_camera_are_robust() {
    let mut inside = base_scene();
    inside.lights[0].position = Vec3::Y * 0.3;
    inside.lights[0].emitter = Emitter::Point;
    inside.lights[0].aim = Aim::Point(Vec3::Y);
    assert_eq!(mean(&assert_robust(&inside, &Assets::default())), 0.0, "the light is inside of the sphere");
    for emitter in [
        Emitter::Point,
        Emitter::Sphere { radius_m: 0.05 },
        Emitter::RectPanel { width_m: 0.3, height_m: 0.3 },
        Emitter::RoundPanel { diameter_m: 0.3 },
        Emitter::Spot { inner_deg: 40.0, outer_deg: 60.0 },
    ] {
        // A ring flash: the light is at the lens, visible to the camera or not.
        for visible_to_camera in [false, true] {
            let mut scene = base_scene();
            scene.lights[0].position = scene.camera.position;
            scene.lights[0].emitter = emitter;
            scene.lights[0].visible_to_camera = visible_to_camera;
            let picture = assert_robust(&scene, &Assets::default());
            assert!(mean(&picture) > 0.0, "{emitter:?} at the camera gives no light");
        }
    }
}

#[test]
fn roughness_from_zero_to_one_is_robust() {
    for roughness in [0.0, 1e-4, 0.0316, 0.032, 0.1, 1.0] {
        for (metallic, transmission) in [(0.0, 0.0), (1.0, 0.0), (0.5, 0.5), (0.0, 1.0)] {
            let mut scene = base_scene();
            scene.objects[1].material = Material { metallic, transmission, ..metal(roughness) };
            assert_robust(&scene, &Assets::default());
        }
    }
    // Roughness 1e-4 is below the limit of a delta lobe.
    let mirror = |roughness| {
        let mut scene = base_scene();
        scene.objects[1].material = metal(roughness);
        picture(&scene, &square(Method::Path, 16, 8))
    };
    assert_eq!(mirror(0.0), mirror(1e-4));
}

#[test]
fn spots_with_equal_cones_and_hemispherical_cones_are_robust() {
    for (inner_deg, outer_deg) in [(30.0, 30.0), (180.0, 180.0), (0.0, 180.0), (0.0, 0.1), (0.1, 0.1), (179.9, 180.0)] {
        let mut scene = base_scene();
        scene.lights[0].emitter = Emitter::Spot { inner_deg, outer_deg };
        assert_robust(&scene, &Assets::default());
    }
}

fn model(mesh: Mesh, edit: impl Fn(&mut Scene)) -> (Scene, Assets) {
    let mut scene = base_scene();
    scene.objects[1].shape = Shape::MeshFile { path: "model.obj".into() };
    scene.objects[1].transform = Transform::default();
    edit(&mut scene);
    let mut assets = Assets::default();
    assets.insert_mesh("model.obj", Arc::new(mesh));
    (scene, assets)
}

#[test]
fn degenerate_triangles_and_normals_are_robust() {
    let corners = vec![
        Vec3::ZERO,
        Vec3::X,
        Vec3::Y,
        Vec3::X * 2.0,
        Vec3::ZERO,
        Vec3::new(1e-20, 0.0, 0.0),
        Vec3::new(0.5, 0.5, 1e-30),
    ];
    let triangles = vec![[0, 1, 2], [0, 1, 3], [0, 0, 0], [0, 4, 1], [5, 4, 0], [1, 1, 2], [0, 1, 6], [2, 1, 6]];
    let bare = Mesh { positions: corners.clone(), triangles: triangles.clone(), ..Mesh::default() };
    let zero_normals = Mesh { normals: vec![Vec3::ZERO; 7], uvs: vec![Vec2::NAN; 7], ..bare.clone() };
    let nothing = Mesh { positions: corners, triangles: vec![[0, 1, 3], [4, 4, 4]], ..Mesh::default() };
    for mesh in [bare, zero_normals, nothing, Mesh::default()] {
        let (scene, assets) = model(mesh.with_single_part("surface"), |_| {});
        assert_robust(&scene, &assets);
    }
}

#[test]
fn normals_opposite_to_the_winding_light_the_visible_side() {
    let quad = |normal: Vec3| Mesh {
        positions: vec![Vec3::ZERO, Vec3::X, Vec3::new(1.0, 1.0, 0.0), Vec3::Y],
        normals: vec![normal; 4],
        triangles: vec![[0, 1, 2], [0, 2, 3]],
        ..Mesh::default()
    };
    let view = |normal| {
        let (scene, assets) = model(quad(normal).with_single_part("surface"), |_| {});
        film_with(&scene, &assets, &square(Method::Direct, 16, 4)).develop(&scene)
    };
    // Reversed normals give the same picture; normals nearly in the plane keep the visible side lit.
    assert_eq!(view(Vec3::Z), view(Vec3::NEG_Z));
    assert!(mean(&view(Vec3::new(1.0, 0.0, -0.05).normalize())) > 0.0);
}

#[test]
fn scenes_without_light_are_black() {
    let mut off = base_scene();
    off.lights[0].on = false;
    let mut weak = base_scene();
    weak.lights[0].power.output = Output::Lumens(0.0);
    let none = Scene { lights: Vec::new(), ..base_scene() };
    for scene in [off, weak, none] {
        assert_eq!(mean(&assert_robust(&scene, &Assets::default())), 0.0);
    }
    // An empty scene.
    assert_robust(&Scene::default(), &Assets::default());
}

#[test]
fn lights_of_size_zero_are_rejected_by_name_and_the_smallest_are_right() {
    for emitter in [
        Emitter::Sphere { radius_m: 0.0 },
        Emitter::RectPanel { width_m: 0.0, height_m: 0.5 },
        Emitter::RoundPanel { diameter_m: 0.0 },
        Emitter::RectPanel { width_m: f32::NAN, height_m: 0.5 },
    ] {
        let mut scene = base_scene();
        scene.lights[0].emitter = emitter;
        let error = raytrace::prepare(&scene, &Assets::default()).unwrap_err().to_string();
        assert!(error.contains("emitter.") && error.contains("Light"), "{error}");
    }
    // The smallest allowed lights have the illuminance of point lights.
    for (emitter, per_axial) in [
        (Emitter::Sphere { radius_m: 1e-5 }, 4.0 * PI),
        (Emitter::RectPanel { width_m: 1e-5, height_m: 1e-5 }, PI),
        (Emitter::RoundPanel { diameter_m: 1e-5 }, PI),
        (Emitter::RectPanel { width_m: 1e-5, height_m: 1e-3 }, PI),
    ] {
        let mut scene = meter_card(Vec3::ZERO, Vec3::Z);
        scene.lights.push(light(emitter, Output::Lumens(1000.0), Vec3::Z * 2.0));
        let reading = illuminance(&scene, &square(Method::Path, 8, 16));
        assert!(reading.agrees_with(1000.0 / per_axial / 4.0, BIAS, 4), "{emitter:?}: {reading:?}");
    }
}

#[test]
fn lights_of_two_kilometres_light_like_a_uniform_hemisphere() {
    // Half a metre from a panel or a sphere of 2 km: E = pi L.
    for (emitter, position) in [
        (Emitter::RectPanel { width_m: 2000.0, height_m: 2000.0 }, Vec3::Z * 0.5),
        (Emitter::RoundPanel { diameter_m: 2000.0 }, Vec3::Z * 0.5),
        (Emitter::Sphere { radius_m: 1000.0 }, Vec3::Z * 1000.5),
    ] {
        let flux = 1e9_f32;
        let luminance = match emitter {
            Emitter::RectPanel { .. } => 1e9 / (PI * 4e6),
            Emitter::RoundPanel { .. } => 1e9 / (PI * PI * 1e6),
            _ => 1e9 / (4.0 * PI * PI * 1e6),
        };
        let mut scene = meter_card(Vec3::ZERO, Vec3::Z);
        scene.lights.push(light(emitter, Output::Lumens(flux), position));
        let reading = illuminance(&scene, &square(Method::Path, 16, 256));
        // The limb of the sphere is 0.05 % above the horizon.
        assert!(reading.agrees_with(PI * luminance, 2e-3, 3), "{emitter:?}: {reading:?} for {}", PI * luminance);
        assert!(reading.standard_error / reading.mean < 0.01, "{emitter:?}: {reading:?} is too noisy");
    }
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
fn paths_between_parallel_mirrors_end() {
    let mut scene = base_scene();
    let mirror = |id, z: f32, rotation_deg: f32| {
        let mut mirror = object_with_id(
            id,
            if id == 2 { "Front" } else { "Back" },
            Shape::Plane { width_m: 4.0, depth_m: 4.0 },
            Vec3::Z * z,
        );
        mirror.transform.rotation_deg = Vec3::X * rotation_deg;
        mirror.material = Material { base_color: [0.999; 3], ..metal(0.0) };
        mirror
    };
    scene.objects.extend([mirror(2, -2.0, 90.0), mirror(3, 4.0, -90.0)]);
    assert!(mean(&assert_robust(&scene, &Assets::default())) > 0.0);
}

#[test]
fn paths_through_nested_glass_end() {
    let mut scene = base_scene();
    scene.objects.truncate(1);
    for i in 0..20 {
        let mut shell = object_with_id(
            10 + i,
            &format!("Shell {i}"),
            Shape::Sphere { radius_m: 0.8 - 0.03 * i as f32 },
            Vec3::Y * 0.9,
        );
        shell.material = Material { ior: 1.0 + 0.1 * i as f32, absorption_per_m: [0.1; 3], ..glass() };
        scene.objects.push(shell);
    }
    assert!(mean(&assert_robust(&scene, &Assets::default())) > 0.0);
}

#[test]
fn mirrors_with_interpolated_normals_are_not_dark_at_the_rim() {
    // A coarse sphere, whose interpolated normals reflect rays below the surface at its rim. In a uniform surround, a
    // mirror has the value of the surround there, too.
    let mut coarse = Mesh::default();
    let (around, rows) = (10_u32, 6_u32);
    for row in 0..=rows {
        for column in 0..=around {
            let (latitude, azimuth) = (
                row as f32 / rows as f32 * std::f32::consts::PI,
                column as f32 / around as f32 * std::f32::consts::TAU,
            );
            let n = Vec3::new(latitude.sin() * azimuth.sin(), -latitude.cos(), latitude.sin() * azimuth.cos());
            coarse.positions.push(n * 0.5);
            coarse.normals.push(n);
        }
    }
    for row in 0..rows {
        for column in 0..around {
            let a = row * (around + 1) + column;
            coarse.triangles.extend([[a, a + 1, a + around + 2], [a, a + around + 2, a + around + 1]]);
        }
    }
    let mut scene = studio::ball_in_even_light(Material { base_color: [0.999; 3], ..metal(0.0) });
    scene.objects[0].shape = Shape::MeshFile { path: "ball.obj".into() };
    let mut assets = Assets::default();
    assets.insert_mesh("ball.obj", Arc::new(coarse.with_single_part("surface")));
    let ours =
        film_with(&scene, &assets, &Settings { max_depth: Some(64), ..square(Method::Path, 48, 16) }).develop(&scene);
    let surround = ours.at(0, 0)[1];
    let darkest = ours.rgb.iter().map(|p| p[1] / surround).fold(f32::INFINITY, f32::min);
    assert!(darkest > 0.99, "a pixel has {darkest} of the surround");
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

#[test]
fn many_lights_at_one_position_sum_up() {
    let mut scene = base_scene();
    let key = scene.lights[0].clone();
    for i in 1..40 {
        scene.lights.push(Light { id: LightId(i), name: format!("Light {i}"), ..key.clone() });
    }
    let one = mean(&picture(&base_scene(), &square(Method::Direct, 24, 64)));
    let many = mean(&picture(&scene, &square(Method::Direct, 24, 64)));
    // 36 864 samples each, with a standard deviation below the mean.
    assert!((many / one / 40.0 - 1.0).abs() < 0.02, "{many} for 40 times {one}");
}

#[test]
fn paper_on_the_floor_plane_hides_the_floor_without_z_fighting() {
    // Floor and paper are both at y = 0. From every side, near and far, only the paper is visible, uniformly lit.
    let paper = Shape::Sweep { width_m: 2.7, height_m: 2.0, depth_m: 3.0, radius_m: 0.5 };
    let mut sweep = object_with_id(1, "Paper", paper, Vec3::new(0.0, 0.0, -1.5));
    sweep.material = grey(0.8);
    let mut scene = Scene { room: Some(Room::default()), objects: vec![sweep], ..Scene::default() };
    scene.lights.push(light(Emitter::Point, Output::Lumens(8000.0), Vec3::new(0.0, 2.4, 0.4)));
    for position in [Vec3::new(1.9, 0.4, 0.9), Vec3::new(-1.7, 2.0, 1.8), Vec3::new(0.3, 0.2, 2.2)] {
        scene.camera = Camera { position, aim: Aim::Point(Vec3::Z * 0.4), focal_length_mm: 300.0, ..Camera::default() };
        let prepared = raytrace::prepare(&scene, &Assets::default()).unwrap();
        assert!(raytrace::primary_objects(&prepared, 60, 40).iter().all(|object| *object == 0), "from {position}");
        let picture =
            picture(&scene, &Settings { width: 60, height: 40, spp: 4, method: Method::Direct, ..Settings::default() });
        let (low, high) =
            picture.rgb.iter().fold((f32::MAX, 0.0_f32), |(low, high), p| (low.min(p[1]), high.max(p[1])));
        // Distance and cosine vary by less than this over the patch; a shadow of the floor would be black.
        assert!(low > 0.3 * high, "{low} to {high} from {position}");
    }
}

//! Bodies of lights: they leave the light of their own as it is, block that of others, and are seen as the studio says.

use crate::studio::measure::{film, picture, square, values};
use crate::studio::statistics::critical_z;
use crate::studio::{light, object};
use catchlight::photo::Picture;
use catchlight::photo::meter::Receptor;
use catchlight::raytrace::{
    self, GeometryCache, LightMeter, MeterEffort, MeterPoint, Method, RenderControl, Settings, is_up_to_date,
};
use catchlight::scene::{
    Aim, Assets, Bodies, BodyChoice, Camera, Emitter, Light, LightId, MaterialPreset, NamedModifier, Output, Scene,
    Sensor, Shape,
};
use glam::Vec3;
use std::ops::ControlFlow;

/// Returns a light with a named modifier that points at the origin.
fn named(name: &str, position: Vec3) -> Light {
    let named = NamedModifier::named(name).unwrap();
    Light { modifier: named.modifier, ..light(named.emitter, Output::Lumens(1000.0), position) }
}

/// Returns the direct and the bounced illuminance of each light at a point, with as many samples each time.
fn lux(scene: &Scene, position: Vec3, facing: Vec3) -> Vec<(f32, f32)> {
    let meter = LightMeter::new(scene, &Assets::default(), position).unwrap();
    let effort = MeterEffort { paths: Some(4096), ..MeterEffort::default() };
    let point = MeterPoint { position, facing: facing.normalize(), receptor: Receptor::Flat };
    let result = meter.read(&point, &effort, &RenderControl::new()).unwrap();
    assert_eq!(result.nonfinite.count, 0);
    result.reading.lights.iter().map(|light| (light.direct, light.bounced)).collect()
}

#[test]
fn every_modifier_reads_the_same_with_its_body_to_the_bit() {
    for modifier in &NamedModifier::ALL {
        let place = Vec3::new(0.6, 1.4, 1.1);
        let mut scene = Scene { lights: vec![named(modifier.name, place)], ..Scene::default() };
        // On the axis, aside, close before the front, under it beside the stand, and behind
        let axis = -place.normalize();
        let on_axis = lux(&scene, Vec3::ZERO, place)[0].0;
        for at in
            [Vec3::ZERO, Vec3::new(0.9, 0.2, -0.4), place + axis * 0.12, Vec3::new(0.6, 0.0, 1.0), place - axis * 2.0]
        {
            scene.bodies = Bodies::Off;
            let without = lux(&scene, at, place - at);
            for bodies in [Bodies::On, Bodies::InReflections] {
                scene.bodies = bodies;
                let with = lux(&scene, at, place - at);
                assert_eq!(with[0].0, without[0].0, "{} at {at}", modifier.name);
                assert_eq!(without[0].1, 0.0);
                // Its own head, stand and ribs throw some of it back; most the head that a bare bulb sits on
                let most = if at == Vec3::ZERO { 0.1 * on_axis } else { f32::INFINITY };
                assert!(with[0].1 <= most, "{} at {at}: {with:?}", modifier.name);
            }
        }
    }
}

#[test]
fn a_floor_under_each_kind_of_body_is_as_bright_as_without_it() {
    // Light that a path finds by chance, and light that it samples: on a floor that is nearly a mirror both count
    for name in ["Umbrella 105", "Shoot-through 105", "Octa 120, 40\u{b0} grid", "Bare bulb", "Scrim 120 x 180"] {
        for preset in [MaterialPreset::GreyCard, MaterialPreset::Gold] {
            let mut floor = object("Floor", Shape::Plane { width_m: 0.3, depth_m: 0.3 }, Vec3::ZERO);
            floor.material = preset.material();
            let camera = Camera {
                position: Vec3::new(-0.6, 1.4, -1.1) * 0.5,
                aim: Aim::Point(Vec3::ZERO),
                sensor: Sensor::Custom { width_mm: 24.0, height_mm: 24.0 },
                focal_length_mm: 200.0,
                ..Camera::default()
            };
            let lights = vec![named(name, Vec3::new(0.6, 1.4, 1.1))];
            let mut scene = Scene { objects: vec![floor], lights, camera, ..Scene::default() };
            let mut settings = Settings { seed: 3, ..square(Method::Direct, 32, 64) };
            let mut read = |bodies, seed| {
                (scene.bodies, settings.seed) = (bodies, seed);
                values(&picture(&scene, &settings))
            };
            let (without, with) = (read(Bodies::Off, 1), read(Bodies::InReflections, 2));
            let error = without.standard_error.hypot(with.standard_error);
            // With one bounce the body itself is in the floor's reflection, where no other light is
            let z = (with.mean - without.mean) / error.max(1e-5 * without.mean);
            assert!(z.abs() < critical_z(10), "{name} {preset:?}: {without:?} {with:?}");
        }
    }
}

#[test]
fn a_softbox_blocks_the_light_behind_it_and_none_without_a_body() {
    let mut lamp = light(Emitter::Point, Output::Lumens(1000.0), Vec3::new(0.0, 1.0, 3.0));
    (lamp.id, lamp.name) = (LightId(1), "Lamp".to_owned());
    // Off: its body stays where it is
    let softbox = Light { on: false, ..named("Softbox 60 x 90", Vec3::new(0.0, 0.5, 1.5)) };
    let mut scene = Scene { lights: vec![softbox, lamp], ..Scene::default() };
    let without = lux(&scene, Vec3::ZERO, Vec3::Z);
    assert!(without[0].0 > 7.0, "{without:?}");
    for bodies in [Bodies::On, Bodies::InReflections] {
        scene.bodies = bodies;
        assert_eq!(lux(&scene, Vec3::ZERO, Vec3::Z)[0].0, 0.0);
    }
    scene.lights[0].body = BodyChoice::Off;
    assert_eq!(lux(&scene, Vec3::ZERO, Vec3::Z)[0].0, without[0].0, "its own head throws some of it back");
    // The lamp is bare, and its own head is before it as seen from behind: it passes
    scene.lights[0].body = BodyChoice::On;
    scene.lights[1].aim = Aim::Point(Vec3::new(0.0, 1.0, 9.0));
    scene.lights[0].position.x = 5.0;
    assert!((lux(&scene, Vec3::ZERO, Vec3::Z)[0].0 / without[0].0 - 1.0).abs() < 1e-5);
}

/// A room of light: a softbox before it is a dark shape against the surround.
fn before_surround(softbox: Light, camera: Camera) -> Scene {
    let mut surround = light(Emitter::Surround, Output::Lux(1000.0), Vec3::ZERO);
    (surround.id, surround.aim, surround.visible_to_camera) = (LightId(7), Aim::Point(Vec3::NEG_Z), true);
    surround.name = "Surround".to_owned();
    Scene { lights: vec![softbox, surround], camera, ..Scene::default() }
}

fn camera(position: Vec3, aim: Vec3) -> Camera {
    Camera {
        position,
        aim: Aim::Point(aim),
        sensor: Sensor::Custom { width_mm: 24.0, height_mm: 24.0 },
        focal_length_mm: 50.0,
        ..Camera::default()
    }
}

fn centre(picture: &Picture) -> f32 {
    picture.at(picture.width / 2, picture.height / 2)[1]
}

#[test]
fn the_back_of_a_softbox_is_black_to_the_camera_and_in_chrome_and_the_camera_may_pass_it() {
    let softbox = Light { on: false, ..named("Softbox 90 x 120", Vec3::new(0.0, 1.5, 2.0)) };
    let settings = square(Method::Path, 16, 16);
    // The camera is behind it; between is nothing
    let mut direct = before_surround(softbox.clone(), camera(Vec3::new(0.0, 2.5, 5.5), Vec3::new(0.0, 1.5, 2.0)));
    let void = centre(&picture(&direct, &settings));
    direct.bodies = Bodies::On;
    assert!(centre(&picture(&direct, &settings)) < 0.2 * void);
    direct.bodies = Bodies::InReflections;
    assert_eq!(centre(&picture(&direct, &settings)), void, "camera rays pass it");

    // A chrome wall shows what is behind the camera's back
    let mut wall = object("Wall", Shape::Plane { width_m: 9.0, depth_m: 9.0 }, Vec3::new(0.0, 1.5, 7.0));
    wall.material = MaterialPreset::Chrome.material();
    wall.transform.rotation_deg = Vec3::new(-90.0, 0.0, 0.0);
    let mut mirrored = before_surround(softbox, camera(Vec3::new(0.0, 1.5, 5.0), Vec3::new(0.0, 1.5, 7.0)));
    mirrored.objects.push(wall);
    let chrome = centre(&picture(&mirrored, &settings));
    for bodies in [Bodies::On, Bodies::InReflections] {
        mirrored.bodies = bodies;
        let seen = centre(&picture(&mirrored, &settings));
        assert!(seen < 0.25 * chrome && chrome > 0.3 * void, "{bodies:?}: {seen} of {chrome}");
    }
}

#[test]
fn the_front_of_a_body_in_the_picture_is_as_bright_as_its_emitter() {
    let softbox = named("Softbox 60 x 90", Vec3::new(0.0, 1.0, 2.0));
    let mut scene = Scene { lights: vec![softbox], camera: camera(Vec3::ZERO, Vec3::Z), ..Scene::default() };
    scene.camera.aim = Aim::Point(scene.lights[0].position);
    let settings = square(Method::Path, 16, 16);
    assert_eq!(centre(&picture(&scene, &settings)), 0.0);
    scene.lights[0].visible_to_camera = true;
    let emitter = centre(&picture(&scene, &settings));
    (scene.lights[0].visible_to_camera, scene.bodies) = (false, Bodies::On);
    let body = centre(&picture(&scene, &settings));
    assert!(emitter > 0.0 && (body / emitter - 1.0).abs() < 1e-3, "{body} for {emitter}");
    // Its switch costs no ray: it is a layer before its front
    let lit = film(&scene, &settings);
    let mut dark = scene.clone();
    dark.lights[0].on = false;
    assert!(is_up_to_date(lit.layers(), &scene, &dark));
    assert_eq!(centre(&lit.develop(&dark)), 0.0);
    dark.lights[0].position.x += 0.1;
    assert!(!is_up_to_date(lit.layers(), &scene, &dark), "its body has moved");
}

#[test]
fn a_moved_body_is_traced_as_in_a_fresh_render() {
    let mut fill = named("Umbrella 105", Vec3::new(-1.2, 1.6, 1.0));
    (fill.id, fill.name) = (LightId(1), "Fill".to_owned());
    let lights = vec![named("Softbox 60 x 90", Vec3::new(1.0, 1.5, 1.0)), fill];
    let floor = object("Floor", Shape::Plane { width_m: 4.0, depth_m: 4.0 }, Vec3::ZERO);
    let camera = camera(Vec3::new(0.0, 2.0, 4.0), Vec3::ZERO);
    let mut scene = Scene { objects: vec![floor], lights, camera, bodies: Bodies::On, ..Scene::default() };
    let settings = square(Method::Path, 24, 4);
    let cache = GeometryCache::default();
    let render = |scene: &Scene| {
        let prepared = raytrace::prepare_kept(scene, &Assets::default(), &cache).unwrap();
        raytrace::render(&prepared, &settings, &RenderControl::new(), &mut |_| ControlFlow::Continue(())).develop(scene)
    };
    let before = render(&scene);
    let builds = cache.builds();
    scene.lights[0].position.z += 0.2;
    let moved = render(&scene);
    assert_ne!(before, moved);
    assert_eq!(moved, picture(&scene, &settings));
    // A stand of another height is another mesh at most
    assert!(cache.builds() - builds <= 1, "{} meshes", cache.builds() - builds);
}

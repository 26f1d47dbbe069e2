use super::*;
use crate::scene::{
    Aim, Assets, Camera, ColorSource, Emitter, Focus, Gel, Light, LightId, Object, ObjectId, Output, Room, Sensor,
    Shape, Solo, TextureRef,
};
use glam::Vec3;

fn object(name: &str) -> Object {
    Object::new(name, Shape::Box { size_m: Vec3::ONE })
}

fn light(name: &str) -> Light {
    let panel = Emitter::RectPanel { width_m: 0.6, height_m: 0.9 };
    let (name, position) = (name.to_owned(), Vec3::new(1.0, 2.0, 1.0));
    Light { name, position, aim: Aim::Point(Vec3::ZERO), ..Light::new(panel, Output::Lumens(1000.0)) }
}

fn valid_scene() -> Scene {
    let camera = Camera { aim: Aim::Point(Vec3::ZERO), ..Camera::default() };
    Scene { camera, objects: vec![object("Box")], lights: vec![light("Key")], ..Scene::default() }
}

/// Returns the one finding of a valid scene after an edit.
fn finding(edit: impl FnOnce(&mut Scene)) -> Finding {
    let mut scene = valid_scene();
    edit(&mut scene);
    let mut findings = validate(&scene);
    if findings.iter().all(|f| f.severity == Severity::Warning) {
        findings.extend(placement(&scene, &Assets::default()));
    }
    assert_eq!(findings.len(), 1, "{findings:#?}");
    findings[0].clone()
}

#[test]
fn a_good_scene_has_no_findings() {
    assert_eq!(validate(&valid_scene()), []);
    assert_eq!(placement(&valid_scene(), &Assets::default()), []);
}

#[test]
fn errors_name_the_field_and_the_value() {
    let found = finding(|s| s.lights[0].power.dial_stops = 400.0);
    assert_eq!(found.severity, Severity::Error);
    assert_eq!(
        found.to_string(),
        "lights[0] \"Key\" power.dial_stops: 400 stops is not allowed; it must be from -20 to 10 stops"
    );
    let found = finding(|s| s.objects[0].transform.position.y = f32::NAN);
    assert_eq!(
        found.to_string(),
        "objects[0] \"Box\" position: y NaN is no usable number; it must be from -1000000 to 1000000 m"
    );
}

#[test]
fn every_number_has_a_range() {
    type Edit = (&'static str, fn(&mut Scene));
    let cases: &[Edit] = &[
        ("camera.focal_length_mm", |s| s.camera.focal_length_mm = 0.0),
        ("camera.f_number", |s| s.camera.f_number = -8.0),
        ("camera.iso", |s| s.camera.iso = f32::INFINITY),
        ("camera.nd_stops", |s| s.camera.nd_stops = -1.0),
        ("camera.nd_stops", |s| s.camera.nd_stops = 31.0),
        ("camera.shutter_s", |s| s.camera.shutter_s = f32::NAN),
        ("camera.sensor.width_mm", |s| s.camera.sensor = Sensor::Custom { width_mm: -1.0, height_mm: 24.0 }),
        ("camera.focus", |s| s.camera.focus = Focus::OnObject { object: ObjectId(9), offset: Vec3::ZERO }),
        ("camera.focus[0]", |s| s.camera.focus = Focus::Distance(0.0)),
        ("room.size_m", |s| s.room = Some(Room { size_m: Vec3::new(9.0, -3.0, 9.0), ..Room::default() })),
        ("room.floor.roughness", |s| {
            let mut room = Room::default();
            room.floor.roughness = 1.5;
            s.room = Some(room);
        }),
        ("objects[0] \"Box\" shape.size_m", |s| s.objects[0].shape = Shape::Box { size_m: -Vec3::ONE }),
        ("objects[0] \"Box\" scale", |s| s.objects[0].transform.scale.x = 0.0),
        ("objects[0] \"Box\" material.base_color", |s| s.objects[0].material.base_color = [0.5, 1.0, 0.5]),
        ("objects[0] \"Box\" material.ior", |s| s.objects[0].material.ior = 0.9),
        ("objects[0] \"Box\" material.base_color_texture", |s| {
            s.objects[0].material.textures.base_color = Some(TextureRef::file("../secret.png"));
        }),
        ("lights[0] \"Key\" emitter.inner_deg", |s| {
            s.lights[0].emitter = Emitter::Spot { inner_deg: 50.0, outer_deg: 30.0 };
        }),
        ("lights[0] \"Key\" emitter.width_m", |s| {
            s.lights[0].emitter = Emitter::RectPanel { width_m: 0.0, height_m: 1.0 };
        }),
        ("lights[0] \"Key\" power.output[0]", |s| s.lights[0].power.output = Output::Lumens(-1.0)),
        ("lights[0] \"Key\" power.output", |s| s.lights[0].power.output = Output::Lux(100.0)),
        ("lights[0] \"Key\" power.output", |s| s.lights[0].emitter = Emitter::Surround),
        ("lights[0] \"Key\" color[0]", |s| s.lights[0].color.source = ColorSource::Kelvin(10.0)),
        ("lights[0] \"Key\" color", |s| s.lights[0].color.source = ColorSource::Rgb([0.0; 3])),
        ("lights[0] \"Key\" gel", |s| s.lights[0].color.gel = Gel::Tint([1.0, 2.0, 0.0])),
        ("lights[0] \"Key\" aim", |s| s.lights[0].aim = Aim::Point(s.lights[0].position)),
        ("lights[0] \"Key\" aim", |s| s.lights[0].aim = Aim::Object { object: ObjectId(7), offset: Vec3::ZERO }),
        ("lights[0] \"Key\" name", |s| s.lights[0].name = "Key".repeat(100)),
    ];
    for (place, edit) in cases {
        let mut scene = valid_scene();
        edit(&mut scene);
        let errors: Vec<Finding> = validate(&scene).into_iter().filter(|f| f.severity == Severity::Error).collect();
        assert_eq!(errors.len(), 1, "{place}: {errors:#?}");
        let found = errors[0].place.replace(&"Key".repeat(100), "Key");
        assert_eq!(&found, place, "{errors:#?}");
    }
}

#[test]
fn equal_names_of_an_object_and_a_light_clash() {
    assert!(finding(|s| s.lights[0].name = "Box".to_owned()).is_name_clash());
}

#[test]
fn unlikely_scenes_have_warnings() {
    type Edit = (&'static str, fn(&mut Scene));
    let cases: &[Edit] = &[
        ("there is no light", |s| s.lights.clear()),
        ("all lights are off", |s| s.lights[0].on = false),
        ("one light is silent", |s| {
            let alone = Light { id: LightId(1), name: "Alone".to_owned(), ..s.lights[0].clone() };
            s.solo = Some(Solo { lights: vec![alone.id], restores: vec![s.lights[0].id] });
            s.lights[0].on = false;
            s.lights.push(alone);
        }),
        ("gives 0", |s| s.lights[0].power.output = Output::Lumens(0.0)),
        ("looks past everything", |s| s.camera.aim = Aim::Point(Vec3::new(0.0, 1.5, 9.0))),
        ("nearer than a lens of 85 mm focuses", |s| {
            (s.camera.focus, s.camera.focus_breathing) = (Focus::Distance(0.05), true);
        }),
        ("is inside \"Box\"", |s| s.lights[0].position = Vec3::splat(0.2)),
        ("is outside the room", |s| {
            s.room = Some(Room::default());
            s.lights[0].position.x = 8.0;
        }),
    ];
    for (words, edit) in cases {
        let found = finding(edit);
        assert_eq!(found.severity, Severity::Warning);
        assert!(found.message.contains(words), "{found}");
    }
}

#[test]
fn a_camera_inside_an_object_has_a_warning() {
    let found = finding(|s| {
        s.camera.position = Vec3::splat(0.1);
        s.camera.aim = Aim::Point(Vec3::NEG_Z);
    });
    assert_eq!(found.place, "camera.position");
}

#[test]
fn too_long_lists_are_refused_before_their_items_are_checked() {
    let found = finding(|s| s.lights = vec![light("Key"); LIST_LIMIT + 1]);
    assert_eq!(found.message, "10001 are too many; at most 10000 fit in a scene");
}

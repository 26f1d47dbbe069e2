//! A soak of the open studio: random actions, undo and redo against a list of scenes that says what they should give.

use super::mutate::Random;
use super::{budget, first_seed};
use catchlight::editor::{Action, Document, Item, MirrorPlane};
use catchlight::io::{parse_scene, presets, write_scene};
use catchlight::scene::{Assets, Camera, Facing, Light, Meter, Object, Receptor, Role, Scene};
use glam::Vec3;
use std::time::Instant;

/// Actions on one studio; the history keeps 300.
const ACTIONS: usize = 200;

/// What studios are made of: the objects and lights of all shipped ones.
struct Parts {
    objects: Vec<Object>,
    lights: Vec<Light>,
    cameras: Vec<Camera>,
}

impl Parts {
    fn of_presets(scenes: &[Scene]) -> Self {
        Parts {
            objects: scenes.iter().flat_map(|scene| scene.objects.clone()).collect(),
            lights: scenes.iter().flat_map(|scene| scene.lights.clone()).collect(),
            cameras: scenes.iter().map(|scene| scene.camera.clone()).collect(),
        }
    }
}

/// Returns a number, now and then one that no studio may have.
fn number(random: &mut Random, low: f32, high: f32) -> f32 {
    match random.below(40) {
        0 => *random.pick(&[f32::NAN, f32::INFINITY, -f32::INFINITY, 1e30, -1e30, 0.0]),
        1 => low,
        2 => high,
        _ => low + (high - low) * (random.next() >> 40) as f32 / 16_777_216.0,
    }
}

fn vector(random: &mut Random, low: f32, high: f32) -> Vec3 {
    Vec3::new(number(random, low, high), number(random, low, high), number(random, low, high))
}

fn name(random: &mut Random) -> String {
    (*random.pick(&["Key", "Fill", "Man", "A \"quoted\" name", "", " ", "é\u{202e}\\", "Key 2", "x\ny"])).to_owned()
}

fn object(random: &mut Random, mut object: Object, parts: &Parts) -> Object {
    match random.below(7) {
        0 => object.transform.position = vector(random, -3.0, 3.0),
        1 => object.transform.rotation_deg = vector(random, -180.0, 180.0),
        2 => object.transform.scale = vector(random, 0.1, 3.0),
        3 => object.material = random.pick(&parts.objects).material.clone(),
        4 => object.shape = random.pick(&parts.objects).shape.clone(),
        5 => object.material.roughness = number(random, 0.0, 1.0),
        _ => object.visible = !object.visible,
    }
    object
}

fn light(random: &mut Random, mut light: Light, parts: &Parts) -> Light {
    let other = random.pick(&parts.lights);
    match random.below(9) {
        0 => light.position = vector(random, -3.0, 3.0),
        1 => light.power.dial_stops = number(random, -8.0, 8.0),
        2 => (light.emitter, light.power) = (other.emitter, other.power),
        3 => light.emitter = other.emitter,
        4 => light.modifier = other.modifier,
        5 => light.color = other.color,
        6 => light.roll_deg = number(random, -180.0, 180.0),
        7 => light.role = *random.pick(&Role::ALL),
        _ => light.on = !light.on,
    }
    light
}

fn camera(random: &mut Random, mut camera: Camera, parts: &Parts) -> Camera {
    match random.below(5) {
        0 => camera.position = vector(random, -4.0, 4.0),
        1 => camera.focal_length_mm = number(random, 10.0, 300.0),
        2 => camera.nd_stops = number(random, 0.0, 30.0),
        3 => camera.shutter_s = number(random, 1e-4, 2.0),
        _ => camera = random.pick(&parts.cameras).clone(),
    }
    camera
}

/// Returns some items, perhaps of none that exist.
fn items(random: &mut Random, scene: &Scene) -> Vec<Item> {
    let objects = scene.objects.iter().map(|object| Item::Object(object.id));
    let lights = scene.lights.iter().map(|light| Item::Light(light.id));
    let gone = [Item::Object(catchlight::scene::ObjectId(9999)), Item::Camera, Item::Room, Item::Meter];
    let all: Vec<Item> = objects.chain(lights).chain(gone).collect();
    (0..1 + random.below(3)).map(|_| *random.pick(&all)).collect()
}

fn action(random: &mut Random, scene: &Scene, parts: &Parts) -> Action {
    let light_ids: Vec<_> = scene.lights.iter().map(|light| light.id).filter(|_| random.below(2) == 0).collect();
    match random.below(20) {
        0 => Action::AddObject(Box::new(random.pick(&parts.objects).clone())),
        1 => Action::AddLight(Box::new(random.pick(&parts.lights).clone())),
        2..5 if !scene.objects.is_empty() => {
            let chosen = random.pick(&scene.objects).clone();
            Action::SetObject(Box::new(object(random, chosen, parts)))
        }
        5..9 if !scene.lights.is_empty() => {
            let chosen = random.pick(&scene.lights).clone();
            Action::SetLight(Box::new(light(random, chosen, parts)))
        }
        9 => Action::SetCamera(Box::new(camera(random, scene.camera.clone(), parts))),
        10 => Action::SetRoom(if random.below(2) == 0 { None } else { Some(Box::default()) }),
        11 => {
            let facing = Facing::Angles { yaw_deg: number(random, -180.0, 180.0), pitch_deg: 0.0 };
            let meter = Meter { position: vector(random, -2.0, 2.0), facing, receptor: Receptor::Dome };
            Action::SetMeter(Some(meter).filter(|_| random.below(3) > 0))
        }
        12 => Action::SetNotes { name: name(random), description: name(random) },
        13 => Action::Rename(items(random, scene)[0], name(random)),
        14 => Action::Delete(items(random, scene)),
        15 => Action::Duplicate(items(random, scene)),
        16 => {
            let plane = MirrorPlane { point: vector(random, -1.0, 1.0), normal: *random.pick(&[Vec3::X, Vec3::Z]) };
            Action::Mirror { items: items(random, scene), plane, copies: random.below(2) == 0 }
        }
        17 => Action::Mute(light_ids, random.below(2) == 0),
        18 => Action::Solo(light_ids),
        19 => Action::Lock(items(random, scene), random.below(2) == 0),
        _ => {
            let actions = (0..random.below(4)).map(|_| action(random, scene, parts)).collect();
            Action::Together { label: "Several".to_owned(), actions }
        }
    }
}

/// Checks that a studio reads as it was written.
fn assert_saves(scene: &Scene) {
    let written = write_scene(scene);
    let (read, _) = parse_scene(&written).unwrap_or_else(|error| panic!("{error}\n{written}"));
    assert_eq!(write_scene(&read), written);
}

/// Applies random actions to a studio. Returns the number of steps.
fn soak(seed: u64, first: &Scene, parts: &Parts) -> usize {
    let mut random = Random::new(seed);
    let mut document = Document::new(first.clone(), Assets::default(), None);
    // The scenes of the undo list, the current one, and those of the redo list.
    let (mut before, mut now, mut after): (Vec<Scene>, Scene, Vec<Scene>) = (Vec::new(), first.clone(), Vec::new());
    for step in 0..ACTIONS {
        match random.below(8) {
            0 => {
                assert_eq!(document.undo().is_some(), !before.is_empty());
                if let Some(scene) = before.pop() {
                    after.push(std::mem::replace(&mut now, scene));
                }
            }
            1 => {
                assert_eq!(document.redo().is_some(), !after.is_empty());
                if let Some(scene) = after.pop() {
                    before.push(std::mem::replace(&mut now, scene));
                }
            }
            _ => {
                let applied = document.apply(action(&mut random, &now, parts), None);
                if applied.is_ok() && *document.scene() != now {
                    before.push(std::mem::replace(&mut now, document.scene().clone()));
                    after.clear();
                }
            }
        }
        assert!(*document.scene() == now, "step {step}: undo, redo or a refused action has changed the studio");
        if step % 16 == 0 {
            assert_saves(&now);
        }
    }
    assert_saves(&now);
    let steps = before.len();
    assert_eq!(document.history().depth(), steps);
    while document.undo().is_some() {}
    assert!(document.scene() == first, "undo to the start does not give the first studio");
    assert!(!document.is_dirty());
    while document.redo().is_some() {}
    after
        .into_iter()
        .next()
        .map_or_else(|| assert!(*document.scene() == now), |last| assert!(*document.scene() == last));
    steps
}

/// Returns the memory of the process, bytes; 0 where the system does not tell.
fn memory() -> u64 {
    let status = std::fs::read_to_string("/proc/self/status").unwrap_or_default();
    let now = status.lines().find_map(|line| line.strip_prefix("VmRSS:"));
    now.and_then(|now| now.trim().split(' ').next()?.parse::<u64>().ok()).unwrap_or(0) * 1024
}

#[test]
fn random_actions_undo_to_the_first_studio_and_every_studio_saves_and_loads_alike() {
    let scenes: Vec<Scene> = presets().iter().map(|preset| preset.scene().unwrap()).collect();
    let parts = Parts::of_presets(&scenes);
    let (started, first_seed) = (Instant::now(), first_seed());
    let (mut studios, mut steps, mut warm) = (0, 0, 0);
    while started.elapsed() < budget() || studios == 0 {
        let seed = first_seed.wrapping_add(studios);
        let scene = &scenes[studios as usize % scenes.len()];
        steps += std::panic::catch_unwind(|| soak(seed, scene, &parts))
            .unwrap_or_else(|_| panic!("CATCHLIGHT_FUZZ_SEED={seed}: see above"));
        studios += 1;
        if studios == 200 {
            warm = memory();
        }
        // Other tests of the process take memory, too: this is about growth without end.
        assert!(
            warm == 0 || memory() < warm + 2_000_000_000,
            "{} bytes after {studios} studios, {warm} at first",
            memory()
        );
    }
    println!("soak: {studios} studios, {steps} steps, {} MB at the end, {} MB when warm", memory() >> 20, warm >> 20);
}

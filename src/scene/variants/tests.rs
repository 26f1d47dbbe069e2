use super::*;
use crate::scene::{
    BodyChoice, Camera, ColorSource, Emitter, Focus, Gel, Head, HeadDial, LightColor, LightId, Modifier, Object,
    ObjectId, Orientation, Output, Power, Role, Scene, Sensor, Shape,
};
use glam::Vec3;

fn light(id: u32, name: &str) -> Light {
    Light { id: LightId(id), name: name.to_owned(), ..Light::new(Emitter::Point, Output::Lumens(1000.0)) }
}

/// A studio with key, fill and two balls.
fn studio() -> Scene {
    let ball = |id, name: &str| Object { id: ObjectId(id), ..Object::new(name, Shape::Sphere { radius_m: 0.1 }) };
    Scene {
        lights: vec![light(0, "Key"), light(1, "Fill")],
        objects: vec![ball(0, "Ball"), ball(1, "Stand")],
        ..Scene::default()
    }
}

fn names(scene: &Scene) -> Vec<&str> {
    scene.lights.iter().map(|light| light.name.as_str()).collect()
}

/// A studio whose variant B has a dimmer key, no fill, a rim, a wider lens and no stand.
fn with_b() -> (Scene, VariantId, VariantId) {
    let mut scene = studio();
    let a = scene.variants.shown();
    let b = scene.add_variant("B".to_owned()).unwrap();
    scene.lights[0].power.dial_stops = -1.0;
    scene.lights.remove(1);
    scene.lights.push(light(scene.fresh_light_id().0, "Rim"));
    scene.camera.focal_length_mm = 50.0;
    scene.objects[1].visible = false;
    (scene, a, b)
}

#[test]
fn a_variant_differs_in_lights_camera_and_visibility_and_the_studio_stays() {
    let (mut scene, a, b) = with_b();
    let shown_b = scene.clone();
    assert!(scene.show_variant(a));
    assert_eq!(scene.without_variants(), studio());
    let difference = &scene.variants.others[0].difference;
    assert_eq!(difference.lights, [(LightId(0), LightDifference { dial_stops: Some(-1.0), ..Default::default() })]);
    assert_eq!((difference.removed_lights.as_slice(), difference.added_lights.len()), (&[LightId(1)][..], 1));
    assert_eq!(difference.camera, CameraDifference { focal_length_mm: Some(50.0), ..Default::default() });
    assert_eq!((difference.hidden.as_slice(), difference.visible.len()), (&[ObjectId(1)][..], 0));
    assert!(scene.show_variant(b));
    assert_eq!(scene.without_variants(), shown_b.without_variants());
    assert!(!scene.show_variant(VariantId(77)));
}

#[test]
fn what_the_studio_changes_shows_in_a_variant_that_does_not_differ_there() {
    let (mut scene, a, b) = with_b();
    scene.show_variant(a);
    scene.lights[0].position = Vec3::new(1.0, 2.0, 3.0);
    scene.lights[0].power.dial_stops = -3.0;
    scene.camera.iso = 400.0;
    scene.objects[0].transform.position.x = 2.0;
    scene.show_variant(b);
    assert_eq!(scene.lights[0].position, Vec3::new(1.0, 2.0, 3.0));
    assert_eq!(scene.lights[0].power.dial_stops, -1.0, "its own");
    assert_eq!((scene.camera.iso, scene.camera.focal_length_mm), (400.0, 50.0));
    assert_eq!(scene.objects[0].transform.position.x, 2.0);
}

#[test]
fn names_and_locks_of_lights_are_common_to_all_variants() {
    let (mut scene, a, b) = with_b();
    scene.lights[0].name = "Main".to_owned();
    scene.lights[0].locked = true;
    scene.show_variant(a);
    assert_eq!((names(&scene), scene.lights[0].locked), (vec!["Main", "Fill"], true));
    scene.show_variant(b);
    // A light of two variants is one light, too.
    let c = scene.add_variant("C".to_owned()).unwrap();
    scene.lights[1].name = "Kicker".to_owned();
    scene.show_variant(b);
    assert_eq!(names(&scene), ["Main", "Kicker"]);
    scene.show_variant(c);
    assert_eq!(names(&scene), ["Main", "Kicker"]);
}

#[test]
fn ids_and_names_are_unused_in_all_variants() {
    let (scene, ..) = with_b();
    assert_eq!(scene.fresh_light_id(), LightId(3), "fill is stored, the rim is shown");
    assert_eq!(scene.unique_name("Fill"), "Fill 2");
    assert_eq!(scene.light_of_any_variant(LightId(1)).map(|light| light.name.as_str()), Some("Fill"));
}

#[test]
fn a_variant_becomes_the_studio_and_the_others_stay_as_they_look() {
    let (mut scene, a, b) = with_b();
    scene.show_variant(a);
    let c = scene.add_variant("C".to_owned()).unwrap();
    scene.lights[1].on = false;
    let looks = |scene: &Scene, id| scene.as_variant(id).unwrap().without_variants();
    let before = [a, b, c].map(|id| looks(&scene, id));
    assert!(scene.make_studio(b));
    assert_eq!((scene.variants.studio_id, scene.variants.shown()), (b, b));
    let list: Vec<_> = scene.variants.list().map(|(id, name)| (id, name.to_owned())).collect();
    assert_eq!(list, [(b, "B".to_owned()), (a, "A".to_owned()), (c, "C".to_owned())]);
    let sorted = |mut scene: Scene| {
        scene.lights.sort_by_key(|light| light.id);
        scene
    };
    for (id, before) in [a, b, c].into_iter().zip(before) {
        assert_eq!(sorted(looks(&scene, id)), sorted(before), "{id:?}");
    }
}

#[test]
fn a_removed_variant_leaves_the_studio() {
    let (mut scene, a, b) = with_b();
    assert!(!scene.remove_variant(a), "the studio itself stays");
    assert!(scene.remove_variant(b));
    assert_eq!(scene, studio());
}

#[test]
fn variants_have_different_names() {
    let (mut scene, a, b) = with_b();
    assert_eq!(scene.variants.next_name(), "C");
    assert!(!scene.rename_variant(b, "A"));
    assert!(scene.rename_variant(a, "As built") && scene.rename_variant(b, "No fill"));
    assert_eq!(scene.variants.named("No fill"), Some(b));
    assert_eq!(scene.variants.next_name(), "A");
}

#[test]
fn the_solo_of_the_studio_waits_for_it_and_that_of_a_variant_ends() {
    let (mut scene, a, b) = with_b();
    let solo = |scene: &mut Scene, id| {
        let restores = scene.lights.iter().filter(|light| light.on).map(|light| light.id).collect();
        scene.solo = Some(crate::scene::Solo { lights: vec![id], restores });
        scene.lights.iter_mut().for_each(|light| light.on = light.id == id);
    };
    solo(&mut scene, LightId(2));
    scene.show_variant(a);
    assert_eq!(scene.solo, None);
    solo(&mut scene, LightId(0));
    let soloed = scene.clone();
    scene.show_variant(b);
    assert!(scene.solo.is_none() && scene.lights.iter().all(|light| light.on), "the switches of B are its own");
    scene.show_variant(a);
    assert_eq!(scene, soloed);
    // A variant is added without the solo
    scene.add_variant("C".to_owned()).unwrap();
    assert!(scene.solo.is_none() && scene.lights[1].on);
}

#[test]
fn a_variant_keeps_its_switches_while_the_studio_is_soloed() {
    let (mut scene, a, b) = with_b();
    scene.lights[0].on = false;
    scene.show_variant(a);
    scene.solo = Some(crate::scene::Solo { lights: vec![LightId(1)], restores: vec![LightId(0), LightId(1)] });
    scene.lights[0].on = false;
    scene.drop_equal_parts_of_variants();
    scene.show_variant(b);
    assert!(!scene.lights[0].on);
}

#[test]
fn showing_another_variant_and_returning_changes_nothing() {
    let (mut scene, a, b) = with_b();
    scene.show_variant(a);
    let difference = &mut scene.variants.others[0].difference;
    difference.hidden = vec![ObjectId(1), ObjectId(0), ObjectId(1)];
    difference.lights.push((LightId(9), LightDifference { on: Some(false), ..Default::default() }));
    difference.removed_lights.push(LightId(8));
    scene.lights[0].power.dial_stops = -1.0;
    scene.drop_equal_parts_of_variants();
    let difference = &scene.variants.others[0].difference;
    assert_eq!((difference.lights.len(), difference.hidden.len(), difference.removed_lights.len()), (0, 2, 1));
    let before = scene.clone();
    scene.show_variant(b);
    scene.show_variant(a);
    assert_eq!(scene, before);
    assert_eq!(scene.variant_alone(b), scene.as_variant(b).map(|scene| scene.without_variants()));
}

#[test]
fn every_field_of_light_and_camera_is_compared() {
    // Without `..`: a new field has to be listed here, and in the difference.
    let other = Light {
        id: LightId(0),
        name: "Key".to_owned(),
        locked: false,
        role: Role::Rim,
        body: BodyChoice::On,
        position: Vec3::X,
        aim: Aim::Point(Vec3::Y),
        roll_deg: 1.0,
        emitter: Emitter::Surround,
        photometric_file: Some("lamp.ies".to_owned()),
        environment_map: Some("sky.hdr".to_owned()),
        modifier: Modifier { loss_stops: 1.0, ..Modifier::default() },
        head: Some(Head {
            name: "Monolight".to_owned(),
            dial: HeadDial::UNKNOWN,
            sync_s: None,
            hss_loss_stops: None,
            t01_s: None,
        }),
        power: Power { output: Output::Lux(1.0), dial_stops: -1.0 },
        color: LightColor { source: ColorSource::Kelvin(3200.0), gel: Gel::Mired(1.0), gel_loss_counts: false },
        on: false,
        visible_to_camera: true,
        muted: true,
    };
    let key = light(0, "Key");
    let mut changed = key.clone();
    LightDifference::between(&key, &other).apply(&mut changed);
    assert_eq!(changed, other);
    assert!(LightDifference::between(&key, &key).is_empty());

    let other = Camera {
        position: Vec3::X,
        aim: Aim::Point(Vec3::Z),
        roll_deg: 1.0,
        sensor: Sensor::ApsC,
        orientation: Orientation::Portrait,
        focal_length_mm: 35.0,
        f_number: 2.0,
        shutter_s: 0.1,
        iso: 800.0,
        white_balance_k: 3200.0,
        nd_stops: 1.0,
        focus: Focus::Distance(1.0),
        depth_of_field: true,
        focus_breathing: true,
        meter_constant: 330.0,
    };
    let mut camera = Camera::default();
    CameraDifference::between(&Camera::default(), &other).apply(&mut camera);
    assert_eq!(camera, other);
}

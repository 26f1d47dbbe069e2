//! Bodies of lights in the preview: their outline, what a click on them selects, and their shadows.

use super::*;
use catchlight::scene::{Bodies, NamedModifier};

fn named(name: &str, position: Vec3, target: Vec3) -> Light {
    let named = NamedModifier::named(name).unwrap();
    let placed = light(0, position, target, named.emitter, Output::Lumens(2000.0));
    Light { modifier: named.modifier, ..placed }
}

/// A floor in the light of a bright surround, with a camera that looks at a body from the side.
fn studio(body: Light) -> Scene {
    let mut scene = floor_under(body);
    let mut surround = light(1, Vec3::ZERO, Vec3::NEG_Z, Emitter::Surround, Output::Lux(100.0));
    surround.visible_to_camera = true;
    scene.lights.push(surround);
    scene.camera.position = Vec3::new(2.6, 1.4, 3.2);
    scene.camera.aim = Aim::Point(Vec3::new(0.0, 1.1, 0.0));
    scene.camera.focal_length_mm = 35.0;
    scene
}

#[test]
fn a_body_has_the_outline_of_the_tracer_and_a_click_on_it_selects_its_light() {
    let Some(mut renderer) = shared_renderer() else { return };
    for name in ["Softbox 60 x 90", "Octa 120", "Umbrella 105", "Beauty dish 55", "Barn doors"] {
        let mut scene = studio(named(name, Vec3::new(0.0, 1.6, 0.0), Vec3::new(-1.0, 1.0, 0.6)));
        let size = (150, 100);
        // Outlines are where the picture differs from one without the body
        let preview = |renderer: &mut PreviewRenderer, scene: &Scene| {
            let options = Options { shadows: false, ..Options::direct_only() };
            let input = PreviewInput { options, ..direct(scene, size) };
            renderer.linear_picture(&input).unwrap()
        };
        let traced = |scene: &Scene| {
            let prepared = raytrace::prepare(scene, &Assets::default()).unwrap();
            raytrace::bodies_in_picture(&prepared, size.0, size.1)
        };
        let plain = preview(&mut renderer, &scene);
        assert!(traced(&scene).iter().all(Option::is_none));
        scene.bodies = Bodies::On;
        let with = preview(&mut renderer, &scene);
        let theirs = traced(&scene);
        let differs = |i: usize| plain.rgb[i] != with.rgb[i];
        let both = (0..theirs.len()).filter(|i| theirs[*i].is_some() && differs(*i)).count();
        let either = (0..theirs.len()).filter(|i| theirs[*i].is_some() || differs(*i)).count();
        // Legs and ribs are thinner than a pixel: nine of ten agree
        assert!(either > 100 && both as f32 > 0.9 * either as f32, "{name}: {both} of {either}");
        let hit = theirs.iter().position(Option::is_some).map(|i| (i as u32 % size.0, i as u32 / size.0)).unwrap();
        let picked = (0..3).find_map(|down| renderer.pick_blocking((hit.0, hit.1 + down)).unwrap());
        assert_eq!(picked, Some(Pick::Light(LightId(0))), "{name} at {hit:?}");
        scene.bodies = Bodies::InReflections;
        assert_eq!(preview(&mut renderer, &scene), plain, "{name} is hidden from the camera");
    }
}

#[test]
fn a_softbox_shades_what_is_behind_it_and_not_its_own_light() {
    let Some(mut renderer) = shared_renderer() else { return };
    let softbox = Light { on: false, ..named("Softbox 60 x 90", Vec3::new(0.0, 1.5, 0.0), Vec3::new(0.0, 0.0, 0.01)) };
    let mut lamp = light(1, Vec3::new(0.0, 4.0, 0.0), Vec3::ZERO, Emitter::Point, Output::Lumens(20_000.0));
    lamp.body = catchlight::scene::BodyChoice::Off;
    let mut scene = floor_under(lamp);
    scene.lights.insert(0, softbox);
    let mut centre = |scene: &Scene| renderer.linear_picture(&direct(scene, (96, 64))).unwrap().at(48, 32)[1];
    let without = centre(&scene);
    for bodies in [Bodies::InReflections, Bodies::Off] {
        scene.bodies = bodies;
        let expected = if bodies == Bodies::Off { without } else { 0.0 };
        let seen = centre(&scene);
        assert!((seen - expected).abs() <= 0.02 * without, "{bodies:?}: {seen} of {without}");
    }
    // Its own light passes it
    (scene.lights[0].on, scene.lights[1].on) = (true, false);
    let own = centre(&scene);
    scene.bodies = Bodies::InReflections;
    let with_body = centre(&scene);
    assert!(own > 0.0 && (with_body / own - 1.0).abs() < 0.01, "{with_body} for {own}");
}

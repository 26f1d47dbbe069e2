//! The number of shadow maps that are redrawn after a change.

use super::*;

/// Two spots side by side, each lighting its own box.
fn two_spots() -> Scene {
    let spot = Emitter::Spot { inner_deg: 20.0, outer_deg: 30.0 };
    let over =
        |id: u32, x: f32| light(id, Vec3::new(x, 3.0, 0.0), Vec3::new(x, 0.0, 0.0), spot, Output::Candela(3000.0));
    let mut scene = floor_under(over(0, -3.0));
    scene.lights.push(over(1, 3.0));
    for (id, x) in [(1, -3.0), (2, 3.0)] {
        let cube = Shape::Box { size_m: Vec3::splat(0.4) };
        scene.objects.push(object(id, cube, Vec3::new(x, 0.2, 0.0), grey_card()));
    }
    scene
}

/// Draws a picture and returns the number of shadow maps that it redrew.
fn redrawn(renderer: &mut PreviewRenderer, scene: &Scene) -> usize {
    renderer.render(&direct(scene, (60, 40))).unwrap();
    renderer.redrawn_shadow_maps()
}

#[test]
fn a_shadow_map_is_redrawn_only_for_changes_in_its_view() {
    let Some((_gpu, mut renderer)) = renderer() else { return };
    let mut scene = two_spots();
    assert_eq!(redrawn(&mut renderer, &scene), 2);
    assert_eq!(redrawn(&mut renderer, &scene), 0, "nothing has changed");
    scene.camera.position.x += 0.5;
    scene.lights[0].power.dial_stops = -1.0;
    scene.objects[1].material.base_color = [0.5, 0.1, 0.1];
    assert_eq!(redrawn(&mut renderer, &scene), 0, "camera, power and colour do not affect shadow maps");

    scene.objects[1].transform.position.x += 0.1;
    assert_eq!(redrawn(&mut renderer, &scene), 1, "a box under the first spot moves");
    scene.lights[1].position.y += 0.1;
    assert_eq!(redrawn(&mut renderer, &scene), 1, "the second spot moves");
    scene.objects[1].transform.position.x = 3.5;
    assert_eq!(redrawn(&mut renderer, &scene), 2, "a box moves from the first view to the second");
    scene.objects[1].transform.position.x = 3.4;
    assert_eq!(redrawn(&mut renderer, &scene), 1, "the box is outside of the first view");
}

#[test]
fn switching_a_light_off_and_on_keeps_its_shadow_map() {
    let Some((_gpu, mut renderer)) = renderer() else { return };
    let mut scene = two_spots();
    redrawn(&mut renderer, &scene);
    for on in [false, true] {
        scene.lights[0].on = on;
        let kept = renderer.picture(&direct(&scene, (60, 40))).unwrap();
        assert_eq!(renderer.redrawn_shadow_maps(), 0, "the first light is on: {on}");
        let (_, mut fresh) = self::renderer().unwrap();
        assert_eq!(kept, fresh.picture(&direct(&scene, (60, 40))).unwrap(), "the first light is on: {on}");
    }
}

#[test]
fn objects_outside_of_the_cull_radius_do_not_invalidate_a_shadow_map() {
    let Some((_gpu, mut renderer)) = renderer() else { return };
    let mut scene = two_spots();
    // f/4, 0.5 s, ISO 100: half a candela falls under 1/256 of display white within two metres.
    scene.lights = vec![light(0, Vec3::new(-3.0, 1.0, 0.0), Vec3::ZERO, Emitter::Point, Output::Candela(0.5))];
    assert_eq!(redrawn(&mut renderer, &scene), 6, "a cube map, because the floor surrounds the light");
    scene.objects[2].transform.position.x = 3.5;
    assert_eq!(redrawn(&mut renderer, &scene), 0, "a box far away");
    scene.objects[1].transform.position.x = -2.5;
    assert!((1..4).contains(&redrawn(&mut renderer, &scene)), "a box close by, below and to one side");
}

//! The room and surfaces that are coplanar with its floor.

use super::*;
use catchlight::preview::Channel;

/// A paper roll in a room under a point light; the camera is beside its front edge and looks along the floor.
fn paper_in_a_room() -> Scene {
    let paper = Shape::Sweep { width_m: 2.7, height_m: 2.6, depth_m: 3.4, radius_m: 0.6 };
    let bulb = light(0, Vec3::new(0.6, 2.4, 1.0), Vec3::ZERO, Emitter::Point, Output::Lumens(8000.0));
    Scene {
        room: Some(Room { floor: grey_card(), ..Room::default() }),
        camera: Camera {
            position: Vec3::new(2.0, 2.0, 4.2),
            aim: Aim::Point(Vec3::Z),
            focal_length_mm: 28.0,
            ..floor_under(bulb.clone()).camera
        },
        objects: vec![object(0, paper, Vec3::Z * -2.0, grey_card())],
        lights: vec![bulb],
        ..Scene::default()
    }
}

#[test]
fn a_floor_that_extends_under_the_camera_has_exact_depth() {
    let Some(mut renderer) = shared_renderer() else { return };
    let scene = paper_in_a_room();
    let size = (301, 201);
    let mut input = direct(&scene, size);
    input.options.channel = Channel::Depth;
    let picture = renderer.linear_picture(&input).unwrap();
    let mut compared = 0;
    for (x, y) in (0..size.1).flat_map(|y| (0..size.0).map(move |x| (x, y))) {
        let Some(floor) = floor_at(&input.frame, size, (x, y)) else { continue };
        // Keep away from the walls and the curve of the roll
        if floor.x.abs() < 3.3 && (-1.2..4.3).contains(&floor.z) {
            let depth = (floor - input.frame.position()).dot(input.frame.forward());
            // Half floats hold eleven bits.
            assert_close(picture.at(x, y)[0], depth, 1e-3, &format!("depth at {floor}"));
            compared += 1;
        }
    }
    assert!(compared > 20_000, "{compared} pixels of floor and paper");
}

#[test]
fn the_edge_of_paper_on_the_floor_casts_no_shadow() {
    let Some(mut renderer) = shared_renderer() else { return };
    let mut scene = paper_in_a_room();
    for position in [Vec3::new(2.0, 2.0, 4.2), Vec3::new(-2.6, 0.7, 2.4), Vec3::new(0.4, 1.3, 3.9)] {
        scene.camera.position = position;
        let size = (301, 201);
        let mut input = direct(&scene, size);
        let shadowed = renderer.linear_picture(&input).unwrap();
        let paper = renderer.object_mask().unwrap().objects;
        input.options.shadows = false;
        let open = renderer.linear_picture(&input).unwrap();
        let mut compared = 0;
        for (i, object) in (0..).zip(&paper) {
            let (x, y) = (i % size.0, i / size.0);
            let Some(floor) = floor_at(&input.frame, size, (x, y)) else { continue };
            // The flat part of the paper and the floor around it, outside of the roll's shadow
            if floor.x.abs() < 1.6 && (0.0..1.8).contains(&floor.z) {
                let inside = floor.x.abs() < 1.33 && floor.z < 1.38;
                assert!(object.is_some() || !inside, "the floor shows through the paper at {floor}");
                let [lit, all] = [&shadowed, &open].map(|p| color::luminance(p.at(x, y).into()));
                assert!(lit > 0.97 * all, "from {position}: {lit} of {all} at {floor}");
                compared += 1;
            }
        }
        assert!(compared > 2000, "{compared} pixels about the edge from {position}");
    }
}

//! Lights of extreme sizes and positions.

use super::{assert_robust, base_scene, grey, mean, object_with_id};
use crate::studio::light;
use crate::studio::measure::{BIAS, illuminance, meter_card, picture, square};
use catchlight::raytrace::{self, Method};
use catchlight::scene::{Aim, Assets, Emitter, Light, LightId, Output, Room, Scene, Shape};
use glam::Vec3;
use std::f64::consts::PI;

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
fn spots_with_equal_cones_and_hemispherical_cones_are_robust() {
    for (inner_deg, outer_deg) in [(30.0, 30.0), (180.0, 180.0), (0.0, 180.0), (0.0, 0.1), (0.1, 0.1), (179.9, 180.0)] {
        let mut scene = base_scene();
        scene.lights[0].emitter = Emitter::Spot { inner_deg, outer_deg };
        assert_robust(&scene, &Assets::default());
    }
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

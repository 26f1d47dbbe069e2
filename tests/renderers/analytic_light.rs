//! The illuminance of every emitter in rendered pictures against closed forms. Tolerances are multiples of the standard
//! error, which is estimated from the variance of the pixels. The tests of a family share a false-alarm rate of 1 in
//! 1000 (`studio::statistics`). `BIAS` is the error of the measuring card.

use crate::studio;
use crate::studio::closed_forms::{disc, polygon, vec3};
use crate::studio::light;
use crate::studio::measure::{BIAS, corners, film, illuminance, lux_per_value, meter_card, square, values};
use crate::studio::statistics::{SampleMean, TestRng};
use catchlight::raytrace::Method;
use catchlight::scene::{Aim, Emitter, Output, Scene, Shape};
use glam::{DVec3, Vec3};
use std::f64::consts::PI;

fn lit(emitter: Emitter, position: Vec3, aim: Vec3, receiver: Vec3, normal: Vec3) -> Scene {
    let mut scene = meter_card(receiver, normal);
    scene.lights.push(light(emitter, Output::Lumens(1000.0), position));
    scene.lights[0].aim = Aim::Point(aim);
    scene
}

fn check(reading: SampleMean, truth: f64, tests: usize, name: &str) {
    assert!(reading.agrees_with(truth, BIAS, tests), "{name}: {reading:?} for {truth} lx");
}

#[test]
fn random_panels_light_random_receivers_by_lamberts_polygon_formula() {
    // Random sizes, distances, rotations and receivers: also behind the panel, edge-on, and cut by the horizon.
    let mut rng = TestRng::new(41);
    let tests = 80;
    let (mut lit_count, mut dark_count) = (0, 0);
    for _ in 0..tests {
        let (width_m, height_m) = (rng.range(0.05, 2.0), rng.range(0.05, 2.0));
        let position = rng.direction() * rng.range(0.2, 4.0);
        let (aim, normal) = (position + rng.direction(), rng.direction());
        let mut scene = lit(Emitter::RectPanel { width_m, height_m }, position, aim, Vec3::ZERO, normal);
        scene.lights[0].roll_deg = rng.range(0.0, 360.0);
        let luminance = 1000.0 / (PI * f64::from(width_m * height_m));
        let front = (Vec3::ZERO - position).dot(aim - position) > 0.0;
        let outline = corners(&scene, 0, width_m, height_m);
        let truth = if front { polygon(&outline, luminance, DVec3::ZERO, vec3(normal)) } else { 0.0 };
        // The card has an extent: its illuminance varies where the panel's edge is on its horizon.
        let reading = illuminance(&scene, &square(Method::Direct, 8, 64));
        check(reading, truth, tests, &format!("{width_m} x {height_m} at {position} to {aim}, normal {normal}"));
        if truth > 0.0 { lit_count += 1 } else { dark_count += 1 }
    }
    assert!(lit_count > 15 && dark_count > 15, "{lit_count} lit and {dark_count} dark");
}

#[test]
fn random_discs_light_random_receivers_like_polygons_of_many_corners() {
    let mut rng = TestRng::new(42);
    let tests = 40;
    for _ in 0..tests {
        let diameter_m = rng.range(0.05, 2.0);
        let position = rng.direction() * rng.range(0.3, 4.0);
        // Panel and receiver roughly face each other, so that most are lit.
        let (aim, normal) = (rng.direction() * 0.5, (position + rng.direction()).normalize());
        let scene = lit(Emitter::RoundPanel { diameter_m }, position, aim, Vec3::ZERO, normal);
        let frame = scene.light_frame(&scene.lights[0]);
        let outline = disc(
            vec3(position),
            vec3(frame.matrix3.x_axis.into()),
            vec3(frame.matrix3.y_axis.into()),
            0.5 * f64::from(diameter_m),
        );
        let luminance = 1000.0 / (PI * PI * 0.25 * f64::from(diameter_m * diameter_m));
        let front = (-position).dot(aim - position) > 0.0;
        let truth = if front { polygon(&outline, luminance, DVec3::ZERO, vec3(normal)) } else { 0.0 };
        let reading = illuminance(&scene, &square(Method::Direct, 8, 128));
        check(reading, truth, tests, &format!("{diameter_m} m at {position} to {aim}, normal {normal}"));
    }
}

#[test]
fn panels_are_right_from_a_centimetre_to_two_hundred_metres() {
    // From a centimetre in front of a softbox, where it fills the half space, to 200 m; from 2 cm to 60 m.
    let cases = [
        (0.6, 0.9, 0.01),
        (0.6, 0.9, 0.1),
        (0.6, 0.9, 200.0),
        (0.02, 0.02, 0.5),
        (0.1, 0.1, 1.4),
        (0.1, 0.1, 1.6),
        (30.0, 60.0, 2.0),
        (0.3, 1.6, 0.05),
    ];
    for (width_m, height_m, distance) in cases {
        let scene = lit(Emitter::RectPanel { width_m, height_m }, Vec3::Z * distance, Vec3::ZERO, Vec3::ZERO, Vec3::Z);
        let luminance = 1000.0 / (PI * f64::from(width_m * height_m));
        let truth = polygon(&corners(&scene, 0, width_m, height_m), luminance, DVec3::ZERO, DVec3::Z);
        let reading = illuminance(&scene, &square(Method::Direct, 8, 256));
        check(reading, truth, cases.len(), &format!("{width_m} x {height_m} at {distance} m"));
    }
}

#[test]
fn panels_seen_almost_edge_on_are_right() {
    // A strip on the floor that faces along it, with receivers from 10 cm to 10 m in front; and a panel whose plane is
    // just above the receiver. At these angles, solid angles lose precision.
    let mut cases = Vec::new();
    for distance in [0.1, 0.5, 2.0, 10.0] {
        cases.push((Vec3::new(0.0, 0.15, -distance), Vec3::new(0.0, 0.15, 1.0), Vec3::Y, 1.6, 0.3));
    }
    for height in [1e-3, 1e-2, 3e-2] {
        // Facing down, slightly above the receiver's plane, beside it.
        cases.push((Vec3::new(0.9, height, 0.0), Vec3::new(0.9, -1.0, 0.0), Vec3::X, 0.6, 0.9));
        cases.push((Vec3::new(0.9, height, 0.2), Vec3::new(0.9, -1.0, 0.2), Vec3::new(0.8, 0.6, 0.0), 0.6, 0.9));
    }
    for (position, aim, normal, width_m, height_m) in &cases {
        let (width_m, height_m) = (*width_m, *height_m);
        let scene = lit(Emitter::RectPanel { width_m, height_m }, *position, *aim, Vec3::ZERO, *normal);
        let luminance = 1000.0 / (PI * f64::from(width_m * height_m));
        let truth = polygon(&corners(&scene, 0, width_m, height_m), luminance, DVec3::ZERO, vec3(*normal));
        let reading = illuminance(&scene, &square(Method::Direct, 16, 256));
        // A millimetre above the receiver's plane, the card's half width of 0.2 mm gives 1 %.
        assert!(
            reading.agrees_with(truth, 0.01, cases.len()),
            "at {position}, normal {normal}: {reading:?} for {truth} lx"
        );
        assert!(reading.standard_error < 0.05 * truth, "at {position}: {reading:?} is too noisy for {truth} lx");
    }
}

#[test]
fn spheres_above_the_horizon_light_receivers_like_point_lights() {
    let mut rng = TestRng::new(43);
    let tests = 30;
    for _ in 0..tests {
        let distance = rng.range(0.3, 6.0);
        let radius_m = distance * rng.range(1e-4, 0.6);
        let towards = rng.direction();
        // The whole sphere is above the receiver's horizon.
        let tilt = (radius_m / distance).acos().min(1.5) * rng.range(0.0, 0.95);
        let tangent = towards.any_orthonormal_vector();
        let normal = towards * tilt.cos() + tangent * tilt.sin();
        let scene = lit(Emitter::Sphere { radius_m }, towards * distance, Vec3::ZERO, Vec3::ZERO, normal.normalize());
        let d2 = f64::from(distance).powi(2);
        let truth = 1000.0 / (4.0 * PI * d2) * f64::from(normal.normalize().dot(towards));
        check(
            illuminance(&scene, &square(Method::Direct, 8, 64)),
            truth,
            tests,
            &format!("{radius_m} m at {distance} m"),
        );
    }
}

#[test]
fn a_sphere_half_below_the_horizon_gives_the_light_of_its_upper_half() {
    // The centre is on the receiver's horizon: E = L (a - sin a cos a) with the half angle a (Gershun 1936).
    for ratio in [0.1_f64, 0.5, 0.9] {
        let scene =
            lit(Emitter::Sphere { radius_m: 2.0 * ratio as f32 }, Vec3::X * 2.0, Vec3::ZERO, Vec3::ZERO, Vec3::Z);
        let luminance = 1000.0 / (4.0 * PI * PI * (2.0 * ratio).powi(2));
        let a = ratio.asin();
        check(
            illuminance(&scene, &square(Method::Direct, 8, 256)),
            luminance * (a - a.sin() * a.cos()),
            3,
            &format!("sine of the half-angle {ratio}"),
        );
    }
}

#[test]
fn the_inverse_square_law_holds_from_a_centimetre_to_a_kilometre() {
    for distance in [0.01_f32, 0.1, 1.0, 10.0, 100.0, 1000.0] {
        for emitter in [Emitter::Point, Emitter::Spot { inner_deg: 60.0, outer_deg: 60.0 }] {
            let scene = lit(emitter, Vec3::Z * distance, Vec3::ZERO, Vec3::ZERO, Vec3::Z);
            let per_steradian =
                if emitter == Emitter::Point { 4.0 * PI } else { 2.0 * PI * (1.0 - 30_f64.to_radians().cos()) };
            let truth = 1000.0 / per_steradian / f64::from(distance).powi(2);
            // At a centimetre the card's corners are 0.3 mm off the axis: (1 + r2/d2)^-2 is 0.2 % less.
            let bias = if distance < 0.05 { 2e-3 } else { BIAS };
            let reading = illuminance(&scene, &square(Method::Direct, 4, 4));
            assert!(reading.agrees_with(truth, bias, 12), "{emitter:?} at {distance} m: {reading:?} for {truth} lx");
        }
    }
}

#[test]
fn the_intensity_of_a_spot_is_linear_in_angle_between_its_cones() {
    // Full intensity up to 10 degrees off the axis, 0 beyond 35 degrees: I0 = F / (2 pi (1 - (sin b - sin a) / (b -
    // a))).
    let (a, b) = (10_f64.to_radians(), 35_f64.to_radians());
    let axial = 1000.0 / (2.0 * PI * (1.0 - (b.sin() - a.sin()) / (b - a)));
    for (off_axis_deg, fraction) in
        [(0.0, 1.0), (9.0, 1.0), (15.0, 0.8), (22.5, 0.5), (34.0, 0.04), (36.0, 0.0), (90.0, 0.0), (180.0, 0.0)]
    {
        let (sin, cos) = f64::to_radians(off_axis_deg).sin_cos();
        let receiver = Vec3::new(sin as f32, 0.0, -cos as f32) * 2.0;
        let emitter = Emitter::Spot { inner_deg: 20.0, outer_deg: 70.0 };
        let scene = lit(emitter, Vec3::ZERO, Vec3::NEG_Z, receiver, -receiver.normalize());
        let reading = illuminance(&scene, &square(Method::Direct, 4, 4));
        // Near the outer cone, rounding of the angle has more effect.
        assert!(reading.agrees_with(axial * fraction / 4.0, 1e-3, 8), "{off_axis_deg} degrees: {reading:?}");
    }
}

#[test]
fn equal_lumens_candela_and_lux_are_the_same_light() {
    // 1000 lm of a panel are 1000 / pi cd on its axis, and that intensity over 9 m2 in lx at 3 m.
    let axial = 1000.0 / std::f32::consts::PI;
    let panel = Emitter::RectPanel { width_m: 0.1, height_m: 0.1 };
    let readings =
        [Output::Lumens(1000.0), Output::Candela(axial), Output::LuxAt { lux: axial / 9.0, distance_m: 3.0 }].map(
            |output| {
                let mut scene = lit(panel, Vec3::Z * 2.0, Vec3::ZERO, Vec3::ZERO, Vec3::Z);
                scene.lights[0].power.output = output;
                illuminance(&scene, &square(Method::Direct, 4, 16)).mean
            },
        );
    // The samples are the same: only rounding differs.
    assert!(readings.iter().all(|r| (r / readings[0] - 1.0).abs() < 1e-5), "{readings:?}");
}

#[test]
fn the_falloff_to_a_backdrop_matches_the_table() {
    // light_and_camera.md: backdrop 1.5 m behind the subject, light 0.5, 1, 2, 3, 4 m in front of the subject.
    for (distance_m, stops) in [(0.5, -4.0), (1.0, -2.64), (2.0, -1.61), (3.0, -1.17), (4.0, -0.92)] {
        let at = |depth: f32| {
            let scene = lit(Emitter::Point, Vec3::Z * distance_m, Vec3::ZERO, Vec3::Z * -depth, Vec3::Z);
            illuminance(&scene, &square(Method::Direct, 4, 4)).mean
        };
        let ours = (at(1.5) / at(0.0)).log2();
        // The table has two decimals.
        assert!((ours - stops).abs() < 0.0051, "{distance_m} m: {ours} stops for {stops}");
    }
}

#[test]
fn a_surround_lights_a_tilted_card_by_its_visible_part() {
    // (1 + cos) / 2 of the surround is visible from a tilted card above a black floor.
    for tilt_deg in [0.0_f32, 45.0, 90.0, 135.0] {
        let (sin, cos) = tilt_deg.to_radians().sin_cos();
        let mut scene = meter_card(Vec3::Y * 0.5, Vec3::new(sin, cos, 0.0));
        let mut floor = studio::object("Floor", Shape::Plane { width_m: 4000.0, depth_m: 4000.0 }, Vec3::ZERO);
        floor.material.base_color = [0.0; 3];
        scene.objects.push(floor);
        scene.lights.push(light(Emitter::Surround, Output::Lux(1000.0), Vec3::ZERO));
        let truth = 1000.0 * 0.5 * (1.0 + f64::from(cos));
        check(illuminance(&scene, &square(Method::Path, 16, 64)), truth, 4, &format!("{tilt_deg} degrees"));
    }
}

#[test]
fn the_sun_follows_the_cosine_law_and_is_cut_by_the_horizon() {
    let sun = |angular_diameter_deg, elevation_deg: f32, tests| {
        let (sin, cos) = elevation_deg.to_radians().sin_cos();
        let mut scene = meter_card(Vec3::ZERO, Vec3::Y);
        scene.lights.push(light(
            Emitter::Sun { angular_diameter_deg },
            Output::Lux(80_000.0),
            Vec3::new(cos, sin, 0.0),
        ));
        (illuminance(&scene, &square(Method::Direct, 8, 256)), 80_000.0 * f64::from(sin), tests)
    };
    for (diameter, elevation) in [(0.0, 90.0), (0.0, 30.0), (0.53, 5.0), (20.0, 50.0)] {
        let (reading, truth, tests) = sun(diameter, elevation, 5);
        check(reading, truth, tests, &format!("{diameter} degrees wide, {elevation} degrees high"));
    }
    // Centre on the horizon: L (a - sin a cos a) for the luminance E / (pi sin2 a).
    let a = 10_f64.to_radians();
    let (reading, _, _) = sun(20.0, 0.0, 5);
    check(reading, 80_000.0 / (PI * a.sin().powi(2)) * (a - a.sin() * a.cos()), 5, "centre on the horizon");
}

#[test]
fn sampling_one_of_many_lights_gives_each_layer_its_own_light() {
    // 14 point lights and panels over a range of six stops, near and far, one of them behind the card: too many to
    // sample all at a hit, and few enough for a layer each. A wrong pmf would move light between layers.
    let (position, normal) = (Vec3::ZERO, Vec3::new(0.3, 0.9, 0.2).normalize());
    let mut scene = meter_card(position, normal);
    let mut rng = TestRng::new(77);
    let (width_m, height_m) = (0.4, 0.7);
    for i in 0..14 {
        let is_behind = i == 5;
        let from = rng.direction();
        let from = if (from.dot(normal) > 0.0) == is_behind { -from } else { from };
        let emitter = if i % 2 == 0 { Emitter::Point } else { Emitter::RectPanel { width_m, height_m } };
        let output = Output::Lumens(100.0 * 1.4_f32.powi(i));
        let id = catchlight::scene::LightId(i as u32);
        let position = from * rng.range(0.6, 4.0);
        scene.lights.push(catchlight::scene::Light {
            id,
            name: format!("Light {i}"),
            ..light(emitter, output, position)
        });
    }
    let film = film(&scene, &square(Method::Direct, 32, 256));
    for (i, light) in scene.lights.iter().enumerate() {
        let mut alone = scene.clone();
        alone.lights.iter_mut().enumerate().for_each(|(k, light)| light.on = k == i);
        let reading = values(&film.develop(&alone)).scaled(lux_per_value(&scene.camera));
        let flux = 100.0 * 1.4_f64.powi(i as i32);
        let truth = if i == 5 {
            0.0
        } else if let Emitter::RectPanel { .. } = light.emitter {
            let luminance = flux / (PI * f64::from(width_m * height_m));
            polygon(&corners(&scene, i, width_m, height_m), luminance, DVec3::ZERO, vec3(normal))
        } else {
            let to = vec3(light.position);
            flux / (4.0 * PI) * to.normalize().dot(vec3(normal)) / to.length_squared()
        };
        assert!(truth == 0.0 || reading.standard_error < 0.1 * truth, "light {i} is too noisy: {reading:?}");
        check(reading, truth, scene.lights.len(), &format!("light {i}"));
    }
}

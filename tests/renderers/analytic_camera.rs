//! Exposure, lens and shadows in rendered pictures against closed forms.

use crate::studio;
use crate::studio::light;
use crate::studio::measure::{film, illuminance, meter_card, picture, square, values};
use catchlight::photo::{Picture, exposure};
use catchlight::raytrace::{Method, Settings};
use catchlight::scene::{Aim, Camera, Emitter, Focus, Material, Object, Output, Scene, Sensor, Shape, Transform};
use glam::Vec3;
use std::f64::consts::PI;

fn rotated_object(name: &str, shape: Shape, position: Vec3, rotation_deg: Vec3) -> Object {
    let transform = Transform { position, rotation_deg, ..Transform::default() };
    Object { transform, ..studio::object(name, shape, position) }
}

#[test]
fn a_card_exposed_as_metered_has_the_value_018_for_continuous_light_flash_and_both() {
    // N2 = (E t + H) S / C, with E and H of a point light at 2 m.
    for (lumens, flash_ws) in [(20_000.0_f32, 0.0_f32), (0.0, 200.0), (20_000.0, 50.0)] {
        let mut scene = meter_card(Vec3::ZERO, Vec3::Z);
        let at_2_m = 1.0 / (4.0 * std::f32::consts::PI * 4.0);
        let mut lux_s = 0.0;
        if lumens > 0.0 {
            scene.lights.push(light(Emitter::Point, Output::Lumens(lumens), Vec3::Z * 2.0));
            lux_s += lumens * at_2_m * scene.camera.shutter_s;
        }
        if flash_ws > 0.0 {
            let output = Output::FlashWs { energy_ws: flash_ws, efficacy_lm_s_per_ws: 40.0 };
            let flash = light(Emitter::Point, output, Vec3::Z * 2.0);
            scene.lights.push(catchlight::scene::Light {
                id: catchlight::scene::LightId(1),
                name: "Flash".into(),
                ..flash
            });
            lux_s += flash_ws * 40.0 * at_2_m;
        }
        scene.camera.iso = 200.0;
        scene.camera.f_number = exposure::f_number(lux_s, 200.0, scene.camera.meter_constant);
        let value = values(&picture(&scene, &square(Method::Path, 8, 4))).mean;
        // The card is the only object: its 0.4 mm and single precision give less than 0.1 %.
        assert!((value / 0.18 - 1.0).abs() < 1e-3, "{lumens} lm and {flash_ws} Ws: {value}");
    }
}

#[test]
fn every_setting_changes_the_exposure_by_its_stops() {
    let mut scene = meter_card(Vec3::ZERO, Vec3::Z);
    scene.lights.push(light(Emitter::RectPanel { width_m: 0.6, height_m: 0.9 }, Output::Lumens(1000.0), Vec3::Z));
    let value = |scene: &Scene| values(&picture(scene, &square(Method::Path, 4, 16))).mean;
    let reference = value(&scene);
    type Change = fn(&mut Scene);
    let changes: [(&str, f64, Change); 10] = [
        ("power -1", -1.0, |s| s.lights[0].power.dial_stops = -1.0),
        ("power -1/10", -0.1, |s| s.lights[0].power.dial_stops = -0.1),
        ("power 1/256", -8.0, |s| s.lights[0].power.dial_stops = -8.0),
        ("shutter twice", 1.0, |s| s.camera.shutter_s *= 2.0),
        ("iso a third up", 1.0 / 3.0, |s| s.camera.iso *= 2_f32.powf(1.0 / 3.0)),
        ("a stop closed", -1.0, |s| s.camera.f_number *= 2_f32.sqrt()),
        ("ND8", -3.0, |s| s.camera.nd_stops = 3.0),
        ("a third of ND", -1.0 / 3.0, |s| s.camera.nd_stops = 1.0 / 3.0),
        ("ND of 6.6 stops", -6.6, |s| s.camera.nd_stops = 6.6),
        ("dome constant", -(340.0_f64 / 250.0).log2(), |s| s.camera.meter_constant = 340.0),
    ];
    for (name, stops, change) in changes {
        let mut changed = scene.clone();
        change(&mut changed);
        let ours = (value(&changed) / reference).log2();
        // The samples are the same: only rounding differs.
        assert!((ours - stops).abs() < 1e-5, "{name}: {ours} stops for {stops}");
    }
}

#[test]
fn ev_and_f_numbers_match_the_tables() {
    // light_and_camera.md: ISO 100, 1/125 s, in nominal labels; flash at f/8 is 160 lux s; EV100 = log2(100 E / C).
    for (lux, label) in [(1000.0, "f/1.8"), (2000.0, "f/2.5"), (5000.0, "f/4"), (10_000.0, "f/5.6")] {
        let n = exposure::f_number(lux / 125.0, 100.0, 250.0);
        let dial = catchlight::photo::thirds::Dial::FNumber;
        let nearest = dial.nominal_label(dial.thirds(n).round() as i32).unwrap();
        assert_eq!(format!("f/{nearest}"), label, "{lux} lx: {n}");
    }
    assert!((exposure::f_number(160.0, 100.0, 250.0) - 8.0).abs() < 1e-5);
    assert!((exposure::ev100(2.5, 250.0) - 0.0).abs() < 1e-6);
    assert!((exposure::ev100(81_920.0, 250.0) - 15.0).abs() < 1e-5);
}

/// Returns a view of 1 m of a perpendicular plane.
fn plane_view() -> Scene {
    let mut floor = rotated_object("Plane", Shape::Plane { width_m: 6.0, depth_m: 6.0 }, Vec3::ZERO, Vec3::X * 90.0);
    floor.material = Material { base_color: [0.5; 3], ior: 1.0, roughness: 1.0, ..Material::default() };
    let camera = Camera {
        position: Vec3::Z * 20.0,
        aim: Aim::Point(Vec3::ZERO),
        sensor: Sensor::Custom { width_mm: 24.0, height_mm: 24.0 },
        focal_length_mm: 480.0,
        ..Camera::default()
    };
    Scene { objects: vec![floor], camera, ..Scene::default() }
}

#[test]
fn the_width_of_a_penumbra_follows_from_source_size_and_distances() {
    // The penumbra of an edge at d1 from a panel of width D, on a plane d2 behind the edge, is D d2 / d1 wide. The
    // illuminance across it grows linearly for a square panel.
    for (source, d1, d2) in [(0.3_f32, 2.0_f32, 1.0_f32), (0.1, 1.0, 1.0), (0.4, 3.0, 0.5)] {
        let mut scene = plane_view();
        // Camera, light and blade are on one side; the blade covers x < 0 and occludes the dark half of the penumbra.
        scene.camera.position = Vec3::Z * -20.0;
        let blade = Shape::Plane { width_m: 4.0, depth_m: 8.0 };
        scene.objects.push(rotated_object("Blade", blade, Vec3::new(-2.0, 0.0, -d2), Vec3::X * 90.0));
        scene.objects[1].material.base_color = [0.0; 3];
        let panel = Emitter::RectPanel { width_m: source, height_m: source };
        scene.lights.push(light(panel, Output::Lumens(1e5), Vec3::Z * -(d1 + d2)));
        let settings = Settings { width: COLUMNS, height: 64, ..square(Method::Direct, 64, 16) };
        let occluded = column_sums(&picture(&scene, &settings));
        // Without the blade: the columns lit by the whole source.
        scene.objects[1].visible = false;
        let unoccluded = column_sums(&picture(&scene, &settings));
        let fractions: Vec<f64> = occluded.iter().zip(&unoccluded).map(|(o, u)| o / u).collect();
        let width = f64::from(source * d2 / d1);
        let ours = 1.0 / (bright_half_slope(&fractions) * f64::from(COLUMNS));
        // Columns of 4 mm in a penumbra of 7 to 15 cm, with 1024 samples each: an error of 3 %.
        assert!((ours / width - 1.0).abs() < 0.06, "D {source}, d1 {d1}, d2 {d2}: {ours} for {width} m");
    }
}

const COLUMNS: u32 = 256;

fn column_sums(picture: &Picture) -> Vec<f64> {
    let sum = |x: u32| (0..picture.height).map(|y| f64::from(picture.at(x, y)[1])).sum();
    (0..picture.width).map(sum).collect()
}

/// Returns the slope of the visible fraction of the source per column, by least squares over fractions from 0.6 to
/// 0.95.
fn bright_half_slope(fractions: &[f64]) -> f64 {
    let points: Vec<(f64, f64)> =
        fractions.iter().enumerate().filter(|(_, s)| (0.6..0.95).contains(*s)).map(|(x, s)| (x as f64, *s)).collect();
    let n = points.len() as f64;
    assert!(n > 4.0, "the penumbra is {n} columns wide");
    let (mx, my) = (points.iter().map(|p| p.0).sum::<f64>() / n, points.iter().map(|p| p.1).sum::<f64>() / n);
    let (xy, xx) =
        points.iter().fold((0.0, 0.0), |(xy, xx), p| (xy + (p.0 - mx) * (p.1 - my), xx + (p.0 - mx).powi(2)));
    (xy / xx).abs()
}

#[test]
fn the_blur_disc_of_a_small_light_follows_the_thin_lens_equation() {
    // Diameter of the blur in the plane of the light: A |s - f| / f, for an aperture A = focal length / N, focus f,
    // distance s.
    for (f_number, focus_m, distance_m) in [(1.4_f32, 2.0_f32, 4.0_f32), (2.8, 3.0, 1.5), (1.4, 1.0, 10.0)] {
        let focal_length_mm = 85.0;
        let camera = Camera {
            position: Vec3::ZERO,
            aim: Aim::Point(Vec3::NEG_Z),
            sensor: Sensor::Custom { width_mm: 6.0, height_mm: 6.0 },
            focal_length_mm,
            f_number,
            focus: Focus::Distance(focus_m),
            depth_of_field: true,
            ..Camera::default()
        };
        let width_m = distance_m * 6.0 / focal_length_mm;
        let blur_m = focal_length_mm * 1e-3 / f_number * (distance_m - focus_m).abs() / focus_m;
        let radius_m = 0.075 * blur_m;
        let mut bulb = light(Emitter::Sphere { radius_m }, Output::Lumens(1e4), Vec3::NEG_Z * distance_m);
        bulb.visible_to_camera = true;
        let scene = Scene { camera, lights: vec![bulb], ..Scene::default() };
        let side = 128;
        let ours = picture(&scene, &square(Method::Path, side, 128));
        // A uniform disc has a mean squared radius of half its squared radius; that of the light itself adds to it.
        let (mut sum, mut moment, mut mean) = (0.0, 0.0, [0.0; 2]);
        for y in 0..side {
            for x in 0..side {
                let value = f64::from(ours.at(x, y)[1]);
                let position = [x, y]
                    .map(|i| (f64::from(i) + 0.5) / f64::from(side) * f64::from(width_m) - 0.5 * f64::from(width_m));
                sum += value;
                moment += value * (position[0] * position[0] + position[1] * position[1]);
                (0..2).for_each(|k| mean[k] += value * position[k]);
            }
        }
        assert!(mean.iter().all(|m| (m / sum).abs() < 0.02 * f64::from(blur_m)), "the disc is off the axis");
        // Samples are spread uniformly over a pixel, whose moment is subtracted.
        let pixel = f64::from(width_m) / f64::from(side);
        let moment = moment / sum - pixel * pixel / 6.0 - 0.5 * f64::from(radius_m).powi(2);
        let ours_m = 2.0 * (2.0 * moment).sqrt();
        // Some 700 samples or more hit the light: 2 % for the root of the moment.
        assert!((ours_m / f64::from(blur_m) - 1.0).abs() < 0.05, "f/{f_number}: {ours_m} for {blur_m} m");
    }
}

#[test]
fn depth_of_field_does_not_change_the_exposure() {
    let mut scene = meter_card(Vec3::ZERO, Vec3::Z);
    scene.lights.push(light(Emitter::Point, Output::Lumens(1000.0), Vec3::Z * 2.0));
    scene.objects[0].shape = Shape::Plane { width_m: 0.5, depth_m: 0.5 };
    scene.camera.focal_length_mm = 50.0;
    scene.camera.f_number = 16.0;
    let pinhole = illuminance(&scene, &square(Method::Path, 8, 64));
    scene.camera.depth_of_field = true;
    scene.camera.focus = Focus::Distance(0.5);
    let blurred = illuminance(&scene, &square(Method::Path, 8, 64));
    // A uniformly lit card has the same value out of focus; 4 cm at 2 m from the light vary by 0.1 %.
    assert!((blurred.mean / pinhole.mean - 1.0).abs() < 2e-3, "{blurred:?} for {pinhole:?}");
    assert!((pinhole.mean / (1000.0 / (4.0 * PI) / 4.0) - 1.0).abs() < 2e-3, "{pinhole:?}");
}

#[test]
fn an_nd_filter_takes_its_stops_from_a_finished_picture() {
    // A finished picture is developed again: the values of whole stops are the same bits, halved.
    let mut scene = meter_card(Vec3::ZERO, Vec3::Z);
    scene.lights.push(light(Emitter::Point, Output::Lumens(1000.0), Vec3::Z * 2.0));
    let flash = Output::FlashWs { energy_ws: 50.0, efficacy_lm_s_per_ws: 40.0 };
    let flash = light(Emitter::Point, flash, Vec3::Z * 2.0);
    scene.lights.push(catchlight::scene::Light { id: catchlight::scene::LightId(1), name: "Flash".into(), ..flash });
    let finished = film(&scene, &square(Method::Path, 4, 16));
    let unfiltered = finished.develop(&scene);
    for stops in [1.0_f32, 3.0, 10.0] {
        scene.camera.nd_stops = stops;
        let filtered = finished.develop(&scene);
        let halved = unfiltered.rgb.iter().map(|p| p.map(|v| v * (-stops).exp2()));
        assert!(halved.eq(filtered.rgb.iter().copied()), "{stops} stops");
        // A render with the filter has the same samples.
        assert_eq!(picture(&scene, &square(Method::Path, 4, 16)).rgb, filtered.rgb, "{stops} stops");
    }
    scene.camera.nd_stops = 1.0 / 3.0;
    let third = finished.develop(&scene);
    let loss = (values(&unfiltered).mean / values(&third).mean).log2();
    assert!((loss - 1.0 / 3.0).abs() < 1e-6, "{loss}");
}

/// Returns a glowing square card in the plane of focus, which fills 0.6 of the sensor's height at magnification `m`, and
/// a camera that is focused on it.
fn glowing_card(focal_length_mm: f32, distance_m: f32, m: f32) -> Scene {
    let side_m = 0.6 * 24e-3 / m;
    let mut card =
        rotated_object("Card", Shape::Plane { width_m: side_m, depth_m: side_m }, Vec3::ZERO, Vec3::X * 90.0);
    card.material = Material { base_color: [0.0; 3], ior: 1.0, emission_cd_m2: [100.0; 3], ..Material::default() };
    let camera = Camera {
        position: Vec3::Z * distance_m,
        aim: Aim::Point(Vec3::ZERO),
        sensor: Sensor::Custom { width_mm: 24.0, height_mm: 24.0 },
        focal_length_mm,
        focus: Focus::Distance(distance_m),
        ..Camera::default()
    };
    Scene { objects: vec![card], camera, ..Scene::default() }
}

/// Returns the magnification in a picture of [`glowing_card`]: the side of its image over that of the card.
fn measured_magnification(picture: &Picture, m: f32) -> f64 {
    let middle = f64::from(picture.at(picture.width / 2, picture.height / 2)[1]);
    let covered: f64 = picture.rgb.iter().map(|p| f64::from(p[1]) / middle).sum();
    let sensor_per_pixel = 24e-3 / f64::from(picture.width);
    covered.sqrt() * sensor_per_pixel / (0.6 * 24e-3 / f64::from(m))
}

#[test]
fn the_magnification_in_the_plane_of_focus_is_that_of_a_thin_lens() {
    // m = f / (d - f) with focus breathing, f / d without: the lens is then as far from the sensor as for infinity.
    let lenses = [(35.0_f32, 0.25_f32), (50.0, 0.45), (85.0, 3.0), (100.0, 0.2), (100.0, 0.15), (180.0, 0.48)];
    for (focal_length_mm, d) in lenses {
        let f = focal_length_mm * 1e-3;
        for (focus_breathing, m) in [(true, f / (d - f)), (false, f / d)] {
            for depth_of_field in [false, true] {
                let mut scene = glowing_card(focal_length_mm, d, m);
                (scene.camera.focus_breathing, scene.camera.depth_of_field) = (focus_breathing, depth_of_field);
                let ours = measured_magnification(&picture(&scene, &square(Method::Path, 64, 64)), m);
                // Some 150 pixels on the edge of 1475 are covered in part, each to 1/8 by 64 samples: 0.1 % of the area.
                let what = format!("{focal_length_mm} mm at {d} m, breathing {focus_breathing}, blur {depth_of_field}");
                assert!((ours / f64::from(m) - 1.0).abs() < 2e-3, "{what}: {ours} for {m}");
            }
        }
    }
    // A macro lens of 100 mm at 0.2 m is at 1:1.
    let mut life_size = glowing_card(100.0, 0.2, 1.0);
    life_size.camera.focus_breathing = true;
    let ours = measured_magnification(&picture(&life_size, &square(Method::Path, 64, 64)), 1.0);
    assert!((ours - 1.0).abs() < 2e-3, "{ours}");
}

#[test]
fn near_focus_loses_the_bellows_factor_and_infinity_nothing() {
    // N_eff = N (1 + m): 2 log2(1 + m) stops, two at 1:1.
    for (focal_length_mm, d, stops) in [(100.0_f32, 0.2_f32, 2.0_f64), (100.0, 0.15, 3.16993), (85.0, 3.0, 0.08297)] {
        let f = focal_length_mm * 1e-3;
        let mut scene = glowing_card(focal_length_mm, d, f / d);
        let middle = |scene: &Scene| f64::from(picture(scene, &square(Method::Path, 9, 4)).at(4, 4)[1]);
        let at_infinity = middle(&scene);
        scene.camera.focus_breathing = true;
        let loss = (at_infinity / middle(&scene)).log2();
        assert!((loss - stops).abs() < 1e-4, "{focal_length_mm} mm at {d} m: {loss} stops for {stops}");
        // A finished picture of the lens without breathing keeps its exposure.
        let far = Camera { focus: Focus::Distance(1e5), ..scene.camera.clone() };
        let loss = (at_infinity / middle(&Scene { camera: far, ..scene.clone() })).log2();
        assert!(loss.abs() < 1e-4, "{loss} stops at infinity");
    }
}

#[test]
fn focus_changes_nothing_without_breathing_and_depth_of_field() {
    let mut scene = glowing_card(100.0, 0.2, 0.5);
    let near = picture(&scene, &square(Method::Path, 32, 4));
    scene.camera.focus = Focus::Distance(10.0);
    assert_eq!(picture(&scene, &square(Method::Path, 32, 4)), near);
}

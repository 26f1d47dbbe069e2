//! The light meter: readings against closed forms, and the exposure that the command proposes against a render.

use crate::studio;
use crate::studio::light;
use crate::studio::statistics::SampleMean;
use catchlight::photo::meter::Receptor;
use catchlight::raytrace::{LightMeter, MeterEffort, MeterPoint, MeterResult, Method, RenderControl, Settings};
use catchlight::scene::{
    Aim, Assets, Emitter, Light, LightId, Material, MaterialPreset, Object, Output, Role, Room, Scene, Shape,
};
use glam::Vec3;
use serde_json::Value;
use std::f32::consts::PI;
use std::path::Path;
use std::process::{Command, Output as ProcessOutput};

fn read(scene: &Scene, position: Vec3, facing: Vec3, receptor: Receptor) -> MeterResult {
    read_with(scene, position, facing, receptor, &MeterEffort::default())
}

fn read_with(scene: &Scene, position: Vec3, facing: Vec3, receptor: Receptor, effort: &MeterEffort) -> MeterResult {
    let meter = LightMeter::new(scene, &Assets::default(), position).unwrap();
    let result = meter.read(&MeterPoint { position, facing, receptor }, effort, &RenderControl::new()).unwrap();
    assert_eq!(result.nonfinite.count, 0);
    result
}

/// A meter at the origin that faces +Z, where the light comes from.
fn lux_of(emitter: Emitter, output: Output, position: Vec3, receptor: Receptor) -> f32 {
    let scene = Scene { lights: vec![light(emitter, output, position)], ..Scene::default() };
    read(&scene, Vec3::ZERO, Vec3::Z, receptor).reading.total_lux().0
}

#[test]
fn panels_match_lamberts_formula_from_a_centimetre_to_five_metres() {
    // The first round of 1024 points has an error of at most 0.05 % here.
    let (rect, round) = (Emitter::RectPanel { width_m: 0.6, height_m: 0.9 }, Emitter::RoundPanel { diameter_m: 1.2 });
    for d in [0.01_f32, 0.1, 0.5, 1.0, 2.0, 5.0] {
        let (a, b) = (0.3_f32, 0.45_f32);
        let (ha, hb) = (d.hypot(a), d.hypot(b));
        let luminance = 1000.0 / (PI * 4.0 * a * b);
        let lambert = 2.0 * luminance * (a / ha * (b / ha).atan() + b / hb * (a / hb).atan());
        let ours = lux_of(rect, Output::Lumens(1000.0), Vec3::Z * d, Receptor::Flat);
        assert!((ours / lambert - 1.0).abs() < 0.0015, "rectangle at {d} m: {ours} for {lambert}");
        let disc = 1000.0 / PI / (0.36 + d * d);
        let ours = lux_of(round, Output::Lumens(1000.0), Vec3::Z * d, Receptor::Flat);
        assert!((ours / disc - 1.0).abs() < 0.0015, "disc at {d} m: {ours} for {disc}");
    }
}

#[test]
fn a_lamp_a_millimetre_over_the_meter_is_read_by_the_inverse_square_law() {
    // A receptor that was lifted by 0.02 mm everywhere read 4 % too much. Coordinates are multiples of 2^-10 m. A meter
    // in the air, on a card of 1 cm, on a large floor, and on either away from the origin.
    let up = Vec3::Y;
    for at in [Vec3::ZERO, Vec3::new(1.25, 0.5, -3.75)] {
        for floor_m in [None, Some(0.01), Some(20.0)] {
            for distance_m in [0.000_976_562_5_f32, 0.007_812_5, 0.125] {
                let lamp = light(Emitter::Point, Output::Candela(1.0), at + up * distance_m);
                let floor = |size_m| studio::object("Floor", Shape::Plane { width_m: size_m, depth_m: size_m }, at);
                let objects = floor_m.map(floor).into_iter().collect();
                let scene = Scene { lights: vec![lamp], objects, ..Scene::default() };
                let lux = read(&scene, at, up, Receptor::Flat).reading.lights[0].direct;
                let error = lux * distance_m * distance_m - 1.0;
                assert!(error.abs() < 1e-4, "{distance_m} m over {floor_m:?} m at {at}: {error}");
            }
        }
    }
}

#[test]
fn a_dome_receives_half_of_a_light_at_its_side_and_nothing_from_behind() {
    for (degrees, flat, dome) in
        [(0.0_f32, 1.0, 1.0), (60.0, 0.5, 0.75), (90.0, 0.0, 0.5), (150.0, 0.0, 0.067), (180.0, 0.0, 0.0)]
    {
        let angle = degrees.to_radians();
        let from = Vec3::new(angle.sin(), 0.0, angle.cos()) * 2.0;
        let normal = 1000.0 / (4.0 * PI) / 4.0;
        for (receptor, share) in [(Receptor::Flat, flat), (Receptor::Dome, dome)] {
            // A delta light has no sampling error: only rounding is left.
            let ours = lux_of(Emitter::Point, Output::Lumens(1000.0), from, receptor) / normal;
            assert!((ours - share).abs() < 2e-4, "{receptor:?} at {degrees} degrees: {ours}");
        }
    }
}

#[test]
fn sun_and_surround_are_read_with_their_illuminance() {
    for angular_diameter_deg in [0.0, 0.53, 10.0] {
        let sun = Emitter::Sun { angular_diameter_deg };
        let ours = lux_of(sun, Output::Lux(5000.0), Vec3::Z, Receptor::Flat);
        assert!((ours / 5000.0 - 1.0).abs() < 5e-4, "{angular_diameter_deg}: {ours}");
    }
    // The response to a uniform sky integrates to pi for a flat receptor and to 2 pi for a dome, without sampling
    // error.
    for (receptor, lux) in [(Receptor::Flat, 2000.0), (Receptor::Dome, 4000.0)] {
        let ours = lux_of(Emitter::Surround, Output::Lux(2000.0), Vec3::Z, receptor);
        assert!((ours / lux - 1.0).abs() < 1e-4, "{receptor:?}: {ours}");
    }
}

/// A hollow ball of 2 m with a lamp at its centre: every point of its wall has the same illuminance.
fn hollow_ball(reflectance: f32) -> Scene {
    let mut ball: Object = studio::object("Ball", Shape::Sphere { radius_m: 2.0 }, Vec3::ZERO);
    ball.material = Material { base_color: [reflectance; 3], ior: 1.0, roughness: 1.0, ..Material::default() };
    let lamp = light(Emitter::Point, Output::Lumens(10_000.0), Vec3::ZERO);
    let mut scene = Scene { objects: vec![ball], lights: vec![lamp], ..Scene::default() };
    scene.lights[0].aim = Aim::Point(Vec3::Y);
    scene
}

#[test]
fn a_closed_ball_sums_the_geometric_series_of_bounces() {
    for reflectance in [0.0_f32, 0.2, 0.5, 0.8, 0.95] {
        let result = read(&hollow_ball(reflectance), Vec3::Y * -1.999, Vec3::Y, Receptor::Flat);
        let light = &result.reading.lights[0];
        let direct = 10_000.0 / (16.0 * PI);
        // The ball is a polyhedron, 0.1 % nearer on average; three standard errors of the reading.
        let allowed = 0.0015 + 3.0 * result.reading.relative_error().unwrap();
        assert!((light.direct / direct - 1.0).abs() < 0.0015, "r = {reflectance}: direct {}", light.direct);
        let expected = direct / (1.0 - reflectance);
        assert!((light.sum() / expected - 1.0).abs() < allowed, "r = {reflectance}: {} for {expected}", light.sum());
        assert!(result.reading.relative_error().unwrap() < 0.004, "the default effort is good to 0.4 %");
        assert_eq!(result.inside, Some(0), "the object around the meter is reported");
    }
}

#[test]
fn the_standard_error_matches_the_scatter_of_readings() {
    // Twenty readings with few paths each: their variance matches the claims, by chi-square with 19 degrees of freedom
    // (0.4 to 2.1 times the variance at a false alarm rate under 1 %; the error of the claims' mean is small).
    let scene = hollow_ball(0.8);
    let meter = LightMeter::new(&scene, &Assets::default(), Vec3::NEG_Y).unwrap();
    let point = MeterPoint { position: Vec3::Y * -1.999, facing: Vec3::Y, receptor: Receptor::Flat };
    let read = |seed| {
        let effort = MeterEffort { paths: Some(512), seed, ..MeterEffort::default() };
        let reading = meter.read(&point, &effort, &RenderControl::new()).unwrap().reading;
        (reading.lights[0].sum(), reading.lights[0].standard_error)
    };
    let readings: Vec<(f32, f32)> = (0..20).map(read).collect();
    let mean = readings.iter().map(|r| r.0).sum::<f32>() / 20.0;
    let variance = readings.iter().map(|r| (r.0 - mean).powi(2)).sum::<f32>() / 19.0;
    let claimed = readings.iter().map(|r| r.1 * r.1).sum::<f32>() / 20.0;
    let quotient = variance / claimed;
    assert!((0.35..2.3).contains(&quotient), "variance {variance}, claimed {claimed}");
}

#[test]
fn lights_are_read_separately_with_the_same_bits_for_any_number_of_threads() {
    let named = |id, role, output, x| {
        let name = format!("Light {id}");
        Light {
            id: LightId(id),
            name,
            role,
            ..light(Emitter::Sphere { radius_m: 0.1 }, output, Vec3::new(x, 1.0, 2.0))
        }
    };
    let mut scene = hollow_ball(0.3);
    scene.objects.clear();
    scene.objects.push(studio::object("Wall", Shape::Plane { width_m: 4.0, depth_m: 4.0 }, Vec3::Y * -0.5));
    // More lights than film layers: the meter still reads them separately.
    scene.lights = (0..20).map(|i| named(i, Role::Accent, Output::Lumens(10.0 + i as f32), i as f32 * 0.1)).collect();
    scene.lights.push(named(20, Role::Key, Output::FlashWs { energy_ws: 10.0, efficacy_lm_s_per_ws: 40.0 }, -1.0));
    scene.lights.push(Light { on: false, ..named(21, Role::Fill, Output::Lumens(1e6), 0.5) });
    scene.lights.push(named(22, Role::Fill, Output::Lumens(0.0), 0.5));
    let effort = MeterEffort { paths: Some(2048), ..MeterEffort::default() };
    let read = || read_with(&scene, Vec3::ZERO, Vec3::Y, Receptor::Dome, &effort);
    let all = read();
    let names: Vec<&str> = all.reading.lights.iter().map(|l| l.name.as_str()).collect();
    assert_eq!(names.len(), 22, "those that are on, the dark one included: {names:?}");
    assert_eq!(all.reading.lights[21].sum(), 0.0);
    let dark: Vec<_> = all.reading.lights[..21].iter().filter(|l| l.direct <= 0.0 || l.bounced <= 0.0).collect();
    assert!(dark.is_empty(), "{dark:?}");
    assert_eq!(all.reading.key().unwrap().name, "Light 20");
    // A light alone has the same reading.
    let mut alone = scene.clone();
    alone.lights = vec![scene.lights[7].clone()];
    let one = read_with(&alone, Vec3::ZERO, Vec3::Y, Receptor::Dome, &effort);
    let (ours, theirs) = (&all.reading.lights[7], &one.reading.lights[0]);
    assert!((ours.direct / theirs.direct - 1.0).abs() < 1e-3);
    // One light of 21 is sampled at each hit, 2048 paths: the bounced part has an error of some percent.
    let allowed = 4.0 * (ours.standard_error.powi(2) + theirs.standard_error.powi(2)).sqrt();
    assert!((ours.sum() - theirs.sum()).abs() < allowed, "{ours:?} {theirs:?}");
    let pool = rayon::ThreadPoolBuilder::new().num_threads(1).build().unwrap();
    assert_eq!(pool.install(read), all, "the same bits for one thread");
}

#[test]
fn an_object_in_the_light_casts_a_shadow_and_an_emissive_one_illuminates() {
    let mut scene = Scene::default();
    scene.lights.push(light(Emitter::RectPanel { width_m: 0.6, height_m: 0.9 }, Output::Lumens(1000.0), Vec3::Z * 2.0));
    let mut screen = studio::object("Screen", Shape::Box { size_m: Vec3::new(3.0, 3.0, 0.02) }, Vec3::Z);
    screen.material.base_color = [0.0; 3];
    screen.material.emission_cd_m2 = [50.0; 3];
    scene.objects.push(screen);
    let result = read(&scene, Vec3::ZERO, Vec3::Z, Receptor::Flat);
    let [panel, glow] = &result.reading.lights[..] else { unreachable!("a light and the glow") };
    assert_eq!(panel.sum(), 0.0);
    // Lambert over the middle of a square of half side a = 1.5 at h = 0.99.
    let (a, h) = (1.5_f32, 0.99_f32);
    let expected = 4.0 * 50.0 * a / a.hypot(h) * (a / a.hypot(h)).atan();
    assert!((glow.direct / expected - 1.0).abs() < 0.005 && glow.bounced.abs() < 1e-3, "{glow:?} for {expected}");
}

#[test]
fn an_object_in_the_sun_casts_a_shadow() {
    // Infinite distances once gave shadow rays a NaN end: suns shone through everything.
    for angular_diameter_deg in [0.0, 0.53] {
        let sun = light(Emitter::Sun { angular_diameter_deg }, Output::Lux(5000.0), Vec3::Z * 4.0);
        let flag = Shape::Box { size_m: Vec3::new(1.0, 1.0, 0.1) };
        let objects = vec![studio::object("Flag", flag, Vec3::Z)];
        let scene = Scene { lights: vec![sun], objects, ..Scene::default() };
        let direct = |point| read(&scene, point, Vec3::Z, Receptor::Flat).reading.lights[0].direct;
        assert_eq!(direct(Vec3::ZERO), 0.0, "{angular_diameter_deg}");
        assert!((direct(Vec3::X * 2.0) / 5000.0 - 1.0).abs() < 5e-4, "{angular_diameter_deg}");
    }
}

#[test]
fn a_meter_on_the_floor_is_precise_far_from_the_origin() {
    for far in [0.0, 1e3, 1e5] {
        let point = Vec3::new(far, 0.0, -far);
        let floor = studio::object("Floor", Shape::Plane { width_m: 10.0, depth_m: 10.0 }, point);
        let lamp = light(Emitter::Point, Output::Lumens(10_000.0), point + Vec3::Y * 3.0);
        let scene = Scene { objects: vec![floor], lights: vec![lamp], ..Scene::default() };
        let reading = read(&scene, point, Vec3::Y, Receptor::Flat).reading;
        // 88.42 lx of light_and_camera.md, to five digits: positions are relative to the meter, and
        // the lamp's is a whole number.
        assert!((reading.lights[0].direct / 88.42 - 1.0).abs() < 2e-4, "{far} m: {}", reading.lights[0].direct);
        assert_eq!(reading.lights[0].bounced, 0.0);
    }
}

#[test]
fn a_spot_with_fixed_angles_keeps_its_aim_a_million_metres_away() {
    // A cone of 20 degrees whose intensity falls linearly in angle from its axis: an error of the axis by 0.001 degrees
    // is 0.01 %. The light is far from the meter, or both are far from the origin, where coordinates have steps of 8 mm
    // and 6 cm; these here are representable.
    let emitter = Emitter::Spot { inner_deg: 0.0, outer_deg: 20.0 };
    for far_m in [0.0_f32, 1e5, 1e6] {
        for (name, meter_at, distance_m) in [
            ("both far away", Vec3::new(far_m, 0.5 * far_m, -far_m), 2.0),
            ("the light far away", Vec3::ZERO, far_m.max(2.0)),
        ] {
            for (yaw_deg, pitch_deg) in [(0.0_f32, 0.0_f32), (0.0, 3.7), (-5.3, 1.1), (2.2, -7.9), (9.0, 0.0)] {
                let mut spot = light(emitter, Output::Candela(1000.0), meter_at + Vec3::Z * distance_m);
                spot.aim = Aim::Angles { yaw_deg, pitch_deg };
                let scene = Scene { lights: vec![spot], ..Scene::default() };
                let lux = read(&scene, meter_at, Vec3::Z, Receptor::Flat).reading.total_lux().0;
                let [yaw, pitch] = [yaw_deg, pitch_deg].map(|angle| f64::from(angle).to_radians());
                let off_axis_deg = (yaw.cos() * pitch.cos()).acos().to_degrees();
                let expected = 1000.0 / f64::from(distance_m).powi(2) * (1.0 - off_axis_deg / 10.0);
                let error = f64::from(lux) / expected - 1.0;
                assert!(error.abs() < 1e-4, "{name}, {far_m} m, {yaw_deg} and {pitch_deg} degrees: {error}");
            }
        }
    }
}

fn catchlight(folder: &Path, arguments: &[&str]) -> ProcessOutput {
    Command::new(env!("CARGO_BIN_EXE_catchlight")).current_dir(folder).args(arguments).output().unwrap()
}

fn json(output: &ProcessOutput) -> Value {
    assert_eq!(output.status.code(), Some(0), "{}", String::from_utf8_lossy(&output.stderr));
    serde_json::from_slice(&output.stdout).unwrap()
}

#[test]
fn a_grey_card_at_the_metered_exposure_renders_to_its_value() {
    // Flash through a softbox, a continuous lamp, a slow shutter: the meter adds them, the camera takes its f-number.
    let mut scene = studio::card_at(Vec3::new(0.0, 1.2, 0.3), 0.2);
    scene.objects[0].material = MaterialPreset::GreyCard.material();
    scene.camera.shutter_s = 1.0 / 8.0;
    scene.camera.iso = 200.0;
    // The f-number makes up for an ND filter and for the bellows factor of a lens of 100 mm, 0.3 m from the card.
    (scene.camera.nd_stops, scene.camera.focus_breathing, scene.camera.focal_length_mm) = (2.0, true, 100.0);
    scene.camera.position = Vec3::new(0.06, 1.2, 0.594);
    scene.camera.sensor = catchlight::scene::Sensor::Custom { width_mm: 3.0, height_mm: 3.0 };
    let softbox = Emitter::RectPanel { width_m: 0.6, height_m: 0.9 };
    let flash = Output::FlashWs { energy_ws: 100.0, efficacy_lm_s_per_ws: 40.0 };
    let mut key = light(softbox, flash, Vec3::new(0.5, 1.6, 1.9));
    key.aim = Aim::Point(Vec3::new(0.0, 1.2, 0.3));
    let mut lamp = light(Emitter::Point, Output::Lumens(90_000.0), Vec3::new(-1.0, 1.0, 2.0));
    (lamp.id, lamp.name) = (LightId(1), "Lamp".into());
    scene.lights = vec![key, lamp];
    let folder = tempfile::tempdir().unwrap();
    std::fs::write(folder.path().join("card.ron"), catchlight::io::write_scene(&scene)).unwrap();
    let meter = ["meter", "card.ron", "--at", "0,1.2,0.3", "--facing", "0,0,1", "--json"];
    let reading = json(&catchlight(folder.path(), &meter));
    let n = reading["total"]["f_number"].as_f64().unwrap();
    let bellows_stops = reading["total"]["bellows_stops"].as_f64().unwrap();
    assert!((bellows_stops - 2.0 * (0.3_f64 / 0.2).log2()).abs() < 1e-3, "{bellows_stops}");
    assert_eq!(reading["total"]["nd_stops"].as_f64(), Some(2.0));
    let flash_percent = reading["flash_percent"].as_f64().unwrap();
    assert!((20.0..80.0).contains(&flash_percent), "both kinds of light count: {flash_percent} % flash");
    scene.camera.f_number = n as f32;
    std::fs::write(folder.path().join("card.ron"), catchlight::io::write_scene(&scene)).unwrap();
    let render = ["render", "card.ron", "-o", "card.exr", "--size", "16x16", "--spp", "256"];
    assert_eq!(catchlight(folder.path(), &render).status.code(), Some(0));
    let picture = exr::prelude::read_first_rgba_layer_from_file(
        folder.path().join("card.exr"),
        |size, _| vec![[0.0_f32; 3]; size.area()],
        |pixels: &mut Vec<[f32; 3]>, pixel, (r, g, b, _): (f32, f32, f32, f32)| {
            let index = pixel.y() * 16 + pixel.x();
            pixels[index] = [r, g, b];
        },
    );
    let pixels = picture.unwrap().layer_data.channel_data.pixels;
    let mean = pixels.iter().map(|p| f64::from(p[1])).sum::<f64>() / pixels.len() as f64;
    // 65536 samples of a smooth light; the frame is 6 mm of the card, lit evenly to 0.1 %.
    assert!((mean / 0.18 - 1.0).abs() < 0.005, "f/{n}: {mean}");
}

#[test]
fn the_json_report_has_the_documented_keys() {
    let folder = tempfile::tempdir().unwrap();
    let report =
        json(&catchlight(folder.path(), &["meter", "three_point", "--at", "-0.05,1.55,0.2", "--dome", "--json"]));
    assert_eq!(report["receptor"], "dome");
    assert_eq!(report["at"].as_array().unwrap().len(), 3);
    for key in ["direct_lux", "bounced_lux", "lux", "lux_s", "ev100", "f_number"] {
        assert!(report["total"][key].is_number(), "total lacks {key}: {report}");
    }
    let lights = report["lights"].as_array().unwrap();
    assert_eq!(lights.len(), 4);
    for light in lights {
        for key in ["name", "direct_lux", "bounced_lux", "lux", "lux_s", "share_stops"] {
            assert!(!light[key].is_null(), "a light lacks {key}: {light}");
        }
    }
    let sum: f64 = lights.iter().map(|l| l["lux_s"].as_f64().unwrap()).sum();
    assert!((sum / report["total"]["lux_s"].as_f64().unwrap() - 1.0).abs() < 1e-5);
    assert_eq!(lights[0]["share_stops"].as_f64(), Some(0.0), "the key is the measure");
    let table = catchlight(folder.path(), &["meter", "three_point", "--at", "0,1.55,0.2", "--spp", "256"]);
    let table = String::from_utf8(table.stdout).unwrap();
    for word in ["Key softbox", "facing the camera", "f/", "key:fill", "EV100", "flash 100.0 %", "fc", "stops"] {
        assert!(table.contains(word), "no {word} in\n{table}");
    }
}

#[test]
fn wrong_positions_are_errors_with_a_reason_and_odd_ones_are_warnings() {
    let folder = tempfile::tempdir().unwrap();
    for (arguments, reason) in [
        (vec!["--at", "NaN,0,0"], "NaN"),
        (vec!["--at", "1,2"], "X,Y,Z"),
        (vec!["--at", "1e30,0,0"], "1000 km"),
        (vec!["--at", "0,1,0", "--facing", "0,0,0"], "direction"),
        (vec!["--at", "0,1.55,1.85"], "--facing"),
        (vec!["--at", "0,1,0", "--spp", "0"], "0"),
        (vec![], "--at"),
    ] {
        let arguments = [vec!["meter", "three_point"], arguments].concat();
        let output = catchlight(folder.path(), &arguments);
        let complaint = String::from_utf8_lossy(&output.stderr).into_owned();
        assert_eq!(output.status.code(), Some(1), "{arguments:?}: {complaint}");
        assert!(complaint.contains(reason) && output.stdout.is_empty(), "{arguments:?}: {complaint}");
    }
    let mut metered = Scene::default();
    metered.lights.push(light(Emitter::Point, Output::Lumens(1000.0), Vec3::Y * 3.0));
    metered.meter = Some(catchlight::scene::Meter {
        position: Vec3::Y,
        facing: catchlight::scene::Facing::Angles { yaw_deg: 0.0, pitch_deg: 90.0 },
        receptor: Receptor::Flat,
    });
    std::fs::write(folder.path().join("own.ron"), catchlight::io::write_scene(&metered)).unwrap();
    let own = json(&catchlight(folder.path(), &["meter", "own.ron", "--json"]));
    let expected = 1000.0 / (4.0 * f64::from(PI)) / 4.0;
    assert!((own["total"]["lux"].as_f64().unwrap() / expected - 1.0).abs() < 1e-3, "the studio's own meter: {own}");
    for (at, told) in [("0,0.9,0", "inside of \"Woman\""), ("0,9,0", "outside of the room")] {
        let output = catchlight(folder.path(), &["meter", "three_point", "--at", at, "--spp", "16", "--json"]);
        let report = json(&output);
        let complaint = String::from_utf8_lossy(&output.stderr).into_owned();
        assert!(complaint.contains(told), "{at}: {complaint}");
        // Darkness has no exposure value.
        assert!(report["total"]["ev100"].is_null() || report["total"]["lux"].as_f64().unwrap() > 0.0);
    }
}

#[test]
fn a_closed_room_reads_direct_plus_bounced_light() {
    let paint = Material { base_color: [0.5; 3], ior: 1.0, roughness: 1.0, ..Material::default() };
    let room = Room { size_m: Vec3::splat(4.0), floor: paint.clone(), walls: paint.clone(), ceiling: paint };
    let lamp = light(Emitter::Point, Output::Lumens(10_000.0), Vec3::new(0.0, 2.0, 0.0));
    let mut scene = Scene { room: Some(room), lights: vec![lamp], ..Scene::default() };
    scene.lights[0].aim = Aim::Point(Vec3::Y);
    // Mean over a wall by a 4 x 4 grid: by symmetry that of all walls, F / (S (1 - r)).
    let meter = LightMeter::new(&scene, &Assets::default(), Vec3::ZERO).unwrap();
    let (mut sum, n) = (0.0, 8);
    for i in 0..n * n {
        let at = |k: i32| (k as f32 + 0.5) / n as f32 * 4.0 - 2.0;
        let point =
            MeterPoint { position: Vec3::new(at(i % n), 0.0, at(i / n)), facing: Vec3::Y, receptor: Receptor::Flat };
        // A seed per point, so that their errors are independent.
        let effort = MeterEffort { paths: Some(1024), seed: i as u32, ..MeterEffort::default() };
        sum += meter.read(&point, &effort, &RenderControl::new()).unwrap().reading.total_lux_s() * 125.0;
    }
    let mean = sum / (n * n) as f32;
    // 208.33 lx by light_and_camera.md. The grid has an error of 0.2 % at the lamp's peak, 64 x 1024 paths one of 0.1
    // %.
    assert!((mean / 208.33 - 1.0).abs() < 0.006, "{mean}");
}

#[test]
fn the_direct_picture_plus_the_metered_bounced_light_is_the_path_traced_picture() {
    // A card in a closed room with a grey ball, a softbox and a bulb. The picture by `direct`, the meter's bounced
    // light and the picture by `path` are three estimates that share no random number.
    let (position, normal) = (Vec3::new(0.2, 1.0, 0.1), Vec3::new(0.4, 0.3, 1.0).normalize());
    let mut scene = studio::measure::meter_card(position, normal);
    scene.room = Some(Room::default());
    let mut ball =
        studio::object("A ball nearby", Shape::Sphere { radius_m: 0.4 }, position + Vec3::new(0.5, 0.0, 0.6));
    ball.material.base_color = [0.6; 3];
    scene.objects.push(ball);
    let softbox = Emitter::RectPanel { width_m: 0.6, height_m: 0.9 };
    for (i, (emitter, point)) in
        [(softbox, Vec3::new(-1.2, 1.8, 1.4)), (Emitter::Point, Vec3::new(1.3, 2.2, 0.9))].into_iter().enumerate()
    {
        let light = light(emitter, Output::Lumens(4000.0), point);
        scene.lights.push(Light { id: LightId(i as u32), name: format!("Light {i}"), ..light });
    }
    let picture = |method, seed| {
        let settings = Settings { seed, ..studio::measure::square(method, 32, 64) };
        studio::measure::illuminance(&scene, &settings)
    };
    let (direct, path) = (picture(Method::Direct, 1), picture(Method::Path, 2));
    let effort = MeterEffort { paths: Some(1 << 16), ..MeterEffort::default() };
    let read = read_with(&scene, position, normal, Receptor::Flat, &effort).reading;
    let bounced: f64 = read.lights.iter().map(|light| f64::from(light.bounced)).sum();
    let bounced_error = read.lights.iter().map(|light| f64::from(light.standard_error).powi(2)).sum::<f64>();
    assert!(bounced > 0.2 * direct.mean, "a room worth the test: {bounced} of {direct:?}");
    let rest = SampleMean {
        mean: path.mean - direct.mean,
        standard_error: (path.standard_error.powi(2) + direct.standard_error.powi(2) + bounced_error).sqrt(),
    };
    assert!(rest.standard_error < 0.01 * bounced, "{rest:?} for {bounced}");
    assert!(rest.agrees_with(bounced, 1e-3, 1), "{rest:?} for {bounced}");
}

/// An object of a material, turned.
fn specular(shape: Shape, material: Material, position: Vec3, rotation_deg: Vec3) -> Object {
    let mut object = studio::object("Specular", shape, position);
    object.transform.rotation_deg = rotation_deg;
    Object { material, ..object }
}

#[test]
fn a_mirror_gives_the_meter_the_illuminance_of_the_lights_image() {
    // The meter faces up under a lamp at 1 m; a mirror 1 m beside shows its image at (2, 1, 0). Flat: inverse square and
    // cosine; a dome weights it by (1 + cos) / 2.
    let mirror = Material { metallic: 1.0, roughness: 0.0, base_color: [0.999; 3], ..Material::default() };
    let plane = Shape::Plane { width_m: 0.4, depth_m: 0.4 };
    let cos = 0.2_f64.sqrt();
    for emitter in [Emitter::Point, Emitter::Sphere { radius_m: 0.005 }, Emitter::Sun { angular_diameter_deg: 0.53 }] {
        for receptor in [Receptor::Flat, Receptor::Dome] {
            let mut lamp = light(emitter, Output::Lumens(12_566.37), Vec3::Y);
            let mut image = 1000.0 / 5.0 * if receptor == Receptor::Flat { cos } else { 0.5 * (1.0 + cos) };
            if let Emitter::Sun { .. } = emitter {
                lamp.power.output = Output::Lux(1000.0);
                lamp.aim = Aim::Angles { yaw_deg: -90.0, pitch_deg: -30.0 };
                image = if receptor == Receptor::Flat { 500.0 } else { 750.0 };
            }
            let mut scene = Scene { lights: vec![lamp], ..Scene::default() };
            let at = Vec3::new(1.0, 0.5, 0.0);
            scene.objects.push(specular(plane.clone(), mirror.clone(), at, Vec3::Z * 90.0));
            let reading = &read(&scene, Vec3::ZERO, Vec3::Y, receptor).reading.lights[0];
            let (ours, error) = (f64::from(reading.bounced), f64::from(reading.standard_error));
            // Over a receptor of 1 cm the image's illuminance changes by less than 0.1 %.
            assert!(
                (ours - 0.999 * image).abs() < 4.0 * error + 2e-3 * image,
                "{emitter:?} {receptor:?}: {ours} of {image} lx"
            );
            assert!(error < 0.06 * image, "{emitter:?} {receptor:?}: {error} says little");
        }
    }
}

/// Illuminance of a disc of this radius by a lamp of 1 cd through a ball of glass between both, all on one axis: rays in
/// a plane of the axis, at equal steps of the angle, with all inner reflections. Distances from the ball's centre.
fn through_ball(lamp: f64, ball: f64, n: f64, disc: f64, disc_radius: f64) -> f64 {
    use glam::DVec2;
    let steps = 20_000;
    let widest = (ball / lamp).asin();
    let reflectances = |cos: f64, eta: f64| {
        let (s, p) = studio::closed_forms::fresnel(cos.min(1.0).acos(), eta);
        [s, p]
    };
    let refract = |d: DVec2, normal: DVec2, eta: f64| {
        let cos = -d.dot(normal);
        d / eta + normal * (cos / eta - (1.0 - (1.0 - cos * cos) / (eta * eta)).max(0.0).sqrt())
    };
    let mut flux = 0.0;
    for step in 0..steps {
        let angle = (f64::from(step) + 0.5) / f64::from(steps) * widest;
        let (mut at, d) = (DVec2::new(0.0, lamp), DVec2::new(angle.sin(), -angle.cos()));
        let b = at.dot(d);
        at += d * (-b - (b * b - lamp * lamp + ball * ball).sqrt());
        let mut weights = reflectances(-d.dot(at / ball), n).map(|r| 1.0 - r);
        let mut inside = refract(d, at / ball, n);
        for _ in 0..8 {
            at -= inside * (2.0 * at.dot(inside));
            let normal = -at / ball;
            let faces = reflectances(-inside.dot(normal), 1.0 / n);
            let out = refract(inside, normal, 1.0 / n);
            let x = at.x + out.x * (at.y + disc) / -out.y;
            if out.y < 0.0 && x.abs() < disc_radius {
                let passed = 0.5 * (weights[0] * (1.0 - faces[0]) + weights[1] * (1.0 - faces[1]));
                flux += passed * 2.0 * std::f64::consts::PI * angle.sin() * widest / f64::from(steps);
            }
            weights = [weights[0] * faces[0], weights[1] * faces[1]];
            inside -= normal * (2.0 * inside.dot(normal));
        }
    }
    flux / (std::f64::consts::PI * disc_radius * disc_radius)
}

#[test]
fn a_ball_of_glass_focuses_small_lamps_on_the_meter_with_every_seed() {
    // 7 % of the light is that of three inner reflections. The lamp is 2.6 m before the ball's centre, the meter 0.4 m
    // behind it, with a receptor of 1 cm.
    let truth = 1000.0 * through_ball(2.6, 0.1, 1.5, 0.4, 0.01);
    assert!((truth - 63.68).abs() < 0.1, "{truth}");
    let glass = Material { base_color: [1.0; 3], transmission: 1.0, roughness: 0.0, ior: 1.5, ..Material::default() };
    for emitter in [Emitter::Point, Emitter::Sphere { radius_m: 0.005 }] {
        let lamp = light(emitter, Output::Lumens(12_566.37), Vec3::Z * 3.0);
        let mut scene = Scene { lights: vec![lamp], ..Scene::default() };
        scene.objects.push(specular(Shape::Sphere { radius_m: 0.1 }, glass.clone(), Vec3::Z * 0.4, Vec3::ZERO));
        for seed in 0..5 {
            let effort = MeterEffort { seed, ..MeterEffort::default() };
            let result = read_with(&scene, Vec3::ZERO, Vec3::Z, Receptor::Flat, &effort);
            let reading = &result.reading.lights[0];
            let (ours, error) = (f64::from(reading.sum()), f64::from(reading.standard_error));
            // The ball is a mesh, which focuses like a ball to 1 %.
            assert!(
                (ours - truth).abs() < 0.01 * truth + 4.0 * error,
                "{emitter:?}, seed {seed}: {ours} of {truth} lx"
            );
            assert!(error < 0.03 * truth, "{emitter:?}, seed {seed}: {error} says little");
        }
    }
}

#[test]
fn a_meter_that_finds_no_light_says_what_mirrors_may_throw_on_it() {
    // A lamp behind a wall; a mirror shows it to the meter from one direction of many, or from none.
    let mirror = Material { metallic: 1.0, roughness: 0.0, ..Material::default() };
    let wall = studio::object("Wall", Shape::Box { size_m: Vec3::new(1.0, 1.0, 0.1) }, Vec3::Z);
    let lamp = light(Emitter::Point, Output::Lumens(12_566.37), Vec3::Z * 2.0);
    let mut scene = Scene { objects: vec![wall], lights: vec![lamp], ..Scene::default() };
    let dark = read(&scene, Vec3::ZERO, Vec3::Z, Receptor::Flat).reading;
    assert_eq!((dark.total_lux_s(), dark.missed_lux_s()), (0.0, 0.0), "nothing can bring light here");
    let plane = Shape::Plane { width_m: 0.5, depth_m: 0.5 };
    scene.objects.push(specular(plane, mirror, Vec3::new(1.5, -0.5, 1.0), Vec3::ZERO));
    let unknown = read(&scene, Vec3::ZERO, Vec3::Z, Receptor::Flat).reading;
    assert!(unknown.total_lux_s() == 0.0 && unknown.missed_lux_s() > 0.0, "{unknown:?}");
    assert!(unknown.missed_lux_s() * 125.0 < 30.0, "{} lx are more than it can be", unknown.missed_lux_s() * 125.0);
}

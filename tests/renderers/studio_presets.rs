//! Checks the shipped studios as a photographer does with a meter: exposure of the key, lighting ratios, angles of the
//! patterns. The illuminances are closed forms, independent of every renderer.

use crate::people::shipped;
use catchlight::figures::{build, head_frame};
use catchlight::io::presets;
use catchlight::photo::{PhotometricLight, exposure};
use catchlight::scene::{Assets, Emitter, Light, Role, Scene, Shape};
use glam::Vec2;
use std::f32::consts::PI;

/// Returns the direct luminous exposure (lux s) of one light on a receptor at its aim that faces it.
fn metered_lux_s(scene: &Scene, light: &Light) -> f32 {
    let distance = scene.aim_point(&light.aim, light.position).distance(light.position);
    let per_axial_intensity = match light.emitter {
        // A rectangle on its axis: the sum of four corner patches (Lambert's formula for parallel planes).
        Emitter::RectPanel { width_m, height_m } => {
            let (a, b) = (0.5 * width_m, 0.5 * height_m);
            let (to_a, to_b) = (a.hypot(distance), b.hypot(distance));
            2.0 * (a / to_a * (b / to_a).atan() + b / to_b * (a / to_b).atan()) / (width_m * height_m)
        }
        Emitter::RoundPanel { diameter_m } => 1.0 / (0.25 * diameter_m * diameter_m + distance * distance),
        Emitter::Point | Emitter::Sphere { .. } | Emitter::Spot { .. } => 1.0 / (distance * distance),
        Emitter::Sun { .. } | Emitter::Surround => return f32::NAN,
    };
    let light = PhotometricLight::new(scene, &Assets::default(), light);
    light.axial_intensity() * per_axial_intensity * light.exposure_time_s
}

/// Returns the stops of a light over the exposure of the camera's settings.
fn stops_over(scene: &Scene, lux_s: f32) -> f32 {
    let n = exposure::f_number(lux_s, scene.camera.iso, scene.camera.meter_constant);
    2.0 * (n / scene.camera.f_number).log2()
}

fn of_role(scene: &Scene, role: Role) -> impl Iterator<Item = f32> + '_ {
    scene.lights.iter().filter(move |l| l.role == role).map(|light| stops_over(scene, metered_lux_s(scene, light)))
}

fn scene(file: &str) -> Scene {
    let preset = presets().iter().find(|p| p.file_name == file);
    preset.unwrap().scene().unwrap()
}

#[test]
fn the_closed_forms_agree_with_the_table_of_illuminances() {
    // light_and_camera.md's table: 1000 lm, 60x90 cm at 1 m 267.05 lx, round 120 cm at 1 m 234.05 lx.
    let mut scene = scene("three_point.ron");
    let light = &mut scene.lights[0];
    light.aim = catchlight::scene::Aim::Point(light.position + glam::Vec3::X);
    light.power.dial_stops = 0.0;
    light.power.output = catchlight::scene::Output::FlashWs { energy_ws: 100.0, efficacy_lm_s_per_ws: 10.0 };
    for (emitter, expected) in [
        (Emitter::RectPanel { width_m: 0.6, height_m: 0.9 }, 267.05),
        (Emitter::RoundPanel { diameter_m: 1.2 }, 234.05),
        (Emitter::Point, 1000.0 / (4.0 * PI)),
    ] {
        let light = Light { emitter, ..scene.lights[0].clone() };
        let computed = metered_lux_s(&scene, &light);
        assert!((computed / expected - 1.0).abs() < 1e-4, "{emitter:?}: {computed}");
    }
}

#[test]
fn keys_are_exposed_correctly_and_fills_are_weaker() {
    for preset in presets() {
        let scene = scene(preset.file_name);
        let keys: Vec<f32> = of_role(&scene, Role::Key).collect();
        assert!(keys.len() == 1 || preset.file_name == "rim_low_key.ron", "{}: {keys:?}", preset.file_name);
        for key in keys {
            // Slightly under where a fill or a bright room adds light.
            assert!((-0.8..=0.2).contains(&key), "{}: the key is {key:+.2} stops off", preset.file_name);
            for fill in of_role(&scene, Role::Fill) {
                let ratio = key - fill;
                assert!((0.9..=4.0).contains(&ratio), "{}: key:fill is {ratio:.2} stops", preset.file_name);
            }
        }
    }
}

#[test]
fn dials_stay_within_the_range_of_flash_heads() {
    for preset in presets() {
        for light in &scene(preset.file_name).lights {
            let dial = light.power.dial_stops;
            assert!((-8.0..=0.0).contains(&dial), "{}: {} at {dial}", preset.file_name, light.name);
            assert!(light.power.output.is_flash() || dial > -7.0);
        }
    }
}

/// Returns azimuth and elevation, degrees, of a light, seen from a face at its aim that looks along +Z.
fn angles(scene: &Scene, name: &str) -> (f32, f32) {
    let light = scene.lights.iter().find(|l| l.name == name).cloned();
    let offset = light.map(|l| l.position - scene.aim_point(&l.aim, l.position)).unwrap_or_default();
    (offset.x.atan2(offset.z).to_degrees(), offset.y.atan2(offset.x.hypot(offset.z)).to_degrees())
}

#[test]
fn portrait_patterns_have_their_textbook_angles() {
    // light_and_camera.md, portrait patterns. Positions are rounded to the centimetre, so the tolerance is half a
    // degree.
    for (file, light, azimuths, elevations) in [
        ("butterfly.ron", "Beauty dish", 0.0..=0.0, 25.0..=45.0),
        ("loop.ron", "Key dish", 20.0..=50.0, 25.0..=60.0),
        ("rembrandt.ron", "Key reflector", 45.0..=60.0, 40.0..=50.0),
        ("split.ron", "Key strip", 90.0..=90.0, 0.0..=0.0),
        ("clamshell.ron", "Upper octa", 0.0..=0.0, 25.0..=60.0),
        ("clamshell.ron", "Lower softbox", 0.0..=0.0, -60.0..=-25.0),
    ] {
        let (azimuth, elevation) = angles(&scene(file), light);
        let within = |x: f32, range: std::ops::RangeInclusive<f32>| x >= range.start() - 0.5 && x <= range.end() + 0.5;
        assert!(within(azimuth, azimuths), "{file}: azimuth {azimuth}");
        assert!(within(elevation, elevations), "{file}: elevation {elevation}");
    }
}

#[test]
fn no_lock_of_curly_hair_stands_out_of_its_outline() {
    // As seen from the front, in sectors of 10 degrees about a point between the brows; a lock stood 20 mm over the rest
    const SECTORS: usize = 18;
    let loaded = shipped("loop");
    let figure = loaded.scene.objects.iter().find_map(|object| match &object.shape {
        Shape::Figure(figure) => Some(figure),
        _ => None,
    });
    let figure = figure.unwrap();
    let head_from_object = head_frame(figure).inverse();
    let mut outline = [0.0_f32; SECTORS];
    for point in build(figure).fine.strands.with_parts(|part| part == "hair").points() {
        let p = head_from_object.transform_point3(point.position).truncate() - Vec2::new(0.0, 0.015);
        let sector = (p.y.atan2(p.x) / PI * SECTORS as f32).floor();
        if let Some(farthest) = outline.get_mut(sector as usize).filter(|_| sector >= 0.0) {
            *farthest = farthest.max(p.length());
        }
    }
    outline.sort_unstable_by(f32::total_cmp);
    let tuft_m = outline[SECTORS - 1] - outline[SECTORS / 2];
    assert!(tuft_m < 0.013, "{tuft_m} m of {outline:?}");
}

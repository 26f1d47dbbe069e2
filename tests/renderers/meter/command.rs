//! The command `meter`: its report, its errors, and the exposure that it proposes against a render.

use super::*;
use serde_json::Value;
use std::path::Path;
use std::process::{Command, Output as ProcessOutput};

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

//! `catchlight solve`: dials for wishes, refusals, the studio that it writes.

use super::{Value, catchlight, stderr, stdout};
use catchlight::scene::{Emitter, Facing, Light, Meter, Object, Output, Power, Receptor, Role, Room, Scene, Shape};
use glam::Vec3;

/// Returns a studio with a meter, a key on the left and a fill on the right.
fn studio() -> Scene {
    let flash = |name: &str, role, x| {
        let output = Output::FlashWs { energy_ws: 400.0, efficacy_lm_s_per_ws: 20.0 };
        let light =
            Light { position: Vec3::new(x, 2.0, 1.5), role, ..Light::new(Emitter::Sphere { radius_m: 0.1 }, output) };
        Light { name: name.to_owned(), power: Power { output, dial_stops: -3.0 }, ..light }
    };
    Scene {
        room: Some(Room::default()),
        objects: vec![Object::new("Ball", Shape::Sphere { radius_m: 0.2 })],
        lights: vec![flash("Left", Role::Key, -1.0), flash("Right", Role::Fill, 1.5)],
        meter: Some(Meter { position: Vec3::Y * 1.4, facing: Facing::Camera, receptor: Receptor::Flat }),
        ..Scene::default()
    }
}

#[test]
fn a_solved_studio_has_the_wanted_readings_by_meter() {
    let folder = tempfile::tempdir().unwrap();
    catchlight::io::save_scene(&studio(), &folder.path().join("studio.ron")).unwrap();
    let want = ["--want", "Key=f/8", "--want", "Fill=-1.5"];
    let arguments = [&["solve", "studio.ron", "--write", "set.ron", "--json"], &want[..]].concat();
    let output = catchlight(folder.path(), &arguments);
    assert_eq!(output.status.code(), Some(0), "{}", stderr(&output));
    let report: Value = serde_json::from_str(stdout(&output).trim()).unwrap();
    assert_eq!(report["dials"].as_array().unwrap().len(), 2);
    assert!(report["wishes"].as_array().unwrap().iter().all(|wish| wish["missed_stops"].is_null()), "{report}");
    let read = catchlight(folder.path(), &["meter", "set.ron", "--json"]);
    let reading: Value = serde_json::from_str(stdout(&read).trim()).unwrap();
    let light = |index: usize, key: &str| reading["lights"][index][key].as_f64().unwrap();
    // N^2 = H S / C
    let f_number = (light(0, "lux_s") * 100.0 / 250.0).sqrt();
    assert!((2.0 * (f_number / 8.0).log2()).abs() < 0.06, "f/{f_number}");
    assert!((light(1, "share_stops") + 1.5).abs() < 0.06);
}

#[test]
fn wishes_beyond_a_head_are_warned_of_and_wrong_ones_refused() {
    let folder = tempfile::tempdir().unwrap();
    let output = catchlight(folder.path(), &["solve", "three_point", "--want", "key=f/90"]);
    assert_eq!(output.status.code(), Some(0));
    assert!(stderr(&output).contains("cannot be met") && stderr(&output).contains("at full power"));
    assert!(stdout(&output).contains("not met"), "{}", stdout(&output));
    for (want, message) in [("Nobody=f/8", "has Key softbox"), ("key=8", "write f/8"), ("key", "NAME=LEVEL")] {
        let output = catchlight(folder.path(), &["solve", "three_point", "--want", want, "--write", "set.ron"]);
        assert_eq!(output.status.code(), Some(1));
        assert!(stderr(&output).contains(message), "{}", stderr(&output));
    }
    // A level that is none is reported before the studio is opened
    let output = catchlight(folder.path(), &["solve", "no such studio", "--want", "key=8"]);
    assert!(stderr(&output).contains("write f/8"), "{}", stderr(&output));
    let output =
        catchlight(folder.path(), &["solve", "three_point", "--want", "key=f/8", "--write", "no/such/set.ron"]);
    assert_eq!(output.status.code(), Some(1));
    assert!(!folder.path().join("set.ron").exists());
}

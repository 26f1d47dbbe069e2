//! `catchlight sheet`: files, formats, refusals.

use super::{Value, catchlight, stderr, stdout};
use catchlight::photo::meter::nearest_third;
use catchlight::scene::{Emitter, Facing, Light, Meter, Object, Output, Receptor, Room, Scene, Shape};
use glam::Vec3;

#[test]
fn a_sheet_is_written_in_the_format_of_its_extension_with_the_reading_of_meter() {
    let folder = tempfile::tempdir().unwrap();
    let light = Light { position: Vec3::new(1.0, 2.0, 1.5), ..Light::new(Emitter::Point, Output::Lumens(3e5)) };
    let scene = Scene {
        room: Some(Room::default()),
        objects: vec![Object::new("Ball", Shape::Sphere { radius_m: 0.2 })],
        lights: vec![light],
        meter: Some(Meter { position: Vec3::Y * 1.4, facing: Facing::Camera, receptor: Receptor::Flat }),
        ..Scene::default()
    };
    catchlight::io::save_scene(&scene, &folder.path().join("studio.ron")).unwrap();
    let read = catchlight(folder.path(), &["meter", "studio.ron", "--json"]);
    let reading: Value = serde_json::from_str(stdout(&read).trim()).unwrap();
    let f_number = reading["total"]["f_number"].as_f64().unwrap() as f32;
    let output = catchlight(folder.path(), &["sheet", "studio.ron", "-o", "plan.svg", "--spp", "1", "--units", "ft"]);
    assert_eq!(output.status.code(), Some(0), "{}", stderr(&output));
    let svg = std::fs::read_to_string(folder.path().join("plan.svg")).unwrap();
    assert!(f_number > 4.0 && svg.contains(&format!("{} at the subject", nearest_third(f_number))), "{f_number}");
    // 2 m
    assert!(svg.contains("6&#39; 7&quot;"));
}

#[test]
fn a_sheet_of_another_format_or_into_no_folder_is_refused_before_the_picture_is_rendered() {
    let folder = tempfile::tempdir().unwrap();
    for (file, message) in [("plan.docx", ".pdf, .svg or .html"), ("no/such/plan.pdf", "no/such")] {
        // So many samples would take hours
        let output = catchlight(folder.path(), &["sheet", "split", "-o", file, "--spp", "65536"]);
        assert_eq!(output.status.code(), Some(1), "{}", stderr(&output));
        assert!(stderr(&output).contains(message), "{}", stderr(&output));
    }
}

#[test]
fn a_lesson_sheet_is_written_and_its_faults_are_named_before_it_is_rendered() {
    let folder = tempfile::tempdir().unwrap();
    let flash = Output::FlashWs { energy_ws: 400.0, efficacy_lm_s_per_ws: 20.0 };
    let light = Light { position: Vec3::new(1.0, 2.0, 1.5), ..Light::new(Emitter::Point, flash) };
    let scene = Scene {
        room: Some(Room::default()),
        objects: vec![Object::new("Ball", Shape::Sphere { radius_m: 0.2 })],
        lights: vec![light],
        meter: Some(Meter { position: Vec3::Y * 1.4, facing: Facing::Camera, receptor: Receptor::Dome }),
        ..Scene::default()
    };
    catchlight::io::save_scene(&scene, &folder.path().join("studio.ron")).unwrap();
    let run = |rest: &[&str]| catchlight(folder.path(), &[&["sheet", "studio.ron", "--spp", "1"], rest].concat());
    let output = run(&["-o", "rooms.png", "--series", "room"]);
    assert_eq!(output.status.code(), Some(0), "{}", stderr(&output));
    assert!(stderr(&output).contains("3 of 3: White, +"), "{}", stderr(&output));
    let picture = image::open(folder.path().join("rooms.png")).unwrap();
    assert!(picture.width() > 900 && picture.height() > 200);
    for (rest, message) in [
        (&["-o", "x.pdf", "--series", "distance"][..], ".png or .html"),
        (&["-o", "x.png", "--series", "azimuth", "--light", "Nobody"], "is not one light"),
        (&["-o", "x.png", "--light", "Light"], "--series"),
        (&["-o", "x.png"], ".pdf, .svg or .html"),
    ] {
        let output = run(rest);
        assert_ne!(output.status.code(), Some(0));
        assert!(stderr(&output).contains(message), "{}", stderr(&output));
    }
    assert!(!folder.path().join("x.png").exists());
}

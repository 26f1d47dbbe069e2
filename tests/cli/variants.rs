//! Variants of a studio on the command line.

use super::{Value, catchlight, stderr, stdout};
use catchlight::scene::Scene;

/// Writes a studio whose variant "Dim" has its key a stop lower, and returns it.
fn write_studio(folder: &std::path::Path) -> Scene {
    let mut scene = catchlight::io::find_preset("three_point").unwrap().scene().unwrap();
    scene.add_variant("Dim".to_owned()).unwrap();
    scene.lights[0].power.dial_stops -= 1.0;
    catchlight::io::save_scene(&scene, &folder.join("studio.ron")).unwrap();
    scene
}

#[test]
fn a_variant_is_metered_and_named_in_the_picture() {
    let folder = tempfile::tempdir().unwrap();
    write_studio(folder.path());
    let lux = |variant: &[&str]| {
        let read = ["meter", "studio.ron", "--at", "0,1.5,0.3", "--spp", "64", "--json"];
        let output = catchlight(folder.path(), &[&read, variant].concat());
        assert_eq!(output.status.code(), Some(0), "{}", stderr(&output));
        let reading: Value = serde_json::from_str(stdout(&output).trim()).unwrap();
        reading["lights"][0]["lux_s"].as_f64().unwrap()
    };
    let ratio = lux(&["--variant", "Dim"]) / lux(&[]);
    assert!((ratio - 0.5).abs() < 1e-4, "{ratio}");
    assert_eq!(lux(&["--variant", "A"]), lux(&[]));

    let draw = ["render", "studio.ron", "--variant", "Dim", "--size", "24x16", "--spp", "1", "-o", "dim.png"];
    let output = catchlight(folder.path(), &draw);
    assert_eq!(output.status.code(), Some(0), "{}", stderr(&output));
    let png = std::fs::read(folder.path().join("dim.png")).unwrap();
    let title = "Three-point portrait (Dim)";
    assert!(png.windows(title.len()).any(|bytes| bytes == title.as_bytes()));
}

#[test]
fn an_unknown_variant_is_refused_with_the_names_of_all() {
    let folder = tempfile::tempdir().unwrap();
    write_studio(folder.path());
    for command in [
        &["meter", "studio.ron", "--at", "0,1,0"][..],
        &["render", "studio.ron", "-o", "a.png"],
        &["audit", "studio.ron"],
    ] {
        let output = catchlight(folder.path(), &[command, &["--variant", "Dimm"]].concat());
        assert_eq!(output.status.code(), Some(1));
        assert!(stderr(&output).contains("\"Dimm\"") && stderr(&output).contains("A, Dim"), "{}", stderr(&output));
    }
}

#[test]
fn a_solved_variant_is_written_and_the_studio_stays() {
    let folder = tempfile::tempdir().unwrap();
    let before = write_studio(folder.path());
    let solve = ["solve", "studio.ron", "--variant", "Dim", "--want", "Key=f/11", "--write", "set.ron"];
    let output = catchlight(folder.path(), &solve);
    assert_eq!(output.status.code(), Some(0), "{}", stderr(&output));
    let after = catchlight::io::load_scene(&folder.path().join("set.ron")).unwrap().scene;
    let studio = before.as_variant(before.variants.studio_id).unwrap();
    assert_eq!(after.without_variants(), studio.without_variants());
    let dim = after.as_variant(after.variants.named("Dim").unwrap()).unwrap();
    assert_ne!(dim.lights[0].power.dial_stops, before.lights[0].power.dial_stops);
}

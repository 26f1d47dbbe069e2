//! The program as a process: arguments, files, exit codes, output to stdout and stderr.
#![allow(clippy::unwrap_used, reason = "a failed unwrap fails the test")]

mod audit;
mod chart;
mod checkpoints;
mod denoiser;
mod extremes;
mod farm;
mod gear;
mod import;
mod output;
mod package;
#[cfg(unix)]
mod peers;
mod picture_files;
mod running_render;
mod sheet;
mod signals;
mod solve;
mod variants;
mod window_libraries;

use serde_json::Value;
use std::path::Path;
use std::process::{Command, Output, Stdio};

fn catchlight(folder: &Path, arguments: &[&str]) -> Output {
    Command::new(env!("CARGO_BIN_EXE_catchlight"))
        .current_dir(folder)
        .env_remove("DISPLAY")
        .env_remove("WAYLAND_DISPLAY")
        .env_remove("WAYLAND_SOCKET")
        .args(arguments)
        .output()
        .unwrap()
}

/// Returns true if a program is there that a test runs beside ours; the gate demands all.
#[cfg(unix)]
#[expect(clippy::print_stderr, reason = "a skipped test says so")]
fn is_installed(program: &str) -> bool {
    let is_installed = Command::new(program).arg("--version").output().is_ok();
    assert!(is_installed || std::env::var_os("CATCHLIGHT_REQUIRE_TOOLS").is_none(), "no {program}");
    if !is_installed {
        eprintln!("\n!!! SKIPPED, no {program}\n");
    }
    is_installed
}

fn stderr(output: &Output) -> String {
    String::from_utf8_lossy(&output.stderr).into_owned()
}

fn stdout(output: &Output) -> String {
    String::from_utf8_lossy(&output.stdout).into_owned()
}

#[test]
fn render_writes_each_format_and_reports_in_json() {
    let folder = tempfile::tempdir().unwrap();
    for name in ["a.png", "b.jpg", "c.exr"] {
        let output = catchlight(
            folder.path(),
            &["render", "product_still_life", "-o", name, "--size", "48x32", "--spp", "2", "--json", "--threads", "2"],
        );
        assert_eq!(output.status.code(), Some(0), "{}", stderr(&output));
        let report: Value = serde_json::from_str(stdout(&output).trim()).unwrap();
        for key in [
            "width",
            "height",
            "spp",
            "threads",
            "method",
            "seed",
            "triangles",
            "lights",
            "build_s",
            "trace_s",
            "wall_s",
            "rays",
            "noise_stops",
            "nonfinite",
        ] {
            assert!(report.get(key).is_some(), "the report lacks {key}: {report}");
        }
        assert_eq!((report["width"].as_u64(), report["spp"].as_u64()), (Some(48), Some(2)));
        assert!(report["rays"].as_u64().unwrap() > 48 * 32 * 2);
        assert!(folder.path().join(name).metadata().unwrap().len() > 500);
    }
    let png = image::open(folder.path().join("a.png")).unwrap().to_rgb8();
    assert_eq!(png.dimensions(), (48, 32));
    assert!(png.pixels().any(|p| p[1] > 100));
}

#[test]
fn exr_holds_scene_linear_values_and_attributes_of_the_render() {
    let folder = tempfile::tempdir().unwrap();
    let arguments = ["render", "split", "-o", "x.exr", "--size", "24x36", "--spp", "2", "--seed", "9", "--layers"];
    let output = catchlight(folder.path(), &arguments);
    assert_eq!(output.status.code(), Some(0), "{}", stderr(&output));
    let bytes = std::fs::read(folder.path().join("x.exr")).unwrap();
    assert_eq!(&bytes[..4], &[0x76, 0x2f, 0x31, 0x01]);
    let header = String::from_utf8_lossy(&bytes[..bytes.len().min(8192)]).into_owned();
    for attribute in ["spp", "seed", "method", "catchlightVersion", "cd"] {
        assert!(header.contains(attribute), "no {attribute} in the header");
    }
}

/// A room of white walls, lit by a panel.
const WHITE_ROOM: &str = r#"(
    format: 1,
    name: "White room",
    camera: (
        position: (0.0, 1.5, 2.0), aim: Point(0.0, 1.2, -1.0), sensor: FullFrame, orientation: Landscape,
        focal_length_mm: 24.0, f_number: 4.0, shutter_s: 0.01, iso: 100.0, white_balance_k: 5600.0,
    ),
    room: Some((
        size_m: (4.0, 3.0, 5.0),
        floor: Custom(base_color: (0.8, 0.8, 0.8), roughness: 1.0),
        walls: Custom(base_color: (0.8, 0.8, 0.8), roughness: 1.0),
        ceiling: Custom(base_color: (0.8, 0.8, 0.8), roughness: 1.0),
    )),
    objects: [],
    lights: [(
        name: "Key", role: Key, position: (0.0, 2.9, -0.5), aim: Point(0.0, 0.0, -0.5),
        emitter: RectPanel(width_m: 0.9, height_m: 0.9), power: (output: Lumens(12000.0), dial_stops: 0.0),
        color: Kelvin(5600.0),
    )],
)"#;

#[test]
fn the_exr_method_names_how_light_was_approximated_and_the_report_photons() {
    let folder = tempfile::tempdir().unwrap();
    let render = |studio: &str, options: &[&str]| {
        let arguments = ["render", studio, "-o", "a.exr", "--size", "24x16", "--spp", "1", "--json"];
        let arguments = [&arguments, options].concat();
        let output = catchlight(folder.path(), &arguments);
        let report: Value = serde_json::from_str(stdout(&output).trim()).unwrap();
        let file = std::fs::read(folder.path().join("a.exr")).unwrap();
        let header = String::from_utf8_lossy(&file[..4000.min(file.len())]).into_owned();
        let text = ["caustics from photons", "blurred gloss after a bounce", "bounced light from a cache"];
        (report["photons"].as_bool().unwrap(), text.map(|text| header.contains(text)))
    };
    let plain = ["--caustics", "paths", "--bounced-light", "paths"];
    assert_eq!(render("product_still_life", &["--caustics", "photons"]), (true, [true, true, false]));
    assert_eq!(render("product_still_life", &plain[..2]), (false, [false, true, false]));
    assert_eq!(render("product_still_life", &plain), (false, [false; 3]));
    // This studio has neither glass nor mirrors, and a person.
    assert_eq!(render("rembrandt", &[]), (false, [false; 3]));
    // The walls of this room are white.
    std::fs::write(folder.path().join("room.ron"), WHITE_ROOM).unwrap();
    assert_eq!(render("room.ron", &[]), (false, [false, false, true]));
    assert_eq!(render("room.ron", &plain), (false, [false; 3]));
}

#[test]
fn explain_prints_the_shortcuts_of_the_render_plan_with_reasons() {
    let folder = tempfile::tempdir().unwrap();
    let arguments = ["render", "three_point", "-o", "x.png", "--size", "12x18", "--spp", "1", "--explain"];
    let output = catchlight(folder.path(), &arguments);
    assert!(stdout(&output).contains("no glass: no refraction"), "{}", stdout(&output));
    assert!(!stdout(&output).contains("focus breathing"), "{}", stdout(&output));
    let mut scene = catchlight::io::presets()[0].scene().unwrap();
    scene.camera.focus_breathing = true;
    scene.camera.focal_length_mm = 100.0;
    scene.camera.focus = catchlight::scene::Focus::Distance(0.2);
    std::fs::write(folder.path().join("near.ron"), catchlight::io::write_scene(&scene)).unwrap();
    let output = catchlight(folder.path(), &[&["render", "near.ron"], &arguments[2..]].concat());
    let line = "focused at 0.200 m, magnification 1.000, field 2.000 times narrower, 2.00 stops lost";
    assert!(stdout(&output).contains(line), "{}", stdout(&output));
}

#[test]
fn presets_are_listed_with_a_description() {
    let output = catchlight(Path::new("."), &["presets"]);
    assert_eq!(output.status.code(), Some(0));
    assert!(stdout(&output).lines().count() >= 8);
    assert!(stdout(&output).lines().any(|l| l.starts_with("rembrandt ") && l.len() > 40));
}

#[test]
fn wrong_input_exits_with_code_1_a_reason_and_no_file() {
    let folder = tempfile::tempdir().unwrap();
    std::fs::write(folder.path().join("bad.ron"), "(format: 1, name: \"x\", camra: ())").unwrap();
    for (arguments, reason) in [
        (vec!["render", "nowhere.ron", "-o", "x.png"], "nowhere.ron"),
        (vec!["render", "three_point", "-o", "x.bmp"], "bmp"),
        (vec!["render", "three_point", "-o", "missing/x.png"], "missing"),
        (vec!["render", "three_point", "-o", "x.png", "--size", "0x10"], "0x10"),
        (vec!["render", "three_point", "-o", "x.png", "--spp", "0"], "0"),
        (vec!["render", "three_point", "-o", "x.png", "--layers"], "exr"),
        (vec!["check", "bad.ron"], "camra"),
        (vec!["render", "bad.ron", "-o", "x.png"], "camera"),
        (vec!["dance"], "dance"),
    ] {
        let output = catchlight(folder.path(), &arguments);
        assert_eq!(output.status.code(), Some(1), "{arguments:?}: {}", stderr(&output));
        assert!(stderr(&output).contains(reason), "{arguments:?}: {}", stderr(&output));
        assert!(stdout(&output).is_empty());
        assert!(!folder.path().join("x.png").exists());
    }
}

#[test]
fn check_accepts_a_valid_studio_and_warns_of_one_without_lights() {
    let folder = tempfile::tempdir().unwrap();
    let good = catchlight(folder.path(), &["check", "loop"]);
    assert_eq!(good.status.code(), Some(0));
    let text = stdout(&good);
    assert!(
        text.contains("Woman: loop lighting; key \u{201c}Key dish\u{201d} 35\u{b0} to the person's left"),
        "{text}"
    );
    let dark = catchlight::io::write_scene(&catchlight::scene::Scene::default());
    std::fs::write(folder.path().join("dark.ron"), dark).unwrap();
    let output = catchlight(folder.path(), &["check", "dark.ron"]);
    assert_eq!(output.status.code(), Some(0));
    assert!(stderr(&output).contains("light"), "a studio without lights is odd: {}", stderr(&output));
}

#[test]
fn without_a_display_the_editor_names_the_render_command() {
    let output = catchlight(Path::new("."), &[]);
    assert_eq!(output.status.code(), Some(2));
    assert!(stderr(&output).contains("catchlight render"), "{}", stderr(&output));
}

#[test]
fn a_time_limit_ends_a_render_with_a_picture() {
    let folder = tempfile::tempdir().unwrap();
    let arguments = ["render", "split", "-o", "x.png", "--size", "64x96", "--time", "0.5", "--json"];
    let output = catchlight(folder.path(), &arguments);
    assert_eq!(output.status.code(), Some(0), "{}", stderr(&output));
    let report: Value = serde_json::from_str(stdout(&output).trim()).unwrap();
    // Without a limit the picture would have 65 536 samples; half a second is enough for some hundreds.
    assert!((1..16_384).contains(&report["spp"].as_u64().unwrap()), "{report}");
    assert!(folder.path().join("x.png").exists());
}

#[test]
fn the_zbuffer_draws_on_the_cpu_with_the_exposure_of_the_other_methods() {
    let folder = tempfile::tempdir().unwrap();
    let render =
        ["render", "three_point", "-o", "z.png", "--method", "zbuffer", "--size", "48x72", "--spp", "4", "--json"];
    let output = catchlight(folder.path(), &render);
    assert_eq!(output.status.code(), Some(0), "{}", stderr(&output));
    let report: Value = serde_json::from_str(stdout(&output).trim()).unwrap();
    assert_eq!(
        (report["method"].as_str(), report["spp"].as_u64(), report["rays"].as_u64()),
        (Some("zbuffer"), Some(4), Some(0))
    );
    let output = catchlight(folder.path(), &["preview", "three_point", "-o", "p.png", "--cpu", "--size", "48x72"]);
    assert_eq!(output.status.code(), Some(0), "{}", stderr(&output));
    let output = catchlight(
        folder.path(),
        &["render", "three_point", "-o", "d.png", "--method", "direct", "--size", "48x72", "--spp", "4"],
    );
    assert_eq!(output.status.code(), Some(0), "{}", stderr(&output));
    // The exposure is the same. Without shadows the mean of the encoded values is a little larger.
    let mean = |name: &str| {
        let bytes = image::open(folder.path().join(name)).unwrap().to_rgb8().into_raw();
        bytes.iter().map(|c| f64::from(*c)).sum::<f64>() / bytes.len() as f64
    };
    let (z, p, d) = (mean("z.png"), mean("p.png"), mean("d.png"));
    assert!((z - p).abs() < 3.0 && z / d > 0.9 && z / d < 1.3, "{z}, {p}, {d}");
    let timed =
        catchlight(folder.path(), &["preview", "three_point", "--cpu", "--frames", "2", "--size", "64x36", "--json"]);
    let times: Value = serde_json::from_str(stdout(&timed).trim()).unwrap();
    assert!(times["median_ms"].as_f64().unwrap() > 0.0 && times["triangles"].as_u64().unwrap() > 10_000);
}

#[test]
fn the_traced_preview_measures_times_to_a_first_picture_and_writes_the_finished_one() {
    let folder = tempfile::tempdir().unwrap();
    let traced = ["preview", "product_still_life", "--traced", "--size", "64x40"];
    let output = catchlight(folder.path(), &[&traced[..], &["--frames", "3", "--json"]].concat());
    assert_eq!(output.status.code(), Some(0), "{}", stderr(&output));
    let report: Value = serde_json::from_str(stdout(&output).trim()).unwrap();
    for key in ["light_moved_ms", "thing_moved_ms", "dimmed_ms", "view_turned_ms"] {
        let [median, most] = [0, 1].map(|i| report[key][i].as_f64().unwrap());
        assert!(median > 0.0 && median <= most, "{key}: {report}");
    }
    assert!(report["opened_ms"].as_f64() > Some(0.0) && report["covered_s"].as_f64() > Some(0.0), "{report}");
    assert!(report["reused"].as_f64() > Some(0.3), "a turned view reuses most of its pixels: {report}");
    let output = catchlight(folder.path(), &[&traced[..], &["-o", "t.png"]].concat());
    assert_eq!(output.status.code(), Some(0), "{}", stderr(&output));
    assert_eq!(image::open(folder.path().join("t.png")).unwrap().to_rgb8().dimensions(), (64, 40));
}

/// The values of a channel in the first part of an EXR file, by pixel.
fn exr_channel(path: &Path, name: &str) -> Option<Vec<f64>> {
    use exr::prelude::{FlatSamples, read_first_flat_layer_from_file};
    let image = read_first_flat_layer_from_file(path).unwrap();
    let channel = image.layer_data.channel_data.list.into_iter().find(|channel| channel.name.eq(name))?;
    Some(match channel.sample_data {
        FlatSamples::F32(values) => values.into_iter().map(f64::from).collect(),
        FlatSamples::U32(values) => values.into_iter().map(f64::from).collect(),
        FlatSamples::F16(values) => values.into_iter().map(|value| f64::from(value.to_f32())).collect(),
    })
}

#[test]
fn aovs_are_channels_beside_the_same_picture() {
    let folder = tempfile::tempdir().unwrap();
    let render = |name: &str, options: &[&str]| {
        let size = ["--size", "48x32", "--spp", "2"];
        catchlight(folder.path(), &[&["render", "product_still_life", "-o", name], &size[..], options].concat())
    };
    for (name, options) in [("plain.exr", &[][..]), ("aovs.exr", &["--aovs", "--layers"])] {
        let output = render(name, options);
        assert_eq!(output.status.code(), Some(0), "{}", stderr(&output));
    }
    let (plain, aovs) = (folder.path().join("plain.exr"), folder.path().join("aovs.exr"));
    for channel in ["R", "G", "B"] {
        assert_eq!(exr_channel(&plain, channel).unwrap(), exr_channel(&aovs, channel).unwrap());
    }
    let channel = |name| exr_channel(&aovs, name).unwrap_or_else(|| panic!("no channel {name}"));
    assert!(["albedo.R", "albedo.G", "albedo.B"].iter().all(|name| channel(name).iter().any(|value| *value > 0.05)));
    let [x, y, z] = ["normal.X", "normal.Y", "normal.Z"].map(channel);
    assert!(x.iter().zip(&y).zip(&z).all(|((x, y), z)| (x * x + y * y + z * z) < 1.0001));
    let (depth, id) = (channel("Z"), channel("id"));
    assert!(depth.iter().zip(&id).all(|(depth, id)| *depth > 0.0 && (depth.is_finite() || *id == 0.0)));
    assert!(id.iter().any(|id| *id >= 2.0) && exr_channel(&plain, "Z").is_none());
    // A PNG has no place for them, and a z-buffer has no paths.
    for (name, options) in [("a.png", &["--aovs"][..]), ("a.exr", &["--aovs", "--method", "zbuffer"])] {
        let output = render(name, options);
        assert_eq!(output.status.code(), Some(1));
        assert!(stderr(&output).contains("--aovs"), "{}", stderr(&output));
        assert!(!folder.path().join(name).exists());
    }
}

#[test]
fn a_pixel_is_explained_step_by_step_and_adds_up_to_the_picture() {
    let folder = tempfile::tempdir().unwrap();
    let size = ["render", "product_still_life", "--size", "24x16", "--spp", "1", "--seed", "3"];
    let output = catchlight(folder.path(), &[&size[..], &["-o", "a.exr"]].concat());
    assert_eq!(output.status.code(), Some(0), "{}", stderr(&output));
    let explain = |options: &[&str]| catchlight(folder.path(), &[&size[..], options].concat());
    let text = stdout(&explain(&["--explain-pixel", "12,9"]));
    for word in ["pixel 12,9, sample 0, the brightest of 1, seed 3", "camera ray", "vertex 0:", "BSDF sample", "pmf"] {
        assert!(text.contains(word), "no {word:?} in\n{text}");
    }
    let json = stdout(&explain(&["--explain-pixel", "12,9", "--sample", "0", "--json"]));
    let report: Value = serde_json::from_str(json.trim()).unwrap();
    assert!(report["events"].as_array().unwrap().len() > 3);
    for (index, name) in ["R", "G", "B"].into_iter().enumerate() {
        let film = exr_channel(&folder.path().join("a.exr"), name).unwrap()[9 * 24 + 12];
        assert_eq!(report["value"][index].as_f64().unwrap() as f32, film as f32, "{name}");
    }
    for (options, word) in [
        (&["--explain-pixel", "24,0"][..], "24x16"),
        (&["--explain-pixel", "1,1", "--sample", "1"], "sample 1"),
        (&["--explain-pixel", "1"], "such as"),
        (&["--sample", "1"], "--explain-pixel"),
    ] {
        let output = explain(options);
        assert_eq!(output.status.code(), Some(1), "{options:?}");
        assert!(stderr(&output).contains(word), "{options:?}: {}", stderr(&output));
    }
}

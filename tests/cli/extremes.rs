//! Arguments and files at the ends of what they may be.

use super::{Path, catchlight, stderr, stdout};

/// Renders a few pixels with other options.
fn render(folder: &Path, options: &[&str]) -> std::process::Output {
    let few = ["render", "split", "-o", "x.png", "--size", "8x8", "--spp", "2", "--json"];
    catchlight(folder, &[&few[..], options].concat())
}

#[test]
fn a_time_limit_of_ages_is_no_limit() {
    let folder = tempfile::tempdir().unwrap();
    for seconds in ["1e9", "1e19", "1e20", "1e308"] {
        let output = render(folder.path(), &["--time", seconds]);
        assert_eq!(output.status.code(), Some(0), "{seconds}: {}", stderr(&output));
    }
    let refused = render(folder.path(), &["--time", "1e309"]);
    assert!(stderr(&refused).contains("1e309 is too large"), "{}", stderr(&refused));
    assert!(stderr(&render(folder.path(), &["--time", "0"])).contains("must be more than 0, not 0"));
}

#[test]
fn a_thousand_threads_on_a_few_pixels_do_not_wait_for_each_other() {
    let folder = tempfile::tempdir().unwrap();
    let output = render(folder.path(), &["--threads", "1024"]);
    assert_eq!(output.status.code(), Some(0), "{}", stderr(&output));
    let report: serde_json::Value = serde_json::from_str(stdout(&output).trim()).unwrap();
    let used = report["threads"].as_u64().unwrap();
    let cores = std::thread::available_parallelism().unwrap().get() as u64;
    assert_eq!(used, 1024.min(16.max(4 * cores)));
    if used < 1024 {
        assert!(stderr(&output).contains(&format!("1024 threads are too many for {cores} cores; {used} are used")));
    }
}

#[test]
fn ten_thousand_equal_warnings_and_a_name_of_ten_megabytes_are_short_messages() {
    let folder = tempfile::tempdir().unwrap();
    let light = "(name: \"Key\", role: Key, position: (0.0, 2.0, 0.0), aim: Angles(yaw_deg: 0.0, pitch_deg: -90.0), \
                 emitter: Sphere(radius_m: 0.1), power: (output: Lumens(100.0)), color: Kelvin(5500.0)),";
    let empty = catchlight::io::write_scene(&catchlight::scene::Scene::default());
    let with_lights = |lights: String| empty.replacen("lights: []", &format!("lights: [{lights}]"), 1);
    std::fs::write(folder.path().join("many.ron"), with_lights(light.repeat(2_000))).unwrap();
    let output = catchlight(folder.path(), &["check", "many.ron"]);
    let printed = stderr(&output);
    assert!(printed.contains("; and 1998 more like this") && printed.lines().count() < 30, "{printed}");
    let long = with_lights(light.replace("\"Key\"", &format!("\"{}\"", "K".repeat(10_000_000))));
    std::fs::write(folder.path().join("long.ron"), long).unwrap();
    let output = catchlight(folder.path(), &["check", "long.ron"]);
    assert_eq!(output.status.code(), Some(1));
    assert!(stderr(&output).contains("10000000 characters are too many"), "{} bytes", output.stderr.len());
    assert!(output.stderr.len() < 1000, "{} bytes", output.stderr.len());
}

#[test]
fn the_reason_why_a_file_cannot_be_read_is_printed_once_and_in_words() {
    let folder = tempfile::tempdir().unwrap();
    let output = catchlight(folder.path(), &["check", "nowhere.ron"]);
    let message = "catchlight: can't read the studio: there is no such file: nowhere.ron\n";
    assert_eq!(stderr(&output), message);
    let output = catchlight(folder.path(), &["chart", "--traversal", "nowhere.obj"]);
    assert!(!stderr(&output).contains("os error"), "{}", stderr(&output));
}

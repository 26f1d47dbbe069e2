//! `catchlight chart` as a process: its files are complete, and its errors rank the methods.

use catchlight::scene::{HairStyle, Shape};
use serde_json::Value;
use std::path::Path;
use std::process::{Command, Output};

fn chart(folder: &Path, arguments: &[&str]) -> Output {
    Command::new(env!("CARGO_BIN_EXE_catchlight")).current_dir(folder).arg("chart").args(arguments).output().unwrap()
}

fn json(output: &Output) -> Vec<Value> {
    assert_eq!(output.status.code(), Some(0), "{}", String::from_utf8_lossy(&output.stderr));
    serde_json::from_slice(&output.stdout).unwrap()
}

#[test]
fn the_path_tracer_converges_and_the_other_methods_keep_their_bias() {
    let folder = tempfile::tempdir().unwrap();
    // Hair is noisy: it would hide the bias of the other methods.
    let mut scene = catchlight::io::find_preset("three_point").unwrap().scene().unwrap();
    for object in &mut scene.objects {
        if let Shape::Figure(figure) = &mut object.shape {
            figure.hair = HairStyle::Bald;
        }
    }
    std::fs::write(folder.path().join("three_point.ron"), catchlight::io::write_scene(&scene)).unwrap();
    let arguments = ["three_point.ron", "-o", "out", "--size", "24x16", "--spp", "64", "--json"];
    let rows = json(&chart(folder.path(), &arguments));
    let error = |method: &str, spp: u64| {
        let row = rows.iter().find(|row| row["method"] == method && row["spp"] == spp).unwrap();
        assert!(row["trace_s"].as_f64().unwrap() > 0.0);
        // The z-buffer traces no rays.
        assert_eq!(row["mrays_s"].as_f64().unwrap() > 0.0, method != "zbuffer", "{row}");
        row["rel_mse"].as_f64().unwrap()
    };
    // So many times the samples have that part of the squared error or less; a fifth of it allows for the seed.
    assert!(error("path", 16) < error("path", 1) / 3.0);
    assert!(error("path", 64) < error("path", 1) / 12.0);
    // Few samples are worth more after the denoiser.
    assert!(error("path + denoiser", 1) < 0.7 * error("path", 1));
    // Samples do not reduce the bias of the other methods; the z-buffer takes no more of them.
    for (method, spp) in [("zbuffer", 16), ("whitted", 64), ("direct", 64)] {
        assert!(error(method, spp) > 4.0 * error("path", 64), "{method}");
    }
    let read = |name: &str| std::fs::read_to_string(folder.path().join("out").join(name)).unwrap();
    assert_eq!(read("chart.csv").lines().count(), rows.len() + 1);
    assert_eq!(read("chart.md").lines().count(), rows.len() + 2);
    let drawing = read("three_point.svg");
    assert!(drawing.starts_with("<svg") && drawing.trim_end().ends_with("</svg>") && drawing.contains("whitted"));
}

/// Writes a model of a unit square in the XY plane and a triangle behind it, and a ray file.
fn square(folder: &Path) {
    let model = "o a\nv 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nf 1 2 3\no b\nv 0 0 -1\nv 1 1 -1\nv 0 1 -1\nf 5 6 7\n";
    std::fs::write(folder.join("square.obj"), model).unwrap();
    let rays: [[f32; 6]; 4] = [
        [0.7, 0.2, 2.0, 0.0, 0.0, -1.0],
        [0.2, 0.7, 2.0, 0.0, 0.0, -2.0],
        [0.2, 0.7, 2.0, 0.0, 0.0, 1.0],
        [5.0, 0.7, 2.0, 0.0, 0.0, -1.0],
    ];
    std::fs::write(
        folder.join("rays.bin"),
        rays.as_flattened().iter().flat_map(|x| x.to_le_bytes()).collect::<Vec<u8>>(),
    )
    .unwrap();
}

#[test]
fn all_intersection_methods_find_the_same_hits_for_rays_from_a_file() {
    let folder = tempfile::tempdir().unwrap();
    square(folder.path());
    let rows = json(&chart(folder.path(), &["--traversal", "square.obj", "--rays", "rays.bin", "--json"]));
    let cores = std::thread::available_parallelism().unwrap().get();
    assert_eq!(rows.len(), 4 * cores, "one row per method and number of threads");
    for row in &rows {
        // The first ray hits the near square at t = 2. The second, of twice the length, hits the far triangle at 1.5.
        assert_eq!(row["hits"], 2, "{row}");
        assert!((row["mean_t"].as_f64().unwrap() - 1.75).abs() < 1e-6, "{row}");
        assert!(row["build_s"].as_f64().is_some() && row["mrays_s"].as_f64().unwrap() > 0.0);
    }
    assert_eq!(rows.iter().filter(|row| row["method"] == "bvh").count(), cores);
}

#[test]
fn invalid_rays_and_missing_files_are_errors_with_a_reason() {
    let folder = tempfile::tempdir().unwrap();
    square(folder.path());
    std::fs::write(folder.path().join("short.bin"), [0; 23]).unwrap();
    let nan = [f32::NAN; 6].map(f32::to_le_bytes).concat();
    std::fs::write(folder.path().join("nan.bin"), nan).unwrap();
    for (arguments, complaint) in [
        (&["--traversal", "square.obj", "--rays", "short.bin"][..], "23 bytes"),
        (&["--traversal", "square.obj", "--rays", "nan.bin"], "ray 0"),
        (&["--traversal", "square.obj", "--rays", "none.bin"], "none.bin"),
        (&["--traversal", "none.obj"], "none.obj"),
        (&["three_point"], "--output"),
        (&["no_such_studio", "-o", "out"], "no_such_studio"),
    ] {
        let output = chart(folder.path(), arguments);
        let stderr = String::from_utf8_lossy(&output.stderr);
        assert_eq!(output.status.code(), Some(1), "{arguments:?}: {stderr}");
        assert!(stderr.contains(complaint), "{arguments:?}: {stderr}");
    }
}

#[test]
fn scaling_reports_one_row_per_number_of_triangles_lights_pixels_and_threads() {
    let folder = tempfile::tempdir().unwrap();
    let few = "--scaling --triangles 2000,8000 --lights 1,9 --sizes 32x24,64x48 --threads 1,3 --json";
    let rows = json(&chart(folder.path(), &few.split(' ').collect::<Vec<_>>()));
    let column = |varies: &str, key: &str| -> Vec<f64> {
        rows.iter().filter(|row| row["varies"] == varies).map(|row| row[key].as_f64().unwrap()).collect()
    };
    assert_eq!(column("lights", "lights"), [1.0, 9.0]);
    assert_eq!(column("pixels", "paths"), [768.0, 3072.0]);
    let triangles = column("triangles", "triangles");
    assert!(triangles[1] - triangles[0] > 5000.0, "{triangles:?}");
    // Efficiency compares with the first number of threads
    let (threads, efficiency, trace_s) =
        (column("threads", "count"), column("threads", "efficiency"), column("threads", "trace_s"));
    assert_eq!((threads, efficiency[0]), (vec![1.0, 3.0], 1.0));
    assert!((efficiency[1] - trace_s[0] / (3.0 * trace_s[1])).abs() < 1e-9, "{efficiency:?} {trace_s:?}");
    assert!(rows.iter().all(|row| row["trace_s"].as_f64().unwrap() > 0.0 && row["prepare_s"].as_f64().unwrap() > 0.0));
}

#[test]
fn the_noise_study_compares_stated_noise_with_its_scatter() {
    let folder = tempfile::tempdir().unwrap();
    let rows = json(&chart(folder.path(), &["--noise", "rembrandt", "--size", "32x24", "--spp", "8", "--json"]));
    assert_eq!(rows.iter().map(|row| row["spp"].as_u64().unwrap()).collect::<Vec<_>>(), [4, 8]);
    for row in &rows {
        let [scatter, ratio] = ["scatter", "ratio"].map(|key| row[key].as_f64().unwrap());
        // A fifth of a stop or less, stated about right: 768 pixels, some of which hold most of the scatter.
        assert!(scatter > 0.01 && scatter < 0.5 && ratio > 0.6 && ratio < 1.5, "{row}");
    }
    assert!(rows[1]["scatter"].as_f64() < rows[0]["scatter"].as_f64());
}

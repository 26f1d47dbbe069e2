//! Pictures that are rendered in parts, by several processes, and merged.

#[cfg(unix)]
use super::is_installed;
use super::running_render::RunningRender;
use super::{catchlight, exr_channel, stderr, stdout};
use serde_json::Value;
use std::path::Path;
use std::process::{Child, Command, Stdio};

/// A studio with caustics from photons.
const RENDER: [&str; 8] = ["render", "product_still_life", "--size", "60x40", "--spp", "24", "--seed", "7"];
const CHANNELS: [&str; 9] = ["R", "G", "B", "albedo.R", "albedo.G", "normal.X", "normal.Y", "Z", "id"];

/// Starts the render of a part.
fn start(folder: &Path, samples: &str, output: &str, threads: &str) -> Child {
    let mut program = Command::new(env!("CARGO_BIN_EXE_catchlight"));
    let part = ["--samples", samples, "-o", output, "--threads", threads, "--aovs"];
    program.current_dir(folder).args(RENDER).args(part).stderr(Stdio::null()).spawn().unwrap()
}

fn render(folder: &Path, samples: &str, output: &str) {
    assert!(start(folder, samples, output, "2").wait().unwrap().success(), "{samples}");
}

/// Merges parts; returns the report.
fn merge(folder: &Path, parts: &[&str], output: &str) -> Value {
    let merged = catchlight(folder, &[&["merge", "-o", output, "--json"], parts].concat());
    assert_eq!(merged.status.code(), Some(0), "{}", stderr(&merged));
    serde_json::from_str(stdout(&merged).trim()).unwrap()
}

/// Fails to merge parts; returns the message.
fn refused(folder: &Path, parts: &[&str]) -> String {
    let merged = catchlight(folder, &[&["merge", "-o", "refused.exr"], parts].concat());
    assert_eq!(merged.status.code(), Some(1), "{}", stderr(&merged));
    assert!(!folder.join("refused.exr").exists());
    stderr(&merged)
}

fn assert_same_picture(folder: &Path, a: &str, b: &str) {
    for channel in CHANNELS {
        let values = |name: &str| exr_channel(&folder.join(name), channel).unwrap();
        assert!(values(a) == values(b), "{channel} of {a} and {b}");
    }
}

#[test]
fn a_picture_of_parts_by_several_processes_is_that_of_one_process_to_the_bit() {
    let folder = tempfile::tempdir().unwrap();
    let folder = folder.path();
    render(folder, "0..24", "one.exr");
    merge(folder, &["one.exr"], "single.exr");
    // Four processes at once; ranges cut passes of photons in two.
    let ranges = [("0..5", "a.exr"), ("5..12", "b.exr"), ("12..13", "c.exr"), ("13..24", "d.exr")];
    let mut processes = ranges.map(|(samples, output)| start(folder, samples, output, "1"));
    processes.iter_mut().for_each(|process| assert!(process.wait().unwrap().success()));
    let report = merge(folder, &["d.exr", "b.exr", "a.exr", "c.exr"], "merged.exr");
    assert_eq!((&report["samples"], &report["of"], &report["parts"]), (&24.into(), &24.into(), &4.into()));
    assert!(report["noise_stops"].as_f64().is_some_and(|noise| noise > 0.0 && noise < 2.0), "{report}");
    assert_same_picture(folder, "merged.exr", "single.exr");
    // An ordinary render of the same samples adds them as floats of 24 bits.
    let whole = catchlight(folder, &[&RENDER[..], &["-o", "whole.exr", "--aovs", "--layers"]].concat());
    assert_eq!(whole.status.code(), Some(0), "{}", stderr(&whole));
    let values = |name: &str, channel: &str| exr_channel(&folder.join(name), channel).unwrap();
    for channel in ["R", "G", "B"] {
        let (merged, whole) = (values("merged.exr", channel), values("whole.exr", channel));
        let off = |(a, b): (&f64, &f64)| (a - b).abs() / a.max(*b).max(1e-4);
        let worst = merged.iter().zip(&whole).map(off).fold(0.0, f64::max);
        // 24 samples of some ten contributions, each rounded once.
        assert!(worst < 240.0 * f64::from(f32::EPSILON), "{channel}: {worst}");
    }
    assert!(
        values("merged.exr", "Z") == values("whole.exr", "Z")
            && values("merged.exr", "id") == values("whole.exr", "id")
    );
    merge(folder, &["a.exr", "b.exr", "c.exr", "d.exr", "--layers"], "layers.exr");
    let parts = |name: &str| exr::meta::MetaData::read_from_file(folder.join(name), false).unwrap().headers.len();
    assert_eq!(parts("layers.exr"), parts("whole.exr"));
    merge(folder, &["a.exr", "b.exr", "c.exr", "d.exr"], "shown.png");
    assert_eq!(image::open(folder.join("shown.png")).unwrap().to_rgb8().dimensions(), (60, 40));
}

#[cfg(unix)]
#[test]
fn a_part_that_is_killed_is_rendered_again_and_completes_the_same_picture() {
    let folder = tempfile::tempdir().unwrap();
    let folder = folder.path();
    let options = |samples| ["--spp", "4000", "--samples", samples];
    let program = || Command::new(env!("CARGO_BIN_EXE_catchlight"));
    // Long enough to be killed on the way.
    let render = RunningRender::start(program(), folder, "b.exr", &options("20..4000"));
    render.send("-KILL");
    assert_eq!(render.end().0, None);
    assert_eq!(std::fs::read_dir(folder).unwrap().count(), 0, "a killed part leaves no torn file");
    // A scheduler's cancel keeps what there is, as a part of fewer samples, and says so.
    let render = RunningRender::start(program(), folder, "b.exr", &options("20..4000"));
    render.send("-TERM");
    let (code, message) = render.end();
    assert_eq!(code, Some(130));
    let (_, end) = message.split_once("has the samples 20..").unwrap();
    let end: u32 = end.split(',').next().unwrap().parse().unwrap();
    let part = |samples: &str, output| {
        let arguments = ["render", "split", "-o", output, "--size", "64x96", "--spp", "4000", "--samples", samples];
        let output = catchlight(folder, &arguments);
        assert_eq!(output.status.code(), Some(0), "{}", stderr(&output));
    };
    part("0..20", "a.exr");
    let message = refused(folder, &["a.exr", "b.exr"]);
    assert!(message.contains(&format!("{end}..4000 are missing")), "{message}");
    part(&format!("20..{end}"), "again.exr");
    for (second, output) in [("b.exr", "kept.exr"), ("again.exr", "retried.exr")] {
        assert_eq!(merge(folder, &["a.exr", second, "--incomplete"], output)["samples"], end);
    }
    for channel in ["R", "G", "B"] {
        let values = |name: &str| exr_channel(&folder.join(name), channel).unwrap();
        assert!(values("kept.exr") == values("retried.exr"), "{channel}");
    }
}

#[test]
fn parts_that_do_not_belong_together_are_refused_in_words() {
    let folder = tempfile::tempdir().unwrap();
    let folder = folder.path();
    render(folder, "0..4", "a.exr");
    render(folder, "2..6", "overlapping.exr");
    let message = refused(folder, &["a.exr", "overlapping.exr"]);
    assert!(message.contains("two parts have the same samples: 0..4 and 2..6"), "{message}");
    assert!(refused(folder, &["a.exr", "a.exr"]).contains("the same samples"));
    assert!(refused(folder, &["a.exr"]).contains("of the samples 0..24, 4..24 are missing"));
    for (other, value) in [("--seed", "8"), ("--spp", "25"), ("--size", "40x60"), ("--caustics", "paths")] {
        let mut arguments = vec!["render", "product_still_life", "-o", "other.exr", "--samples", "4..6"];
        let (pairs, _) = RENDER[2..].as_chunks::<2>();
        pairs.iter().filter(|pair| pair[0] != other).for_each(|pair| arguments.extend(pair));
        arguments.extend([other, value]);
        assert_eq!(catchlight(folder, &arguments).status.code(), Some(0));
        let message = refused(folder, &["a.exr", "other.exr"]);
        assert!(message.contains("of other settings"), "{other}: {message}");
    }
    let picture = catchlight(folder, &["render", "split", "-o", "p.exr", "--size", "8x8", "--spp", "1"]);
    assert_eq!(picture.status.code(), Some(0));
    assert!(refused(folder, &["a.exr", "p.exr"]).contains("no part of a picture"));
    assert!(refused(folder, &["a.exr", "none.exr"]).contains("no such file"));
}

#[test]
fn options_that_a_part_cannot_have_are_refused_with_the_reason() {
    let folder = tempfile::tempdir().unwrap();
    let cases: [(&[&str], &str); 9] = [
        (&["--noise", "0.1"], "--noise and --time"),
        (&["--time", "1"], "--noise and --time"),
        (&["--layers"], "to merge"),
        (&["--resume"], "no checkpoints"),
        (&["--method", "zbuffer"], "no samples to divide"),
        (&["--spp", "8"], "0..8 (--spp)"),
        (&["--samples", "4..4"], "has no sample"),
        (&["--samples", "4-8"], "write A..B"),
        (&["-o", "p.png"], ".exr"),
    ];
    for (options, reason) in cases {
        let mut arguments = vec!["render", "split"];
        if !options.contains(&"-o") {
            arguments.extend(["-o", "p.exr"]);
        }
        if !options.contains(&"--samples") {
            arguments.extend(["--samples", "4..10"]);
        }
        arguments.extend(options);
        let output = catchlight(folder.path(), &arguments);
        assert_eq!(output.status.code(), Some(1), "{options:?}");
        assert!(stderr(&output).contains(reason), "{options:?}: {}", stderr(&output));
    }
    assert_eq!(std::fs::read_dir(folder.path()).unwrap().count(), 0);
}

#[test]
fn progress_is_printed_in_lines_for_the_program_that_asked() {
    let folder = tempfile::tempdir().unwrap();
    let progress = |style: &str| {
        let arguments = ["-o", "p.png", "--progress", style];
        let output = catchlight(folder.path(), &[&RENDER[..], &arguments].concat());
        assert_eq!(output.status.code(), Some(0), "{}", stderr(&output));
        stderr(&output)
    };
    let lines = progress("lines");
    let values: Vec<Value> =
        lines.lines().filter(|line| line.starts_with('{')).map(|line| serde_json::from_str(line).unwrap()).collect();
    let percents: Vec<u64> = values.iter().map(|value| value["percent"].as_u64().unwrap()).collect();
    assert!(percents.is_sorted() && percents.last() == Some(&100), "{lines}");
    let openjd = progress("openjd");
    assert!(openjd.contains("openjd_progress: 100\nopenjd_status: 24 samples a pixel"), "{openjd}");
}

/// Returns a program that renders as Catchlight does, but is killed on its way through one part, once.
#[cfg(unix)]
fn killed_once(folder: &Path, samples: &str) -> std::path::PathBuf {
    use std::os::unix::fs::PermissionsExt;
    let (script, catchlight) = (folder.join("flaky"), env!("CARGO_BIN_EXE_catchlight"));
    let killed = folder.join("killed");
    let text = format!(
        "#!/bin/sh\ncase \"$*\" in *'--samples {samples}'*)\n  if mkdir '{}'; then\n    '{catchlight}' \"$@\" &\n    \
         sleep 0.05; kill -KILL $!; wait $!; exit $?\n  fi;;\nesac\nexec '{catchlight}' \"$@\"\n",
        killed.display()
    );
    std::fs::write(&script, text).unwrap();
    std::fs::set_permissions(&script, std::fs::Permissions::from_mode(0o755)).unwrap();
    script
}

/// Runs a job twice: the first run loses a part, the second completes the picture of a single part.
#[cfg(unix)]
fn assert_completes_after_a_loss(folder: &Path, job: &dyn Fn() -> Command) {
    let output = job().current_dir(folder).output().unwrap();
    assert!(!output.status.success(), "{}", stdout(&output));
    assert!(folder.join("killed").exists() && !folder.join("picture.exr").exists());
    let output = job().current_dir(folder).output().unwrap();
    assert!(output.status.success(), "{}{}", stdout(&output), stderr(&output));
    render(folder, "0..24", "one.exr");
    merge(folder, &["one.exr"], "single.exr");
    assert_same_picture(folder, "picture.exr", "single.exr");
}

/// Options that the parts share with [`RENDER`].
#[cfg(unix)]
const OPTIONS: [&str; 5] = ["--size", "60x40", "--seed", "7", "--aovs"];

#[cfg(unix)]
#[test]
fn the_slurm_script_renders_the_missing_parts_when_it_is_run_again() {
    let folder = tempfile::tempdir().unwrap();
    let flaky = killed_once(folder.path(), "8..16");
    let script = Path::new(env!("CARGO_MANIFEST_DIR")).join("farm/slurm.sh");
    assert_completes_after_a_loss(folder.path(), &|| {
        // Without sbatch it works on this machine.
        let mut job = Command::new("bash");
        job.arg(&script).args(["product_still_life", "picture.exr", "24", "3"]).args(OPTIONS);
        job.env("CATCHLIGHT", &flaky).env("CATCHLIGHT_SBATCH", "none");
        job
    });
}

#[cfg(unix)]
#[test]
fn the_job_for_open_job_description_completes_the_picture_after_a_killed_part() {
    if !is_installed("openjd") {
        return;
    }
    let folder = tempfile::tempdir().unwrap();
    let flaky = killed_once(folder.path(), "8..16");
    let template = Path::new(env!("CARGO_MANIFEST_DIR")).join("farm/render.openjd.yaml");
    assert_completes_after_a_loss(folder.path(), &|| {
        let picture = folder.path().join("picture.exr");
        let parameters = [
            "Studio=product_still_life".to_owned(),
            format!("Picture={}", picture.display()),
            "Spp=24".to_owned(),
            "Parts=3".to_owned(),
            format!("Options={}", OPTIONS.join(" ")),
            format!("Catchlight={}", flaky.display()),
        ];
        let mut job = Command::new("openjd");
        job.arg("run").arg(&template).args(["--step", "Merge", "--run-dependencies"]);
        for parameter in &parameters {
            job.args(["-p", parameter]);
        }
        job
    });
}

#[cfg(unix)]
#[test]
fn the_series_for_open_job_description_renders_studios_and_variants_and_completes_after_a_killed_part() {
    if !is_installed("openjd") {
        return;
    }
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path();
    let mut scene = catchlight::io::find_preset("product_still_life").unwrap().scene().unwrap();
    scene.add_variant("Dim".to_owned()).unwrap();
    scene.lights.iter_mut().for_each(|light| light.power.dial_stops -= 1.0);
    catchlight::io::save_scene(&scene, &path.join("still.ron")).unwrap();
    let series = "# a comment\na.exr still.ron --size 36x24\n\ndim.exr still.ron --size 36x24 --variant Dim\n";
    std::fs::write(path.join("series.txt"), series).unwrap();
    let flaky = killed_once(path, "4..8");
    let template = Path::new(env!("CARGO_MANIFEST_DIR")).join("farm/series.openjd.yaml");
    let run = || {
        let mut job = Command::new("openjd");
        job.arg("run").arg(&template).args(["--step", "Merge", "--run-dependencies"]);
        let (series, pictures) = (path.join("series.txt"), path.join("pictures"));
        let paths = [format!("Series={}", series.display()), format!("Folder={}", pictures.display())];
        let counts = ["Pictures=2", "Spp=8", "Parts=2"].map(str::to_owned);
        for parameter in paths.into_iter().chain(counts).chain([format!("Catchlight={}", flaky.display())]) {
            job.args(["-p", &parameter]);
        }
        job.current_dir(path).output().unwrap()
    };
    let first = run();
    assert!(!first.status.success() && path.join("killed").exists(), "{}", stdout(&first));
    let second = run();
    assert!(second.status.success(), "{}{}", stdout(&second), stderr(&second));
    let sum = |name: &str| exr_channel(&path.join("pictures").join(name), "G").unwrap().iter().sum::<f64>();
    let ratio = sum("dim.exr") / sum("a.exr");
    assert!((ratio - 0.5).abs() < 1e-3, "{ratio}");
}

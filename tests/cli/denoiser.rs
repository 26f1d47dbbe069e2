//! `--denoise` of `render` and `merge`: what is denoised, what is kept noisy, and what is refused.

use super::{catchlight, exr_channel, stderr, stdout};
use serde_json::Value;
use std::path::Path;

const RENDER: [&str; 7] = ["render", "product_still_life", "--size", "60x40", "--spp", "4", "--json"];

/// Runs a command; returns its report.
fn report(folder: &Path, arguments: &[&str]) -> Value {
    let output = catchlight(folder, arguments);
    assert_eq!(output.status.code(), Some(0), "{}", stderr(&output));
    serde_json::from_str(stdout(&output).trim()).unwrap()
}

fn render(folder: &Path, more: &[&str]) -> Value {
    report(folder, &[&RENDER[..], more].concat())
}

/// Mean absolute difference between neighbours in a row, relative to the mean.
fn roughness(values: &[f64]) -> f64 {
    let steps = values.windows(2).map(|pair| (pair[1] - pair[0]).abs());
    steps.sum::<f64>() / values.iter().sum::<f64>()
}

#[test]
fn a_denoised_render_is_smooth_and_keeps_the_noisy_picture() {
    let folder = tempfile::tempdir().unwrap();
    let folder = folder.path();
    let plain = render(folder, &["-o", "plain.exr"]);
    let denoised = render(folder, &["-o", "denoised.exr", "--denoise", "on"]);
    assert!(plain["denoise_s"].is_null() && denoised["denoise_s"].as_f64().is_some_and(|seconds| seconds > 0.0));
    let values = |file: &str, channel: &str| exr_channel(&folder.join(file), channel);
    for (channel, noisy) in [("R", "noisy.R"), ("G", "noisy.G"), ("B", "noisy.B")] {
        assert!(values("denoised.exr", noisy) == values("plain.exr", channel), "the noisy picture, to the bit");
        assert_eq!(values("plain.exr", noisy), None);
    }
    let rough = |file: &str| roughness(&values(file, "G").unwrap());
    assert!(rough("denoised.exr") < 0.8 * rough("plain.exr"), "{} {}", rough("denoised.exr"), rough("plain.exr"));
    // What it was denoised by
    let [albedo, none] = ["denoised.exr", "plain.exr"].map(|file| values(file, "albedo.R"));
    assert!(albedo.is_some_and(|albedo| albedo.iter().any(|value| *value > 0.05)) && none.is_none());
    // The small network, and no network
    render(folder, &["-o", "fast.exr", "--denoise", "fast"]);
    assert!(values("fast.exr", "G") != values("denoised.exr", "G"));
    render(folder, &["-o", "off.exr", "--denoise", "off"]);
    assert!(values("off.exr", "G") == values("plain.exr", "G"));
    assert_eq!(values("off.exr", "noisy.G"), None);
}

#[test]
fn merged_parts_are_denoised_and_parts_are_not() {
    let folder = tempfile::tempdir().unwrap();
    let folder = folder.path();
    for (samples, part) in [("0..2", "a.exr"), ("2..4", "b.exr")] {
        render(folder, &["-o", part, "--samples", samples, "--denoise", "on"]);
    }
    report(folder, &["merge", "a.exr", "b.exr", "-o", "noisy.exr", "--json"]);
    let merged = report(folder, &["merge", "a.exr", "b.exr", "-o", "denoised.exr", "--denoise", "on", "--json"]);
    assert!(merged["denoise_s"].as_f64().is_some());
    let values = |file: &str, channel: &str| exr_channel(&folder.join(file), channel).unwrap();
    assert!(values("denoised.exr", "noisy.G") == values("noisy.exr", "G"), "parts hold noisy pixels");
    assert!(roughness(&values("denoised.exr", "G")) < 0.8 * roughness(&values("noisy.exr", "G")));
}

#[test]
fn pictures_without_albedo_and_normals_are_refused() {
    let folder = tempfile::tempdir().unwrap();
    let folder = folder.path();
    render(folder, &["-o", "a.exr", "--samples", "0..4"]);
    let output = catchlight(folder, &["merge", "a.exr", "-o", "b.exr", "--denoise", "on"]);
    assert_eq!(output.status.code(), Some(1));
    assert!(stderr(&output).contains("render the parts with --denoise on"), "{}", stderr(&output));
    let output = catchlight(folder, &["render", "split", "-o", "b.png", "--method", "zbuffer", "--denoise", "on"]);
    assert_eq!(output.status.code(), Some(1));
    assert!(stderr(&output).contains("--denoise"), "{}", stderr(&output));
    assert!(!folder.join("b.exr").exists() && !folder.join("b.png").exists());
}

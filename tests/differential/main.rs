//! A differential test: random small scenes, rendered by the path tracer with photons, without photons, and by a
//! brute-force tracer that shares neither code nor techniques with it (`brute_force.rs`).
//!
//! Blocks of the pictures are compared by t-tests (`comparison.rs`). All tests of a run share the false-alarm rate
//! [`FALSE_ALARM`] (Sidak's correction): 1 in 1000 that a run rejects correct code. A scene that differs is compared again,
//! with more samples, before it counts as a failure. A failure prints the seed, writes
//! the scene to `target/tmp/differential/SEED.ron` and prints the command that replays a sample of the worst pixel.
//!
//! The gate runs [`GATE_SCENES`] scenes, in less than a minute on two cores. Environment variables run more:
//!
//! ```text
//! CATCHLIGHT_DIFFERENTIAL_SCENES=500 cargo test --test differential -- --nocapture
//! CATCHLIGHT_DIFFERENTIAL_SEED=17    the first seed; with ..._SCENES=1 a single scene
//! CATCHLIGHT_DIFFERENTIAL_EFFORT=8   so many times the samples, which resolves errors 8^0.5 times as small
//! ```
#![allow(clippy::unwrap_used, clippy::panic, clippy::print_stdout)]

mod brute_force;
mod comparison;
mod reference_bsdf;
mod scenes;
#[path = "../studio/mod.rs"]
mod studio;

use brute_force::BruteForce;
use catchlight::io::{Loaded, load_scene, write_scene};
use catchlight::raytrace;
use catchlight::scene::{Assets, Material, Scene};
use comparison::{Difference, Effort, Measured, TESTS};
use std::fs;
use std::path::{Path, PathBuf};
use std::sync::{Arc, OnceLock};
use studio::statistics::{critical_z, sidak_level};

/// Scenes that the gate compares.
const GATE_SCENES: u64 = 18;

/// The samples of a scene that differs are so many times as many in a second comparison by other brute-force paths, which decides. Light
/// that one in thousands of brute-force paths finds, and none of the first ones has found, is missing in their standard
/// error too; an error of the tracer stays.
const CONFIRMATION: u32 = 8;

/// Returns the value of an environment variable.
fn variable(name: &str, default: u64) -> u64 {
    std::env::var(name).map_or(default, |text| text.parse().unwrap())
}

/// Returns a folder for scenes, with the models that they use.
fn folder(name: &str) -> PathBuf {
    let folder = Path::new(env!("CARGO_TARGET_TMPDIR")).join(name);
    fs::create_dir_all(&folder).unwrap();
    for (file, subdivisions) in scenes::BALLS {
        fs::write(folder.join(file), scenes::ball_obj(subdivisions)).unwrap();
    }
    folder
}

/// Returns the estimate of a seed's scene by brute force. The tests of a run share that of the gate's effort.
fn expected(seed: u64, scene: &Scene, assets: &Assets, effort: Effort, round: u64) -> Arc<Measured> {
    static SHARED: [OnceLock<Arc<Measured>>; GATE_SCENES as usize] = [const { OnceLock::new() }; GATE_SCENES as usize];
    let estimate = || {
        Arc::new(comparison::brute_force(&BruteForce::new(scene, assets), effort.brute_force_spp, seed + (round << 40)))
    };
    match SHARED.get(seed as usize) {
        Some(shared) if effort == Effort::GATE && round == 0 => shared.get_or_init(estimate).clone(),
        _ => estimate(),
    }
}

/// A change of a material.
type Change = fn(&mut Material);

/// The comparison of a scene.
struct Compared {
    file: PathBuf,
    /// Differences, and whether the render had photons.
    differences: Vec<(bool, Difference)>,
}

impl Compared {
    fn smallest_p(&self) -> f64 {
        self.differences.iter().map(|(_, difference)| difference.p_value).fold(1.0, f64::min)
    }
}

/// Renders the scene of a seed by all techniques; the tracer renders it with a change of its materials. The scene goes
/// through its file, so that the file shows the same. Brute force has other random numbers in each round.
fn compare(seed: u64, folder: &Path, effort: Effort, change: Change, round: u64) -> Compared {
    let file = folder.join(format!("{seed}.ron"));
    fs::write(&file, write_scene(&scenes::scene(seed))).unwrap();
    let Loaded { mut scene, assets, .. } = load_scene(&file).unwrap();
    let expected = expected(seed, &scene, &assets, effort, round);
    scene.objects.iter_mut().for_each(|object| change(&mut object.material));
    let scene = &scene;
    let mut prepared = raytrace::prepare(scene, &assets).unwrap();
    let mut differences = Vec::new();
    if prepared.plan().photons {
        let photons = comparison::compare_photons(&prepared, scene, &expected, effort);
        differences.extend(photons.into_iter().map(|difference| (true, difference)));
    }
    let paths = comparison::compare_paths(&mut prepared, scene, &expected, effort);
    differences.extend(paths.into_iter().map(|difference| (false, difference)));
    Compared { file, differences }
}

#[test]
fn random_scenes_agree_with_brute_force() {
    let first = variable("CATCHLIGHT_DIFFERENTIAL_SEED", 0);
    let count = variable("CATCHLIGHT_DIFFERENTIAL_SCENES", GATE_SCENES);
    let effort = Effort::GATE.times(variable("CATCHLIGHT_DIFFERENTIAL_EFFORT", 1) as u32);
    let tests = count as usize * 2 * TESTS;
    let (level, critical) = (sidak_level(tests), critical_z(tests));
    let folder = folder("differential");
    let mut failures = Vec::new();
    let (mut resolutions, mut tested) = (Vec::new(), 0);
    for seed in first..first + count {
        let mut compared = compare(seed, &folder, effort, |_| (), 0);
        if compared.smallest_p() < level {
            println!(
                "seed {seed}: p {:.1e}; compared again with {CONFIRMATION} times the samples",
                compared.smallest_p()
            );
            compared = compare(seed, &folder, effort.times(CONFIRMATION), |_| (), 1);
        }
        let smallest = compared.smallest_p();
        let Compared { file, mut differences } = compared;
        tested += differences.len();
        let whole = || differences.iter().filter(|(_, difference)| difference.region == 0);
        let found = whole().map(|(_, difference)| difference.resolution(critical)).fold(f64::INFINITY, f64::min);
        resolutions.push(found);
        let relative: Vec<String> =
            whole().map(|(_, difference)| format!("{:+.2}", 100.0 * difference.relative())).collect();
        println!(
            "seed {seed}, {:?}: {} % of the whole picture, where {:.2} % would be found; smallest p of {} {smallest:.1e}",
            scenes::kind(seed),
            relative.join(" "),
            100.0 * found,
            differences.len()
        );
        differences.retain(|(_, difference)| difference.p_value < level);
        differences.sort_by(|a, b| a.1.p_value.total_cmp(&b.1.p_value));
        if differences.is_empty() {
            fs::remove_file(&file).unwrap();
            continue;
        }
        for (with_photons, difference) in differences.iter().take(3) {
            let technique = if *with_photons { "with photons" } else { "without photons" };
            let report = difference.report(&file.display().to_string(), *with_photons, effort);
            let failure = format!("seed {seed}, {:?}, {technique}, {report}", scenes::kind(seed));
            println!("{failure}");
            failures.push(failure);
        }
    }
    resolutions.sort_by(f64::total_cmp);
    let typical = resolutions[resolutions.len() / 2];
    println!("{tested} tests; errors of {:.2} % of a whole picture are found in half of the scenes", 100.0 * typical);
    assert!(failures.is_empty(), "{} differences from brute force:\n{}", failures.len(), failures.join("\n"));
}

#[test]
fn surfaces_that_are_three_percent_too_dark_are_found() {
    let folder = folder("differential_errors");
    let level = sidak_level(GATE_SCENES as usize * 2 * TESTS);
    let darker = |material: &mut Material| material.base_color = material.base_color.map(|channel| 0.97 * channel);
    const CASES: u64 = 6;
    let smallest: Vec<f64> =
        (0..CASES).map(|seed| compare(seed, &folder, Effort::GATE, darker, 0).smallest_p()).collect();
    println!("smallest p of scenes with dark surfaces: {smallest:?}");
    let found = smallest.iter().filter(|p| **p < level).count();
    assert!(2 * found >= CASES as usize, "found in {found} of {CASES} scenes: {smallest:?}");
}

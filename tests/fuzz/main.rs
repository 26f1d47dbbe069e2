//! Files changed at random, and a soak of the editor: nothing panics, hangs or eats memory.
//!
//! `cargo test --test fuzz` works for some seconds. `CATCHLIGHT_FUZZ_SECONDS=600 cargo test --release --test fuzz` gives
//! each kind of file, and the soak, so many. Runs differ; a failure is written to `target/tmp/fuzz/KIND-SEED`. Put it into
//! `tests/fuzz/corpus/KIND/` as well: every run begins with the files there.
#![allow(clippy::unwrap_used, clippy::panic, reason = "a test that cannot go on says so by panicking")]

mod files;
mod mutate;
#[cfg(feature = "gui")]
mod soak;

use mutate::Random;
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::path::{Path, PathBuf};
use std::time::{Duration, Instant, SystemTime, UNIX_EPOCH};

/// Longest time that one input may take. It is far more than any takes: the machine may be busy.
const PATIENCE: Duration = Duration::from_secs(20);

/// Returns the time for each kind of file, and for the soak.
fn budget() -> Duration {
    let seconds = std::env::var("CATCHLIGHT_FUZZ_SECONDS").ok();
    Duration::from_secs_f64(seconds.map_or(1.5, |seconds| seconds.parse().unwrap()))
}

/// Returns a seed that differs from run to run, or the one of CATCHLIGHT_FUZZ_SEED.
fn first_seed() -> u64 {
    let now = || SystemTime::now().duration_since(UNIX_EPOCH).unwrap().as_nanos() as u64;
    std::env::var("CATCHLIGHT_FUZZ_SEED").ok().map_or_else(now, |seed| seed.parse().unwrap())
}

/// Returns the most memory that the process has had so far, bytes; 0 where the system does not tell.
fn peak_memory() -> u64 {
    let status = std::fs::read_to_string("/proc/self/status").unwrap_or_default();
    let peak = status.lines().find_map(|line| line.strip_prefix("VmHWM:"));
    peak.and_then(|peak| peak.trim().split(' ').next()?.parse::<u64>().ok()).unwrap_or(0) * 1024
}

/// The files of former failures.
fn stored_inputs(kind: &str) -> Vec<Vec<u8>> {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/fuzz/corpus").join(kind);
    let Ok(entries) = std::fs::read_dir(folder) else { return Vec::new() };
    entries.map(|entry| std::fs::read(entry.unwrap().path()).unwrap()).collect()
}

fn keep_failure(kind: &str, seed: u64, input: &[u8]) -> PathBuf {
    let folder = Path::new(env!("CARGO_TARGET_TMPDIR")).join("fuzz");
    std::fs::create_dir_all(&folder).unwrap();
    let path = folder.join(format!("{kind}-{seed}"));
    std::fs::write(&path, input).unwrap();
    path
}

/// Feeds `read` with stored failures, then with changes of `corpus` until the time is over. `read` returns true if it
/// took an input, and panics if something is wrong with it.
#[expect(clippy::print_stdout, reason = "a long run tells how far it came")]
fn fuzz(kind: &str, corpus: &[Vec<u8>], words: &[&str], read: impl Fn(&[u8]) -> bool) {
    let (started, budget, first_seed) = (Instant::now(), budget(), first_seed());
    let run = |seed: u64, input: &[u8]| {
        let began = Instant::now();
        let taken = catch_unwind(AssertUnwindSafe(|| read(input)));
        let (is_slow, memory) = (began.elapsed() > PATIENCE, peak_memory());
        let is_large = memory > 6_000_000_000;
        if taken.is_err() || is_slow || is_large {
            let file = keep_failure(kind, seed, input);
            let took = began.elapsed().as_secs_f64();
            panic!("{kind}, CATCHLIGHT_FUZZ_SEED={seed}: {took:.1} s, {memory} bytes, input: {}", file.display());
        }
        taken.unwrap_or(false)
    };
    for input in stored_inputs(kind) {
        run(0, &input);
    }
    assert!(corpus.iter().all(|input| run(0, input)), "{kind}: an unchanged file is refused");
    let (mut count, mut taken) = (0_u64, 0_u64);
    while started.elapsed() < budget {
        let seed = first_seed.wrapping_add(count);
        let mut random = Random::new(seed);
        let input = mutate::changed(&mut random, corpus, words);
        taken += u64::from(run(seed, &input));
        count += 1;
    }
    println!("{kind}: {count} inputs, {taken} of them taken");
}

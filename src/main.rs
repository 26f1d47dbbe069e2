//! Catchlight's command line and window. All the work is in the library.

use std::process::ExitCode;

fn main() -> ExitCode {
    let started = std::time::Instant::now();
    env_logger::Builder::from_env(env_logger::Env::default().default_filter_or("off")).init();
    catchlight::cli::run(started)
}

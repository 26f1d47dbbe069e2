//! `catchlight bake-mannequins -o DIR`: bakes the figures in `assets/mannequins`. A hidden command for developers.

use super::failure::Failure;
use super::terminal;
use crate::figures;
use std::path::PathBuf;

/// Arguments of `bake-mannequins`.
#[derive(Debug, clap::Args)]
pub struct Arguments {
    /// Folder for the OBJ files.
    #[arg(short, long)]
    output: PathBuf,
}

/// Bakes every figure and prints the file names.
pub fn run(arguments: &Arguments) -> Result<(), Failure> {
    for name in figures::bake(&arguments.output)? {
        terminal::result(name);
    }
    Ok(())
}

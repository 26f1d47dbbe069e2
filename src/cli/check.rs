//! `catchlight check SCENE`: reports what is wrong or odd with a studio.

use super::failure::Failure;
use super::{input, terminal};
use std::path::PathBuf;

/// Arguments of `check`.
#[derive(Debug, clap::Args)]
pub struct Arguments {
    /// Studio: a .ron file, or the name of a shipped one.
    scene: PathBuf,
}

/// Prints a summary; fails if the studio cannot be used.
pub fn run(arguments: &Arguments) -> Result<(), Failure> {
    let loaded = input::load_studio(&arguments.scene)?;
    let scene = &loaded.scene;
    let verdict = match loaded.warnings.len() {
        0 => "nothing odd".to_owned(),
        1 => "1 warning".to_owned(),
        n => format!("{n} warnings"),
    };
    terminal::result(format_args!(
        "{}: {} objects, {} lights, {verdict}",
        if scene.name.is_empty() { "studio" } else { &scene.name },
        scene.objects.len(),
        scene.lights.len(),
    ));
    Ok(())
}

//! `catchlight preview SCENE -o OUT`: the live preview's picture, without a window.

use super::{Failure, input, window};
use std::path::PathBuf;

/// Arguments of `preview`.
#[derive(Debug, clap::Args)]
pub struct Arguments {
    /// Studio: a .ron file, or the name of a shipped one.
    scene: PathBuf,
    /// Picture file; the ending says which kind: png, jpg, exr.
    #[arg(short, long)]
    output: PathBuf,
    /// Picture size in pixels, WIDTHxHEIGHT [default: 960 on the long edge, in the sensor's shape].
    #[arg(long, value_parser = input::parse_size)]
    size: Option<(u32, u32)>,
}

/// Renders and writes.
pub fn run(arguments: &Arguments) -> Result<(), Failure> {
    // A wrong file name should not cost a rendering.
    crate::io::PictureFormat::of(&arguments.output)?;
    let loaded = input::load_studio(&arguments.scene)?;
    let size = arguments.size.unwrap_or_else(|| loaded.scene.camera.picture_size(960));
    window::write_preview(&loaded, size, &arguments.output)
}

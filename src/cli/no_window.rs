//! Stands in for `window.rs` where the program was built without the `gui` feature.

use super::Failure;
use super::preview::{Look, TimesReport};
use crate::io::Loaded;
use anyhow::anyhow;
use std::path::{Path, PathBuf};

/// There is no window in this build.
pub fn open(scene: Option<PathBuf>) -> Result<(), Failure> {
    let scene = scene.unwrap_or_else(|| "three_point".into());
    Err(Failure::Machine(anyhow!(
        "this build has no window (it was made without the `gui` feature); to render instead: \
         catchlight render {} -o picture.png",
        scene.display()
    )))
}

/// There is no graphics-card preview in this build.
pub fn write_preview(_loaded: &Loaded, _size: (u32, u32), _output: &Path, _look: &Look) -> Result<(), Failure> {
    Err(no_preview())
}

/// There is no graphics-card preview to be timed in this build.
pub fn time_preview(_loaded: &Loaded, _size: (u32, u32), _frames: u32, _radius: bool) -> Result<TimesReport, Failure> {
    Err(no_preview())
}

fn no_preview() -> Failure {
    Failure::Machine(anyhow!("this build has no live preview (it was made without the `gui` feature)"))
}

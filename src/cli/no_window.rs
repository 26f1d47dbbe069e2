//! Replaces `window.rs` in a build without the `gui` feature.

use super::failure::Failure;
use super::frame_times::FrameTimeReport;
use super::preview_look::PreviewLook;
use crate::io::Loaded;
use anyhow::anyhow;
use std::path::{Path, PathBuf};

/// Fails: this build has no window.
pub fn open(scene: Option<PathBuf>) -> Result<(), Failure> {
    let scene = scene.unwrap_or_else(|| "three_point".into());
    Err(Failure::Machine(anyhow!(
        "this build has no window (it was made without the `gui` feature); to render instead: \
         catchlight render {} -o picture.png",
        scene.display()
    )))
}

/// Fails: this build has no GPU preview.
pub fn write_preview(_loaded: &Loaded, _size: (u32, u32), _output: &Path, _look: &PreviewLook) -> Result<(), Failure> {
    Err(no_preview())
}

/// Fails: this build has no GPU preview.
pub fn time_preview(
    _loaded: &Loaded,
    _size: (u32, u32),
    _frames: u32,
    _radius: bool,
) -> Result<FrameTimeReport, Failure> {
    Err(no_preview())
}

fn no_preview() -> Failure {
    Failure::Machine(anyhow!("this build has no live preview (it was made without the `gui` feature)"))
}

//! What needs a graphics adapter: the editor and its preview.

use super::Failure;
use crate::editor;
use crate::io::{self, Loaded, PictureInfo};
use crate::preview::{self, PreviewInput};
use anyhow::anyhow;
use std::path::{Path, PathBuf};

/// Opens the editor on a studio file, a shipped studio by name, or the first shipped one.
pub fn open(scene: Option<PathBuf>) -> Result<(), Failure> {
    let named = scene.as_ref().map_or_else(|| "three_point".to_owned(), |path| path.display().to_string());
    editor::run(scene).map_err(|error| {
        let hint = format!("{error}; to render without a window: catchlight render {named} -o picture.png");
        Failure::Machine(anyhow!(hint))
    })
}

/// Renders the preview offscreen and writes it.
pub fn write_preview(loaded: &Loaded, size: (u32, u32), output: &Path) -> Result<(), Failure> {
    let machine = |error: preview::PreviewError| Failure::Machine(error.into());
    let gpu = preview::Gpu::headless().map_err(machine)?;
    let mut renderer = preview::PreviewRenderer::new(&gpu.device, &gpu.queue).map_err(machine)?;
    let input = PreviewInput::camera_view(&loaded.scene, &loaded.assets, size);
    let picture = renderer.linear_picture(&input).map_err(machine)?;
    Ok(io::export_picture(output, &picture, &PictureInfo::new(&loaded.scene.camera, "preview", 1, 0))?)
}

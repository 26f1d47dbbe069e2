//! What needs a graphics adapter: the editor and its preview.

use super::Failure;
use super::preview::TimesReport;
use crate::editor;
use crate::io::{self, Loaded, PictureInfo};
use crate::preview::{Gpu, Options, PreviewError, PreviewInput, PreviewRenderer};
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
    let (_, mut renderer) = start()?;
    let input = PreviewInput::camera_view(&loaded.scene, &loaded.assets, size);
    let picture = renderer.linear_picture(&input).map_err(machine)?;
    Ok(io::export_picture(output, &picture, &PictureInfo::new(&loaded.scene.camera, "preview", 1, 0))?)
}

/// Times frames of the preview in motion.
pub fn time_preview(
    loaded: &Loaded,
    (width, height): (u32, u32),
    frames: u32,
    light_radius: bool,
) -> Result<TimesReport, Failure> {
    let (gpu, mut renderer) = start()?;
    let mut input = PreviewInput::camera_view(&loaded.scene, &loaded.assets, (width, height));
    input.options = Options { light_radius, draft: true, ..input.options };
    let moving = renderer.time_frames(&input, frames).map_err(machine)?;
    input.options.draft = false;
    let full = if renderer.draws_drafts() { renderer.time_frames(&input, frames).map_err(machine)? } else { moving };
    Ok(TimesReport {
        scene: loaded.scene.name.clone(),
        width,
        height,
        adapter: gpu.name,
        triangles: None,
        lights: loaded.scene.lights.iter().filter(|light| light.on).count(),
        light_radius,
        draft: renderer.draws_drafts(),
        frames: moving.frames,
        median_ms: moving.median_ms,
        ninety_percent_ms: moving.ninety_percent_ms,
        full_median_ms: full.median_ms,
    })
}

fn start() -> Result<(Gpu, PreviewRenderer), Failure> {
    let gpu = Gpu::headless().map_err(machine)?;
    let renderer = PreviewRenderer::new(&gpu.device, &gpu.queue).map_err(machine)?;
    Ok((gpu, renderer))
}

fn machine(error: PreviewError) -> Failure {
    Failure::Machine(error.into())
}

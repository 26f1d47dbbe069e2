//! Commands that need a GPU: the editor and its preview.

use super::failure::Failure;
use super::frame_times::FrameTimeReport;
use super::preview_look::PreviewLook;
use super::terminal;
use crate::editor;
use crate::io::{self, Loaded, PictureInfo};
use crate::jobs;
use crate::photo::{FALSE_STOPS, exposure, false_color};
use crate::preview::{Channel, Gloss, Gpu, Options, PreviewError, PreviewInput, PreviewRenderer};
use crate::scene::Scene;
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

/// Draws the preview offscreen and writes it. Channels are written to EXR as values, else as colours.
pub fn write_preview(loaded: &Loaded, size: (u32, u32), output: &Path, look: &PreviewLook) -> Result<(), Failure> {
    let options = options(loaded, look)?;
    let (_, mut renderer) = start()?;
    let bounced_light = jobs::trace_bounced_light(&loaded.scene, &loaded.assets, options.only_light)
        .map_err(|error| Failure::Input(error.into()))?;
    let view = PreviewInput::camera_view(&loaded.scene, &loaded.assets, size);
    let input = PreviewInput { options, bounced_light: bounced_light.as_ref(), ..view };
    if options.channel == Channel::Illuminance {
        legend(&loaded.scene);
    }
    if options.channel != Channel::Lit && io::PictureFormat::of(output)? != io::PictureFormat::Exr {
        return Ok(io::export_shown(output, &renderer.picture(&input).map_err(machine)?)?);
    }
    let samples = if options.channel == Channel::Lit { renderer.still_samples() } else { 1 };
    let picture = renderer.still_picture(&input, samples).map_err(machine)?;
    Ok(io::export_picture(output, &picture, &PictureInfo::new(&loaded.scene, "preview", 1, 0))?)
}

fn options(loaded: &Loaded, look: &PreviewLook) -> Result<Options, Failure> {
    let known = Channel::ALL.map(Channel::name).join(", ");
    let channel = Channel::ALL.into_iter().find(|channel| channel.name() == look.channel);
    let channel =
        channel.ok_or_else(|| Failure::Input(anyhow!("there is no channel {:?}; there are {known}", look.channel)))?;
    let named = |name: &String| loaded.scene.lights.iter().find(|light| light.name == *name).map(|light| light.id);
    let unknown = |name: &String| Failure::Input(anyhow!("the studio has no light named {name:?}"));
    let only_light = look.light.as_ref().map(|name| named(name).ok_or_else(|| unknown(name))).transpose()?;
    let gloss = if look.blinn_phong { Gloss::BlinnPhong } else { Gloss::Ggx };
    Ok(Options { channel, only_light, gloss, ..Options::default() })
}

/// Prints the legend of the false colours on stderr.
fn legend(scene: &Scene) {
    let lux_s = exposure::lux_s_to_set(scene, scene.camera.f_number);
    for stops in FALSE_STOPS.0..=FALSE_STOPS.1 {
        let [r, g, b] = false_color(stops as f32);
        let lux_s = lux_s * (stops as f32).exp2();
        let lux = lux_s / scene.camera.shutter_s;
        terminal::progress(format_args!(
            "#{r:02x}{g:02x}{b:02x}  {stops:+} stops  {lux_s:.3} lx s, or {lux:.1} lx at the camera's shutter"
        ));
    }
}

/// Measures frame times of the preview in motion.
pub fn time_preview(
    loaded: &Loaded,
    (width, height): (u32, u32),
    frames: u32,
    light_radius: bool,
) -> Result<FrameTimeReport, Failure> {
    let (gpu, mut renderer) = start()?;
    let mut input = PreviewInput::camera_view(&loaded.scene, &loaded.assets, (width, height));
    input.options = Options { light_radius, draft: true, ..input.options };
    let moving = renderer.time_frames(&input, frames).map_err(machine)?;
    input.options.draft = false;
    let full = if renderer.draws_drafts() { renderer.time_frames(&input, frames).map_err(machine)? } else { moving };
    Ok(FrameTimeReport {
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

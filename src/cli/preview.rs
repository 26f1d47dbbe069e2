//! `catchlight preview SCENE`: draws the live preview without a window, or measures its frame times.

use super::failure::Failure;
use super::input::{self, StudioArguments};
use super::preview_look::PreviewLook;
use super::{light_crowd, live_view_times, terminal, window, zbuffer};
use crate::io::Loaded;
use anyhow::anyhow;
use std::path::{Path, PathBuf};

/// Picture size of frame times.
const TIMED_SIZE: (u32, u32) = (1280, 720);
/// Numbers of lights of `--lights`.
const LIGHT_COUNTS: [u32; 4] = [1, 4, 16, 60];
/// Number of timed frames without `--frames`.
const FRAMES: u32 = 30;

/// Arguments of `preview`.
#[derive(Debug, clap::Args)]
pub struct Arguments {
    #[command(flatten)]
    studio: StudioArguments,
    /// Picture file, whose extension names its format: png, jpg, tif, exr.
    #[arg(short, long, required_unless_present_any = ["frames", "lights", "traced"])]
    output: Option<PathBuf>,
    /// Picture size in pixels, WIDTHxHEIGHT [default: 960 on the long edge, in the sensor's shape; 1280x720 for times].
    #[arg(long, value_parser = input::parse_size)]
    size: Option<(u32, u32)>,
    /// Measure the time of this many frames, with the camera turned a little from one to the next.
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u32).range(1..=100_000))]
    frames: Option<u32>,
    /// Measure frame times against the number of lights: five figures of the studio under 1, 4, 16 and 60 lights, each
    /// with and without the radius beyond which a light is left out.
    #[arg(long)]
    lights: bool,
    /// Channel of the picture: lit, base-color, normal, roughness, metallic, depth, ids, or illuminance (direct light
    /// in false colour, in stops against the camera's exposure).
    #[arg(long, default_value = "lit", conflicts_with = "cpu")]
    channel: String,
    /// Name of the only light that is on.
    #[arg(long, value_name = "NAME", conflicts_with = "cpu")]
    light: Option<String>,
    /// Blinn-Phong highlights instead of GGX.
    #[arg(long, conflicts_with = "cpu")]
    blinn_phong: bool,
    /// Draw on the CPU, without a GPU: no shadows.
    #[arg(long, conflicts_with = "lights")]
    cpu: bool,
    /// Measure the traced live view: the time to its first picture after opening, moving, dimming and turning, each
    /// repeated as often as `--frames` says. With `-o`, write its finished picture.
    #[arg(long, conflicts_with_all = ["lights", "cpu"])]
    traced: bool,
    /// Print times as JSON.
    #[arg(long)]
    json: bool,
}

/// Renders and writes, or measures and prints.
pub fn run(arguments: &Arguments) -> Result<(), Failure> {
    if let Some(output) = &arguments.output {
        // Check the file before a picture is drawn for it.
        crate::io::check_picture_file(output)?;
    }
    let mut loaded = arguments.studio.load()?;
    if arguments.traced {
        let size = arguments.size.unwrap_or(TIMED_SIZE);
        let frames = arguments.frames.unwrap_or(FRAMES);
        return live_view_times::run(&loaded, size, frames, arguments.output.as_deref(), arguments.json);
    }
    if let Some(output) = &arguments.output {
        let size = arguments.size.unwrap_or_else(|| loaded.scene.camera.picture_size(960));
        let (channel, light) = (arguments.channel.clone(), arguments.light.clone());
        let look = PreviewLook { channel, light, blinn_phong: arguments.blinn_phong };
        write(&loaded, size, output, arguments.cpu, &look)?;
    }
    let size = arguments.size.unwrap_or(TIMED_SIZE);
    let frames = arguments.frames.unwrap_or(FRAMES);
    if arguments.lights {
        let Some(crowd) = light_crowd::five_figures(&loaded.scene) else {
            return Err(Failure::Input(anyhow!("--lights needs a studio with at least one figure")));
        };
        for lights in LIGHT_COUNTS {
            loaded.scene = light_crowd::lit_by(&crowd, lights);
            for radius in [true, false] {
                window::time_preview(&loaded, size, frames, radius)?.print(arguments.json)?;
            }
        }
    } else if arguments.frames.is_some() {
        let report = match arguments.cpu {
            true => zbuffer::time(&loaded, size, frames),
            false => window::time_preview(&loaded, size, frames, true)?,
        };
        report.print(arguments.json)?;
    }
    Ok(())
}

/// Writes the preview: on the CPU with `cpu`, or if there is no GPU.
fn write(loaded: &Loaded, size: (u32, u32), output: &Path, cpu: bool, look: &PreviewLook) -> Result<(), Failure> {
    if !cpu {
        let plain = look.channel == "lit" && look.light.is_none() && !look.blinn_phong;
        match window::write_preview(loaded, size, output, look) {
            Err(Failure::Machine(error)) if plain => {
                terminal::progress(format_args!("{error:#}; drawn on the CPU instead, without shadows"))
            }
            done => return done,
        }
    }
    zbuffer::write(loaded, size, output)
}

//! `catchlight preview SCENE`: the live preview without a window, as a picture or as the time its frames take.

use super::{Failure, crowd, input, say, traced, window, zbuffer};
use crate::io::Loaded;
use anyhow::anyhow;
use serde::Serialize;
use std::path::{Path, PathBuf};

/// Size at which frame times are stated.
const TIMED_SIZE: (u32, u32) = (1280, 720);
/// Numbers of lights that `--lights` goes through.
const LIGHT_COUNTS: [usize; 4] = [1, 4, 16, 60];
/// Frames timed where `--frames` does not say.
const FRAMES: u32 = 30;

/// Arguments of `preview`.
#[derive(Debug, clap::Args)]
pub struct Arguments {
    /// Studio: a .ron file, or the name of a shipped one.
    scene: PathBuf,
    /// Picture file; the ending says which kind: png, jpg, exr.
    #[arg(short, long, required_unless_present_any = ["frames", "lights", "traced"])]
    output: Option<PathBuf>,
    /// Picture size in pixels, WIDTHxHEIGHT [default: 960 on the long edge, in the sensor's shape; 1280x720 for times].
    #[arg(long, value_parser = input::parse_size)]
    size: Option<(u32, u32)>,
    /// Time this many frames, the camera turning a little each time.
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u32).range(1..=100_000))]
    frames: Option<u32>,
    /// Time frames against the number of lights: five figures of the studio under 1, 4, 16 and 60 lights, each with and
    /// without the radius beyond which a light is left out.
    #[arg(long)]
    lights: bool,
    /// What the picture shows: lit, base-color, normal, roughness, metallic, depth, ids, or illuminance (direct light
    /// in false colour, in stops against the camera's exposure).
    #[arg(long, default_value = "lit", conflicts_with = "cpu")]
    channel: String,
    /// One light alone, by name.
    #[arg(long, value_name = "NAME", conflicts_with = "cpu")]
    light: Option<String>,
    /// Highlights by Blinn and Phong instead of GGX.
    #[arg(long, conflicts_with = "cpu")]
    blinn_phong: bool,
    /// Draw on the processor, without a graphics adapter: no shadows.
    #[arg(long, conflicts_with = "lights")]
    cpu: bool,
    /// The live view as the tracer shows it: how soon its first picture stands after opening, moving, dimming and
    /// turning, each so many times as `--frames` says; with `-o`, its picture when it has settled.
    #[arg(long, conflicts_with_all = ["lights", "cpu"])]
    traced: bool,
    /// Print times as JSON.
    #[arg(long)]
    json: bool,
}

/// What of the studio a picture shows.
#[derive(Clone, Debug, Default)]
pub struct Look {
    /// Name of the channel.
    pub channel: String,
    /// Name of the light that shines alone.
    pub light: Option<String>,
    /// Highlights by Blinn and Phong.
    pub blinn_phong: bool,
}

/// What `--frames` and `--lights` print.
#[derive(Debug, Serialize)]
pub struct TimesReport {
    /// Name of the studio.
    pub scene: String,
    /// Pixels across.
    pub width: u32,
    /// Pixels down.
    pub height: u32,
    /// The graphics adapter and its interface.
    pub adapter: String,
    /// Triangles in the studio, where the processor draws.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub triangles: Option<u64>,
    /// Lights that are on.
    pub lights: usize,
    /// Whether lights are left out where they fall under 1/256 of display white.
    pub light_radius: bool,
    /// Whether frames in motion are drafts here, which light one pixel in nine (fewer under many lights) and give way
    /// to the picture in full when nothing moves: on adapters that are processors.
    pub draft: bool,
    /// Frames measured.
    pub frames: usize,
    /// Half of the frames in motion took less.
    pub median_ms: f64,
    /// Nine of ten frames in motion took less.
    pub ninety_percent_ms: f64,
    /// Half of the frames took less when each was drawn in full.
    pub full_median_ms: f64,
}

/// Renders and writes, or measures and prints.
pub fn run(arguments: &Arguments) -> Result<(), Failure> {
    if let Some(output) = &arguments.output {
        // A wrong file name should not cost a rendering.
        crate::io::PictureFormat::of(output)?;
    }
    let mut loaded = input::load_studio(&arguments.scene)?;
    if arguments.traced {
        let size = arguments.size.unwrap_or(TIMED_SIZE);
        let frames = arguments.frames.unwrap_or(FRAMES);
        return traced::run(&loaded, size, frames, arguments.output.as_deref(), arguments.json);
    }
    if let Some(output) = &arguments.output {
        let size = arguments.size.unwrap_or_else(|| loaded.scene.camera.picture_size(960));
        let (channel, light) = (arguments.channel.clone(), arguments.light.clone());
        let look = Look { channel, light, blinn_phong: arguments.blinn_phong };
        write(&loaded, size, output, arguments.cpu, &look)?;
    }
    let size = arguments.size.unwrap_or(TIMED_SIZE);
    let frames = arguments.frames.unwrap_or(FRAMES);
    if arguments.lights {
        let Some(crowd) = crowd::five_figures(&loaded.scene) else {
            return Err(Failure::Input(anyhow!("--lights wants a studio with at least one figure")));
        };
        for lights in LIGHT_COUNTS {
            loaded.scene = crowd::lit_by(&crowd, lights);
            for radius in [true, false] {
                print(&window::time_preview(&loaded, size, frames, radius)?, arguments.json)?;
            }
        }
    } else if arguments.frames.is_some() {
        let report = match arguments.cpu {
            true => zbuffer::time(&loaded, size, frames),
            false => window::time_preview(&loaded, size, frames, true)?,
        };
        print(&report, arguments.json)?;
    }
    Ok(())
}

/// Writes the preview; without an adapter, or where `cpu` asks for it, as the processor draws it.
fn write(loaded: &Loaded, size: (u32, u32), output: &Path, cpu: bool, look: &Look) -> Result<(), Failure> {
    if !cpu {
        let plain = look.channel == "lit" && look.light.is_none() && !look.blinn_phong;
        match window::write_preview(loaded, size, output, look) {
            Err(Failure::Machine(error)) if plain => {
                eprintln!("{error:#}; drawn on the processor instead, without shadows")
            }
            done => return done,
        }
    }
    zbuffer::write(loaded, size, output)
}

fn print(report: &TimesReport, json: bool) -> Result<(), Failure> {
    if json {
        say(serde_json::to_string(report)?);
        return Ok(());
    }
    let TimesReport { scene, width, height, adapter, lights, frames, median_ms, ninety_percent_ms, .. } = report;
    let radius = match report.triangles {
        Some(triangles) => format!(", {triangles} triangles"),
        None if report.light_radius => String::new(),
        None => ", each over the whole picture".to_owned(),
    };
    let draft = if report.draft { " as a draft" } else { "" };
    let full = if report.draft { format!("; in full {:.1} ms", report.full_median_ms) } else { String::new() };
    say(format!(
        "{scene}, {width}x{height}, {adapter}, {lights} lights{radius}: {median_ms:.1} ms a frame in motion{draft} \
         (median of {frames}), 90 % within {ninety_percent_ms:.1} ms{full}"
    ));
    Ok(())
}

//! Arguments of `catchlight render`, and the settings that follow from them.

use super::progress::ProgressStyle;
use crate::cli::denoised_output::Denoise;
use crate::cli::input::{self, StudioArguments};
use crate::io::{self, PictureFormat};
use crate::raytrace::{Method, SampleId, Settings, Shortcut};
use crate::scene::Camera;
use anyhow::anyhow;
use clap::ValueEnum;
use std::ops::Range;
use std::path::{Path, PathBuf};
use std::str::FromStr;
use std::time::Duration;

/// Arguments of `render`.
#[derive(Debug, clap::Args)]
pub struct Arguments {
    #[command(flatten)]
    pub studio: StudioArguments,
    /// Picture file, whose extension names its format: png, jpg, tif of 16 bits (as shown), exr (scene-linear).
    #[arg(short, long, required_unless_present = "explain_pixel")]
    output: Option<PathBuf>,
    /// Rendering method.
    #[arg(long, value_enum, default_value_t = MethodName::Path)]
    pub method: MethodName,
    /// Picture size in pixels, WIDTHxHEIGHT [default: 960 on the long edge, in the sensor's shape].
    #[arg(long, value_parser = input::parse_size)]
    size: Option<(u32, u32)>,
    /// Samples per pixel [default: 64, or as many as --noise or --time allow].
    #[arg(long, value_parser = clap::value_parser!(u32).range(1..=1_000_000))]
    pub spp: Option<u32>,
    /// Sample each part of the picture until its noise is below this many stops, such as 0.05.
    #[arg(long, value_name = "STOPS", value_parser = positive::<f32>)]
    noise: Option<f32>,
    /// Stop after this many seconds.
    #[arg(long, value_name = "SECONDS", value_parser = positive::<f64>)]
    time: Option<f64>,
    /// Maximum number of bounces [default: what the studio's surfaces need].
    #[arg(long, value_parser = clap::value_parser!(u32).range(1..=1000))]
    max_depth: Option<u32>,
    /// Method for caustics, the light that mirrors and glass throw on surfaces. Photons have little noise and blur the
    /// edges by a pixel or two, less the longer it renders; paths blur nothing and are noisy.
    #[arg(long, value_enum, default_value_t = Caustics::Photons)]
    caustics: Caustics,
    /// Method for light that paths meet after a bounce. In bright closed rooms, that on matte surfaces comes from a cache,
    /// several times as fast and right within 0.001 stops on average; everywhere, gloss is blurred there, less with every
    /// sample. `paths` does neither.
    #[arg(long, value_enum, default_value_t = BouncedLight::Cache)]
    bounced_light: BouncedLight,
    /// Minutes between checkpoints, which are written beside the picture (OUT.checkpoint) after a pass; 0 for none.
    #[arg(long, value_name = "MINUTES", default_value_t = 5.0, value_parser = not_negative)]
    checkpoint: f64,
    /// Go on from the checkpoint of an earlier run that was killed, to the same picture as of one run. The other
    /// arguments must be the same.
    #[arg(long, conflicts_with = "explain_pixel")]
    pub resume: bool,
    /// Render only the samples A to B - 1 of the --spp of each pixel, as a part of the picture for `catchlight merge`
    /// (exr only). Parts may be rendered by different machines.
    #[arg(long, value_name = "A..B", value_parser = parse_samples, conflicts_with = "explain_pixel")]
    samples: Option<Range<u32>>,
    /// How progress is shown on stderr: a bar, a line of JSON for each percent, or lines for Open Job Description.
    #[arg(long, value_enum, default_value_t = ProgressStyle::Bar)]
    pub progress: ProgressStyle,
    /// Number of threads [default: all cores].
    #[arg(long, value_parser = clap::value_parser!(u16).range(1..=1024))]
    threads: Option<u16>,
    /// Seed of the noise pattern.
    #[arg(long, default_value_t = 0)]
    pub seed: u32,
    /// Print what the renderer leaves out for this studio, and why.
    #[arg(long)]
    pub explain: bool,
    /// Print one JSON object with the statistics.
    #[arg(long)]
    pub json: bool,
    /// Write one EXR layer per light beside the whole picture (exr only).
    #[arg(long)]
    pub layers: bool,
    /// Write what each pixel shows beside its light (exr only): albedo.R/G/B, normal.X/Y/Z (world), Z (metres along the
    /// view axis, infinite where there is nothing), id (0 nothing, 1 the room, then the objects in the file's order), and
    /// from 8 samples on RelativeVariance.Y (of the mean luminance, over its square); what mirrors and clear glass show
    /// in Denoising Albedo.R/G/B and Denoising Normal.X/Y/Z.
    #[arg(long)]
    pub aovs: bool,
    /// Remove the noise with a neural network. Fine detail that looks like noise gets lost: hair, textures, small
    /// reflections, if the render has few samples. An EXR file holds the noisy picture, too (noisy.R/G/B), and the channels
    /// of --aovs, by which it can be denoised again. With --samples, the part only gets those channels.
    #[arg(long, value_enum, value_name = "HOW", default_value_t)]
    pub denoise: Denoise,
    /// Trace one sample of a pixel again and print every step, instead of a picture.
    #[arg(long, value_name = "X,Y", value_parser = input::parse_pixel)]
    pub explain_pixel: Option<(u32, u32)>,
    /// The sample that --explain-pixel traces [default: the pixel's brightest].
    #[arg(long, value_name = "N", requires = "explain_pixel")]
    pub sample: Option<u32>,
}

#[derive(Clone, Copy, Debug, PartialEq, ValueEnum)]
enum Caustics {
    Photons,
    Paths,
}

#[derive(Clone, Copy, Debug, PartialEq, ValueEnum)]
enum BouncedLight {
    Cache,
    Paths,
}

/// A rendering method, by its name in arguments and reports.
#[derive(Clone, Copy, Debug, ValueEnum)]
pub enum MethodName {
    /// A z-buffer on the CPU: visibility and direct light, no shadows.
    Zbuffer,
    /// Phong lobes, hard shadows, mirrors and glass, no bounced light.
    Whitted,
    /// Direct light only: soft shadows, no bounced light.
    Direct,
    /// All light paths: the reference.
    Path,
}

impl MethodName {
    /// Returns the ray tracer's method; none for the z-buffer.
    pub fn traced(self) -> Option<Method> {
        match self {
            MethodName::Zbuffer => None,
            MethodName::Whitted => Some(Method::Whitted),
            MethodName::Direct => Some(Method::Direct),
            MethodName::Path => Some(Method::Path),
        }
    }

    /// Returns the name in reports.
    pub fn label(self) -> &'static str {
        match self {
            MethodName::Zbuffer => "zbuffer",
            MethodName::Whitted => "whitted",
            MethodName::Direct => "direct",
            MethodName::Path => "path",
        }
    }
}

fn positive<T: FromStr + Into<f64> + Copy>(text: &str) -> Result<T, String> {
    let value: T = text.parse().map_err(|_| format!("`{text}` is not a number"))?;
    let number: f64 = value.into();
    match number > 0.0 {
        true if number.is_finite() => Ok(value),
        true => Err(format!("{text} is too large")),
        false => Err(format!("must be more than 0, not {text}")),
    }
}

fn parse_samples(text: &str) -> Result<Range<u32>, String> {
    let ends = text.split_once("..").and_then(|(a, b)| Some((a.trim().parse().ok()?, b.trim().parse().ok()?)));
    let (start, end) = ends.ok_or_else(|| format!("`{text}` is no range of samples: write A..B, such as 0..16"))?;
    if start < end { Ok(start..end) } else { Err(format!("the range {text} has no sample")) }
}

fn not_negative(text: &str) -> Result<f64, String> {
    let value: f64 = text.parse().map_err(|_| format!("`{text}` is not a number"))?;
    if value >= 0.0 { Ok(value) } else { Err(format!("must be 0 or more, not {text}")) }
}

/// Samples per pixel where nothing else ends the render.
const DEFAULT_SPP: u32 = 64;
/// Samples per pixel where noise or time end the render.
const MAX_SPP: u32 = 65_536;

impl Arguments {
    /// Checks that the output file can be written, before a picture is rendered for it.
    pub fn check_output(&self) -> anyhow::Result<()> {
        let Some(output) = &self.output else { return Ok(()) };
        let format = PictureFormat::of(output)?;
        for (is_set, option) in [(self.layers, "--layers"), (self.aovs, "--aovs")] {
            if is_set && format != PictureFormat::Exr {
                return Err(anyhow!("{option} needs a picture that ends in .exr, not {}", output.display()));
            }
        }
        Ok(io::check_picture_file(output)?)
    }

    /// Returns the samples of the part that is to be rendered; none for a whole picture.
    pub fn part(&self) -> anyhow::Result<Option<Range<u32>>> {
        let Some(samples) = self.samples.clone() else { return Ok(None) };
        let (of, Range { start, end }) = (self.spp.unwrap_or(DEFAULT_SPP), samples.clone());
        anyhow::ensure!(end <= of, "the picture has the samples 0..{of} (--spp), so {start}..{end} is no part of it");
        anyhow::ensure!(
            self.noise.is_none() && self.time.is_none(),
            "a part has all samples of its range: --noise and --time end a picture by what all of its samples show, \
             which a part does not know"
        );
        anyhow::ensure!(self.method.traced().is_some(), "--method zbuffer has no samples to divide");
        anyhow::ensure!(!self.layers, "a part has the layers of all lights; give --layers to merge");
        anyhow::ensure!(!self.resume, "a part has no checkpoints: render it again, and choose shorter ranges");
        if PictureFormat::of(self.output())? != PictureFormat::Exr {
            return Err(anyhow!("a part needs a file that ends in .exr, not {}", self.output().display()));
        }
        Ok(Some(samples))
    }

    /// Returns the picture file; empty only with --explain-pixel.
    pub fn output(&self) -> &Path {
        self.output.as_deref().unwrap_or(Path::new(""))
    }

    /// Returns the command that traces a sample of a render again, step by step.
    pub fn replay_command(&self, settings: &Settings, sample: SampleId) -> String {
        let Settings { width, height, spp, .. } = settings;
        let SampleId { x, y, index, seed } = sample;
        let (scene, method) = (self.studio.scene.display(), self.method.label());
        let variant = self.studio.variant.as_ref().map_or(String::new(), |name| format!(" --variant '{name}'"));
        let depth = self.max_depth.map_or(String::new(), |depth| format!(" --max-depth {depth}"));
        let caustics = if self.caustics == Caustics::Paths { " --caustics paths" } else { "" };
        let bounced_light = if self.bounced_light == BouncedLight::Paths { " --bounced-light paths" } else { "" };
        format!(
            "catchlight render '{scene}'{variant} --method {method} --size {width}x{height} --spp {spp}{depth}{caustics}\
             {bounced_light} --seed {seed} --explain-pixel {x},{y} --sample {index}"
        )
    }

    /// Returns the size of the picture, pixels.
    pub fn picture_size(&self, camera: &Camera) -> (u32, u32) {
        self.size.unwrap_or_else(|| camera.picture_size(960))
    }

    /// Returns the settings of a ray-traced picture.
    pub fn settings(&self, camera: &Camera, method: Method) -> Settings {
        let (width, height) = self.picture_size(camera);
        let is_open_ended = self.noise.is_some() || self.time.is_some();
        let spp = self.spp.unwrap_or(if is_open_ended { MAX_SPP } else { DEFAULT_SPP });
        let (max_depth, seed, noise_stops) = (self.max_depth, self.seed, self.noise);
        Settings {
            width,
            height,
            method,
            spp,
            max_depth,
            seed,
            noise_stops,
            aovs: self.aovs || self.denoise != Denoise::Off,
        }
    }

    /// Returns the time limit. A limit beyond what a duration holds is none.
    pub fn time_limit(&self) -> Option<Duration> {
        self.time.and_then(|seconds| Duration::try_from_secs_f64(seconds).ok())
    }

    /// Returns the time between checkpoints; none for no checkpoints.
    pub fn checkpoint_interval(&self) -> Option<Duration> {
        Duration::try_from_secs_f64(self.checkpoint * 60.0).ok().filter(|interval| !interval.is_zero())
    }

    /// Returns the number of threads; 0 for all cores.
    pub fn threads(&self) -> usize {
        self.threads.unwrap_or(0).into()
    }

    /// Returns the shortcuts of the render plan that are not taken.
    pub fn without(&self) -> &'static [Shortcut] {
        match (self.caustics, self.bounced_light) {
            (Caustics::Photons, BouncedLight::Cache) => &[],
            (Caustics::Paths, BouncedLight::Cache) => &[Shortcut::Photons],
            (Caustics::Photons, BouncedLight::Paths) => &[Shortcut::IrradianceCache, Shortcut::Regularisation],
            (Caustics::Paths, BouncedLight::Paths) => {
                &[Shortcut::Photons, Shortcut::IrradianceCache, Shortcut::Regularisation]
            }
        }
    }
}

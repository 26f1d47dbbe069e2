//! `catchlight render SCENE -o OUT`: a picture without a window.

use super::{Failure, input, say, zbuffer};
use crate::io::{self, Loaded, PictureFormat, PictureInfo};
use crate::raytrace::{self, Film, Method, RenderControl, RenderScene, SampleId, Settings, Shortcut};
use anyhow::{Context, anyhow};
use clap::ValueEnum;
use indicatif::{ProgressBar, ProgressStyle};
use serde::Serialize;
use std::ops::ControlFlow;
use std::path::PathBuf;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::{Duration, Instant};

/// Arguments of `render`.
#[derive(Debug, clap::Args)]
pub struct Arguments {
    /// Studio: a .ron file, or the name of a shipped one.
    scene: PathBuf,
    /// Picture file; the ending says which kind: png, jpg (as shown), exr (scene-linear).
    #[arg(short, long)]
    output: PathBuf,
    /// How light is followed.
    #[arg(long, value_enum, default_value_t = MethodName::Path)]
    method: MethodName,
    /// Picture size in pixels, WIDTHxHEIGHT [default: 960 on the long edge, in the sensor's shape].
    #[arg(long, value_parser = input::parse_size)]
    size: Option<(u32, u32)>,
    /// Samples a pixel [default: 64, or as many as --noise or --time allow].
    #[arg(long, value_parser = clap::value_parser!(u32).range(1..=1_000_000))]
    spp: Option<u32>,
    /// Sample each part of the picture until its noise is under this many stops, such as 0.05.
    #[arg(long, value_name = "STOPS", value_parser = positive)]
    noise: Option<f32>,
    /// Stop after this many seconds.
    #[arg(long, value_name = "SECONDS", value_parser = positive)]
    time: Option<f32>,
    /// Bounces at most [default: what the studio's surfaces need].
    #[arg(long, value_parser = clap::value_parser!(u32).range(1..=1000))]
    max_depth: Option<u32>,
    /// What brings the light that mirrors and glass throw on surfaces: photons are quiet and blur its edges by a pixel or
    /// two, less the longer it renders; paths alone blur nothing and are grainy.
    #[arg(long, value_enum, default_value_t = Caustics::Photons)]
    caustics: Caustics,
    /// Threads [default: all cores].
    #[arg(long, value_parser = clap::value_parser!(u16).range(1..=1024))]
    threads: Option<u16>,
    /// Another seed gives other noise.
    #[arg(long, default_value_t = 0)]
    seed: u32,
    /// Print what the tracer leaves out for this studio, and why.
    #[arg(long)]
    explain: bool,
    /// Print one JSON object with the statistics.
    #[arg(long)]
    json: bool,
    /// Write one EXR layer a light beside the whole picture (exr only).
    #[arg(long)]
    layers: bool,
}

#[derive(Clone, Copy, Debug, PartialEq, ValueEnum)]
enum Caustics {
    Photons,
    Paths,
}

#[derive(Clone, Copy, Debug, ValueEnum)]
enum MethodName {
    /// A z-buffer on the processor: visibility and direct light, no shadows.
    Zbuffer,
    /// Phong lobes, hard shadows, mirrors and glass, no bounces.
    Whitted,
    /// Direct light only: soft shadows, no bounces.
    Direct,
    /// Everything: the reference.
    Path,
}

impl MethodName {
    /// The tracer's method; none for what no ray draws.
    fn traced(self) -> Option<Method> {
        match self {
            MethodName::Zbuffer => None,
            MethodName::Whitted => Some(Method::Whitted),
            MethodName::Direct => Some(Method::Direct),
            MethodName::Path => Some(Method::Path),
        }
    }

    fn label(self) -> &'static str {
        match self {
            MethodName::Zbuffer => "zbuffer",
            MethodName::Whitted => "whitted",
            MethodName::Direct => "direct",
            MethodName::Path => "path",
        }
    }
}

fn positive(text: &str) -> Result<f32, String> {
    let value: f32 = text.parse().map_err(|_| format!("`{text}` is no number"))?;
    if value > 0.0 && value.is_finite() { Ok(value) } else { Err(format!("must be more than 0, not {text}")) }
}

/// Samples where nothing else ends the render.
const DEFAULT_SPP: u32 = 64;
/// Samples where noise or time end it.
const MOST_SPP: u32 = 65_536;

/// What `--json` prints.
#[derive(Debug, Serialize)]
struct Report {
    width: u32,
    height: u32,
    /// Samples that every pixel has.
    spp: u32,
    /// In the mean; more than `spp` where noise was sought out.
    mean_spp: f64,
    threads: usize,
    method: &'static str,
    seed: u32,
    triangles: u64,
    lights: usize,
    /// Loading the studio and its files.
    load_s: f64,
    /// Trees and tables.
    build_s: f64,
    trace_s: f64,
    /// From the start of the process to the written file.
    wall_s: f64,
    /// From the start of the process to the first picture: of a large one, a coarse version.
    first_picture_s: f64,
    /// From the start of the process to the first sample of every pixel.
    first_wave_s: f64,
    rays: u64,
    /// Millions of rays a second, all threads.
    mrays_s: f64,
    /// Photons brought what mirrors and glass throw on surfaces.
    photons: bool,
    /// Estimated; null before there are two samples.
    noise_stops: Option<f32>,
    nonfinite: u64,
    interrupted: bool,
    output: String,
}

/// Renders and writes.
pub fn run(arguments: &Arguments, started: Instant) -> Result<(), Failure> {
    check_output(arguments)?;
    let control = Arc::new(RenderControl::new());
    let interrupted = stop_on_ctrl_c(&control)?;
    let pool = rayon::ThreadPoolBuilder::new()
        .num_threads(arguments.threads.unwrap_or(0).into())
        .build()
        .map_err(|error| Failure::Machine(anyhow!(error).context("can't start the threads")))?;
    let load_started = Instant::now();
    let loaded = pool.install(|| input::load_studio(&arguments.scene))?;
    let load_s = load_started.elapsed().as_secs_f64();
    let Some(method) = arguments.method.traced() else {
        return draw_zbuffer(arguments, &loaded, &pool, started, load_s);
    };
    let build_started = Instant::now();
    let mut scene = pool.install(|| raytrace::prepare(&loaded.scene, &loaded.assets))?;
    if arguments.caustics == Caustics::Paths {
        scene.set_plan(scene.plan().clone().without(Shortcut::Photons));
    }
    let build_s = build_started.elapsed().as_secs_f64();
    if arguments.explain {
        say_plan(&scene, arguments.json);
    }
    let settings = settings(arguments, &loaded, method);
    let trace_started = Instant::now();
    let coarse = settings
        .coarse()
        .map(|coarse| pool.install(|| raytrace::render(&scene, &coarse, &control, &mut |_| ControlFlow::Break(()))));
    let coarse_done = Instant::now();
    let (film, first_wave) = trace(arguments, &pool, &scene, &settings, &control);
    let trace_s = trace_started.elapsed().as_secs_f64();
    if film.spp() == 0 {
        return keep_coarse(arguments, &loaded, coarse.as_ref(), &settings);
    }
    let nonfinite = film.nonfinite();
    if let Some(SampleId { x, y, index, seed }) = nonfinite.first {
        eprintln!(
            "warning: {} non-finite contributions shown black; the first at pixel {x},{y}, sample {index}, seed {seed}",
            nonfinite.count
        );
    }
    write(arguments, &loaded, &film, &settings)?;
    let interrupted = interrupted.load(Ordering::Relaxed);
    let seconds = |then: Option<Instant>| then.map_or(0.0, |then| (then - started).as_secs_f64());
    let report = Report {
        width: film.width(),
        height: film.height(),
        spp: film.spp(),
        mean_spp: film.mean_spp(),
        threads: pool.current_num_threads(),
        method: arguments.method.label(),
        seed: arguments.seed,
        triangles: scene.triangle_count(),
        lights: scene.light_count(),
        load_s,
        build_s,
        trace_s,
        wall_s: started.elapsed().as_secs_f64(),
        first_picture_s: seconds(if coarse.is_some() { Some(coarse_done) } else { first_wave }),
        first_wave_s: seconds(first_wave),
        rays: control.rays(),
        mrays_s: control.rays() as f64 / trace_s.max(1e-9) / 1e6,
        photons: film.has_photons(),
        noise_stops: Some(film.noise_stops()).filter(|n| n.is_finite()),
        nonfinite: nonfinite.count,
        interrupted,
        output: arguments.output.display().to_string(),
    };
    tell(arguments, &report)?;
    if interrupted { Err(Failure::Interrupted) } else { Ok(()) }
}

/// Interrupted before the first sample of every pixel: of a large picture the coarse version is left.
fn keep_coarse(
    arguments: &Arguments,
    loaded: &Loaded,
    coarse: Option<&Film>,
    settings: &Settings,
) -> Result<(), Failure> {
    match coarse.filter(|film| film.spp() > 0) {
        Some(film) => {
            write(arguments, loaded, film, settings)?;
            eprintln!("interrupted before the first sample of every pixel was done; a coarse picture is kept");
        }
        None => eprintln!("interrupted before the first sample of every pixel was done; nothing is written"),
    }
    Err(Failure::Interrupted)
}

/// A wrong file name should not cost a rendering.
fn check_output(arguments: &Arguments) -> anyhow::Result<()> {
    let format = PictureFormat::of(&arguments.output)?;
    if arguments.layers && format != PictureFormat::Exr {
        return Err(anyhow!("--layers needs a picture that ends in .exr, not {}", arguments.output.display()));
    }
    let folder = arguments.output.parent().filter(|p| !p.as_os_str().is_empty());
    if let Some(folder) = folder.filter(|p| !p.is_dir()) {
        return Err(anyhow!("the folder of the picture does not exist: {}", folder.display()));
    }
    Ok(())
}

/// The first Ctrl+C ends the render and keeps its picture; the second ends the program.
fn stop_on_ctrl_c(control: &Arc<RenderControl>) -> Result<Arc<AtomicBool>, Failure> {
    let interrupted = Arc::new(AtomicBool::new(false));
    let (flag, control) = (interrupted.clone(), control.clone());
    ctrlc::set_handler(move || {
        if flag.swap(true, Ordering::Relaxed) {
            std::process::exit(130);
        }
        control.cancel();
    })
    .map_err(|error| Failure::Machine(anyhow!(error).context("can't listen for Ctrl+C")))?;
    Ok(interrupted)
}

/// Draws and writes without a ray. Samples are a square of pixels a pixel, 4 x 4 at most.
fn draw_zbuffer(
    arguments: &Arguments,
    loaded: &Loaded,
    pool: &rayon::ThreadPool,
    started: Instant,
    load_s: f64,
) -> Result<(), Failure> {
    if arguments.layers || arguments.explain {
        return Err(Failure::Input(anyhow!("--layers and --explain are for methods that trace, not for zbuffer")));
    }
    let (width, height) = arguments.size.unwrap_or_else(|| loaded.scene.camera.picture_size(960));
    let samples = arguments.spp.unwrap_or(1).isqrt().clamp(1, 4);
    let draw_started = Instant::now();
    let (picture, triangles) = pool.install(|| zbuffer::picture(loaded, (width, height), samples));
    let trace_s = draw_started.elapsed().as_secs_f64();
    let info = PictureInfo::new(&loaded.scene.camera, "zbuffer", samples * samples, arguments.seed.into());
    let first_picture_s = started.elapsed().as_secs_f64();
    io::export_picture(&arguments.output, &picture, &info)?;
    let report = Report {
        width,
        height,
        spp: samples * samples,
        mean_spp: f64::from(samples * samples),
        threads: pool.current_num_threads(),
        method: arguments.method.label(),
        seed: arguments.seed,
        triangles,
        lights: loaded.scene.lights.iter().filter(|light| light.on).count(),
        load_s,
        build_s: 0.0,
        trace_s,
        wall_s: started.elapsed().as_secs_f64(),
        first_picture_s,
        first_wave_s: first_picture_s,
        rays: 0,
        mrays_s: 0.0,
        photons: false,
        noise_stops: None,
        nonfinite: 0,
        interrupted: false,
        output: arguments.output.display().to_string(),
    };
    Ok(tell(arguments, &report)?)
}

fn settings(arguments: &Arguments, loaded: &Loaded, method: Method) -> Settings {
    let (width, height) = arguments.size.unwrap_or_else(|| loaded.scene.camera.picture_size(960));
    let open_ended = arguments.noise.is_some() || arguments.time.is_some();
    Settings {
        width,
        height,
        method,
        spp: arguments.spp.unwrap_or(if open_ended { MOST_SPP } else { DEFAULT_SPP }),
        max_depth: arguments.max_depth,
        seed: arguments.seed,
        noise_stops: arguments.noise,
    }
}

fn say_plan(scene: &RenderScene, json: bool) {
    // With --json stdout belongs to the JSON object.
    let text = scene.plan().to_string();
    if json { eprint!("{text}") } else { say(text.trim_end()) }
}

/// Traces with a progress bar. Also returns when the first sample of every pixel was there.
fn trace(
    arguments: &Arguments,
    pool: &rayon::ThreadPool,
    scene: &RenderScene,
    settings: &Settings,
    control: &RenderControl,
) -> (Film, Option<Instant>) {
    let started = Instant::now();
    let limit = arguments.time.map(Duration::from_secs_f32);
    let finished = AtomicBool::new(false);
    let first_done = AtomicBool::new(false);
    let mut first_picture = None;
    let film = std::thread::scope(|scope| {
        scope.spawn(|| watch(settings, control, started, limit, &first_done, &finished));
        let film = pool.install(|| {
            raytrace::render(scene, settings, control, &mut |_| {
                first_picture.get_or_insert_with(Instant::now);
                first_done.store(true, Ordering::Relaxed);
                let over = limit.is_some_and(|limit| started.elapsed() >= limit);
                if over { ControlFlow::Break(()) } else { ControlFlow::Continue(()) }
            })
        });
        finished.store(true, Ordering::Relaxed);
        film
    });
    (film, first_picture)
}

/// Draws the progress bar, and ends the render when its time is over (but not before there is a picture).
fn watch(
    settings: &Settings,
    control: &RenderControl,
    started: Instant,
    limit: Option<Duration>,
    first_done: &AtomicBool,
    finished: &AtomicBool,
) {
    let pixels = u64::from(settings.width) * u64::from(settings.height);
    let bar = ProgressBar::new(pixels * u64::from(settings.spp));
    if let Ok(style) = ProgressStyle::with_template("{bar:40} {percent:>3} %  {msg}  {eta} left") {
        bar.set_style(style);
    }
    let mut last_drawn = started;
    while !finished.load(Ordering::Relaxed) {
        std::thread::sleep(Duration::from_millis(5));
        let elapsed = started.elapsed();
        if first_done.load(Ordering::Relaxed) && limit.is_some_and(|limit| elapsed >= limit) {
            control.cancel();
        }
        if last_drawn.elapsed() > Duration::from_millis(100) {
            last_drawn = Instant::now();
            let samples = control.samples_done();
            let mrays_s = control.rays() as f64 / elapsed.as_secs_f64() / 1e6;
            bar.set_message(format!("{} samples a pixel, {mrays_s:.1} Mrays/s", samples / pixels.max(1)));
            bar.set_position(samples);
        }
    }
    bar.finish_and_clear();
}

/// Writes the picture in the size that was asked for, whatever size the film has.
fn write(arguments: &Arguments, loaded: &Loaded, film: &Film, settings: &Settings) -> anyhow::Result<()> {
    let camera = &loaded.scene.camera;
    let info = PictureInfo::new(camera, film.method(), film.spp(), arguments.seed.into());
    let (width, height) = (settings.width, settings.height);
    let picture = film.develop(&loaded.scene).resized(width, height);
    if arguments.layers {
        let layers = film.develop_layers(&loaded.scene).into_iter();
        let layers: Vec<_> = layers.map(|(name, layer)| (name, layer.resized(width, height))).collect();
        io::export_layers(&arguments.output, &picture, &layers, &info)?;
    } else {
        io::export_picture(&arguments.output, &picture, &info)?;
    }
    Ok(())
}

fn tell(arguments: &Arguments, report: &Report) -> anyhow::Result<()> {
    if arguments.json {
        say(serde_json::to_string(report).context("can't write the statistics")?);
    } else {
        let noise = report.noise_stops.map_or(String::new(), |n| format!(", noise {n:.2} stops"));
        eprintln!(
            "{}: {}x{}, {:.0} samples a pixel in {:.2} s, {:.1} Mrays/s{noise}",
            report.output, report.width, report.height, report.mean_spp, report.trace_s, report.mrays_s
        );
    }
    Ok(())
}

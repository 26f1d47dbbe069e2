//! `catchlight render SCENE -o OUT`: renders a picture without a window.

mod arguments;
mod checkpoints;
mod explain_pixel;
mod interrupt;
mod part;
mod progress;
mod progress_bar;
mod progress_updates;
mod report;

pub use arguments::Arguments;

use super::denoised_output::{Denoise, Output, Written};
use super::failure::Failure;
use super::{input, picture_output, terminal, zbuffer};
use crate::io::{self, LayeredPicture, Loaded, PictureInfo};
use crate::jobs::{self, Bytes, RenderInput, RenderMemory, RenderMonitor, RenderStage, Rendered};
use crate::raytrace::{Film, GeometryCache, NonFiniteReport, RenderControl, RenderScene, Settings};
use anyhow::anyhow;
use checkpoints::Checkpoints;
use interrupt::cancel_on_signals;
use progress::ProgressDisplay;
use rayon::ThreadPool;
use report::RenderReport;
use std::sync::Arc;
use std::sync::atomic::Ordering;
use std::time::Instant;

/// Renders, writes the picture and prints the statistics.
pub fn run(arguments: &Arguments, started: Instant) -> Result<(), Failure> {
    let control: Arc<RenderControl> = Arc::default();
    let interrupted = cancel_on_signals(&control)?;
    arguments.check_output()?;
    let samples = arguments.part()?;
    let pool = input::thread_pool(arguments.threads())?;
    // Load the studio.
    let load_started = Instant::now();
    let loaded = pool.install(|| arguments.studio.load())?;
    let load_s = load_started.elapsed().as_secs_f64();
    let Some(method) = arguments.method.traced() else {
        return draw_zbuffer(arguments, &loaded, &pool, started, load_s);
    };
    let settings = arguments.settings(&loaded.scene.camera, method);
    if let Some(pixel) = arguments.explain_pixel {
        let explain = || explain_pixel::run(arguments, &loaded, &settings, pixel);
        return Ok(pool.install(explain)?);
    }
    if let Some(samples) = samples {
        let part = part::PartRender { arguments, loaded: &loaded, settings: &settings, pool: &pool, started, load_s };
        return part.run(samples, control, &interrupted);
    }
    // Render with a progress bar.
    let monitor = Arc::new(RenderMonitor::new(&settings, control));
    let mut checkpoints = Checkpoints::new(arguments, &loaded, &settings);
    let rendered = render(arguments, &loaded, &settings, &pool, &monitor, &mut checkpoints)?;
    // Write the picture.
    let film = &rendered.film;
    if film.spp() == 0 {
        return pool.install(|| keep_coarse(arguments, &loaded, rendered.coarse.as_ref(), &settings));
    }
    let nonfinite = film.nonfinite();
    warn_of_nonfinite(arguments, &settings, &nonfinite);
    let interrupted = interrupted.load(Ordering::Relaxed);
    let Written { picture: written, denoise_s } = pool.install(|| write(arguments, &loaded, film, &settings))?;
    // Print the statistics.
    let seconds = |then: Option<Instant>| then.map_or(0.0, |then| (then - started).as_secs_f64());
    let rays = monitor.control().rays();
    let report = RenderReport {
        width: film.width(),
        height: film.height(),
        spp: film.spp(),
        mean_spp: film.mean_spp(),
        threads: pool.current_num_threads(),
        method: arguments.method.label(),
        seed: arguments.seed,
        triangles: rendered.scene.triangle_count(),
        lights: rendered.scene.light_count(),
        load_s,
        build_s: rendered.build_s,
        trace_s: rendered.trace_s,
        denoise_s,
        wall_s: started.elapsed().as_secs_f64(),
        first_picture_s: seconds(monitor.first_picture()),
        first_wave_s: seconds(monitor.first_pass()),
        rays,
        mrays_s: rays as f64 / rendered.trace_s.max(1e-9) / 1e6,
        photons: film.approximations().photons,
        noise_stops: Some(film.noise_stops()).filter(|n| n.is_finite()),
        nonfinite: nonfinite.count,
        interrupted,
        output: written.path.display().to_string(),
    };
    report.print(arguments.json)?;
    written.finish()?;
    if !interrupted {
        checkpoints.remove();
    }
    if interrupted { Err(Failure::Interrupted) } else { Ok(()) }
}

/// Renders with a progress bar, and prints the render plan if that is requested.
fn render(
    arguments: &Arguments,
    loaded: &Loaded,
    settings: &Settings,
    pool: &ThreadPool,
    monitor: &Arc<RenderMonitor>,
    checkpoints: &mut Checkpoints<'_>,
) -> Result<Rendered, Failure> {
    let earlier = checkpoints.resume(arguments)?;
    let input = RenderInput {
        scene: &loaded.scene,
        assets: &loaded.assets,
        cache: &GeometryCache::default(),
        settings,
        without: arguments.without(),
        checkpoint: earlier.as_deref(),
        time_limit: arguments.time_limit(),
        memory: None,
        snapshots: arguments.checkpoint_interval().is_some(),
    };
    let mut display = None;
    let rendered = jobs::render(&input, pool, monitor, &mut |stage| match stage {
        RenderStage::Prepared(scene, memory) => {
            tell_memory(memory, arguments.explain);
            if arguments.explain {
                print_plan(scene, arguments.json);
            }
            display = Some(ProgressDisplay::start(monitor.clone(), arguments.progress));
        }
        RenderStage::Coarse(_) => {}
        RenderStage::Pass(film) => checkpoints.after_pass(film),
    });
    drop(display);
    checkpoints.finish_writing();
    Ok(rendered?)
}

/// Prints the render plan: on stderr with `--json`, whose object is alone on stdout.
fn print_plan(scene: &RenderScene, json: bool) {
    let text = scene.plan().to_string();
    if json { terminal::progress(text.trim_end()) } else { terminal::result(text.trim_end()) }
}

/// Tells the memory of a large picture, or of any that is explained, and warns if lights share layers for want of it.
fn tell_memory(memory: RenderMemory, explain: bool) {
    const LARGE: Bytes = Bytes(1 << 30);
    if explain || memory.need >= LARGE {
        terminal::progress(memory);
    }
    memory.sharing().iter().for_each(terminal::warning);
}

/// Warns of non-finite contributions, with the command that replays the first.
fn warn_of_nonfinite(arguments: &Arguments, settings: &Settings, nonfinite: &NonFiniteReport) {
    if let Some(sample) = nonfinite.first {
        terminal::warning(format_args!(
            "{} non-finite contributions shown black; trace the first again with\n  {}",
            nonfinite.count,
            arguments.replay_command(settings, sample)
        ));
    }
}

/// Keeps the coarse version of a large picture that was interrupted before the first sample of every pixel.
fn keep_coarse(
    arguments: &Arguments,
    loaded: &Loaded,
    coarse: Option<&Film>,
    settings: &Settings,
) -> Result<(), Failure> {
    const EARLY: &str = "interrupted before the first sample of every pixel was done";
    match coarse.filter(|film| film.spp() > 0) {
        Some(film) => {
            let written = write(arguments, loaded, film, settings)?.picture;
            terminal::progress(format_args!("{EARLY}; a coarse picture is kept"));
            written.finish()?;
        }
        None => terminal::progress(format_args!("{EARLY}; nothing is written")),
    }
    Err(Failure::Interrupted)
}

/// Draws and writes the picture of the z-buffer. Samples are a square of subpixels, 4 x 4 at most.
fn draw_zbuffer(
    arguments: &Arguments,
    loaded: &Loaded,
    pool: &ThreadPool,
    started: Instant,
    load_s: f64,
) -> Result<(), Failure> {
    let denoise = arguments.denoise != Denoise::Off;
    if arguments.layers || arguments.explain || arguments.aovs || denoise || arguments.explain_pixel.is_some() {
        return Err(Failure::Input(anyhow!(
            "--layers, --aovs, --denoise, --explain and --explain-pixel are for methods that trace, not for zbuffer"
        )));
    }
    let (width, height) = arguments.picture_size(&loaded.scene.camera);
    let side = arguments.spp.unwrap_or(1).isqrt().clamp(1, 4);
    let draw_started = Instant::now();
    let (picture, triangles) = pool.install(|| zbuffer::picture(loaded, (width, height), side));
    let trace_s = draw_started.elapsed().as_secs_f64();
    let info = PictureInfo::new(&loaded.scene, "zbuffer", side * side, arguments.seed.into());
    let first_picture_s = started.elapsed().as_secs_f64();
    let written = picture_output::write(&io::picture_file(
        arguments.output(),
        LayeredPicture::alone(&picture),
        None,
        None,
        &info,
    )?)?;
    let report = RenderReport {
        width,
        height,
        spp: side * side,
        mean_spp: f64::from(side * side),
        threads: pool.current_num_threads(),
        method: arguments.method.label(),
        seed: arguments.seed,
        triangles,
        lights: loaded.scene.lights.iter().filter(|light| light.on).count(),
        load_s,
        build_s: 0.0,
        trace_s,
        denoise_s: None,
        wall_s: started.elapsed().as_secs_f64(),
        first_picture_s,
        first_wave_s: first_picture_s,
        rays: 0,
        mrays_s: 0.0,
        photons: false,
        noise_stops: None,
        nonfinite: 0,
        interrupted: false,
        output: written.path.display().to_string(),
    };
    report.print(arguments.json)?;
    written.finish()
}

/// Writes the picture in the requested size, for a film of any size.
fn write(arguments: &Arguments, loaded: &Loaded, film: &Film, settings: &Settings) -> Result<Written, Failure> {
    let output = Output {
        path: arguments.output(),
        size: (settings.width, settings.height),
        picture: film.develop(&loaded.scene),
        layers: if arguments.layers { film.lazy_layers(&loaded.scene) } else { Vec::new() },
        aovs: film.aovs(),
        info: PictureInfo::new(&loaded.scene, &film.method(), film.spp(), arguments.seed.into()),
    };
    output.write(arguments.denoise)
}

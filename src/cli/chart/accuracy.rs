//! `catchlight chart [SCENE ...] -o DIR`: the error of every method against its time, compared with the converged
//! path-traced picture.
//!
//! Five errors are stated. The relative mean squared error is the mean over pixels and channels of (x - r)^2 / (r^2 +
//! 0.01^2) with r from the reference; the constant, four stops below a grey card, bounds the error of black pixels. FLIP is
//! the mean difference that people see on a display. The median and the 95th percentile are those of the luminance error over the pixels, in stops. The bias is the error of
//! the mean luminance, in stops, in which noise nearly vanishes. Time is that of tracing on all cores; BVHs are built
//! once.

use super::accuracy_row::{AccuracyRow, Study, csv, markdown};
use super::picture_error::PictureError;
use super::{drawing, front, reference};
use crate::cli::failure::Failure;
use crate::cli::input::{load_studio, thread_pool};
use crate::cli::{terminal, zbuffer};
use crate::denoise::{Quality, denoise};
use crate::io::Loaded;
use crate::jobs::render_all_passes;
use crate::math::simd;
use crate::photo::Picture;
use crate::raytrace::{self, Method, RenderControl, RenderScene, Settings, Shortcut};
use anyhow::Context;
use std::path::{Path, PathBuf};
use std::time::Instant;

/// Seed of the reference. Measurements have seed 0.
const REFERENCE_SEED: u32 = 7;
/// Numbers of bounces in the study of time and error against depth.
const DEPTHS: [u32; 4] = [1, 2, 4, 8];
const METHODS: [(Method, &str); 3] = [(Method::Whitted, "whitted"), (Method::Direct, "direct"), (Method::Path, "path")];

/// Studios and numbers of the chart.
#[derive(Clone, Copy, Debug)]
pub struct AccuracyInput<'a> {
    /// Studios; the default ones if empty.
    pub scenes: &'a [PathBuf],
    /// Picture size, pixels.
    pub size: (u32, u32),
    /// Largest number of samples per pixel.
    pub spp: u32,
    /// Samples per pixel of the reference; 32 times `spp` if none.
    pub reference_spp: Option<u32>,
    /// Prints JSON instead of a table.
    pub json: bool,
}

/// Measures, and writes the files of the chart into `folder`.
pub fn run(input: &AccuracyInput<'_>, folder: &Path) -> Result<(), Failure> {
    std::fs::create_dir_all(folder).with_context(|| format!("can't make the folder: {}", folder.display()))?;
    let default = [PathBuf::from("three_point"), PathBuf::from("product_still_life")];
    let scenes = if input.scenes.is_empty() { &default[..] } else { input.scenes };
    let (mut rows, mut best, mut times) = (Vec::new(), Vec::new(), Vec::new());
    for path in scenes {
        let loaded = load_studio(path)?;
        let measured = measure(input, folder, &loaded)?;
        let stem = path.file_stem().map_or("studio".into(), |stem| stem.to_string_lossy().into_owned());
        drawing::draw(&folder.join(format!("{stem}.svg")), &loaded.scene.name, &measured)?;
        best.extend(front::best_in_time(&measured));
        times.extend(front::times_to_error(&measured));
        rows.extend(measured);
    }
    write(&folder.join("chart.csv"), &csv(&rows))?;
    let (table, summary) = (markdown(&rows), front::markdown(&best, &times));
    write(&folder.join("chart.md"), &table)?;
    write(&folder.join("front.md"), &summary)?;
    if input.json {
        terminal::result(serde_json::to_string(&rows).context("can't write the results")?);
    } else {
        terminal::result(table);
        terminal::result(summary.trim_end());
    }
    Ok(())
}

/// A studio with the values that its measurements share.
struct StudioStudy<'a> {
    name: &'a str,
    loaded: &'a Loaded,
    scene: RenderScene,
    size: (u32, u32),
    reference: Picture,
}

fn measure(input: &AccuracyInput<'_>, folder: &Path, loaded: &Loaded) -> Result<Vec<AccuracyRow>, Failure> {
    let (size, cores) = (input.size, std::thread::available_parallelism().map_or(1, usize::from));
    let mut scene = raytrace::prepare(&loaded.scene, &loaded.assets)?;
    let reference_spp = input.reference_spp.unwrap_or(32 * input.spp);
    let converged = Settings { spp: reference_spp, seed: REFERENCE_SEED, ..settings(size, Method::Path) };
    let plan = scene.plan().clone();
    scene.set_plan(plan.clone().without_blur());
    let reference = reference::load_or_render(folder, loaded, &scene, &converged);
    scene.set_plan(plan);
    let mut studio = StudioStudy { name: &loaded.scene.name, loaded, scene, size, reference };
    let mut rows = Vec::new();
    for side in [1, 2, 4].into_iter().filter(|side| side * side <= input.spp) {
        rows.push(studio.zbuffer(side, cores));
    }
    for (method, label) in METHODS {
        let mut spp = 1;
        while spp <= input.spp {
            rows.push(studio.row(
                Study::Method,
                label.to_owned(),
                Settings { spp, ..settings(size, method) },
                cores,
            )?);
            spp *= 4;
        }
    }
    let mut spp = 1;
    while spp <= input.spp {
        rows.push(studio.denoised(Settings { spp, aovs: true, ..settings(size, Method::Path) }, cores)?);
        spp *= 4;
    }
    let spp = input.spp.min(16);
    for depth in DEPTHS {
        let shallow = Settings { spp, max_depth: Some(depth), ..settings(size, Method::Path) };
        rows.push(studio.row(Study::Bounces, format!("path, {depth} bounces"), shallow, cores)?);
    }
    for threads in 1..cores {
        let narrow = Settings { spp, ..settings(size, Method::Path) };
        rows.push(studio.row(Study::Threads, format!("path, {threads} of {cores} threads"), narrow, threads)?);
    }
    if simd::has_avx2() {
        let portable = Settings { spp, ..settings(size, Method::Path) };
        rows.push(simd::without_avx2(|| studio.row(Study::Simd, "path, without AVX2".to_owned(), portable, cores))?);
    }
    let plan = studio.scene.plan().clone();
    for shortcut in Shortcut::ALL {
        let longer = plan.clone().without(shortcut);
        if longer != plan {
            studio.scene.set_plan(longer);
            let label = format!("path, without: {}", shortcut.label());
            rows.push(studio.row(Study::Plan, label, Settings { spp, ..settings(size, Method::Path) }, cores)?);
        }
    }
    Ok(rows)
}

fn settings((width, height): (u32, u32), method: Method) -> Settings {
    Settings { width, height, method, ..Settings::default() }
}

impl StudioStudy<'_> {
    /// Measures the z-buffer with `side` x `side` subpixels per pixel.
    fn zbuffer(&self, side: u32, threads: usize) -> AccuracyRow {
        let started = Instant::now();
        let (picture, _) = zbuffer::picture(self.loaded, self.size, side);
        let trace_s = started.elapsed().as_secs_f64();
        self.compare(Study::Method, "zbuffer".to_owned(), (side * side, threads), trace_s, 0, &picture)
    }

    /// Measures a ray-traced picture.
    fn row(&self, study: Study, method: String, settings: Settings, threads: usize) -> Result<AccuracyRow, Failure> {
        let pool = thread_pool(threads)?;
        let control = RenderControl::new();
        let started = Instant::now();
        let film = pool.install(|| render_all_passes(&self.scene, &settings, &control));
        let trace_s = started.elapsed().as_secs_f64();
        let picture = film.develop(&self.loaded.scene);
        Ok(self.compare(study, method, (settings.spp, threads), trace_s, control.rays(), &picture))
    }

    /// Measures a path-traced picture after the denoiser, whose time counts.
    fn denoised(&self, settings: Settings, threads: usize) -> Result<AccuracyRow, Failure> {
        let pool = thread_pool(threads)?;
        let control = RenderControl::new();
        let started = Instant::now();
        let picture = pool.install(|| {
            let film = render_all_passes(&self.scene, &settings, &control);
            let aovs = film.aovs()?;
            denoise(&film.develop(&self.loaded.scene), &aovs, Quality::Best, &|| false).ok()
        });
        let picture =
            picture.ok_or_else(|| Failure::Machine(anyhow::anyhow!("the picture has no albedo and normals")))?;
        let trace_s = started.elapsed().as_secs_f64();
        let label = "path + denoiser".to_owned();
        Ok(self.compare(Study::Method, label, (settings.spp, threads), trace_s, control.rays(), &picture))
    }

    fn compare(
        &self,
        study: Study,
        method: String,
        (spp, threads): (u32, usize),
        trace_s: f64,
        rays: u64,
        picture: &Picture,
    ) -> AccuracyRow {
        let error = PictureError::new(picture, &self.reference);
        terminal::progress(format_args!(
            "{}: {method}, {spp} samples: {trace_s:.3} s, error {:.2e}",
            self.name, error.rel_mse
        ));
        let mrays_s = rays as f64 / trace_s.max(1e-9) / 1e6;
        let scene = self.name.to_owned();
        AccuracyRow { scene, study, method, spp, threads, trace_s, mrays_s, error }
    }
}

fn write(path: &Path, text: &str) -> anyhow::Result<()> {
    std::fs::write(path, text).with_context(|| format!("can't write {}", path.display()))
}

//! `catchlight chart [SCENE ...] -o DIR`: every method's error against its time, beside the converged path-traced
//! picture.
//!
//! Error is the mean over pixels and colours of (x - r)^2 / (r^2 + 0.01^2), r from the reference (relative mean squared
//! error; the small term, four stops under a grey card, keeps black pixels from counting without bound), the median and
//! the 95th percentile over pixels of the error in stops of luminance, and the bias: how many stops the mean of the
//! whole picture is over the reference's, where noise has nearly gone. Time is tracing alone, on all cores; trees are
//! built once.

use super::{Arguments, drawing, reference};
use crate::cli::{Failure, input, say, zbuffer};
use crate::color::luminance;
use crate::io::Loaded;
use crate::photo::Picture;
use crate::raytrace::{self, Method, RenderControl, RenderScene, Settings, Shortcut};
use anyhow::Context;
use glam::Vec3;
use serde::Serialize;
use std::fmt::Write;
use std::ops::ControlFlow;
use std::path::{Path, PathBuf};
use std::time::Instant;

/// One measured point.
#[derive(Clone, Debug, Serialize)]
pub struct Row {
    /// The studio's name.
    pub scene: String,
    /// What was varied.
    pub study: Vary,
    /// Its value: a method, a number of threads, a number of bounces, a shortcut of the plan.
    pub method: String,
    /// Samples a pixel.
    pub spp: u32,
    threads: usize,
    /// Tracing, seconds.
    pub trace_s: f64,
    mrays_s: f64,
    /// Relative mean squared error against the reference.
    pub rel_mse: f64,
    /// Over pixels, stops of luminance.
    median_stops: f64,
    stops_95: f64,
    /// Of the picture's mean, stops.
    bias_stops: f64,
}

/// What a part of the chart varies.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "lowercase")]
pub enum Vary {
    /// Methods, and samples a pixel.
    Method,
    /// The path tracer's depth.
    Bounces,
    /// Its threads.
    Threads,
    /// Its plan, with one shortcut undone.
    Plan,
}

/// Seed of the reference; measurements have seed 0.
const REFERENCE_SEED: u32 = 7;
/// Bounces of the study of time and error against depth.
const DEPTHS: [u32; 4] = [1, 2, 4, 8];
/// Picture value below which no difference is seen.
const DARKEST: f64 = 6e-4;
const METHODS: [(Method, &str); 3] = [(Method::Whitted, "whitted"), (Method::Direct, "direct"), (Method::Path, "path")];

/// Measures, and writes the folder.
pub fn run(arguments: &Arguments, folder: &Path) -> Result<(), Failure> {
    std::fs::create_dir_all(folder).with_context(|| format!("can't make the folder: {}", folder.display()))?;
    let default = [PathBuf::from("three_point"), PathBuf::from("product_still_life")];
    let scenes = if arguments.scenes.is_empty() { &default[..] } else { &arguments.scenes };
    let mut rows = Vec::new();
    for path in scenes {
        let loaded = input::load_studio(path)?;
        let measured = measure(arguments, folder, &loaded)?;
        let stem = path.file_stem().map_or("studio".into(), |stem| stem.to_string_lossy().into_owned());
        drawing::draw(&folder.join(format!("{stem}.svg")), &loaded.scene.name, &measured)?;
        rows.extend(measured);
    }
    write(&folder.join("chart.csv"), &csv(&rows))?;
    let table = markdown(&rows);
    write(&folder.join("chart.md"), &table)?;
    if arguments.json {
        say(serde_json::to_string(&rows).context("can't write the results")?);
    } else {
        say(table.trim_end());
    }
    Ok(())
}

/// A studio with what the measurements share.
struct Study<'a> {
    name: &'a str,
    loaded: &'a Loaded,
    scene: RenderScene,
    size: (u32, u32),
    reference: Picture,
}

fn measure(arguments: &Arguments, folder: &Path, loaded: &Loaded) -> Result<Vec<Row>, Failure> {
    let (size, cores) = (arguments.size, std::thread::available_parallelism().map_or(1, usize::from));
    let mut scene = raytrace::prepare(&loaded.scene, &loaded.assets)?;
    let reference_spp = arguments.reference_spp.unwrap_or(32 * arguments.spp);
    let converged = Settings { spp: reference_spp, seed: REFERENCE_SEED, ..settings(size, Method::Path) };
    // What the others are held to blurs nothing.
    let plan = scene.plan().clone();
    scene.set_plan(plan.clone().without(Shortcut::Photons));
    let reference = reference::of(folder, loaded, &scene, &converged);
    scene.set_plan(plan);
    let mut study = Study { name: &loaded.scene.name, loaded, scene, size, reference };
    let mut rows = Vec::new();
    for side in [1, 2, 4].into_iter().filter(|side| side * side <= arguments.spp) {
        rows.push(study.zbuffer(side, cores));
    }
    for (method, label) in METHODS {
        let mut spp = 1;
        while spp <= arguments.spp {
            rows.push(study.row(Vary::Method, label.to_owned(), Settings { spp, ..settings(size, method) }, cores)?);
            spp *= 4;
        }
    }
    let spp = arguments.spp.min(16);
    for depth in DEPTHS {
        let shallow = Settings { spp, max_depth: Some(depth), ..settings(size, Method::Path) };
        rows.push(study.row(Vary::Bounces, format!("path, {depth} bounces"), shallow, cores)?);
    }
    for threads in 1..cores {
        let narrow = Settings { spp, ..settings(size, Method::Path) };
        rows.push(study.row(Vary::Threads, format!("path, {threads} of {cores} threads"), narrow, threads)?);
    }
    let plan = study.scene.plan().clone();
    for shortcut in Shortcut::ALL {
        let longer = plan.clone().without(shortcut);
        if longer != plan {
            study.scene.set_plan(longer);
            let label = format!("path, without: {}", shortcut.label());
            rows.push(study.row(Vary::Plan, label, Settings { spp, ..settings(size, Method::Path) }, cores)?);
        }
    }
    Ok(rows)
}

fn settings((width, height): (u32, u32), method: Method) -> Settings {
    Settings { width, height, method, ..Settings::default() }
}

impl Study<'_> {
    /// The z-buffer, with `side` pixels along each side of a pixel.
    fn zbuffer(&self, side: u32, threads: usize) -> Row {
        let started = Instant::now();
        let (picture, _) = zbuffer::picture(self.loaded, self.size, side);
        let trace_s = started.elapsed().as_secs_f64();
        self.compare(Vary::Method, "zbuffer".to_owned(), (side * side, threads), trace_s, 0, &picture)
    }

    fn row(&self, study: Vary, method: String, settings: Settings, threads: usize) -> Result<Row, Failure> {
        let pool = rayon::ThreadPoolBuilder::new()
            .num_threads(threads)
            .build()
            .map_err(|error| Failure::Machine(anyhow::anyhow!(error).context("can't start the threads")))?;
        let control = RenderControl::new();
        let started = Instant::now();
        let film =
            pool.install(|| raytrace::render(&self.scene, &settings, &control, &mut |_| ControlFlow::Continue(())));
        let trace_s = started.elapsed().as_secs_f64();
        let picture = film.develop(&self.loaded.scene);
        Ok(self.compare(study, method, (settings.spp, threads), trace_s, control.rays(), &picture))
    }

    fn compare(
        &self,
        study: Vary,
        method: String,
        (spp, threads): (u32, usize),
        trace_s: f64,
        rays: u64,
        picture: &Picture,
    ) -> Row {
        let Error { rel_mse, median_stops, stops_95, bias_stops } = Error::new(picture, &self.reference);
        eprintln!("{}: {method}, {spp} samples: {trace_s:.3} s, error {rel_mse:.2e}", self.name);
        let mrays_s = rays as f64 / trace_s.max(1e-9) / 1e6;
        let scene = self.name.to_owned();
        Row { scene, study, method, spp, threads, trace_s, mrays_s, rel_mse, median_stops, stops_95, bias_stops }
    }
}

/// How far a picture is from the reference.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Error {
    rel_mse: f64,
    median_stops: f64,
    stops_95: f64,
    bias_stops: f64,
}

impl Error {
    fn new(picture: &Picture, reference: &Picture) -> Self {
        let (mut sum, mut mean, mut true_mean) = (0.0, 0.0, 0.0);
        let mut stops: Vec<f64> = Vec::with_capacity(picture.rgb.len());
        for (ours, truth) in picture.rgb.iter().zip(&reference.rgb) {
            for (x, r) in ours.iter().zip(truth).map(|(&x, &r)| (f64::from(x), f64::from(r))) {
                sum += (x - r).powi(2) / (r * r + 1e-4);
            }
            let bright = |rgb: &[f32; 3]| f64::from(luminance(Vec3::from(*rgb)));
            let (ours, truth) = (bright(ours), bright(truth));
            mean += ours;
            true_mean += truth;
            // Four stops under a hundredth of white nobody sees stops.
            stops.push((ours.max(DARKEST) / truth.max(DARKEST)).log2().abs());
        }
        stops.sort_by(f64::total_cmp);
        let last = stops.len().saturating_sub(1) as f64;
        let at = |part: f64| stops.get((last * part).round() as usize).copied().unwrap_or(0.0);
        Error {
            rel_mse: sum / (3 * picture.rgb.len()).max(1) as f64,
            median_stops: at(0.5),
            stops_95: at(0.95),
            bias_stops: (mean.max(f64::MIN_POSITIVE) / true_mean.max(f64::MIN_POSITIVE)).log2(),
        }
    }
}

fn csv(rows: &[Row]) -> String {
    let mut text = "scene,method,spp,threads,trace_s,mrays_s,rel_mse,median_stops,stops_95,bias_stops\n".to_owned();
    for row in rows {
        let Row { scene, method, spp, threads, trace_s, mrays_s, rel_mse, median_stops, stops_95, bias_stops, .. } =
            row;
        let (scene, method) = (quoted(scene), quoted(method));
        // Writing to a String cannot fail.
        let _ = writeln!(
            text,
            "{scene},{method},{spp},{threads},{trace_s:.6},{mrays_s:.4},{rel_mse:.6e},{median_stops:.6},\
             {stops_95:.6},{bias_stops:.6}"
        );
    }
    text
}

/// A field of a csv file (RFC 4180).
fn quoted(text: &str) -> String {
    format!("\"{}\"", text.replace('"', "\"\""))
}

fn markdown(rows: &[Row]) -> String {
    let mut text = "| studio | method | samples | threads | seconds | Mrays/s | relative MSE | median, stops | 95 %, stops | bias, stops |\n\
                    |---|---|---|---|---|---|---|---|---|---|\n"
        .to_owned();
    for row in rows {
        let Row { scene, method, spp, threads, trace_s, mrays_s, rel_mse, median_stops, stops_95, bias_stops, .. } =
            row;
        let scene = scene.replace('|', "\\|");
        // Writing to a String cannot fail.
        let _ = writeln!(
            text,
            "| {scene} | {method} | {spp} | {threads} | {trace_s:.3} | {mrays_s:.2} | {rel_mse:.2e} \
             | {median_stops:.4} | {stops_95:.4} | {bias_stops:+.4} |"
        );
    }
    text
}

fn write(path: &Path, text: &str) -> anyhow::Result<()> {
    std::fs::write(path, text).with_context(|| format!("can't write {}", path.display()))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_picture_one_stop_over_is_one_stop_off() {
        let reference = Picture { width: 2, height: 1, rgb: vec![[0.2; 3], [0.5; 3]] };
        let over = Picture { rgb: vec![[0.4; 3], [1.0; 3]], ..reference.clone() };
        let Error { rel_mse, median_stops, stops_95, bias_stops } = Error::new(&over, &reference);
        assert!((rel_mse - 1.0).abs() < 2e-3, "{rel_mse}");
        assert!([median_stops, stops_95, bias_stops].iter().all(|stops| (stops - 1.0).abs() < 1e-6));
        let none = Error { rel_mse: 0.0, median_stops: 0.0, stops_95: 0.0, bias_stops: 0.0 };
        assert_eq!(Error::new(&reference, &reference), none);
    }

    #[test]
    fn names_with_commas_and_quotes_stay_one_field() {
        assert_eq!(quoted("a, \"b\""), "\"a, \"\"b\"\"\"");
    }
}

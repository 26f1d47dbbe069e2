//! `catchlight chart --noise`: the noise that renders state against their scatter over sixteen seeds.

use crate::cli::failure::Failure;
use crate::cli::input::load_studio;
use crate::cli::terminal;
use crate::color::luminance;
use crate::io;
use crate::raytrace::{self, Film, MIN_ESTIMATE_SPP, RenderControl, Settings, TILE};
use crate::scene::Scene;
use anyhow::Context;
use serde::Serialize;
use std::fmt::Write;
use std::ops::ControlFlow;
use std::path::PathBuf;

/// Number of renders of each studio.
const SEEDS: u32 = 16;

/// A studio with a number of samples.
#[derive(Debug, Serialize)]
struct NoiseRow {
    studio: String,
    /// Samples per pixel.
    spp: u32,
    /// Relative error of a pixel by the scatter over the seeds: the root mean square over the tiles.
    scatter: f64,
    /// Relative error as estimated, over the scatter: the root mean square over tiles and seeds.
    ratio: f64,
}

/// The tiles of the renders with one number of samples.
struct Renders {
    spp: u32,
    /// Luminance of each pixel: sum and sum of squares over the seeds.
    pixels: Vec<[f64; 2]>,
    /// Sum over the seeds of the squared relative error that each tile states.
    stated: Vec<f64>,
}

/// Measures and prints, for 4, 8, 16 ... samples up to `spp`. Without scenes, all shipped studios are measured.
pub fn run(scenes: &[PathBuf], size: (u32, u32), spp: u32, json: bool) -> Result<(), Failure> {
    let shipped: Vec<PathBuf> = io::presets().iter().map(|preset| preset.file_name.into()).collect();
    let mut rows = Vec::new();
    for path in if scenes.is_empty() { &shipped } else { scenes } {
        terminal::progress(format_args!("{} ...", path.display()));
        let loaded = load_studio(path)?;
        let prepared = raytrace::prepare(&loaded.scene, &loaded.assets)?;
        let mut renders: Vec<Renders> = Vec::new();
        for seed in 0..SEEDS {
            let settings = Settings { width: size.0, height: size.1, spp, seed, ..Settings::default() };
            raytrace::render(&prepared, &settings, &RenderControl::new(), &mut |film| {
                add_render(&mut renders, film, &loaded.scene);
                ControlFlow::Continue(())
            });
        }
        rows.extend(renders.iter().filter_map(|renders| renders.row(&loaded.scene.name, size)));
    }
    if json {
        terminal::result(serde_json::to_string(&rows).context("can't write the results")?);
    } else {
        terminal::result(table(&rows).trim_end());
    }
    Ok(())
}

fn add_render(all: &mut Vec<Renders>, film: &Film, scene: &Scene) {
    let spp = film.spp();
    if spp < MIN_ESTIMATE_SPP || !spp.is_power_of_two() {
        return;
    }
    let picture = film.develop(scene);
    let noise = film.tile_noise_stops();
    let index = all.iter().position(|renders| renders.spp == spp).unwrap_or_else(|| {
        all.push(Renders { spp, pixels: vec![[0.0; 2]; picture.rgb.len()], stated: vec![0.0; noise.len()] });
        all.len() - 1
    });
    for ([sum, squares], rgb) in all[index].pixels.iter_mut().zip(&picture.rgb) {
        let value = f64::from(luminance((*rgb).into()));
        *sum += value;
        *squares += value * value;
    }
    for (stated, noise) in all[index].stated.iter_mut().zip(noise) {
        // A tile that is too dark states nothing
        *stated += noise.map_or(f64::NAN, |noise| (f64::from(noise).exp2() - 1.0).powi(2));
    }
}

impl Renders {
    /// Returns the row of a studio; none if it is too dark.
    fn row(&self, studio: &str, (width, height): (u32, u32)) -> Option<NoiseRow> {
        let seeds = f64::from(SEEDS);
        let tiles_across = width.div_ceil(TILE);
        // Variance and mean of each tile
        let mut tiles = vec![[0.0; 3]; self.stated.len()];
        for (pixel, [sum, squares]) in (0..width * height).zip(&self.pixels) {
            let tile = (pixel / width / TILE) * tiles_across + pixel % width / TILE;
            let [variances, means, pixels] = &mut tiles[tile as usize];
            *variances += (squares - sum * sum / seeds) / (seeds - 1.0);
            *means += sum / seeds;
            *pixels += 1.0;
        }
        let scatter = tiles.iter().map(|[variances, means, pixels]| variances * pixels / (means * means));
        let known: Vec<(f64, f64)> = scatter
            .zip(&self.stated)
            .filter(|(scatter, stated)| *scatter > 0.0 && !stated.is_nan())
            .map(|(s, e)| (s, e / seeds))
            .collect();
        let mean = |values: &mut dyn Iterator<Item = f64>| values.sum::<f64>() / known.len() as f64;
        (!known.is_empty()).then(|| NoiseRow {
            studio: studio.to_owned(),
            spp: self.spp,
            scatter: mean(&mut known.iter().map(|(scatter, _)| *scatter)).sqrt(),
            ratio: mean(&mut known.iter().map(|(scatter, stated)| stated / scatter)).sqrt(),
        })
    }
}

fn table(rows: &[NoiseRow]) -> String {
    let mut text = "| studio | samples | error, % | stated over it |\n|---|---|---|---|\n".to_owned();
    for NoiseRow { studio, spp, scatter, ratio } in rows {
        let _ = writeln!(text, "| {studio} | {spp} | {:.2} | {ratio:.2} |", 100.0 * scatter);
    }
    text
}

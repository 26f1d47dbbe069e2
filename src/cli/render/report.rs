//! The statistics that `catchlight render` prints.

use crate::cli::terminal;
use anyhow::Context;
use serde::Serialize;

/// The object that `--json` prints.
#[derive(Debug, Serialize)]
pub struct RenderReport {
    /// Pixels across.
    pub width: u32,
    /// Pixels down.
    pub height: u32,
    /// Samples that every pixel has.
    pub spp: u32,
    /// Mean samples per pixel: more than `spp` with adaptive sampling.
    pub mean_spp: f64,
    /// Number of threads.
    pub threads: usize,
    /// Name of the method.
    pub method: &'static str,
    /// Seed of the noise pattern.
    pub seed: u32,
    /// Triangles in the studio, each instance counted.
    pub triangles: u64,
    /// Lights that are on.
    pub lights: usize,
    /// Time to load the studio and its files.
    pub load_s: f64,
    /// Time to build BVHs and tables.
    pub build_s: f64,
    /// Time to trace.
    pub trace_s: f64,
    /// Time to denoise; null for a picture that is not denoised.
    pub denoise_s: Option<f64>,
    /// Time from the start of the process to the written file.
    pub wall_s: f64,
    /// Time from the start of the process to the first picture: of a large one, a coarse version.
    pub first_picture_s: f64,
    /// Time from the start of the process to the first sample of every pixel.
    pub first_wave_s: f64,
    /// Rays traced.
    pub rays: u64,
    /// Millions of rays per second, all threads.
    pub mrays_s: f64,
    /// Caustics come from photons.
    pub photons: bool,
    /// Estimated noise; null before there are four samples.
    pub noise_stops: Option<f32>,
    /// Non-finite contributions that were shown black.
    pub nonfinite: u64,
    /// Ended by Ctrl+C or another signal.
    pub interrupted: bool,
    /// Name of the written file.
    pub output: String,
}

impl RenderReport {
    /// Prints one JSON object on stdout, or one line on stderr.
    pub fn print(&self, json: bool) -> anyhow::Result<()> {
        if json {
            terminal::result(serde_json::to_string(self).context("can't write the statistics")?);
            return Ok(());
        }
        let noise = self.noise_stops.map_or(String::new(), |n| format!(", noise {n:.2} stops"));
        let denoised = self.denoise_s.map_or(String::new(), |seconds| format!(", denoised in {seconds:.2} s"));
        terminal::progress(format_args!(
            "{}: {}x{}, {:.0} samples a pixel in {:.2} s, {:.1} Mrays/s{noise}{denoised}",
            self.output, self.width, self.height, self.mean_spp, self.trace_s, self.mrays_s
        ));
        Ok(())
    }
}

//! Progress of a running render, readable from another thread.

use super::threads::locked;
use crate::raytrace::{RenderControl, Settings};
use std::sync::{Arc, Mutex};
use std::time::{Duration, Instant};

/// Numbers for a progress bar.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Progress {
    /// Part of the samples that are taken, 0 to 1.
    pub fraction: f32,
    /// Samples per pixel so far.
    pub samples: f32,
    /// Rays per second, millions.
    pub mrays_s: f32,
    /// Time since the start.
    pub elapsed: Duration,
    /// Estimated time left; none before there are enough samples to judge by.
    pub left: Option<Duration>,
}

/// The monitor of one render: the renderer writes the times of its stages, an observer reads the progress.
#[derive(Debug)]
pub struct RenderMonitor {
    control: Arc<RenderControl>,
    pixels: u64,
    spp: u32,
    started: Instant,
    stages: Mutex<StageTimes>,
}

/// When the stages of a render were reached.
#[derive(Clone, Copy, Debug, Default)]
struct StageTimes {
    tracing: Option<Instant>,
    coarse: Option<Instant>,
    /// Samples of the coarse picture, which are not the picture's own.
    coarse_samples: u64,
    first_pass: Option<Instant>,
    ended: Option<Instant>,
}

impl RenderMonitor {
    /// Returns the monitor of a render that starts now.
    pub fn new(settings: &Settings, control: Arc<RenderControl>) -> Self {
        RenderMonitor {
            control,
            pixels: u64::from(settings.width) * u64::from(settings.height),
            spp: settings.spp,
            started: Instant::now(),
            stages: Mutex::default(),
        }
    }

    /// Returns the render's control.
    pub fn control(&self) -> &RenderControl {
        &self.control
    }

    /// Returns the number of samples of the whole picture.
    pub fn total_samples(&self) -> u64 {
        (self.pixels * u64::from(self.spp)).max(1)
    }

    /// Returns the current progress.
    pub fn progress(&self) -> Progress {
        let stages = *locked(&self.stages);
        let total = self.total_samples();
        let done = self.control.samples_done().saturating_sub(stages.coarse_samples).min(total);
        let end = stages.ended.unwrap_or_else(Instant::now);
        let tracing_s = stages.tracing.map_or(0.0, |since| (end - since).as_secs_f64());
        let fraction = done as f64 / total as f64;
        let is_enough = tracing_s > 0.3 && fraction > 0.002;
        Progress {
            fraction: fraction as f32,
            samples: done as f32 / self.pixels.max(1) as f32,
            mrays_s: if tracing_s > 0.0 { (self.control.rays() as f64 * 1e-6 / tracing_s) as f32 } else { 0.0 },
            elapsed: end - self.started,
            left: is_enough.then(|| Duration::from_secs_f64(tracing_s * (1.0 - fraction) / fraction)),
        }
    }

    /// Returns when the first picture was complete: of a large one, its coarse version.
    pub fn first_picture(&self) -> Option<Instant> {
        let stages = locked(&self.stages);
        stages.coarse.or(stages.first_pass)
    }

    /// Returns when every pixel had its first sample.
    pub fn first_pass(&self) -> Option<Instant> {
        locked(&self.stages).first_pass
    }

    pub(super) fn start_tracing(&self, now: Instant) {
        locked(&self.stages).tracing = Some(now);
    }

    pub(super) fn finish_coarse(&self) {
        let mut stages = locked(&self.stages);
        (stages.coarse, stages.coarse_samples) = (Some(Instant::now()), self.control.samples_done());
    }

    pub(super) fn finish_pass(&self) {
        let mut stages = locked(&self.stages);
        if stages.first_pass.is_none() {
            stages.first_pass = Some(Instant::now());
            log::debug!("every pixel has a sample after {} ms", self.started.elapsed().as_millis());
        }
    }

    pub(super) fn finish(&self) {
        locked(&self.stages).ended.get_or_insert_with(Instant::now);
    }
}

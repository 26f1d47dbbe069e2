//! Progress of a running render, readable from another thread.

use super::threads::locked;
use crate::raytrace::{NoiseTarget, RenderControl, Settings};
use std::sync::{Arc, Mutex};
use std::time::{Duration, Instant};

/// Numbers for a progress bar.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Progress {
    /// Part of the work that is done, 0 to 1: of the samples, or of the rays that a noise limit is predicted to need.
    pub fraction: f32,
    /// Samples per pixel so far, on average.
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
    /// The render may end by its noise: the number of samples is not known in advance.
    ends_by_noise: bool,
    started: Instant,
    stages: Mutex<StageTimes>,
}

/// When the stages of a render were reached.
#[derive(Clone, Copy, Debug, Default)]
struct StageTimes {
    tracing: Option<Instant>,
    coarse: Option<Instant>,
    /// Rays of the coarse version.
    coarse_rays: u64,
    /// Rays of the whole picture, as far as they can be predicted.
    predicted_rays: Option<u64>,
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
            ends_by_noise: NoiseTarget::may_end(settings),
            started: Instant::now(),
            stages: Mutex::default(),
        }
    }

    /// Returns the render's control.
    pub fn control(&self) -> &RenderControl {
        &self.control
    }

    /// Returns the largest number of samples of the whole picture.
    pub fn total_samples(&self) -> u64 {
        (self.pixels * u64::from(self.spp)).max(1)
    }

    /// Returns the current progress.
    pub fn progress(&self) -> Progress {
        let stages = *locked(&self.stages);
        let samples = self.control.samples_done();
        let rays = self.control.rays().saturating_sub(stages.coarse_rays);
        let is_over = stages.ended.is_some() && !self.control.is_cancelled();
        let (done, total) = match (self.ends_by_noise, stages.predicted_rays) {
            (true, _) if is_over => (1, 1),
            (true, Some(total)) => (rays.min(total), total.max(1)),
            (true, None) => (0, 1),
            (false, _) => (samples.min(self.total_samples()), self.total_samples()),
        };
        let end = stages.ended.unwrap_or_else(Instant::now);
        let tracing_s = stages.tracing.map_or(0.0, |since| (end - since).as_secs_f64());
        let fraction = done as f64 / total as f64;
        // The predicted rays are those after the coarse version
        let counted_s = match stages.coarse.filter(|_| self.ends_by_noise) {
            Some(since) => (end - since).as_secs_f64(),
            None => tracing_s,
        };
        let is_enough = counted_s > 0.3 && fraction > 0.002;
        Progress {
            fraction: fraction as f32,
            samples: samples as f32 / self.pixels.max(1) as f32,
            mrays_s: if tracing_s > 0.0 { (self.control.rays() as f64 * 1e-6 / tracing_s) as f32 } else { 0.0 },
            elapsed: end - self.started,
            left: is_enough.then(|| Duration::from_secs_f64(counted_s * (1.0 - fraction) / fraction)),
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

    /// Returns the rays so far, without those of the coarse version.
    pub(super) fn rays(&self) -> u64 {
        self.control.rays().saturating_sub(locked(&self.stages).coarse_rays)
    }

    pub(super) fn start_tracing(&self, now: Instant) {
        locked(&self.stages).tracing = Some(now);
    }

    /// Takes the end of the coarse version, which took so many rays beside those that the whole picture shares.
    pub(super) fn finish_coarse(&self, rays: u64) {
        let mut stages = locked(&self.stages);
        (stages.coarse, stages.coarse_rays) = (Some(Instant::now()), rays);
    }

    pub(super) fn finish_pass(&self) {
        let mut stages = locked(&self.stages);
        if stages.first_pass.is_none() {
            stages.first_pass = Some(Instant::now());
            log::debug!("every pixel has a sample after {} ms", self.started.elapsed().as_millis());
        }
    }

    /// Takes the prediction of the rays that are still needed after a pass.
    pub(super) fn predict_rays_left(&self, left: u64) {
        let total = self.rays() + left;
        locked(&self.stages).predicted_rays = Some(total);
    }

    pub(super) fn finish(&self) {
        locked(&self.stages).ended.get_or_insert_with(Instant::now);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_draft_counts_its_samples_and_a_longer_render_waits_for_the_prediction_of_its_rays() {
        let monitor = |spp| {
            let settings = Settings { width: 10, height: 10, spp, noise_stops: Some(0.3), ..Settings::default() };
            let monitor = RenderMonitor::new(&settings, Arc::default());
            monitor.start_tracing(Instant::now());
            monitor.control().count(1000, 100);
            monitor
        };
        let (draft, longer) = (monitor(2), monitor(14));
        assert_eq!((draft.progress().fraction, longer.progress().fraction), (0.5, 0.0));
        longer.predict_rays_left(3000);
        assert_eq!(longer.progress().fraction, 0.25);
    }

    #[test]
    fn the_samples_of_the_coarse_version_are_the_pictures_own() {
        let settings = Settings { width: 10, height: 10, spp: 2, ..Settings::default() };
        let monitor = RenderMonitor::new(&settings, Arc::default());
        monitor.start_tracing(Instant::now() - Duration::from_secs(10));
        monitor.control().count(50, 50);
        monitor.finish_coarse(50);
        monitor.control().count(50, 50);
        let progress = monitor.progress();
        let left_s = progress.left.unwrap().as_secs_f32();
        assert!(progress.fraction == 0.5 && (10.0..11.0).contains(&left_s), "{left_s}");
        assert_eq!(monitor.rays(), 50);
    }
}

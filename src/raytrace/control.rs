//! Cancellation and progress counters of a render.

use std::sync::atomic::{AtomicBool, AtomicU64, Ordering};

/// The state that a render shares with its observers.
#[derive(Debug, Default)]
pub struct RenderControl {
    cancelled: AtomicBool,
    rays: AtomicU64,
    samples: AtomicU64,
}

impl RenderControl {
    /// A control that is not cancelled.
    pub fn new() -> Self {
        RenderControl::default()
    }

    /// Requests the end of the render, which comes within a tile's time.
    pub fn cancel(&self) {
        self.cancelled.store(true, Ordering::Relaxed);
    }

    /// Returns true if the end was requested.
    pub fn is_cancelled(&self) -> bool {
        self.cancelled.load(Ordering::Relaxed)
    }

    /// Rays traced so far.
    pub fn rays(&self) -> u64 {
        self.rays.load(Ordering::Relaxed)
    }

    /// Pixel samples traced so far; `width * height * spp` when done.
    pub fn samples_done(&self) -> u64 {
        self.samples.load(Ordering::Relaxed)
    }

    /// Adds finished work to the counters.
    pub fn count(&self, rays: u64, samples: u64) {
        self.rays.fetch_add(rays, Ordering::Relaxed);
        self.samples.fetch_add(samples, Ordering::Relaxed);
    }
}

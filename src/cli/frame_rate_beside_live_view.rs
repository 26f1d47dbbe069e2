//! Frame rate of a simulated window beside the live traced view: a thread that does as much work per frame as the
//! editor's, timed alone, beside the live view, and beside the live view and a render.

use serde::Serialize;
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::{Duration, Instant};

/// Work per frame: more than egui needs for all panels and handles.
const WORK: Duration = Duration::from_millis(8);
/// Time between two frames on a screen of 60 Hz.
const FRAME_INTERVAL: Duration = Duration::from_micros(16_667);

/// Frame rate, and the 99th percentile of the frame times.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct FrameRate {
    /// Mean frames per second.
    pub per_second: f64,
    /// 99th percentile of the frame times, milliseconds.
    pub most_ms: f64,
}

/// The arithmetic of one frame, which takes [`WORK`] when nothing else runs.
#[derive(Clone, Copy, Debug)]
pub struct FrameWork {
    rounds: u64,
}

impl FrameWork {
    /// Calibrates the work by the fastest of some trials, which other threads have disturbed least.
    pub fn new() -> Self {
        const TRIAL: u64 = 1 << 20;
        let trial = |_| {
            let began = Instant::now();
            spin(TRIAL);
            began.elapsed().as_nanos()
        };
        let fastest_ns = (0..20).map(trial).min().unwrap_or(1).max(1);
        FrameWork { rounds: u64::try_from(u128::from(TRIAL) * WORK.as_nanos() / fastest_ns).unwrap_or(u64::MAX) }
    }

    /// Measures the frame rate while `beside` runs.
    pub fn timed(self, beside: impl FnOnce()) -> FrameRate {
        let done = AtomicBool::new(false);
        std::thread::scope(|scope| {
            let frames = scope.spawn(|| self.frames(&done));
            beside();
            done.store(true, Ordering::Relaxed);
            // The thread only counts; there is no result if it panicked.
            frames.join().unwrap_or(FrameRate { per_second: 0.0, most_ms: 0.0 })
        })
    }

    fn frames(self, done: &AtomicBool) -> FrameRate {
        let (began, mut times) = (Instant::now(), Vec::new());
        while !done.load(Ordering::Relaxed) || times.is_empty() {
            let frame = Instant::now();
            spin(self.rounds);
            std::thread::sleep(FRAME_INTERVAL.saturating_sub(frame.elapsed()));
            times.push(frame.elapsed().as_secs_f64() * 1e3);
        }
        let per_second = times.len() as f64 / began.elapsed().as_secs_f64();
        times.sort_by(f64::total_cmp);
        FrameRate { per_second, most_ms: times[(times.len() - 1) * 99 / 100] }
    }
}

fn spin(rounds: u64) {
    let mut x = 1.0_f64;
    for i in 0..rounds {
        x = std::hint::black_box(x * 0.999_999 + i as f64 * 1e-12);
    }
    std::hint::black_box(x);
}

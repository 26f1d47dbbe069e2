//! How much room the live traced view leaves to the window: a thread that does as much in a frame as the editor's does,
//! timed alone, beside the tracer, and beside the tracer and a render.

use serde::Serialize;
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::{Duration, Instant};

/// Work in a frame: what egui takes for all panels and handles, and more.
const WORK: Duration = Duration::from_millis(8);
/// From frame to frame on a screen of 60 Hz.
const TICK: Duration = Duration::from_micros(16_667);

/// Frames a second, and how long the slowest of 99 in a hundred took.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Frames {
    /// Mean.
    pub per_second: f64,
    /// Milliseconds within which 99 of 100 frames were done.
    pub most_ms: f64,
}

/// A frame's worth of arithmetic, as long as [`WORK`] takes alone.
#[derive(Clone, Copy, Debug)]
pub struct FrameWork {
    rounds: u64,
}

impl FrameWork {
    /// Finds out how much it is: the quickest of some tries, which nothing has disturbed.
    pub fn new() -> Self {
        const TRY: u64 = 1 << 20;
        let seconds = |_| {
            let began = Instant::now();
            spin(TRY);
            began.elapsed().as_secs_f64()
        };
        let quickest = (0..20).map(seconds).fold(f64::INFINITY, f64::min);
        FrameWork { rounds: (TRY as f64 * WORK.as_secs_f64() / quickest.max(1e-9)) as u64 }
    }

    /// Draws frames while `beside` runs.
    pub fn timed(self, beside: impl FnOnce()) -> Frames {
        let done = AtomicBool::new(false);
        std::thread::scope(|scope| {
            let frames = scope.spawn(|| self.frames(&done));
            beside();
            done.store(true, Ordering::Relaxed);
            // The thread only counts; if it panicked there is nothing to tell.
            frames.join().unwrap_or(Frames { per_second: 0.0, most_ms: 0.0 })
        })
    }

    fn frames(self, done: &AtomicBool) -> Frames {
        let (began, mut times) = (Instant::now(), Vec::new());
        while !done.load(Ordering::Relaxed) || times.is_empty() {
            let frame = Instant::now();
            spin(self.rounds);
            std::thread::sleep(TICK.saturating_sub(frame.elapsed()));
            times.push(frame.elapsed().as_secs_f64() * 1e3);
        }
        let per_second = times.len() as f64 / began.elapsed().as_secs_f64();
        times.sort_by(f64::total_cmp);
        Frames { per_second, most_ms: times[(times.len() - 1) * 99 / 100] }
    }
}

fn spin(rounds: u64) {
    let mut x = 1.0_f64;
    for i in 0..rounds {
        x = std::hint::black_box(x * 0.999_999 + i as f64 * 1e-12);
    }
    std::hint::black_box(x);
}

//! The progress bar of a render, on stderr.

use crate::jobs::RenderMonitor;
use indicatif::{ProgressBar, ProgressStyle};
use std::sync::Arc;
use std::sync::mpsc::{Receiver, RecvTimeoutError, Sender, channel};
use std::thread::JoinHandle;
use std::time::Duration;

/// Time between two updates of the bar.
const INTERVAL: Duration = Duration::from_millis(100);

/// A thread that draws the progress bar. Dropping it removes the bar.
#[derive(Debug)]
pub struct ProgressDisplay {
    /// Dropped to end the thread.
    end: Option<Sender<()>>,
    thread: Option<JoinHandle<()>>,
}

impl ProgressDisplay {
    /// Shows the progress of a render.
    pub fn start(monitor: Arc<RenderMonitor>) -> Self {
        let (end, ended) = channel();
        let thread = std::thread::spawn(move || draw(&monitor, &ended));
        ProgressDisplay { end: Some(end), thread: Some(thread) }
    }
}

impl Drop for ProgressDisplay {
    fn drop(&mut self) {
        self.end = None;
        if let Some(thread) = self.thread.take() {
            // A panic of the thread ends only the bar.
            let _ = thread.join();
        }
    }
}

/// Returns a fraction, 0 to 1, of a number of samples.
#[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "the product is within 0 to total")]
fn part_of(total: u64, fraction: f32) -> u64 {
    (f64::from(fraction) * total as f64) as u64
}

fn draw(monitor: &RenderMonitor, ended: &Receiver<()>) {
    let total = monitor.total_samples();
    let bar = ProgressBar::new(total);
    if let Ok(style) = ProgressStyle::with_template("{bar:40} {percent:>3} %  {msg}  {eta} left") {
        bar.set_style(style);
    }
    while ended.recv_timeout(INTERVAL) == Err(RecvTimeoutError::Timeout) {
        let progress = monitor.progress();
        bar.set_message(format!("{:.0} samples a pixel, {:.1} Mrays/s", progress.samples.floor(), progress.mrays_s));
        bar.set_position(part_of(total, progress.fraction));
    }
    bar.finish_and_clear();
}

//! The progress bar of a render.

use super::progress_updates::Updates;
use crate::jobs::RenderMonitor;
use indicatif::{ProgressBar, ProgressStyle};

/// Draws the bar until the render ends, and removes it.
pub fn draw(monitor: &RenderMonitor, updates: Updates) {
    let total = monitor.total_samples();
    let bar = ProgressBar::new(total);
    if let Ok(style) = ProgressStyle::with_template("{bar:40} {percent:>3} %  {msg}  {eta} left") {
        bar.set_style(style);
    }
    for () in updates {
        let progress = monitor.progress();
        bar.set_message(format!("{:.0} samples a pixel, {:.1} Mrays/s", progress.samples.floor(), progress.mrays_s));
        bar.set_position(part_of(total, progress.fraction));
    }
    bar.finish_and_clear();
}

/// Returns a fraction, 0 to 1, of a number of samples.
#[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "the product is within 0 to total")]
fn part_of(total: u64, fraction: f32) -> u64 {
    (f64::from(fraction) * total as f64) as u64
}

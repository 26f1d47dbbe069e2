//! The progress of a render on stderr: a bar, or lines for the programs that started it.

use super::progress_bar;
use super::progress_updates::Updates;
use crate::cli::terminal;
use crate::jobs::{Progress, RenderMonitor};
use clap::ValueEnum;
use std::sync::Arc;
use std::sync::mpsc::{Sender, channel};
use std::thread::JoinHandle;

/// How progress is shown.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub enum ProgressStyle {
    /// A bar, on a terminal.
    Bar,
    /// A line of JSON for each percent.
    Lines,
    /// Lines that a runner of Open Job Description reads.
    Openjd,
}

/// A thread that shows the progress. Dropping it ends the display.
#[derive(Debug)]
pub struct ProgressDisplay {
    /// Dropped to end the thread.
    end: Option<Sender<()>>,
    thread: Option<JoinHandle<()>>,
}

impl ProgressDisplay {
    /// Shows the progress of a render.
    pub fn start(monitor: Arc<RenderMonitor>, style: ProgressStyle) -> Self {
        let (end, ended) = channel();
        let updates = Updates::until(ended);
        let thread = std::thread::spawn(move || match style {
            ProgressStyle::Bar => progress_bar::draw(&monitor, updates),
            ProgressStyle::Lines => print(&monitor, updates, json_line),
            ProgressStyle::Openjd => print(&monitor, updates, openjd_lines),
        });
        ProgressDisplay { end: Some(end), thread: Some(thread) }
    }
}

impl Drop for ProgressDisplay {
    fn drop(&mut self) {
        self.end = None;
        if let Some(thread) = self.thread.take() {
            // A panic of the thread ends only the display.
            let _ = thread.join();
        }
    }
}

/// Prints the progress each time another percent is complete.
fn print(monitor: &RenderMonitor, updates: Updates, line: fn(&Progress, u32) -> String) {
    let mut last = None;
    for () in updates {
        let progress = monitor.progress();
        let percent = percent(progress.fraction);
        if last != Some(percent) {
            terminal::progress(line(&progress, percent));
            last = Some(percent);
        }
    }
}

/// Returns the complete percents of a fraction, 0 to 1.
#[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "from 0 to 100")]
fn percent(fraction: f32) -> u32 {
    (fraction.clamp(0.0, 1.0) * 100.0) as u32
}

fn json_line(progress: &Progress, percent: u32) -> String {
    let left_s = progress.left.map(|left| left.as_secs_f64().round());
    serde_json::json!({ "percent": percent, "samples": progress.samples.floor(), "left_s": left_s }).to_string()
}

fn openjd_lines(progress: &Progress, percent: u32) -> String {
    let left = progress.left.map_or(String::new(), |left| format!(", {:.0} s left", left.as_secs_f64()));
    format!("openjd_progress: {percent}\nopenjd_status: {:.0} samples a pixel{left}", progress.samples.floor())
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::time::Duration;

    #[test]
    fn lines_have_whole_percents_samples_and_the_time_left() {
        let left = Some(Duration::from_millis(12_400));
        let progress = Progress { fraction: 0.4299, samples: 27.5, mrays_s: 1.0, elapsed: Duration::ZERO, left };
        let percent = percent(progress.fraction);
        assert_eq!(percent, 42);
        assert_eq!(json_line(&progress, percent), r#"{"left_s":12.0,"percent":42,"samples":27.0}"#);
        assert_eq!(
            openjd_lines(&progress, percent),
            "openjd_progress: 42\nopenjd_status: 27 samples a pixel, 12 s left"
        );
        assert_eq!([super::percent(f32::NAN), super::percent(2.0)], [0, 100]);
    }
}

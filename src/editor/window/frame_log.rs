//! Frame times during input, for the log (`RUST_LOG=catchlight=debug`).

use std::time::{Duration, Instant};

/// Interval of the log lines.
const EVERY: Duration = Duration::from_secs(2);

/// Times between frames during input.
#[derive(Debug, Default)]
pub struct FrameLog {
    /// Start of the last frame, if it had input.
    last: Option<Instant>,
    last_report: Option<Instant>,
    times_ms: Vec<f64>,
}

impl FrameLog {
    /// Records the start of a frame; `has_input` is true if it has events.
    pub fn frame(&mut self, has_input: bool, what: &str) {
        let now = Instant::now();
        let last = std::mem::replace(&mut self.last, has_input.then_some(now));
        self.times_ms.extend(last.filter(|_| has_input).map(|last| (now - last).as_secs_f64() * 1e3));
        let last_report = *self.last_report.get_or_insert(now);
        if now - last_report > EVERY {
            if let Some(line) = summary(&mut self.times_ms) {
                log::debug!("{what}: {line}");
            }
            self.times_ms.clear();
            self.last_report = Some(now);
        }
    }
}

/// Formats frames per second, the 90th percentile and the slowest frame.
fn summary(times_ms: &mut [f64]) -> Option<String> {
    times_ms.sort_by(f64::total_cmp);
    let most = times_ms.last()?;
    let at = |part: f64| times_ms[((times_ms.len() - 1) as f64 * part).round() as usize];
    let mean = times_ms.iter().sum::<f64>() / times_ms.len() as f64;
    Some(format!("{:.1} frames/s, 90 % within {:.0} ms, all within {most:.0} ms", 1e3 / mean, at(0.9)))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_summary_has_mean_percentile_and_maximum() {
        let mut times: Vec<f64> = [40.0; 9].into_iter().chain([140.0]).collect();
        assert_eq!(summary(&mut times).unwrap(), "20.0 frames/s, 90 % within 40 ms, all within 140 ms");
        assert_eq!(summary(&mut []), None);
    }

    #[test]
    fn pauses_without_input_are_not_counted() {
        let mut log = FrameLog::default();
        for has_input in [true, true, false, true] {
            log.frame(has_input, "test");
        }
        assert_eq!(log.times_ms.len(), 1);
    }
}

//! How the window keeps up with its user: told in the log (`RUST_LOG=catchlight=debug`).

use std::time::{Duration, Instant};

/// How often it is told.
const EVERY: Duration = Duration::from_secs(2);

/// Times from frame to frame while mouse or keys are at work.
#[derive(Debug, Default)]
pub struct FrameLog {
    /// When the last frame began, if there was input in it.
    last: Option<Instant>,
    told: Option<Instant>,
    times_ms: Vec<f64>,
}

impl FrameLog {
    /// A frame begins; `has_input` is whether the user does something.
    pub fn frame(&mut self, has_input: bool, what: &str) {
        let now = Instant::now();
        let last = std::mem::replace(&mut self.last, has_input.then_some(now));
        self.times_ms.extend(last.filter(|_| has_input).map(|last| (now - last).as_secs_f64() * 1e3));
        let told = *self.told.get_or_insert(now);
        if now - told > EVERY {
            if let Some(line) = summary(&mut self.times_ms) {
                log::debug!("{what}: {line}");
            }
            self.times_ms.clear();
            self.told = Some(now);
        }
    }
}

/// Frames a second, and how long nine of ten and the slowest took.
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
    fn frames_are_told_by_their_mean_and_their_slowest() {
        let mut times: Vec<f64> = [40.0; 9].into_iter().chain([140.0]).collect();
        assert_eq!(summary(&mut times).unwrap(), "20.0 frames/s, 90 % within 40 ms, all within 140 ms");
        assert_eq!(summary(&mut []), None);
    }

    #[test]
    fn a_pause_is_no_slow_frame() {
        let mut log = FrameLog::default();
        for has_input in [true, true, false, true] {
            log.frame(has_input, "test");
        }
        assert_eq!(log.times_ms.len(), 1);
    }
}

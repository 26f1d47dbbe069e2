//! The front of speed and accuracy: which method has the smallest error in the time that there is, and how long each
//! takes to an error.

use super::accuracy_row::{AccuracyRow, Study};
use serde::Serialize;
use std::fmt::Write;

/// Times that a user may have, seconds.
const BUDGETS_S: [f64; 4] = [0.1, 1.0, 10.0, 100.0];
/// Relative mean squared errors to reach: a picture that one can judge, and one that one can print.
const TARGETS: [f64; 2] = [1e-2, 1e-3];

/// The best picture in a time.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct BestInTime {
    /// Name of the studio.
    pub scene: String,
    /// The time, seconds.
    pub budget_s: f64,
    /// The method with the smallest error.
    pub method: String,
    /// Its samples per pixel.
    pub spp: u32,
    /// Its time, seconds.
    pub trace_s: f64,
    /// Its relative mean squared error.
    pub rel_mse: f64,
    /// Its FLIP difference.
    pub flip: f64,
}

/// The time of a method to an error.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct TimeToError {
    /// Name of the studio.
    pub scene: String,
    /// The method.
    pub method: String,
    /// The relative mean squared error.
    pub rel_mse: f64,
    /// The time, seconds, interpolated between numbers of samples; none where it is not reached.
    pub seconds: Option<f64>,
}

/// Returns the rows of the methods that no other beats in both time and error, by time.
pub fn front(rows: &[AccuracyRow]) -> Vec<&AccuracyRow> {
    let mut by_time: Vec<&AccuracyRow> = rows.iter().filter(|row| row.study == Study::Method).collect();
    by_time.sort_by(|a, b| a.trace_s.total_cmp(&b.trace_s));
    let mut smallest = f64::INFINITY;
    by_time.retain(|row| {
        let is_better = row.error.rel_mse < smallest;
        smallest = smallest.min(row.error.rel_mse);
        is_better
    });
    by_time
}

/// Returns the best picture of a studio in each time in which there is one.
pub fn best_in_time(rows: &[AccuracyRow]) -> Vec<BestInTime> {
    let front = front(rows);
    let best = |budget_s: f64| {
        let row = front.iter().rev().find(|row| row.trace_s <= budget_s)?;
        let AccuracyRow { scene, method, spp, trace_s, error, .. } = (*row).clone();
        Some(BestInTime { scene, budget_s, method, spp, trace_s, rel_mse: error.rel_mse, flip: error.flip })
    };
    BUDGETS_S.into_iter().filter_map(best).collect()
}

/// Returns the time of each method of a studio that takes samples to each error.
pub fn times_to_error(rows: &[AccuracyRow]) -> Vec<TimeToError> {
    let mut methods: Vec<&str> = Vec::new();
    for row in rows.iter().filter(|row| row.study == Study::Method) {
        if !methods.contains(&row.method.as_str()) {
            methods.push(&row.method);
        }
    }
    let mut times = Vec::new();
    for method in methods {
        let points: Vec<&AccuracyRow> =
            rows.iter().filter(|row| row.study == Study::Method && row.method == method).collect();
        for rel_mse in TARGETS {
            let (scene, method) = (points[0].scene.clone(), method.to_owned());
            times.push(TimeToError { scene, method, rel_mse, seconds: seconds_to(&points, rel_mse) });
        }
    }
    times
}

/// Returns the time at which an error is reached: on straight lines between logarithms.
fn seconds_to(points: &[&AccuracyRow], target: f64) -> Option<f64> {
    let reached = points.iter().position(|row| row.error.rel_mse <= target)?;
    let after = points[reached];
    let Some(before) = reached.checked_sub(1).map(|index| points[index]) else { return Some(after.trace_s) };
    let (high, low) = (before.error.rel_mse.ln(), after.error.rel_mse.max(f64::MIN_POSITIVE).ln());
    let part = (high - target.ln()) / (high - low);
    Some((before.trace_s.ln() * (1.0 - part) + after.trace_s.ln() * part).exp())
}

/// Returns both as Markdown tables.
pub fn markdown(best: &[BestInTime], times: &[TimeToError]) -> String {
    // Writing to a String cannot fail.
    let mut text = "| studio | seconds at most | best method | samples | seconds | relative MSE | FLIP |\n\
                    |---|---|---|---|---|---|---|\n"
        .to_owned();
    for BestInTime { scene, budget_s, method, spp, trace_s, rel_mse, flip } in best {
        let scene = scene.replace('|', "\\|");
        let _ =
            writeln!(text, "| {scene} | {budget_s} | {method} | {spp} | {trace_s:.3} | {rel_mse:.2e} | {flip:.4} |");
    }
    text.push_str("\n| studio | method | relative MSE | seconds to it |\n|---|---|---|---|\n");
    for TimeToError { scene, method, rel_mse, seconds } in times {
        let scene = scene.replace('|', "\\|");
        let seconds = seconds.map_or("not reached".to_owned(), |seconds| format!("{seconds:.3}"));
        let _ = writeln!(text, "| {scene} | {method} | {rel_mse:.0e} | {seconds} |");
    }
    text
}

#[cfg(test)]
mod tests {
    use super::super::picture_error::PictureError;
    use super::*;

    fn row(method: &str, trace_s: f64, rel_mse: f64) -> AccuracyRow {
        let error = PictureError { rel_mse, flip: 0.1, median_stops: 0.0, stops_95: 0.0, bias_stops: 0.0 };
        let (scene, method) = ("Studio".to_owned(), method.to_owned());
        AccuracyRow { scene, study: Study::Method, method, spp: 1, threads: 1, trace_s, mrays_s: 0.0, error }
    }

    #[test]
    fn the_front_has_what_nothing_beats_in_time_and_error() {
        let rows = [row("quick", 0.01, 0.5), row("slow", 0.5, 0.6), row("path", 0.4, 0.1), row("path", 4.0, 0.01)];
        let methods: Vec<(&str, f64)> = front(&rows).iter().map(|row| (row.method.as_str(), row.trace_s)).collect();
        assert_eq!(methods, [("quick", 0.01), ("path", 0.4), ("path", 4.0)]);
        let best: Vec<(f64, f64)> = best_in_time(&rows).iter().map(|best| (best.budget_s, best.trace_s)).collect();
        assert_eq!(best, [(0.1, 0.01), (1.0, 0.4), (10.0, 4.0), (100.0, 4.0)]);
    }

    #[test]
    fn the_time_to_an_error_lies_on_the_line_between_two_measurements() {
        // Error times time is constant: a hundredth of the error takes a hundred times as long.
        let rows = [row("path", 0.1, 0.1), row("path", 10.0, 0.001), row("whitted", 1.0, 0.3)];
        let times = times_to_error(&rows);
        let seconds: Vec<Option<f64>> = times.iter().map(|time| time.seconds).collect();
        assert!((seconds[0].unwrap() - 1.0).abs() < 1e-9 && (seconds[1].unwrap() - 10.0).abs() < 1e-9);
        assert_eq!(seconds[2..], [None, None]);
        assert!(markdown(&best_in_time(&rows), &times).contains("| Studio | whitted | 1e-3 | not reached |"));
    }
}

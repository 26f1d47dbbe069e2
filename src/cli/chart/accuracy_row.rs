//! Rows of the accuracy chart, and their tables in CSV and Markdown.

use super::picture_error::PictureError;
use serde::Serialize;
use std::fmt::Write;

/// One measured point.
#[derive(Clone, Debug, Serialize)]
pub struct AccuracyRow {
    /// Name of the studio.
    pub scene: String,
    /// Varied quantity.
    pub study: Study,
    /// Value of the varied quantity: a method, a number of threads, a number of bounces, a shortcut of the plan.
    pub method: String,
    /// Samples per pixel.
    pub spp: u32,
    /// Number of threads.
    pub threads: usize,
    /// Time to trace, and to denoise, seconds.
    pub trace_s: f64,
    /// Millions of rays per second, all threads.
    pub mrays_s: f64,
    /// Errors against the reference.
    #[serde(flatten)]
    pub error: PictureError,
}

/// The quantity that a part of the chart varies.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "lowercase")]
pub enum Study {
    /// Methods, and samples per pixel.
    Method,
    /// Depth of the path tracer.
    Bounces,
    /// Threads of the path tracer.
    Threads,
    /// Width of the path tracer's SIMD kernels.
    Simd,
    /// Render plan of the path tracer, without one of its shortcuts.
    Plan,
}

/// Returns the rows as CSV (RFC 4180).
pub fn csv(rows: &[AccuracyRow]) -> String {
    let mut text =
        "scene,method,spp,threads,trace_s,mrays_s,rel_mse,flip,median_stops,stops_95,bias_stops\n".to_owned();
    for row in rows {
        let AccuracyRow { scene, method, spp, threads, trace_s, mrays_s, error, .. } = row;
        let PictureError { rel_mse, flip, median_stops, stops_95, bias_stops } = error;
        let (scene, method) = (quoted(scene), quoted(method));
        // Writing to a String cannot fail.
        let _ = writeln!(
            text,
            "{scene},{method},{spp},{threads},{trace_s:.6},{mrays_s:.4},{rel_mse:.6e},{flip:.6},{median_stops:.6},\
             {stops_95:.6},{bias_stops:.6}"
        );
    }
    text
}

/// Returns a quoted field of a CSV file (RFC 4180).
fn quoted(text: &str) -> String {
    format!("\"{}\"", text.replace('"', "\"\""))
}

/// Returns the rows as a Markdown table.
pub fn markdown(rows: &[AccuracyRow]) -> String {
    let mut text = "| studio | method | samples | threads | seconds | Mrays/s | relative MSE | FLIP | median, stops | 95 %, stops | bias, stops |\n\
                    |---|---|---|---|---|---|---|---|---|---|---|\n"
        .to_owned();
    for row in rows {
        let AccuracyRow { scene, method, spp, threads, trace_s, mrays_s, error, .. } = row;
        let PictureError { rel_mse, flip, median_stops, stops_95, bias_stops } = error;
        let scene = scene.replace('|', "\\|");
        // Writing to a String cannot fail.
        let _ = writeln!(
            text,
            "| {scene} | {method} | {spp} | {threads} | {trace_s:.3} | {mrays_s:.2} | {rel_mse:.2e} \
             | {flip:.4} | {median_stops:.4} | {stops_95:.4} | {bias_stops:+.4} |"
        );
    }
    text
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_with_commas_and_quotes_are_one_field() {
        assert_eq!(quoted("a, \"b\""), "\"a, \"\"b\"\"\"");
    }
}

//! Frame times of the live preview, as `preview --frames` and `--lights` print them.

use super::terminal;
use serde::Serialize;

/// Measured frame times of a preview.
#[derive(Debug, Serialize)]
pub struct FrameTimeReport {
    /// Name of the studio.
    pub scene: String,
    /// Pixels across.
    pub width: u32,
    /// Pixels down.
    pub height: u32,
    /// The GPU and its interface, or the CPU z-buffer.
    pub adapter: String,
    /// Triangles in the studio, where the CPU draws.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub triangles: Option<u64>,
    /// Lights that are on.
    pub lights: usize,
    /// Lights are left out where they fall below 1/256 of display white.
    pub light_radius: bool,
    /// Frames in motion are drafts, which light one pixel in nine (fewer under many lights) until nothing moves: on
    /// adapters that are CPUs.
    pub draft: bool,
    /// Frames measured.
    pub frames: usize,
    /// Median frame time in motion.
    pub median_ms: f64,
    /// 90th percentile of the frame times in motion.
    pub ninety_percent_ms: f64,
    /// Median time of frames that are not drafts.
    pub full_median_ms: f64,
}

impl FrameTimeReport {
    /// Prints it as JSON or as a sentence.
    pub fn print(&self, json: bool) -> anyhow::Result<()> {
        if json {
            terminal::result(serde_json::to_string(self)?);
            return Ok(());
        }
        let FrameTimeReport { scene, width, height, adapter, lights, frames, median_ms, ninety_percent_ms, .. } = self;
        let radius = match self.triangles {
            Some(triangles) => format!(", {triangles} triangles"),
            None if self.light_radius => String::new(),
            None => ", each over the whole picture".to_owned(),
        };
        let draft = if self.draft { " as a draft" } else { "" };
        let full = if self.draft { format!("; in full {:.1} ms", self.full_median_ms) } else { String::new() };
        terminal::result(format_args!(
            "{scene}, {width}x{height}, {adapter}, {lights} lights{radius}: {median_ms:.1} ms a frame in motion{draft} \
             (median of {frames}), 90 % within {ninety_percent_ms:.1} ms{full}"
        ));
        Ok(())
    }
}

//! One tile of the live view: sums of samples in layers, primary hits, and how far it is refined.

use super::primary_hit::PrimaryHit;
use super::refinement::{RefinementStep, TileProgress};
use crate::color::luminance;
use crate::raytrace::film::{LayerSums, NonFiniteReport, SampleBlocks, TILE};
use glam::Vec4;

/// The samples and primary hits of a square of pixels.
#[derive(Clone, Debug)]
pub struct LiveTile {
    /// Left edge, pixels.
    pub x: u32,
    /// Upper edge, pixels.
    pub y: u32,
    /// Pixels across.
    pub width: u32,
    /// Pixels down.
    pub height: u32,
    /// Sums of the contributions; w is their weight in samples.
    pub sums: LayerSums<Vec4>,
    /// The primary hit of each pixel, in rows.
    pub primary_hits: Vec<PrimaryHit>,
    /// Completed refinement steps.
    pub progress: TileProgress,
    /// True once the noise is low enough, or the samples are the maximum.
    is_converged: bool,
    /// Blocks of the samples, for the noise estimate.
    pub blocks: SampleBlocks,
    /// True if the blocks hold samples of retraced layers alone.
    blocks_are_retraced: bool,
    /// Discarded non-finite contributions.
    pub nonfinite: NonFiniteReport,
    /// Number of pixels that took their value from the history.
    pub reprojected: u32,
}

/// The criterion by which a tile is converged.
#[derive(Clone, Copy, Debug)]
pub struct ConvergenceTarget<'a> {
    /// Noise at which a tile takes no more samples, stops.
    pub noise_stops: f32,
    /// Picture values per time-integrated luminance (cd s/m2).
    pub exposure: f32,
    /// Seconds for which each layer counts in the exposure.
    pub layer_times: &'a [f32],
}

/// Samples before the noise is estimated.
const MIN_NOISE_SAMPLES: u32 = 8;
/// Samples per pixel after which a tile takes no more.
const MAX_SAMPLES: u32 = 512;

impl LiveTile {
    /// An empty tile at a corner of a picture of this size.
    pub fn new(x: u32, y: u32, size: (u32, u32), layers: usize) -> Self {
        let (width, height) = (TILE.min(size.0 - x), TILE.min(size.1 - y));
        let pixels = (width * height) as usize;
        LiveTile {
            x,
            y,
            width,
            height,
            sums: LayerSums::new(pixels, layers),
            primary_hits: vec![PrimaryHit::NONE_YET; pixels],
            progress: TileProgress::default(),
            is_converged: false,
            blocks: SampleBlocks::new(pixels),
            blocks_are_retraced: false,
            nonfinite: NonFiniteReport::default(),
            reprojected: 0,
        }
    }

    /// Number of pixels.
    pub fn pixels(&self) -> usize {
        self.primary_hits.len()
    }

    /// Picture coordinates of a pixel of the tile.
    pub fn position(&self, pixel: usize) -> (u32, u32) {
        (self.x + pixel as u32 % self.width, self.y + pixel as u32 / self.width)
    }

    /// The pixels of a grid with this spacing, by index.
    pub fn grid(&self, stride: u32) -> impl Iterator<Item = usize> + use<> {
        let (width, height) = (self.width, self.height);
        let rows = (0..height).step_by(stride as usize);
        rows.flat_map(move |y| (0..width).step_by(stride as usize).map(move |x| (y * width + x) as usize))
    }

    /// Returns true if some layer takes more samples.
    pub fn is_active(&self) -> bool {
        self.progress.is_retracing() || !self.is_converged
    }

    /// Takes samples again although the tile is converged.
    #[cfg(test)]
    pub fn reactivate(&mut self) {
        self.is_converged = false;
    }

    /// Empties the tile.
    pub fn clear(&mut self) {
        self.sums.clear();
        self.primary_hits.fill(PrimaryHit::NONE_YET);
        self.reset_blocks(false);
        (self.progress, self.is_converged, self.reprojected) = (TileProgress::default(), false, 0);
        self.nonfinite = NonFiniteReport::default();
    }

    /// Reorders the layers: `from` names the former layer of each new one, `None` for one that is retraced from zero.
    pub fn remap(&mut self, from: &[Option<usize>]) {
        self.sums.remap(from);
        if from.iter().any(Option::is_none) {
            self.progress.retraced = 0;
        }
        self.reset_blocks(true);
    }

    /// Discards the blocks if they hold samples of the other layers.
    pub fn begin_sample_pass(&mut self, is_retracing: bool) {
        if self.blocks_are_retraced != is_retracing {
            self.reset_blocks(is_retracing);
        }
    }

    fn reset_blocks(&mut self, is_retracing: bool) {
        self.blocks.clear();
        self.blocks_are_retraced = is_retracing;
    }

    /// Counts a completed step, and decides whether the tile is converged.
    pub fn finish_step(&mut self, is_retracing: bool, target: &ConvergenceTarget<'_>) {
        let has_samples = self.blocks.samples() >= MIN_NOISE_SAMPLES;
        let is_quiet = has_samples
            && self.blocks.noise_stops(self.mean_luminance(target)).is_none_or(|noise| noise <= target.noise_stops);
        let TileProgress { kept, retraced } = &mut self.progress;
        if is_retracing {
            *retraced = if is_quiet && self.blocks_are_retraced { *kept } else { *retraced + 1 };
        } else {
            *kept += 1;
            *retraced = *kept;
            self.is_converged =
                (is_quiet && !self.blocks_are_retraced) || RefinementStep::samples(*kept) >= MAX_SAMPLES;
        }
    }

    /// Mean exposed luminance of all layers. The noise of retraced layers counts against the whole picture.
    fn mean_luminance(&self, target: &ConvergenceTarget<'_>) -> f32 {
        let of_layer = |(layer, sums): (usize, &[Vec4])| {
            let mean = |sum: &Vec4| if sum.w > 0.0 { luminance(sum.truncate()) / sum.w } else { 0.0 };
            sums.iter().map(mean).sum::<f32>() * target.layer_times[layer]
        };
        self.sums.layers().enumerate().map(of_layer).sum::<f32>() * target.exposure / self.pixels() as f32
    }
}

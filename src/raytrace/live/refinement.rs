//! The order in which a tile is refined: paths on a coarse grid, primary hits, paths at the pixels between, then one
//! sample pass after the other.

/// One refinement step of a tile.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum RefinementStep {
    /// A path at each pixel of a grid that has no value yet.
    Paths {
        /// Grid spacing, pixels.
        stride: u32,
    },
    /// The primary hit of each pixel of a grid, and its history.
    PrimaryHits {
        /// Grid spacing, pixels.
        stride: u32,
    },
    /// One more sample of every pixel.
    SamplePass {
        /// Index of the sample, from 1.
        sample: u32,
    },
}

/// The steps until every pixel has a path.
const FIRST_STEPS: [RefinementStep; 8] = [
    RefinementStep::Paths { stride: 16 },
    RefinementStep::Paths { stride: 8 },
    RefinementStep::PrimaryHits { stride: 4 },
    RefinementStep::PrimaryHits { stride: 2 },
    RefinementStep::PrimaryHits { stride: 1 },
    RefinementStep::Paths { stride: 4 },
    RefinementStep::Paths { stride: 2 },
    RefinementStep::Paths { stride: 1 },
];

impl RefinementStep {
    /// Returns the step that follows after `steps` completed ones.
    pub fn after(steps: u32) -> RefinementStep {
        let first = FIRST_STEPS.get(steps as usize);
        let sample = (steps + 1).saturating_sub(FIRST_STEPS.len() as u32);
        first.copied().unwrap_or(RefinementStep::SamplePass { sample })
    }

    /// Returns the spacing of the pixels that have a path after `steps` completed steps; `None` before the first.
    pub fn stride(steps: u32) -> Option<u32> {
        let completed = &FIRST_STEPS[..FIRST_STEPS.len().min(steps as usize)];
        completed.iter().rev().find_map(|step| match step {
            RefinementStep::Paths { stride } => Some(*stride),
            RefinementStep::PrimaryHits { .. } | RefinementStep::SamplePass { .. } => None,
        })
    }

    /// Returns the samples that every pixel has after `steps` completed steps.
    pub fn samples(steps: u32) -> u32 {
        (steps + 1).saturating_sub(FIRST_STEPS.len() as u32)
    }

    /// Estimates the cost of the step, in paths.
    pub fn cost(self, pixels: usize) -> u64 {
        let grid = |stride: u32| (pixels as u64).div_ceil(u64::from(stride * stride));
        match self {
            RefinementStep::Paths { stride } => grid(stride),
            RefinementStep::PrimaryHits { stride } => grid(stride).div_ceil(8),
            RefinementStep::SamplePass { .. } => pixels as u64,
        }
    }
}

/// Completed steps of a tile.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct TileProgress {
    /// Steps of the layers that kept their samples.
    pub kept: u32,
    /// Steps of the layers of retraced lights; never more than `kept`.
    pub retraced: u32,
}

impl TileProgress {
    /// Returns true if retraced layers have fewer steps than the others.
    pub fn is_retracing(self) -> bool {
        self.retraced < self.kept
    }

    /// Returns the completed steps of all layers.
    pub fn completed(self) -> u32 {
        self.kept.min(self.retraced)
    }
}

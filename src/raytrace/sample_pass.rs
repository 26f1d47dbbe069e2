//! A sample pass of a render.

/// Consecutive samples of every pixel.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct SamplePass {
    /// Samples per pixel before the pass.
    pub first_sample: u32,
    /// Samples per pixel in the pass.
    pub samples: u32,
}

impl SamplePass {
    /// Returns true if the pass has a sample.
    pub fn contains(&self, index: u32) -> bool {
        index >= self.first_sample && index - self.first_sample < self.samples
    }
}

//! The settings of a render.

use serde::{Deserialize, Serialize};

/// The rendering method.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Default, Serialize, Deserialize)]
pub enum Method {
    /// Whitted's recursion, for comparison: Phong lobes, hard shadows, mirrors and glass.
    Whitted,
    /// Path tracing with one non-specular scattering event: soft shadows and gloss, no indirect light. Specular
    /// surfaces are followed.
    Direct,
    /// Path tracing with all indirect light: the reference.
    #[default]
    Path,
}

/// The parameters of a render.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Settings {
    /// Pixels across.
    pub width: u32,
    /// Pixels down.
    pub height: u32,
    /// Rendering method.
    pub method: Method,
    /// Samples per pixel at most.
    pub spp: u32,
    /// Maximum path depth; none takes the plan's.
    pub max_depth: Option<u32>,
    /// Seed of the random numbers.
    pub seed: u32,
    /// Noise of a tile, in stops, at which it takes no more samples.
    pub noise_stops: Option<f32>,
    /// The film also holds albedo, normal, depth and object of the first hit.
    pub aovs: bool,
}

impl Default for Settings {
    fn default() -> Self {
        Settings {
            width: 960,
            height: 640,
            method: Method::Path,
            spp: 64,
            max_depth: None,
            seed: 0,
            noise_stops: None,
            aovs: false,
        }
    }
}

impl Settings {
    /// Number of pixels.
    pub fn pixels(&self) -> u64 {
        u64::from(self.width) * u64::from(self.height)
    }
}

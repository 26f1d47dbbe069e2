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

/// Pixels above which a coarse picture is rendered first: the first pass of a large one takes its time.
const LARGE: u64 = 150_000;
/// Most pixels of the coarse picture: those of a portrait of 720x1080 at half the size, less than a second on two cores.
const MOST_COARSE: u64 = 200_000;

impl Settings {
    /// One sample of a large picture at a half, a quarter ... of its size, to be shown until the first pass is done.
    pub fn coarse(&self) -> Option<Settings> {
        let small = |part: u32| Settings {
            width: self.width.div_ceil(part),
            height: self.height.div_ceil(part),
            spp: 1,
            ..self.clone()
        };
        let parts = (1..32).map(|halvings| small(1 << halvings));
        (self.pixels() > LARGE).then_some(parts)?.find(|coarse| coarse.pixels() <= MOST_COARSE)
    }

    /// Number of pixels.
    pub fn pixels(&self) -> u64 {
        u64::from(self.width) * u64::from(self.height)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_coarse_picture_has_the_shape_of_a_large_one_and_few_pixels() {
        let coarse = |width, height| {
            let coarse = Settings { width, height, spp: 64, ..Settings::default() }.coarse();
            coarse.map(|coarse| (coarse.width, coarse.height, coarse.spp))
        };
        assert_eq!(coarse(320, 240), None);
        assert_eq!(coarse(720, 1080), Some((360, 540, 1)));
        assert_eq!(coarse(3840, 2160), Some((480, 270, 1)));
        assert!(coarse(u32::MAX, 1).is_some_and(|(width, height, _)| width <= 200_000 && height == 1));
    }
}

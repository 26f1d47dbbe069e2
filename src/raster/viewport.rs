//! The viewport: from clip space to screen space in 1/256 of a pixel, and the grid of tiles over it.

use glam::Vec4;

/// Sub-pixel positions along each side of a pixel.
pub(super) const SUBPIXELS: i32 = 256;
/// Largest picture edge, pixels: positions have 22 bits, and products of edge vectors 45.
const LARGEST_EDGE: u32 = 16384;

/// Width of a tile, pixels.
pub(super) const TILE_WIDTH: usize = 64;
/// Height of a tile, pixels.
pub(super) const TILE_HEIGHT: usize = 16;

/// The size of the picture, pixels.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Viewport {
    pub width: u32,
    pub height: u32,
}

/// A vertex in screen space.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct ScreenVertex {
    /// Position in 1/256 pixels, y down.
    pub position: [i32; 2],
    /// One over the depth along the camera's axis, 1/m.
    pub inverse_w: f32,
}

impl Viewport {
    pub fn new((width, height): (u32, u32)) -> Self {
        Viewport { width: width.clamp(1, LARGEST_EDGE), height: height.clamp(1, LARGEST_EDGE) }
    }

    /// Returns the columns and rows of tiles.
    pub fn tile_counts(self) -> (usize, usize) {
        ((self.width as usize).div_ceil(TILE_WIDTH), (self.height as usize).div_ceil(TILE_HEIGHT))
    }

    /// Maps a point inside the clip volume to the screen: perspective division and viewport transform.
    pub fn screen_from_clip(self, clip: Vec4) -> ScreenVertex {
        let inverse_w = 1.0 / clip.w;
        // Not negative inside the volume: adding a half and truncating rounds.
        let fixed = |part: f32, pixels: u32| (f64::from(part) * f64::from(pixels) * f64::from(SUBPIXELS) + 0.5) as i32;
        let x = fixed(0.5 + 0.5 * clip.x * inverse_w, self.width);
        let y = fixed(0.5 - 0.5 * clip.y * inverse_w, self.height);
        ScreenVertex { position: [x, y], inverse_w }
    }
}

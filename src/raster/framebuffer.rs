//! The framebuffer: colour, object index and depth of every pixel.

use super::viewport::Viewport;
use crate::photo::Picture;

/// Object index of a pixel that shows the room or nothing.
pub const NO_OBJECT: u32 = u32::MAX;

/// A rasterized picture.
#[derive(Clone, Debug, PartialEq, Default)]
pub struct Framebuffer {
    /// Scene-linear colour.
    pub picture: Picture,
    /// Index of the visible object in the scene's list, or [`NO_OBJECT`], per pixel.
    pub objects: Vec<u32>,
    /// One over the depth along the camera's axis, 1/m, per pixel; 0 where there is nothing.
    pub inverse_depths: Vec<f32>,
}

impl Framebuffer {
    /// Sets the size; the content is undefined until it is drawn.
    pub(super) fn resize(&mut self, Viewport { width, height }: Viewport) {
        let pixels = width as usize * height as usize;
        (self.picture.width, self.picture.height) = (width, height);
        self.picture.rgb.resize(pixels, [0.0; 3]);
        self.objects.resize(pixels, NO_OBJECT);
        self.inverse_depths.resize(pixels, 0.0);
    }
}

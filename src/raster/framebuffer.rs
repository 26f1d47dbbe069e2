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
    /// Sets the size, and clears every pixel to a background of this radiance.
    pub(super) fn clear(&mut self, Viewport { width, height }: Viewport, background: [f32; 3]) {
        let pixels = width as usize * height as usize;
        (self.picture.width, self.picture.height) = (width, height);
        clear(&mut self.picture.rgb, pixels, background);
        clear(&mut self.objects, pixels, NO_OBJECT);
        clear(&mut self.inverse_depths, pixels, 0.0);
    }
}

fn clear<T: Copy>(values: &mut Vec<T>, length: usize, value: T) {
    values.clear();
    values.resize(length, value);
}

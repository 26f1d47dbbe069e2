//! Pictures that are computed pixel by pixel, so that a large one need not be in memory as a whole.

use super::picture::{Picture, nearest};
use std::fmt;

/// A scene-linear picture, as [`Picture`], whose pixels are computed when they are read.
pub struct LazyPicture<'a> {
    width: u32,
    height: u32,
    pixel: Box<dyn Fn(u32, u32) -> [f32; 3] + Sync + 'a>,
}

impl<'a> LazyPicture<'a> {
    /// Creates a picture of a width and height in pixels from the function that returns the pixel at (x, y), y down.
    pub fn new((width, height): (u32, u32), pixel: impl Fn(u32, u32) -> [f32; 3] + Sync + 'a) -> Self {
        LazyPicture { width, height, pixel: Box::new(pixel) }
    }

    /// Returns width and height, pixels.
    pub fn size(&self) -> (u32, u32) {
        (self.width, self.height)
    }

    /// Returns the pixel at (x, y), y down.
    pub fn at(&self, x: u32, y: u32) -> [f32; 3] {
        (self.pixel)(x, y)
    }

    /// Resizes by the nearest pixel.
    pub fn resized(self, width: u32, height: u32) -> LazyPicture<'a> {
        if self.size() == (width, height) {
            return self;
        }
        LazyPicture::new((width, height), move |x, y| {
            self.at(nearest(x, self.width, width), nearest(y, self.height, height))
        })
    }

    /// Computes all pixels.
    pub fn collect(&self) -> Picture {
        let places = (0..self.height).flat_map(|y| (0..self.width).map(move |x| (x, y)));
        Picture { width: self.width, height: self.height, rgb: places.map(|(x, y)| self.at(x, y)).collect() }
    }
}

impl<'a> From<&'a Picture> for LazyPicture<'a> {
    fn from(picture: &'a Picture) -> Self {
        LazyPicture::new((picture.width, picture.height), |x, y| picture.at(x, y))
    }
}

impl From<Picture> for LazyPicture<'_> {
    fn from(picture: Picture) -> Self {
        LazyPicture::new((picture.width, picture.height), move |x, y| picture.at(x, y))
    }
}

impl fmt::Debug for LazyPicture<'_> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_struct("LazyPicture").field("width", &self.width).field("height", &self.height).finish_non_exhaustive()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_lazy_picture_has_the_pixels_of_the_whole_one_in_any_size() {
        let rgb = (0..15u8).map(|i| [f32::from(i), 0.5, 1.0]).collect();
        let picture = Picture { width: 5, height: 3, rgb };
        for (width, height) in [(5, 3), (7, 8), (2, 1)] {
            let lazy = LazyPicture::from(&picture).resized(width, height);
            assert_eq!((lazy.size(), lazy.collect()), ((width, height), picture.resized(width, height)));
        }
    }
}

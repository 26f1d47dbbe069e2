//! Scene-linear pictures, before the tone curve.

/// A scene-linear RGB picture after exposure and white balance: a correctly metered grey card is 0.18. Rows from the
/// top.
#[derive(Clone, Debug, PartialEq, Default)]
pub struct Picture {
    /// Width, pixels.
    pub width: u32,
    /// Height, pixels.
    pub height: u32,
    /// `width * height` pixels.
    pub rgb: Vec<[f32; 3]>,
}

impl Picture {
    /// Creates a black picture.
    pub fn new(width: u32, height: u32) -> Self {
        Picture { width, height, rgb: vec![[0.0; 3]; width as usize * height as usize] }
    }

    /// Returns the pixel at (x, y), y down.
    pub fn at(&self, x: u32, y: u32) -> [f32; 3] {
        self.rgb[y as usize * self.width as usize + x as usize]
    }

    /// Resizes by the nearest pixel.
    pub fn resized(&self, width: u32, height: u32) -> Picture {
        Picture { width, height, rgb: resized(&self.rgb, (self.width, self.height), (width, height)) }
    }

    /// Converts to display values: tone curve and sRGB encoding, 8 bits per channel.
    pub fn to_srgb8(&self) -> Vec<[u8; 3]> {
        self.rgb.iter().map(|&c| crate::color::display_srgb8(c)).collect()
    }
}

/// Returns rows of pixels resized by the nearest pixel.
pub(super) fn resized<T: Copy>(
    pixels: &[T],
    (width, height): (u32, u32),
    (new_width, new_height): (u32, u32),
) -> Vec<T> {
    let nearest = |i: u32, from: u32, to: u32| {
        (u64::from(2 * i + 1) * u64::from(from) / u64::from(2 * to.max(1))).min(u64::from(from.max(1) - 1)) as usize
    };
    let rows = (0..new_height).map(|y| nearest(y, height, new_height) * width as usize);
    rows.flat_map(|row| (0..new_width).map(move |x| pixels[row + nearest(x, width, new_width)])).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn resizing_takes_the_nearest_pixel() {
        let small = Picture { width: 2, height: 1, rgb: vec![[1.0; 3], [2.0; 3]] };
        let values: Vec<f32> = small.resized(5, 2).rgb.iter().map(|rgb| rgb[0]).collect();
        assert_eq!(values, [1.0, 1.0, 2.0, 2.0, 2.0, 1.0, 1.0, 2.0, 2.0, 2.0]);
        assert_eq!(small.resized(2, 1), small);
    }
}

//! Scene-linear pictures, before the tone curve.

use glam::Vec2;

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

    /// Returns the part between two corners, in fractions of width and height from the top left; at least a pixel of a
    /// picture that has any.
    pub fn cropped(&self, [low, high]: [Vec2; 2]) -> Picture {
        let range = |low: f32, high: f32, pixels: u32| {
            let first = ((low * pixels as f32).round() as u32).min(pixels.saturating_sub(1));
            first..((high * pixels as f32).round() as u32).clamp(first + 1, pixels.max(first + 1)).min(pixels)
        };
        let (columns, rows) = (range(low.x, high.x, self.width), range(low.y, high.y, self.height));
        let rgb = rows.clone().flat_map(|y| columns.clone().map(move |x| self.at(x, y))).collect();
        Picture { width: columns.len() as u32, height: rows.len() as u32, rgb }
    }

    /// Resizes by the nearest pixel.
    pub fn resized(&self, width: u32, height: u32) -> Picture {
        Picture { width, height, rgb: resized(&self.rgb, (self.width, self.height), (width, height)) }
    }

    /// As [`Picture::resized`], without a copy of a picture that has the size.
    pub fn into_resized(self, width: u32, height: u32) -> Picture {
        if (self.width, self.height) == (width, height) { self } else { self.resized(width, height) }
    }

    /// Converts to display values: tone curve and sRGB encoding, 16 bits per channel.
    pub fn to_srgb16(&self) -> Vec<[u16; 3]> {
        self.rgb.iter().map(|&rgb| crate::color::display_srgb16(rgb)).collect()
    }

    /// Converts to display values: tone curve and sRGB encoding, 8 bits per channel, dithered.
    pub fn to_srgb8(&self) -> Vec<[u8; 3]> {
        let places = (0..self.height).flat_map(|y| (0..self.width).map(move |x| [x, y]));
        self.rgb.iter().zip(places).map(|(&rgb, place)| crate::color::dithered_srgb8(rgb, place)).collect()
    }
}

/// Returns rows of pixels resized by the nearest pixel.
pub(super) fn resized<T: Copy>(
    pixels: &[T],
    (width, height): (u32, u32),
    (new_width, new_height): (u32, u32),
) -> Vec<T> {
    let rows = (0..new_height).map(|y| nearest(y, height, new_height) as usize * width as usize);
    rows.flat_map(|row| (0..new_width).map(move |x| pixels[row + nearest(x, width, new_width) as usize])).collect()
}

/// Returns the index, among `from` pixels, of the one nearest to pixel `i` of `to`.
pub(super) fn nearest(i: u32, from: u32, to: u32) -> u32 {
    let index = u64::from(2 * i + 1) * u64::from(from) / u64::from(2 * to.max(1));
    index.min(u64::from(from.max(1) - 1)) as u32
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_crop_has_the_pixels_between_its_corners() {
        let rgb = (0..24).map(|at| [at as f32; 3]).collect();
        let picture = Picture { width: 6, height: 4, rgb };
        assert_eq!(picture.cropped([Vec2::ZERO, Vec2::ONE]), picture);
        let middle = picture.cropped([Vec2::new(0.34, 0.25), Vec2::new(0.66, 0.75)]);
        assert_eq!((middle.width, middle.height), (2, 2));
        assert_eq!(middle.rgb, [8.0, 9.0, 14.0, 15.0].map(|value| [value; 3]));
        let corner = picture.cropped([Vec2::ONE, Vec2::ONE]);
        assert_eq!((corner.width, corner.height, corner.rgb[0]), (1, 1, [23.0; 3]));
        assert_eq!(Picture::default().cropped([Vec2::ZERO, Vec2::ONE]), Picture::default());
    }

    #[test]
    fn a_slow_gradient_in_the_dark_has_no_contour_lines() {
        // From code 20 to code 23 in 600 pixels: without dithering the mean of a neighbourhood is off by up to 0.5.
        let (width, height) = (600, 16);
        let code = |x: u32| 20.0 + 3.0 * x as f32 / width as f32;
        let value = |i: u32| [crate::color::srgb_decode(code(i % width) / 255.0); 3];
        let picture = Picture { width, height, rgb: (0..width * height).map(value).collect() };
        let shown = picture.to_srgb8();
        let block = 16;
        for left in (0..width - block).step_by(4) {
            let cells = (0..height).flat_map(|y| (left..left + block).map(move |x| (x, y)));
            let errors = cells.map(|(x, y)| f32::from(shown[(y * width + x) as usize][0]) - code(x));
            let mean = errors.sum::<f32>() / (block * height) as f32;
            assert!(mean.abs() < 0.1, "{mean} codes at column {left}");
        }
        let black = Picture::new(40, 40);
        assert!(black.to_srgb8().iter().all(|code| *code == [0; 3]), "black stays black");
    }

    #[test]
    fn resizing_takes_the_nearest_pixel() {
        let small = Picture { width: 2, height: 1, rgb: vec![[1.0; 3], [2.0; 3]] };
        let values: Vec<f32> = small.resized(5, 2).rgb.iter().map(|rgb| rgb[0]).collect();
        assert_eq!(values, [1.0, 1.0, 2.0, 2.0, 2.0, 1.0, 1.0, 2.0, 2.0, 2.0]);
        assert_eq!(small.resized(2, 1), small);
    }
}

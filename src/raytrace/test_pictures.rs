//! Luminances of test pictures.

use crate::color::luminance;
use crate::photo::Picture;
use glam::Vec3;

/// Returns the sums of the luminances of blocks of so many pixels across and down.
pub fn blocks(picture: &Picture, side: usize) -> Vec<f64> {
    let (width, height) = (picture.width as usize / side, picture.height as usize / side);
    let mut sums = vec![0.0; width * height];
    for (pixel, rgb) in picture.rgb.iter().enumerate() {
        let (x, y) = (pixel % picture.width as usize, pixel / picture.width as usize);
        sums[y / side * width + x / side] += f64::from(luminance(Vec3::from(*rgb)));
    }
    sums
}

/// Returns the mean of values.
pub fn mean(values: &[f64]) -> f64 {
    values.iter().sum::<f64>() / values.len() as f64
}

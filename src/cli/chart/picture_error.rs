//! Errors of a picture against the reference.

use super::flip::mean_flip;
use crate::cli::percentile::percentile;
use crate::color::luminance;
use crate::photo::Picture;
use glam::Vec3;
use serde::Serialize;

/// Luminance below which no difference is visible: four stops below a hundredth of white.
const DARKEST: f64 = 6e-4;

/// Errors of a picture against the reference.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct PictureError {
    /// Relative mean squared error.
    pub rel_mse: f64,
    /// Mean difference that people see on a display, 0 to 1 (FLIP).
    pub flip: f64,
    /// Median over the pixels of the luminance error, stops.
    pub median_stops: f64,
    /// 95th percentile over the pixels of the luminance error, stops.
    pub stops_95: f64,
    /// Error of the mean luminance, stops.
    pub bias_stops: f64,
}

impl PictureError {
    /// Compares a picture with the reference of the same size.
    pub fn new(picture: &Picture, reference: &Picture) -> Self {
        let (mut sum, mut mean, mut reference_mean) = (0.0, 0.0, 0.0);
        let mut stops: Vec<f64> = Vec::with_capacity(picture.rgb.len());
        for (rgb, reference_rgb) in picture.rgb.iter().zip(&reference.rgb) {
            for (x, r) in rgb.iter().zip(reference_rgb).map(|(&x, &r)| (f64::from(x), f64::from(r))) {
                sum += (x - r).powi(2) / (r * r + 1e-4);
            }
            let [y, reference_y] = [rgb, reference_rgb].map(|rgb| f64::from(luminance(Vec3::from(*rgb))));
            mean += y;
            reference_mean += reference_y;
            stops.push((y.max(DARKEST) / reference_y.max(DARKEST)).log2().abs());
        }
        stops.sort_by(f64::total_cmp);
        PictureError {
            rel_mse: sum / (3 * picture.rgb.len()).max(1) as f64,
            flip: mean_flip(picture, reference),
            median_stops: percentile(&stops, 50),
            stops_95: percentile(&stops, 95),
            bias_stops: (mean.max(f64::MIN_POSITIVE) / reference_mean.max(f64::MIN_POSITIVE)).log2(),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_picture_one_stop_brighter_has_an_error_of_one_stop() {
        let reference = Picture { width: 2, height: 1, rgb: vec![[0.2; 3], [0.5; 3]] };
        let over = Picture { rgb: vec![[0.4; 3], [1.0; 3]], ..reference.clone() };
        let PictureError { rel_mse, flip, median_stops, stops_95, bias_stops } = PictureError::new(&over, &reference);
        assert!((rel_mse - 1.0).abs() < 2e-3, "{rel_mse}");
        assert!(0.1 < flip && flip < 1.0, "{flip}");
        assert!([median_stops, stops_95, bias_stops].iter().all(|stops| (stops - 1.0).abs() < 1e-6));
        let none = PictureError { rel_mse: 0.0, flip: 0.0, median_stops: 0.0, stops_95: 0.0, bias_stops: 0.0 };
        assert_eq!(PictureError::new(&reference, &reference), none);
    }
}

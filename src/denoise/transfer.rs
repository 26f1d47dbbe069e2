//! The transfer function between radiance and the network's values, and the exposure of its input.
//!
//! The network was trained with colours in a perceptually uniform encoding: a fit of the PU2 curve, normalised at
//! 100 cd/m2 (Aydın, Mantiuk and Seidel, "Extending Quality Metrics to Full Luminance Range Images", 2008), with the
//! constants of Open Image Denoise (`color.ispc`). The largest number of half precision is encoded as 1.

use crate::photo::Picture;

const A: f32 = 1_412.837_6;
const B: f32 = 1.645_931_7;
const C: f32 = 0.431_384_98;
const D: f32 = -2.941_396e-3;
const E: f32 = 0.192_653_25;
const F: f32 = 6.260_261e-3;
const G: f32 = 0.998_620_15;
/// Ends of the linear part and of the power law, decoded and encoded.
const Y0: f32 = 1.579_457_6e-6;
const Y1: f32 = 3.220_876_3e-2;
const X0: f32 = 2.231_517e-3;
const X1: f32 = 0.370_974_75;
/// 1 over the encoded value of 65504, the largest number of half precision.
const SCALE: f32 = 0.318_967_16;

/// Encodes a value for the network. Values that are no number and negative ones are encoded as 0.
pub fn encode(value: f32) -> f32 {
    let y = if value > 0.0 { value.min(f32::MAX) } else { 0.0 };
    let x = if y <= Y0 {
        A * y
    } else if y <= Y1 {
        B * y.powf(C) + D
    } else {
        E * (y + F).ln() + G
    };
    x * SCALE
}

/// Decodes a value of the network. Values that are no number and negative ones are decoded as 0.
pub fn decode(value: f32) -> f32 {
    let x = if value > 0.0 { value.min(f32::MAX) / SCALE } else { 0.0 };
    let y = if x <= X0 {
        x / A
    } else if x <= X1 {
        ((x - D) / B).powf(1.0 / C)
    } else {
        ((x - G) / E).exp() - F
    };
    y.min(f32::MAX)
}

/// Side of the squares whose mean luminance is averaged, pixels.
const CELL: usize = 16;
/// Mean luminance below which a square does not count.
const DARK: f32 = 1e-8;
/// Value of a medium grey.
const GREY: f32 = 0.18;

/// Returns the factor that brings a picture to the brightness for which the network was trained: the geometric mean of
/// the luminance of squares becomes a medium grey. 1 for a black picture.
pub fn input_scale(picture: &Picture) -> f32 {
    let (width, height) = (picture.width as usize, picture.height as usize);
    let (columns, rows) = (width.div_ceil(CELL), height.div_ceil(CELL));
    let (mut sum, mut count) = (0.0_f64, 0_u32);
    for row in 0..rows {
        for column in 0..columns {
            let (top, bottom) = (row * height / rows, (row + 1) * height / rows);
            let (left, right) = (column * width / columns, (column + 1) * width / columns);
            let lines = (top..bottom).flat_map(|y| &picture.rgb[y * width + left..y * width + right]);
            let mean = lines.map(|rgb| luminance(*rgb)).sum::<f32>() / ((bottom - top) * (right - left)) as f32;
            if mean > DARK {
                sum += f64::from(mean.min(f32::MAX)).log2();
                count += 1;
            }
        }
    }
    if count == 0 { 1.0 } else { (f64::from(GREY) / (sum / f64::from(count)).exp2()) as f32 }
}

/// Luminance of linear sRGB, with the coefficients of Open Image Denoise.
fn luminance(rgb: [f32; 3]) -> f32 {
    let [red, green, blue] = rgb.map(|value| if value > 0.0 { value.min(f32::MAX) } else { 0.0 });
    0.212_671 * red + 0.715_16 * green + 0.072_169 * blue
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn decoding_inverts_encoding() {
        // The constants have eight digits; the pieces of the curve meet within 1e-4 of their value.
        for exponent in -28..16 {
            for step in 0..8 {
                let value = (1.0 + step as f32 / 8.0) * f32::powi(2.0, exponent);
                let there_and_back = decode(encode(value));
                assert!((there_and_back / value - 1.0).abs() < 3e-4, "{value} {there_and_back}");
            }
        }
        assert!((encode(65504.0) - 1.0).abs() < 1e-6);
        assert_eq!([encode(0.0), decode(0.0)], [0.0; 2]);
    }

    #[test]
    fn encoded_values_increase_with_the_value() {
        let values = (-600..400).map(|step| f32::powf(2.0, step as f32 / 20.0));
        let encoded: Vec<f32> = values.map(encode).collect();
        assert!(encoded.windows(2).all(|pair| pair[0] < pair[1]));
    }

    #[test]
    fn values_that_are_no_colours_are_black() {
        assert_eq!([f32::NAN, -1.0, f32::NEG_INFINITY].map(encode), [0.0; 3]);
        assert_eq!([f32::NAN, -1.0, f32::NEG_INFINITY].map(decode), [0.0; 3]);
        assert!(encode(f32::INFINITY).is_finite() && decode(f32::INFINITY).is_finite());
    }

    #[test]
    fn the_geometric_mean_of_squares_becomes_a_medium_grey() {
        let half = |x: u32| if x < 32 { [0.01; 3] } else { [1.0; 3] };
        let picture = Picture { width: 64, height: 32, rgb: (0..64 * 32).map(|i| half(i % 64)).collect() };
        // The square root of 0.01 is 0.1; the luminance coefficients sum to 1.
        assert!((input_scale(&picture) - 1.8).abs() < 1e-4, "{}", input_scale(&picture));
        assert_eq!(input_scale(&Picture::new(20, 10)), 1.0);
        assert_eq!(input_scale(&Picture::new(0, 0)), 1.0);
    }
}

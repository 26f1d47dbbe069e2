//! Denoised light layers that sum to the denoised picture.

use super::{Cancelled, Quality, denoise};
use crate::photo::{AovPicture, Picture};
use rayon::prelude::*;

/// A denoised picture and its layers.
#[derive(Clone, Debug, PartialEq)]
pub struct DenoisedLayers {
    /// The whole picture.
    pub picture: Picture,
    /// The layers. They sum to the picture, but for rounding.
    pub layers: Vec<Picture>,
}

/// Denoises a picture and each of its layers, which sum to it.
///
/// The network is not linear: denoised layers do not sum to the denoised picture, which is the better estimate, because
/// it shows all edges. In each pixel and channel the difference is therefore divided among the layers in proportion to
/// their denoised values.
///
/// # Errors
/// Once `is_cancelled` returns true.
pub fn denoise_layers(
    picture: &Picture,
    layers: &[Picture],
    aovs: &AovPicture,
    quality: Quality,
    is_cancelled: &(dyn Fn() -> bool + Sync),
) -> Result<DenoisedLayers, Cancelled> {
    let whole = denoise(picture, aovs, quality, is_cancelled)?;
    let denoised = layers.iter().map(|layer| denoise(layer, aovs, quality, is_cancelled));
    let mut denoised = denoised.collect::<Result<Vec<_>, _>>()?;
    share_difference(&whole, layers, &mut denoised);
    Ok(DenoisedLayers { picture: whole, layers: denoised })
}

/// Scales the layers of each pixel so that they sum to the picture. Where all of them are black, they take the
/// proportions of the noisy layers; where those are black, too, the first takes the whole.
fn share_difference(picture: &Picture, noisy: &[Picture], layers: &mut [Picture]) {
    let factors = |values: &[Picture]| -> Vec<[f32; 3]> {
        let factor = |pixel: usize| -> [f32; 3] {
            std::array::from_fn(|channel| {
                let sum: f32 = values.iter().filter_map(|layer| layer.rgb.get(pixel)).map(|rgb| rgb[channel]).sum();
                let whole = picture.rgb[pixel][channel];
                if sum > f32::MIN_POSITIVE { whole / sum } else { f32::INFINITY }
            })
        };
        (0..picture.rgb.len()).into_par_iter().map(factor).collect()
    };
    let (denoised_factors, noisy_factors) = (factors(layers), factors(noisy));
    for (index, (layer, noisy)) in layers.iter_mut().zip(noisy).enumerate() {
        let pixels =
            layer.rgb.iter_mut().zip(&noisy.rgb).zip(&picture.rgb).zip(denoised_factors.iter().zip(&noisy_factors));
        for (((pixel, noisy), whole), (denoised_factor, noisy_factor)) in pixels {
            for channel in 0..3 {
                pixel[channel] = match (denoised_factor[channel], noisy_factor[channel]) {
                    (factor, _) if factor.is_finite() => pixel[channel] * factor,
                    (_, factor) if factor.is_finite() => noisy[channel] * factor,
                    _ if index == 0 => whole[channel],
                    _ => 0.0,
                };
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn row(values: &[f32]) -> Picture {
        Picture { width: values.len() as u32, height: 1, rgb: values.iter().map(|value| [*value; 3]).collect() }
    }

    #[test]
    fn the_difference_to_the_picture_is_shared_in_proportion() {
        let picture = row(&[6.0, 6.0, 6.0, 0.0]);
        let noisy = [row(&[9.0, 1.0, 0.0, 0.0]), row(&[9.0, 5.0, 0.0, 0.0])];
        let mut layers = [row(&[1.0, 0.0, 0.0, 2.0]), row(&[2.0, 0.0, 0.0, 2.0])];
        share_difference(&picture, &noisy, &mut layers);
        let values = |layer: &Picture| layer.rgb.iter().map(|rgb| rgb[0]).collect::<Vec<_>>();
        assert_eq!(values(&layers[0]), [2.0, 1.0, 6.0, 0.0]);
        assert_eq!(values(&layers[1]), [4.0, 5.0, 0.0, 0.0]);
    }
}

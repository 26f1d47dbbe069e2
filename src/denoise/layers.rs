//! Denoised light layers that sum to the denoised picture.

use super::{Cancelled, Quality, denoised_by_network, with_noisy_part};
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
/// their denoised values. All layers keep the same part of the noisy ones as the picture does.
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
    let Some(whole) = denoised_by_network(picture, aovs, quality, is_cancelled)? else {
        return Ok(DenoisedLayers { picture: picture.clone(), layers: layers.to_vec() });
    };
    let (whole, noisy_part) = with_noisy_part(whole, picture, aovs);
    let denoised = layers.iter().map(|layer| {
        let denoised = denoised_by_network(layer, aovs, quality, is_cancelled)?;
        let mixed = denoised.map(|mut denoised| {
            noisy_part.mix(&mut denoised, layer);
            denoised
        });
        Ok(mixed.unwrap_or_else(|| layer.clone()))
    });
    let mut denoised = denoised.collect::<Result<Vec<_>, _>>()?;
    share_difference(&whole, layers, &mut denoised);
    Ok(DenoisedLayers { picture: whole, layers: denoised })
}

/// Scales the layers of each pixel so that they sum to the picture. Where all of them are black, they take the
/// proportions of the noisy layers; where those are black, too, the brightest layer of the picture takes the whole, which
/// is a light that is on.
fn share_difference(picture: &Picture, noisy: &[Picture], layers: &mut [Picture]) {
    let factors = |values: &[Picture]| -> Vec<[Option<f32>; 3]> {
        let factor = |pixel: usize| -> [Option<f32>; 3] {
            std::array::from_fn(|channel| {
                let sum: f32 = values.iter().filter_map(|layer| layer.rgb.get(pixel)).map(|rgb| rgb[channel]).sum();
                let whole = picture.rgb[pixel][channel];
                (sum > f32::MIN_POSITIVE).then(|| whole / sum).filter(|factor| factor.is_finite())
            })
        };
        (0..picture.rgb.len()).into_par_iter().map(factor).collect()
    };
    let (denoised_factors, noisy_factors) = (factors(layers), factors(noisy));
    let light = |layer: &Picture| layer.rgb.as_flattened().iter().map(|value| f64::from(*value)).sum::<f64>();
    let brightest = (0..noisy.len()).max_by(|a, b| light(&noisy[*a]).total_cmp(&light(&noisy[*b])));
    for (index, (layer, noisy)) in layers.iter_mut().zip(noisy).enumerate() {
        let pixels =
            layer.rgb.iter_mut().zip(&noisy.rgb).zip(&picture.rgb).zip(denoised_factors.iter().zip(&noisy_factors));
        for (((pixel, noisy), whole), (denoised_factor, noisy_factor)) in pixels {
            for channel in 0..3 {
                pixel[channel] = match (denoised_factor[channel], noisy_factor[channel]) {
                    (Some(factor), _) => pixel[channel] * factor,
                    (None, Some(factor)) => noisy[channel] * factor,
                    (None, None) if Some(index) == brightest => whole[channel],
                    (None, None) => 0.0,
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
        let noisy = [row(&[19.0, 1.0, 0.0, 0.0]), row(&[9.0, 5.0, 0.0, 0.0])];
        let mut layers = [row(&[1.0, 0.0, 0.0, 2.0]), row(&[2.0, 0.0, 0.0, 2.0])];
        share_difference(&picture, &noisy, &mut layers);
        let values = |layer: &Picture| layer.rgb.iter().map(|rgb| rgb[0]).collect::<Vec<_>>();
        // The brightest layer, the first one, takes what has no proportions.
        assert_eq!(values(&layers[0]), [2.0, 1.0, 6.0, 0.0]);
        assert_eq!(values(&layers[1]), [4.0, 5.0, 0.0, 0.0]);
    }

    #[test]
    fn a_light_that_is_off_gets_no_light_wherever_its_layer_stands() {
        let picture = row(&[4.0, 6.0]);
        let noisy = [row(&[0.0, 0.0]), row(&[4.0, 0.0])];
        let mut layers = [row(&[0.0, 0.0]), row(&[3.0, 0.0])];
        share_difference(&picture, &noisy, &mut layers);
        assert_eq!(layers, [row(&[0.0, 0.0]), row(&[4.0, 6.0])]);
    }
}

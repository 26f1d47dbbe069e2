//! The denoiser: a neural network that estimates a picture without noise from a noisy one and its albedo and normals.
//!
//! The network is the U-Net of Intel Open Image Denoise (Áfra, <https://www.openimagedenoise.org>) with its weights, in
//! our own code. `assets/denoiser/README.md` names version and licence of the weights. It is biased: detail that it takes
//! for noise is lost, and noise that it takes for detail stays. Where its bias is larger than the noise, most of the noisy
//! picture is kept. Meters, references and noise estimates never read its pixels.
//!
//! | file | contents |
//! |---|---|
//! | `weight_file` | reader of the weights |
//! | `transfer` | encoding of radiance for the network |
//! | `feature_map`, `filter`, `convolution` | features in blocks of 16 channels, transformed weights, convolutions |
//! | `winograd` | pairs of rows of a convolution |
//! | `simd` | registers of each instruction set |
//! | `network` | the layers |
//! | `tiles` | borders, and pictures that are too large for one run |
//! | `noisy_part` | the noisy picture where the network is biased |
//! | `layers` | light layers that sum to the denoised picture |

mod convolution;
mod feature_map;
mod filter;
mod layers;
mod network;
mod noisy_part;
mod simd;
#[cfg(test)]
mod tests;
mod tiles;
mod transfer;
mod weight_file;
mod winograd;

pub use layers::{DenoisedLayers, denoise_layers};
pub use network::Cancelled;

use crate::photo::{AovPicture, Picture};
use network::Network;
use noisy_part::NoisyPart;
use simd::InstructionSet;
use std::sync::LazyLock;
use tiles::MirroredPicture;
use weight_file::{WeightError, WeightFile};

/// Pixels by which a picture is continued beyond its borders. Without them the network sees zeros there, as that of the
/// native library does, and the outermost three pixels have up to twice the error; 16 and more are no better than 8.
const MARGIN: usize = 8;

/// The denoiser's network.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Quality {
    /// 0.9 million weights.
    Best,
    /// 0.3 million weights: in two thirds of the time, less detail.
    Fast,
}

static BEST: LazyLock<Result<Network, WeightError>> =
    LazyLock::new(|| network(include_bytes!("../../assets/denoiser/rt_hdr_alb_nrm.tza")));
static FAST: LazyLock<Result<Network, WeightError>> =
    LazyLock::new(|| network(include_bytes!("../../assets/denoiser/rt_hdr_alb_nrm_small.tza")));

fn network(weights: &[u8]) -> Result<Network, WeightError> {
    Network::new(&WeightFile::parse(weights)?, InstructionSet::best())
}

impl Quality {
    /// Returns the name of the network, for the picture's file.
    pub fn label(self) -> &'static str {
        match self {
            Quality::Best => "U-Net of Open Image Denoise, weights rt_hdr_alb_nrm",
            Quality::Fast => "U-Net of Open Image Denoise, weights rt_hdr_alb_nrm_small",
        }
    }

    /// Returns the network; none if the weights in the program are damaged, which a test excludes.
    fn network(self) -> Option<&'static Network> {
        let network = match self {
            Quality::Best => &BEST,
            Quality::Fast => &FAST,
        };
        network.as_ref().inspect_err(|error| log::error!("{error}")).ok()
    }
}

/// Returns the picture without noise, on the current thread pool: the same bits for any number of threads.
///
/// `aovs` are the albedo and normals of the same pixels. Where their variance is known, a part of the noisy picture
/// stays if the network changes more than the noise explains ([`noisy_part`]). Pixels that are no number or negative
/// count as black. The picture is returned as it is if the sizes differ, and if it is black: the network would see light
/// in it.
///
/// # Errors
/// Once `is_cancelled` returns true.
pub fn denoise(
    picture: &Picture,
    aovs: &AovPicture,
    quality: Quality,
    is_cancelled: &(dyn Fn() -> bool + Sync),
) -> Result<Picture, Cancelled> {
    let denoised = denoised_by_network(picture, aovs, quality, is_cancelled)?;
    Ok(denoised.map_or_else(|| picture.clone(), |denoised| with_noisy_part(denoised, picture, aovs).0))
}

/// Returns the picture as the network denoises it; none where it returns it as it is.
///
/// # Errors
/// Once `is_cancelled` returns true.
fn denoised_by_network(
    picture: &Picture,
    aovs: &AovPicture,
    quality: Quality,
    is_cancelled: &(dyn Fn() -> bool + Sync),
) -> Result<Option<Picture>, Cancelled> {
    let is_black = picture.rgb.as_flattened().iter().all(|value| value.is_nan() || *value <= 0.0);
    let network = quality.network().filter(|_| !is_black);
    let Some((network, mirrored)) = network.zip(MirroredPicture::new(picture, aovs, MARGIN)) else { return Ok(None) };
    tiles::denoise(network, mirrored, tiles::MAX_PIXELS, is_cancelled).map(Some)
}

/// Returns the denoised picture with the part of the noisy one that it keeps, and this part.
fn with_noisy_part(mut denoised: Picture, noisy: &Picture, aovs: &AovPicture) -> (Picture, NoisyPart) {
    let part = NoisyPart::new(noisy, &denoised, aovs);
    part.mix(&mut denoised, noisy);
    (denoised, part)
}

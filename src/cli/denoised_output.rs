//! The picture that `render` and `merge` write, denoised or not.

use super::failure::Failure;
use super::picture_output::{self, WrittenPicture};
use crate::denoise::{self, Quality};
use crate::io::{self, LayeredPicture, PictureInfo};
use crate::photo::{AovPicture, Picture};
use anyhow::anyhow;
use clap::ValueEnum;
use std::path::Path;
use std::time::Instant;

/// The choices of `--denoise`.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, ValueEnum)]
pub enum Denoise {
    /// The whole network.
    On,
    /// The small network, in half the time.
    Fast,
    /// No denoiser.
    #[default]
    Off,
}

impl Denoise {
    /// Returns the network; none for no denoiser.
    pub fn quality(self) -> Option<Quality> {
        match self {
            Denoise::On => Some(Quality::Best),
            Denoise::Fast => Some(Quality::Fast),
            Denoise::Off => None,
        }
    }
}

/// A developed picture that is to be written.
#[derive(Debug)]
pub struct Output<'a> {
    /// The file.
    pub path: &'a Path,
    /// Size of the picture, pixels. What follows may be smaller: a coarse version.
    pub size: (u32, u32),
    /// The whole picture.
    pub picture: Picture,
    /// The light layers that are written.
    pub layers: Vec<(String, Picture)>,
    /// Albedo and normals for the denoiser.
    pub denoiser_aovs: Option<AovPicture>,
    /// The AOVs that are written.
    pub aovs: Option<AovPicture>,
    /// Settings of the render.
    pub info: PictureInfo,
}

/// A picture on the disk, and the time that the denoiser took.
#[derive(Debug)]
pub struct Written {
    /// The picture.
    pub picture: WrittenPicture,
    /// Seconds; none for a picture that is not denoised.
    pub denoise_s: Option<f64>,
}

impl Output<'_> {
    /// Denoises the picture, if that is requested, and writes it. It runs on the current thread pool.
    pub fn write(self, denoise: Denoise) -> Result<Written, Failure> {
        let Output { path, size: (width, height), picture, layers, denoiser_aovs, aovs, info } = self;
        let resized = |picture: &Picture| picture.resized(width, height);
        let all_resized = |layers: &[(String, Picture)]| -> Vec<(String, Picture)> {
            layers.iter().map(|(name, layer)| (name.clone(), resized(layer))).collect()
        };
        let (noisy, noisy_layers) = (resized(&picture), all_resized(&layers));
        let noisy = LayeredPicture { picture: &noisy, layers: &noisy_layers };
        let aovs = aovs.map(|aovs| aovs.resized(width, height));
        let (encoded, denoise_s) = match denoise.quality() {
            None => (io::encode_layers(path, noisy.picture, noisy.layers, aovs.as_ref(), &info)?, None),
            Some(quality) => {
                let denoiser_aovs = denoiser_aovs.ok_or_else(|| {
                    Failure::Input(anyhow!("the denoiser needs albedo and normals: render the parts with --denoise on"))
                })?;
                let started = Instant::now();
                let names = layers.iter().map(|(name, _)| name.clone()).collect::<Vec<_>>();
                let layers: Vec<Picture> = layers.into_iter().map(|(_, layer)| layer).collect();
                let denoised = denoise::denoise_layers(&picture, &layers, &denoiser_aovs, quality, &|| false);
                let denoised = denoised.map_err(|_| Failure::Interrupted)?;
                let denoise_s = started.elapsed().as_secs_f64();
                let layers = names.into_iter().zip(denoised.layers.iter().map(resized)).collect::<Vec<_>>();
                let shown = LayeredPicture { picture: &resized(&denoised.picture), layers: &layers };
                let info = PictureInfo { denoiser: Some(quality.label()), ..info };
                (io::encode_denoised(path, shown, noisy, aovs.as_ref(), &info)?, Some(denoise_s))
            }
        };
        Ok(Written { picture: picture_output::write(&encoded)?, denoise_s })
    }
}

//! The picture that `render` and `merge` write, denoised or not.

use super::failure::Failure;
use super::picture_output::{self, WrittenPicture};
use crate::denoise::{self, DenoisedLayers, Quality};
use crate::io::{self, LayeredPicture, PictureInfo};
use crate::photo::{AovPicture, LazyPicture, Picture};
use anyhow::anyhow;
use clap::ValueEnum;
use std::path::Path;
use std::time::Instant;

/// The choices of `--denoise`.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, ValueEnum)]
pub enum Denoise {
    /// The whole network.
    On,
    /// The small network, in two thirds of the time.
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
    pub layers: Vec<(String, LazyPicture<'a>)>,
    /// The AOVs, which the denoiser reads, and which are written if the file has a place for them.
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
        let Output { path, size: (width, height), picture, layers, aovs, info } = self;
        // Denoise in the size of the render
        let started = Instant::now();
        let denoised = match denoise.quality() {
            Some(quality) => Some((denoised(&picture, &layers, aovs.as_ref(), quality)?, quality.label())),
            None => None,
        };
        let denoise_s = denoised.as_ref().map(|_| started.elapsed().as_secs_f64());
        // Write in the requested size
        let names: Vec<String> = layers.iter().map(|(name, _)| name.clone()).collect();
        let aovs = aovs.map(|aovs| aovs.into_resized(width, height));
        let picture = picture.into_resized(width, height);
        let layers: Vec<_> = layers.into_iter().map(|(name, layer)| (name, layer.resized(width, height))).collect();
        let noisy = LayeredPicture { picture: &picture, layers: &layers };
        let file = |shown, noisy, info| -> Result<WrittenPicture, Failure> {
            picture_output::write(&io::picture_file(path, shown, noisy, aovs.as_ref(), info)?)
        };
        let picture = match denoised {
            None => file(noisy, None, &info)?,
            Some((denoised, denoiser)) => {
                let picture = denoised.picture.into_resized(width, height);
                let layers = denoised.layers.into_iter().map(|layer| LazyPicture::from(layer).resized(width, height));
                let layers: Vec<_> = names.into_iter().zip(layers).collect();
                let shown = LayeredPicture { picture: &picture, layers: &layers };
                file(shown, Some(noisy), &PictureInfo { denoiser: Some(denoiser), ..info })?
            }
        };
        Ok(Written { picture, denoise_s })
    }
}

fn denoised(
    picture: &Picture,
    layers: &[(String, LazyPicture<'_>)],
    aovs: Option<&AovPicture>,
    quality: Quality,
) -> Result<DenoisedLayers, Failure> {
    let aovs = aovs.ok_or_else(|| {
        Failure::Input(anyhow!("the denoiser needs albedo and normals: render the parts with --denoise on"))
    })?;
    let layers: Vec<Picture> = layers.iter().map(|(_, layer)| layer.collect()).collect();
    denoise::denoise_layers(picture, &layers, aovs, quality, &|| false).map_err(|_| Failure::Interrupted)
}

//! Writes pictures: tone-mapped PNG and JPEG, scene-linear EXR.

mod encoded;
mod exr_file;
mod part_file;

pub use encoded::EncodedPicture;
pub use part_file::{PicturePart, encode_part, read_part};

use super::atomic;
use super::error::SaveError;
use crate::photo::{AovPicture, Picture, exposure};
use crate::scene::Scene;
use std::io::Cursor;
use std::path::Path;

/// JPEG quality, 0 to 100: no visible loss on skin.
const JPEG_QUALITY: u8 = 95;

/// The settings that a picture was rendered with. EXR files hold them as attributes.
#[derive(Clone, Debug, PartialEq)]
pub struct PictureInfo {
    /// Time-integrated luminance of the picture value 1, cd s/m2.
    pub cd_s_m2_per_unit: f32,
    /// Samples per pixel.
    pub spp: u32,
    /// Seed of the sampler.
    pub seed: u64,
    /// Rendering method: `path`, `direct`, `zbuffer` ...
    pub method: String,
    /// The denoiser, if the picture is denoised.
    pub denoiser: Option<&'static str>,
}

/// A picture and its light layers.
#[derive(Clone, Copy, Debug)]
pub struct LayeredPicture<'a> {
    /// The whole picture.
    pub picture: &'a Picture,
    /// The layers, by name.
    pub layers: &'a [(String, Picture)],
}

impl PictureInfo {
    /// Returns the settings of a render; the exposure scale is that of the scene's camera.
    pub fn new(scene: &Scene, method: &str, spp: u32, seed: u64) -> Self {
        let cd_s_m2_per_unit = 1.0 / exposure::pixel_per_cd_s_m2(scene);
        PictureInfo { cd_s_m2_per_unit, spp, seed, method: method.to_owned(), denoiser: None }
    }
}

/// The picture formats, chosen by the extension of the file name.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum PictureFormat {
    /// Tone-mapped 8-bit sRGB.
    Png,
    /// Tone-mapped 8-bit sRGB, lossy.
    Jpeg,
    /// Scene-linear 32-bit float, after exposure and before the tone curve.
    Exr,
}

impl PictureFormat {
    /// Returns the format of a file name.
    ///
    /// # Errors
    /// If the extension is none of `png`, `jpg`, `jpeg` and `exr`, in upper or lower case.
    pub fn of(path: &Path) -> Result<Self, SaveError> {
        let ending = path.extension().map(|e| e.to_string_lossy().to_lowercase()).unwrap_or_default();
        match ending.as_str() {
            "png" => Ok(PictureFormat::Png),
            "jpg" | "jpeg" => Ok(PictureFormat::Jpeg),
            "exr" => Ok(PictureFormat::Exr),
            _ => Err(SaveError::UnknownEnding { ending, path: path.to_owned() }),
        }
    }
}

/// Reads the picture of an EXR file.
///
/// # Errors
/// If the file can't be read, or has no red, green and blue channels.
pub fn read_exr(path: &Path) -> Result<Picture, String> {
    let content = std::fs::read(path).map_err(|error| error.to_string())?;
    exr_file::decode(&content)
}

/// Writes a picture in the format of the file name's extension. An older file is replaced atomically.
///
/// # Errors
/// If the extension is unknown, the folder missing or the picture empty, or if the file can't be written.
pub fn export_picture(path: &Path, picture: &Picture, info: &PictureInfo) -> Result<(), SaveError> {
    export_layers(path, picture, &[], None, info)
}

/// As [`export_picture`]; an EXR file also gets the light layers, each as a part under its light's name, and the AOVs
/// as channels beside the picture's. PNG and JPEG hold the picture alone.
///
/// # Errors
/// As [`export_picture`], and if layers or AOVs differ in size from the picture.
pub fn export_layers(
    path: &Path,
    picture: &Picture,
    layers: &[(String, Picture)],
    aovs: Option<&AovPicture>,
    info: &PictureInfo,
) -> Result<(), SaveError> {
    encode_layers(path, picture, layers, aovs, info)?.write()
}

/// Encodes a picture as [`export_layers`] does, for a file that is written later.
///
/// # Errors
/// If the extension is unknown or the picture empty, or if layers or AOVs differ in size from the picture.
pub fn encode_layers(
    path: &Path,
    picture: &Picture,
    layers: &[(String, Picture)],
    aovs: Option<&AovPicture>,
    info: &PictureInfo,
) -> Result<EncodedPicture, SaveError> {
    encode(path, LayeredPicture { picture, layers }, None, aovs, info)
}

/// Encodes a denoised picture, for a file that is written later. An EXR file holds the noisy pixels, too: the channels
/// `noisy.R`, `noisy.G` and `noisy.B` of the picture and of each layer.
///
/// # Errors
/// As [`encode_layers`], and if the noisy picture has another size or other layers.
pub fn encode_denoised(
    path: &Path,
    denoised: LayeredPicture<'_>,
    noisy: LayeredPicture<'_>,
    aovs: Option<&AovPicture>,
    info: &PictureInfo,
) -> Result<EncodedPicture, SaveError> {
    encode(path, denoised, Some(noisy), aovs, info)
}

fn encode(
    path: &Path,
    shown: LayeredPicture<'_>,
    noisy: Option<LayeredPicture<'_>>,
    aovs: Option<&AovPicture>,
    info: &PictureInfo,
) -> Result<EncodedPicture, SaveError> {
    let format = PictureFormat::of(path)?;
    let picture = shown.picture;
    check_size("the picture", picture)?;
    let own = shown.layers.iter().map(|(name, layer)| (name.as_str(), layer));
    let noisy_layers = noisy.into_iter().flat_map(|noisy| {
        let layers = noisy.layers.iter().map(|(name, layer)| (name.as_str(), layer));
        std::iter::once(("the noisy picture", noisy.picture)).chain(layers)
    });
    for (name, layer) in own.chain(noisy_layers) {
        check_size(name, layer)?;
        if (layer.width, layer.height) != (picture.width, picture.height) {
            return Err(SaveError::BadPicture(format!("the layer {name:?} has another size than the picture")));
        }
    }
    if aovs.is_some_and(|aovs| (aovs.width, aovs.height) != (picture.width, picture.height)) {
        return Err(SaveError::BadPicture("the AOVs have another size than the picture".to_owned()));
    }
    if noisy.is_some_and(|noisy| noisy.layers.len() != shown.layers.len()) {
        return Err(SaveError::BadPicture("the noisy picture has other layers than the denoised one".to_owned()));
    }
    let content = match format {
        PictureFormat::Png | PictureFormat::Jpeg => encode_8bit(picture, format),
        PictureFormat::Exr => exr_file::encode(shown, noisy, aovs, info),
    };
    let content = content.map_err(|message| SaveError::Encode { message, path: path.to_owned() })?;
    Ok(EncodedPicture::new(path, content))
}

fn check_size(name: &str, picture: &Picture) -> Result<(), SaveError> {
    let pixels = picture.width as usize * picture.height as usize;
    if pixels == 0 || pixels != picture.rgb.len() {
        let Picture { width, height, rgb } = picture;
        return Err(SaveError::BadPicture(format!(
            "{name}: {} pixels are no picture of {width} x {height}",
            rgb.len()
        )));
    }
    Ok(())
}

/// Writes an sRGB image as PNG or JPEG, without tone mapping. An older file is replaced atomically.
///
/// # Errors
/// As [`export_picture`], and if the extension is `exr`.
pub fn export_shown(path: &Path, shown: &image::RgbImage) -> Result<(), SaveError> {
    let format = PictureFormat::of(path)?;
    let content = if format == PictureFormat::Exr || shown.is_empty() {
        Err("bytes as they are shown go to PNG and JPEG".to_owned())
    } else {
        encode_rgb8(shown.width(), shown.height(), shown.as_raw(), format)
    };
    let content = content.map_err(|message| SaveError::Encode { message, path: path.to_owned() })?;
    atomic::send(path, &content)
}

/// Checks that a picture can be written to a file, before it is rendered: its extension, its folder, permissions.
///
/// # Errors
/// As [`export_picture`], as far as they can be known before.
pub fn check_picture_file(path: &Path) -> Result<(), SaveError> {
    PictureFormat::of(path)?;
    atomic::check(path)
}

/// Encodes the tone-mapped picture as PNG or JPEG.
fn encode_8bit(picture: &Picture, format: PictureFormat) -> Result<Vec<u8>, String> {
    encode_rgb8(picture.width, picture.height, picture.to_srgb8().as_flattened(), format)
}

fn encode_rgb8(width: u32, height: u32, rgb: &[u8], format: PictureFormat) -> Result<Vec<u8>, String> {
    use image::ImageEncoder;
    let mut content = Cursor::new(Vec::new());
    let color = image::ExtendedColorType::Rgb8;
    match format {
        PictureFormat::Jpeg => image::codecs::jpeg::JpegEncoder::new_with_quality(&mut content, JPEG_QUALITY)
            .write_image(rgb, width, height, color),
        _ => image::codecs::png::PngEncoder::new(&mut content).write_image(rgb, width, height, color),
    }
    .map_err(|error| error.to_string())?;
    Ok(content.into_inner())
}

#[cfg(test)]
mod tests;

//! Finished pictures to files: PNG and JPEG as they are shown, EXR as the numbers they are.

mod exr_file;

use super::atomic;
use super::error::SaveError;
use crate::photo::{AovPicture, Picture, exposure};
use crate::scene::Camera;
use std::io::Cursor;
use std::path::Path;

/// JPEG quality, of 100: no visible loss on skin.
const JPEG_QUALITY: u8 = 95;

/// How a picture came about. EXR files carry it as attributes.
#[derive(Clone, Debug, PartialEq)]
pub struct PictureInfo {
    /// Time-integrated luminance, cd s/m2, of the picture value 1.
    pub cd_s_m2_per_unit: f32,
    /// Samples a pixel.
    pub spp: u32,
    /// Seed of the sampler.
    pub seed: u64,
    /// Rendering method: `path`, `direct`, `zbuffer` ...
    pub method: String,
}

impl PictureInfo {
    /// The exposure scale follows from the camera.
    pub fn new(camera: &Camera, method: &str, spp: u32, seed: u64) -> Self {
        let cd_s_m2_per_unit = 1.0 / exposure::pixel_per_cd_s_m2(camera);
        PictureInfo { cd_s_m2_per_unit, spp, seed, method: method.to_owned() }
    }
}

/// The kinds of picture files, by the ending of their name.
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
    /// The format for a file name.
    ///
    /// # Errors
    /// When the name ends in none of `.png`, `.jpg`, `.jpeg`, `.exr`, in whatever case.
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
/// A message for a file that cannot be read or holds no red, green and blue.
pub fn read_exr(path: &Path) -> Result<Picture, String> {
    let content = std::fs::read(path).map_err(|error| error.to_string())?;
    exr_file::decode(&content)
}

/// Writes a picture in the format that the file name asks for. An older file is replaced only by a whole new one.
///
/// # Errors
/// For an unknown ending, a missing folder, an empty picture, or a disk that refuses.
pub fn export_picture(path: &Path, picture: &Picture, info: &PictureInfo) -> Result<(), SaveError> {
    export_layers(path, picture, &[], None, info)
}

/// As [`export_picture`]; an EXR file also gets the light layers, each as a part under its light's name, and the AOVs as
/// channels beside the picture's. PNG and JPEG hold the picture alone.
///
/// # Errors
/// As [`export_picture`], and when layers or AOVs differ in size.
pub fn export_layers(
    path: &Path,
    picture: &Picture,
    layers: &[(String, Picture)],
    aovs: Option<&AovPicture>,
    info: &PictureInfo,
) -> Result<(), SaveError> {
    let format = PictureFormat::of(path)?;
    check_size("the picture", picture)?;
    for (name, layer) in layers {
        check_size(name, layer)?;
        if (layer.width, layer.height) != (picture.width, picture.height) {
            return Err(SaveError::BadPicture(format!("the layer {name:?} has another size than the picture")));
        }
    }
    if aovs.is_some_and(|aovs| (aovs.width, aovs.height) != (picture.width, picture.height)) {
        return Err(SaveError::BadPicture("the AOVs have another size than the picture".to_owned()));
    }
    let content = match format {
        PictureFormat::Png | PictureFormat::Jpeg => encode_8bit(picture, format),
        PictureFormat::Exr => exr_file::encode(picture, layers, aovs, info),
    };
    let content = content.map_err(|message| SaveError::Encode { message, path: path.to_owned() })?;
    atomic::write(path, &content)
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

/// Writes sRGB bytes as they are, as PNG or JPEG. An older file is replaced only by a whole new one.
///
/// # Errors
/// For an ending that is not of these two, a missing folder, an empty picture, or a disk that refuses.
pub fn export_shown(path: &Path, shown: &image::RgbImage) -> Result<(), SaveError> {
    let format = PictureFormat::of(path)?;
    let content = if format == PictureFormat::Exr || shown.is_empty() {
        Err("bytes as they are shown go to PNG and JPEG".to_owned())
    } else {
        encode_rgb8(shown.width(), shown.height(), shown.as_raw(), format)
    };
    let content = content.map_err(|message| SaveError::Encode { message, path: path.to_owned() })?;
    atomic::write(path, &content)
}

/// PNG or JPEG of the picture as it is shown.
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

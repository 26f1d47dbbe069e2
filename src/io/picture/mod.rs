//! Writes pictures: tone-mapped PNG, JPEG and TIFF, scene-linear EXR.

mod channel_samples;
mod exr_file;
mod exr_header;
mod icc;
mod metadata;
mod panorama;
mod part_file;
mod picture_file;
mod rendered_file;

pub use metadata::CaptureInfo;
pub use panorama::is_panorama;
pub use part_file::{PicturePart, encode_part, read_part};
pub use picture_file::PictureFile;
pub use rendered_file::{RenderedPicture, read_rendered};

use super::atomic;
use super::error::SaveError;
use super::scene_file::write_scene;
use crate::photo::{AovPicture, LazyPicture, Picture, exposure};
use crate::scene::Scene;
use image::codecs::jpeg::JpegEncoder;
use image::codecs::png::PngEncoder;
use image::codecs::tiff::TiffEncoder;
use image::{ExtendedColorType, ImageEncoder};
use picture_file::Content;
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
    /// The camera's settings.
    pub capture: CaptureInfo,
    /// The studio as it was rendered, in the form of its file.
    pub studio: String,
}

/// A picture and its light layers.
#[derive(Clone, Copy, Debug)]
pub struct LayeredPicture<'a> {
    /// The whole picture.
    pub picture: &'a Picture,
    /// The layers, by name; their pixels are computed while the file is written.
    pub layers: &'a [(String, LazyPicture<'a>)],
}

impl<'a> LayeredPicture<'a> {
    /// Returns a picture without layers.
    pub fn alone(picture: &'a Picture) -> Self {
        LayeredPicture { picture, layers: &[] }
    }
}

impl PictureInfo {
    /// Returns the settings of a render; the exposure scale is that of the scene's camera.
    pub fn new(scene: &Scene, method: &str, spp: u32, seed: u64) -> Self {
        let cd_s_m2_per_unit = 1.0 / exposure::pixel_per_cd_s_m2(scene);
        PictureInfo {
            cd_s_m2_per_unit,
            spp,
            seed,
            method: method.to_owned(),
            denoiser: None,
            capture: CaptureInfo::new(scene),
            studio: write_scene(scene),
        }
    }
}

/// The picture formats, chosen by the extension of the file name.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum PictureFormat {
    /// Tone-mapped 8-bit sRGB.
    Png,
    /// Tone-mapped 8-bit sRGB, lossy.
    Jpeg,
    /// Tone-mapped 16-bit sRGB, for retouching.
    Tiff,
    /// Scene-linear 32-bit float, after exposure and before the tone curve.
    Exr,
}

impl PictureFormat {
    /// Returns the format of a file name.
    ///
    /// # Errors
    /// If the extension is none of `png`, `jpg`, `jpeg`, `tif`, `tiff` and `exr`, in upper or lower case.
    pub fn of(path: &Path) -> Result<Self, SaveError> {
        let ending = path.extension().map(|e| e.to_string_lossy().to_lowercase()).unwrap_or_default();
        match ending.as_str() {
            "png" => Ok(PictureFormat::Png),
            "jpg" | "jpeg" => Ok(PictureFormat::Jpeg),
            "tif" | "tiff" => Ok(PictureFormat::Tiff),
            "exr" => Ok(PictureFormat::Exr),
            _ => {
                let known = "a picture's name ends in .png, .jpg, .tif or .exr";
                Err(SaveError::UnknownEnding { known, ending, path: path.to_owned() })
            }
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
    picture_file(path, LayeredPicture::alone(picture), None, None, info)?.write()
}

/// Prepares the file of a picture, to be written later. An EXR file also gets the light layers, each as a part under
/// its light's name, and the AOVs as channels beside the picture's; with the picture before the denoiser, it gets the
/// channels `noisy.R`, `noisy.G` and `noisy.B` of the picture and of each layer. PNG, JPEG and TIFF hold the picture alone.
///
/// # Errors
/// If the extension is unknown or the picture empty, or if layers, AOVs or the noisy picture differ in size or number.
pub fn picture_file<'a>(
    path: &Path,
    shown: LayeredPicture<'a>,
    noisy: Option<LayeredPicture<'a>>,
    aovs: Option<&'a AovPicture>,
    info: &PictureInfo,
) -> Result<PictureFile<'a>, SaveError> {
    let format = PictureFormat::of(path)?;
    let picture = shown.picture;
    check_size(picture)?;
    let size = (picture.width, picture.height);
    let bad = |message: String| Err(SaveError::BadPicture(message));
    let layers = shown.layers.iter().chain(noisy.into_iter().flat_map(|noisy| noisy.layers));
    if let Some((name, _)) = { layers }.find(|(_, layer)| layer.size() != size) {
        return bad(format!("the layer {name:?} has another size than the picture"));
    }
    if aovs.is_some_and(|aovs| (aovs.width, aovs.height) != size) {
        return bad("the AOVs have another size than the picture".to_owned());
    }
    if let Some(noisy) = noisy {
        check_size(noisy.picture)?;
        if (noisy.picture.width, noisy.picture.height) != size || noisy.layers.len() != shown.layers.len() {
            return bad("the noisy picture has another size or other layers than the denoised one".to_owned());
        }
    }
    let content = match format {
        PictureFormat::Png | PictureFormat::Jpeg | PictureFormat::Tiff => Content::Bytes(
            encode_display(picture, format, Some(&info.capture))
                .map_err(|message| SaveError::Encode { message, path: path.to_owned() })?,
        ),
        PictureFormat::Exr => Content::Exr(Box::new(exr_file::image(shown, noisy, aovs, info))),
    };
    Ok(PictureFile::new(path, content))
}

fn check_size(Picture { width, height, rgb }: &Picture) -> Result<(), SaveError> {
    let pixels = *width as usize * *height as usize;
    if pixels == 0 || pixels != rgb.len() {
        return Err(SaveError::BadPicture(format!("{} pixels are no picture of {width} x {height}", rgb.len())));
    }
    Ok(())
}

/// Writes an sRGB image of 8 bits as PNG, JPEG or TIFF, without tone mapping. An older file is replaced atomically.
///
/// # Errors
/// As [`export_picture`], and if the extension is `exr`.
pub fn export_shown(path: &Path, shown: &image::RgbImage) -> Result<(), SaveError> {
    let format = PictureFormat::of(path)?;
    let content = if format == PictureFormat::Exr || shown.is_empty() {
        Err("bytes as they are shown go to PNG, JPEG and TIFF".to_owned())
    } else {
        encode(shown.width(), shown.height(), shown.as_raw(), ExtendedColorType::Rgb8, format, None)
    };
    let content = content.map_err(|message| SaveError::Encode { message, path: path.to_owned() })?;
    atomic::send(path, |out| out.write_all(&content))
}

/// Checks that a picture can be written to a file, before it is rendered: its extension, its folder, permissions.
///
/// # Errors
/// As [`export_picture`], as far as they can be known before.
pub fn check_picture_file(path: &Path) -> Result<(), SaveError> {
    PictureFormat::of(path)?;
    atomic::check(path)
}

/// Encodes the tone-mapped picture as PNG, JPEG or TIFF.
fn encode_display(picture: &Picture, format: PictureFormat, capture: Option<&CaptureInfo>) -> Result<Vec<u8>, String> {
    let Picture { width, height, .. } = *picture;
    if format == PictureFormat::Tiff {
        let codes: Vec<u8> = picture.to_srgb16().iter().flatten().flat_map(|code| code.to_ne_bytes()).collect();
        return encode(width, height, &codes, ExtendedColorType::Rgb16, format, capture);
    }
    encode(width, height, picture.to_srgb8().as_flattened(), ExtendedColorType::Rgb8, format, capture)
}

/// Encodes the tone-mapped picture as JPEG.
///
/// # Errors
/// If the encoder fails, as for a picture without pixels.
pub fn encode_jpeg(picture: &Picture) -> Result<Vec<u8>, String> {
    encode_display(picture, PictureFormat::Jpeg, None)
}

/// Encodes sRGB pixels, row by row, as PNG.
///
/// # Errors
/// If the encoder fails, as for a picture without pixels.
pub fn encode_png(width: u32, height: u32, pixels: &[[u8; 3]]) -> Result<Vec<u8>, String> {
    encode(width, height, pixels.as_flattened(), ExtendedColorType::Rgb8, PictureFormat::Png, None)
}

/// Encodes rows of pixels, in native byte order.
fn encode(
    width: u32,
    height: u32,
    pixels: &[u8],
    color: ExtendedColorType,
    format: PictureFormat,
    capture: Option<&CaptureInfo>,
) -> Result<Vec<u8>, String> {
    let mut content = Cursor::new(Vec::new());
    match format {
        PictureFormat::Jpeg => {
            let mut encoder = JpegEncoder::new_with_quality(&mut content, JPEG_QUALITY);
            metadata::describe(&mut encoder, capture)?;
            encoder.write_image(pixels, width, height, color)
        }
        // The encoder has no EXIF
        PictureFormat::Tiff => {
            let mut encoder = TiffEncoder::new(&mut content);
            metadata::describe(&mut encoder, None)?;
            encoder.write_image(pixels, width, height, color)
        }
        PictureFormat::Png | PictureFormat::Exr => {
            let mut encoder = PngEncoder::new(&mut content);
            metadata::describe(&mut encoder, capture)?;
            encoder.write_image(pixels, width, height, color)
        }
    }
    .map_err(|error| error.to_string())?;
    Ok(content.into_inner())
}

#[cfg(test)]
mod tests;

//! Decodes textures: PNG and JPEG, with limits.

use super::error::AssetError;
use super::jpeg_end::is_cut_off;
use super::read::read_limited;
use crate::scene::Texture;
use image::codecs::jpeg::JpegEncoder;
use image::codecs::png::PngEncoder;
use image::{ExtendedColorType, ImageEncoder, ImageFormat};
use std::io::Cursor;
use std::path::Path;

/// Extensions of texture files, without the dot.
pub const TEXTURE_EXTENSIONS: &[&str] = &["png", "jpg", "jpeg"];

/// Returns true if a file has the extension of a texture, in upper or lower case.
pub fn is_texture_file(path: &Path) -> bool {
    let extension = path.extension().map(|extension| extension.to_string_lossy().to_lowercase());
    extension.is_some_and(|extension| TEXTURE_EXTENSIONS.contains(&extension.as_str()))
}

/// Largest image file, bytes.
const FILE_LIMIT_BYTES: u64 = 512 << 20;
/// Largest width or height, pixels.
const SIDE_LIMIT: u32 = 16_384;
/// Largest memory of the decoder, bytes.
const MEMORY_LIMIT_BYTES: u64 = 1 << 30;

/// A texture from an image file.
#[derive(Debug)]
pub(super) struct DecodedTexture {
    pub texture: Texture,
    /// A sentence, if the file is damaged.
    pub warning: Option<&'static str>,
}

/// Loads an image file as 8-bit sRGB.
pub(super) fn load(path: &Path) -> Result<DecodedTexture, AssetError> {
    decode(&read_limited(path, FILE_LIMIT_BYTES)?, path)
}

/// Returns width and height of an image file, in pixels, from its first bytes; none for a damaged one.
pub(super) fn size(path: &Path) -> Option<(u32, u32)> {
    // Opening a pipe would block.
    let file = path.is_file().then(|| image::ImageReader::open(path).ok())??;
    file.with_guessed_format().ok()?.into_dimensions().ok()
}

/// Decodes the bytes of a PNG or JPEG image to 8-bit sRGB. `path` is the file that the bytes come from, for errors.
pub(super) fn decode(bytes: &[u8], path: &Path) -> Result<DecodedTexture, AssetError> {
    let bad = |message: String| AssetError::BadTexture { message, path: path.to_owned() };
    let mut reader = image::ImageReader::new(Cursor::new(bytes))
        .with_guessed_format()
        .map_err(|error| AssetError::Read { error, path: path.to_owned() })?;
    if !matches!(reader.format(), Some(ImageFormat::Png | ImageFormat::Jpeg) | None) {
        return Err(bad("it is neither PNG nor JPEG".to_owned()));
    }
    let mut limits = image::Limits::default();
    limits.max_image_width = Some(SIDE_LIMIT);
    limits.max_image_height = Some(SIDE_LIMIT);
    limits.max_alloc = Some(MEMORY_LIMIT_BYTES);
    reader.limits(limits);
    let picture = reader.decode().map_err(|error| bad(error.to_string()))?;
    let (width, height) = (picture.width(), picture.height());
    if width == 0 || height == 0 {
        return Err(bad("it has no pixels".to_owned()));
    }
    let (rgb, alpha) = if picture.color().has_alpha() {
        let picture = picture.into_rgba8();
        let alpha: Vec<u8> = picture.pixels().map(|pixel| pixel.0[3]).collect();
        let is_opaque = alpha.iter().all(|value| *value == u8::MAX);
        let rgb = picture.pixels().map(|image::Rgba([red, green, blue, _])| [*red, *green, *blue]).collect();
        (rgb, if is_opaque { Vec::new() } else { alpha })
    } else {
        (picture.into_rgb8().pixels().map(|pixel| pixel.0).collect(), Vec::new())
    };
    let warning = is_cut_off(bytes).then_some("the file is cut off; what is missing of the picture is grey");
    Ok(DecodedTexture { texture: Texture { width, height, rgb, alpha }, warning })
}

/// Returns the bytes of an image file with a texture, for one whose file no longer exists: JPEG for a path that ends so,
/// otherwise PNG.
pub(super) fn encode(texture: &Texture, path: &Path) -> Result<Vec<u8>, String> {
    const JPEG_QUALITY: u8 = 98;
    let mut file = Vec::new();
    let (width, height) = (texture.width, texture.height);
    let rgb = texture.rgb.as_flattened();
    let color = ExtendedColorType::Rgb8;
    let ending = path.extension().map(|ending| ending.to_string_lossy().to_lowercase()).unwrap_or_default();
    let encoded = match ending.as_str() {
        "jpg" | "jpeg" => JpegEncoder::new_with_quality(&mut file, JPEG_QUALITY).write_image(rgb, width, height, color),
        _ if texture.alpha.is_empty() => PngEncoder::new(&mut file).write_image(rgb, width, height, color),
        _ => {
            let pixel = |([red, green, blue], alpha): (&[u8; 3], &u8)| [*red, *green, *blue, *alpha];
            let rgba: Vec<[u8; 4]> = texture.rgb.iter().zip(&texture.alpha).map(pixel).collect();
            PngEncoder::new(&mut file).write_image(rgba.as_flattened(), width, height, ExtendedColorType::Rgba8)
        }
    };
    encoded.map(|()| file).map_err(|error| error.to_string())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_png_is_decoded_to_its_pixels() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("a.png");
        let pixels = image::RgbImage::from_raw(
            3,
            2,
            [[0, 0, 7], [50, 0, 7], [100, 0, 7], [0, 100, 7], [50, 100, 7], [100, 100, 7]].concat(),
        )
        .unwrap();
        pixels.save(&path).unwrap();
        let DecodedTexture { texture, warning } = load(&path).unwrap();
        assert_eq!(warning, None);
        assert_eq!((texture.width, texture.height), (3, 2));
        assert_eq!(texture.rgb[5], [100, 100, 7]);
    }

    #[test]
    fn alpha_is_kept_where_a_pixel_is_transparent_and_written_again() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("leaf.png");
        for (alpha, expected) in [(vec![255, 7], vec![255, 7]), (vec![255, 255], vec![])] {
            let pixels = image::RgbaImage::from_raw(2, 1, vec![1, 2, 3, alpha[0], 4, 5, 6, alpha[1]]).unwrap();
            pixels.save(&path).unwrap();
            let texture = load(&path).unwrap().texture;
            assert_eq!(texture, Texture { width: 2, height: 1, rgb: vec![[1, 2, 3], [4, 5, 6]], alpha: expected });
            std::fs::write(&path, encode(&texture, &path).unwrap()).unwrap();
            assert_eq!(load(&path).unwrap().texture, texture);
        }
    }

    #[test]
    fn malformed_images_are_errors_that_name_the_file() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("a.png");
        // A format that the program writes and that is no format of textures
        image::RgbImage::new(2, 2).save_with_format(&path, ImageFormat::Tiff).unwrap();
        assert!(load(&path).unwrap_err().to_string().contains("neither PNG nor JPEG"));
        std::fs::write(&path, b"not a picture").unwrap();
        assert!(load(&path).unwrap_err().to_string().ends_with("a.png"));
        // A PNG header that promises more pixels than are allowed.
        let mut header = b"\x89PNG\r\n\x1a\n\0\0\0\x0dIHDR\0\xff\xff\xff\0\xff\xff\xff\x08\x02\0\0\0".to_vec();
        header.extend([0; 16]);
        std::fs::write(&path, header).unwrap();
        assert!(matches!(load(&path), Err(AssetError::BadTexture { .. })));
    }
}

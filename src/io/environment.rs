//! Reads environment maps: equirectangular pictures in Radiance HDR or OpenEXR.

use super::error::AssetError;
use super::read::read_limited;
use crate::scene::EnvironmentMap;
use exr::meta::MetaData;
use exr::prelude::{ReadChannels, ReadLayers};
use image::ImageDecoder;
use image::codecs::hdr::HdrDecoder;
use std::io::Cursor;
use std::path::Path;

/// Extensions of environment maps, without the dot.
pub const ENVIRONMENT_EXTENSIONS: &[&str] = &["hdr", "exr"];

/// Largest file, bytes.
const FILE_LIMIT_BYTES: u64 = 512 << 20;
/// Most pixels of a picture.
const MOST_PIXELS: u64 = 16_384 * 8192;
/// Most pixels a byte of the file: no compression does better, and a damaged size takes no memory.
const MOST_PIXELS_PER_BYTE: u64 = 1024;
/// Pixels across of the map that is kept: 0.18 degrees each.
const MOST_WIDTH: u32 = 2048;
/// Largest value, that of half precision: pictures of the sun may hold infinity.
const LARGEST_VALUE: f32 = 65_504.0;
/// Largest ratio of the sides over 2 to 1 that is taken for an equirectangular picture, and the reverse.
const RATIO_TOLERANCE: f32 = 1.02;

/// An environment map from a file, with what is odd about it.
#[derive(Debug)]
pub struct EnvironmentFile {
    /// The map.
    pub map: EnvironmentMap,
    /// Sentences.
    pub warnings: Vec<String>,
}

/// Reads a picture in HDR or EXR.
///
/// # Errors
/// If the file can't be read, is no such picture, is too large, or is all black.
pub fn read_environment(path: &Path) -> Result<EnvironmentFile, AssetError> {
    let bytes = read_limited(path, FILE_LIMIT_BYTES)?;
    let bad = |message: String| AssetError::BadEnvironment { message, path: path.to_owned() };
    let (width, height, mut rgb) =
        if bytes.starts_with(b"#?") { decode_hdr(&bytes).map_err(bad)? } else { decode_exr(&bytes).map_err(bad)? };
    if width == 0 || height == 0 || rgb.len() as u64 != u64::from(width) * u64::from(height) {
        return Err(bad("it has no pixels".to_owned()));
    }
    let mut warnings = Vec::new();
    if !is_equirectangular(width as usize, height as usize) {
        warnings.push(format!("{width} x {height} pixels are not twice as wide as high: it may be no panorama"));
    }
    let is_odd = |value: &f32| !(0.0..=LARGEST_VALUE).contains(value);
    let odd = rgb.iter().flatten().filter(|value| is_odd(value)).count();
    if odd > 0 {
        warnings.push(format!("{odd} values are negative, too large or no numbers; they were brought into range"));
        let usable = |value: f32| if value.is_nan() { 0.0 } else { value.clamp(0.0, LARGEST_VALUE) };
        rgb.iter_mut().flatten().for_each(|value| *value = usable(*value));
    }
    let (width, height, rgb) = reduced(width, height, rgb);
    let map = EnvironmentMap::new(width, height, rgb).ok_or_else(|| bad("it is all black".to_owned()))?;
    Ok(EnvironmentFile { map, warnings })
}

/// Returns true if a size in pixels is that of an equirectangular picture.
pub(super) fn is_equirectangular(width: usize, height: usize) -> bool {
    (1.0 / RATIO_TOLERANCE..=RATIO_TOLERANCE).contains(&(0.5 * width as f32 / height as f32))
}

/// Returns true if a picture of so many pixels is too large, or too large for its file.
fn is_too_large(width: u32, height: u32, bytes: &[u8]) -> bool {
    u64::from(width) * u64::from(height) > MOST_PIXELS.min(bytes.len() as u64 * MOST_PIXELS_PER_BYTE)
}

/// Returns width, height and pixels of the first part with red, green and blue.
fn decode_exr(bytes: &[u8]) -> Result<(u32, u32, Vec<[f32; 3]>), String> {
    let checked = |size: exr::math::Vec2<usize>| {
        let too_large = || format!("the picture of {} x {} pixels is too large", size.width(), size.height());
        let side = |pixels: usize| u32::try_from(pixels).map_err(|_| too_large());
        let (width, height) = (side(size.width())?, side(size.height())?);
        if is_too_large(width, height, bytes) { Err(too_large()) } else { Ok((width, height)) }
    };
    // Check the sizes before memory is allocated for any of them
    let meta = MetaData::read_from_buffered(Cursor::new(bytes), false).map_err(|error| error.to_string())?;
    meta.headers.iter().try_for_each(|header| checked(header.layer_size).map(|_| ()))?;
    let image = exr::prelude::read()
        .no_deep_data()
        .largest_resolution_level()
        .rgb_channels(
            |size, _| {
                let (width, height) = checked(size).unwrap_or((0, 0));
                (width, height, vec![[0.0; 3]; width as usize * height as usize])
            },
            |(width, _, pixels): &mut (u32, u32, Vec<[f32; 3]>), at, (r, g, b): (f32, f32, f32)| {
                if let Some(pixel) = pixels.get_mut(at.y() * *width as usize + at.x()) {
                    *pixel = [r, g, b];
                }
            },
        )
        .first_valid_layer()
        .all_attributes()
        .from_buffered(Cursor::new(bytes))
        .map_err(|error| error.to_string())?;
    Ok(image.layer_data.channel_data.pixels)
}

fn decode_hdr(bytes: &[u8]) -> Result<(u32, u32, Vec<[f32; 3]>), String> {
    let decoder = HdrDecoder::new(Cursor::new(bytes)).map_err(|error| error.to_string())?;
    let (width, height) = decoder.dimensions();
    if is_too_large(width, height, bytes) {
        return Err(format!("the picture of {width} x {height} pixels is too large"));
    }
    let picture = image::DynamicImage::from_decoder(decoder).map_err(|error| error.to_string())?;
    Ok((width, height, picture.into_rgb32f().pixels().map(|pixel| pixel.0).collect()))
}

/// Returns the picture with at most so many pixels across, as means of blocks: their light stays the same.
fn reduced(width: u32, height: u32, rgb: Vec<[f32; 3]>) -> (u32, u32, Vec<[f32; 3]>) {
    let step = width.div_ceil(MOST_WIDTH).max(height.div_ceil(MOST_WIDTH)).max(1);
    // A rest of a block at the edge would be another solid angle
    if step == 1 || !width.is_multiple_of(step) || !height.is_multiple_of(step) {
        return (width, height, rgb);
    }
    let (columns, rows) = (width / step, height / step);
    let mean = |index: u32| {
        let (column, row) = (index % columns * step, index / columns * step);
        let mut sum = [0.0_f32; 3];
        for (y, x) in (0..step).flat_map(|y| (0..step).map(move |x| (y, x))) {
            let pixel = rgb[((row + y) as usize) * width as usize + (column + x) as usize];
            sum.iter_mut().zip(pixel).for_each(|(sum, value)| *sum += value);
        }
        sum.map(|sum| sum / (step * step) as f32)
    };
    (columns, rows, (0..columns * rows).map(mean).collect())
}

#[cfg(test)]
mod tests {
    use super::*;

    fn written(name: &str, bytes: &[u8]) -> Result<EnvironmentFile, String> {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join(name);
        std::fs::write(&path, bytes).unwrap();
        read_environment(&path).map_err(|error| error.to_string())
    }

    /// A Radiance picture of uncompressed pixels, red green blue exponent.
    fn hdr(width: u32, height: u32, pixel: impl Fn(u32, u32) -> [u8; 4]) -> Vec<u8> {
        let mut bytes = format!("#?RADIANCE\nFORMAT=32-bit_rle_rgbe\n\n-Y {height} +X {width}\n").into_bytes();
        bytes.extend((0..height).flat_map(|y| (0..width).map(move |x| (x, y))).flat_map(|(x, y)| pixel(x, y)));
        bytes
    }

    #[test]
    fn a_radiance_picture_has_its_values_and_damaged_ones_are_refused() {
        // An exponent of 129 makes a mantissa of 128 the value 1
        let bytes = hdr(4, 2, |x, _| [128, 64, if x == 3 { 255 } else { 0 }, 129]);
        let EnvironmentFile { map, warnings } = written("sky.hdr", &bytes).unwrap();
        assert_eq!((map.size(), map.rgb()[0][0], map.rgb()[0][1], warnings.len()), ((4, 2), 1.0, 0.5, 0));
        let square = written("square.hdr", &hdr(3, 3, |_, _| [128, 128, 128, 129])).unwrap();
        assert!(square.warnings[0].contains("3 x 3 pixels are not twice as wide as high"), "{:?}", square.warnings);
        assert!(written("black.hdr", &hdr(4, 2, |_, _| [0; 4])).unwrap_err().contains("it is all black"));
        assert!(written("cut.hdr", &bytes[..bytes.len() - 5]).is_err());
        assert!(written("text.exr", b"no picture").is_err());
        assert!(written("large.hdr", b"#?RADIANCE\n\n-Y 999999 +X 999999\n").is_err());
    }

    #[test]
    fn large_pictures_are_reduced_to_means_of_their_pixels() {
        let pixels: Vec<[f32; 3]> = (0..4096 * 2).map(|i| [if i % 2 == 0 { 1.0 } else { 3.0 }; 3]).collect();
        let (width, height, reduced) = reduced(4096, 2, pixels);
        assert_eq!((width, height), (2048, 1));
        assert!(reduced.iter().all(|pixel| *pixel == [2.0; 3]));
    }
}

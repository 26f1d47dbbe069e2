//! OpenEXR: 32-bit float, Rec.709 primaries, ZIP, one part for the picture with its AOVs and one per light.

use super::{LayeredPicture, PictureInfo};
use crate::photo::{AovPicture, Picture};
use exr::meta::MetaData;
use exr::meta::attribute::AttributeValue;
use exr::prelude::{
    AnyChannel, AnyChannels, Encoding, FlatSamples, Image, ImageAttributes, IntegerBounds, Layer, LayerAttributes,
    ReadChannels, ReadLayers, Text, WritableImage,
};
use std::io::Cursor;

/// Name of the part with all lights, before the parts of single lights.
const WHOLE: &str = "picture";

pub(super) fn encode(
    shown: LayeredPicture<'_>,
    noisy: Option<LayeredPicture<'_>>,
    aovs: Option<&AovPicture>,
    info: &PictureInfo,
) -> Result<Vec<u8>, String> {
    let picture = shown.picture;
    let whole = part(WHOLE, picture, noisy.map(|noisy| noisy.picture), aovs, info);
    let noisy_layer = |index: usize| noisy?.layers.get(index).map(|(_, layer)| layer);
    let layers = shown.layers.iter().enumerate();
    let layers = layers.map(|(index, (name, layer))| part(name, layer, noisy_layer(index), None, info));
    let parts: Vec<_> = std::iter::once(whole).chain(layers).collect();
    let size = (picture.width as usize, picture.height as usize);
    let image = Image::from_layers(ImageAttributes::new(IntegerBounds::from_dimensions(size)), parts);
    let mut content = Cursor::new(Vec::new());
    image.write().to_buffered(&mut content).map_err(|error| error.to_string())?;
    Ok(content.into_inner())
}

/// Longest edge of a picture that is read, pixels.
const LARGEST_EDGE: usize = 65_536;
/// Most pixels of a picture that is read: 4 GB of them.
const MOST_PIXELS: usize = 1 << 28;

/// Returns the size of a picture, if it is small enough to be read.
pub(super) fn checked_size(size: exr::math::Vec2<usize>) -> Result<(u32, u32), String> {
    let (width, height) = (size.width(), size.height());
    let too_large = || format!("the picture of {width} x {height} pixels is too large");
    if width.max(height) > LARGEST_EDGE || width * height > MOST_PIXELS {
        return Err(too_large());
    }
    let edge = |pixels: usize| u32::try_from(pixels).map_err(|_| too_large());
    Ok((edge(width)?, edge(height)?))
}

/// Decodes the first part with red, green and blue channels.
pub(super) fn decode(content: &[u8]) -> Result<Picture, String> {
    // Check the sizes before memory is allocated for any of them
    let meta = MetaData::read_from_buffered(Cursor::new(content), false).map_err(|error| error.to_string())?;
    meta.headers.iter().try_for_each(|header| checked_size(header.layer_size).map(|_| ()))?;
    let image = exr::prelude::read()
        .no_deep_data()
        .largest_resolution_level()
        .rgb_channels(
            |size, _| checked_size(size).map_or(Picture::new(0, 0), |(width, height)| Picture::new(width, height)),
            |picture: &mut Picture, at, (r, g, b): (f32, f32, f32)| {
                let index = at.y() * picture.width as usize + at.x();
                if let Some(pixel) = picture.rgb.get_mut(index) {
                    *pixel = [r, g, b];
                }
            },
        )
        .first_valid_layer()
        .all_attributes()
        .from_buffered(Cursor::new(content))
        .map_err(|error| error.to_string())?;
    Ok(image.layer_data.channel_data.pixels)
}

pub(super) fn part(
    name: &str,
    picture: &Picture,
    noisy: Option<&Picture>,
    aovs: Option<&AovPicture>,
    info: &PictureInfo,
) -> Layer<AnyChannels<FlatSamples>> {
    let mut attributes = LayerAttributes::named(text(name));
    attributes.software_name = Some(text(concat!("Catchlight ", env!("CARGO_PKG_VERSION"))));
    let others = [
        ("exposureScale_cd_s_m2_per_unit", AttributeValue::F32(info.cd_s_m2_per_unit)),
        ("spp", AttributeValue::I32(i32::try_from(info.spp).unwrap_or(i32::MAX))),
        // EXR has no 64-bit integers.
        ("seed", AttributeValue::Text(text(&info.seed.to_string()))),
        ("method", AttributeValue::Text(text(&info.method))),
        ("catchlightVersion", AttributeValue::Text(text(env!("CARGO_PKG_VERSION")))),
    ];
    attributes.other.extend(others.map(|(name, value)| (text(name), value)));
    let denoiser = info.denoiser.map(|name| (text("denoiser"), AttributeValue::Text(text(name))));
    attributes.other.extend(denoiser);
    let mut channels = channels(["R", "G", "B"], &picture.rgb).to_vec();
    channels.extend(noisy.into_iter().flat_map(|noisy| self::channels(["noisy.R", "noisy.G", "noisy.B"], &noisy.rgb)));
    channels.extend(aovs.into_iter().flat_map(aov_channels));
    let size = (picture.width as usize, picture.height as usize);
    Layer::new(size, attributes, Encoding::SMALL_LOSSLESS, AnyChannels::sort(channels.into()))
}

/// Returns the channels of the AOVs, with the names of the OpenEXR conventions: normals in world space, `Z` in metres
/// along the view axis, `id` as unsigned integers.
fn aov_channels(aovs: &AovPicture) -> Vec<AnyChannel<FlatSamples>> {
    let mut all = channels(["albedo.R", "albedo.G", "albedo.B"], &aovs.albedo).to_vec();
    all.extend(channels(["normal.X", "normal.Y", "normal.Z"], &aovs.normal));
    all.push(AnyChannel::new("Z", FlatSamples::F32(aovs.depth_m.clone())));
    all.push(AnyChannel::new("id", FlatSamples::U32(aovs.object_id.clone())));
    all
}

/// Splits pixels into three named channels.
fn channels(names: [&str; 3], pixels: &[[f32; 3]]) -> [AnyChannel<FlatSamples>; 3] {
    let channel = |index: usize| {
        let values = pixels.iter().map(|pixel| pixel[index]).collect();
        AnyChannel::new(names[index], FlatSamples::F32(values))
    };
    [0, 1, 2].map(channel)
}

/// Converts text to EXR's byte strings: at most 200 bytes, not empty, `_` for characters that are not printable ASCII.
pub(super) fn text(value: &str) -> Text {
    const LENGTH: usize = 200;
    let fitting =
        |c: char| u8::try_from(c).ok().filter(|byte| byte.is_ascii() && !byte.is_ascii_control()).unwrap_or(b'_');
    let bytes: Vec<u8> = value.chars().take(LENGTH).map(fitting).collect();
    Text::from_slice_unchecked(if bytes.is_empty() { b"_" } else { &bytes })
}

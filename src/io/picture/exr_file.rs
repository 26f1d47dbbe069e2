//! OpenEXR: 32-bit float, Rec.709 primaries, ZIP, one part for the picture with its AOVs and one per light.

use super::channel_samples::{ChannelSamples, ExrChannel, ExrImage, ExrPart};
use super::{LayeredPicture, PictureInfo};
use crate::photo::{AovPicture, LazyPicture, Picture};
use exr::meta::MetaData;
use exr::meta::attribute::AttributeValue;
use exr::prelude::{
    AnyChannel, AnyChannels, Encoding, Image, ImageAttributes, IntegerBounds, Layer, LayerAttributes, Layers,
    ReadChannels, ReadLayers, Text,
};
use std::io::Cursor;

/// Name of the part with all lights, before the parts of single lights.
pub(super) const WHOLE: &str = "picture";
/// Name of the attribute with the studio that was rendered, as in its file.
pub(super) const STUDIO_FILE: &str = "catchlightStudio";
/// Text of a picture without a studio.
pub(super) const NO_STUDIO: &[u8] = b"_";
/// Characters of a layer's name that stay when its part gets a number.
const LONGEST_STEM: usize = 180;
/// Longest text of a studio that a picture holds, bytes.
const LONGEST_STUDIO: usize = 4 << 20;
/// Channels of the pixels that are shown, and of those before the denoiser.
pub(super) const SHOWN_CHANNELS: [&str; 3] = ["R", "G", "B"];
pub(super) const NOISY_CHANNELS: [&str; 3] = ["noisy.R", "noisy.G", "noisy.B"];

pub(super) fn image<'a>(
    shown: LayeredPicture<'a>,
    noisy: Option<LayeredPicture<'a>>,
    aovs: Option<&'a AovPicture>,
    info: &PictureInfo,
) -> ExrImage<'a> {
    let LayeredPicture { picture, layers } = shown;
    let mut channels = Vec::from(picture_channels(SHOWN_CHANNELS, picture));
    channels.extend(noisy.into_iter().flat_map(|noisy| picture_channels(NOISY_CHANNELS, noisy.picture)));
    channels.extend(aovs.into_iter().flat_map(aov_channels));
    let size = (picture.width as usize, picture.height as usize);
    let mut whole = part(WHOLE, size, channels, info);
    whole.attributes.other.insert(text(STUDIO_FILE), AttributeValue::Text(studio_text(info)));
    let part_names = part_names(layers.iter().map(|(name, _)| name.as_str()));
    let layer = |(index, (_, layer)): (usize, &'a (String, LazyPicture<'a>))| {
        let mut channels = Vec::from(layer_channels(SHOWN_CHANNELS, layer));
        let noisy = noisy.and_then(|noisy| noisy.layers.get(index));
        channels.extend(noisy.into_iter().flat_map(|(_, noisy)| layer_channels(NOISY_CHANNELS, noisy)));
        part(&part_names[index], size, channels, info)
    };
    let parts = std::iter::once(whole).chain(layers.iter().enumerate().map(layer));
    Image::from_layers(ImageAttributes::new(IntegerBounds::from_dimensions(size)), parts.collect::<Layers<_>>())
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

/// Returns a part of an image of a width and height, with the settings of the render in its header.
pub(super) fn part<'a>(
    name: &str,
    size: (usize, usize),
    channels: Vec<ExrChannel<'a>>,
    info: &PictureInfo,
) -> ExrPart<'a> {
    let mut attributes = LayerAttributes::named(text(name));
    info.capture.write_attributes(&mut attributes, text);
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
    Layer::new(size, attributes, Encoding::SMALL_LOSSLESS, AnyChannels::sort(channels.into()))
}

/// Name of the channel with the variance of a pixel's mean luminance, divided by the square of the mean, as pbrt's
/// `RelativeVariance.R`.
pub(super) const VARIANCE_CHANNEL: &str = "RelativeVariance.Y";

/// Channels of albedo and normal, of the first hits and of what is seen by mirrors and clear glass: the names that Blender
/// gives to the latter.
pub(super) const ALBEDO_CHANNELS: [&str; 3] = ["albedo.R", "albedo.G", "albedo.B"];
pub(super) const NORMAL_CHANNELS: [&str; 3] = ["normal.X", "normal.Y", "normal.Z"];
pub(super) const SEEN_ALBEDO_CHANNELS: [&str; 3] = ["Denoising Albedo.R", "Denoising Albedo.G", "Denoising Albedo.B"];
pub(super) const SEEN_NORMAL_CHANNELS: [&str; 3] = ["Denoising Normal.X", "Denoising Normal.Y", "Denoising Normal.Z"];

/// Returns the channels of the AOVs, with the names of the OpenEXR conventions: normals in world space, `Z` in metres
/// along the view axis, `id` as unsigned integers, and the variance where it is known. What is seen has channels of its
/// own where mirrors or clear glass show it.
fn aov_channels<'a>(aovs: &'a AovPicture) -> Vec<ExrChannel<'a>> {
    let width = aovs.width as usize;
    let vectors =
        |names, values: &'a [[f32; 3]]| vector_channels(names, move |x: usize, y: usize| values[y * width + x]);
    let mut all = Vec::from(vectors(ALBEDO_CHANNELS, &aovs.albedo));
    all.extend(vectors(NORMAL_CHANNELS, &aovs.normal));
    if aovs.has_mirrors() {
        all.extend(vectors(SEEN_ALBEDO_CHANNELS, &aovs.seen_albedo));
        all.extend(vectors(SEEN_NORMAL_CHANNELS, &aovs.seen_normal));
    }
    all.push(AnyChannel::new("Z", ChannelSamples::f32(move |x, y| aovs.depth_m[y * width + x])));
    all.push(AnyChannel::new("id", ChannelSamples::u32(move |x, y| aovs.object_id[y * width + x])));
    if aovs.relative_variance.iter().any(|variance| variance.is_finite()) {
        let variance = ChannelSamples::f32(move |x, y| aovs.relative_variance[y * width + x]);
        all.push(AnyChannel::new(VARIANCE_CHANNEL, variance));
    }
    all
}

fn picture_channels<'a>(names: [&str; 3], picture: &'a Picture) -> [ExrChannel<'a>; 3] {
    vector_channels(names, |x, y| picture.rgb[y * picture.width as usize + x])
}

fn layer_channels<'a>(names: [&str; 3], layer: &'a LazyPicture<'a>) -> [ExrChannel<'a>; 3] {
    // A picture's edge is a number of 32 bits.
    let edge = |pixel: usize| u32::try_from(pixel).unwrap_or(u32::MAX);
    vector_channels(names, move |x, y| layer.at(edge(x), edge(y)))
}

/// Returns the three channels of pixels at (x, y).
pub(super) fn vector_channels<'a>(
    names: [&str; 3],
    pixel: impl Fn(usize, usize) -> [f32; 3] + Copy + Sync + 'a,
) -> [ExrChannel<'a>; 3] {
    let channel = |index: usize| AnyChannel::new(names[index], ChannelSamples::f32(move |x, y| pixel(x, y)[index]));
    [0, 1, 2].map(channel)
}

/// Returns the text of the rendered studio in UTF-8; [`NO_STUDIO`] for none and for one that is too long.
pub(super) fn studio_text(info: &PictureInfo) -> Text {
    let studio = info.studio.as_bytes();
    let is_fit = !studio.is_empty() && studio.len() <= LONGEST_STUDIO;
    Text::from_slice_unchecked(if is_fit { studio } else { NO_STUDIO })
}

/// Returns the names of the parts of layers. No two parts of a file may have one name, and names that differ in letters
/// that EXR does not have are equal there: later ones get a number.
fn part_names<'a>(layers: impl Iterator<Item = &'a str>) -> Vec<String> {
    let mut taken = vec![text(WHOLE)];
    let unique = |name: &str| {
        let stem: String = name.chars().take(LONGEST_STEM).collect();
        let numbered = (2..).map(|number| format!("{stem} {number}"));
        let mut names = std::iter::once(name.to_owned()).chain(numbered);
        let name = names.find(|name| !taken.contains(&text(name))).unwrap_or_default();
        taken.push(text(&name));
        name
    };
    layers.map(unique).collect()
}

/// Returns true if a part has the name of a layer, or that with a number.
pub(super) fn is_part_name(part: &str, layer: &str) -> bool {
    let stem: String = layer.chars().take(LONGEST_STEM).collect();
    let numbered = || {
        let number = part.strip_prefix(&text(&stem).to_string())?.strip_prefix(' ')?;
        number.parse::<u32>().ok()
    };
    text(part) == text(layer) || numbered().is_some()
}

/// Converts text to EXR's byte strings: at most 200 bytes, not empty, `_` for characters that are not printable ASCII.
pub(super) fn text(value: &str) -> Text {
    const LENGTH: usize = 200;
    let fitting =
        |c: char| u8::try_from(c).ok().filter(|byte| byte.is_ascii() && !byte.is_ascii_control()).unwrap_or(b'_');
    let bytes: Vec<u8> = value.chars().take(LENGTH).map(fitting).collect();
    Text::from_slice_unchecked(if bytes.is_empty() { b"_" } else { &bytes })
}

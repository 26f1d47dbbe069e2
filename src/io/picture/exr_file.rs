//! OpenEXR: 32-bit float, Rec.709 primaries, ZIP, one part for the picture and one a light.

use super::PictureInfo;
use crate::photo::Picture;
use exr::image::RgbChannels;
use exr::image::write::channels::GetPixel;
use exr::meta::attribute::AttributeValue;
use exr::prelude::{
    Encoding, Image, ImageAttributes, IntegerBounds, Layer, LayerAttributes, ReadChannels, ReadLayers,
    SpecificChannels, Text, Vec2, WritableImage,
};
use std::io::Cursor;

/// Name of the part with all light, beside the parts of single lights.
const WHOLE: &str = "picture";

pub(super) fn encode(picture: &Picture, layers: &[(String, Picture)], info: &PictureInfo) -> Result<Vec<u8>, String> {
    let parts = std::iter::once((WHOLE, picture)).chain(layers.iter().map(|(name, layer)| (name.as_str(), layer)));
    let parts: Vec<_> = parts.map(|(name, picture)| part(name, picture, info)).collect();
    let size = (picture.width as usize, picture.height as usize);
    let image = Image::from_layers(ImageAttributes::new(IntegerBounds::from_dimensions(size)), parts);
    let mut content = Cursor::new(Vec::new());
    image.write().to_buffered(&mut content).map_err(|error| error.to_string())?;
    Ok(content.into_inner())
}

/// The first picture of a file with red, green and blue.
pub(super) fn decode(content: &[u8]) -> Result<Picture, String> {
    let image = exr::prelude::read()
        .no_deep_data()
        .largest_resolution_level()
        .rgb_channels(
            |size, _| Picture::new(size.width() as u32, size.height() as u32),
            |picture: &mut Picture, at, (r, g, b): (f32, f32, f32)| {
                let index = at.y() * picture.width as usize + at.x();
                picture.rgb[index] = [r, g, b];
            },
        )
        .first_valid_layer()
        .all_attributes()
        .from_buffered(Cursor::new(content))
        .map_err(|error| error.to_string())?;
    Ok(image.layer_data.channel_data.pixels)
}

/// A picture as the exr crate asks for it.
struct Pixels<'a>(&'a Picture);

impl GetPixel for Pixels<'_> {
    type Pixel = (f32, f32, f32);

    fn get_pixel(&self, at: Vec2<usize>) -> Self::Pixel {
        let [r, g, b] = self.0.at(at.x() as u32, at.y() as u32);
        (r, g, b)
    }
}

type Part<'a> = Layer<SpecificChannels<Pixels<'a>, RgbChannels>>;

fn part<'a>(name: &str, picture: &'a Picture, info: &PictureInfo) -> Part<'a> {
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
    let size = (picture.width as usize, picture.height as usize);
    Layer::new(size, attributes, Encoding::SMALL_LOSSLESS, SpecificChannels::rgb(Pixels(picture)))
}

/// Text in EXR is bytes; what does not fit is replaced. It must not be empty and not be long.
fn text(value: &str) -> Text {
    const LENGTH: usize = 200;
    let fitting = |c: char| if c.is_ascii() && !c.is_ascii_control() { c as u8 } else { b'_' };
    let bytes: Vec<u8> = value.chars().take(LENGTH).map(fitting).collect();
    Text::from_slice_unchecked(if bytes.is_empty() { b"_" } else { &bytes })
}

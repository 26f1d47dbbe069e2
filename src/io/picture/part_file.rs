//! Files of parts of a picture's samples: EXR in 32 bits.
//!
//! The EXR part `picture` has R, G and B of these samples alone, for viewers, and the sums of their squared luminance;
//! each light has an EXR part with the sums of its samples. A sum is a fixed-point number of 128 bits
//! ([`ExactSum`]) in four unsigned channels, the lowest 32 bits first: `R.0` to `R.3`. Every pixel has the same number
//! of samples; the header says which, and of which render.

use super::PictureInfo;
use super::channel_samples::{ChannelSamples, ExrChannel, ExrPart};
use super::exr_file::{
    ALBEDO_CHANNELS, NORMAL_CHANNELS, SEEN_ALBEDO_CHANNELS, SEEN_NORMAL_CHANNELS, SHOWN_CHANNELS, STUDIO_FILE, WHOLE,
    checked_size, part, studio_text, text, vector_channels,
};
use super::exr_header::{Header, read_parts};
use super::picture_file::{Content, PictureFile};
use crate::io::checkpoint::RenderId;
use crate::io::error::{SaveError, reason};
use crate::raytrace::{ExactSum, FilmPart, NonFiniteReport, PartAovs, PartLayer, PixelSum};
use exr::meta::attribute::AttributeValue;
use exr::prelude::{
    AnyChannel, AnyChannels, Encoding, FlatSamples, Image, ImageAttributes, IntegerBounds, Layer, LayerAttributes,
    Layers,
};
use glam::Vec3;
use std::ops::Range;
use std::path::Path;

/// Some of the samples of a picture, and what they are samples of.
#[derive(Clone, Debug, PartialEq)]
pub struct PicturePart {
    /// The render of the whole picture.
    pub render: RenderId,
    /// Name of the studio.
    pub studio: String,
    /// Indices of the samples.
    pub samples: Range<u32>,
    /// Samples of the whole picture.
    pub of: u32,
    /// Settings for the merged picture's file.
    pub info: PictureInfo,
    /// The sums.
    pub sums: FilmPart,
}

const RENDER: &str = "catchlightRender";
const STUDIO: &str = "studio";
const FIRST: &str = "samplesFirst";
const END: &str = "samplesEnd";
const OF: &str = "samplesOfWhole";
const LAYER: &str = "layerName";
const WEIGHT: &str = "weight";

/// Encodes a part for its file.
///
/// # Errors
/// If the encoder fails.
pub fn encode_part<'a>(path: &Path, value: &'a PicturePart) -> Result<PictureFile<'a>, SaveError> {
    let encode = |message| SaveError::Encode { message, path: path.to_owned() };
    let whole =
        |samples: u32| i32::try_from(samples).map(AttributeValue::I32).map_err(|error| encode(error.to_string()));
    let sums = &value.sums;
    let (width, size) = (sums.width as usize, (sums.width as usize, sums.height as usize));
    let mut channels = Vec::from(vector_channels(SHOWN_CHANNELS, move |x, y| sums.develop_pixel(y * width + x)));
    channels.extend(sum_channels("luminance2", width, &sums.squares, |square| *square));
    channels.extend(sums.aovs.iter().flat_map(|aovs| aov_channels(aovs, width)));
    let mut picture = part(WHOLE, size, channels, &value.info);
    picture.attributes.other.extend([
        (text(RENDER), AttributeValue::Text(text(&value.render.to_string()))),
        (text(STUDIO), AttributeValue::Text(text(&value.studio))),
        (text(STUDIO_FILE), AttributeValue::Text(studio_text(&value.info))),
        (text(FIRST), whole(value.samples.start)?),
        (text(END), whole(value.samples.end)?),
        (text(OF), whole(value.of)?),
    ]);
    let layers = sums.layers.iter().enumerate().map(|(index, layer)| layer_part(index, layer, size));
    let parts = std::iter::once(picture).chain(layers).collect::<Layers<_>>();
    let image = Image::from_layers(ImageAttributes::new(IntegerBounds::from_dimensions(size)), parts);
    Ok(PictureFile::new(path, Content::Exr(Box::new(image))))
}

fn layer_part(index: usize, layer: &PartLayer, size: (usize, usize)) -> ExrPart<'_> {
    let mut attributes = LayerAttributes::named(text(&format!("sums {index}")));
    let weight = layer.weight;
    attributes.other.extend([
        (text(LAYER), AttributeValue::Text(text(&layer.name))),
        (text(WEIGHT), AttributeValue::FloatVec3((weight.x, weight.y, weight.z))),
    ]);
    let channels = pixel_sum_channels(SHOWN_CHANNELS, size.0, &layer.sums);
    Layer::new(size, attributes, Encoding::SMALL_LOSSLESS, AnyChannels::sort(channels.collect()))
}

fn aov_channels(aovs: &PartAovs, width: usize) -> Vec<ExrChannel<'_>> {
    let mut all: Vec<_> = pixel_sum_channels(ALBEDO_CHANNELS, width, &aovs.albedo).collect();
    all.extend(pixel_sum_channels(NORMAL_CHANNELS, width, &aovs.normal));
    if aovs.has_mirrors() {
        all.extend(pixel_sum_channels(SEEN_ALBEDO_CHANNELS, width, &aovs.seen_albedo));
        all.extend(pixel_sum_channels(SEEN_NORMAL_CHANNELS, width, &aovs.seen_normal));
    }
    all.push(AnyChannel::new("Z", ChannelSamples::f32(move |x, y| aovs.depth_m[y * width + x])));
    all.push(AnyChannel::new("id", ChannelSamples::u32(move |x, y| aovs.object_id[y * width + x])));
    all
}

fn pixel_sum_channels<'a>(
    names: [&'a str; 3],
    width: usize,
    sums: &'a [PixelSum],
) -> impl Iterator<Item = ExrChannel<'a>> {
    (0..3).flat_map(move |component| sum_channels(names[component], width, sums, move |sum| sum[component]))
}

/// Returns the four words of each sum as channels.
fn sum_channels<'a, T: Sync>(
    name: &str,
    width: usize,
    sums: &'a [T],
    sum: impl Fn(&T) -> ExactSum + Copy + Sync + 'a,
) -> [ExrChannel<'a>; 4] {
    [0, 1, 2, 3].map(|word| {
        let samples = ChannelSamples::u32(move |x, y| sum(&sums[y * width + x]).words()[word]);
        AnyChannel::new(word_name(name, word).as_str(), samples)
    })
}

fn word_name(name: &str, word: usize) -> String {
    format!("{name}.{word}")
}

/// Reads a part.
///
/// # Errors
/// If the file can't be read, or is none of a part.
pub fn read_part(path: &Path) -> Result<PicturePart, String> {
    let content = std::fs::read(path).map_err(|error| reason(&error))?;
    decode(&content)
}

fn decode(content: &[u8]) -> Result<PicturePart, String> {
    let parts = read_parts(content)?;
    let (picture, layers) = parts.split_first().ok_or("it is empty")?;
    let whole = Header(picture);
    let render = whole.text(RENDER).ok_or("it is no part of a picture (render --samples writes them)")?;
    let render = RenderId::parse(&render).ok_or("the render that it is a part of has no number")?;
    let (width, height) = checked_size(picture.size)?;
    let samples = whole.samples(FIRST)?..whole.samples(END)?;
    let of = whole.samples(OF)?;
    if samples.is_empty() || samples.end > of {
        return Err(format!("it has the samples {}..{} of {of}", samples.start, samples.end));
    }
    let sums = FilmPart {
        width,
        height,
        samples: samples.end - samples.start,
        layers: layers.iter().map(|layer| Header(layer).layer(picture.size)).collect::<Result<_, _>>()?,
        squares: whole.sums("luminance2")?,
        aovs: if whole.channel("Z").is_some() { Some(whole.aovs()?) } else { None },
        nonfinite: NonFiniteReport::default(),
    };
    Ok(PicturePart { render, studio: whole.text(STUDIO).unwrap_or_default(), samples, of, info: whole.info()?, sums })
}

impl Header<'_> {
    fn layer(&self, size: exr::math::Vec2<usize>) -> Result<PartLayer, String> {
        if self.0.size != size {
            return Err("its layers differ in size".to_owned());
        }
        let weight = match self.attribute(WEIGHT) {
            Some(AttributeValue::FloatVec3((x, y, z))) => Vec3::new(*x, *y, *z),
            _ => return Err("a layer has no weight".to_owned()),
        };
        let name = self.text(LAYER).ok_or("a layer has no name")?;
        Ok(PartLayer { name, weight, sums: self.vector_sums(["R", "G", "B"])? })
    }

    fn aovs(&self) -> Result<PartAovs, String> {
        let (depth_m, object_id) = match (self.channel("Z"), self.channel("id")) {
            (Some(FlatSamples::F32(depth)), Some(FlatSamples::U32(id))) => (depth.clone(), id.clone()),
            _ => return Err("depth or object is missing".to_owned()),
        };
        let (albedo, normal) = (self.vector_sums(ALBEDO_CHANNELS)?, self.vector_sums(NORMAL_CHANNELS)?);
        let (seen_albedo, seen_normal) = if self.channel(&word_name(SEEN_ALBEDO_CHANNELS[0], 0)).is_some() {
            (self.vector_sums(SEEN_ALBEDO_CHANNELS)?, self.vector_sums(SEEN_NORMAL_CHANNELS)?)
        } else {
            (albedo.clone(), normal.clone())
        };
        Ok(PartAovs { albedo, normal, seen_albedo, seen_normal, depth_m, object_id })
    }

    fn vector_sums(&self, names: [&str; 3]) -> Result<Vec<PixelSum>, String> {
        let [x, y, z] = [self.sums(names[0])?, self.sums(names[1])?, self.sums(names[2])?];
        Ok(x.into_iter().zip(y).zip(z).map(|((x, y), z)| [x, y, z]).collect())
    }

    fn sums(&self, name: &str) -> Result<Vec<ExactSum>, String> {
        let words = |word| match self.channel(&word_name(name, word)) {
            Some(FlatSamples::U32(words)) => Ok(words.as_slice()),
            _ => Err(format!("the sums {name} are missing")),
        };
        let words = [words(0)?, words(1)?, words(2)?, words(3)?];
        Ok((0..words[0].len()).map(|pixel| ExactSum::from_words(words.map(|word| word[pixel]))).collect())
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::io::{LayeredPicture, presets};
    use crate::raytrace::{RenderControl, Settings, prepare, render_part};

    fn some_part(aovs: bool) -> PicturePart {
        let loaded = presets()[0].load().unwrap();
        let prepared = prepare(&loaded.scene, &loaded.assets).unwrap();
        let settings = Settings { width: 37, height: 21, spp: 9, aovs, ..Settings::default() };
        let sums = render_part(&prepared, &loaded.scene, &settings, 0..2, &RenderControl::new(), &mut |_| {});
        PicturePart {
            render: RenderId::new(&loaded.scene, &loaded.assets, "test"),
            studio: loaded.scene.title(),
            samples: 0..2,
            of: 9,
            info: PictureInfo::new(&loaded.scene, "path", 2, u64::from(u32::MAX)),
            sums,
        }
    }

    #[test]
    fn a_part_keeps_every_bit_in_its_file_and_viewers_find_a_picture() {
        for aovs in [false, true] {
            let part = some_part(aovs);
            let encoded = encode_part(Path::new("part.exr"), &part).unwrap();
            let read = decode(&encoded.bytes()).unwrap();
            assert!(read == part, "{:?} {:?}", read.info, part.info);
            let shown = crate::io::picture::exr_file::decode(&encoded.bytes()).unwrap();
            assert_eq!(shown, part.sums.develop());
        }
    }

    #[test]
    fn files_that_are_no_parts_and_damaged_parts_are_errors() {
        let part = some_part(true);
        let encoded = encode_part(Path::new("part.exr"), &part).unwrap();
        let content = encoded.bytes();
        for length in (0..content.len()).step_by(content.len() / 60) {
            assert!(decode(&content[..length]).is_err(), "{length}");
        }
        let picture = part.sums.develop();
        let alone = LayeredPicture::alone(&picture);
        let picture = crate::io::picture_file(Path::new("a.exr"), alone, None, None, &part.info).unwrap();
        assert!(decode(&picture.bytes()).unwrap_err().contains("no part of a picture"));
        // Bytes of the header, one after the other: an error or a part, and no panic
        for at in 0..1500 {
            let mut damaged = content.clone();
            damaged[at] ^= 0x41;
            let _ = decode(&damaged);
        }
    }
}

//! The parts of an EXR file as they were read, and the settings in their headers.

use super::exr_file::{NO_STUDIO, STUDIO_FILE, checked_size, text};
use super::{CaptureInfo, PictureInfo};
use exr::meta::MetaData;
use exr::meta::attribute::AttributeValue;
use exr::prelude::{AnyChannels, FlatSamples, Layer, ReadChannels, ReadLayers};
use std::io::Cursor;

/// A part with all its channels.
pub(super) type ReadExrPart = Layer<AnyChannels<FlatSamples>>;

/// Reads all parts of a file.
///
/// # Errors
/// If it is damaged, no EXR file, or too large.
pub(super) fn read_parts(content: &[u8]) -> Result<Vec<ReadExrPart>, String> {
    // Check the sizes before memory is allocated for any of them
    let meta = MetaData::read_from_buffered(Cursor::new(content), false).map_err(|error| error.to_string())?;
    meta.headers.iter().try_for_each(|header| checked_size(header.layer_size).map(|_| ()))?;
    let image = exr::prelude::read()
        .no_deep_data()
        .largest_resolution_level()
        .all_channels()
        .all_layers()
        .all_attributes()
        .from_buffered(Cursor::new(content))
        .map_err(|error| error.to_string())?;
    Ok(image.layer_data.into_iter().collect())
}

/// Returns true if the first part of a picture holds the studio that was rendered.
pub(super) fn holds_studio(header: &exr::meta::header::Header) -> bool {
    let studio = header.own_attributes.other.get(&text(STUDIO_FILE));
    matches!(studio, Some(AttributeValue::Text(studio)) if studio.as_slice() != NO_STUDIO)
}

/// A part of an EXR file as it was read.
pub(super) struct Header<'a>(pub &'a ReadExrPart);

impl Header<'_> {
    /// Returns an attribute.
    pub fn attribute(&self, name: &str) -> Option<&AttributeValue> {
        self.0.attributes.other.get(&text(name))
    }

    /// Returns an attribute that is a text.
    pub fn text(&self, name: &str) -> Option<String> {
        match self.attribute(name)? {
            AttributeValue::Text(text) => Some(text.to_string()),
            _ => None,
        }
    }

    /// Returns a number of samples.
    ///
    /// # Errors
    /// If the attribute is missing.
    pub fn samples(&self, name: &str) -> Result<u32, String> {
        let missing = || format!("{name} is missing");
        match self.attribute(name) {
            Some(AttributeValue::I32(samples)) => u32::try_from(*samples).map_err(|_| missing()),
            _ => Err(missing()),
        }
    }

    /// Returns the settings of the render.
    ///
    /// # Errors
    /// If one is missing.
    pub fn info(&self) -> Result<PictureInfo, String> {
        let scale = match self.attribute("exposureScale_cd_s_m2_per_unit") {
            Some(AttributeValue::F32(scale)) => *scale,
            _ => return Err("the exposure scale is missing".to_owned()),
        };
        let seed = self.text("seed").and_then(|seed| seed.parse().ok()).ok_or("the seed is missing")?;
        let method = self.text("method").ok_or("the method is missing")?;
        let (spp, capture) = (self.samples("spp")?, CaptureInfo::read_attributes(&self.0.attributes, text));
        let studio = self.studio().unwrap_or_default();
        Ok(PictureInfo { cd_s_m2_per_unit: scale, spp, seed, method, denoiser: None, capture, studio })
    }

    /// Returns the text of the studio that was rendered.
    pub fn studio(&self) -> Option<String> {
        match self.attribute(STUDIO_FILE)? {
            AttributeValue::Text(studio) if studio.as_slice() != NO_STUDIO => {
                String::from_utf8(studio.as_slice().to_vec()).ok()
            }
            _ => None,
        }
    }

    /// Returns the samples of a channel.
    pub fn channel(&self, name: &str) -> Option<&FlatSamples> {
        self.0.channel_data.list.iter().find(|channel| channel.name.eq(name)).map(|channel| &channel.sample_data)
    }
}

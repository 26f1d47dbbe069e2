//! Metadata of pictures: the exposure as a camera writes it, and the colour space. EXIF and an sRGB profile in PNG and
//! JPEG, the profile in TIFF, the standard attributes of OpenEXR in EXR.

use super::icc::srgb_profile;
use crate::photo::thirds::Dial;
use crate::scene::{Camera, Scene};
use exif::experimental::Writer;
use exif::{Field, In, Rational, Tag, Value};
use exr::meta::attribute::{AttributeValue, Text};
use exr::prelude::LayerAttributes;
use image::ImageEncoder;
use std::io::Cursor;

/// OpenEXR's name of the focal length.
const FOCAL_LENGTH: &str = "nominalFocalLength";
/// Our name of the focal length of the same field on full frame.
const FULL_FRAME: &str = "focalLengthOnFullFrame";

/// The settings of the camera that took a picture, with the values that are printed on its dials.
#[derive(Clone, Debug, PartialEq, Default)]
pub struct CaptureInfo {
    /// Name of the studio.
    pub studio: String,
    /// Aperture, f-number.
    pub f_number: f32,
    /// Exposure time, seconds.
    pub shutter_s: f32,
    /// ISO speed.
    pub iso: f32,
    /// Focal length, millimetres.
    pub focal_length_mm: f32,
    /// Focal length of the same field of view on full frame, millimetres.
    pub full_frame_mm: f32,
}

impl CaptureInfo {
    /// Returns the settings of a scene's camera.
    pub fn new(scene: &Scene) -> Self {
        let Camera { f_number, shutter_s, iso, focal_length_mm, sensor, .. } = scene.camera;
        CaptureInfo {
            studio: scene.title(),
            f_number: Dial::FNumber.printed(f_number),
            shutter_s: Dial::Shutter.printed(shutter_s),
            iso: Dial::Iso.printed(iso),
            focal_length_mm,
            full_frame_mm: focal_length_mm * sensor.crop_factor(),
        }
    }

    /// Writes the settings as attributes of a part of an EXR file.
    pub(super) fn write_attributes(&self, attributes: &mut LayerAttributes, text: fn(&str) -> Text) {
        attributes.comments = Some(text(&self.studio));
        attributes.aperture = Some(self.f_number);
        attributes.exposure = Some(self.shutter_s);
        attributes.iso_speed = Some(self.iso);
        let lengths = [(FOCAL_LENGTH, self.focal_length_mm), (FULL_FRAME, self.full_frame_mm)];
        attributes.other.extend(lengths.map(|(name, length)| (text(name), AttributeValue::F32(length))));
    }

    /// Reads the settings from the attributes of a part of an EXR file. Missing settings are 0.
    pub(super) fn read_attributes(attributes: &LayerAttributes, text: fn(&str) -> Text) -> Self {
        let length = |name| match attributes.other.get(&text(name)) {
            Some(AttributeValue::F32(length)) => *length,
            _ => 0.0,
        };
        CaptureInfo {
            studio: attributes.comments.as_ref().map(ToString::to_string).unwrap_or_default(),
            f_number: attributes.aperture.unwrap_or(0.0),
            shutter_s: attributes.exposure.unwrap_or(0.0),
            iso: attributes.iso_speed.unwrap_or(0.0),
            focal_length_mm: length(FOCAL_LENGTH),
            full_frame_mm: length(FULL_FRAME),
        }
    }

    /// Returns the settings as EXIF.
    ///
    /// # Errors
    /// If the encoder fails.
    fn exif(&self) -> Result<Vec<u8>, String> {
        let fraction = |value: f32, parts: f32| {
            // At most 4 billion parts, as EXIF has it
            Value::Rational(vec![Rational { num: whole(value * parts), denom: whole(parts) }])
        };
        let time = match self.shutter_s {
            short if short > 0.0 && short < 0.3 => {
                Value::Rational(vec![Rational { num: 1, denom: whole(1.0 / short) }])
            }
            long => fraction(long, 10.0),
        };
        let short = |value: f32| Value::Short(vec![u16::try_from(whole(value)).unwrap_or(u16::MAX)]);
        let ascii = |text: &str| Value::Ascii(vec![text.bytes().filter(|byte| *byte != 0).collect()]);
        const SRGB: u16 = 1;
        let fields = [
            (Tag::ImageDescription, ascii(&self.studio)),
            (Tag::Software, ascii(concat!("Catchlight ", env!("CARGO_PKG_VERSION")))),
            (Tag::ExifVersion, Value::Undefined(b"0232".to_vec(), 0)),
            (Tag::ExposureTime, time),
            (Tag::FNumber, fraction(self.f_number, 10.0)),
            (Tag::PhotographicSensitivity, short(self.iso)),
            (Tag::FocalLength, fraction(self.focal_length_mm, 10.0)),
            (Tag::FocalLengthIn35mmFilm, short(self.full_frame_mm)),
            (Tag::ColorSpace, Value::Short(vec![SRGB])),
        ];
        let known = fields.into_iter().filter(|(_, value)| !is_missing(value));
        let fields: Vec<Field> = known.map(|(tag, value)| Field { tag, ifd_num: In::PRIMARY, value }).collect();
        let mut writer = Writer::new();
        fields.iter().for_each(|field| writer.push_field(field));
        let mut bytes = Cursor::new(Vec::new());
        writer.write(&mut bytes, true).map_err(|error| error.to_string())?;
        Ok(bytes.into_inner())
    }
}

/// Returns true for an empty text and for the number 0: settings that are not known.
fn is_missing(value: &Value) -> bool {
    match value {
        Value::Ascii(lines) => lines.iter().all(Vec::is_empty),
        Value::Rational(numbers) => numbers.iter().all(|number| number.num == 0),
        Value::Short(numbers) => numbers.iter().all(|number| *number == 0),
        _ => false,
    }
}

/// Rounds to a whole number that EXIF can hold.
fn whole(value: f32) -> u32 {
    // A cast saturates, and 0 stands for what is no number.
    #[allow(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "saturation is meant")]
    let rounded = value.round() as u32;
    rounded
}

/// Describes to an encoder what it will write: its colour space, and the settings of the camera, if they are
/// known.
///
/// # Errors
/// If the metadata can't be encoded.
pub(super) fn describe(encoder: &mut impl ImageEncoder, capture: Option<&CaptureInfo>) -> Result<(), String> {
    encoder.set_icc_profile(srgb_profile()).map_err(|error| error.to_string())?;
    match capture {
        Some(capture) => encoder.set_exif_metadata(capture.exif()?).map_err(|error| error.to_string()),
        None => Ok(()),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scene::Sensor;

    #[test]
    fn settings_are_those_on_the_dials_of_a_camera() {
        let mut scene = Scene { name: "R\u{e9}mi".to_owned(), ..Scene::default() };
        (scene.camera.f_number, scene.camera.shutter_s, scene.camera.iso) = (5.657, 1.0 / 128.0, 400.0);
        scene.camera.sensor = Sensor::MicroFourThirds;
        let info = CaptureInfo::new(&scene);
        assert_eq!((info.f_number, info.shutter_s, info.iso), (5.6, 1.0 / 125.0, 400.0));
        assert_eq!((info.focal_length_mm, info.full_frame_mm.round()), (85.0, 170.0));
        let read = exif::Reader::new().read_raw(info.exif().unwrap()).unwrap();
        let text = |tag| read.get_field(tag, In::PRIMARY).unwrap().display_value().to_string();
        assert_eq!([Tag::ExposureTime, Tag::FNumber, Tag::FocalLength].map(text), ["1/125", "5.6", "85"]);
        assert_eq!([Tag::PhotographicSensitivity, Tag::FocalLengthIn35mmFilm].map(text), ["400", "170"]);
        scene.camera.shutter_s = 2.0;
        let read = exif::Reader::new().read_raw(CaptureInfo::new(&scene).exif().unwrap()).unwrap();
        assert_eq!(read.get_field(Tag::ExposureTime, In::PRIMARY).unwrap().display_value().to_string(), "2");
        let read = exif::Reader::new().read_raw(CaptureInfo::default().exif().unwrap()).unwrap();
        assert!(
            read.get_field(Tag::FNumber, In::PRIMARY).is_none() && read.get_field(Tag::Software, In::PRIMARY).is_some()
        );
    }
}

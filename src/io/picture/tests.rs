use super::*;
use exr::meta::attribute::{AttributeValue, Text};
use exr::prelude::{ReadChannels, ReadLayers, read};

/// Returns a ramp to above white, which the tone curve changes.
fn ramp(width: u32, height: u32, gain: f32) -> Picture {
    let rgb = (0..width * height).map(|i| [gain * i as f32 / 10.0, 0.18, 1e-3 * i as f32]).collect();
    Picture { width, height, rgb }
}

fn info() -> PictureInfo {
    PictureInfo::new(&Scene::default(), "path", 64, u64::MAX)
}

#[test]
fn png_holds_the_tone_mapped_picture() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("a.PNG");
    let picture = ramp(7, 5, 1.0);
    export_picture(&path, &picture, &info()).unwrap();
    let read = image::load_from_memory(&std::fs::read(&path).unwrap()).unwrap().into_rgb8();
    assert_eq!(read.dimensions(), (7, 5));
    assert_eq!(read.pixels().map(|p| p.0).collect::<Vec<_>>(), picture.to_srgb8());
}

#[test]
fn tiff_holds_the_tone_mapped_picture_in_16_bits_with_the_profile() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("a.tif");
    let picture = ramp(7, 5, 1.0);
    export_picture(&path, &picture, &info()).unwrap();
    let bytes = std::fs::read(&path).unwrap();
    let read = image::load_from_memory(&bytes).unwrap();
    assert_eq!(read.color(), image::ColorType::Rgb16);
    assert_eq!(read.into_rgb16().pixels().map(|p| p.0).collect::<Vec<_>>(), picture.to_srgb16());
    for (fine, coarse) in picture.to_srgb16().iter().flatten().zip(picture.to_srgb8().iter().flatten()) {
        assert!((f32::from(*fine) / 257.0 - f32::from(*coarse)).abs() < 1.0);
    }
    assert!(bytes.windows(4).any(|bytes| bytes == b"acsp"), "the signature of a profile");
}

#[test]
fn png_and_jpeg_hold_the_exposure_the_studio_and_the_srgb_profile() {
    use exif::{In, Tag};
    use image::ImageDecoder;
    let folder = tempfile::tempdir().unwrap();
    let mut info = info();
    info.capture.studio = "Two lights".to_owned();
    for name in ["a.png", "a.jpg"] {
        let path = folder.path().join(name);
        export_picture(&path, &ramp(7, 5, 1.0), &info).unwrap();
        let bytes = std::fs::read(&path).unwrap();
        let read = exif::Reader::new().read_from_container(&mut Cursor::new(&bytes)).unwrap();
        let text = |tag| read.get_field(tag, In::PRIMARY).unwrap().display_value().with_unit(&read).to_string();
        assert_eq!(
            [Tag::FNumber, Tag::ExposureTime, Tag::FocalLength].map(text),
            ["f/5.6", "1/125 s", "85 mm"],
            "{name}"
        );
        assert_eq!(text(Tag::ImageDescription), "\"Two lights\"");
        let reader = image::ImageReader::new(Cursor::new(&bytes)).with_guessed_format().unwrap();
        let profile = reader.into_decoder().unwrap().icc_profile().unwrap().unwrap();
        let profile = moxcms::ColorProfile::new_from_slice(&profile).unwrap();
        assert_eq!(profile.rendering_intent, moxcms::ColorProfile::new_srgb().rendering_intent);
        assert!((profile.red_colorant.x - moxcms::ColorProfile::new_srgb().red_colorant.x).abs() < 1e-3);
    }
}

#[test]
fn jpeg_is_close_to_the_tone_mapped_picture() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("a.jpeg");
    let picture = Picture { width: 16, height: 16, rgb: vec![[0.18, 0.4, 0.1]; 256] };
    export_picture(&path, &picture, &info()).unwrap();
    let read = image::load_from_memory(&std::fs::read(&path).unwrap()).unwrap().into_rgb8();
    for (ours, theirs) in read.get_pixel(8, 8).0.iter().zip(picture.to_srgb8()[0]) {
        assert!(ours.abs_diff(theirs) <= 2, "quality 95 keeps an even colour within two steps");
    }
}

#[test]
fn exr_keeps_every_bit_the_layers_and_the_attributes() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("a.exr");
    let layers = [("Key".to_owned(), ramp(19, 33, 0.25)), ("Füll 灯".to_owned(), ramp(19, 33, 0.75))];
    let whole = ramp(19, 33, 1.0);
    let lazy = layers.each_ref().map(|(name, layer)| (name.clone(), LazyPicture::from(layer)));
    let picture = LayeredPicture { picture: &whole, layers: &lazy };
    picture_file(&path, picture, None, None, &info()).unwrap().write().unwrap();
    let image =
        read().no_deep_data().largest_resolution_level().all_channels().all_layers().all_attributes().from_file(&path);
    let image = image.unwrap();
    let expected = [("picture", &whole), ("Key", &layers[0].1), ("F_ll _", &layers[1].1)];
    assert_eq!(image.layer_data.len(), 3);
    for (layer, (name, picture)) in image.layer_data.iter().zip(expected) {
        assert_eq!(layer.attributes.layer_name, Text::new_or_none(name));
        // Channels are stored in the order of their names.
        for (channel, component) in layer.channel_data.list.iter().zip([2, 1, 0]) {
            let values: Vec<f32> = channel.sample_data.values_as_f32().collect();
            assert_eq!(values, picture.rgb.iter().map(|c| c[component]).collect::<Vec<_>>(), "{name} {}", channel.name);
        }
        let other = |name| layer.attributes.other.get(&Text::new_or_none(name).unwrap()).cloned();
        let attributes = &layer.attributes;
        assert_eq!((attributes.aperture, attributes.iso_speed), (Some(5.6), Some(100.0)));
        assert_eq!((attributes.exposure, other("nominalFocalLength")), (Some(0.008), Some(AttributeValue::F32(85.0))));
        assert_eq!(other("spp"), Some(AttributeValue::I32(64)));
        assert_eq!(other("seed"), Some(AttributeValue::Text(Text::new_or_none(u64::MAX.to_string()).unwrap())));
        assert_eq!(other("method"), Some(AttributeValue::Text(Text::new_or_none("path").unwrap())));
        // pi S / (C N^2) with f/5.6, ISO 100 and C = 250.
        let Some(AttributeValue::F32(scale)) = other("exposureScale_cd_s_m2_per_unit") else { panic!("no scale") };
        assert!((scale * std::f32::consts::PI * 100.0 / (250.0 * 5.6 * 5.6) - 1.0).abs() < 1e-6);
    }
}

#[test]
fn one_pixel_and_odd_sizes_are_written() {
    let folder = tempfile::tempdir().unwrap();
    for name in ["a.png", "a.jpg", "a.exr"] {
        for (width, height) in [(1, 1), (1, 17), (31, 1)] {
            export_picture(&folder.path().join(name), &ramp(width, height, 1.0), &info()).unwrap();
        }
    }
}

#[test]
fn refused_pictures_leave_no_file() {
    let folder = tempfile::tempdir().unwrap();
    let picture = ramp(2, 2, 1.0);
    let refused = |name: &str, picture: &Picture| {
        export_picture(&folder.path().join(name), picture, &info()).unwrap_err().to_string()
    };
    assert!(
        refused("a.webp", &picture).starts_with("a picture's name ends in .png, .jpg, .tif or .exr, not in \"webp\"")
    );
    assert!(refused("a", &picture).contains(".png, .jpg, .tif or .exr"));
    assert!(refused("none/a.png", &picture).starts_with("there is no such folder"));
    assert!(refused("a.png", &Picture::default()).contains("no picture of 0 x 0"));
    let layers = [("Key".to_owned(), LazyPicture::from(ramp(3, 2, 1.0)))];
    let layered = LayeredPicture { picture: &picture, layers: &layers };
    assert!(picture_file(&folder.path().join("a.exr"), layered, None, None, &info()).is_err());
    assert_eq!(std::fs::read_dir(folder.path()).unwrap().count(), 0);
}

#[test]
fn the_exr_of_a_denoised_picture_keeps_the_noisy_pixels_of_picture_and_layers() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("a.exr");
    let layers = |gain| [("Key".to_owned(), LazyPicture::from(ramp(7, 5, gain)))];
    let (denoised_layers, noisy_layers) = (layers(1.0), layers(2.0));
    let denoised = LayeredPicture { picture: &ramp(7, 5, 3.0), layers: &denoised_layers };
    let noisy = LayeredPicture { picture: &ramp(7, 5, 4.0), layers: &noisy_layers };
    let info = PictureInfo { denoiser: Some("a network"), ..info() };
    picture_file(&path, denoised, Some(noisy), None, &info).unwrap().write().unwrap();
    assert_eq!(read_exr(&path).as_ref(), Ok(denoised.picture), "R, G and B are denoised");
    let image =
        read().no_deep_data().largest_resolution_level().all_channels().all_layers().all_attributes().from_file(&path);
    for (part, (clean, noisy)) in
        image.unwrap().layer_data.iter().zip([(ramp(7, 5, 3.0), ramp(7, 5, 4.0)), (ramp(7, 5, 1.0), ramp(7, 5, 2.0))])
    {
        let red = |name: &str| -> Vec<f32> {
            let channel = part.channel_data.list.iter().find(|channel| channel.name == *name).unwrap();
            channel.sample_data.values_as_f32().collect()
        };
        let expected = |picture: &Picture| picture.rgb.iter().map(|rgb| rgb[0]).collect::<Vec<_>>();
        assert_eq!([red("R"), red("noisy.R")], [expected(&clean), expected(&noisy)]);
        let denoiser = part.attributes.other.get(&Text::new_or_none("denoiser").unwrap());
        assert_eq!(denoiser, Some(&AttributeValue::Text(Text::new_or_none("a network").unwrap())));
    }
    let fewer = LayeredPicture { layers: &[], ..noisy };
    assert!(picture_file(&path, denoised, Some(fewer), None, &info).is_err());
    let smaller = LayeredPicture { picture: &ramp(6, 5, 4.0), ..noisy };
    assert!(picture_file(&path, denoised, Some(smaller), None, &info).is_err());
}

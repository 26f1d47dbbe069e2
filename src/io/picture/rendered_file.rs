//! Rendered pictures that are read back from EXR files, with their lights and the studio.

use super::PictureInfo;
use super::exr_file::{
    ALBEDO_CHANNELS, NOISY_CHANNELS, NORMAL_CHANNELS, SEEN_ALBEDO_CHANNELS, SEEN_NORMAL_CHANNELS, SHOWN_CHANNELS,
    VARIANCE_CHANNEL, checked_size, is_part_name, text,
};
use super::exr_header::{Header, ReadExrPart, read_parts};
use crate::io::error::{Problem, reason};
use crate::io::kept_picture::KeptPicture;
use crate::io::scene_file::parse_scene;
use crate::photo::{AovPicture, Picture};
use crate::raytrace::{Approximations, Film, Layer, Method, Settings};
use crate::scene::{Finding, Light, Role, Scene};
use exr::prelude::FlatSamples;
use std::path::Path;
use std::sync::Arc;

/// A rendered picture with its studio.
#[derive(Debug)]
pub struct RenderedPicture {
    /// The studio as it was rendered, with the picture.
    pub picture: KeptPicture,
    /// What is odd about the studio.
    pub findings: Vec<Finding>,
}

/// Reads a rendered picture with the layers of its lights, so that they can be mixed, and the studio that it shows.
///
/// # Errors
/// If the file can't be read, or is no EXR picture of Catchlight with its studio.
pub fn read_rendered(path: &Path) -> Result<RenderedPicture, String> {
    let content = std::fs::read(path).map_err(|error| reason(&error))?;
    decode(&content)
}

fn decode(content: &[u8]) -> Result<RenderedPicture, String> {
    let parts = read_parts(content)?;
    let (whole, lights) = parts.split_first().ok_or("it is empty")?;
    let studio =
        Header(whole).studio().ok_or("there is no studio in it: Catchlight writes one into its EXR pictures")?;
    let (scene, findings) =
        parse_scene(&studio).map_err(|error| error.problems().first().map_or(error.to_string(), Problem::to_string))?;
    let info = Header(whole).info()?;
    let aovs = aovs(whole)?;
    let settings = settings(whole, &info, aovs.is_some())?;
    let (mut layers, mut unused) = (Vec::new(), scene.lights.iter().collect());
    for part in lights {
        let name = part.attributes.layer_name.as_ref().map(ToString::to_string).unwrap_or_default();
        // A light that was off has a black layer
        if let Some(layer) = layer_of(&scene, &mut unused, &name) {
            layers.push((layer, picture(part, &settings)?));
        }
    }
    if layers.is_empty() {
        layers.push((Layer::shared("Picture"), picture(whole, &settings)?));
    }
    let approximations = Approximations::named_in(&info.method);
    let film = Arc::new(Film::from_layers(&settings, approximations, &scene, &layers, aovs.as_ref()));
    let picture = KeptPicture { film, scene: Arc::new(scene), settings, is_complete: true };
    Ok(RenderedPicture { picture, findings })
}

fn settings(whole: &ReadExrPart, info: &PictureInfo, aovs: bool) -> Result<Settings, String> {
    let (width, height) = checked_size(whole.size)?;
    let method = match info.method.split(',').next().unwrap_or_default() {
        "whitted" => Method::Whitted,
        "direct" => Method::Direct,
        _ => Method::Path,
    };
    let (spp, seed) = (info.spp.max(1), u32::try_from(info.seed).unwrap_or_default());
    Ok(Settings { width, height, method, spp, seed, aovs, ..Settings::default() })
}

/// Returns the layer of a part by its name: that of a light, or of the lights of a role that share one, as far as they
/// are on. None for a light that is off. `unused` has the lights without a part so far: parts whose names differ by a
/// number alone are in the lights' order.
fn layer_of(scene: &Scene, unused: &mut Vec<&Light>, name: &str) -> Option<Layer> {
    let exact = unused.iter().position(|light| text(&light.name) == text(name));
    if let Some(index) = exact.or_else(|| unused.iter().position(|light| is_part_name(name, &light.name))) {
        let light = unused.remove(index);
        return light.on.then(|| Layer::of_light(light));
    }
    let role = Role::ALL.into_iter().find(|role| Layer::name_of_role(*role) == name);
    Some(role.map_or_else(|| Layer::shared(name), |role| Layer::of_role(role, scene)))
}

/// Returns the pixels of a part before the denoiser, those that are shown if there are no others.
fn picture(part: &ReadExrPart, settings: &Settings) -> Result<Picture, String> {
    let Settings { width, height, .. } = *settings;
    if checked_size(part.size)? != (width, height) {
        return Err("its layers differ in size".to_owned());
    }
    let rgb = vectors(part, NOISY_CHANNELS).or_else(|| vectors(part, SHOWN_CHANNELS));
    let rgb = rgb.ok_or("a layer has no red, green and blue")?;
    let finite = |rgb: [f32; 3]| rgb.map(|value| if value.is_finite() { value } else { 0.0 });
    Ok(Picture { width, height, rgb: rgb.into_iter().map(finite).collect() })
}

/// Returns the AOVs, if there are any.
fn aovs(part: &ReadExrPart) -> Result<Option<AovPicture>, String> {
    let (width, height) = checked_size(part.size)?;
    let header = Header(part);
    let (Some(FlatSamples::F32(depth_m)), Some(FlatSamples::U32(object_id))) =
        (header.channel("Z"), header.channel("id"))
    else {
        return Ok(None);
    };
    let albedo = vectors(part, ALBEDO_CHANNELS).ok_or("the albedo is missing")?;
    let normal = vectors(part, NORMAL_CHANNELS).ok_or("the normals are missing")?;
    let (depth_m, object_id) = (depth_m.clone(), object_id.clone());
    let aovs = AovPicture { albedo, normal, depth_m, object_id, ..AovPicture::new(width, height) };
    let mut aovs = match (vectors(part, SEEN_ALBEDO_CHANNELS), vectors(part, SEEN_NORMAL_CHANNELS)) {
        (Some(seen_albedo), Some(seen_normal)) => AovPicture { seen_albedo, seen_normal, ..aovs },
        _ => aovs.seen_directly(),
    };
    if let Some(FlatSamples::F32(variance)) = header.channel(VARIANCE_CHANNEL) {
        let known = |&variance: &f32| if variance >= 0.0 { variance } else { f32::INFINITY };
        aovs.relative_variance = variance.iter().map(known).collect();
    }
    Ok(Some(aovs))
}

/// Returns the vectors of three channels, rows from the top; none if one is missing.
fn vectors(part: &ReadExrPart, names: [&str; 3]) -> Option<Vec<[f32; 3]>> {
    let channel = |name| -> Option<Vec<f32>> { Some(Header(part).channel(name)?.values_as_f32().collect()) };
    let [x, y, z] = [channel(names[0])?, channel(names[1])?, channel(names[2])?];
    Some(x.into_iter().zip(y).zip(z).map(|((x, y), z)| [x, y, z]).collect())
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::io::{LayeredPicture, picture_file, presets};
    use crate::raytrace::{RenderControl, prepare, render};
    use std::ops::ControlFlow;

    /// Renders a shipped studio, and returns its film with the bytes of its file.
    fn rendered(index: usize, change: impl Fn(&mut Scene)) -> (Film, Scene, Vec<u8>) {
        rendered_with(index, 4, change)
    }

    /// As [`rendered`], with so many samples.
    fn rendered_with(index: usize, spp: u32, change: impl Fn(&mut Scene)) -> (Film, Scene, Vec<u8>) {
        let mut loaded = presets()[index].load().unwrap();
        change(&mut loaded.scene);
        let prepared = prepare(&loaded.scene, &loaded.assets).unwrap();
        let settings = Settings { width: 37, height: 21, spp, aovs: true, ..Settings::default() };
        let film = render(&prepared, &settings, &RenderControl::new(), &mut |_| ControlFlow::Continue(()));
        let (picture, layers, aovs) = (film.develop(&loaded.scene), film.lazy_layers(&loaded.scene), film.aovs());
        let info = PictureInfo::new(&loaded.scene, &film.method(), film.spp(), 7);
        let shown = LayeredPicture { picture: &picture, layers: &layers };
        let bytes = picture_file(Path::new("a.exr"), shown, None, aovs.as_ref(), &info).unwrap().bytes();
        drop(layers);
        (film, loaded.scene, bytes)
    }

    /// Compares two pictures. Samples of skin that are negative are cut off in a file: of few samples, some pixels differ.
    fn assert_same(a: &Picture, b: &Picture) {
        assert_eq!((a.width, a.height), (b.width, b.height));
        let values = || a.rgb.iter().flatten().zip(b.rgb.iter().flatten());
        let differ = values().filter(|(a, b)| (*a - *b).abs() > 1e-4 * b.abs().max(0.01)).count();
        assert!(differ * 12 < a.rgb.len() * 3, "{differ} of {}", a.rgb.len() * 3);
        let off: f32 = values().map(|(a, b)| (a - b).abs()).sum();
        assert!(off < 0.01 * b.rgb.iter().flatten().sum::<f32>(), "{off}");
    }

    #[test]
    fn a_picture_comes_back_with_studio_and_lights_and_can_be_mixed() {
        let (film, scene, bytes) = rendered(0, |scene| scene.lights[0].name = "R\u{e9}mi".to_owned());
        let RenderedPicture { picture: read, findings } = decode(&bytes).unwrap();
        assert!(findings.is_empty(), "{findings:?}");
        assert_eq!((&*read.scene, read.film.spp(), read.settings.seed), (&scene, 4, 7));
        assert_eq!((read.film.method(), read.film.aovs()), (film.method(), film.aovs()));
        assert_same(&read.film.develop(&scene), &film.develop(&scene));
        // As a new development of the film: a light dimmed, one in another colour, one off
        let mut mixed = scene.clone();
        mixed.lights[0].power.dial_stops -= 2.0;
        mixed.lights[1].color.source = crate::scene::ColorSource::Kelvin(3200.0);
        mixed.lights[2].on = false;
        assert_same(&read.film.develop(&mixed), &film.develop(&mixed));
        assert_ne!(read.film.develop(&mixed), read.film.develop(&scene));
    }

    #[test]
    fn what_mirrors_and_glass_show_comes_back() {
        let still_life =
            presets().iter().position(|preset| preset.file_name.starts_with("product_still_life")).unwrap();
        let (film, _, bytes) = rendered(still_life, |_| {});
        let (ours, theirs) = (decode(&bytes).unwrap().picture.film.aovs().unwrap(), film.aovs().unwrap());
        assert!(theirs.has_mirrors() && ours == theirs);
    }

    #[test]
    fn the_noise_of_a_picture_comes_back_and_the_denoiser_keeps_what_it_kept() {
        let (film, scene, bytes) = rendered_with(0, 9, |_| {});
        let read = decode(&bytes).unwrap().picture.film;
        let [ours, theirs] = [&read, &film].map(|film| film.aovs().unwrap().relative_variance);
        assert!(theirs.iter().all(|variance| variance.is_finite()));
        // Negative samples of skin are cut off in a file
        let differ = ours.iter().zip(&theirs).filter(|(a, b)| (*a - *b).abs() > 1e-3 * b.max(1e-6)).count();
        assert!(differ * 12 < ours.len(), "{differ} of {}", ours.len());
        assert!((read.noise_stops() / film.noise_stops() - 1.0).abs() < 0.3, "{}", read.noise_stops());
        assert_eq!(read.spp(), 9);
        assert_same(&read.develop(&scene), &film.develop(&scene));
    }

    #[test]
    fn lights_whose_names_are_equal_in_a_file_keep_their_own_layers() {
        // Their letters become underlines, and the export failed: a file has no two parts of one name
        let (film, scene, bytes) = rendered(0, |scene| {
            for (light, name) in scene.lights.iter_mut().zip(["\u{4e3b}\u{5149}", "\u{8f85}\u{5149}"]) {
                light.name = name.to_owned();
            }
        });
        let read = decode(&bytes).unwrap().picture;
        assert_eq!(read.film.layers(), film.layers());
        let mut dark = scene.clone();
        dark.lights[1].on = false;
        assert_same(&read.film.develop(&dark), &film.develop(&dark));
    }

    #[test]
    fn lights_that_share_a_layer_are_mixed_together() {
        let (film, scene, bytes) = rendered(0, |scene| {
            let key = scene.lights[0].clone();
            let first = scene.lights.last().map_or(0, |light| light.id.0 + 1);
            for copy in 0..20 {
                let id = crate::scene::LightId(first + copy);
                scene.lights.push(Light { id, name: format!("Copy {copy}"), ..key.clone() });
            }
        });
        let read = decode(&bytes).unwrap().picture;
        assert_eq!(read.film.layers(), film.layers());
        let mut dimmed = scene.clone();
        dimmed
            .lights
            .iter_mut()
            .filter(|light| light.role == Role::Key)
            .for_each(|light| light.power.dial_stops -= 1.0);
        assert_same(&read.film.develop(&dimmed), &film.develop(&dimmed));
    }

    #[test]
    fn other_pictures_and_damaged_ones_are_errors() {
        let (_, scene, bytes) = rendered(0, |_| {});
        let picture = Picture::new(4, 4);
        let info = PictureInfo { studio: String::new(), ..PictureInfo::new(&scene, "path", 1, 0) };
        let alone = picture_file(Path::new("a.exr"), LayeredPicture::alone(&picture), None, None, &info).unwrap();
        assert!(decode(&alone.bytes()).unwrap_err().contains("no studio in it"));
        assert!(decode(b"a picture").is_err());
        for length in (0..bytes.len()).step_by(bytes.len() / 60) {
            assert!(decode(&bytes[..length]).is_err(), "{length}");
        }
        // Bytes of the header, one after the other: an error or a picture, and no panic
        for at in 0..1500 {
            let mut damaged = bytes.clone();
            damaged[at] ^= 0x41;
            let _ = decode(&damaged);
        }
    }
}

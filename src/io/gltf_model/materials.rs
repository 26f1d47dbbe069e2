//! Materials of glTF files.

use super::buffers::{ModelFile, data_uri};
use crate::color::srgb_decode;
use crate::io::texture;
use crate::scene::{Material, MaterialTextures, TextureRef, path_complaint};
use gltf::image::Source;
use gltf::material::AlphaMode;
use percent_encoding::percent_decode_str;
use std::collections::{BTreeSet, HashMap};
use std::path::Path;

/// Largest reflectance: a reflectance of 1 would absorb nothing.
const MOST_REFLECTED: f32 = 0.98;

/// Reads materials, and collects what they have that is left out.
pub struct MaterialReader<'a> {
    file: &'a ModelFile,
    path: &'a Path,
    warnings: BTreeSet<String>,
    /// Mean colours of images, sRGB-encoded, 0 to 1.
    means: HashMap<usize, Option<[f32; 3]>>,
}

impl<'a> MaterialReader<'a> {
    /// Returns a reader for a file at a path.
    pub fn new(file: &'a ModelFile, path: &'a Path) -> Self {
        MaterialReader { file, path, warnings: BTreeSet::new(), means: HashMap::new() }
    }

    /// Returns a sentence for each property that some material has and that is left out.
    pub fn into_warnings(self) -> Vec<String> {
        self.warnings.into_iter().collect()
    }

    /// Converts a material. Of maps other than that of the base colour, the mean counts.
    pub fn read(&mut self, material: &gltf::Material<'_>) -> Material {
        let pbr = material.pbr_metallic_roughness();
        let [red, green, blue, alpha] = pbr.base_color_factor();
        let mut roughness = pbr.roughness_factor();
        let mut metallic = pbr.metallic_factor();
        if let Some(map) = pbr.metallic_roughness_texture() {
            // Green has the roughness, blue the metal, both linear
            let mean = self.mean(&map.texture());
            (roughness, metallic) = mean.map_or((roughness, 0.0), |mean| (roughness * mean[1], metallic * mean[2]));
            self.leave_out("maps of roughness and metal are taken as their mean");
        }
        let transmission = material.transmission().map_or(0.0, |transmission| transmission.transmission_factor());
        let transmission = match material.alpha_mode() {
            AlphaMode::Blend => transmission.max(1.0 - alpha),
            AlphaMode::Opaque | AlphaMode::Mask => transmission,
        };
        if material.alpha_mode() != AlphaMode::Opaque && pbr.base_color_texture().is_some() {
            self.leave_out("transparent parts of textures are shown opaque");
        }
        if material.normal_texture().is_some() {
            self.leave_out("normal maps are left out");
        }
        if material.unlit() {
            self.leave_out("surfaces that are to be shown unlit are lit");
        }
        let most = if transmission > 0.0 { 1.0 } else { MOST_REFLECTED };
        let unit = |value: f32| if value.is_finite() { value.clamp(0.0, 1.0) } else { 0.0 };
        let base_color = pbr.base_color_texture().and_then(|texture| self.texture(&texture.texture()));
        Material {
            base_color: [red, green, blue].map(|value| unit(value).min(most)),
            textures: MaterialTextures { base_color },
            metallic: unit(metallic),
            roughness: unit(roughness),
            ior: material.ior().filter(|ior| (1.0..=4.0).contains(ior)).unwrap_or(1.5).max(1.01),
            transmission: unit(transmission),
            absorption_per_m: absorption_per_m(material),
            emission_cd_m2: self.emission_cd_m2(material),
            ..Material::default()
        }
    }

    fn leave_out(&mut self, what: &str) {
        self.warnings.insert(what.to_owned());
    }

    /// Returns the luminance of a glowing surface: the factors are in cd/m2 (glTF 2.0, section 3.9.4).
    fn emission_cd_m2(&mut self, material: &gltf::Material<'_>) -> [f32; 3] {
        let strength = material.emissive_strength().unwrap_or(1.0);
        let factor = material.emissive_factor().map(|value| value * strength);
        if factor == [0.0; 3] || !factor.iter().all(|value| value.is_finite() && *value >= 0.0) {
            return [0.0; 3];
        }
        let Some(map) = material.emissive_texture() else { return factor };
        self.leave_out("maps of glowing surfaces are taken as their mean");
        let mean = self.mean(&map.texture()).unwrap_or([0.0; 3]).map(srgb_decode);
        [0, 1, 2].map(|channel| factor[channel] * mean[channel])
    }

    /// Returns the reference to a texture's image: in the model, or a file beside it. None if it leads out of the folder.
    fn texture(&mut self, texture: &gltf::Texture<'_>) -> Option<TextureRef> {
        let image = texture.source();
        let inside = || {
            let model = self.path.file_name()?.to_str()?.to_owned();
            Some(TextureRef::Embedded { model, image: u32::try_from(image.index()).ok()? })
        };
        match image.source() {
            Source::View { .. } => inside(),
            Source::Uri { uri, .. } if uri.starts_with("data:") => inside(),
            Source::Uri { uri, .. } => {
                let path = percent_decode_str(uri).decode_utf8().ok()?.into_owned();
                let complaint = path_complaint(&path);
                if let Some(why) = complaint {
                    self.leave_out(&format!("the texture {path:?} is left out: {why}"));
                }
                complaint.is_none().then_some(TextureRef::File(path))
            }
        }
    }

    /// Returns the mean of an image's values, 0 to 1; none if it can't be read.
    fn mean(&mut self, texture: &gltf::Texture<'_>) -> Option<[f32; 3]> {
        let (file, path) = (self.file, self.path);
        *self.means.entry(texture.source().index()).or_insert_with(|| {
            let bytes = match texture.source().source() {
                Source::View { view, .. } => file.view(&view)?.to_vec(),
                Source::Uri { uri, .. } => match data_uri(uri) {
                    Some(bytes) => bytes.ok()?,
                    None => {
                        let name = percent_decode_str(uri).decode_utf8().ok()?;
                        let beside = path.parent()?.join(&*name);
                        let decoded = path_complaint(&name).is_none().then(|| texture::load(&beside).ok())??;
                        return Some(mean_of(&decoded.texture.rgb));
                    }
                },
            };
            Some(mean_of(&texture::decode(&bytes, path).ok()?.texture.rgb))
        })
    }
}

fn mean_of(pixels: &[[u8; 3]]) -> [f32; 3] {
    let sum = |channel: usize| pixels.iter().map(|pixel| u64::from(pixel[channel])).sum::<u64>();
    [0, 1, 2].map(|channel| sum(channel) as f32 / (255.0 * pixels.len().max(1) as f32))
}

/// Returns the absorption inside of a body, from the colour that is left after a distance.
fn absorption_per_m(material: &gltf::Material<'_>) -> [f32; 3] {
    let Some(volume) = material.volume() else { return [0.0; 3] };
    // A colour of 0 is darker than any body; a channel that nothing passes gets the absorption of 0.1 %
    let per_m = |left: f32| -left.clamp(1e-3, 1.0).ln() / volume.attenuation_distance();
    let absorption = volume.attenuation_color().map(per_m);
    if absorption.iter().all(|value| value.is_finite() && *value >= 0.0) { absorption } else { [0.0; 3] }
}

//! Materials of glTF files.

use super::buffers::ModelFile;
use super::layers::add_layers;
use super::texture_slots::{SlotTexture, UvSets};
use crate::scene::{Alpha, Material, MaterialTextures, TextureRef, TextureSlot, path_complaint};
use gltf::image::Source;
use gltf::material::AlphaMode;
use percent_encoding::percent_decode_str;
use std::collections::BTreeSet;
use std::path::Path;

/// Largest reflectance: a reflectance of 1 would absorb nothing.
const MOST_REFLECTED: f32 = 0.98;
/// Largest luminance of a glowing surface, cd/m2.
const MOST_GLOWING: f32 = 1e9;

/// Reads materials, and collects what they have that is left out.
pub struct MaterialReader<'a> {
    file: &'a ModelFile,
    path: &'a Path,
    warnings: BTreeSet<String>,
}

impl<'a> MaterialReader<'a> {
    /// Returns a reader for a file at a path.
    pub fn new(file: &'a ModelFile, path: &'a Path) -> Self {
        MaterialReader { file, path, warnings: BTreeSet::new() }
    }

    /// Returns a sentence for each property that some material has and that is left out.
    pub fn into_warnings(self) -> Vec<String> {
        self.warnings.into_iter().collect()
    }

    /// Converts a material.
    pub fn read(&mut self, material: &gltf::Material<'_>) -> Material {
        let pbr = material.pbr_metallic_roughness();
        let [red, green, blue, opacity] = pbr.base_color_factor();
        let transmission = material.transmission().map_or(0.0, |transmission| transmission.transmission_factor());
        if material.transmission().is_some_and(|transmission| transmission.transmission_texture().is_some()) {
            self.leave_out("maps of transmission are left out");
        }
        if material.unlit() {
            self.leave_out("surfaces that are to be shown unlit are lit");
        }
        if material.occlusion_texture().is_some() {
            self.leave_out("occlusion maps are left out: the light itself finds what hides it");
        }
        let unit = |value: f32| if value.is_finite() { value.clamp(0.0, 1.0) } else { 0.0 };
        let alpha = match material.alpha_mode() {
            AlphaMode::Opaque => Alpha::Opaque,
            // The factor is that of the texture's alpha
            AlphaMode::Mask => Alpha::Mask { cutoff: unit(material.alpha_cutoff().unwrap_or(0.5) / opacity.max(1e-6)) },
            AlphaMode::Blend => Alpha::Blend { opacity: unit(opacity) },
        };
        // Glass is seen through by itself; what is wholly there needs no test
        let alpha = match alpha {
            Alpha::Mask { .. } | Alpha::Blend { .. } if transmission > 0.0 => Alpha::Opaque,
            Alpha::Mask { cutoff } if cutoff <= 0.0 => Alpha::Opaque,
            Alpha::Blend { opacity } if opacity >= 1.0 && pbr.base_color_texture().is_none() => Alpha::Opaque,
            alpha => alpha,
        };
        let most = if transmission > 0.0 { 1.0 } else { MOST_REFLECTED };
        let mut read = Material {
            base_color: [red, green, blue].map(|value| unit(value).min(most)),
            textures: self.textures(material),
            metallic: unit(pbr.metallic_factor()),
            roughness: unit(pbr.roughness_factor()),
            ior: material.ior().filter(|ior| (1.0..=4.0).contains(ior)).unwrap_or(1.5).max(1.01),
            transmission: unit(transmission),
            absorption_per_m: absorption_per_m(material),
            emission_cd_m2: emission_cd_m2(material),
            alpha,
            ..Material::default()
        };
        let left_out = add_layers(self.file, material, &mut read);
        self.warnings.extend(left_out);
        read
    }

    /// Returns the textures of a material, with their placements.
    fn textures(&mut self, material: &gltf::Material<'_>) -> MaterialTextures {
        let sets = UvSets::of(self.file, material);
        let scale = material.normal_texture().map_or(1.0, |normals| normals.scale());
        let normal_scale = if scale.is_finite() { scale.clamp(-16.0, 16.0) } else { 1.0 };
        let mut textures = MaterialTextures { normal_scale, ..MaterialTextures::default() };
        for slot in TextureSlot::ALL {
            let Some(source) = SlotTexture::of(self.file, material, slot) else { continue };
            if slot == TextureSlot::Emission && emission_cd_m2(material) == [0.0; 3] {
                continue;
            }
            if !sets.contain(source.set) {
                self.leave_out("textures by a third set of texture coordinates are left out");
                continue;
            }
            let reference = self.texture(&source.texture);
            if reference.is_some() {
                textures.placements[slot as usize] = source.placement(&sets);
            }
            *textures.get_mut(slot) = reference;
        }
        textures
    }

    fn leave_out(&mut self, what: &str) {
        self.warnings.insert(what.to_owned());
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
}

/// Returns the luminance of a glowing surface: the factors are in cd/m2 (glTF 2.0, section 3.9.4).
fn emission_cd_m2(material: &gltf::Material<'_>) -> [f32; 3] {
    let strength = material.emissive_strength().unwrap_or(1.0);
    let factor = material.emissive_factor().map(|value| value * strength);
    let is_usable = factor.iter().all(|value| value.is_finite() && (0.0..=MOST_GLOWING).contains(value));
    if is_usable { factor } else { [0.0; 3] }
}

/// Returns the absorption inside of a body, from the colour that is left after a distance.
fn absorption_per_m(material: &gltf::Material<'_>) -> [f32; 3] {
    let Some(volume) = material.volume() else { return [0.0; 3] };
    // A colour of 0 is darker than any body; a channel that nothing passes gets the absorption of 0.1 %
    let per_m = |left: f32| -left.clamp(1e-3, 1.0).ln() / volume.attenuation_distance();
    let absorption = volume.attenuation_color().map(per_m);
    if absorption.iter().all(|value| value.is_finite() && *value >= 0.0) { absorption } else { [0.0; 3] }
}

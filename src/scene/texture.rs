//! Texture images, references to them, and the texture slots of a material.

use super::{BuiltinTexture, TexturePlacement};
use std::fmt;

/// A decoded image of 8 bits a channel, rows from the top.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Texture {
    /// Pixels across.
    pub width: u32,
    /// Pixels down.
    pub height: u32,
    /// `width * height` pixels, red green blue. Their encoding is that of the slot: see [`TextureSlot::is_srgb`].
    pub rgb: Vec<[u8; 3]>,
    /// Alpha of the pixels, 255 for opaque; empty for an image without a transparent pixel.
    pub alpha: Vec<u8>,
}

impl Texture {
    /// Returns an image without transparent pixels.
    pub fn opaque(width: u32, height: u32, rgb: Vec<[u8; 3]>) -> Self {
        Texture { width, height, rgb, alpha: Vec::new() }
    }
}

/// The source of a texture: a PNG or JPEG image, or the program. Paths are relative to the scene file, `/` between
/// folders.
#[derive(Clone, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub enum TextureRef {
    /// An image file.
    File(String),
    /// An image inside a model file.
    Embedded {
        /// Path of the model file.
        model: String,
        /// Index of the image in the model, from 0.
        image: u32,
    },
    /// A texture that the program draws.
    Builtin(BuiltinTexture),
}

/// Separates a model's path from the index of its image: the JSON pointer to the image in glTF (RFC 6901, section 6).
const IMAGE_POINTER: &str = "#/images/";

impl TextureRef {
    /// Returns a reference to an image file.
    pub fn file(path: impl Into<String>) -> Self {
        TextureRef::File(path.into())
    }

    /// Reads the text form that scene files use: `PATH`, `MODEL#/images/N` for image N of a model, or the name of a
    /// built-in texture.
    pub fn parse(text: &str) -> Self {
        if let Some(texture) = BuiltinTexture::ALL.into_iter().find(|texture| texture.name() == text) {
            return TextureRef::Builtin(texture);
        }
        let embedded = text.rsplit_once(IMAGE_POINTER).and_then(|(model, image)| {
            let image: u32 = image.parse().ok()?;
            let reference = TextureRef::Embedded { model: model.to_owned(), image };
            // Other spellings of the number would change when they are written again.
            (reference.to_string() == text).then_some(reference)
        });
        embedded.unwrap_or_else(|| TextureRef::file(text))
    }

    /// Returns the path of the file that holds the image: the image file, or the model; `None` for a built-in texture.
    pub fn path(&self) -> Option<&str> {
        match self {
            TextureRef::File(path) => Some(path),
            TextureRef::Embedded { model, .. } => Some(model),
            TextureRef::Builtin(_) => None,
        }
    }

    /// Returns the same image in a file at another path; a built-in texture as it is.
    pub fn at_path(self, path: String) -> Self {
        match self {
            TextureRef::File(_) => TextureRef::File(path),
            TextureRef::Embedded { image, .. } => TextureRef::Embedded { model: path, image },
            TextureRef::Builtin(_) => self,
        }
    }
}

impl fmt::Display for TextureRef {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            TextureRef::File(path) => f.write_str(path),
            TextureRef::Embedded { model, image } => write!(f, "{model}{IMAGE_POINTER}{image}"),
            TextureRef::Builtin(texture) => f.write_str(texture.name()),
        }
    }
}

/// A property of a material that a texture can vary.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum TextureSlot {
    /// Multiplies [`super::Material::base_color`]; its alpha is that of [`super::Alpha`].
    BaseColor,
    /// Green multiplies [`super::Material::roughness`], blue [`super::Material::metallic`].
    MetallicRoughness,
    /// Multiplies [`super::Material::emission_cd_m2`].
    Emission,
    /// Tilts the shading normal: red along +U, green along +V, blue along the normal, each from -1 to 1.
    Normal,
}

impl TextureSlot {
    /// Number of slots; `slot as usize` is an index below it.
    pub const COUNT: usize = 4;

    /// Every slot, by index.
    pub const ALL: [TextureSlot; Self::COUNT] =
        [TextureSlot::BaseColor, TextureSlot::MetallicRoughness, TextureSlot::Emission, TextureSlot::Normal];

    /// Returns the name of the slot's field in a scene file.
    pub fn field(self) -> &'static str {
        match self {
            TextureSlot::BaseColor => "base_color_texture",
            TextureSlot::MetallicRoughness => "metallic_roughness_texture",
            TextureSlot::Emission => "emission_texture",
            TextureSlot::Normal => "normal_texture",
        }
    }

    /// Returns the name of the field with the placement of the slot's texture.
    pub fn placement_field(self) -> &'static str {
        match self {
            TextureSlot::BaseColor => "base_color_placement",
            TextureSlot::MetallicRoughness => "metallic_roughness_placement",
            TextureSlot::Emission => "emission_placement",
            TextureSlot::Normal => "normal_placement",
        }
    }

    /// Returns true for colours, whose pixels are sRGB-encoded; false for data, whose pixels are linear.
    pub fn is_srgb(self) -> bool {
        match self {
            TextureSlot::BaseColor | TextureSlot::Emission => true,
            TextureSlot::MetallicRoughness | TextureSlot::Normal => false,
        }
    }
}

/// The textures of a material, at most one a slot.
#[derive(Clone, Debug, PartialEq)]
pub struct MaterialTextures {
    /// Multiplies [`super::Material::base_color`].
    pub base_color: Option<TextureRef>,
    /// Multiplies [`super::Material::roughness`] and [`super::Material::metallic`].
    pub metallic_roughness: Option<TextureRef>,
    /// Multiplies [`super::Material::emission_cd_m2`].
    pub emission: Option<TextureRef>,
    /// Tilts the shading normal.
    pub normal: Option<TextureRef>,
    /// Factor of the normal texture's tilt; 1 is as drawn.
    pub normal_scale: f32,
    /// The gloss has the normal of the mesh: it lies over the relief, as lacquer over carved wood.
    pub smooth_gloss: bool,
    /// Radius of a clear dome over the textures, in half widths of the square from (0, 0) to (1, 1) of their coordinates; 0
    /// for none. The surface is a cap of that sphere, and its textures are seen on the flat base, by refraction. Colours of
    /// vertices, which lie on the surface, are not shown below it.
    pub dome_radius: f32,
    /// How each texture lies on the surface, by slot.
    pub placements: [TexturePlacement; TextureSlot::COUNT],
}

impl Default for MaterialTextures {
    fn default() -> Self {
        MaterialTextures {
            base_color: None,
            metallic_roughness: None,
            emission: None,
            normal: None,
            normal_scale: 1.0,
            smooth_gloss: false,
            dome_radius: 0.0,
            placements: [TexturePlacement::default(); TextureSlot::COUNT],
        }
    }
}

impl MaterialTextures {
    /// Returns textures with only the base colour's.
    pub fn with_base_color(texture: TextureRef) -> Self {
        MaterialTextures { base_color: Some(texture), ..MaterialTextures::default() }
    }

    /// Returns the texture of a slot.
    pub fn get(&self, slot: TextureSlot) -> Option<&TextureRef> {
        match slot {
            TextureSlot::BaseColor => self.base_color.as_ref(),
            TextureSlot::MetallicRoughness => self.metallic_roughness.as_ref(),
            TextureSlot::Emission => self.emission.as_ref(),
            TextureSlot::Normal => self.normal.as_ref(),
        }
    }

    /// Returns the texture of a slot, to be changed.
    pub fn get_mut(&mut self, slot: TextureSlot) -> &mut Option<TextureRef> {
        match slot {
            TextureSlot::BaseColor => &mut self.base_color,
            TextureSlot::MetallicRoughness => &mut self.metallic_roughness,
            TextureSlot::Emission => &mut self.emission,
            TextureSlot::Normal => &mut self.normal,
        }
    }

    /// Returns how the texture of a slot lies on the surface.
    pub fn placement(&self, slot: TextureSlot) -> &TexturePlacement {
        &self.placements[slot as usize]
    }

    /// Returns the textures that are set, with their slots.
    pub fn iter(&self) -> impl Iterator<Item = (TextureSlot, &TextureRef)> {
        TextureSlot::ALL.into_iter().filter_map(|slot| Some((slot, self.get(slot)?)))
    }

    /// Looks every texture up. Returns the results by slot index; `None` for slots that are empty or not found.
    pub fn look_up<T>(
        &self,
        mut find: impl FnMut(TextureSlot, &TextureRef) -> Option<T>,
    ) -> [Option<T>; TextureSlot::COUNT] {
        TextureSlot::ALL.map(|slot| self.get(slot).and_then(|texture| find(slot, texture)))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn texture_references_are_written_as_they_are_read() {
        let embedded = |model: &str, image| TextureRef::Embedded { model: model.to_owned(), image };
        for (text, expected) in [
            ("a/floor.png", TextureRef::file("a/floor.png")),
            ("chair.glb#/images/3", embedded("chair.glb", 3)),
            ("a#/images/1#/images/2", embedded("a#/images/1", 2)),
            ("chair.glb#/images/03", TextureRef::file("chair.glb#/images/03")),
            ("chair.glb#/images/x", TextureRef::file("chair.glb#/images/x")),
            ("chair.glb#3", TextureRef::file("chair.glb#3")),
            ("builtin:skin-gloss", TextureRef::Builtin(BuiltinTexture::SkinGloss)),
            ("builtin:skin", TextureRef::file("builtin:skin")),
        ] {
            let reference = TextureRef::parse(text);
            assert_eq!(reference, expected);
            assert_eq!(reference.to_string(), text);
        }
    }

    #[test]
    fn slots_have_the_index_of_their_place_in_the_list() {
        for (index, slot) in TextureSlot::ALL.into_iter().enumerate() {
            assert_eq!(slot as usize, index);
            let mut textures = MaterialTextures::default();
            let reference = TextureRef::file(slot.field());
            *textures.get_mut(slot) = Some(reference.clone());
            assert_eq!(textures.iter().collect::<Vec<_>>(), [(slot, &reference)]);
            assert_eq!(textures.look_up(|_, found| Some(found == &reference))[index], Some(true));
        }
    }
}

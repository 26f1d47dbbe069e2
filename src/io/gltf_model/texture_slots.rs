//! The textures of a material: images, placements, and the sets of texture coordinates that they lie by.

use super::buffers::ModelFile;
use crate::scene::{TexturePlacement, TextureSlot, Wrap};
use gltf::texture::{MagFilter, Sampler, TextureTransform, WrappingMode};
use serde_json::Value;

/// A texture of a material, as the file names it.
pub struct SlotTexture<'a> {
    /// The texture.
    pub texture: gltf::Texture<'a>,
    /// The set of texture coordinates.
    pub set: u32,
    transform: Transform,
}

/// A texture transform (`KHR_texture_transform`).
#[derive(Clone, Copy)]
struct Transform {
    offset: [f32; 2],
    rotation_rad: f32,
    scale: [f32; 2],
}

impl Transform {
    const NONE: Self = Transform { offset: [0.0; 2], rotation_rad: 0.0, scale: [1.0; 2] };

    fn of(transform: &TextureTransform<'_>) -> Self {
        Transform { offset: transform.offset(), rotation_rad: transform.rotation(), scale: transform.scale() }
    }
}

impl<'a> SlotTexture<'a> {
    /// Returns the texture of a material in a slot.
    pub fn of(file: &ModelFile, material: &gltf::Material<'a>, slot: TextureSlot) -> Option<Self> {
        let pbr = material.pbr_metallic_roughness();
        let info = match slot {
            TextureSlot::BaseColor => pbr.base_color_texture()?,
            TextureSlot::MetallicRoughness => pbr.metallic_roughness_texture()?,
            TextureSlot::Emission => material.emissive_texture()?,
            TextureSlot::Normal => {
                let json = file.normal_texture_transform(material.index());
                return material.normal_texture().map(|texture| Self::of_normals(&texture, json));
            }
        };
        let transform = info.texture_transform();
        let set = transform.as_ref().and_then(TextureTransform::tex_coord).unwrap_or(info.tex_coord());
        let transform = transform.as_ref().map_or(Transform::NONE, Transform::of);
        Some(SlotTexture { texture: info.texture(), set, transform })
    }

    /// Reads a normal texture, whose transform the crate leaves in the JSON.
    fn of_normals(normals: &gltf::material::NormalTexture<'a>, json: Option<&Value>) -> Self {
        let pair = |name: &str| serde_json::from_value::<[f32; 2]>(json?.get(name)?.clone()).ok();
        let rotation = json.and_then(|json| serde_json::from_value::<f32>(json.get("rotation")?.clone()).ok());
        let set = json.and_then(|json| u32::try_from(json.get("texCoord")?.as_u64()?).ok());
        SlotTexture {
            texture: normals.texture(),
            set: set.unwrap_or(normals.tex_coord()),
            transform: Transform {
                offset: pair("offset").unwrap_or([0.0; 2]),
                rotation_rad: rotation.unwrap_or(0.0),
                scale: pair("scale").unwrap_or([1.0; 2]),
            },
        }
    }

    /// Returns how the texture lies on the surface; the default for a transform that is no usable number.
    pub fn placement(&self, sets: &UvSets) -> TexturePlacement {
        let Transform { offset, rotation_rad, scale } = self.transform;
        let rotation_deg = rotation_rad.to_degrees() % 360.0;
        let values = [offset[0], offset[1], rotation_deg, scale[0], scale[1]];
        let is_usable = values.iter().all(|value| value.is_finite() && value.abs() <= 1e4);
        let Transform { offset, scale, .. } = if is_usable { self.transform } else { Transform::NONE };
        let sampler = self.texture.sampler();
        TexturePlacement {
            offset,
            rotation_deg: if is_usable { rotation_deg } else { 0.0 },
            scale,
            wrap: wraps(&sampler),
            nearest: sampler.mag_filter() == Some(MagFilter::Nearest),
            second_uvs: sets.second == Some(self.set),
        }
    }
}

fn wraps(sampler: &Sampler<'_>) -> [Wrap; 2] {
    [sampler.wrap_s(), sampler.wrap_t()].map(|mode| match mode {
        WrappingMode::Repeat => Wrap::Repeat,
        WrappingMode::MirroredRepeat => Wrap::Mirror,
        WrappingMode::ClampToEdge => Wrap::Clamp,
    })
}

/// The sets of texture coordinates that a material's textures lie by: a mesh has two.
#[derive(Debug, Default, PartialEq)]
pub struct UvSets {
    /// The first set in use.
    pub first: Option<u32>,
    /// Another one.
    pub second: Option<u32>,
}

impl UvSets {
    /// Returns the sets that a material uses, in the order of the slots.
    pub fn of(file: &ModelFile, material: &gltf::Material<'_>) -> Self {
        let mut sets = UvSets::default();
        for slot in TextureSlot::ALL {
            let Some(texture) = SlotTexture::of(file, material, slot) else { continue };
            match sets {
                UvSets { first: None, .. } => sets.first = Some(texture.set),
                UvSets { first: Some(first), second: None } if first != texture.set => sets.second = Some(texture.set),
                UvSets { .. } => {}
            }
        }
        sets
    }

    /// Returns true if a mesh holds a set.
    pub fn contain(&self, set: u32) -> bool {
        [self.first, self.second].contains(&Some(set))
    }
}

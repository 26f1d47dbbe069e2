//! How the textures of a surface lie on it, as the shaders read it.

use crate::math::Dome;
use crate::scene::{Alpha, Material, TextureSlot};
use bytemuck::{Pod, Zeroable};

/// The placements of a surface's textures; twin of the last fields of `Draw` in `draw.wgsl`.
#[repr(C)]
#[derive(Clone, Copy, Debug, PartialEq, Pod, Zeroable)]
pub(crate) struct GpuMaps {
    /// Columns of the transforms of texture coordinates, by slot.
    matrices: [[f32; 4]; TextureSlot::COUNT],
    /// Offsets of two slots each.
    offsets: [[f32; 4]; 2],
    normal_scale: f32,
    /// Least alpha that is there; negative for blended surfaces.
    cutoff: f32,
    /// Factor of the alpha of blended surfaces.
    opacity: f32,
    /// Bits of the slots that lie by the second set of texture coordinates, and of a smooth gloss.
    bits: u32,
    /// Radius and index of refraction of the dome over the textures; 0 for none.
    dome: [f32; 2],
    unused: [f32; 2],
}

/// Bit of a surface whose relief is below the gloss; twin of `SMOOTH_GLOSS_BIT` in `draw.wgsl`.
const SMOOTH_GLOSS_BIT: u32 = 256;

impl GpuMaps {
    /// Packs the placements of a material.
    pub fn new(material: &Material) -> Self {
        let textures = &material.textures;
        let transforms = TextureSlot::ALL.map(|slot| textures.placement(slot).picture_from_mesh());
        let [a, b, c, d] = transforms.map(|transform| transform.translation);
        let (cutoff, opacity) = match material.alpha {
            Alpha::Opaque => (0.0, 1.0),
            Alpha::Mask { cutoff } => (cutoff, 1.0),
            Alpha::Blend { opacity } => (-1.0, opacity),
        };
        let bit = |slot: &TextureSlot| u32::from(textures.placement(*slot).second_uvs) << (*slot as u32);
        let smooth_gloss = if material.has_relief() && material.has_smooth_gloss() { SMOOTH_GLOSS_BIT } else { 0 };
        GpuMaps {
            matrices: transforms.map(|transform| transform.matrix2.to_cols_array()),
            offsets: [[a.x, a.y, b.x, b.y], [c.x, c.y, d.x, d.y]],
            // Without a map the normal stays as it is
            normal_scale: if textures.normal.is_some() { textures.normal_scale } else { 0.0 },
            cutoff,
            opacity,
            bits: TextureSlot::ALL.iter().map(bit).sum::<u32>() | smooth_gloss,
            dome: material.dome().map_or([0.0; 2], |Dome { radius, ior }| [radius, ior]),
            unused: [0.0; 2],
        }
    }
}

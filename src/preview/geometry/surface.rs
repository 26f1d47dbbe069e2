//! Surface records as the shaders read them.

use super::gpu_maps::GpuMaps;
use crate::scene::Material;
use bytemuck::{Pod, Zeroable};
use glam::{Affine3A, Vec3};

/// The surface is an emitter: its front emits and is not lit.
pub(crate) const FLAG_EMITTER: u32 = 1;
/// The surface emits and is lit.
pub(crate) const FLAG_GLOWS: u32 = 2;
/// The surface has the selection outline.
pub(crate) const FLAG_SELECTED: u32 = 4;
/// The surface has the hover outline.
pub(crate) const FLAG_HOVERED: u32 = 8;

/// The surface has a normal map; twin of `FLAG_RELIEF` in `scene.wgsl`.
pub(crate) const FLAG_RELIEF: u32 = 16;
/// The normal map is below the gloss; twin of `FLAG_SMOOTH_GLOSS` in `scene.wgsl`.
pub(crate) const FLAG_SMOOTH_GLOSS: u32 = 32;
/// Strands so short that light from behind meets what they grow from; twin of `FLAG_SHORT_FIBRE` in `scene.wgsl`.
pub(crate) const FLAG_SHORT_FIBRE: u32 = 64;

/// A surface in the storage buffer; twin of `Surface` in `scene.wgsl`.
#[repr(C)]
#[derive(Clone, Copy, Debug, PartialEq, Pod, Zeroable)]
pub(crate) struct GpuSurface {
    pub base_color: [f32; 3],
    pub roughness: f32,
    /// Emitted radiance, picture units.
    pub emission: [f32; 3],
    pub metallic: f32,
    pub ior: f32,
    pub transmission: f32,
    pub flags: u32,
    /// Amount and roughness of lacquer, translucency, frosting, 8 bits each.
    pub layers: u32,
    /// Shape parameters of the diffusion profile, metres; 0 for hard surfaces.
    pub diffusion_m: [f32; 3],
    pub unused_1: u32,
}

impl GpuSurface {
    /// Returns true if the surface emits besides being lit.
    pub fn glows(&self) -> bool {
        self.flags & FLAG_GLOWS != 0
    }

    /// Returns true if the surface is the front of an emitter.
    pub fn is_emitter(&self) -> bool {
        self.flags & FLAG_EMITTER != 0
    }

    /// Returns the outline flags of the id buffer; twins of `ID_SELECTED` and `ID_HOVERED` in `scene.wgsl`.
    pub fn outline_bits(&self) -> u32 {
        let bit_of = |flag: u32, bit: u32| if self.flags & flag != 0 { 1 << bit } else { 0 };
        bit_of(FLAG_SELECTED, 31) | bit_of(FLAG_HOVERED, 30)
    }
}

/// Returns the shape parameters of a material's diffusion profile, metres: the mean free paths over a fit in the albedo
/// (Christensen and Burley 2015, equation 6); zeros for hard surfaces.
pub(crate) fn diffusion_m(material: &Material) -> [f32; 3] {
    let opaque = material.subsurface.filter(|_| material.transmission == 0.0 && material.metallic < 1.0);
    let Some(subsurface) = opaque else { return [0.0; 3] };
    std::array::from_fn(|channel| {
        let albedo = material.base_color[channel].clamp(0.0, 1.0);
        let scale = 1.9 - albedo + 3.5 * (albedo - 0.8).powi(2);
        1e-3 * subsurface.mean_free_path_mm[channel] / scale
    })
}

/// Packs the layers of a material that the lighting and the glass pass draw, for `unpack4x8unorm`.
pub(crate) fn packed_layers(material: &Material) -> u32 {
    let (amount, roughness) = material.clearcoat.map_or((0.0, 0.0), |coat| (coat.amount, coat.roughness));
    let translucency = if material.is_translucent() { material.translucency } else { 0.0 };
    let bytes = [amount, roughness, translucency, material.frosting].map(|v| (v.clamp(0.0, 1.0) * 255.0 + 0.5) as u8);
    u32::from_le_bytes(bytes)
}

/// The record of a draw call; twin of `Draw` in `draw.wgsl`.
#[repr(C)]
#[derive(Clone, Copy, Debug, PartialEq, Pod, Zeroable)]
pub(crate) struct GpuDraw {
    /// Rows of the transform to world space.
    world_from_object: [[f32; 4]; 3],
    /// Rows of the normal transform to world space, not normalised.
    normal_from_object: [[f32; 4]; 3],
    /// Packed colour, packed gloss, id with outline flags, and 1 for an emitter.
    surface: [u32; 4],
    maps: GpuMaps,
}

impl GpuDraw {
    /// Packs the record of the surface with this index.
    pub fn new(index: u32, world_from_object: &Affine3A, surface: &GpuSurface, material: &Material) -> Self {
        let (axes, t) = (world_from_object.matrix3, world_from_object.translation);
        let (x, y, z) = (Vec3::from(axes.x_axis), Vec3::from(axes.y_axis), Vec3::from(axes.z_axis));
        // Transform normals by the cofactor matrix, which exists for every scale, including zero and negative ones
        let mirror = if axes.determinant() >= 0.0 { 1.0 } else { -1.0 };
        let [a, b, c] = [y.cross(z) * mirror, z.cross(x) * mirror, x.cross(y) * mirror];
        let row = |i: usize| [x[i], y[i], z[i], t[i]];
        let normal_row = |i: usize| [a[i], b[i], c[i], 0.0];
        GpuDraw {
            world_from_object: [0, 1, 2].map(row),
            normal_from_object: [0, 1, 2].map(normal_row),
            surface: [
                pack_color(surface.base_color, u32::from(surface.glows())),
                match surface.glows() {
                    true => pack_glowing_gloss(surface.roughness, surface.metallic),
                    false => pack_gloss(surface.roughness, surface.metallic, surface.ior),
                },
                (index + 1) | surface.outline_bits(),
                u32::from(surface.is_emitter()),
            ],
            maps: GpuMaps::new(material),
        }
    }

    /// Returns how textures lie on the surface.
    pub fn maps(&self) -> &GpuMaps {
        &self.maps
    }
}

/// Packs a colour and a surface kind; twin of `pack_color` in `scene.wgsl`.
fn pack_color(color: [f32; 3], kind: u32) -> u32 {
    let [r, g, b] = color.map(|c| (c.clamp(0.0, 1.0).sqrt() * 1023.0 + 0.5) as u32);
    r | g << 10 | b << 20 | kind << 30
}

/// Packs roughness in 8 bits and metallic in 6 of a surface that glows all over; twin of `pack_glowing_gloss` in
/// `scene.wgsl`.
fn pack_glowing_gloss(roughness: f32, metallic: f32) -> u32 {
    let bits = |value: f32, max: f32| (value * max + 0.5) as u32;
    bits(roughness, 255.0) | bits(metallic, 63.0) << 8 | 0x3_ffff << 14
}

/// Packs roughness and the square root of the dielectric F0 in 12 bits each, metallic in 8; the inverse of
/// `unpack_gloss` in `scene.wgsl`.
fn pack_gloss(roughness: f32, metallic: f32, ior: f32) -> u32 {
    let sqrt_f0 = (ior - 1.0) / (ior + 1.0);
    let bits = |value: f32, max: f32| (value * max + 0.5) as u32;
    bits(roughness, 4095.0) | bits(sqrt_f0, 4095.0) << 12 | bits(metallic, 255.0) << 24
}

//! Surface records as the shaders read them.

use bytemuck::{Pod, Zeroable};
use glam::{Affine3A, Vec3};

/// The surface shines and is not lit; twin of the flag in `scene.wgsl`.
pub(crate) const FLAG_EMITTER: u32 = 1;
/// The surface glows besides being lit.
pub(crate) const FLAG_GLOWS: u32 = 2;
/// Outlined as selected.
pub(crate) const FLAG_SELECTED: u32 = 4;
/// Outlined as hovered.
pub(crate) const FLAG_HOVERED: u32 = 8;

/// One surface in a storage buffer; twin of `Surface` in `scene.wgsl`.
#[repr(C)]
#[derive(Clone, Copy, Debug, PartialEq, Pod, Zeroable)]
pub(crate) struct GpuSurface {
    pub base_color: [f32; 3],
    pub roughness: f32,
    /// Picture units.
    pub emission: [f32; 3],
    pub metallic: f32,
    pub ior: f32,
    pub transmission: f32,
    pub flags: u32,
    pub unused: u32,
}

impl GpuSurface {
    pub fn glows(&self) -> bool {
        self.flags & FLAG_GLOWS != 0
    }

    pub fn is_emitter(&self) -> bool {
        self.flags & FLAG_EMITTER != 0
    }

    /// Marks in the id buffer; twin of `mark_of` in `scene.wgsl`.
    pub fn marks(&self) -> u32 {
        let mark = |flag: u32, bit: u32| if self.flags & flag != 0 { 1 << bit } else { 0 };
        mark(FLAG_SELECTED, 31) | mark(FLAG_HOVERED, 30)
    }
}

/// One draw; twin of `Draw` in `draw.wgsl`.
#[repr(C)]
#[derive(Clone, Copy, Debug, PartialEq, Pod, Zeroable)]
pub(crate) struct GpuDraw {
    /// Rows of world from object.
    world_from_object: [[f32; 4]; 3],
    /// Rows that take normals to the world, to any length.
    normal_from_object: [[f32; 4]; 3],
    /// Packed colour, packed gloss, mark in the id buffer, and whether the front shines.
    surface: [u32; 4],
}

impl GpuDraw {
    pub fn new(number: u32, world_from_object: &Affine3A, surface: &GpuSurface) -> Self {
        let (axes, t) = (world_from_object.matrix3, world_from_object.translation);
        let (x, y, z) = (Vec3::from(axes.x_axis), Vec3::from(axes.y_axis), Vec3::from(axes.z_axis));
        // Normals go by the cofactors of the matrix, which exist for every scale, flat and mirrored ones too.
        let mirror = if axes.determinant() >= 0.0 { 1.0 } else { -1.0 };
        let [a, b, c] = [y.cross(z) * mirror, z.cross(x) * mirror, x.cross(y) * mirror];
        let row = |i: usize| [x[i], y[i], z[i], t[i]];
        let normal_row = |i: usize| [a[i], b[i], c[i], 0.0];
        GpuDraw {
            world_from_object: [0, 1, 2].map(row),
            normal_from_object: [0, 1, 2].map(normal_row),
            surface: [
                pack_color(surface.base_color, u32::from(surface.glows())),
                pack_gloss(surface.roughness, surface.metallic, surface.ior),
                (number + 1) | surface.marks(),
                u32::from(surface.is_emitter()),
            ],
        }
    }
}

/// Twin of `pack_color` in `scene.wgsl`.
fn pack_color(color: [f32; 3], kind: u32) -> u32 {
    let [r, g, b] = color.map(|c| (c.clamp(0.0, 1.0).sqrt() * 1023.0 + 0.5) as u32);
    r | g << 10 | b << 20 | kind << 30
}

/// Roughness and the square root of the dielectric's reflectance at normal incidence in 12 bits, metallic in 8; read by
/// `unpack_gloss` in `scene.wgsl`.
fn pack_gloss(roughness: f32, metallic: f32, ior: f32) -> u32 {
    let root = (ior - 1.0) / (ior + 1.0);
    let bits = |value: f32, most: f32| (value * most + 0.5) as u32;
    bits(roughness, 4095.0) | bits(root, 4095.0) << 12 | bits(metallic, 255.0) << 24
}

//! What a single draw reads: where its triangles stand and what they are made of.
//!
//! A uniform bound for each draw, not an entry of a storage buffer that each vertex looks up: rasterisers on a processor
//! read it once for all vertices, which takes a quarter off their work before the first pixel.

use super::draw_list::GpuSurface;
use crate::preview::shadows::maps::{dynamic_uniform, dynamic_uniform_layout};
use bytemuck::{Pod, Zeroable};
use eframe::wgpu;
use glam::{Affine3A, Vec3};

/// Dynamic uniform offsets are multiples of this on every device.
const OFFSET_STRIDE: usize = 256;
/// Draws for which there is room at first.
const FIRST_ROOM: usize = 64;

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

/// The draws of a frame, one for each surface.
#[derive(Debug)]
pub(crate) struct DrawUniforms {
    layout: wgpu::BindGroupLayout,
    buffer: wgpu::Buffer,
    bind_group: wgpu::BindGroup,
    /// What the buffer holds.
    written: Vec<GpuDraw>,
}

impl DrawUniforms {
    pub fn new(device: &wgpu::Device) -> Self {
        let stages = wgpu::ShaderStages::VERTEX_FRAGMENT;
        let layout = dynamic_uniform_layout(device, "draw", stages);
        let (buffer, bind_group) = with_room(device, &layout, FIRST_ROOM);
        DrawUniforms { layout, buffer, bind_group, written: Vec::new() }
    }

    /// Layout of the bind group.
    pub fn layout(&self) -> &wgpu::BindGroupLayout {
        &self.layout
    }

    /// Uploads a frame's draws, unless they are those of the last one.
    pub fn write(&mut self, device: &wgpu::Device, queue: &wgpu::Queue, draws: &[GpuDraw]) {
        if draws == self.written {
            return;
        }
        if (draws.len() * OFFSET_STRIDE) as u64 > self.buffer.size() {
            (self.buffer, self.bind_group) = with_room(device, &self.layout, draws.len().next_power_of_two());
        }
        let mut bytes = vec![0; draws.len() * OFFSET_STRIDE];
        for (place, draw) in bytes.chunks_exact_mut(OFFSET_STRIDE).zip(draws) {
            place[..size_of::<GpuDraw>()].copy_from_slice(bytemuck::bytes_of(draw));
        }
        queue.write_buffer(&self.buffer, 0, &bytes);
        self.written = draws.to_vec();
    }

    /// Binds a surface's draw as group 1.
    pub fn bind(&self, pass: &mut wgpu::RenderPass, surface: u32) {
        pass.set_bind_group(1, &self.bind_group, &[surface * OFFSET_STRIDE as u32]);
    }
}

fn with_room(device: &wgpu::Device, layout: &wgpu::BindGroupLayout, draws: usize) -> (wgpu::Buffer, wgpu::BindGroup) {
    let buffer = device.create_buffer(&wgpu::BufferDescriptor {
        label: Some("draws"),
        size: (draws * OFFSET_STRIDE) as u64,
        usage: wgpu::BufferUsages::UNIFORM | wgpu::BufferUsages::COPY_DST,
        mapped_at_creation: false,
    });
    let bind_group = dynamic_uniform(device, "draw", layout, &buffer, size_of::<GpuDraw>());
    (buffer, bind_group)
}

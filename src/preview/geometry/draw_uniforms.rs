//! The uniform buffer of draws: one record per surface, bound with a dynamic offset for each draw call.
//!
//! A uniform rather than an entry of a storage buffer that each vertex indexes: CPU rasterisers read a uniform once for
//! all vertices, which saves a quarter of their work before the first pixel.

use super::surface::GpuDraw;
use crate::preview::gpu::bindings::{UNIFORM_OFFSET_ALIGNMENT, dynamic_uniform, dynamic_uniform_layout};
use eframe::wgpu;

/// Stride of the records, bytes.
const OFFSET_STRIDE: usize = UNIFORM_OFFSET_ALIGNMENT as usize;
/// Initial capacity in draws.
const INITIAL_CAPACITY: usize = 64;

/// The draw records of a frame, one per surface.
#[derive(Debug)]
pub(crate) struct DrawUniforms {
    layout: wgpu::BindGroupLayout,
    buffer: wgpu::Buffer,
    bind_group: wgpu::BindGroup,
    /// Contents of the buffer.
    written: Vec<GpuDraw>,
}

impl DrawUniforms {
    pub fn new(device: &wgpu::Device) -> Self {
        let stages = wgpu::ShaderStages::VERTEX_FRAGMENT;
        let layout = dynamic_uniform_layout(device, "draw", stages);
        let (buffer, bind_group) = buffer_with_capacity(device, &layout, INITIAL_CAPACITY);
        DrawUniforms { layout, buffer, bind_group, written: Vec::new() }
    }

    /// The layout of the bind group.
    pub fn layout(&self) -> &wgpu::BindGroupLayout {
        &self.layout
    }

    /// Uploads a frame's records if they differ from those of the last frame.
    pub fn write(&mut self, device: &wgpu::Device, queue: &wgpu::Queue, draws: &[GpuDraw]) {
        if draws == self.written {
            return;
        }
        if (draws.len() * OFFSET_STRIDE) as u64 > self.buffer.size() {
            (self.buffer, self.bind_group) =
                buffer_with_capacity(device, &self.layout, draws.len().next_power_of_two());
        }
        let mut bytes = vec![0; draws.len() * OFFSET_STRIDE];
        for (slot, draw) in bytes.chunks_exact_mut(OFFSET_STRIDE).zip(draws) {
            slot[..size_of::<GpuDraw>()].copy_from_slice(bytemuck::bytes_of(draw));
        }
        queue.write_buffer(&self.buffer, 0, &bytes);
        self.written = draws.to_vec();
    }

    /// Binds a surface's record as group 1.
    pub fn bind(&self, pass: &mut wgpu::RenderPass, surface: u32) {
        pass.set_bind_group(1, &self.bind_group, &[surface * OFFSET_STRIDE as u32]);
    }
}

/// Creates the buffer for a number of draws, and its bind group.
fn buffer_with_capacity(
    device: &wgpu::Device,
    layout: &wgpu::BindGroupLayout,
    draws: usize,
) -> (wgpu::Buffer, wgpu::BindGroup) {
    let buffer = device.create_buffer(&wgpu::BufferDescriptor {
        label: Some("draws"),
        size: (draws * OFFSET_STRIDE) as u64,
        usage: wgpu::BufferUsages::UNIFORM | wgpu::BufferUsages::COPY_DST,
        mapped_at_creation: false,
    });
    let bind_group = dynamic_uniform(device, "draw", layout, &buffer, size_of::<GpuDraw>());
    (buffer, bind_group)
}

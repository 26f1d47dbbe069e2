//! The overlay pass over the finished picture: selection outline, tinted triangles, lines.

use super::gizmo::Gizmos;
use super::pipelines::OverlayPipelines;
use crate::preview::geometry::oriented_box::OrientedBox;
use crate::preview::gpu::bindings::color_attachment;
use crate::preview::gpu::pipeline::BindGroupLayouts;
use crate::preview::targets::Targets;
use crate::scene::CameraFrame;
use eframe::wgpu;
use glam::{UVec2, Vec2};

/// A rectangle of the picture in pixels: corner and size.
pub(crate) type Area = (UVec2, UVec2);

/// Pipelines and buffers of the overlay.
#[derive(Debug)]
pub(crate) struct OverlayPass {
    pipelines: OverlayPipelines,
    lines: Vertices,
    tints: Vertices,
}

/// A growing vertex buffer and the number of its items in use.
#[derive(Debug)]
struct Vertices {
    buffer: wgpu::Buffer,
    count: u32,
}

impl Vertices {
    fn new(device: &wgpu::Device, size: u64) -> Self {
        let usage = wgpu::BufferUsages::VERTEX | wgpu::BufferUsages::COPY_DST;
        let descriptor = wgpu::BufferDescriptor { label: Some("overlay"), size, usage, mapped_at_creation: false };
        Vertices { buffer: device.create_buffer(&descriptor), count: 0 }
    }

    fn write<T: bytemuck::Pod>(&mut self, device: &wgpu::Device, queue: &wgpu::Queue, items: &[T]) {
        let bytes: &[u8] = bytemuck::cast_slice(items);
        if bytes.len() as u64 > self.buffer.size() {
            *self = Vertices::new(device, (bytes.len() as u64).next_power_of_two());
        }
        if !bytes.is_empty() {
            queue.write_buffer(&self.buffer, 0, bytes);
        }
        self.count = items.len() as u32;
    }
}

impl OverlayPass {
    pub fn new(device: &wgpu::Device, layouts: &BindGroupLayouts) -> Self {
        OverlayPass {
            pipelines: OverlayPipelines::new(device, layouts),
            lines: Vertices::new(device, 1 << 16),
            tints: Vertices::new(device, 1 << 12),
        }
    }

    /// Returns the rectangle of the picture that encloses the outlined boxes; none if they are off screen.
    pub fn outlined_area(&self, frame: &CameraFrame, size: (u32, u32), outlined: &[OrientedBox]) -> Option<Area> {
        let scale = Vec2::new(size.0 as f32, size.1 as f32);
        let (mut low, mut high) = (Vec2::INFINITY, Vec2::NEG_INFINITY);
        for corner in outlined.iter().flat_map(OrientedBox::corners) {
            match frame.project(corner) {
                Some(uv) => (low, high) = (low.min(uv * scale), high.max(uv * scale)),
                // A corner behind the eye has no projection: take the whole picture.
                None => (low, high) = (Vec2::ZERO, scale),
            }
        }
        let (low, high) = ((low - 3.0).max(Vec2::ZERO), (high + 3.0).min(scale));
        (low.cmplt(high).all()).then(|| {
            let corner = low.floor().as_uvec2();
            (corner, high.ceil().as_uvec2().min(UVec2::from(size)) - corner)
        })
    }

    /// Uploads lines and tints.
    pub fn upload(&mut self, device: &wgpu::Device, queue: &wgpu::Queue, gizmos: &Gizmos) {
        self.lines.write(device, queue, &gizmos.lines);
        self.tints.write(device, queue, &gizmos.tints);
    }

    /// Draws over the picture; `outlined` is the rectangle that holds the selection outline.
    pub fn draw(
        &self,
        encoder: &mut wgpu::CommandEncoder,
        targets: &Targets,
        scene: &wgpu::BindGroup,
        outlined: Option<Area>,
    ) {
        let mut pass = encoder.begin_render_pass(&wgpu::RenderPassDescriptor {
            label: Some("overlay"),
            color_attachments: &[color_attachment(&targets.color_view, wgpu::LoadOp::Load)],
            ..Default::default()
        });
        pass.set_bind_group(0, scene, &[]);
        pass.set_bind_group(1, &targets.gbuffer_group, &[]);
        if let Some((corner, size)) = outlined {
            pass.set_pipeline(&self.pipelines.outline);
            pass.set_scissor_rect(corner.x, corner.y, size.x, size.y);
            pass.draw(0..3, 0..1);
            pass.set_scissor_rect(0, 0, targets.size.0, targets.size.1);
        }
        if self.tints.count > 0 {
            pass.set_pipeline(&self.pipelines.tints);
            pass.set_vertex_buffer(0, self.tints.buffer.slice(..));
            pass.draw(0..self.tints.count, 0..1);
        }
        if self.lines.count > 0 {
            pass.set_pipeline(&self.pipelines.lines);
            pass.set_vertex_buffer(0, self.lines.buffer.slice(..));
            pass.draw(0..6, 0..self.lines.count);
        }
    }
}

/// Clears the picture to transparent, for an overlay without a picture below.
pub(crate) fn clear(encoder: &mut wgpu::CommandEncoder, view: &wgpu::TextureView) {
    encoder.begin_render_pass(&wgpu::RenderPassDescriptor {
        label: Some("clear for the overlay"),
        color_attachments: &[color_attachment(view, wgpu::LoadOp::Clear(wgpu::Color::TRANSPARENT))],
        ..Default::default()
    });
}

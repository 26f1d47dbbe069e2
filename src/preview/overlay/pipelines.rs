//! Pipelines of the overlay pass.

use super::gizmo::{GpuLine, GpuTint};
use crate::preview::gpu::pipeline::{BindGroupLayouts, pipeline_layout};
use crate::preview::shaders;
use crate::preview::targets::Output;
use eframe::wgpu;

/// Pipelines that blend lines, tinted triangles and the selection outline over the display picture.
#[derive(Debug)]
pub(crate) struct OverlayPipelines {
    pub lines: wgpu::RenderPipeline,
    pub tints: wgpu::RenderPipeline,
    pub outline: wgpu::RenderPipeline,
}

impl OverlayPipelines {
    pub fn new(device: &wgpu::Device, layouts: &BindGroupLayouts) -> Self {
        let layout = pipeline_layout(device, "overlay", &[&layouts.scene, &layouts.gbuffer]);
        let overlay = shaders::module(device, "overlay", shaders::OVERLAY);
        let outline = shaders::module(device, "outline", shaders::OUTLINE);
        let pipeline = |module: &wgpu::ShaderModule, entry_point, buffers: &[_]| {
            let color = wgpu::ColorTargetState {
                blend: Some(wgpu::BlendState::ALPHA_BLENDING),
                ..Output::Display.format().into()
            };
            device.create_render_pipeline(&wgpu::RenderPipelineDescriptor {
                label: Some("overlay"),
                layout: Some(&layout),
                vertex: wgpu::VertexState {
                    module,
                    entry_point: Some(entry_point),
                    compilation_options: Default::default(),
                    buffers,
                },
                primitive: Default::default(),
                depth_stencil: None,
                multisample: Default::default(),
                fragment: Some(wgpu::FragmentState {
                    module,
                    entry_point: Some("fragment"),
                    compilation_options: Default::default(),
                    targets: &[Some(color)],
                }),
                multiview_mask: None,
                cache: None,
            })
        };
        let line = wgpu::VertexBufferLayout {
            array_stride: size_of::<GpuLine>() as u64,
            step_mode: wgpu::VertexStepMode::Instance,
            attributes: &wgpu::vertex_attr_array![0 => Float32x4, 1 => Float32x4, 2 => Float32x4],
        };
        let tint = wgpu::VertexBufferLayout {
            array_stride: size_of::<GpuTint>() as u64,
            step_mode: wgpu::VertexStepMode::Vertex,
            attributes: &wgpu::vertex_attr_array![0 => Float32x4, 1 => Float32x4],
        };
        OverlayPipelines {
            lines: pipeline(&overlay, "line_vertex", &[Some(line)]),
            tints: pipeline(&overlay, "tint_vertex", &[Some(tint)]),
            outline: pipeline(&outline, "vertex", &[]),
        }
    }
}

//! Render pipelines of the kinds that several passes use, and the list of bind group layouts.

use crate::preview::shaders;
use eframe::wgpu;

/// The layouts of all bind groups. Clones share the layouts.
#[derive(Clone, Debug)]
pub(crate) struct BindGroupLayouts {
    /// Group 0 of all pipelines: frame constants, surfaces, lights, light tiles.
    pub scene: wgpu::BindGroupLayout,
    pub texture: wgpu::BindGroupLayout,
    pub draw: wgpu::BindGroupLayout,
    pub gbuffer: wgpu::BindGroupLayout,
    pub coarse: wgpu::BindGroupLayout,
    pub shadow_view: wgpu::BindGroupLayout,
    pub shadow_maps: wgpu::BindGroupLayout,
    pub shadow_slots: wgpu::BindGroupLayout,
    pub raw_mask: wgpu::BindGroupLayout,
    pub masks: wgpu::BindGroupLayout,
}

/// Creates the pipeline of a full-screen pass without depth test; `entry` names the fragment entry point, and `target` is
/// a format, or also how to blend.
pub(crate) fn fullscreen(
    device: &wgpu::Device,
    (label, entry): (&str, &str),
    source: &str,
    layout: &wgpu::PipelineLayout,
    constants: &[(&str, f64)],
    target: impl Into<wgpu::ColorTargetState>,
) -> wgpu::RenderPipeline {
    let module = shaders::module(device, label, source);
    device.create_render_pipeline(&wgpu::RenderPipelineDescriptor {
        label: Some(label),
        layout: Some(layout),
        vertex: wgpu::VertexState {
            module: &module,
            entry_point: Some("vertex"),
            compilation_options: Default::default(),
            buffers: &[],
        },
        primitive: Default::default(),
        depth_stencil: None,
        multisample: Default::default(),
        fragment: Some(wgpu::FragmentState {
            module: &module,
            entry_point: Some(entry),
            compilation_options: wgpu::PipelineCompilationOptions { constants, ..Default::default() },
            targets: &[Some(target.into())],
        }),
        multiview_mask: None,
        cache: None,
    })
}

/// Creates a pipeline layout of bind groups 0, 1, ...
pub(crate) fn pipeline_layout(
    device: &wgpu::Device,
    label: &str,
    groups: &[&wgpu::BindGroupLayout],
) -> wgpu::PipelineLayout {
    let groups: Vec<_> = groups.iter().map(|group| Some(*group)).collect();
    device.create_pipeline_layout(&wgpu::PipelineLayoutDescriptor {
        label: Some(label),
        bind_group_layouts: &groups,
        ..Default::default()
    })
}

/// Returns a depth test that keeps the greater depth: depth is reversed, greater is nearer.
pub(crate) fn reversed_depth(format: wgpu::TextureFormat) -> wgpu::DepthStencilState {
    wgpu::DepthStencilState {
        format,
        depth_write_enabled: Some(true),
        depth_compare: Some(wgpu::CompareFunction::Greater),
        stencil: Default::default(),
        bias: Default::default(),
    }
}

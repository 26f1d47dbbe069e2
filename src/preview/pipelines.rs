//! The fixed list of pipelines. Constructors of pipelines are tables; they run long for that reason.

use super::mesh_cache::VERTEX_LAYOUT;
use super::targets::{DEPTH_FORMAT, GBUFFER_FORMAT, ID_FORMAT, Output};
use super::{shaders, shadow_maps};
use eframe::wgpu;

/// Layouts of the bind groups that the pipelines take.
pub(super) struct Layouts<'a> {
    pub scene: &'a wgpu::BindGroupLayout,
    pub texture: &'a wgpu::BindGroupLayout,
    pub gbuffer: &'a wgpu::BindGroupLayout,
    pub shadow_view: &'a wgpu::BindGroupLayout,
    pub shadow_maps: &'a wgpu::BindGroupLayout,
}

/// Pipelines that do not depend on the output's format.
#[derive(Debug)]
pub(super) struct GeometryPipelines {
    /// By `[textured][one-sided]`.
    pub geometry: [[wgpu::RenderPipeline; 2]; 2],
    pub shadow: wgpu::RenderPipeline,
}

/// Pipelines that write the picture.
#[derive(Debug)]
pub(super) struct PicturePipelines {
    pub lighting: wgpu::RenderPipeline,
}

impl GeometryPipelines {
    pub fn new(device: &wgpu::Device, layouts: &Layouts) -> Self {
        let module = shaders::module(device, "geometry", shaders::GEOMETRY);
        let layout = pipeline_layout(device, "geometry", &[layouts.scene, layouts.texture]);
        let geometry = |textured: bool, one_sided: bool| {
            device.create_render_pipeline(&wgpu::RenderPipelineDescriptor {
                label: Some("geometry"),
                layout: Some(&layout),
                vertex: mesh_vertices(&module),
                primitive: wgpu::PrimitiveState {
                    cull_mode: one_sided.then_some(wgpu::Face::Back),
                    ..Default::default()
                },
                depth_stencil: Some(nearer(DEPTH_FORMAT)),
                multisample: Default::default(),
                fragment: Some(wgpu::FragmentState {
                    module: &module,
                    entry_point: Some("fragment"),
                    compilation_options: wgpu::PipelineCompilationOptions {
                        constants: &[("TEXTURED", f64::from(u8::from(textured)))],
                        ..Default::default()
                    },
                    targets: &[Some(GBUFFER_FORMAT.into()), Some(ID_FORMAT.into())],
                }),
                multiview_mask: None,
                cache: None,
            })
        };
        let shadow_module = shaders::module(device, "shadow map", shaders::SHADOW_MAP);
        let shadow_layout = pipeline_layout(device, "shadow map", &[layouts.scene, layouts.shadow_view]);
        let shadow = device.create_render_pipeline(&wgpu::RenderPipelineDescriptor {
            label: Some("shadow map"),
            layout: Some(&shadow_layout),
            vertex: mesh_vertices(&shadow_module),
            primitive: Default::default(),
            depth_stencil: Some(nearer(shadow_maps::FORMAT)),
            multisample: Default::default(),
            fragment: None,
            multiview_mask: None,
            cache: None,
        });
        GeometryPipelines {
            geometry: [[geometry(false, false), geometry(false, true)], [geometry(true, false), geometry(true, true)]],
            shadow,
        }
    }
}

impl PicturePipelines {
    pub fn new(device: &wgpu::Device, layouts: &Layouts, output: Output) -> Self {
        let module = shaders::module(device, "lighting", shaders::LIGHTING);
        let layout = pipeline_layout(device, "lighting", &[layouts.scene, layouts.gbuffer, layouts.shadow_maps]);
        let constants = [("LINEAR", f64::from(u8::from(output == Output::Linear)))];
        let options = wgpu::PipelineCompilationOptions { constants: &constants, ..Default::default() };
        let lighting = device.create_render_pipeline(&wgpu::RenderPipelineDescriptor {
            label: Some("lighting"),
            layout: Some(&layout),
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
                entry_point: Some("fragment"),
                compilation_options: options,
                targets: &[Some(output.format().into())],
            }),
            multiview_mask: None,
            cache: None,
        });
        PicturePipelines { lighting }
    }
}

fn pipeline_layout(device: &wgpu::Device, label: &str, groups: &[&wgpu::BindGroupLayout]) -> wgpu::PipelineLayout {
    let groups: Vec<_> = groups.iter().map(|group| Some(*group)).collect();
    device.create_pipeline_layout(&wgpu::PipelineLayoutDescriptor {
        label: Some(label),
        bind_group_layouts: &groups,
        ..Default::default()
    })
}

fn mesh_vertices(module: &wgpu::ShaderModule) -> wgpu::VertexState<'_> {
    wgpu::VertexState {
        module,
        entry_point: Some("vertex"),
        compilation_options: Default::default(),
        buffers: &[Some(VERTEX_LAYOUT)],
    }
}

/// Reversed depth: greater is nearer.
fn nearer(format: wgpu::TextureFormat) -> wgpu::DepthStencilState {
    wgpu::DepthStencilState {
        format,
        depth_write_enabled: Some(true),
        depth_compare: Some(wgpu::CompareFunction::Greater),
        stencil: Default::default(),
        bias: Default::default(),
    }
}

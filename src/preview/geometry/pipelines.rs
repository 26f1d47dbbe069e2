//! Pipelines of the geometry pass. Constructors of pipelines are tables; they run long for that reason.

use super::draw_item::Sides;
use super::mesh_cache::VERTEX_LAYOUT;
use crate::preview::gpu::pipeline::{BindGroupLayouts, pipeline_layout, reversed_depth};
use crate::preview::shaders;
use crate::preview::targets::{DEPTH_FORMAT, GBUFFER_FORMAT, ID_FORMAT};
use eframe::wgpu;

/// Factor of the room's depth (near over distance), so that paper that lies on its floor wins the depth test. Not a
/// depth bias: its unit depends on the nearest corner of a triangle, and a floor that runs under the camera would sink
/// by decimetres.
const BEHIND_COPLANAR: f64 = 1.0 - 1e-4;

/// The pipelines of the geometry pass: untextured and textured, each by `Sides`.
#[derive(Debug)]
pub(crate) struct GeometryPipelines([[wgpu::RenderPipeline; 4]; 2]);

impl GeometryPipelines {
    pub fn new(device: &wgpu::Device, layouts: &BindGroupLayouts) -> Self {
        let module = shaders::module(device, "geometry", shaders::GEOMETRY);
        let layout = pipeline_layout(device, "geometry", &[&layouts.scene, &layouts.draw, &layouts.texture]);
        let geometry = |textured: bool, sides: Sides| {
            device.create_render_pipeline(&wgpu::RenderPipelineDescriptor {
                label: Some("geometry"),
                layout: Some(&layout),
                vertex: wgpu::VertexState {
                    compilation_options: wgpu::PipelineCompilationOptions {
                        constants: &[("DEPTH_FACTOR", if sides == Sides::Room { BEHIND_COPLANAR } else { 1.0 })],
                        ..Default::default()
                    },
                    ..mesh_vertices(&module)
                },
                primitive: wgpu::PrimitiveState { cull_mode: sides.cull_mode(), ..Default::default() },
                depth_stencil: Some(reversed_depth(DEPTH_FORMAT)),
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
        GeometryPipelines([false, true].map(|textured| Sides::ALL.map(|sides| geometry(textured, sides))))
    }

    /// Returns the pipeline that draws a run of triangles into the G-buffer.
    pub fn get(&self, textured: bool, sides: Sides) -> &wgpu::RenderPipeline {
        &self.0[usize::from(textured)][sides as usize]
    }
}

/// Returns the vertex state of meshes: entry point `vertex`, one vertex buffer.
pub(crate) fn mesh_vertices(module: &wgpu::ShaderModule) -> wgpu::VertexState<'_> {
    wgpu::VertexState {
        module,
        entry_point: Some("vertex"),
        compilation_options: Default::default(),
        buffers: &[Some(VERTEX_LAYOUT)],
    }
}

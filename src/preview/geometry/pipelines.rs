//! Pipelines of the geometry pass. Constructors of pipelines are tables; they run long for that reason.

use super::draw_item::{DrawItem, Sides};
use super::mesh_cache::VERTEX_LAYOUT;
use super::texture_cache::TextureKey;
use crate::preview::gpu::pipeline::{BindGroupLayouts, pipeline_layout, reversed_depth};
use crate::preview::shaders;
use crate::preview::targets::{DEPTH_FORMAT, GBUFFER_FORMAT, ID_FORMAT};
use eframe::wgpu;

/// Factor of the room's depth (near over distance), so that paper that lies on its floor wins the depth test. Not a
/// depth bias: its unit depends on the nearest corner of a triangle, and a floor that runs under the camera would sink
/// by decimetres.
const BEHIND_COPLANAR: f64 = 1.0 - 1e-4;

/// What the geometry pass samples.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Sampled {
    /// No texture.
    Nothing = 0,
    /// The texture of the base colour.
    BaseColor = 1,
    /// All textures.
    Everything = 2,
    /// All textures; what is not there is discarded.
    Holes = 3,
}

impl Sampled {
    /// All variants, in the order of their values.
    const ALL: [Sampled; 4] = [Sampled::Nothing, Sampled::BaseColor, Sampled::Everything, Sampled::Holes];

    /// Returns what is sampled for an item.
    pub fn of(item: &DrawItem) -> Self {
        let [base_color, others @ ..] = &item.textures;
        match (item.has_holes, item.has_dome || others.iter().any(TextureKey::is_texture)) {
            (true, _) => Sampled::Holes,
            (false, true) => Sampled::Everything,
            (false, false) if base_color.is_texture() => Sampled::BaseColor,
            (false, false) => Sampled::Nothing,
        }
    }

    /// Returns the constants of the fragment shader.
    fn constants(self) -> [(&'static str, f64); 2] {
        let textures = (self as u32).min(Sampled::Everything as u32);
        [("TEXTURES", textures.into()), ("HOLES", f64::from(u8::from(self == Sampled::Holes)))]
    }
}

/// The pipelines of the geometry pass: by what they sample, each by `Sides`.
#[derive(Debug)]
pub(crate) struct GeometryPipelines([[wgpu::RenderPipeline; 4]; 4]);

impl GeometryPipelines {
    pub fn new(device: &wgpu::Device, layouts: &BindGroupLayouts) -> Self {
        let module = shaders::module(device, "geometry", shaders::GEOMETRY);
        let layout = pipeline_layout(device, "geometry", &[&layouts.scene, &layouts.draw, &layouts.texture]);
        let geometry = |sampled: Sampled, sides: Sides| {
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
                        constants: &sampled.constants(),
                        ..Default::default()
                    },
                    targets: &[Some(GBUFFER_FORMAT.into()), Some(ID_FORMAT.into())],
                }),
                multiview_mask: None,
                cache: None,
            })
        };
        GeometryPipelines(Sampled::ALL.map(|sampled| Sides::ALL.map(|sides| geometry(sampled, sides))))
    }

    /// Returns the pipeline that draws a run of triangles into the G-buffer.
    pub fn get(&self, sampled: Sampled, sides: Sides) -> &wgpu::RenderPipeline {
        &self.0[sampled as usize][sides as usize]
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

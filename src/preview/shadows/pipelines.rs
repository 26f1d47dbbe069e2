//! Pipelines of the shadow maps and the shadow masks.

use super::maps::{self, MapSide};
use super::mask;
use crate::preview::geometry::draw_item::ShadowCasting;
use crate::preview::geometry::pipelines::mesh_vertices;
use crate::preview::gpu::pipeline::{BindGroupLayouts, fullscreen, pipeline_layout, reversed_depth};
use crate::preview::shaders;
use eframe::wgpu;

/// The pipelines of all shadow passes.
#[derive(Debug)]
pub(crate) struct ShadowPipelines {
    /// Shadow maps without face culling, with front faces culled, with back faces culled.
    map: [wgpu::RenderPipeline; 3],
    /// Shadow maps of masked and blended surfaces, without face culling.
    map_with_holes: wgpu::RenderPipeline,
    /// Raw masks, by whether an emitter is subdivided.
    pub raw_mask: [wgpu::RenderPipeline; 2],
    pub mask_blur: wgpu::RenderPipeline,
}

impl ShadowPipelines {
    pub fn new(device: &wgpu::Device, layouts: &BindGroupLayouts) -> Self {
        let module = shaders::module(device, "shadow map", shaders::SHADOW_MAP);
        let layout = pipeline_layout(device, "shadow map", &[&layouts.scene, &layouts.draw, &layouts.shadow_view]);
        let map = |cull_mode| {
            device.create_render_pipeline(&wgpu::RenderPipelineDescriptor {
                label: Some("shadow map"),
                layout: Some(&layout),
                vertex: mesh_vertices(&module),
                primitive: wgpu::PrimitiveState { cull_mode, ..Default::default() },
                depth_stencil: Some(reversed_depth(maps::FORMAT)),
                multisample: Default::default(),
                fragment: None,
                multiview_mask: None,
                cache: None,
            })
        };
        let map_with_holes = map_with_holes(device, layouts);
        let raw_groups = [&layouts.scene, &layouts.gbuffer, &layouts.shadow_maps, &layouts.shadow_slots];
        let blur_groups = [&layouts.scene, &layouts.gbuffer, &layouts.raw_mask];
        let fullscreen = |label, source, groups: &[_], constants: &[_]| {
            let layout = pipeline_layout(device, label, groups);
            fullscreen(device, (label, "fragment"), source, &layout, constants, mask::FORMAT)
        };
        let raw =
            |subdivided| fullscreen("shadow mask", shaders::SHADOW_MASK, &raw_groups, &[("SUBDIVIDED", subdivided)]);
        ShadowPipelines {
            map_with_holes,
            map: [map(None), map(Some(wgpu::Face::Front)), map(Some(wgpu::Face::Back))],
            raw_mask: [raw(0.0), raw(1.0)],
            mask_blur: fullscreen("shadow blur", shaders::SHADOW_BLUR, &blur_groups, &[]),
        }
    }

    /// Returns the pipeline that draws a run of triangles into one side of a shadow map; none if it casts no shadow.
    pub fn map(&self, caster: ShadowCasting, has_holes: bool, side: MapSide) -> Option<&wgpu::RenderPipeline> {
        match (caster, side) {
            (ShadowCasting::None, _) => None,
            _ if has_holes => Some(&self.map_with_holes),
            (ShadowCasting::Sheet, _) | (_, MapSide::Near) => Some(&self.map[0]),
            (ShadowCasting::Solid, MapSide::Far) => Some(&self.map[1]),
            (ShadowCasting::MirroredSolid, MapSide::Far) => Some(&self.map[2]),
        }
    }
}

fn map_with_holes(device: &wgpu::Device, layouts: &BindGroupLayouts) -> wgpu::RenderPipeline {
    let module = shaders::module(device, "shadow map with holes", shaders::SHADOW_HOLES);
    let groups = [&layouts.scene, &layouts.draw, &layouts.shadow_view, &layouts.texture];
    device.create_render_pipeline(&wgpu::RenderPipelineDescriptor {
        label: Some("shadow map with holes"),
        layout: Some(&pipeline_layout(device, "shadow map with holes", &groups)),
        vertex: wgpu::VertexState { entry_point: Some("vertex_with_holes"), ..mesh_vertices(&module) },
        primitive: Default::default(),
        depth_stencil: Some(reversed_depth(maps::FORMAT)),
        multisample: Default::default(),
        fragment: Some(wgpu::FragmentState {
            module: &module,
            entry_point: Some("fragment_with_holes"),
            compilation_options: Default::default(),
            targets: &[],
        }),
        multiview_mask: None,
        cache: None,
    })
}

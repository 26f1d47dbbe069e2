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
        let raw_groups = [&layouts.scene, &layouts.gbuffer, &layouts.shadow_maps, &layouts.shadow_slots];
        let blur_groups = [&layouts.scene, &layouts.gbuffer, &layouts.raw_mask];
        let fullscreen = |label, source, groups: &[_], constants: &[_]| {
            let layout = pipeline_layout(device, label, groups);
            fullscreen(device, (label, "fragment"), source, &layout, constants, mask::FORMAT)
        };
        let raw =
            |subdivided| fullscreen("shadow mask", shaders::SHADOW_MASK, &raw_groups, &[("SUBDIVIDED", subdivided)]);
        ShadowPipelines {
            map: [map(None), map(Some(wgpu::Face::Front)), map(Some(wgpu::Face::Back))],
            raw_mask: [raw(0.0), raw(1.0)],
            mask_blur: fullscreen("shadow blur", shaders::SHADOW_BLUR, &blur_groups, &[]),
        }
    }

    /// Returns the pipeline that draws a run of triangles into one side of a shadow map; none if it casts no shadow.
    pub fn map(&self, caster: ShadowCasting, side: MapSide) -> Option<&wgpu::RenderPipeline> {
        match (caster, side) {
            (ShadowCasting::None, _) => None,
            (ShadowCasting::Sheet, _) | (_, MapSide::Near) => Some(&self.map[0]),
            (ShadowCasting::Solid, MapSide::Far) => Some(&self.map[1]),
            (ShadowCasting::MirroredSolid, MapSide::Far) => Some(&self.map[2]),
        }
    }
}

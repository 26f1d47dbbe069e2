//! The passes of a frame, each by itself. Which of them a frame needs, and in which order, says the renderer.

use super::PreviewRenderer;
use crate::preview::PreviewInput;
use crate::preview::channel::{Channel, Gloss};
use crate::preview::geometry::clusters::Eye;
use crate::preview::geometry::draw_list::{DrawItem, DrawList, Pass};
use crate::preview::geometry::draw_uniforms::DrawUniforms;
use crate::preview::geometry::mesh_cache::GpuMesh;
use crate::preview::geometry::texture_cache::{TextureCache, WHITE};
use crate::preview::lights::light_table::LightTable;
use crate::preview::lights::lighting_pass::LightingInput;
use crate::preview::overlay::gizmo::Gizmos;
use crate::preview::pipelines::{Layouts, LightingVariant, Sides};
use crate::preview::scene_buffers::{NEAR_M, SceneBuffers};
use crate::preview::shadows::maps::{ShadowMaps, Side};
use crate::preview::shadows::mask::ShadowMasks;
use crate::preview::targets::{Output, TargetLayouts};
use crate::scene::CameraFrame;
use eframe::wgpu;
use glam::Mat4;

/// The layouts of a renderer's resources. A method would borrow all of it, and its pipelines could not be added to.
macro_rules! layouts_of {
    ($of:ident) => {
        layouts(&$of.buffers, &$of.textures, &$of.draws, &$of.target_layouts, &$of.shadow_maps, &$of.shadow_masks)
    };
}

impl PreviewRenderer {
    pub(super) fn shadow_pass(
        &self,
        encoder: &mut wgpu::CommandEncoder,
        items: &[&DrawItem],
        layer: usize,
        side: Side,
    ) {
        let mut pass = self.shadow_maps.begin_pass(encoder, layer, side);
        pass.set_bind_group(0, self.buffers.bind_group(), &[]);
        for item in items {
            if let Some(pipeline) = self.geometry.shadow(item.shadow, side) {
                pass.set_pipeline(pipeline);
                self.draw_item(&mut pass, item);
            }
        }
    }

    pub(super) fn geometry_pass(&self, encoder: &mut wgpu::CommandEncoder, list: &DrawList, camera: &CameraFrame) {
        let clear = wgpu::LoadOp::Clear(wgpu::Color::TRANSPARENT);
        // Where nothing is, the id says so and nobody looks at the G-buffer: what clears bytes one by one need not.
        let load = if self.on_processor { wgpu::LoadOp::Load } else { clear };
        let attachment = |view, load| {
            Some(wgpu::RenderPassColorAttachment {
                view,
                depth_slice: None,
                resolve_target: None,
                ops: wgpu::Operations { load, store: wgpu::StoreOp::Store },
            })
        };
        let mut pass = encoder.begin_render_pass(&wgpu::RenderPassDescriptor {
            label: Some("geometry"),
            color_attachments: &[attachment(&self.targets.gbuffer, load), attachment(&self.targets.ids_view, clear)],
            depth_stencil_attachment: Some(wgpu::RenderPassDepthStencilAttachment {
                view: &self.targets.depth,
                depth_ops: Some(wgpu::Operations { load: wgpu::LoadOp::Clear(0.0), store: wgpu::StoreOp::Store }),
                stencil_ops: None,
            }),
            ..Default::default()
        });
        pass.set_bind_group(0, self.buffers.bind_group(), &[]);
        let clip_from_world = camera.clip_from_world(NEAR_M);
        for item in list.items.iter().filter(|item| item.pass != Pass::Glass) {
            let sides = list.sides(item, camera.position());
            pass.set_pipeline(self.geometry.geometry(item.texture != WHITE, sides));
            pass.set_bind_group(2, self.textures.get(item.texture), &[]);
            let world_from_object = list.places[item.record as usize];
            let clip_from_object = clip_from_world * Mat4::from(world_from_object);
            let position = world_from_object.inverse().transform_point3(camera.position());
            let front_only = matches!(sides, Sides::Front | Sides::Back);
            self.draw_seen(&mut pass, item, &Eye::new(position, clip_from_object, front_only));
        }
    }

    pub(super) fn glass_pass(
        &mut self,
        encoder: &mut wgpu::CommandEncoder,
        list: &DrawList,
        table: &LightTable,
        output: Output,
    ) {
        let families = table.families();
        let (masks, scale, reach, listed, beams) = (0, 1, false, false, true);
        let (cells, illuminance, gloss) = (false, false, Gloss::Ggx);
        let variant =
            LightingVariant { output, families, masks, scale, reach, listed, beams, cells, illuminance, gloss };
        let layouts = layouts_of!(self);
        let mut draws = Vec::new();
        for item in list.items.iter().filter(|item| item.pass == Pass::Glass) {
            for (left, sides) in (0..item.glass.len()).rev().zip(item.glass) {
                let pipeline = self.lighting.glass(&self.device, &layouts, variant, (*sides, left > 0));
                draws.push((item, pipeline.clone()));
            }
        }
        let keep = |view| {
            Some(wgpu::RenderPassColorAttachment {
                view,
                depth_slice: None,
                resolve_target: None,
                ops: wgpu::Operations { load: wgpu::LoadOp::Load, store: wgpu::StoreOp::Store },
            })
        };
        let mut pass = encoder.begin_render_pass(&wgpu::RenderPassDescriptor {
            label: Some("glass"),
            color_attachments: &[keep(&self.targets.color_view), keep(&self.targets.ids_view)],
            depth_stencil_attachment: Some(wgpu::RenderPassDepthStencilAttachment {
                view: &self.targets.depth,
                depth_ops: Some(wgpu::Operations { load: wgpu::LoadOp::Load, store: wgpu::StoreOp::Store }),
                stencil_ops: None,
            }),
            ..Default::default()
        });
        pass.set_bind_group(0, self.buffers.bind_group(), &[]);
        for (item, pipeline) in &draws {
            pass.set_pipeline(pipeline);
            self.draw_item(&mut pass, item);
        }
    }

    pub(super) fn overlay_pass(&mut self, encoder: &mut wgpu::CommandEncoder, input: &PreviewInput, list: &DrawList) {
        let gizmos = Gizmos::new(input.scene, &input.overlay, &input.frame);
        let outlined = self.overlay.outlined_area(&input.frame, self.targets.size, &list.outlined);
        if outlined.is_some() || !gizmos.lines.is_empty() {
            self.overlay.upload(&self.device, &self.queue, &gizmos);
            self.overlay.draw(encoder, &self.targets, self.buffers.bind_group(), outlined);
        }
        self.gizmos = gizmos;
    }

    pub(super) fn mask_passes(&self, encoder: &mut wgpu::CommandEncoder, raw: &wgpu::RenderPipeline, mask: usize) {
        let mut pass = self.shadow_masks.begin_raw(encoder, mask);
        pass.set_pipeline(raw);
        pass.set_bind_group(0, self.buffers.bind_group(), &[]);
        pass.set_bind_group(1, &self.targets.lookup, &[]);
        pass.set_bind_group(2, self.shadow_maps.lookup(), &[]);
        pass.draw(0..3, 0..1);
        drop(pass);
        let mut pass = self.shadow_masks.begin_blur(encoder, mask);
        pass.set_pipeline(&self.masking.blur);
        pass.set_bind_group(0, self.buffers.bind_group(), &[]);
        pass.set_bind_group(1, &self.targets.lookup, &[]);
        pass.draw(0..3, 0..1);
    }

    pub(super) fn lighting_pass(
        &mut self,
        encoder: &mut wgpu::CommandEncoder,
        variant: LightingVariant,
        cell_scale: u32,
    ) {
        let layouts = layouts_of!(self);
        let input = LightingInput {
            scene: self.buffers.bind_group(),
            targets: &self.targets,
            masks: self.shadow_masks.lookup(),
            cell_scale,
        };
        self.lighting.draw(&self.device, &layouts, encoder, &input, variant);
    }

    pub(super) fn channel_pass(&mut self, encoder: &mut wgpu::CommandEncoder, channel: Channel) {
        let layouts = layouts_of!(self);
        let inputs = (self.buffers.bind_group(), &self.targets);
        self.lighting.draw_channel(&self.device, &layouts, encoder, inputs, channel);
    }

    fn draw_item(&self, pass: &mut wgpu::RenderPass, item: &DrawItem) {
        if self.bind_item(pass, item).is_some() {
            pass.draw_indexed(item.indices.clone(), 0, 0..1);
        }
    }

    /// The same without clusters that cannot be seen.
    fn draw_seen(&self, pass: &mut wgpu::RenderPass, item: &DrawItem, eye: &Eye) {
        let Some(mesh) = self.bind_item(pass, item) else { return };
        for run in eye.visible(mesh.clusters(&item.indices)) {
            pass.draw_indexed(run, 0, 0..1);
        }
    }

    fn bind_item(&self, pass: &mut wgpu::RenderPass, item: &DrawItem) -> Option<&GpuMesh> {
        let mesh = self.meshes.get(item.mesh)?;
        self.draws.bind(pass, item.record);
        pass.set_vertex_buffer(0, mesh.vertices.slice(..));
        pass.set_index_buffer(mesh.indices.slice(..), wgpu::IndexFormat::Uint32);
        Some(mesh)
    }
}

pub(super) fn layouts<'a>(
    buffers: &'a SceneBuffers,
    textures: &'a TextureCache,
    draws: &'a DrawUniforms,
    targets: &'a TargetLayouts,
    shadow_maps: &'a ShadowMaps,
    shadow_masks: &'a ShadowMasks,
) -> Layouts<'a> {
    Layouts {
        scene: buffers.layout(),
        texture: textures.layout(),
        draw: draws.layout(),
        gbuffer: &targets.gbuffer,
        cells: &targets.cells,
        shadow_view: shadow_maps.view_layout(),
        shadow_maps: shadow_maps.lookup_layout(),
        shadow_slots: shadow_masks.slots_layout(),
        raw_mask: shadow_masks.raw_layout(),
        masks: shadow_masks.masks_layout(),
    }
}

//! The glass pass: clear glass and water, forward-shaded and blended over the lit picture.

use super::lighting_pass::LightingPasses;
use super::pipelines::LightingVariant;
use crate::preview::channel::Gloss;
use crate::preview::frame_resources::FrameResources;
use crate::preview::geometry::draw_item::DrawPass;
use crate::preview::geometry::draw_list::DrawList;
use crate::preview::gpu::bindings::{color_attachment, depth_attachment};
use eframe::wgpu;

/// Draws the glass items of a list, lit by the kinds of lights that `light_kinds` marks as present.
pub(crate) fn draw(
    device: &wgpu::Device,
    encoder: &mut wgpu::CommandEncoder,
    passes: &mut LightingPasses,
    resources: FrameResources,
    list: &DrawList,
    light_kinds: [bool; 4],
) {
    let FrameResources { scene, targets, caches } = resources;
    let variant = LightingVariant {
        output: targets.output,
        light_kinds,
        masks: 0,
        mask_scale: 1,
        light_radius: false,
        tiled: false,
        has_beams: true,
        coarse: false,
        illuminance: false,
        gloss: Gloss::Ggx,
        has_fibres: false,
        has_layers: false,
        has_relief: false,
    };
    let mut draws = Vec::new();
    for item in list.items.iter().filter(|item| item.pass == DrawPass::Glass) {
        for (remaining, sides) in (0..item.glass_sides.len()).rev().zip(item.glass_sides) {
            draws.push((item, passes.glass(device, variant, *sides, remaining > 0).clone()));
        }
    }
    let mut pass = encoder.begin_render_pass(&wgpu::RenderPassDescriptor {
        label: Some("glass"),
        color_attachments: &[
            color_attachment(&targets.color_view, wgpu::LoadOp::Load),
            color_attachment(&targets.ids_view, wgpu::LoadOp::Load),
        ],
        depth_stencil_attachment: depth_attachment(&targets.depth, wgpu::LoadOp::Load),
        ..Default::default()
    });
    pass.set_bind_group(0, scene, &[]);
    for (item, pipeline) in &draws {
        pass.set_pipeline(pipeline);
        caches.draw(&mut pass, item);
    }
}

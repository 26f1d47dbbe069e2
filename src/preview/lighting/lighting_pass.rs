//! The lighting pass over the G-buffer: at full resolution, or for drafts one pixel of each coarse pixel, upsampled
//! along surfaces by the resolve pass.

use super::pipelines::{self, LightingVariant};
use crate::preview::channel::Channel;
use crate::preview::frame_resources::FrameResources;
use crate::preview::geometry::draw_item::Sides;
use crate::preview::gpu::bindings::color_attachment;
use crate::preview::gpu::pipeline::BindGroupLayouts;
use crate::preview::targets::Output;
use eframe::wgpu;
use std::collections::HashMap;

/// Pipelines of the lighting passes, compiled on first use.
#[derive(Debug)]
pub(crate) struct LightingPasses {
    layouts: BindGroupLayouts,
    lighting: HashMap<LightingVariant, wgpu::RenderPipeline>,
    glass: HashMap<(LightingVariant, (Sides, bool)), wgpu::RenderPipeline>,
    /// For pictures and for illuminance.
    resolve: [wgpu::RenderPipeline; 2],
    diffusion: HashMap<Output, wgpu::RenderPipeline>,
    channels: HashMap<(Channel, Output), wgpu::RenderPipeline>,
}

impl LightingPasses {
    pub fn new(device: &wgpu::Device, layouts: BindGroupLayouts) -> Self {
        let resolve = [false, true].map(|illuminance| pipelines::resolve(device, &layouts, illuminance));
        LightingPasses {
            layouts,
            lighting: HashMap::new(),
            glass: HashMap::new(),
            resolve,
            diffusion: HashMap::new(),
            channels: HashMap::new(),
        }
    }

    /// Returns the pipeline that draws these sides of glass over the lit picture. `inner` sides are seen through
    /// others.
    pub fn glass(
        &mut self,
        device: &wgpu::Device,
        variant: LightingVariant,
        sides: Sides,
        inner: bool,
    ) -> &wgpu::RenderPipeline {
        let make = || pipelines::glass(device, &self.layouts, &variant, (sides, inner));
        self.glass.entry((variant, (sides, inner))).or_insert_with(make)
    }

    /// Lights the picture. `coarse_scale` is the side of a coarse pixel in picture pixels: 1 for the diffusion pass, at
    /// least 2 for drafts.
    pub fn draw(
        &mut self,
        device: &wgpu::Device,
        encoder: &mut wgpu::CommandEncoder,
        resources: FrameResources,
        masks: &wgpu::BindGroup,
        variant: LightingVariant,
        coarse_scale: u32,
    ) {
        let FrameResources { scene, targets, .. } = resources;
        let make = || pipelines::lighting(device, &self.layouts, &variant);
        let lighting = self.lighting.entry(variant).or_insert_with(make);
        // Shade the G-buffer into the picture, or one pixel of each coarse pixel into the coarse target
        let target = if variant.coarse { &targets.coarse } else { &targets.color_view };
        let side = if variant.coarse { coarse_scale } else { 1 };
        let area = (targets.size.0.div_ceil(side), targets.size.1.div_ceil(side));
        fullscreen_pass(encoder, "lighting", (target, area), lighting, [scene, &targets.gbuffer_group, masks]);
        // Upsample the coarse target to the picture, or spread its light under soft surfaces
        if variant.coarse {
            let groups = [scene, &targets.gbuffer_group, &targets.coarse_group];
            let (label, pipeline) = if coarse_scale == 1 {
                let make = || pipelines::diffusion(device, &self.layouts, variant.output);
                ("diffusion", &*self.diffusion.entry(variant.output).or_insert_with(make))
            } else {
                ("resolve", &self.resolve[usize::from(variant.illuminance)])
            };
            fullscreen_pass(encoder, label, (&targets.color_view, targets.size), pipeline, groups);
        }
    }

    /// Draws one channel of the G-buffer to the picture.
    pub fn draw_channel(
        &mut self,
        device: &wgpu::Device,
        encoder: &mut wgpu::CommandEncoder,
        resources: FrameResources,
        channel: Channel,
    ) {
        let FrameResources { scene, targets, .. } = resources;
        let output = targets.output;
        let make = || pipelines::channel(device, &self.layouts, channel, output);
        let pipeline = self.channels.entry((channel, output)).or_insert_with(make);
        let picture = (&targets.color_view, targets.size);
        fullscreen_pass(encoder, "channel", picture, pipeline, [scene, &targets.gbuffer_group]);
    }
}

fn fullscreen_pass<const GROUPS: usize>(
    encoder: &mut wgpu::CommandEncoder,
    label: &str,
    (view, area): (&wgpu::TextureView, (u32, u32)),
    pipeline: &wgpu::RenderPipeline,
    groups: [&wgpu::BindGroup; GROUPS],
) {
    let mut pass = encoder.begin_render_pass(&wgpu::RenderPassDescriptor {
        label: Some(label),
        color_attachments: &[color_attachment(view, wgpu::LoadOp::Clear(wgpu::Color::BLACK))],
        ..Default::default()
    });
    pass.set_pipeline(pipeline);
    for (index, group) in (0..).zip(groups) {
        pass.set_bind_group(index, group, &[]);
    }
    pass.set_viewport(0.0, 0.0, area.0 as f32, area.1 as f32, 0.0, 1.0);
    pass.draw(0..3, 0..1);
}

//! The passes that light the G-buffer: in full, or as a draft that lights one pixel of each cell and spreads the light.

use crate::preview::channel::Channel;
use crate::preview::pipelines::{self, Layouts, LightingVariant, Sides};
use crate::preview::targets::{Output, Targets};
use eframe::wgpu;
use std::collections::HashMap;

/// Pipelines of the lighting passes, compiled when a scene first needs them.
#[derive(Debug)]
pub(crate) struct LightingPasses {
    lighting: HashMap<LightingVariant, wgpu::RenderPipeline>,
    glass: HashMap<(LightingVariant, (Sides, bool)), wgpu::RenderPipeline>,
    /// Of pictures and of illuminance.
    resolve: [wgpu::RenderPipeline; 2],
    channels: HashMap<(Channel, Output), wgpu::RenderPipeline>,
}

/// What the lighting passes read.
pub(crate) struct LightingInput<'a> {
    pub scene: &'a wgpu::BindGroup,
    pub targets: &'a Targets,
    pub masks: &'a wgpu::BindGroup,
    /// Picture pixels a cell of a draft, along each side: at least two.
    pub cell_scale: u32,
}

impl LightingPasses {
    pub fn new(device: &wgpu::Device, layouts: &Layouts) -> Self {
        let resolve = [false, true].map(|illuminance| pipelines::resolve(device, layouts, illuminance));
        LightingPasses { lighting: HashMap::new(), glass: HashMap::new(), resolve, channels: HashMap::new() }
    }

    /// The pipeline that draws these sides of glass over the lit picture, as the far sides of a body or as what is seen
    /// first.
    pub fn glass(
        &mut self,
        device: &wgpu::Device,
        layouts: &Layouts,
        variant: LightingVariant,
        sides: (Sides, bool),
    ) -> &wgpu::RenderPipeline {
        let make = || pipelines::glass(device, layouts, &variant, sides);
        self.glass.entry((variant, sides)).or_insert_with(make)
    }

    /// Lights the picture as the variant says.
    pub fn draw(
        &mut self,
        device: &wgpu::Device,
        layouts: &Layouts,
        encoder: &mut wgpu::CommandEncoder,
        input: &LightingInput,
        variant: LightingVariant,
    ) {
        let lighting = self.lighting.entry(variant).or_insert_with(|| pipelines::lighting(device, layouts, &variant));
        let target = if variant.cells { &input.targets.cells } else { &input.targets.color_view };
        let (width, height) = input.targets.size;
        let side = if variant.cells { input.cell_scale } else { 1 };
        let area = (width.div_ceil(side), height.div_ceil(side));
        let groups = [input.scene, &input.targets.lookup, input.masks];
        fullscreen_pass(encoder, "lighting", (target, area), lighting, groups);
        if variant.cells {
            let resolve = &self.resolve[usize::from(variant.illuminance)];
            let groups = [input.scene, &input.targets.lookup, &input.targets.cells_lookup];
            fullscreen_pass(encoder, "resolve", (&input.targets.color_view, input.targets.size), resolve, groups);
        }
    }

    /// Shows one channel of the G-buffer.
    pub fn draw_channel(
        &mut self,
        device: &wgpu::Device,
        layouts: &Layouts,
        encoder: &mut wgpu::CommandEncoder,
        (scene, targets): (&wgpu::BindGroup, &Targets),
        channel: Channel,
    ) {
        let output = targets.output;
        let make = || pipelines::channel(device, layouts, channel, output);
        let pipeline = self.channels.entry((channel, output)).or_insert_with(make);
        let whole = (&targets.color_view, targets.size);
        fullscreen_pass(encoder, "channel", whole, pipeline, [scene, &targets.lookup]);
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
        color_attachments: &[Some(wgpu::RenderPassColorAttachment {
            view,
            depth_slice: None,
            resolve_target: None,
            ops: wgpu::Operations { load: wgpu::LoadOp::Clear(wgpu::Color::BLACK), store: wgpu::StoreOp::Store },
        })],
        ..Default::default()
    });
    pass.set_pipeline(pipeline);
    for (index, group) in (0..).zip(groups) {
        pass.set_bind_group(index, group, &[]);
    }
    pass.set_viewport(0.0, 0.0, area.0 as f32, area.1 as f32, 0.0, 1.0);
    pass.draw(0..3, 0..1);
}

//! The average of several pictures of a still view, each through other points of its pixels and with other strands: its
//! edges are smooth, and hair thinner than a pixel is soft.
//!
//! The average is of linear display values, after the tone curve.

use super::gpu::bindings::{color_attachment, texture_group, texture_layout};
use super::gpu::pipeline::{fullscreen, pipeline_layout};
use super::shaders;
use super::targets::{Output, RenderTargets, Targets};
use eframe::wgpu;

/// Format of the average.
const AVERAGE_FORMAT: wgpu::TextureFormat = wgpu::TextureFormat::Rgba16Float;

/// The passes of still pictures, and the average of the last one.
#[derive(Debug)]
pub(crate) struct StillPictures {
    layout: wgpu::BindGroupLayout,
    /// Adds a picture to the average, with the blend constant as its weight.
    add: wgpu::RenderPipeline,
    /// Writes the average as a picture.
    show: wgpu::RenderPipeline,
    average: Option<Average>,
}

/// The average of pictures of one size.
#[derive(Debug)]
struct Average {
    /// Generation of the targets that it belongs to.
    generation: u64,
    view: wgpu::TextureView,
    /// Reads the average.
    group: wgpu::BindGroup,
    /// Reads the picture.
    picture_group: wgpu::BindGroup,
}

impl StillPictures {
    /// Compiles the pipelines.
    pub fn new(device: &wgpu::Device) -> Self {
        let sample_type = wgpu::TextureSampleType::Float { filterable: false };
        let layout = texture_layout(device, "still picture", sample_type, wgpu::TextureViewDimension::D2, 1);
        let pipelines = pipeline_layout(device, "still picture", &[&layout]);
        let weighted = wgpu::BlendComponent {
            src_factor: wgpu::BlendFactor::Constant,
            dst_factor: wgpu::BlendFactor::OneMinusConstant,
            operation: wgpu::BlendOperation::Add,
        };
        let blend = wgpu::BlendState { color: weighted, alpha: weighted };
        let pipeline = |label, encodes: bool, format, blend| {
            let constants = [("ENCODES", f64::from(u8::from(encodes)))];
            let target = wgpu::ColorTargetState { format, blend, write_mask: wgpu::ColorWrites::ALL };
            fullscreen(device, (label, "fragment"), shaders::STILL, &pipelines, &constants, target)
        };
        StillPictures {
            add: pipeline("still picture, sum", false, AVERAGE_FORMAT, Some(blend)),
            show: pipeline("still picture", true, Output::Display.format(), None),
            layout,
            average: None,
        }
    }

    /// Starts the average with the picture that the targets hold: sample 0, before sample 1 is drawn over it.
    pub fn start(&mut self, device: &wgpu::Device, encoder: &mut wgpu::CommandEncoder, targets: &RenderTargets) {
        if self.average.as_ref().is_none_or(|average| average.generation != targets.generation) {
            self.average = Some(Average::new(device, &self.layout, &targets.current, targets.generation));
        }
        self.add(encoder, 1.0);
    }

    /// Adds the picture that has just been drawn as sample number `sample`, from 1 on, and replaces it by the average.
    /// Does nothing if the average is of targets that were replaced since.
    pub fn add_and_show(&self, encoder: &mut wgpu::CommandEncoder, targets: &RenderTargets, sample: u32) {
        if self.average.as_ref().is_none_or(|average| average.generation != targets.generation) {
            return;
        }
        self.add(encoder, 1.0 / f64::from(sample + 1));
        if let Some(average) = &self.average {
            draw(encoder, &self.show, &average.group, &targets.current.color_view, 1.0);
        }
    }

    fn add(&self, encoder: &mut wgpu::CommandEncoder, weight: f64) {
        if let Some(average) = &self.average {
            draw(encoder, &self.add, &average.picture_group, &average.view, weight);
        }
    }
}

impl Average {
    fn new(device: &wgpu::Device, layout: &wgpu::BindGroupLayout, targets: &Targets, generation: u64) -> Self {
        let texture = device.create_texture(&wgpu::TextureDescriptor {
            label: Some("average"),
            size: wgpu::Extent3d { width: targets.size.0, height: targets.size.1, depth_or_array_layers: 1 },
            mip_level_count: 1,
            sample_count: 1,
            dimension: wgpu::TextureDimension::D2,
            format: AVERAGE_FORMAT,
            usage: wgpu::TextureUsages::TEXTURE_BINDING | wgpu::TextureUsages::RENDER_ATTACHMENT,
            view_formats: &[],
        });
        let view = texture.create_view(&Default::default());
        Average {
            generation,
            group: texture_group(device, "average", layout, &[&view]),
            picture_group: texture_group(device, "picture", layout, &[&targets.color_view]),
            view,
        }
    }
}

/// Draws a full-screen pass over what `target` has.
fn draw(
    encoder: &mut wgpu::CommandEncoder,
    pipeline: &wgpu::RenderPipeline,
    group: &wgpu::BindGroup,
    target: &wgpu::TextureView,
    weight: f64,
) {
    let mut pass = encoder.begin_render_pass(&wgpu::RenderPassDescriptor {
        label: Some("still picture"),
        color_attachments: &[color_attachment(target, wgpu::LoadOp::Load)],
        ..Default::default()
    });
    pass.set_pipeline(pipeline);
    pass.set_bind_group(0, group, &[]);
    pass.set_blend_constant(wgpu::Color { r: weight, g: weight, b: weight, a: weight });
    pass.draw(0..3, 0..1);
}

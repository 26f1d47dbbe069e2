//! The shadow masks: the visibility of each light from each pixel, four lights a layer, kept while nothing moves.

use super::plan::{MAX_SHADOWS, ShadowPlan};
use super::slots::GpuShadows;
use crate::preview::gpu::bindings::{
    UNIFORM_OFFSET_ALIGNMENT, array_view, color_attachment, dynamic_uniform, dynamic_uniform_layout, layer_views,
    texture_group, texture_layout,
};
use crate::preview::gpu::context::GpuContext;
use eframe::wgpu;

/// Four 8-bit visibilities in the first word, the bits of the depth in the second.
pub(crate) const FORMAT: wgpu::TextureFormat = wgpu::TextureFormat::Rg32Uint;
/// Bytes of the slots of one mask.
const SLOTS_BYTES: usize = size_of::<GpuShadows>();
/// Stride between the slots of two masks, bytes.
const SLOTS_STRIDE: u64 = (SLOTS_BYTES as u64).next_multiple_of(UNIFORM_OFFSET_ALIGNMENT);

/// The mask textures and the uniforms of the passes that fill them.
#[derive(Debug)]
pub(crate) struct ShadowMasks {
    slots_layout: wgpu::BindGroupLayout,
    slots_buffer: wgpu::Buffer,
    slots_group: wgpu::BindGroup,
    raw_layout: wgpu::BindGroupLayout,
    masks_layout: wgpu::BindGroupLayout,
    textures: MaskTextures,
}

/// The textures, which depend on the size and number of masks.
#[derive(Debug)]
struct MaskTextures {
    size: (u32, u32),
    raw: wgpu::TextureView,
    raw_group: wgpu::BindGroup,
    layers: Vec<wgpu::TextureView>,
    masks_group: wgpu::BindGroup,
}

impl ShadowMasks {
    pub fn new(device: &wgpu::Device) -> Self {
        let slots_layout = dynamic_uniform_layout(device, "shadow slots", wgpu::ShaderStages::FRAGMENT);
        let slots_buffer = device.create_buffer(&wgpu::BufferDescriptor {
            label: Some("shadow slots"),
            size: SLOTS_STRIDE * MAX_SHADOWS as u64 / 4,
            usage: wgpu::BufferUsages::UNIFORM | wgpu::BufferUsages::COPY_DST,
            mapped_at_creation: false,
        });
        let slots_group = dynamic_uniform(device, "shadow slots", &slots_layout, &slots_buffer, SLOTS_BYTES);
        let layout = |label, dimension| texture_layout(device, label, wgpu::TextureSampleType::Uint, dimension, 1);
        let raw_layout = layout("raw shadow mask", wgpu::TextureViewDimension::D2);
        let masks_layout = layout("shadow masks", wgpu::TextureViewDimension::D2Array);
        let textures = MaskTextures::new(device, &raw_layout, &masks_layout, (1, 1), 1);
        ShadowMasks { slots_layout, slots_buffer, slots_group, raw_layout, masks_layout, textures }
    }

    /// The layout of the slots' uniform.
    pub fn slots_layout(&self) -> &wgpu::BindGroupLayout {
        &self.slots_layout
    }

    /// The layout through which the blur reads the raw mask.
    pub fn raw_layout(&self) -> &wgpu::BindGroupLayout {
        &self.raw_layout
    }

    /// The layout through which the lighting pass reads the masks.
    pub fn masks_layout(&self) -> &wgpu::BindGroupLayout {
        &self.masks_layout
    }

    /// The bind group through which the lighting pass reads the masks.
    pub fn masks_group(&self) -> &wgpu::BindGroup {
        &self.textures.masks_group
    }

    /// Uploads a plan's slots and recreates the textures if the masks' size (mask pixels) or number need it. Returns
    /// true if the textures are new and hold nothing.
    pub fn prepare(&mut self, gpu: &GpuContext, plan: &ShadowPlan, size: (u32, u32)) -> bool {
        for (mask, shadows) in plan.masks.iter().enumerate() {
            gpu.queue.write_buffer(&self.slots_buffer, mask as u64 * SLOTS_STRIDE, bytemuck::bytes_of(shadows));
        }
        let stale =
            !plan.masks.is_empty() && (self.textures.size != size || self.textures.layers.len() < plan.masks.len());
        if stale {
            let layers = plan.masks.len() as u32;
            self.textures = MaskTextures::new(&gpu.device, &self.raw_layout, &self.masks_layout, size, layers);
        }
        stale
    }

    /// Begins the pass that fills the raw mask; bind groups 0 to 2 are the caller's.
    pub fn begin_raw<'e>(&self, encoder: &'e mut wgpu::CommandEncoder, mask: usize) -> wgpu::RenderPass<'e> {
        let mut pass = begin(encoder, "shadow mask", &self.textures.raw);
        pass.set_bind_group(3, &self.slots_group, &[mask as u32 * SLOTS_STRIDE as u32]);
        pass
    }

    /// Begins the pass that blurs the raw mask into a layer; bind groups 0 and 1 are the caller's.
    pub fn begin_blur<'e>(&self, encoder: &'e mut wgpu::CommandEncoder, mask: usize) -> wgpu::RenderPass<'e> {
        let mut pass = begin(encoder, "shadow blur", &self.textures.layers[mask]);
        pass.set_bind_group(2, &self.textures.raw_group, &[]);
        pass
    }
}

impl MaskTextures {
    fn new(
        device: &wgpu::Device,
        raw_layout: &wgpu::BindGroupLayout,
        masks_layout: &wgpu::BindGroupLayout,
        size: (u32, u32),
        layers: u32,
    ) -> Self {
        let texture = |label, layers| {
            device.create_texture(&wgpu::TextureDescriptor {
                label: Some(label),
                size: wgpu::Extent3d { width: size.0, height: size.1, depth_or_array_layers: layers },
                mip_level_count: 1,
                sample_count: 1,
                dimension: wgpu::TextureDimension::D2,
                format: FORMAT,
                usage: wgpu::TextureUsages::RENDER_ATTACHMENT | wgpu::TextureUsages::TEXTURE_BINDING,
                view_formats: &[],
            })
        };
        let raw = texture("raw shadow mask", 1).create_view(&Default::default());
        let masks = texture("shadow masks", layers);
        MaskTextures {
            size,
            raw_group: texture_group(device, "raw shadow mask", raw_layout, &[&raw]),
            raw,
            layers: layer_views(&masks),
            masks_group: texture_group(device, "shadow masks", masks_layout, &[&array_view(&masks)]),
        }
    }
}

fn begin<'e>(
    encoder: &'e mut wgpu::CommandEncoder,
    label: &'static str,
    view: &wgpu::TextureView,
) -> wgpu::RenderPass<'e> {
    encoder.begin_render_pass(&wgpu::RenderPassDescriptor {
        label: Some(label),
        color_attachments: &[color_attachment(view, wgpu::LoadOp::Clear(wgpu::Color::TRANSPARENT))],
        ..Default::default()
    })
}

//! The shadow masks: how much of each light reaches each pixel, four lights a layer, kept while nothing moves.

use super::maps::{array_view, dynamic_uniform, dynamic_uniform_layout, layer_views};
use super::views::{GpuShadows, MAX_SHADOWS, ShadowPlan};
use eframe::wgpu;

/// Four shadows in a word, and the depth's bits.
pub(crate) const FORMAT: wgpu::TextureFormat = wgpu::TextureFormat::Rg32Uint;
/// Bytes of four lights' views.
const SLOTS_BYTES: usize = size_of::<GpuShadows>();
/// Distance between the slots of two masks: a multiple of every device's offset alignment.
const OFFSET_STRIDE: u64 = (SLOTS_BYTES as u64).next_multiple_of(256);

/// Masks of a picture's size and the uniforms that fill them.
#[derive(Debug)]
pub(crate) struct ShadowMasks {
    slots_layout: wgpu::BindGroupLayout,
    slots_buffer: wgpu::Buffer,
    slots: wgpu::BindGroup,
    raw_layout: wgpu::BindGroupLayout,
    masks_layout: wgpu::BindGroupLayout,
    textures: Textures,
}

/// What depends on size and number of masks.
#[derive(Debug)]
struct Textures {
    size: (u32, u32),
    raw: wgpu::TextureView,
    raw_lookup: wgpu::BindGroup,
    layers: Vec<wgpu::TextureView>,
    masks_lookup: wgpu::BindGroup,
}

impl ShadowMasks {
    pub fn new(device: &wgpu::Device) -> Self {
        let slots_layout = dynamic_uniform_layout(device, "shadow slots", wgpu::ShaderStages::FRAGMENT);
        let slots_buffer = device.create_buffer(&wgpu::BufferDescriptor {
            label: Some("shadow slots"),
            size: OFFSET_STRIDE * MAX_SHADOWS as u64 / 4,
            usage: wgpu::BufferUsages::UNIFORM | wgpu::BufferUsages::COPY_DST,
            mapped_at_creation: false,
        });
        let slots = dynamic_uniform(device, "shadow slots", &slots_layout, &slots_buffer, SLOTS_BYTES);
        let raw_layout = uint_layout(device, "raw shadow mask", wgpu::TextureViewDimension::D2);
        let masks_layout = uint_layout(device, "shadow masks", wgpu::TextureViewDimension::D2Array);
        let textures = Textures::new(device, &raw_layout, &masks_layout, (1, 1), 1);
        ShadowMasks { slots_layout, slots_buffer, slots, raw_layout, masks_layout, textures }
    }

    /// Layout of the slots' uniform.
    pub fn slots_layout(&self) -> &wgpu::BindGroupLayout {
        &self.slots_layout
    }

    /// Layout with which the blur reads a mask.
    pub fn raw_layout(&self) -> &wgpu::BindGroupLayout {
        &self.raw_layout
    }

    /// Layout with which the lighting pass reads the masks.
    pub fn masks_layout(&self) -> &wgpu::BindGroupLayout {
        &self.masks_layout
    }

    /// The finished masks, for reading.
    pub fn lookup(&self) -> &wgpu::BindGroup {
        &self.textures.masks_lookup
    }

    /// Makes masks of this size (in mask pixels) and uploads the slots. True if what the masks held is gone.
    pub fn prepare(&mut self, device: &wgpu::Device, queue: &wgpu::Queue, plan: &ShadowPlan, size: (u32, u32)) -> bool {
        for (mask, shadows) in plan.masks.iter().enumerate() {
            queue.write_buffer(&self.slots_buffer, mask as u64 * OFFSET_STRIDE, bytemuck::bytes_of(shadows));
        }
        let renew =
            !plan.masks.is_empty() && (self.textures.size != size || self.textures.layers.len() < plan.masks.len());
        if renew {
            let layers = plan.masks.len() as u32;
            self.textures = Textures::new(device, &self.raw_layout, &self.masks_layout, size, layers);
        }
        renew
    }

    /// Starts the pass that fills the raw mask; bind groups 0 to 2 are the caller's.
    pub fn begin_raw<'e>(&self, encoder: &'e mut wgpu::CommandEncoder, mask: usize) -> wgpu::RenderPass<'e> {
        let mut pass = begin(encoder, "shadow mask", &self.textures.raw);
        pass.set_bind_group(3, &self.slots, &[mask as u32 * OFFSET_STRIDE as u32]);
        pass
    }

    /// Starts the pass that evens the raw mask out; bind groups 0 and 1 are the caller's.
    pub fn begin_blur<'e>(&self, encoder: &'e mut wgpu::CommandEncoder, mask: usize) -> wgpu::RenderPass<'e> {
        let mut pass = begin(encoder, "shadow blur", &self.textures.layers[mask]);
        pass.set_bind_group(2, &self.textures.raw_lookup, &[]);
        pass
    }
}

impl Textures {
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
        let lookup = |label, layout, view: &wgpu::TextureView| {
            device.create_bind_group(&wgpu::BindGroupDescriptor {
                label: Some(label),
                layout,
                entries: &[wgpu::BindGroupEntry { binding: 0, resource: wgpu::BindingResource::TextureView(view) }],
            })
        };
        let raw = texture("raw shadow mask", 1).create_view(&Default::default());
        let masks = texture("shadow masks", layers);
        Textures {
            size,
            raw_lookup: lookup("raw shadow mask", raw_layout, &raw),
            raw,
            layers: layer_views(&masks),
            masks_lookup: lookup("shadow masks", masks_layout, &array_view(&masks)),
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
        color_attachments: &[Some(wgpu::RenderPassColorAttachment {
            view,
            depth_slice: None,
            resolve_target: None,
            ops: wgpu::Operations { load: wgpu::LoadOp::Clear(wgpu::Color::TRANSPARENT), store: wgpu::StoreOp::Store },
        })],
        ..Default::default()
    })
}

fn uint_layout(
    device: &wgpu::Device,
    label: &str,
    view_dimension: wgpu::TextureViewDimension,
) -> wgpu::BindGroupLayout {
    device.create_bind_group_layout(&wgpu::BindGroupLayoutDescriptor {
        label: Some(label),
        entries: &[wgpu::BindGroupLayoutEntry {
            binding: 0,
            visibility: wgpu::ShaderStages::FRAGMENT,
            ty: wgpu::BindingType::Texture {
                sample_type: wgpu::TextureSampleType::Uint,
                view_dimension,
                multisampled: false,
            },
            count: None,
        }],
    })
}

//! The shadow maps themselves: one layer a view, redrawn only when the view or what casts shadows has changed.

use super::shadow_views::{GpuShadowView, MAX_VIEWS};
use eframe::wgpu;

/// Depth of all maps.
pub(super) const FORMAT: wgpu::TextureFormat = wgpu::TextureFormat::Depth32Float;
/// Dynamic uniform offsets are multiples of this on every device.
const OFFSET_STRIDE: u64 = 256;

/// What a layer shows.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Content {
    view: GpuShadowView,
    casters: u64,
}

/// All shadow maps, in one array texture.
#[derive(Debug)]
pub(super) struct ShadowMaps {
    view_index_layout: wgpu::BindGroupLayout,
    view_index: wgpu::BindGroup,
    lookup_layout: wgpu::BindGroupLayout,
    lookup: wgpu::BindGroup,
    sampler: wgpu::Sampler,
    layers: Vec<wgpu::TextureView>,
    contents: Vec<Option<Content>>,
    resolution: u32,
}

impl ShadowMaps {
    pub fn new(device: &wgpu::Device, queue: &wgpu::Queue) -> Self {
        let view_index_layout = device.create_bind_group_layout(&wgpu::BindGroupLayoutDescriptor {
            label: Some("shadow view index"),
            entries: &[wgpu::BindGroupLayoutEntry {
                binding: 0,
                visibility: wgpu::ShaderStages::VERTEX,
                ty: wgpu::BindingType::Buffer {
                    ty: wgpu::BufferBindingType::Uniform,
                    has_dynamic_offset: true,
                    min_binding_size: None,
                },
                count: None,
            }],
        });
        let view_index = view_index_bind_group(device, queue, &view_index_layout);
        let lookup_layout = lookup_layout(device);
        let sampler = device.create_sampler(&wgpu::SamplerDescriptor { label: Some("shadow"), ..Default::default() });
        let (layers, lookup) = create_maps(device, &lookup_layout, &sampler, 1, 1);
        ShadowMaps {
            view_index_layout,
            view_index,
            lookup_layout,
            lookup,
            sampler,
            layers,
            contents: Vec::new(),
            resolution: 1,
        }
    }

    /// Layout of the uniform that tells the shadow pass its view.
    pub fn view_index_layout(&self) -> &wgpu::BindGroupLayout {
        &self.view_index_layout
    }

    /// Layout with which other passes read the maps.
    pub fn lookup_layout(&self) -> &wgpu::BindGroupLayout {
        &self.lookup_layout
    }

    /// The maps, for reading.
    pub fn lookup(&self) -> &wgpu::BindGroup {
        &self.lookup
    }

    /// Makes room for the views and returns the layers that must be drawn anew.
    pub fn stale(
        &mut self,
        device: &wgpu::Device,
        views: &[GpuShadowView],
        casters: u64,
        resolution: u32,
    ) -> Vec<usize> {
        let resolution = resolution.clamp(16, device.limits().max_texture_dimension_2d);
        let count = views.len().max(1).next_power_of_two().min(MAX_VIEWS);
        if !views.is_empty() && (count > self.contents.len() || resolution != self.resolution) {
            (self.layers, self.lookup) =
                create_maps(device, &self.lookup_layout, &self.sampler, resolution, count as u32);
            self.contents = vec![None; count];
            self.resolution = resolution;
        }
        let wanted = views.iter().map(|&view| Some(Content { view, casters }));
        let stale: Vec<usize> =
            wanted.enumerate().filter(|(layer, content)| self.contents[*layer] != *content).map(|(l, _)| l).collect();
        for &layer in &stale {
            self.contents[layer] = Some(Content { view: views[layer], casters });
        }
        stale
    }

    /// Forgets what the layers show, after a frame that failed.
    pub fn invalidate(&mut self) {
        self.contents.fill(None);
    }

    /// Starts drawing into a layer.
    pub fn begin_pass<'e>(&self, encoder: &'e mut wgpu::CommandEncoder, layer: usize) -> wgpu::RenderPass<'e> {
        let mut pass = encoder.begin_render_pass(&wgpu::RenderPassDescriptor {
            label: Some("shadow map"),
            depth_stencil_attachment: Some(wgpu::RenderPassDepthStencilAttachment {
                view: &self.layers[layer],
                // Reversed depth: 0 is infinitely far.
                depth_ops: Some(wgpu::Operations { load: wgpu::LoadOp::Clear(0.0), store: wgpu::StoreOp::Store }),
                stencil_ops: None,
            }),
            ..Default::default()
        });
        pass.set_bind_group(1, &self.view_index, &[layer as u32 * OFFSET_STRIDE as u32]);
        pass
    }
}

fn view_index_bind_group(
    device: &wgpu::Device,
    queue: &wgpu::Queue,
    layout: &wgpu::BindGroupLayout,
) -> wgpu::BindGroup {
    let buffer = device.create_buffer(&wgpu::BufferDescriptor {
        label: Some("shadow view index"),
        size: OFFSET_STRIDE * MAX_VIEWS as u64,
        usage: wgpu::BufferUsages::UNIFORM | wgpu::BufferUsages::COPY_DST,
        mapped_at_creation: false,
    });
    for view in 0..MAX_VIEWS {
        queue.write_buffer(&buffer, view as u64 * OFFSET_STRIDE, bytemuck::bytes_of(&[view as u32; 4]));
    }
    device.create_bind_group(&wgpu::BindGroupDescriptor {
        label: Some("shadow view index"),
        layout,
        entries: &[wgpu::BindGroupEntry {
            binding: 0,
            resource: wgpu::BindingResource::Buffer(wgpu::BufferBinding {
                buffer: &buffer,
                offset: 0,
                size: std::num::NonZeroU64::new(16),
            }),
        }],
    })
}

fn lookup_layout(device: &wgpu::Device) -> wgpu::BindGroupLayout {
    device.create_bind_group_layout(&wgpu::BindGroupLayoutDescriptor {
        label: Some("shadow maps"),
        entries: &[
            wgpu::BindGroupLayoutEntry {
                binding: 0,
                visibility: wgpu::ShaderStages::FRAGMENT,
                ty: wgpu::BindingType::Texture {
                    sample_type: wgpu::TextureSampleType::Depth,
                    view_dimension: wgpu::TextureViewDimension::D2Array,
                    multisampled: false,
                },
                count: None,
            },
            wgpu::BindGroupLayoutEntry {
                binding: 1,
                visibility: wgpu::ShaderStages::FRAGMENT,
                ty: wgpu::BindingType::Sampler(wgpu::SamplerBindingType::NonFiltering),
                count: None,
            },
        ],
    })
}

fn create_maps(
    device: &wgpu::Device,
    layout: &wgpu::BindGroupLayout,
    sampler: &wgpu::Sampler,
    resolution: u32,
    layers: u32,
) -> (Vec<wgpu::TextureView>, wgpu::BindGroup) {
    let texture = device.create_texture(&wgpu::TextureDescriptor {
        label: Some("shadow maps"),
        size: wgpu::Extent3d { width: resolution, height: resolution, depth_or_array_layers: layers },
        mip_level_count: 1,
        sample_count: 1,
        dimension: wgpu::TextureDimension::D2,
        format: FORMAT,
        usage: wgpu::TextureUsages::RENDER_ATTACHMENT | wgpu::TextureUsages::TEXTURE_BINDING,
        view_formats: &[],
    });
    let layer_view = |layer| {
        texture.create_view(&wgpu::TextureViewDescriptor {
            dimension: Some(wgpu::TextureViewDimension::D2),
            base_array_layer: layer,
            array_layer_count: Some(1),
            ..Default::default()
        })
    };
    let array = texture.create_view(&wgpu::TextureViewDescriptor {
        dimension: Some(wgpu::TextureViewDimension::D2Array),
        ..Default::default()
    });
    let lookup = device.create_bind_group(&wgpu::BindGroupDescriptor {
        label: Some("shadow maps"),
        layout,
        entries: &[
            wgpu::BindGroupEntry { binding: 0, resource: wgpu::BindingResource::TextureView(&array) },
            wgpu::BindGroupEntry { binding: 1, resource: wgpu::BindingResource::Sampler(sampler) },
        ],
    });
    ((0..layers).map(layer_view).collect(), lookup)
}

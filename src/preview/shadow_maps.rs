//! The shadow maps themselves: two layers a view, redrawn only when the view or what casts shadows has changed.
//!
//! The first layer of a view holds what is nearest to the light; in the second, solids show their far sides.

use super::shadow_views::{MAX_VIEWS, ShadowPlan};
use eframe::wgpu;
use glam::Mat4;

/// Depth of all maps.
pub(super) const FORMAT: wgpu::TextureFormat = wgpu::TextureFormat::Depth32Float;
/// Dynamic uniform offsets are multiples of this on every device.
const OFFSET_STRIDE: u64 = 256;

/// Which sides of solids a layer holds.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Side {
    /// Whatever is nearest to the light.
    Near = 0,
    /// Their far sides.
    Far = 1,
}

/// What the layers of a view show.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Content {
    view: Mat4,
    casters: u64,
}

/// All shadow maps, in one array texture.
#[derive(Debug)]
pub(super) struct ShadowMaps {
    view_layout: wgpu::BindGroupLayout,
    view_buffer: wgpu::Buffer,
    view: wgpu::BindGroup,
    lookup_layout: wgpu::BindGroupLayout,
    lookup: wgpu::BindGroup,
    layers: Vec<wgpu::TextureView>,
    contents: Vec<Option<Content>>,
    resolution: u32,
}

impl ShadowMaps {
    pub fn new(device: &wgpu::Device) -> Self {
        let view_layout = dynamic_uniform_layout(device, "shadow view", wgpu::ShaderStages::VERTEX);
        let view_buffer = device.create_buffer(&wgpu::BufferDescriptor {
            label: Some("shadow views"),
            size: OFFSET_STRIDE * MAX_VIEWS as u64,
            usage: wgpu::BufferUsages::UNIFORM | wgpu::BufferUsages::COPY_DST,
            mapped_at_creation: false,
        });
        let view = dynamic_uniform(device, "shadow view", &view_layout, &view_buffer, size_of::<Mat4>());
        let lookup_layout = device.create_bind_group_layout(&wgpu::BindGroupLayoutDescriptor {
            label: Some("shadow maps"),
            entries: &[wgpu::BindGroupLayoutEntry {
                binding: 0,
                visibility: wgpu::ShaderStages::FRAGMENT,
                ty: wgpu::BindingType::Texture {
                    sample_type: wgpu::TextureSampleType::Depth,
                    view_dimension: wgpu::TextureViewDimension::D2Array,
                    multisampled: false,
                },
                count: None,
            }],
        });
        let (layers, lookup) = create_maps(device, &lookup_layout, 1, 2);
        let contents = Vec::new();
        ShadowMaps { view_layout, view_buffer, view, lookup_layout, lookup, layers, contents, resolution: 1 }
    }

    /// Layout of the uniform that holds the view of the shadow pass.
    pub fn view_layout(&self) -> &wgpu::BindGroupLayout {
        &self.view_layout
    }

    /// Layout with which the mask reads the maps.
    pub fn lookup_layout(&self) -> &wgpu::BindGroupLayout {
        &self.lookup_layout
    }

    /// The maps, for reading.
    pub fn lookup(&self) -> &wgpu::BindGroup {
        &self.lookup
    }

    /// Makes room for the views, uploads them, and returns the indices of those that must be drawn anew.
    pub fn stale(
        &mut self,
        device: &wgpu::Device,
        queue: &wgpu::Queue,
        plan: &ShadowPlan,
        casters: u64,
        resolution: u32,
    ) -> Vec<usize> {
        let resolution = resolution.clamp(16, device.limits().max_texture_dimension_2d);
        let count = plan.views.len().max(1).next_power_of_two().min(MAX_VIEWS);
        if !plan.views.is_empty() && (count > self.contents.len() || resolution != self.resolution) {
            (self.layers, self.lookup) = create_maps(device, &self.lookup_layout, resolution, 2 * count as u32);
            self.contents = vec![None; count];
            self.resolution = resolution;
        }
        let mut stale = Vec::new();
        for (index, view) in plan.views.iter().enumerate().filter_map(|(index, view)| Some((index, (*view)?))) {
            let content = Some(Content { view, casters });
            if self.contents[index] != content {
                self.contents[index] = content;
                queue.write_buffer(
                    &self.view_buffer,
                    index as u64 * OFFSET_STRIDE,
                    bytemuck::bytes_of(&view.to_cols_array()),
                );
                stale.push(index);
            }
        }
        stale
    }

    /// Forgets what the layers show, after a frame that failed.
    pub fn invalidate(&mut self) {
        self.contents.fill(None);
    }

    /// Starts drawing into a layer of a view.
    pub fn begin_pass<'e>(
        &self,
        encoder: &'e mut wgpu::CommandEncoder,
        index: usize,
        side: Side,
    ) -> wgpu::RenderPass<'e> {
        let mut pass = encoder.begin_render_pass(&wgpu::RenderPassDescriptor {
            label: Some("shadow map"),
            depth_stencil_attachment: Some(wgpu::RenderPassDepthStencilAttachment {
                view: &self.layers[2 * index + side as usize],
                // Reversed depth: 0 is infinitely far.
                depth_ops: Some(wgpu::Operations { load: wgpu::LoadOp::Clear(0.0), store: wgpu::StoreOp::Store }),
                stencil_ops: None,
            }),
            ..Default::default()
        });
        pass.set_bind_group(1, &self.view, &[index as u32 * OFFSET_STRIDE as u32]);
        pass
    }
}

/// Layout of one uniform buffer whose offset is given at each use.
pub(super) fn dynamic_uniform_layout(
    device: &wgpu::Device,
    label: &str,
    visibility: wgpu::ShaderStages,
) -> wgpu::BindGroupLayout {
    device.create_bind_group_layout(&wgpu::BindGroupLayoutDescriptor {
        label: Some(label),
        entries: &[wgpu::BindGroupLayoutEntry {
            binding: 0,
            visibility,
            ty: wgpu::BindingType::Buffer {
                ty: wgpu::BufferBindingType::Uniform,
                has_dynamic_offset: true,
                min_binding_size: None,
            },
            count: None,
        }],
    })
}

/// Bind group of such a buffer, `size` bytes at each use.
pub(super) fn dynamic_uniform(
    device: &wgpu::Device,
    label: &str,
    layout: &wgpu::BindGroupLayout,
    buffer: &wgpu::Buffer,
    size: usize,
) -> wgpu::BindGroup {
    device.create_bind_group(&wgpu::BindGroupDescriptor {
        label: Some(label),
        layout,
        entries: &[wgpu::BindGroupEntry {
            binding: 0,
            resource: wgpu::BindingResource::Buffer(wgpu::BufferBinding {
                buffer,
                offset: 0,
                size: std::num::NonZeroU64::new(size as u64),
            }),
        }],
    })
}

fn create_maps(
    device: &wgpu::Device,
    layout: &wgpu::BindGroupLayout,
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
    let lookup = device.create_bind_group(&wgpu::BindGroupDescriptor {
        label: Some("shadow maps"),
        layout,
        entries: &[wgpu::BindGroupEntry {
            binding: 0,
            resource: wgpu::BindingResource::TextureView(&array_view(&texture)),
        }],
    });
    (layer_views(&texture), lookup)
}

/// All layers of a texture as an array.
pub(super) fn array_view(texture: &wgpu::Texture) -> wgpu::TextureView {
    texture.create_view(&wgpu::TextureViewDescriptor {
        dimension: Some(wgpu::TextureViewDimension::D2Array),
        ..Default::default()
    })
}

/// Each layer of a texture by itself.
pub(super) fn layer_views(texture: &wgpu::Texture) -> Vec<wgpu::TextureView> {
    let layer = |layer| {
        texture.create_view(&wgpu::TextureViewDescriptor {
            dimension: Some(wgpu::TextureViewDimension::D2),
            base_array_layer: layer,
            array_layer_count: Some(1),
            ..Default::default()
        })
    };
    (0..texture.depth_or_array_layers()).map(layer).collect()
}

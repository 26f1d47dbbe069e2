//! The shadow maps themselves: two sides a view. One holds what is nearest to the light; in the other, solids show
//! their far sides.

use super::layers::{ShadowLayers, StaleMap};
use super::views::{MAX_VIEWS, ShadowPlan};
use crate::preview::geometry::draw_list::DrawList;
use eframe::wgpu;
use glam::Mat4;

/// Depth of all maps.
pub(crate) const FORMAT: wgpu::TextureFormat = wgpu::TextureFormat::Depth32Float;
/// Dynamic uniform offsets are multiples of this on every device.
const OFFSET_STRIDE: u64 = 256;

/// Which sides of solids a map holds.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Side {
    /// Whatever is nearest to the light.
    Near = 0,
    /// Their far sides.
    Far = 1,
}

/// All shadow maps, in one array texture.
#[derive(Debug)]
pub(crate) struct ShadowMaps {
    view_layout: wgpu::BindGroupLayout,
    view_buffer: wgpu::Buffer,
    view: wgpu::BindGroup,
    lookup_layout: wgpu::BindGroupLayout,
    lookup: wgpu::BindGroup,
    sides: Vec<wgpu::TextureView>,
    layers: ShadowLayers,
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
        let (sides, lookup) = create_maps(device, &lookup_layout, 1, 2);
        let layers = ShadowLayers::default();
        ShadowMaps { view_layout, view_buffer, view, lookup_layout, lookup, sides, layers, resolution: 1 }
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

    /// Makes room for a plan's views, tells it where they are, uploads those that must be drawn and returns them.
    pub fn place(
        &mut self,
        device: &wgpu::Device,
        queue: &wgpu::Queue,
        plan: &mut ShadowPlan,
        list: &DrawList,
        resolution: u32,
    ) -> Vec<StaleMap> {
        let resolution = resolution.clamp(16, device.limits().max_texture_dimension_2d);
        let count = plan.views.max(1).next_power_of_two().min(MAX_VIEWS);
        if !plan.runs.is_empty() && (count > self.layers.len() || resolution != self.resolution) {
            (self.sides, self.lookup) = create_maps(device, &self.lookup_layout, resolution, 2 * count as u32);
            self.layers = ShadowLayers::with_room(count);
            self.resolution = resolution;
        }
        let (firsts, stale) = self.layers.place(&plan.runs, list.caster_signature, |view| list.seen_by(view));
        plan.set_layers(&firsts);
        for map in &stale {
            let offset = map.layer as u64 * OFFSET_STRIDE;
            queue.write_buffer(
                &self.view_buffer,
                offset,
                bytemuck::bytes_of(&map.view.clip_from_world.to_cols_array()),
            );
        }
        stale
    }

    /// Forgets what the layers show, after a frame that failed.
    pub fn invalidate(&mut self) {
        self.layers.invalidate();
    }

    /// Starts drawing one side of a layer's view.
    pub fn begin_pass<'e>(
        &self,
        encoder: &'e mut wgpu::CommandEncoder,
        layer: usize,
        side: Side,
    ) -> wgpu::RenderPass<'e> {
        let mut pass = encoder.begin_render_pass(&wgpu::RenderPassDescriptor {
            label: Some("shadow map"),
            depth_stencil_attachment: Some(wgpu::RenderPassDepthStencilAttachment {
                view: &self.sides[2 * layer + side as usize],
                // Reversed depth: 0 is infinitely far.
                depth_ops: Some(wgpu::Operations { load: wgpu::LoadOp::Clear(0.0), store: wgpu::StoreOp::Store }),
                stencil_ops: None,
            }),
            ..Default::default()
        });
        pass.set_bind_group(2, &self.view, &[layer as u32 * OFFSET_STRIDE as u32]);
        pass
    }
}

/// Layout of one uniform buffer whose offset is given at each use.
pub(crate) fn dynamic_uniform_layout(
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
pub(crate) fn dynamic_uniform(
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
pub(crate) fn array_view(texture: &wgpu::Texture) -> wgpu::TextureView {
    texture.create_view(&wgpu::TextureViewDescriptor {
        dimension: Some(wgpu::TextureViewDimension::D2Array),
        ..Default::default()
    })
}

/// Each layer of a texture by itself.
pub(crate) fn layer_views(texture: &wgpu::Texture) -> Vec<wgpu::TextureView> {
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

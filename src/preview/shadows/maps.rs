//! The shadow maps: two layers of an array texture per view. The near side holds the surfaces nearest to the light; in
//! the far side, solids are drawn with their back faces.

use super::culling;
use super::layers::{ShadowLayers, StaleMap};
use super::plan::{MAX_VIEWS, ShadowPlan};
use crate::preview::geometry::draw_list::DrawList;
use crate::preview::gpu::bindings::{
    UNIFORM_OFFSET_ALIGNMENT, array_view, depth_attachment, dynamic_uniform, dynamic_uniform_layout, layer_views,
    texture_group, texture_layout,
};
use crate::preview::gpu::context::GpuContext;
use eframe::wgpu;
use glam::Mat4;

/// Depth format of the maps, reversed: 0 is infinitely far.
pub(crate) const FORMAT: wgpu::TextureFormat = wgpu::TextureFormat::Depth32Float;

/// The sides of solids that a layer holds.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum MapSide {
    /// All surfaces: the nearest to the light.
    Near = 0,
    /// Sheets, and the sides of solids that face away from the light.
    Far = 1,
}

/// All shadow maps, in one array texture.
#[derive(Debug)]
pub(crate) struct ShadowMaps {
    view_layout: wgpu::BindGroupLayout,
    view_buffer: wgpu::Buffer,
    view_group: wgpu::BindGroup,
    texture_layout: wgpu::BindGroupLayout,
    texture_group: wgpu::BindGroup,
    /// Views of the texture's layers: near and far side of each view.
    sides: Vec<wgpu::TextureView>,
    layers: ShadowLayers,
    resolution: u32,
}

impl ShadowMaps {
    pub fn new(device: &wgpu::Device) -> Self {
        let view_layout = dynamic_uniform_layout(device, "shadow view", wgpu::ShaderStages::VERTEX);
        let view_buffer = device.create_buffer(&wgpu::BufferDescriptor {
            label: Some("shadow views"),
            size: UNIFORM_OFFSET_ALIGNMENT * MAX_VIEWS as u64,
            usage: wgpu::BufferUsages::UNIFORM | wgpu::BufferUsages::COPY_DST,
            mapped_at_creation: false,
        });
        let view_group = dynamic_uniform(device, "shadow view", &view_layout, &view_buffer, size_of::<Mat4>());
        let dimension = wgpu::TextureViewDimension::D2Array;
        let texture_layout = texture_layout(device, "shadow maps", wgpu::TextureSampleType::Depth, dimension, 1);
        let (sides, texture_group) = create_maps(device, &texture_layout, 1, 2);
        let layers = ShadowLayers::default();
        ShadowMaps { view_layout, view_buffer, view_group, texture_layout, texture_group, sides, layers, resolution: 1 }
    }

    /// The layout of the uniform that holds the clip-from-world matrix of the shadow map pass.
    pub fn view_layout(&self) -> &wgpu::BindGroupLayout {
        &self.view_layout
    }

    /// The layout through which the mask pass reads the maps.
    pub fn texture_layout(&self) -> &wgpu::BindGroupLayout {
        &self.texture_layout
    }

    /// The bind group through which the mask pass reads the maps.
    pub fn texture_group(&self) -> &wgpu::BindGroup {
        &self.texture_group
    }

    /// Allocates layers for a plan's views, writes them into the plan's slots, and returns the maps to draw after
    /// uploading their matrices.
    pub fn prepare(
        &mut self,
        gpu: &GpuContext,
        plan: &mut ShadowPlan,
        list: &DrawList,
        resolution: u32,
    ) -> Vec<StaleMap> {
        let resolution = resolution.clamp(16, gpu.device.limits().max_texture_dimension_2d);
        let count = plan.views.max(1).next_power_of_two().min(MAX_VIEWS);
        if !plan.lights.is_empty() && (count > self.layers.len() || resolution != self.resolution) {
            let layers = 2 * count as u32;
            (self.sides, self.texture_group) = create_maps(&gpu.device, &self.texture_layout, resolution, layers);
            self.layers = ShadowLayers::with_capacity(count);
            self.resolution = resolution;
        }
        let signature = |view: &_| culling::caster_signature(list, view);
        let (firsts, stale) = self.layers.assign(&plan.lights, list.caster_signature, signature);
        plan.set_layers(&firsts);
        for map in &stale {
            let offset = map.layer as u64 * UNIFORM_OFFSET_ALIGNMENT;
            let matrix = map.view.clip_from_world.to_cols_array();
            gpu.queue.write_buffer(&self.view_buffer, offset, bytemuck::bytes_of(&matrix));
        }
        stale
    }

    /// Marks all maps as stale, after a frame that failed.
    pub fn invalidate(&mut self) {
        self.layers.invalidate();
    }

    /// Begins the pass that draws one side of a view's map; bind groups 0 and 1 are the caller's.
    pub fn begin_pass<'e>(
        &self,
        encoder: &'e mut wgpu::CommandEncoder,
        layer: usize,
        side: MapSide,
    ) -> wgpu::RenderPass<'e> {
        let mut pass = encoder.begin_render_pass(&wgpu::RenderPassDescriptor {
            label: Some("shadow map"),
            depth_stencil_attachment: depth_attachment(
                &self.sides[2 * layer + side as usize],
                wgpu::LoadOp::Clear(0.0),
            ),
            ..Default::default()
        });
        pass.set_bind_group(2, &self.view_group, &[layer as u32 * UNIFORM_OFFSET_ALIGNMENT as u32]);
        pass
    }
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
    (layer_views(&texture), texture_group(device, "shadow maps", layout, &[&array_view(&texture)]))
}

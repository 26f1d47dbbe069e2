//! One frame, pass by pass: shadow maps, geometry, lighting.

use super::draw_list::{DrawItem, DrawList, Pass, Uploads};
use super::gpu::{LossFlag, guarded};
use super::light_table::LightTable;
use super::mesh_cache::MeshCache;
use super::pipelines::{GeometryPipelines, Layouts, PicturePipelines};
use super::scene_buffers::{GpuFrame, SceneBuffers};
use super::shadow_maps::ShadowMaps;
use super::targets::{self, Output, Targets};
use super::texture_cache::{TextureCache, WHITE};
use super::{Pick, PreviewError, PreviewInput, shadow_views};
use eframe::wgpu;

/// Draws scenes on a graphics device and keeps what it uploaded between frames.
#[derive(Debug)]
pub struct PreviewRenderer {
    pub(super) device: wgpu::Device,
    pub(super) queue: wgpu::Queue,
    pub(super) loss: LossFlag,
    meshes: MeshCache,
    textures: TextureCache,
    buffers: SceneBuffers,
    shadow_maps: ShadowMaps,
    gbuffer_layout: wgpu::BindGroupLayout,
    geometry: GeometryPipelines,
    display: PicturePipelines,
    linear: Option<PicturePipelines>,
    pub(super) targets: Targets,
    generation: u64,
    /// What each record of the last frame stands for.
    pub(super) owners: Vec<Option<Pick>>,
}

impl PreviewRenderer {
    /// Compiles the pipelines. The device may be the window's.
    pub fn new(device: &wgpu::Device, queue: &wgpu::Queue) -> Result<Self, PreviewError> {
        let limits = device.limits();
        if limits.max_storage_buffers_per_shader_stage < 3 || limits.max_color_attachment_bytes_per_sample < 24 {
            return Err(PreviewError::Unsupported("no storage buffers or too small a G-buffer".to_owned()));
        }
        let loss = LossFlag::watch(device);
        guarded(device, &loss, || {
            let buffers = SceneBuffers::new(device);
            let textures = TextureCache::new(device, queue);
            let shadow_maps = ShadowMaps::new(device, queue);
            let gbuffer_layout = targets::lookup_layout(device);
            let layouts = Layouts {
                scene: buffers.layout(),
                texture: textures.layout(),
                gbuffer: &gbuffer_layout,
                shadow_view: shadow_maps.view_index_layout(),
                shadow_maps: shadow_maps.lookup_layout(),
            };
            let geometry = GeometryPipelines::new(device, &layouts);
            let display = PicturePipelines::new(device, &layouts, Output::Display);
            Ok(PreviewRenderer {
                device: device.clone(),
                queue: queue.clone(),
                loss: loss.clone(),
                meshes: MeshCache::default(),
                targets: Targets::new(device, &gbuffer_layout, (1, 1), Output::Display),
                textures,
                buffers,
                shadow_maps,
                gbuffer_layout,
                geometry,
                display,
                linear: None,
                generation: 0,
                owners: Vec::new(),
            })
        })
    }

    /// Draws a picture and submits it. The view is sRGB-encoded `Rgba8Unorm`, as egui samples user textures, and stays
    /// the same texture until `generation` changes.
    pub fn render(&mut self, input: &PreviewInput) -> Result<&wgpu::TextureView, PreviewError> {
        self.render_to(input, Output::Display)?;
        Ok(&self.targets.color_view)
    }

    /// The picture of the last `render`.
    pub fn color_view(&self) -> &wgpu::TextureView {
        &self.targets.color_view
    }

    /// Grows when the texture of the picture is replaced, after a change of size: register the view anew.
    pub fn generation(&self) -> u64 {
        self.generation
    }

    /// Pixels across and down of the last picture.
    pub fn size(&self) -> (u32, u32) {
        self.targets.size
    }

    pub(super) fn render_to(&mut self, input: &PreviewInput, output: Output) -> Result<(), PreviewError> {
        let (device, loss) = (self.device.clone(), self.loss.clone());
        let done = guarded(&device, &loss, || {
            self.resize(input.size, output);
            self.draw(input, output);
            Ok(())
        });
        if done.is_err() {
            self.shadow_maps.invalidate();
        }
        done
    }

    fn resize(&mut self, size: (u32, u32), output: Output) {
        let largest = self.device.limits().max_texture_dimension_2d;
        let size = (size.0.clamp(1, largest), size.1.clamp(1, largest));
        if self.targets.size != size || self.targets.output != output {
            self.targets = Targets::new(&self.device, &self.gbuffer_layout, size, output);
            self.generation += 1;
        }
        if output == Output::Linear && self.linear.is_none() {
            let layouts = Layouts {
                scene: self.buffers.layout(),
                texture: self.textures.layout(),
                gbuffer: &self.gbuffer_layout,
                shadow_view: self.shadow_maps.view_index_layout(),
                shadow_maps: self.shadow_maps.lookup_layout(),
            };
            self.linear = Some(PicturePipelines::new(&self.device, &layouts, output));
        }
    }

    fn draw(&mut self, input: &PreviewInput, output: Output) {
        self.meshes.begin_frame();
        let list = DrawList::new(
            input.scene,
            &input.overlay,
            &mut Uploads {
                device: &self.device,
                queue: &self.queue,
                meshes: &mut self.meshes,
                textures: &mut self.textures,
                assets: input.assets,
            },
        );
        let mut table = LightTable::new(input.scene, input.options.bounce_estimate);
        let views =
            if input.options.shadows { shadow_views::plan(&mut table.lights, &list.casters) } else { Vec::new() };
        let stale =
            self.shadow_maps.stale(&self.device, &views, list.caster_signature, input.options.shadow_resolution);
        let mut frame = GpuFrame::new(&input.frame, self.targets.size);
        frame.light_count = table.lights.len() as u32;
        frame.shadows = u32::from(input.options.shadows);
        frame.selected = u32::from(!list.outlined.is_empty());
        frame.set_ambient(input.scene, &table.ambient, input.overlay.void_color, input.options.environment_estimate);
        self.buffers.write(&self.device, &self.queue, &frame, &list.records, &table.lights, &views);

        let mut encoder = self.device.create_command_encoder(&Default::default());
        for layer in stale {
            self.shadow_pass(&mut encoder, &list, layer);
        }
        self.geometry_pass(&mut encoder, &list);
        self.lighting_pass(&mut encoder, output);
        self.queue.submit([encoder.finish()]);
        self.textures.drop_unused();
        self.owners = list.owners;
    }

    fn shadow_pass(&self, encoder: &mut wgpu::CommandEncoder, list: &DrawList, layer: usize) {
        let mut pass = self.shadow_maps.begin_pass(encoder, layer);
        pass.set_pipeline(&self.geometry.shadow);
        pass.set_bind_group(0, self.buffers.bind_group(), &[]);
        for item in list.items.iter().filter(|item| item.casts_shadow) {
            self.draw_item(&mut pass, item);
        }
    }

    fn geometry_pass(&self, encoder: &mut wgpu::CommandEncoder, list: &DrawList) {
        let clear = |view| {
            Some(wgpu::RenderPassColorAttachment {
                view,
                depth_slice: None,
                resolve_target: None,
                ops: wgpu::Operations {
                    load: wgpu::LoadOp::Clear(wgpu::Color::TRANSPARENT),
                    store: wgpu::StoreOp::Store,
                },
            })
        };
        let mut pass = encoder.begin_render_pass(&wgpu::RenderPassDescriptor {
            label: Some("geometry"),
            color_attachments: &[clear(&self.targets.gbuffer), clear(&self.targets.ids_view)],
            depth_stencil_attachment: Some(wgpu::RenderPassDepthStencilAttachment {
                view: &self.targets.depth,
                depth_ops: Some(wgpu::Operations { load: wgpu::LoadOp::Clear(0.0), store: wgpu::StoreOp::Store }),
                stencil_ops: None,
            }),
            ..Default::default()
        });
        pass.set_bind_group(0, self.buffers.bind_group(), &[]);
        for item in list.items.iter().filter(|item| item.pass != Pass::Glass) {
            let (textured, one_sided) = (item.texture != WHITE, item.pass == Pass::OneSided);
            pass.set_pipeline(&self.geometry.geometry[usize::from(textured)][usize::from(one_sided)]);
            pass.set_bind_group(1, self.textures.get(item.texture), &[]);
            self.draw_item(&mut pass, item);
        }
    }

    fn lighting_pass(&self, encoder: &mut wgpu::CommandEncoder, output: Output) {
        let pipelines = match (output, &self.linear) {
            (Output::Linear, Some(linear)) => linear,
            _ => &self.display,
        };
        let mut pass = encoder.begin_render_pass(&wgpu::RenderPassDescriptor {
            label: Some("lighting"),
            color_attachments: &[Some(wgpu::RenderPassColorAttachment {
                view: &self.targets.color_view,
                depth_slice: None,
                resolve_target: None,
                ops: wgpu::Operations { load: wgpu::LoadOp::Clear(wgpu::Color::BLACK), store: wgpu::StoreOp::Store },
            })],
            ..Default::default()
        });
        pass.set_pipeline(&pipelines.lighting);
        pass.set_bind_group(0, self.buffers.bind_group(), &[]);
        pass.set_bind_group(1, &self.targets.lookup, &[]);
        pass.set_bind_group(2, self.shadow_maps.lookup(), &[]);
        pass.draw(0..3, 0..1);
    }

    fn draw_item(&self, pass: &mut wgpu::RenderPass, item: &DrawItem) {
        let Some(mesh) = self.meshes.get(item.mesh) else { return };
        pass.set_vertex_buffer(0, mesh.vertices.slice(..));
        pass.set_index_buffer(mesh.indices.slice(..), wgpu::IndexFormat::Uint32);
        pass.draw_indexed(item.indices.clone(), 0, item.record..item.record + 1);
    }
}

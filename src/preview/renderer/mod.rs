//! One frame: what has changed since the last one, and which passes draw it.

mod passes;

use super::channel::Channel;
use super::geometry::draw_list::{Caster, DrawItem, DrawList, Pass, Uploads};
use super::geometry::draw_uniforms::DrawUniforms;
use super::geometry::mesh_cache::MeshCache;
use super::geometry::texture_cache::TextureCache;
use super::gpu::device::{LossFlag, guarded};
use super::lights::environment::Environment;
use super::lights::light_table::LightTable;
use super::lights::light_tiles::{TILES_BYTES, light_tiles};
use super::lights::lighting_pass::LightingPasses;
use super::overlay::gizmo::Gizmos;
use super::overlay::overlay_pass::{self, OverlayPass};
use super::pick::WaitingPick;
use super::pipelines::{GeometryPipelines, LightingVariant, MaskPipelines};
use super::scene_buffers::{GpuFrame, LIGHTS_BYTES, SceneBuffers};
use super::shadows::focus::Seen;
use super::shadows::layers::StaleMap;
use super::shadows::maps::{ShadowMaps, Side};
use super::shadows::mask::ShadowMasks;
use super::shadows::views::ShadowPlan;
use super::targets::{Output, TargetLayouts, Targets};
use super::{Options, Pick, PreviewError, PreviewInput};
use crate::scene::CameraFrame;
use eframe::wgpu;
use passes::layouts;
use std::hash::{DefaultHasher, Hash, Hasher};

/// More lights than this are many: a draft is at its coarsest.
const MANY_LIGHTS: usize = 24;

/// Draws scenes on a graphics device and keeps what it uploaded between frames.
#[derive(Debug)]
pub struct PreviewRenderer {
    pub(super) device: wgpu::Device,
    pub(super) queue: wgpu::Queue,
    pub(super) loss: LossFlag,
    meshes: MeshCache,
    textures: TextureCache,
    draws: DrawUniforms,
    buffers: SceneBuffers,
    shadow_maps: ShadowMaps,
    target_layouts: TargetLayouts,
    shadow_masks: ShadowMasks,
    geometry: GeometryPipelines,
    masking: MaskPipelines,
    lighting: LightingPasses,
    overlay: OverlayPass,
    /// The adapter is a software rasteriser.
    on_processor: bool,
    drawn: Drawn,
    redrawn_maps: usize,
    pub(super) targets: Targets,
    generation: u64,
    /// What each record of the last frame stands for.
    pub(super) owners: Vec<Option<Pick>>,
    /// What was drawn over the last frame, and where it was seen from.
    pub(super) gizmos: Gizmos,
    pub(super) view: Option<CameraFrame>,
    pub(super) waiting_pick: Option<WaitingPick>,
}

/// What the buffers of the last frame hold, so that a change of power or colour alone draws no geometry.
#[derive(Clone, Copy, Debug, Default)]
struct Drawn {
    geometry: Option<u64>,
    masks: Option<u64>,
}

impl PreviewRenderer {
    /// Compiles the pipelines for a device of its own.
    pub fn new(device: &wgpu::Device, queue: &wgpu::Queue) -> Result<Self, PreviewError> {
        Self::watched(device, queue, LossFlag::watch(device))
    }

    /// Compiles the pipelines for a device that others use, too, and whose loss `loss` tells.
    pub fn watched(device: &wgpu::Device, queue: &wgpu::Queue, loss: LossFlag) -> Result<Self, PreviewError> {
        let limits = device.limits();
        if limits.max_storage_buffers_per_shader_stage < 1
            || limits.max_color_attachment_bytes_per_sample < 24
            || limits.max_uniform_buffer_binding_size < LIGHTS_BYTES.max(TILES_BYTES)
        {
            return Err(PreviewError::Unsupported("too small buffers or too small a G-buffer".to_owned()));
        }
        guarded(device, &loss, || {
            let buffers = SceneBuffers::new(device);
            let textures = TextureCache::new(device, queue);
            let draws = DrawUniforms::new(device);
            let shadow_maps = ShadowMaps::new(device);
            let target_layouts = TargetLayouts::new(device);
            let shadow_masks = ShadowMasks::new(device);
            let on_processor = device.adapter_info().device_type == wgpu::DeviceType::Cpu;
            let layouts = layouts(&buffers, &textures, &draws, &target_layouts, &shadow_maps, &shadow_masks);
            let geometry = GeometryPipelines::new(device, &layouts);
            let masking = MaskPipelines::new(device, &layouts);
            let lighting = LightingPasses::new(device, &layouts);
            let overlay = OverlayPass::new(device, &layouts);
            Ok(PreviewRenderer {
                device: device.clone(),
                queue: queue.clone(),
                loss: loss.clone(),
                meshes: MeshCache::default(),
                targets: Targets::new(device, &target_layouts, (1, 1), Output::Display),
                textures,
                draws,
                buffers,
                shadow_maps,
                target_layouts,
                geometry,
                shadow_masks,
                masking,
                lighting,
                overlay,
                gizmos: Gizmos::default(),
                view: None,
                waiting_pick: None,
                on_processor,
                drawn: Drawn::default(),
                redrawn_maps: 0,
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

    /// How many shadow maps the last picture drew anew; the others still showed what they should.
    pub fn redrawn_shadow_maps(&self) -> usize {
        self.redrawn_maps
    }

    /// Whether `Options::draft` makes a difference here: the adapter is a processor.
    pub fn draws_drafts(&self) -> bool {
        self.on_processor
    }

    /// Picture pixels a pixel of the shadow masks, along each side: a processor draws soft shadows at half the size,
    /// and at a quarter while something moves, or an eighth under lights so many that each matters little.
    fn mask_scale(&self, draft: bool, table: &LightTable) -> u32 {
        match (self.on_processor, draft) {
            (false, _) => 1,
            (true, false) => 2,
            (true, true) if table.lights.len() > MANY_LIGHTS => 8,
            (true, true) => 4,
        }
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
            self.drawn = Drawn::default();
        }
        done
    }

    fn resize(&mut self, size: (u32, u32), output: Output) {
        let largest = self.device.limits().max_texture_dimension_2d;
        let size = (size.0.clamp(1, largest), size.1.clamp(1, largest));
        if self.targets.size != size || self.targets.output != output {
            self.targets = Targets::new(&self.device, &self.target_layouts, size, output);
            self.generation += 1;
            self.drawn = Drawn::default();
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
        let table = LightTable::new(input.scene, input.options.bounce_estimate, input.options.only_light);
        let overlay_alone = input.options.overlay_alone;
        let channel = input.options.channel;
        let needs_light = channel.is_lit() && !overlay_alone;
        let casters: &[_] = if input.options.shadows && needs_light { &list.casters } else { &[] };
        let draft = input.options.draft && self.on_processor && output == Output::Display;
        let seen = Seen::new(&input.frame, casters, input.scene.room.as_ref());
        let mut plan = ShadowPlan::new(&table, casters, &seen, !draft);
        let resolution = input.options.shadow_resolution;
        let stale = self.shadow_maps.place(&self.device, &self.queue, &mut plan, &list, resolution);
        self.redrawn_maps = stale.len();
        let scale = self.mask_scale(draft, &table);
        let frame = GpuFrame { mask_scale: scale, cell_scale: cell_scale(&table), ..self.frame(input, &table) };
        let frame = GpuFrame { depth_range_m: depth_range_m(&input.frame, &list.casters), ..frame };
        let tiles = if input.options.light_radius { light_tiles(&table, &input.frame) } else { None };
        self.buffers.write(&self.device, &self.queue, &frame, &list.records, &table.lights, tiles.as_deref());

        self.draws.write(&self.device, &self.queue, &list.draws);
        let geometry = geometry_signature(&frame, &list);
        let masks = mask_signature(geometry, &plan);
        let renewed = self.shadow_masks.prepare(&self.device, &self.queue, &plan, self.mask_size(scale));
        let geometry_drawn = self.drawn.geometry == Some(geometry);
        let masks_drawn = self.drawn.masks == Some(masks) && stale.is_empty() && !renewed;

        let mut encoder = self.device.create_command_encoder(&Default::default());
        for StaleMap { layer, view } in stale {
            let seen = |item: &&DrawItem| list.is_seen(item, &view);
            let items: Vec<&DrawItem> = list.items.iter().filter(seen).collect();
            self.shadow_pass(&mut encoder, &items, layer, Side::Near);
            self.shadow_pass(&mut encoder, &items, layer, Side::Far);
        }
        if !geometry_drawn {
            self.geometry_pass(&mut encoder, &list, &input.frame);
        }
        if !masks_drawn {
            let raw = &self.masking.raw[usize::from(plan.is_in_parts())];
            (0..plan.masks.len()).for_each(|mask| self.mask_passes(&mut encoder, raw, mask));
        }
        let variant = LightingVariant {
            output,
            families: table.families(),
            masks: plan.masks.len(),
            scale,
            reach: input.options.light_radius,
            listed: tiles.is_some(),
            beams: table.lights.iter().any(|light| light.has_beam != 0),
            cells: draft,
            illuminance: channel == Channel::Illuminance,
            gloss: input.options.gloss,
        };
        if needs_light {
            self.lighting_pass(&mut encoder, variant, frame.cell_scale);
        }
        let has_glass = list.items.iter().any(|item| item.pass == Pass::Glass);
        if has_glass {
            self.glass_pass(&mut encoder, &list, &table, output);
        }
        if !channel.is_lit() {
            self.channel_pass(&mut encoder, channel);
        }
        if overlay_alone {
            overlay_pass::clear(&mut encoder, &self.targets.color_view);
        }
        self.view = Some(input.frame);
        self.gizmos = Gizmos::default();
        if output == Output::Display {
            self.overlay_pass(&mut encoder, input, &list);
        }
        self.queue.submit([encoder.finish()]);
        // Glass has left its marks in the id buffer: what lies behind it is drawn anew.
        self.drawn = if has_glass { Drawn::default() } else { Drawn { geometry: Some(geometry), masks: Some(masks) } };
        self.textures.drop_unused();
        self.owners = list.owners;
    }

    fn frame(&self, input: &PreviewInput, table: &LightTable) -> GpuFrame {
        let mut frame = GpuFrame::new(&input.frame, self.targets.size);
        frame.light_ends = table.ends;
        frame.set_ambient(&table.ambient, input.overlay.void_color);
        let Options { bounce_estimate, environment_estimate, .. } = input.options;
        if let Some(environment) = Environment::new(input.scene, table) {
            if environment_estimate {
                frame.set_environment(&environment);
            }
            // A room has its own estimate, which counts all bounces.
            if bounce_estimate && input.scene.room.is_none() {
                frame.set_bounce(&environment);
            }
        }
        frame
    }

    fn mask_size(&self, scale: u32) -> (u32, u32) {
        let (width, height) = self.targets.size;
        (width.div_ceil(scale), height.div_ceil(scale))
    }
}

/// From the nearest to the farthest of what stands in the studio along the axis of a view that looks from far away, as
/// parallel ones do, and a little more; nothing for others.
fn depth_range_m(frame: &CameraFrame, casters: &[Caster]) -> [f32; 2] {
    /// No perspective view of a studio looks from so far.
    const FAR_M: f32 = 200.0;
    const MARGIN_M: f32 = 0.25;
    let (eye, forward) = (frame.position(), frame.forward());
    let depths = casters.iter().flat_map(Caster::corners).map(|corner| (corner - eye).dot(forward));
    let (near, far) = depths.fold((f32::INFINITY, 0.0_f32), |(near, far), depth| (near.min(depth), far.max(depth)));
    if near > FAR_M && far >= near { [near - MARGIN_M, far + MARGIN_M] } else { [0.0; 2] }
}

/// Side of a draft's cells, pixels: the more lights, the larger, so that many of them stay fluid. Panels and balls cost
/// several times what lights without a size do.
fn cell_scale(table: &LightTable) -> u32 {
    let without_size = table.ends[0] as usize;
    match (table.lights.len(), table.lights.len() - without_size) {
        (0..=8, 0..=2) => 3,
        (0..=MANY_LIGHTS, _) => 4,
        _ => 5,
    }
}

/// Changes when the G-buffer would.
fn geometry_signature(frame: &GpuFrame, list: &DrawList) -> u64 {
    let mut hasher = DefaultHasher::new();
    bytemuck::bytes_of(&frame.clip_from_world).hash(&mut hasher);
    bytemuck::bytes_of(&frame.size).hash(&mut hasher);
    bytemuck::cast_slice::<_, u8>(&list.draws).hash(&mut hasher);
    for item in &list.items {
        (item.mesh, &item.indices, item.record, item.texture, item.pass as u32).hash(&mut hasher);
    }
    hasher.finish()
}

/// Changes when the shadow masks would, for the same maps.
fn mask_signature(geometry: u64, plan: &ShadowPlan) -> u64 {
    let mut hasher = DefaultHasher::new();
    geometry.hash(&mut hasher);
    bytemuck::cast_slice::<_, u8>(&plan.masks).hash(&mut hasher);
    hasher.finish()
}

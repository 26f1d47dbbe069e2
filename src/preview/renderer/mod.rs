//! The renderer: plans a frame, uploads what changed and encodes the passes that are needed.

mod frame_plan;

use super::frame_resources::FrameResources;
use super::geometry::caches::GeometryCaches;
use super::geometry::draw_list::Uploads;
use super::geometry::geometry_pass::{self, StrandDetail};
use super::geometry::pipelines::GeometryPipelines;
use super::gpu::context::GpuContext;
use super::gpu::device::{LossFlag, guarded};
use super::gpu::pipeline::BindGroupLayouts;
use super::lighting::glass_pass;
use super::lighting::lighting_pass::LightingPasses;
use super::lights::light_tiles::TILES_BYTES;
use super::overlay::gizmo::Gizmos;
use super::overlay::overlay_pass::{self, OverlayPass};
use super::overlay::pick::Picking;
use super::scene_buffers::{FrameData, LIGHTS_BYTES, SceneBuffers};
use super::shadows::layers::StaleMap;
use super::shadows::maps::ShadowMaps;
use super::shadows::mask::ShadowMasks;
use super::shadows::shadow_passes::ShadowPasses;
use super::still_picture::StillPictures;
use super::targets::{Output, RenderTargets, TargetLayouts};
use super::{ObjectMask, Pick, PickHit, PreviewError, PreviewInput};
use eframe::wgpu;
use frame_plan::{FramePlan, diffuses, needs_lighting};

/// Draws scenes on a GPU and keeps what it uploaded and drew between frames.
#[derive(Debug)]
pub struct PreviewRenderer {
    pub(super) gpu: GpuContext,
    caches: GeometryCaches,
    buffers: SceneBuffers,
    pub(super) targets: RenderTargets,
    geometry: GeometryPipelines,
    shadows: ShadowPasses,
    lighting: LightingPasses,
    overlay: OverlayPass,
    picking: Picking,
    stills: StillPictures,
    drawn: DrawnFrame,
}

/// The contents of the targets after the last frame.
#[derive(Clone, Copy, Debug, Default)]
struct DrawnFrame {
    /// Signature of the G-buffer, see [`FramePlan::gbuffer_signature`].
    gbuffer: Option<u64>,
    /// Signature of the shadow masks, see [`FramePlan::mask_signature`].
    masks: Option<u64>,
    /// Number of shadow maps that the frame drew.
    shadow_maps: usize,
}

/// The passes of a frame whose results are cached and out of date.
#[derive(Debug)]
struct StalePasses {
    shadow_maps: Vec<StaleMap>,
    gbuffer: bool,
    masks: bool,
}

impl PreviewRenderer {
    /// Compiles the pipelines for a device that nothing else uses.
    pub fn new(device: &wgpu::Device, queue: &wgpu::Queue) -> Result<Self, PreviewError> {
        Self::watched(device, queue, LossFlag::watch(device))
    }

    /// Compiles the pipelines for a shared device, whose loss sets `loss`.
    pub fn watched(device: &wgpu::Device, queue: &wgpu::Queue, loss: LossFlag) -> Result<Self, PreviewError> {
        let limits = device.limits();
        if limits.max_storage_buffers_per_shader_stage < 1
            || limits.max_color_attachment_bytes_per_sample < 24
            || limits.max_uniform_buffer_binding_size < LIGHTS_BYTES.max(TILES_BYTES)
        {
            return Err(PreviewError::Unsupported("too small buffers or too small a G-buffer".to_owned()));
        }
        guarded(device, &loss, || Ok(Self::compiled(GpuContext::new(device, queue, loss.clone()))))
    }

    /// Replaces the flag that a loss of the device sets, for a renderer that moves to another window.
    pub fn set_loss_flag(&mut self, loss: LossFlag) {
        self.gpu.loss = loss;
    }

    fn compiled(gpu: GpuContext) -> Self {
        let device = &gpu.device;
        // Create the resources, which bring their bind group layouts
        let caches = GeometryCaches::new(device, &gpu.queue);
        let buffers = SceneBuffers::new(device);
        let target_layouts = TargetLayouts::new(device);
        let (maps, masks) = (ShadowMaps::new(device), ShadowMasks::new(device));
        let layouts = BindGroupLayouts {
            scene: buffers.layout().clone(),
            texture: caches.textures.layout().clone(),
            draw: caches.draws.layout().clone(),
            gbuffer: target_layouts.gbuffer.clone(),
            coarse: target_layouts.coarse.clone(),
            shadow_view: maps.view_layout().clone(),
            shadow_maps: maps.texture_layout().clone(),
            shadow_slots: masks.slots_layout().clone(),
            raw_mask: masks.raw_layout().clone(),
            masks: masks.masks_layout().clone(),
        };
        // Compile the pipelines
        PreviewRenderer {
            caches,
            buffers,
            targets: RenderTargets::new(device, target_layouts),
            geometry: GeometryPipelines::new(device, &layouts),
            shadows: ShadowPasses::new(device, &layouts, maps, masks),
            overlay: OverlayPass::new(device, &layouts),
            lighting: LightingPasses::new(device, layouts),
            picking: Picking::default(),
            stills: StillPictures::new(device),
            drawn: DrawnFrame::default(),
            gpu,
        }
    }

    /// Draws a picture and submits it. The view is sRGB-encoded `Rgba8Unorm`, as egui samples user textures, and stays
    /// the same texture until `generation` changes.
    pub fn render(&mut self, input: &PreviewInput) -> Result<&wgpu::TextureView, PreviewError> {
        self.render_to(input, Output::Display)?;
        Ok(self.color_view())
    }

    /// The picture of the last `render`.
    pub fn color_view(&self) -> &wgpu::TextureView {
        &self.targets.current.color_view
    }

    /// Increases when the texture of the picture is replaced, after a change of size: register the new view.
    pub fn generation(&self) -> u64 {
        self.targets.generation
    }

    /// Width and height of the last picture in pixels.
    pub fn size(&self) -> (u32, u32) {
        self.targets.current.size
    }

    /// Number of shadow maps that the last picture drew; the others were still valid.
    pub fn redrawn_shadow_maps(&self) -> usize {
        self.drawn.shadow_maps
    }

    /// Returns the number of samples of a finished still picture; see `Options::sample`.
    pub fn still_samples(&self) -> u32 {
        if self.gpu.is_cpu { 6 } else { 16 }
    }

    /// Returns true if `Options::draft` has an effect: the adapter is a CPU rasteriser.
    pub fn draws_drafts(&self) -> bool {
        self.gpu.is_cpu
    }

    /// Returns the thing at a pixel of the last picture (from the top left corner); none for room, void, or a pixel
    /// outside. Waits for the device: a few milliseconds.
    pub fn pick_blocking(&self, pixel: (u32, u32)) -> Result<Option<Pick>, PreviewError> {
        Ok(self.hit_blocking(pixel)?.and_then(|hit| hit.pick))
    }

    /// Returns the thing and the point at a pixel of the last picture; none for a pixel outside. Waits for the device.
    pub fn hit_blocking(&self, pixel: (u32, u32)) -> Result<Option<PickHit>, PreviewError> {
        self.picking.hit_blocking(&self.gpu, &self.targets.current, pixel)
    }

    /// Starts a pick at a pixel of the last picture without waiting; `poll_pick` returns the result some frames later.
    /// A newer request replaces an older one.
    pub fn request_pick(&mut self, pixel: (u32, u32)) -> Result<(), PreviewError> {
        self.picking.request(&self.gpu, &self.targets.current, pixel)
    }

    /// Returns the result of `request_pick`, once; none while it is pending or nothing was requested.
    pub fn poll_pick(&mut self) -> Option<PickHit> {
        self.picking.poll(&self.gpu, &self.targets.current)
    }

    /// Reads back the object at each pixel of the last picture.
    pub fn object_mask(&self) -> Result<ObjectMask, PreviewError> {
        self.picking.object_mask(&self.gpu, &self.targets.current)
    }

    pub(super) fn render_to(&mut self, input: &PreviewInput, output: Output) -> Result<(), PreviewError> {
        let gpu = self.gpu.clone();
        let done = gpu.guarded(|| {
            self.draw(input, output);
            Ok(())
        });
        if done.is_err() {
            self.shadows.maps.invalidate();
            self.drawn = DrawnFrame { shadow_maps: self.drawn.shadow_maps, ..DrawnFrame::default() };
        }
        done
    }

    fn draw(&mut self, input: &PreviewInput, output: Output) {
        if self.targets.resize(&self.gpu.device, input.size, output, diffuses(input)) {
            self.drawn = DrawnFrame::default();
        }
        let mut plan = self.plan(input, output);
        let stale = self.upload(&mut plan, input.options.shadow_resolution);
        let gizmos = match output {
            Output::Display => Gizmos::new(input.scene, input.assets, &input.overlay, &input.frame),
            Output::Linear => Gizmos::default(),
        };
        self.encode(input, &plan, &stale, &gizmos);

        // Remember what the targets hold. Glass has overwritten the id buffer, so that the G-buffer pass must run
        // again.
        let (gbuffer, masks) = (Some(plan.gbuffer_signature()), Some(plan.mask_signature()));
        let (gbuffer, masks) = if plan.has_glass() { (None, None) } else { (gbuffer, masks) };
        self.drawn = DrawnFrame { gbuffer, masks, shadow_maps: stale.shadow_maps.len() };
        self.caches.textures.drop_unused();
        self.picking.surfaces = plan.list.picks;
        self.picking.view = Some(input.frame);
        self.picking.gizmos = gizmos;
    }

    fn plan(&mut self, input: &PreviewInput, output: Output) -> FramePlan {
        self.caches.meshes.begin_frame();
        let size = self.targets.current.size;
        let mut uploads = Uploads { gpu: &self.gpu, caches: &mut self.caches, assets: input.assets };
        FramePlan::new(input, size, output, &mut uploads)
    }

    /// Uploads the buffers of a frame, assigns its shadow map layers and returns the cached passes that must run again.
    fn upload(&mut self, plan: &mut FramePlan, shadow_resolution: u32) -> StalePasses {
        let FramePlan { list, lights, shadows, tiles, constants, bounced_light, .. } = plan;
        let (device, queue) = (&self.gpu.device, &self.gpu.queue);
        let shadow_maps = self.shadows.maps.prepare(&self.gpu, shadows, list, shadow_resolution);
        let data = FrameData {
            frame: constants,
            surfaces: &list.surfaces,
            lights: &lights.lights,
            tiles: tiles.as_deref(),
            bounced_light,
            tables: &lights.tables,
        };
        self.buffers.write(device, queue, &data);
        self.caches.draws.write(device, queue, &list.draws);
        let new_masks = self.shadows.masks.prepare(&self.gpu, &plan.shadows, plan.mask_size(self.size()));
        let masks = self.drawn.masks != Some(plan.mask_signature()) || !shadow_maps.is_empty() || new_masks;
        StalePasses { shadow_maps, gbuffer: self.drawn.gbuffer != Some(plan.gbuffer_signature()), masks }
    }

    /// Encodes and submits the passes of a frame.
    fn encode(&mut self, input: &PreviewInput, plan: &FramePlan, stale: &StalePasses, gizmos: &Gizmos) {
        let (device, queue) = (&self.gpu.device, &self.gpu.queue);
        let options = &input.options;
        let targets = &self.targets.current;
        let resources = FrameResources { scene: self.buffers.bind_group(), targets, caches: &self.caches };
        let mut encoder = device.create_command_encoder(&Default::default());

        // Before the second sample of a still picture, start the average of the first one, which the targets hold
        let is_sample = options.sample > 0 && plan.output == Output::Display;
        if is_sample && options.sample == 1 {
            self.stills.start(device, &mut encoder, &self.targets);
        }
        // Draw the stale shadow maps
        self.shadows.draw_maps(&mut encoder, resources, &plan.list, &stale.shadow_maps);
        // Draw opaque surfaces into the G-buffer. Where the id buffer is 0 the G-buffer is never read, and CPU
        // rasterisers save its clear
        if stale.gbuffer {
            let clear = !self.gpu.is_cpu;
            let pipelines = (&self.geometry, &self.shadows.strands);
            let strands = StrandDetail {
                pixel_angle: plan.constants.pixel_angle,
                factor: plan.constants.strand_width,
                sample: options.sample,
            };
            geometry_pass::draw(
                &mut encoder,
                pipelines,
                resources,
                &plan.list,
                &input.sample_frame(),
                (clear, strands),
            );
        }
        // Filter the shadow maps into the shadow masks
        if stale.masks {
            self.shadows.draw_masks(&mut encoder, resources, &plan.shadows);
        }
        // Light the G-buffer, at full or coarse resolution
        if needs_lighting(options) {
            let (masks, variant) = (self.shadows.masks.masks_group(), plan.lighting_variant(options));
            let coarse_scale = plan.constants.coarse_scale;
            self.lighting.draw(device, &mut encoder, resources, masks, variant, coarse_scale);
        }
        // Blend glass over the lit picture
        if plan.has_glass() {
            let light_kinds = plan.lights.groups_present();
            glass_pass::draw(device, &mut encoder, &mut self.lighting, resources, &plan.list, light_kinds);
        }
        // Replace the picture by a channel of the G-buffer, or by nothing
        if !options.channel.is_lit() {
            self.lighting.draw_channel(device, &mut encoder, resources, options.channel);
        }
        if options.overlay_alone {
            overlay_pass::clear(&mut encoder, &targets.color_view);
        }
        // Draw gizmos and the selection outline over it
        if plan.output == Output::Display {
            let outlined = self.overlay.outlined_area(&input.frame, targets.size, &plan.list.outlined);
            if outlined.is_some() || !gizmos.lines.is_empty() {
                self.overlay.upload(device, queue, gizmos);
                self.overlay.draw(&mut encoder, targets, resources.scene, outlined);
            }
        }
        if is_sample {
            self.stills.add_and_show(&mut encoder, &self.targets, options.sample);
        }
        queue.submit([encoder.finish()]);
    }
}

//! The plan of a frame: everything that is decided on the CPU before a pass is encoded.

use crate::photo::irradiance_grid::IrradianceGrid;
use crate::preview::channel::Channel;
use crate::preview::geometry::draw_item::DrawPass;
use crate::preview::geometry::draw_list::{DrawList, Uploads};
use crate::preview::geometry::oriented_box::OrientedBox;
use crate::preview::geometry::surface::{FLAG_RELIEF, diffusion_m};
use crate::preview::input::{Options, PreviewInput};
use crate::preview::lighting::pipelines::LightingVariant;
use crate::preview::lights::environment::Environment;
use crate::preview::lights::light_table::LightTable;
use crate::preview::lights::light_tiles::light_tiles;
use crate::preview::scene_buffers::GpuFrame;
use crate::preview::shadows::focus::VisibleReceivers;
use crate::preview::shadows::plan::ShadowPlan;
use crate::preview::targets::Output;
use crate::scene::{CameraFrame, Object};
use glam::Vec3;
use std::f32::consts::PI;
use std::hash::{DefaultHasher, Hash, Hasher};

/// With more lights than this, a draft uses its coarsest resolutions.
const MANY_LIGHTS: usize = 24;

/// Factor on the width of strands in a draft: fewer and wider strands cover as much, in less time.
const DRAFT_STRAND_WIDTH: f32 = 4.0;

/// The draw calls, lights, shadow views and constants of a frame.
#[derive(Debug)]
pub(super) struct FramePlan {
    pub list: DrawList,
    pub lights: LightTable,
    pub shadows: ShadowPlan,
    /// Lights per tile; none where every tile reads all lights.
    pub tiles: Option<Vec<[u32; 4]>>,
    pub constants: GpuFrame,
    pub bounced_light: IrradianceGrid,
    pub output: Output,
    /// Lighting at reduced resolution.
    pub is_draft: bool,
    /// Light spreads under soft surfaces. Drafts leave it out.
    pub is_diffused: bool,
}

impl FramePlan {
    /// Plans a frame of `size` pixels, uploading meshes and textures that the caches do not hold yet.
    pub fn new(input: &PreviewInput, size: (u32, u32), output: Output, uploads: &mut Uploads) -> Self {
        // Collect the scene's draw calls and lights
        let options = input.options;
        let list = DrawList::new(input.scene, &input.overlay, uploads);
        let lights = LightTable::new(input.scene, input.assets, options.bounce_estimate, options.only_light);
        let is_cpu = uploads.gpu.is_cpu;
        let is_draft = options.draft && is_cpu && output == Output::Display;

        // Fit the shadow map views to the casters and to the visible receivers
        let casters: &[_] = if options.shadows && needs_lighting(&options) { &list.casters } else { &[] };
        let receivers = VisibleReceivers::new(&input.frame, casters, input.scene.room.as_ref());
        let shadows = ShadowPlan::new(&lights, casters, &receivers, !is_draft);

        // Assign lights to screen tiles
        let tiles = if options.light_radius { light_tiles(&lights, &input.frame) } else { None };

        // Fill the frame constants
        let environment = Environment::new(input.scene, &lights);
        let bounced_light = bounced_light(input, &lights, environment.as_ref());
        let mut constants = frame_constants(input, size, &lights, environment.as_ref());
        constants.set_grid(&bounced_light.layout);
        constants.mask_scale = mask_scale(size, is_cpu, is_draft, lights.lights.len());
        let is_diffused = diffuses(input) && !is_draft;
        constants.coarse_scale = if is_diffused { 1 } else { coarse_scale(&lights) };
        constants.strand_width = if is_draft { DRAFT_STRAND_WIDTH } else { 1.0 };
        constants.depth_range_m = depth_range_m(&input.frame, &list.casters);
        FramePlan { list, lights, shadows, tiles, constants, bounced_light, output, is_draft, is_diffused }
    }

    /// Returns the specialisation of the lighting pass.
    pub fn lighting_variant(&self, options: &Options) -> LightingVariant {
        LightingVariant {
            output: self.output,
            light_kinds: self.lights.groups_present(),
            masks: self.shadows.masks.len(),
            mask_scale: self.constants.mask_scale,
            light_radius: options.light_radius,
            tiled: self.tiles.is_some(),
            has_beams: self.lights.lights.iter().any(|light| light.has_beam != 0),
            coarse: self.is_draft || self.is_diffused,
            illuminance: options.channel == Channel::Illuminance,
            gloss: options.gloss,
            has_fibres: !self.list.strands.is_empty(),
            // Frosting, in the last byte, is the glass pass's
            has_relief: self.list.surfaces.iter().any(|surface| surface.flags & FLAG_RELIEF != 0),
            has_layers: self.list.surfaces.iter().any(|surface| surface.layers & 0x00ff_00ff != 0),
        }
    }

    /// Returns true if the list has items for the glass pass.
    pub fn has_glass(&self) -> bool {
        self.list.items.iter().any(|item| item.pass == DrawPass::Glass)
    }

    /// Returns the size of the shadow masks in pixels.
    pub fn mask_size(&self, (width, height): (u32, u32)) -> (u32, u32) {
        let scale = self.constants.mask_scale;
        (width.div_ceil(scale), height.div_ceil(scale))
    }

    /// Returns a hash of everything that the G-buffer depends on.
    pub fn gbuffer_signature(&self) -> u64 {
        let mut hasher = DefaultHasher::new();
        bytemuck::bytes_of(&self.constants.clip_from_world).hash(&mut hasher);
        bytemuck::bytes_of(&self.constants.size).hash(&mut hasher);
        bytemuck::bytes_of(&self.constants.strand_width).hash(&mut hasher);
        bytemuck::cast_slice::<_, u8>(&self.list.draws).hash(&mut hasher);
        for item in &self.list.items {
            (item.mesh, &item.indices, item.surface, item.textures, item.pass as u32).hash(&mut hasher);
        }
        for item in &self.list.strands {
            (item.mesh, &item.instances, item.surface).hash(&mut hasher);
        }
        hasher.finish()
    }

    /// Returns a hash of everything that the shadow masks depend on besides the shadow maps. The layers must be
    /// assigned.
    pub fn mask_signature(&self) -> u64 {
        let mut hasher = DefaultHasher::new();
        self.gbuffer_signature().hash(&mut hasher);
        bytemuck::cast_slice::<_, u8>(&self.shadows.masks).hash(&mut hasher);
        hasher.finish()
    }
}

/// Returns true if the lighting pass and its shadows are drawn.
pub(super) fn needs_lighting(options: &Options) -> bool {
    options.channel.is_lit() && !options.overlay_alone
}

/// Returns true if a visible object scatters light under its surface, in a picture that shows it.
pub(super) fn diffuses(input: &PreviewInput) -> bool {
    let is_soft = |object: &Object| {
        let parts = object.part_materials.iter().map(|(_, material)| material);
        object.visible && parts.chain([&object.material]).any(|material| diffusion_m(material) != [0.0; 3])
    };
    needs_lighting(&input.options)
        && input.options.channel != Channel::Illuminance
        && input.scene.objects.iter().any(is_soft)
}

/// Returns the constants that depend on camera, lights and room alone.
fn frame_constants(
    input: &PreviewInput,
    size: (u32, u32),
    lights: &LightTable,
    environment: Option<&Environment>,
) -> GpuFrame {
    let mut frame = GpuFrame::new(&input.sample_frame(), size);
    frame.light_ends = lights.ends;
    frame.set_ambient(&lights.ambient, input.overlay.void_color);
    if let Some(environment) = environment.filter(|_| input.options.environment_estimate) {
        frame.set_environment(environment);
    }
    frame
}

/// Irradiance of the work light over pi, on surfaces that face +X, -X, +Y, -Y, +Z and -Z: from above and in front, so
/// that the sides of things differ.
const WORK_LIGHT: [f32; 6] = [0.42, 0.34, 0.62, 0.14, 0.5, 0.24];

/// Returns the bounced light: the traced one, or its estimate, which in a room is the same on all surfaces and without
/// one that of the backdrops on a subject; or the work light of a dark studio.
fn bounced_light(input: &PreviewInput, lights: &LightTable, environment: Option<&Environment>) -> IrradianceGrid {
    let environment = environment.filter(|_| input.scene.room.is_none());
    if input.has_work_light() {
        return IrradianceGrid::uniform(WORK_LIGHT.map(|e| Vec3::splat(e * PI)));
    }
    match input.bounced_light.filter(|grid| !grid.layout.is_empty()) {
        _ if !input.options.bounce_estimate => IrradianceGrid::uniform([Vec3::ZERO; 6]),
        Some(grid) => grid.clone(),
        None => {
            IrradianceGrid::uniform(environment.map_or([lights.ambient.bounced; 6], |estimate| estimate.irradiance))
        }
    }
}

/// Returns the picture pixels per shadow mask pixel along each axis: 1 on a GPU; on a CPU rasteriser 2, in drafts 4,
/// and 8 under many lights, each of which contributes little. Small pictures have finer masks, of up to as many pixels as
/// those of 1280x720: there, a thin shadow is but a few pixels wide.
fn mask_scale(size: (u32, u32), is_cpu: bool, is_draft: bool, light_count: usize) -> u32 {
    const FULL_SIZE: u32 = 1280 * 720;
    let coarsest = match (is_cpu, is_draft) {
        (false, _) => 1,
        (true, false) => 2,
        (true, true) if light_count > MANY_LIGHTS => 8,
        (true, true) => 4,
    };
    let fits = |scale: &u32| {
        size.0 as f32 * size.1 as f32 / (scale * scale) as f32 <= (FULL_SIZE / (coarsest * coarsest)) as f32
    };
    (1..coarsest).find(fits).unwrap_or(coarsest)
}

/// Returns the picture pixels per coarse pixel along each axis of a draft: the more lights, the larger. Panels and
/// spheres cost several times what lights without a size do.
fn coarse_scale(table: &LightTable) -> u32 {
    let without_size = table.ends[0] as usize;
    match (table.lights.len(), table.lights.len() - without_size) {
        (0..=8, 0..=2) => 3,
        (0..=MANY_LIGHTS, _) => 4,
        _ => 5,
    }
}

/// Returns the depths of the nearest and the farthest object along the axis of a camera that is far away, as parallel
/// views are, with a margin; zeros for other cameras.
fn depth_range_m(frame: &CameraFrame, casters: &[OrientedBox]) -> [f32; 2] {
    /// Perspective views of a studio are closer than this.
    const FAR_M: f32 = 200.0;
    const MARGIN_M: f32 = 0.25;
    let (eye, forward) = (frame.position(), frame.forward());
    let depths = casters.iter().flat_map(OrientedBox::corners).map(|corner| (corner - eye).dot(forward));
    let (near, far) = depths.fold((f32::INFINITY, 0.0_f32), |(near, far), depth| (near.min(depth), far.max(depth)));
    if near > FAR_M && far >= near { [near - MARGIN_M, far + MARGIN_M] } else { [0.0; 2] }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn masks_of_small_pictures_are_as_fine_as_the_picture_and_cost_no_more_than_those_of_large_ones() {
        for (size, full, draft, crowded) in [
            ((300, 200), 1, 2, 3),
            ((640, 360), 1, 2, 4),
            ((800, 600), 2, 3, 6),
            ((1280, 720), 2, 4, 8),
            ((3840, 2160), 2, 4, 8),
        ] {
            let scale = |is_draft, lights| mask_scale(size, true, is_draft, lights);
            assert_eq!((scale(false, 4), scale(true, 4), scale(true, 60)), (full, draft, crowded), "{size:?}");
            assert_eq!(mask_scale(size, false, false, 4), 1, "a GPU has masks of full size");
        }
    }
}

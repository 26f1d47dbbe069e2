//! The shadow passes: stale shadow maps, then the masks that the lighting pass reads.

use super::culling;
use super::layers::StaleMap;
use super::maps::{self, MapSide, ShadowMaps};
use super::mask::ShadowMasks;
use super::pipelines::ShadowPipelines;
use super::plan::ShadowPlan;
use crate::preview::frame_resources::FrameResources;
use crate::preview::geometry::draw_item::{DrawItem, StrandItem};
use crate::preview::geometry::draw_list::DrawList;
use crate::preview::geometry::strands::StrandPipelines;
use crate::preview::gpu::pipeline::BindGroupLayouts;
use eframe::wgpu;

/// The shadow maps, the shadow masks and their pipelines, and the pipelines of strands.
#[derive(Debug)]
pub(crate) struct ShadowPasses {
    pub maps: ShadowMaps,
    pub masks: ShadowMasks,
    pipelines: ShadowPipelines,
    pub strands: StrandPipelines,
}

/// The casters that a view may contain.
struct VisibleCasters<'a> {
    items: Vec<&'a DrawItem>,
    strands: Vec<&'a StrandItem>,
}

impl ShadowPasses {
    pub fn new(device: &wgpu::Device, layouts: &BindGroupLayouts, maps: ShadowMaps, masks: ShadowMasks) -> Self {
        let strands = StrandPipelines::new(device, layouts, maps::FORMAT);
        ShadowPasses { maps, masks, pipelines: ShadowPipelines::new(device, layouts), strands }
    }

    /// Draws the stale shadow maps, both sides of each.
    pub fn draw_maps(
        &self,
        encoder: &mut wgpu::CommandEncoder,
        resources: FrameResources,
        list: &DrawList,
        stale: &[StaleMap],
    ) {
        for StaleMap { layer, view } in stale {
            let visible = |caster| culling::is_visible(list, caster, view);
            let casters = VisibleCasters {
                items: list.items.iter().filter(|item| visible(item.caster)).collect(),
                strands: list.strands.iter().filter(|item| visible(item.caster)).collect(),
            };
            self.draw_map(encoder, resources, &casters, *layer, MapSide::Near);
            self.draw_map(encoder, resources, &casters, *layer, MapSide::Far);
        }
    }

    fn draw_map(
        &self,
        encoder: &mut wgpu::CommandEncoder,
        resources: FrameResources,
        casters: &VisibleCasters,
        layer: usize,
        side: MapSide,
    ) {
        let mut pass = self.maps.begin_pass(encoder, layer, side);
        pass.set_bind_group(0, resources.scene, &[]);
        for item in &casters.items {
            if let Some(pipeline) = self.pipelines.map(item.shadow, item.has_holes, side) {
                pass.set_pipeline(pipeline);
                if item.has_holes {
                    pass.set_bind_group(3, resources.caches.textures.get(&item.textures), &[]);
                }
                resources.caches.draw(&mut pass, item);
            }
        }
        for item in &casters.strands {
            let (fraction, _) = item.shadows.fraction_and_width();
            pass.set_pipeline(self.strands.shadow_map(item.shadows));
            resources.caches.draw_strands(&mut pass, item, item.first(fraction));
        }
    }

    /// Draws all masks of a plan: each filtered from the shadow maps, then blurred along surfaces.
    pub fn draw_masks(&self, encoder: &mut wgpu::CommandEncoder, resources: FrameResources, plan: &ShadowPlan) {
        let FrameResources { scene, targets, .. } = resources;
        let raw_mask = &self.pipelines.raw_mask[usize::from(plan.is_subdivided())];
        for mask in 0..plan.masks.len() {
            // Filter the shadow maps of four lights into the raw mask
            let mut pass = self.masks.begin_raw(encoder, mask);
            pass.set_pipeline(raw_mask);
            pass.set_bind_group(0, scene, &[]);
            pass.set_bind_group(1, &targets.gbuffer_group, &[]);
            pass.set_bind_group(2, self.maps.texture_group(), &[]);
            pass.draw(0..3, 0..1);
            drop(pass);
            // Blur the raw mask into its layer of the mask array
            let mut pass = self.masks.begin_blur(encoder, mask);
            pass.set_pipeline(&self.pipelines.mask_blur);
            pass.set_bind_group(0, scene, &[]);
            pass.set_bind_group(1, &targets.gbuffer_group, &[]);
            pass.draw(0..3, 0..1);
        }
    }
}

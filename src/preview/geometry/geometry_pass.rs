//! The geometry pass: opaque surfaces into the G-buffer, the id buffer and the depth buffer.

use super::clusters::ObjectFrustum;
use super::draw_item::{DrawPass, Sides};
use super::draw_list::DrawList;
use super::pipelines::{GeometryPipelines, Sampled};
use super::strands::StrandPipelines;
use crate::preview::frame_resources::FrameResources;
use crate::preview::gpu::bindings::{color_attachment, depth_attachment};
use crate::preview::scene_buffers::NEAR_M;
use crate::scene::CameraFrame;
use eframe::wgpu;
use glam::Mat4;

/// What decides which strands are drawn, and how wide.
#[derive(Clone, Copy, Debug)]
pub(crate) struct StrandDetail {
    /// Half the width of a pixel at 1 m.
    pub pixel_angle: f32,
    /// Factor on the width.
    pub factor: f32,
    /// Sample of a still picture.
    pub sample: u32,
}

/// Draws the opaque items of a list as `camera` sees them. `clear_gbuffer` clears the G-buffer besides ids and depth;
/// `strands` selects the strands.
pub(crate) fn draw(
    encoder: &mut wgpu::CommandEncoder,
    (pipelines, strand_pipelines): (&GeometryPipelines, &StrandPipelines),
    resources: FrameResources,
    list: &DrawList,
    camera: &CameraFrame,
    (clear_gbuffer, strands): (bool, StrandDetail),
) {
    let FrameResources { scene, targets, caches } = resources;
    let clear = wgpu::LoadOp::Clear(wgpu::Color::TRANSPARENT);
    let load = if clear_gbuffer { clear } else { wgpu::LoadOp::Load };
    let mut pass = encoder.begin_render_pass(&wgpu::RenderPassDescriptor {
        label: Some("geometry"),
        color_attachments: &[color_attachment(&targets.gbuffer, load), color_attachment(&targets.ids_view, clear)],
        depth_stencil_attachment: depth_attachment(&targets.depth, wgpu::LoadOp::Clear(0.0)),
        ..Default::default()
    });
    pass.set_bind_group(0, scene, &[]);
    let clip_from_world = camera.clip_from_world(NEAR_M);
    for item in list.items.iter().filter(|item| matches!(item.pass, DrawPass::Opaque | DrawPass::OneSided)) {
        let sides = list.sides(item, camera.position());
        pass.set_pipeline(pipelines.get(Sampled::of(item), sides));
        pass.set_bind_group(2, caches.textures.get(&item.textures), &[]);
        let world_from_object = list.transforms[item.surface as usize];
        let clip_from_object = clip_from_world * Mat4::from(world_from_object);
        let eye_object = world_from_object.inverse().transform_point3(camera.position());
        let cull_back_faces = matches!(sides, Sides::Front | Sides::Back);
        caches.draw_culled(&mut pass, item, &ObjectFrustum::new(eye_object, clip_from_object, cull_back_faces));
    }
    for item in &list.strands {
        let world_from_object = &list.transforms[item.surface as usize];
        let distance = list.casters.get(item.caster).map_or(1.0, |caster| caster.distance(camera.position()));
        let pixel_m = 2.0 * strands.pixel_angle * distance.max(NEAR_M);
        pass.set_pipeline(&strand_pipelines.geometry);
        caches.draw_strands(&mut pass, item, item.visible(pixel_m, strands.factor, strands.sample, world_from_object));
    }
}

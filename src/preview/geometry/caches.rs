//! The GPU caches of a scene's meshes, textures and draw records, and the draw calls that bind them.

use super::clusters::ObjectFrustum;
use super::draw_item::{DrawItem, StrandItem};
use super::draw_uniforms::DrawUniforms;
use super::mesh_cache::{GpuMesh, MeshCache};
use super::texture_cache::TextureCache;
use eframe::wgpu;

/// The caches that draw calls read.
#[derive(Debug)]
pub(crate) struct GeometryCaches {
    pub meshes: MeshCache,
    pub textures: TextureCache,
    pub draws: DrawUniforms,
}

impl GeometryCaches {
    pub fn new(device: &wgpu::Device, queue: &wgpu::Queue) -> Self {
        GeometryCaches {
            meshes: MeshCache::default(),
            textures: TextureCache::new(device, queue),
            draws: DrawUniforms::new(device),
        }
    }

    /// Draws all triangles of an item.
    pub fn draw(&self, pass: &mut wgpu::RenderPass, item: &DrawItem) {
        if self.bind(pass, item).is_some() {
            pass.draw_indexed(item.indices.clone(), 0, 0..1);
        }
    }

    /// Draws the clusters of an item that pass frustum and back-face culling.
    pub fn draw_culled(&self, pass: &mut wgpu::RenderPass, item: &DrawItem, frustum: &ObjectFrustum) {
        let Some(mesh) = self.bind(pass, item) else { return };
        for run in frustum.visible(mesh.clusters(&item.indices)) {
            pass.draw_indexed(run, 0, 0..1);
        }
    }

    /// Draws a run of instances of a part of a mesh's strands.
    pub fn draw_strands(&self, pass: &mut wgpu::RenderPass, item: &StrandItem, instances: std::ops::Range<u32>) {
        let Some(strands) = self.meshes.get(item.mesh).and_then(|mesh| mesh.strands.as_ref()) else { return };
        self.draws.bind(pass, item.surface);
        strands.draw(pass, instances);
    }

    fn bind(&self, pass: &mut wgpu::RenderPass, item: &DrawItem) -> Option<&GpuMesh> {
        let mesh = self.meshes.get(item.mesh)?;
        self.draws.bind(pass, item.surface);
        pass.set_vertex_buffer(0, mesh.vertices.slice(..));
        pass.set_index_buffer(mesh.indices.slice(..), wgpu::IndexFormat::Uint32);
        Some(mesh)
    }
}

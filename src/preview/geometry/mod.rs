//! The scene as draw calls: meshes and textures on the GPU, surface records, cluster culling, the geometry pass.

pub mod caches;
pub mod clusters;
pub mod draw_item;
pub mod draw_list;
pub mod draw_uniforms;
pub mod geometry_pass;
mod gpu_maps;
pub mod mesh_cache;
pub mod oriented_box;
pub mod pipelines;
pub mod strands;
pub mod surface;
pub mod texture_cache;
mod texture_sampling;

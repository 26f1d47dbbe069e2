//! The scene as draw calls: GPU meshes and textures, surface records, cluster culling.

pub mod clusters;
pub mod draw_list;
pub mod draw_uniforms;
pub mod mesh_cache;
pub mod texture_cache;

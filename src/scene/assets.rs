//! The loaded meshes and textures of a scene. `io` loads them; renderers read them.

use super::{AssetRef, Mannequin, Mesh, Object, Shape, tessellate};
use glam::Vec3;
use std::collections::HashMap;
use std::sync::Arc;

/// An sRGB picture, decoded to 8 bits a channel, rows from the top.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Texture {
    /// Pixels across.
    pub width: u32,
    /// Pixels down.
    pub height: u32,
    /// `width * height` pixels, red green blue, sRGB-encoded.
    pub rgb: Vec<[u8; 3]>,
}

/// The loaded assets of a scene. A clone shares the contents.
#[derive(Clone, Debug, Default)]
pub struct Assets {
    /// Mesh files by the path the scene names.
    pub meshes: HashMap<String, Arc<Mesh>>,
    /// Mannequins in use.
    pub mannequins: HashMap<Mannequin, Arc<Mesh>>,
    /// Textures by the path the scene names.
    pub textures: HashMap<String, Arc<Texture>>,
}

/// Returns the error message of an invalid asset path. Paths are relative, with `/` between folders, and stay inside the
/// scene's folder.
pub fn path_complaint(path: &str) -> Option<&'static str> {
    if path.is_empty() {
        Some("a path is needed")
    } else if path.contains('\\') {
        Some("write / between folders")
    } else if path.starts_with('/') || path.chars().nth(1) == Some(':') {
        Some("a path must be relative to the scene's folder")
    } else if path.split('/').any(|part| part == "..") {
        Some("a path must not lead out of the scene's folder")
    } else if path.chars().any(char::is_control) {
        Some("a path has no control characters")
    } else {
        None
    }
}

impl Assets {
    /// Returns true if the asset is loaded.
    pub fn contains(&self, asset: &AssetRef<'_>) -> bool {
        match asset {
            AssetRef::Mesh(path) => self.meshes.contains_key(path.as_ref()),
            AssetRef::Figure(figure) => self.mannequins.contains_key(figure),
            AssetRef::Texture(path) => self.textures.contains_key(path.as_ref()),
        }
    }

    /// Returns the axis-aligned box around an object in world space; none while its mesh is not loaded.
    pub fn object_bounds(&self, object: &Object) -> Option<(Vec3, Vec3)> {
        let (low, high) = self.mesh_of(&object.shape)?.bounds();
        let world_from_object = object.transform.world_from_object();
        let corner = |i: usize| Vec3::new([low.x, high.x][i & 1], [low.y, high.y][i >> 1 & 1], [low.z, high.z][i >> 2]);
        let corners = (0..8).map(|i| world_from_object.transform_point3(corner(i))).map(|p| (p, p));
        corners.reduce(|(low, high), (l, h)| (low.min(l), high.max(h)))
    }

    /// The triangles of a shape; none where its file is missing (loading has warned of it).
    pub fn mesh_of(&self, shape: &Shape) -> Option<Arc<Mesh>> {
        match shape {
            Shape::MeshFile { path } => self.meshes.get(path).cloned(),
            Shape::Mannequin(mannequin) => self.mannequins.get(mannequin).cloned(),
            primitive => tessellate(primitive).map(Arc::new),
        }
    }
}

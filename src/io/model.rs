//! The result of a model importer, and the limits that importers hold.

use super::error::AssetError;
use crate::scene::{Camera, Light, Material, Mesh};

/// The largest model that an importer accepts.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct ModelLimits {
    /// Size of the file, bytes.
    pub file_bytes: u64,
    /// Triangles of the mesh.
    pub triangles: usize,
}

/// Returns the bytes of the image with an index in an open model file, a PNG or JPEG file by itself.
pub(super) type ImageReader = Box<dyn Fn(u32) -> Result<Vec<u8>, AssetError> + Send + Sync>;

/// A model and the materials that its files give to its parts.
#[derive(Clone, Debug, PartialEq)]
pub struct ImportedModel {
    /// All groups as parts of one mesh. Positions in metres, Y up; unit normals.
    pub mesh: Mesh,
    /// Materials by the name of a part. Texture paths are relative to the model's folder.
    pub part_materials: Vec<(String, Material)>,
    /// Lamps and camera of the file.
    pub set_up: ModelSetUp,
    /// Missing files and repaired data, one sentence each.
    pub warnings: Vec<String>,
}

/// The set-up of a model, in its space.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct ModelSetUp {
    /// Its lamps, on, without modifiers. Point and spot lamps have their candela, suns their lux.
    pub lights: Vec<Light>,
    /// Its first camera with a perspective.
    pub camera: Option<Camera>,
}

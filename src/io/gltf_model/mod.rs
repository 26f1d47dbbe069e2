//! glTF 2.0 models: one mesh with a part for each node and material, from GLB files and from self-contained JSON.
//!
//! Skins and morph targets are applied as the file poses them. What the renderers have no property for is named in a
//! warning.

mod accessors;
mod buffers;
mod layers;
mod materials;
mod nodes;
mod set_up;
#[cfg(test)]
mod tests;
mod texture_slots;

use super::error::{AssetError, cut};
use super::load_progress::{LoadProgress, READING};
use super::model::{ImageReader, ImportedModel, ModelLimits};
use super::read::{read_limited, read_model};
use crate::scene::{Mesh, MeshPart};
use buffers::ModelFile;
use glam::Vec3;
use materials::MaterialReader;
use nodes::Nodes;
use std::collections::HashMap;
use std::path::Path;

/// Largest absolute coordinate of a vertex, in the file's unit.
const COORDINATE_LIMIT: f32 = 1e6;

/// Imports the default scene of a glTF file.
///
/// # Errors
/// If the file can't be read, exceeds the limits, needs an extension that is not read, or has a mistake.
pub(super) fn import(path: &Path, limits: &ModelLimits, progress: &LoadProgress) -> Result<ImportedModel, AssetError> {
    let bytes = read_model(path, limits.file_bytes, progress)?;
    let bad_model =
        |message: String| AssetError::BadModel { format: "glTF", message: cut(message), path: path.to_owned() };
    let file = ModelFile::parse(&bytes, Some((path, limits))).map_err(bad_model)?;
    assemble(&file, path, limits, progress).map_err(|error| match error {
        NoModel::Bad(message) => bad_model(message),
        NoModel::Cancelled(error) => error,
    })
}

/// Opens a glTF file for the images inside it.
///
/// # Errors
/// As [`import`].
pub(super) fn images(path: &Path, limits: &ModelLimits) -> Result<ImageReader, AssetError> {
    let bytes = read_limited(path, limits.file_bytes)?;
    let path = path.to_owned();
    let bad_model =
        move |message: String| AssetError::BadModel { format: "glTF", message: cut(message), path: path.clone() };
    let file = ModelFile::parse(&bytes, None).map_err(&bad_model)?;
    Ok(Box::new(move |image| file.image(image).map_err(&bad_model)))
}

/// Returns the files with data of a glTF file, by their paths from its folder. Pictures are none of them: materials name
/// them. Empty for a file that can't be read.
pub(super) fn companions(path: &Path, limits: &ModelLimits) -> Vec<String> {
    read_limited(path, limits.file_bytes).map(|bytes| buffers::companions(&bytes)).unwrap_or_default()
}

/// The reason why a file gives no model.
enum NoModel {
    /// It has a mistake.
    Bad(String),
    /// The import was cancelled.
    Cancelled(AssetError),
}

impl From<String> for NoModel {
    fn from(message: String) -> Self {
        NoModel::Bad(message)
    }
}

/// Builds the mesh of all nodes and collects their materials.
fn assemble(
    file: &ModelFile,
    path: &Path,
    limits: &ModelLimits,
    progress: &LoadProgress,
) -> Result<ImportedModel, NoModel> {
    let mut materials = MaterialReader::new(file, path);
    let (mut mesh, mut part_materials, mut names) = (Mesh::default(), Vec::new(), HashMap::new());
    let nodes = Nodes::new(&file.document);
    let count = nodes.primitives().count();
    for (index, primitive) in nodes.primitives().enumerate() {
        progress.reach_between([READING[1], 1.0], index, count).map_err(NoModel::Cancelled)?;
        let piece = primitive.mesh(file, &nodes, limits.triangles - mesh.triangles.len())?;
        if piece.triangles.is_empty() {
            continue;
        }
        let name = unique(&mut names, primitive.name());
        part_materials.push((name.clone(), materials.read(&primitive.primitive.material())));
        join(&mut mesh, piece, name);
    }
    if mesh.triangles.is_empty() {
        return Err(NoModel::Bad("it has no triangles".to_owned()));
    }
    if let Some(p) = mesh.positions.iter().find(|p| !p.is_finite() || p.abs().max_element() > COORDINATE_LIMIT) {
        return Err(NoModel::Bad(format!("the vertex {p} is not within {COORDINATE_LIMIT}")));
    }
    let mut warnings = materials.into_warnings();
    warnings.extend(file.left_out());
    if nodes.has_lines() {
        warnings.push("lines and points are left out".to_owned());
    }
    Ok(ImportedModel { mesh, part_materials, set_up: set_up::read(&nodes), warnings })
}

/// Returns a name that no part has yet: the name itself, or followed by a number.
fn unique(names: &mut HashMap<String, u32>, name: String) -> String {
    let uses = names.entry(name.clone()).and_modify(|uses| *uses += 1).or_insert(1);
    match *uses {
        1 => name,
        number => unique(names, format!("{name} {number}")),
    }
}

/// Appends a part. Attributes that some parts lack are filled in: texture coordinates with 0, colours with white.
fn join(mesh: &mut Mesh, piece: Mesh, name: String) {
    let (vertices, triangles) = (mesh.positions.len(), mesh.triangles.len());
    let total = vertices + piece.positions.len();
    if !(mesh.uvs.is_empty() && piece.uvs.is_empty()) {
        mesh.uvs.resize(vertices, Default::default());
        mesh.uvs.extend(piece.uvs);
        mesh.uvs.resize(total, Default::default());
    }
    if !(mesh.second_uvs.is_empty() && piece.second_uvs.is_empty()) {
        mesh.second_uvs.resize(vertices, Default::default());
        mesh.second_uvs.extend(piece.second_uvs);
        mesh.second_uvs.resize(total, Default::default());
    }
    if !(mesh.colors.is_empty() && piece.colors.is_empty()) {
        mesh.colors.resize(vertices, Vec3::ONE);
        mesh.colors.extend(piece.colors);
        mesh.colors.resize(total, Vec3::ONE);
    }
    mesh.positions.extend(piece.positions);
    mesh.normals.extend(piece.normals);
    // The triangles of a mesh are limited, and so are its vertices
    let first = u32::try_from(vertices).unwrap_or(u32::MAX);
    mesh.triangles.extend(piece.triangles.into_iter().map(|corners| corners.map(|corner| corner + first)));
    let range = [triangles, mesh.triangles.len()].map(|index| u32::try_from(index).unwrap_or(u32::MAX));
    mesh.parts.push(MeshPart { name, triangles: range[0]..range[1] });
}

//! OBJ models: one mesh with a part for each group, materials from MTL files.

mod chunks;
mod continued_lines;
mod groups;
mod lines;
mod materials;
mod mesh_index;
mod normals;
mod weld;
mod write;

pub(super) use write::write;

use super::error::{AssetError, cut};
use super::load_progress::LoadProgress;
use super::model::{ImportedModel, ModelLimits, ModelSetUp};
use super::read::read_model;
use crate::scene::Mesh;
use chunks::{Elements, ReadError};
use glam::Vec3;
use materials::MaterialLibrary;
use std::collections::HashSet;
use std::path::Path;

/// Largest absolute coordinate of a vertex, metres.
const COORDINATE_LIMIT_M: f32 = 1e6;

/// Imports an OBJ file: polygons become triangles, groups become parts; missing normals are computed, smooth except at
/// hard edges. A missing MTL file is a warning.
///
/// # Errors
/// If the file can't be read, exceeds the limits, or has a mistake; the message names the line of a malformed one.
pub(super) fn import(path: &Path, limits: &ModelLimits, progress: &LoadProgress) -> Result<ImportedModel, AssetError> {
    let bytes = read_model(path, limits.file_bytes, progress)?;
    // Some programs begin text files with a byte order mark.
    let text = continued_lines::joined(bytes.strip_prefix(b"\xef\xbb\xbf").unwrap_or(&bytes));
    let bad_model = |message: String| AssetError::BadModel { format: "OBJ", message, path: path.to_owned() };
    let elements = chunks::parse(&text, limits.triangles, progress).map_err(|error| match error {
        ReadError::Cancelled(error) => error,
        ReadError::BadLine(message) => bad_model(cut(message)),
        ReadError::TooLarge(bytes) => AssetError::TooLarge {
            what: "the file's number of bytes",
            amount: bytes as u64,
            limit: chunks::FILE_LIMIT_BYTES as u64,
            path: path.to_owned(),
        },
        ReadError::TooManyTriangles(amount) => AssetError::TooLarge {
            what: "the model's number of triangles",
            amount: amount as u64,
            limit: limits.triangles as u64,
            path: path.to_owned(),
        },
    })?;
    let mut library = MaterialLibrary::beside(path);
    let mut imported = assemble(&elements, &mut library, normals::CREASE_DEG).map_err(bad_model)?;
    imported.warnings.extend(library.into_warnings());
    Ok(imported)
}

/// Builds the mesh of all groups and collects their materials.
fn assemble(elements: &Elements, library: &mut MaterialLibrary, crease_deg: f32) -> Result<ImportedModel, String> {
    let groups = groups::groups(&elements.faces, library);
    if groups.is_empty() {
        return Err("it has no faces".to_owned());
    }
    let names = groups::part_names(&groups, library);
    let (mut part_materials, mut named) = (Vec::new(), HashSet::new());
    for (group, name) in groups.iter().zip(&names) {
        if let Some(material) = library.get(group.material).filter(|_| named.insert(name.clone())) {
            part_materials.push((name.clone(), materials::convert(material)));
        }
    }
    let mut mesh = groups::weld(elements, &groups, names);
    if let Some(p) = mesh.positions.iter().find(|p| !p.is_finite() || p.abs().max_element() > COORDINATE_LIMIT_M) {
        return Err(format!("the vertex {p} is not within {COORDINATE_LIMIT_M} m"));
    }
    let mut warnings = Vec::new();
    if !mesh.uvs.iter().all(|uv| uv.is_finite()) {
        warnings.push("some texture coordinates are no numbers; all are left out".to_owned());
        mesh.uvs.clear();
    }
    ensure_normals_with(&mut mesh, crease_deg, &mut warnings);
    Ok(ImportedModel { mesh, part_materials, set_up: ModelSetUp::default(), warnings })
}

/// Makes triangles of every three vertices; corners at the same position become one vertex.
pub(super) fn weld_corners(mesh: &mut Mesh) {
    let first = normals::first_at_same_position(&mesh.positions);
    mesh.triangles = first.chunks_exact(3).map(|corners| [corners[0], corners[1], corners[2]]).collect();
}

/// Gives every vertex a unit normal: the file's if all of them are usable, else computed ones, smooth except at hard
/// edges. Vertices that no triangle has are dropped then.
pub(super) fn ensure_normals(mesh: &mut Mesh, warnings: &mut Vec<String>) {
    ensure_normals_with(mesh, normals::CREASE_DEG, warnings);
}

/// As [`ensure_normals`], for a crease angle.
fn ensure_normals_with(mesh: &mut Mesh, crease_deg: f32, warnings: &mut Vec<String>) {
    let unit: Option<Vec<Vec3>> = mesh.normals.iter().map(|n| n.try_normalize()).collect();
    match unit {
        Some(unit) if !unit.is_empty() => mesh.normals = unit,
        Some(_) => normals::compute_normals(mesh, crease_deg),
        None => {
            warnings.push("some normals have no direction; all are computed anew".to_owned());
            normals::compute_normals(mesh, crease_deg);
        }
    }
}

#[cfg(test)]
mod tests;

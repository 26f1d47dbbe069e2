//! OBJ models: one mesh, a part a group, surfaces from the MTL file where there is one.

mod groups;
mod lines;
mod materials;
mod pieces;
mod smooth;
mod weld;

use super::error::AssetError;
use super::model::{ImportedModel, ModelLimits};
use super::read::read_limited;
use crate::scene::Mesh;
use glam::Vec3;
use materials::Library;
use pieces::{Elements, Fault};
use std::collections::HashSet;
use std::path::Path;

/// Farthest vertex from the model's origin, metres.
const PLACE_LIMIT_M: f32 = 1e6;

/// Imports an OBJ file: polygons become triangles, groups become parts, missing normals are made smooth up to hard
/// edges. A missing MTL file is a warning.
///
/// # Errors
/// When the file can't be read, is too large, or has a mistake; the message names its line where it can.
pub(super) fn import(path: &Path, limits: &ModelLimits) -> Result<ImportedModel, AssetError> {
    let bytes = read_limited(path, limits.file_bytes)?;
    let bad_model = |message: String| AssetError::BadModel { format: "OBJ", message, path: path.to_owned() };
    let elements = pieces::read(&bytes, limits.triangles).map_err(|fault| match fault {
        Fault::Mistake(message) => bad_model(message),
        Fault::TooManyTriangles(amount) => AssetError::TooLarge {
            what: "the model's number of triangles",
            amount: amount as u64,
            limit: limits.triangles as u64,
            path: path.to_owned(),
        },
    })?;
    let mut library = Library::beside(path);
    let mut imported = assemble(&elements, &mut library, smooth::CREASE_DEG).map_err(bad_model)?;
    imported.warnings.extend(library.into_warnings());
    Ok(imported)
}

/// Reads one of the OBJ files that ship with the program, which have no mistakes and no MTL file.
pub(super) fn read_shipped(text: &[u8]) -> Option<Mesh> {
    let elements = pieces::read(text, usize::MAX).ok()?;
    // Figures are smooth all over.
    assemble(&elements, &mut Library::default(), 180.0).ok().map(|imported| imported.mesh)
}

/// One mesh of all groups.
fn assemble(elements: &Elements, library: &mut Library, crease_deg: f32) -> Result<ImportedModel, String> {
    let groups = groups::groups(&elements.faces, library);
    if groups.is_empty() {
        return Err("it has no faces".to_owned());
    }
    let names = groups::part_names(&groups, library);
    let (mut part_materials, mut named) = (Vec::new(), HashSet::new());
    for (group, name) in groups.iter().zip(&names) {
        if let Some(material) = library.get(group.material).filter(|_| named.insert(name.clone())) {
            part_materials.push((name.clone(), materials::surface(material)));
        }
    }
    let mut mesh = groups::weld(elements, &groups, names);
    if let Some(p) = mesh.positions.iter().find(|p| !p.is_finite() || p.abs().max_element() > PLACE_LIMIT_M) {
        return Err(format!("the vertex {p} is not within {PLACE_LIMIT_M} m"));
    }
    let mut warnings = Vec::new();
    if !mesh.uvs.iter().all(|uv| uv.is_finite()) {
        warnings.push("some texture coordinates are no numbers; all are left out".to_owned());
        mesh.uvs.clear();
    }
    mend_normals(&mut mesh, crease_deg, &mut warnings);
    Ok(ImportedModel { mesh, part_materials, warnings })
}
/// Unit normals for every vertex. The file's where they are all usable; else computed ones.
fn mend_normals(mesh: &mut Mesh, crease_deg: f32, warnings: &mut Vec<String>) {
    let unit: Option<Vec<Vec3>> = mesh.normals.iter().map(|n| n.try_normalize()).collect();
    match unit {
        Some(unit) if !unit.is_empty() => mesh.normals = unit,
        Some(_) => smooth::compute_normals(mesh, crease_deg),
        None => {
            warnings.push("some normals have no direction; all are computed anew".to_owned());
            smooth::compute_normals(mesh, crease_deg);
        }
    }
}

#[cfg(test)]
mod tests;

//! OBJ models through tobj: one mesh, a part a group, surfaces from the MTL file where there is one.

mod lines;
mod materials;
mod smooth;

use super::error::AssetError;
use crate::scene::{Material, Mesh, MeshPart};
use glam::{Vec2, Vec3};
use std::collections::HashMap;
use std::io::ErrorKind;
use std::path::Path;

/// Largest OBJ file, bytes.
const FILE_LIMIT_BYTES: u64 = 1 << 30;
/// Most triangles of a model.
const TRIANGLE_LIMIT: usize = 20_000_000;
/// Farthest vertex from the model's origin, metres.
const PLACE_LIMIT_M: f32 = 1e6;

/// A model and what its files say about its surfaces.
#[derive(Clone, Debug, PartialEq)]
pub struct ImportedObj {
    /// All groups as parts of one mesh, metres, with normals.
    pub mesh: Mesh,
    /// Surfaces for parts, from the MTL file. Texture paths are relative to the model's folder.
    pub part_materials: Vec<(String, Material)>,
    /// What was missing or mended.
    pub warnings: Vec<String>,
}

/// Imports an OBJ file: polygons become triangles, groups become parts, missing normals are made smooth up to hard
/// edges. A missing MTL file is a warning.
///
/// # Errors
/// When the file can't be read, is too large, or has a mistake; the message names its line where it can.
pub fn import_obj(path: &Path) -> Result<ImportedObj, AssetError> {
    let bytes = read_limited(path, FILE_LIMIT_BYTES)?;
    let text = String::from_utf8_lossy(&bytes);
    let bad_model = |message: String| AssetError::BadModel { message, path: path.to_owned() };
    lines::check(&text).map_err(bad_model)?;
    let library = materials::Library::beside(path);
    let (models, materials) =
        tobj::load_obj_buf(&mut text.as_bytes(), &tobj::GPU_LOAD_OPTIONS, |name| library.load(name))
            .map_err(|error| bad_model(error.to_string()))?;
    let triangles: usize = models.iter().map(|model| model.mesh.indices.len() / 3).sum();
    if triangles > TRIANGLE_LIMIT {
        let (amount, limit) = (triangles as u64, TRIANGLE_LIMIT as u64);
        return Err(AssetError::TooLarge {
            what: "the model's number of triangles",
            amount,
            limit,
            path: path.to_owned(),
        });
    }
    let materials = materials.unwrap_or_default();
    let mut imported = assemble(models, &materials, smooth::CREASE_DEG).map_err(bad_model)?;
    imported.warnings.extend(library.into_warnings());
    Ok(imported)
}

/// Reads one of the OBJ files that ship with the program, which need no checks and have no MTL file.
pub(super) fn read_shipped(text: &[u8]) -> Option<Mesh> {
    let no_materials = |_: &Path| Ok(Default::default());
    let (models, _) = tobj::load_obj_buf(&mut &text[..], &tobj::GPU_LOAD_OPTIONS, no_materials).ok()?;
    // Figures are smooth all over.
    assemble(models, &[], 180.0).ok().map(|imported| imported.mesh)
}

/// Reads a whole file that must not be larger than `limit`.
pub(super) fn read_limited(path: &Path, limit: u64) -> Result<Vec<u8>, AssetError> {
    use std::io::Read;
    let read_error = |source| AssetError::Read { source, path: path.to_owned() };
    // A pipe would keep us waiting for as long as nobody writes to it.
    let metadata = std::fs::metadata(path).map_err(read_error)?;
    if !metadata.is_file() {
        return Err(read_error(std::io::Error::new(ErrorKind::InvalidInput, "it is no regular file")));
    }
    let file = std::fs::File::open(path).map_err(read_error)?;
    let mut bytes = Vec::with_capacity(metadata.len().min(limit) as usize);
    file.take(limit + 1).read_to_end(&mut bytes).map_err(read_error)?;
    if bytes.len() as u64 > limit {
        let amount = metadata.len().max(bytes.len() as u64);
        return Err(AssetError::TooLarge { what: "the file's number of bytes", amount, limit, path: path.to_owned() });
    }
    Ok(bytes)
}

/// One mesh of all groups; groups without triangles are dropped.
fn assemble(models: Vec<tobj::Model>, materials: &[tobj::Material], crease_deg: f32) -> Result<ImportedObj, String> {
    let mut mesh = Mesh::default();
    let mut part_materials: Vec<(String, Material)> = Vec::new();
    let names = part_names(&models, materials);
    let has =
        |field: fn(&tobj::Mesh) -> bool| models.iter().filter(|m| !m.mesh.indices.is_empty()).all(|m| field(&m.mesh));
    let has_normals = has(|m| m.normals.len() == m.positions.len());
    let has_uvs = has(|m| m.texcoords.len() / 2 == m.positions.len() / 3);
    for (model, name) in models.iter().zip(names).filter(|(model, _)| !model.mesh.indices.is_empty()) {
        let (base, first) = (mesh.positions.len() as u32, mesh.triangles.len() as u32);
        mesh.positions.extend(triples(&model.mesh.positions));
        if has_normals {
            mesh.normals.extend(triples(&model.mesh.normals));
        }
        if has_uvs {
            mesh.uvs.extend(model.mesh.texcoords.chunks_exact(2).map(|uv| Vec2::new(uv[0], uv[1])));
        }
        mesh.triangles.extend(model.mesh.indices.chunks_exact(3).map(|t| [t[0] + base, t[1] + base, t[2] + base]));
        if let Some(material) = model.mesh.material_id.and_then(|id| materials.get(id))
            && !part_materials.iter().any(|(part, _)| *part == name)
        {
            part_materials.push((name.clone(), materials::surface(material)));
        }
        mesh.parts.push(MeshPart { name, triangles: first..mesh.triangles.len() as u32 });
    }
    if mesh.triangles.is_empty() {
        return Err("it has no faces".to_owned());
    }
    if let Some(p) = mesh.positions.iter().find(|p| !p.is_finite() || p.abs().max_element() > PLACE_LIMIT_M) {
        return Err(format!("the vertex {p} is not within {PLACE_LIMIT_M} m"));
    }
    let mut warnings = Vec::new();
    if !mesh.uvs.iter().all(|uv| uv.is_finite()) {
        warnings.push("some texture coordinates are no numbers; all are left out".to_owned());
        mesh.uvs.clear();
    }
    mend_normals(&mut mesh, crease_deg, &mut warnings);
    Ok(ImportedObj { mesh, part_materials, warnings })
}

/// A name a part: the group's, with the material's where a group has several, and the material's where there is no
/// group.
fn part_names(models: &[tobj::Model], materials: &[tobj::Material]) -> Vec<String> {
    const NAMELESS: &str = "unnamed_object";
    let mut times = HashMap::new();
    for model in models {
        *times.entry(model.name.as_str()).or_insert(0_u32) += 1;
    }
    let name = |model: &tobj::Model| {
        let material = model.mesh.material_id.and_then(|id| materials.get(id)).map(|m| m.name.as_str());
        match material {
            Some(material) if model.name == NAMELESS => material.to_owned(),
            Some(material) if times[model.name.as_str()] > 1 => format!("{} {material}", model.name),
            _ if model.name == NAMELESS => "surface".to_owned(),
            _ => model.name.clone(),
        }
    };
    models.iter().map(name).collect()
}

fn triples(values: &[f32]) -> impl Iterator<Item = Vec3> + '_ {
    values.chunks_exact(3).map(|v| Vec3::new(v[0], v[1], v[2]))
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

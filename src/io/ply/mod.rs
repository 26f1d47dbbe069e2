//! PLY models: vertices with normals, colours and texture coordinates where the file has them, and polygons; as text or
//! binary of either byte order (Turk 1994, "The PLY Polygon File Format").
//!
//! PLY has no unit and no materials. Elements and properties that are not read are skipped.

mod body;
mod header;
#[cfg(test)]
mod tests;

use super::error::{AssetError, cut};
use super::load_progress::{LoadProgress, PARSING};
use super::model::{ImportedModel, ModelLimits, ModelSetUp};
use super::obj;
use super::read::read_model;
use crate::color::srgb_decode;
use crate::scene::{Material, Mesh};
use body::Body;
use glam::{Vec2, Vec3};
use header::{Element, Header, Property, Scalar};
use std::path::Path;

/// Name of the only part.
const PART: &str = "Surface";
/// Largest absolute coordinate of a vertex, the file's unit.
const COORDINATE_LIMIT: f32 = 1e6;
/// Names of the property with the corners of a face.
const CORNER_NAMES: [&str; 2] = ["vertex_indices", "vertex_index"];
/// Names of the texture coordinates of a vertex.
const UV_NAMES: [[&str; 2]; 3] = [["s", "t"], ["u", "v"], ["texture_u", "texture_v"]];

/// Imports a PLY file.
///
/// # Errors
/// If the file can't be read, exceeds the limits, is cut off, or has a mistake.
pub(super) fn import(path: &Path, limits: &ModelLimits, progress: &LoadProgress) -> Result<ImportedModel, AssetError> {
    let bytes = read_model(path, limits.file_bytes, progress)?;
    let bad_model =
        |message: String| AssetError::BadModel { format: "PLY", message: cut(message), path: path.to_owned() };
    let (header, content) = Header::parse(&bytes).map_err(bad_model)?;
    let mesh = read_mesh(&header, Body::new(header.encoding, content, progress), limits.triangles);
    progress.reach(PARSING[1])?;
    let mut mesh = mesh.map_err(bad_model)?;
    if mesh.triangles.is_empty() {
        return Err(bad_model("it has no faces; clouds of points have no surface".to_owned()));
    }
    if let Some(p) = mesh.positions.iter().find(|p| !p.is_finite() || p.abs().max_element() > COORDINATE_LIMIT) {
        return Err(bad_model(format!("the vertex {p} is not within {COORDINATE_LIMIT}")));
    }
    let mut warnings = Vec::new();
    if !mesh.uvs.iter().all(|uv| uv.is_finite()) {
        warnings.push("some texture coordinates are no numbers; all are left out".to_owned());
        mesh.uvs.clear();
    }
    obj::ensure_normals(&mut mesh, &mut warnings);
    // Colours are factors of the base colour
    let painted = Material { base_color: [1.0; 3], roughness: 0.6, ..Material::default() };
    let part_materials = if mesh.colors.is_empty() { Vec::new() } else { vec![(PART.to_owned(), painted)] };
    Ok(ImportedModel { mesh: mesh.with_single_part(PART), part_materials, set_up: ModelSetUp::default(), warnings })
}

/// Reads the elements of a file, in their order.
fn read_mesh(header: &Header, mut body: Body<'_>, most_triangles: usize) -> Result<Mesh, String> {
    let mut mesh = Mesh::default();
    for element in &header.elements {
        match element.name.as_str() {
            "vertex" => read_vertices(element, &mut body, &mut mesh)?,
            "face" => read_faces(element, &mut body, &mut mesh, most_triangles)?,
            _ => (0..element.count).try_for_each(|_| body.row(element, |_, _| ()))?,
        }
    }
    let vertices = mesh.positions.len();
    // All vertices have them or none: a file may have several elements of vertices, and colours that are no numbers
    if mesh.normals.len() != vertices {
        mesh.normals.clear();
    }
    if mesh.uvs.len() != vertices {
        mesh.uvs.clear();
    }
    if mesh.colors.len() != vertices {
        mesh.colors.clear();
    }
    let is_there = |corner: &u32| (*corner as usize) < vertices;
    match mesh.triangles.as_flattened().iter().find(|corner| !is_there(corner)) {
        Some(corner) => Err(format!("a face has the vertex {corner}, and there are {vertices}, from 0 on")),
        None => Ok(mesh),
    }
}

/// Reads the vertices.
fn read_vertices(element: &Element, body: &mut Body<'_>, mesh: &mut Mesh) -> Result<(), String> {
    let find = |name: &str| element.properties.iter().position(|p| p.name == name && p.length.is_none());
    let find_all = |names: &[&str]| -> Option<Vec<usize>> { names.iter().map(|name| find(name)).collect() };
    let place = find_all(&["x", "y", "z"]).ok_or("its vertices have no x, y and z")?;
    let normal = find_all(&["nx", "ny", "nz"]);
    let color = find_all(&["red", "green", "blue"]);
    let uv = UV_NAMES.iter().find_map(|names| find_all(names));
    let is_byte = color.as_ref().is_some_and(|at| element.properties[at[0]].value == Scalar::U8);
    let mut values = vec![0.0; element.properties.len()];
    // Not more than the rest of the file can hold
    let count = element.count.min(body.most_rows(element));
    mesh.positions.reserve_exact(count);
    for _ in 0..element.count {
        body.row(element, |property, value| values[property] = value)?;
        let vector = |at: &[usize]| Vec3::new(values[at[0]], values[at[1]], values[at[2]]);
        mesh.positions.push(vector(&place));
        mesh.normals.extend(normal.as_deref().map(vector));
        mesh.uvs.extend(uv.as_deref().map(|at| Vec2::new(values[at[0]], values[at[1]])));
        // Bytes are display values, other numbers scene-linear ones
        let linear = |value: f32| if is_byte { srgb_decode(value / 255.0) } else { value };
        let unit = |color: Vec3| Vec3::from(color.to_array().map(|v| linear(v).clamp(0.0, 1.0)));
        mesh.colors.extend(color.as_deref().map(|at| unit(vector(at))).filter(|color| color.is_finite()));
    }
    Ok(())
}

/// Reads the faces: polygons become fans of triangles.
fn read_faces(element: &Element, body: &mut Body<'_>, mesh: &mut Mesh, most_triangles: usize) -> Result<(), String> {
    let is_corners = |p: &Property| CORNER_NAMES.contains(&p.name.as_str()) && p.length.is_some();
    let corners = element.properties.iter().position(is_corners).ok_or("its faces have no list vertex_indices")?;
    let mut polygon: Vec<f64> = Vec::new();
    for _ in 0..element.count {
        polygon.clear();
        body.row_exact(element, |property, value| {
            if property == corners {
                polygon.push(value);
            }
        })?;
        let index = |value: f64| {
            // Numbers out of range are refused with the number of vertices
            #[allow(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "it saturates")]
            if value >= 0.0 { Ok(value as u32) } else { Err(format!("a face has the vertex {value}")) }
        };
        for k in 2..polygon.len() {
            if mesh.triangles.len() >= most_triangles {
                return Err(format!("it has more than {most_triangles} triangles"));
            }
            mesh.triangles.push([index(polygon[0])?, index(polygon[k - 1])?, index(polygon[k])?]);
        }
    }
    Ok(())
}

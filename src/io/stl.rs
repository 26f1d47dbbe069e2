//! STL models: triangles without materials, in binary or as text.
//!
//! STL has no unit, and by custom its Z axis points up: models are turned to Y up. The normals of its facets repeat the
//! order of their corners and are not read; corners get smooth normals except at hard edges.

use super::error::{AssetError, cut};
use super::load_progress::{LoadProgress, PARSING};
use super::model::{ImportedModel, ModelLimits, ModelSetUp};
use super::obj;
use super::read::read_model;
use crate::scene::Mesh;
use glam::Vec3;
use std::path::Path;

/// Bytes before the triangles of a binary file: a comment and their number.
const HEADER_BYTES: usize = 84;
/// Bytes of a binary triangle: normal, three corners, an attribute.
const TRIANGLE_BYTES: usize = 50;
/// Name of the only part.
const PART: &str = "Surface";
/// Largest absolute coordinate of a vertex, the file's unit.
const COORDINATE_LIMIT: f32 = 1e6;

/// Imports an STL file.
///
/// # Errors
/// If the file can't be read, exceeds the limits, is cut off, or has a mistake; the message names the line of a text.
pub(super) fn import(path: &Path, limits: &ModelLimits, progress: &LoadProgress) -> Result<ImportedModel, AssetError> {
    let bytes = read_model(path, limits.file_bytes, progress)?;
    let bad_model =
        |message: String| AssetError::BadModel { format: "STL", message: cut(message), path: path.to_owned() };
    let corners = if is_text(&bytes) { read_text(&bytes, progress) } else { read_binary(&bytes, limits.triangles) };
    progress.reach(PARSING[1])?;
    let corners = corners.map_err(bad_model)?;
    let triangles = corners.len() / 3;
    if triangles > limits.triangles {
        let (what, amount, limit) = ("the model's number of triangles", triangles as u64, limits.triangles as u64);
        return Err(AssetError::TooLarge { what, amount, limit, path: path.to_owned() });
    }
    if corners.is_empty() {
        return Err(bad_model("it has no triangles".to_owned()));
    }
    if let Some(p) = corners.iter().find(|p| !p.is_finite() || p.abs().max_element() > COORDINATE_LIMIT) {
        return Err(bad_model(format!("the vertex {p} is not within {COORDINATE_LIMIT}")));
    }
    let mut mesh = Mesh { positions: corners, ..Mesh::default() };
    obj::weld_corners(&mut mesh);
    let mut warnings = Vec::new();
    obj::ensure_normals(&mut mesh, &mut warnings);
    let mesh = mesh.with_single_part(PART);
    Ok(ImportedModel { mesh, part_materials: Vec::new(), set_up: ModelSetUp::default(), warnings })
}

/// Returns true for a text. Some binary files begin with the word of texts; they have zeros in their header, or the size
/// that their number of triangles asks for.
fn is_text(bytes: &[u8]) -> bool {
    let is_binary = bytes.iter().take(2 * HEADER_BYTES).any(|byte| *byte == 0)
        || binary_count(bytes).is_some_and(|count| size_of(count) == bytes.len());
    bytes.trim_ascii_start().starts_with(b"solid") && !is_binary
}

/// Returns the number of triangles that a binary file states.
fn binary_count(bytes: &[u8]) -> Option<usize> {
    let count = bytes.get(HEADER_BYTES - 4..HEADER_BYTES)?;
    usize::try_from(u32::from_le_bytes(count.try_into().ok()?)).ok()
}

fn size_of(triangles: usize) -> usize {
    triangles.saturating_mul(TRIANGLE_BYTES).saturating_add(HEADER_BYTES)
}

/// Returns the corners of a binary file, three a triangle; of one more than the limit at most.
fn read_binary(bytes: &[u8], limit: usize) -> Result<Vec<Vec3>, String> {
    let count = binary_count(bytes).ok_or("it is neither a text nor has a binary header")?;
    if bytes.len() < size_of(count) {
        return Err(format!(
            "it is cut off: {count} triangles need {} bytes, and it has {}",
            size_of(count),
            bytes.len()
        ));
    }
    let triangles = bytes[HEADER_BYTES..].chunks_exact(TRIANGLE_BYTES).take(count.min(limit.saturating_add(1)));
    let float = |bytes: &[u8]| bytes.try_into().map_or(f32::NAN, f32::from_le_bytes);
    let corner = |bytes: &[u8]| y_up(Vec3::new(float(&bytes[..4]), float(&bytes[4..8]), float(&bytes[8..12])));
    Ok(triangles.flat_map(|triangle| [12, 24, 36].map(|at| corner(&triangle[at..at + 12]))).collect())
}

/// Returns the corners of a text, three a triangle.
fn read_text(bytes: &[u8], progress: &LoadProgress) -> Result<Vec<Vec3>, String> {
    let mut corners = Vec::new();
    for (index, line) in bytes.split(|byte| *byte == b'\n').enumerate() {
        let bad = |what: &str| format!("line {}: {what}", index + 1);
        if progress.is_cancelled() {
            break;
        }
        let line = line.trim_ascii();
        if let Some(numbers) = line.strip_prefix(b"vertex") {
            let numbers = std::str::from_utf8(numbers).map_err(|_| bad("a vertex is no text"))?;
            let mut numbers = numbers.split_ascii_whitespace().map(str::parse::<f32>);
            let mut next = || numbers.next().and_then(Result::ok).ok_or_else(|| bad("a vertex needs three numbers"));
            corners.push(y_up(Vec3::new(next()?, next()?, next()?)));
        } else if line.starts_with(b"endfacet") && !corners.len().is_multiple_of(3) {
            return Err(bad("a facet needs three vertices"));
        }
    }
    if corners.len().is_multiple_of(3) {
        Ok(corners)
    } else {
        Err("it is cut off: a facet needs three vertices".to_owned())
    }
}

/// Turns a point from Z up to Y up.
fn y_up(p: Vec3) -> Vec3 {
    Vec3::new(p.x, p.z, -p.y)
}

#[cfg(test)]
mod tests {
    use super::*;

    const LIMITS: ModelLimits = ModelLimits { file_bytes: 1 << 20, triangles: 12 };
    /// A tetrahedron of 20 units along each axis.
    const TRIANGLES: [[[f32; 3]; 3]; 4] = [
        [[0.0, 0.0, 0.0], [0.0, 20.0, 0.0], [20.0, 0.0, 0.0]],
        [[0.0, 0.0, 0.0], [20.0, 0.0, 0.0], [0.0, 0.0, 20.0]],
        [[0.0, 0.0, 0.0], [0.0, 0.0, 20.0], [0.0, 20.0, 0.0]],
        [[20.0, 0.0, 0.0], [0.0, 20.0, 0.0], [0.0, 0.0, 20.0]],
    ];

    fn imported(content: &[u8]) -> Result<ImportedModel, String> {
        let file = tempfile::NamedTempFile::new().unwrap();
        std::fs::write(file.path(), content).unwrap();
        import(file.path(), &LIMITS, &LoadProgress::default()).map_err(|error| error.to_string())
    }

    fn binary(triangles: &[[[f32; 3]; 3]]) -> Vec<u8> {
        let mut bytes = b"solid, as some programs begin".to_vec();
        bytes.resize(80, 0);
        bytes.extend(u32::try_from(triangles.len()).unwrap().to_le_bytes());
        for triangle in triangles {
            bytes.extend([0; 12]);
            bytes.extend(triangle.as_flattened().iter().flat_map(|value| value.to_le_bytes()));
            bytes.extend([0; 2]);
        }
        bytes
    }

    fn text() -> String {
        let facet = |t: &[[f32; 3]; 3]| {
            let vertex = |[x, y, z]: [f32; 3]| format!("vertex {x:e} {y} {z}\n");
            format!("facet normal 0 0 0\n outer loop\n{}endloop\nendfacet\n", t.map(vertex).concat())
        };
        format!("solid tetra\n{}endsolid tetra\n", TRIANGLES.iter().map(facet).collect::<String>())
    }

    #[test]
    fn binary_and_text_are_the_same_closed_model_with_z_up() {
        let [first, second] = [imported(&binary(&TRIANGLES)), imported(text().as_bytes())].map(Result::unwrap);
        assert_eq!(first, second);
        let mesh = &first.mesh;
        assert_eq!((mesh.triangles.len(), mesh.parts.len(), mesh.is_closed()), (4, 1, true));
        assert_eq!(mesh.bounds(), (Vec3::new(0.0, 0.0, -20.0), Vec3::new(20.0, 20.0, 0.0)));
        // The volume is that of a tetrahedron with its front outside
        let volume: f32 = (0..4).map(|t| mesh.corners(t)).map(|[a, b, c]| a.dot(b.cross(c)) / 6.0).sum();
        assert!((volume - 20.0_f32.powi(3) / 6.0).abs() < 0.1, "{volume}");
        // Hard edges: each corner has the normal of its face
        assert_eq!((mesh.positions.len(), mesh.normals.len()), (12, 12));
    }

    #[test]
    fn damaged_files_are_refused_with_the_reason() {
        let whole = binary(&TRIANGLES);
        let many = binary(&[TRIANGLES[0]; 13]);
        let text = text();
        let cases = [
            (Vec::new(), "neither a text nor has a binary header"),
            (whole[..150].to_vec(), "cut off: 4 triangles need 284 bytes, and it has 150"),
            (many, "number of triangles is too large: 13, at most 12"),
            (binary(&[]), "it has no triangles"),
            (binary(&[[[f32::NAN; 3]; 3]]), "is not within 1000000"),
            (text.replacen("vertex 0e0 0 0", "vertex 0e0 0", 1).into_bytes(), "line 4: a vertex needs three numbers"),
            (text.replacen("vertex 0e0 0 0\n", "", 1).into_bytes(), "line 7: a facet needs three vertices"),
            (b"solid\nvertex 0 0 0\n".to_vec(), "cut off: a facet needs three vertices"),
        ];
        for (content, words) in cases {
            let error = imported(&content).unwrap_err();
            assert!(error.contains(words), "{error} for {words}");
        }
    }
}

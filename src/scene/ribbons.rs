//! Strands as flat ribbons of triangles.

use super::{Mesh, MeshPart, StrandPoint, Strands};
use glam::Vec3;

/// Returns at most so many strands as flat ribbons with as many parts, for renderers without curves. Ribbons face away
/// from the middle of the strands, and are wider than the strands by the fraction that is left out.
pub fn strand_ribbons(strands: &Strands, most_strands: usize) -> Mesh {
    let mut mesh = Mesh::default();
    let Some((low, high)) = strands.bounds() else { return mesh };
    let middle = 0.5 * (low + high);
    let step = strands.len().div_ceil(most_strands.max(1)).max(1);
    for part in strands.parts() {
        let first = mesh.triangles.len() as u32;
        for strand in part.strands.clone().step_by(step) {
            add_ribbon(&mut mesh, strands.strand(strand as usize), middle, step as f32);
        }
        mesh.parts.push(MeshPart { name: part.name.clone(), triangles: first..mesh.triangles.len() as u32 });
    }
    mesh
}

/// Adds a strand as a ribbon that faces away from a point, `widening` times as wide.
fn add_ribbon(mesh: &mut Mesh, points: &[StrandPoint], middle: Vec3, widening: f32) {
    let base = mesh.positions.len() as u32;
    for (i, point) in points.iter().enumerate() {
        let along = points[(i + 1).min(points.len() - 1)].position - points[i.saturating_sub(1)].position;
        let across = along.cross(point.position - middle).normalize_or(Vec3::X);
        let half = across * (point.radius_m * widening);
        mesh.positions.extend([point.position - half, point.position + half]);
        mesh.normals.extend([across.cross(along).normalize_or(Vec3::Y); 2]);
    }
    for i in 0..points.len() as u32 - 1 {
        let a = base + 2 * i;
        mesh.triangles.extend([[a, a + 1, a + 2], [a + 1, a + 3, a + 2]]);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn ribbons_cover_the_area_of_the_strands_and_face_outwards() {
        let mut strands = Strands::default();
        for i in 0..40 {
            let (sin, cos) = (i as f32 * 0.157).sin_cos();
            strands.push((0..3).map(|k| StrandPoint { position: Vec3::new(sin, k as f32, cos), radius_m: 1e-3 }));
        }
        strands.end_part("hair");
        let mesh = strand_ribbons(&strands, 10);
        assert_eq!((mesh.triangles.len(), mesh.parts[0].triangles.end), (10 * 4, 40));
        let area: f32 = (0..mesh.triangles.len())
            .map(|t| mesh.corners(t))
            .map(|[a, b, c]| 0.5 * (b - a).cross(c - a).length())
            .sum();
        assert!((area / (40.0 * 2.0 * 2e-3) - 1.0).abs() < 1e-4, "{area}");
        for (index, triangle) in mesh.triangles.iter().enumerate() {
            let [a, b, c] = mesh.corners(index);
            let (face, normal) = ((b - a).cross(c - a), mesh.normals[triangle[0] as usize]);
            assert!(face.dot(normal) > 0.0 && normal.dot(a.with_y(0.0)) > 0.9, "{a} {normal}");
        }
        assert_eq!(strand_ribbons(&Strands::default(), 10), Mesh::default());
    }
}

//! Normals for models that have none: smooth where the surface is, hard at edges.

use crate::math::angle_between;
use crate::scene::Mesh;
use glam::Vec3;
use std::collections::HashMap;

/// Faces that meet at more than this, degrees, keep an edge between them. A cylinder of eight sides (45) is still
/// smooth, a box (90) or a hexagonal prism (60) is not.
pub(super) const CREASE_DEG: f32 = 50.0;
/// Around a vertex with more corners (the tip of a fine cone) all are smoothed: comparing each with each would take
/// long.
const MOST_CORNERS: usize = 128;

/// Gives every corner the angle-weighted mean of the faces around its vertex that lie within `crease_deg` of its own
/// (Thurmer and Wuthrich 1998 for the weights). Vertices at the same place count as one, so that texture coordinates
/// and groups leave no seams; a vertex whose corners differ is split. Corners of faces without area get +Y.
pub(super) fn compute_normals(mesh: &mut Mesh, crease_deg: f32) {
    let corners: Vec<Corner> = (0..mesh.triangles.len()).flat_map(|t| corners_of(mesh, t)).collect();
    let normals = corner_normals(mesh, &corners, crease_deg);
    split_by_normal(mesh, &normals);
}

/// A corner of a triangle: the face's unit normal (zero without area) and the corner's angle.
#[derive(Clone, Copy)]
struct Corner {
    face: Vec3,
    angle_rad: f32,
}

fn corners_of(mesh: &Mesh, triangle: usize) -> [Corner; 3] {
    let p = mesh.corners(triangle);
    let face = (p[1] - p[0]).cross(p[2] - p[0]).normalize_or_zero();
    std::array::from_fn(|k| Corner { face, angle_rad: angle_between(p[(k + 1) % 3] - p[k], p[(k + 2) % 3] - p[k]) })
}

/// A normal for each corner, three a triangle.
fn corner_normals(mesh: &Mesh, corners: &[Corner], crease_deg: f32) -> Vec<Vec3> {
    let cos_crease = crease_deg.to_radians().cos();
    let mut normals = vec![Vec3::ZERO; corners.len()];
    for around in corners_by_place(mesh) {
        let all = crease_deg >= 180.0 || around.len() > MOST_CORNERS;
        for &own in &around {
            let joins = |other: &Corner| all || other.face.dot(corners[own].face) >= cos_crease;
            // Always in the same order, so that corners with the same neighbours get the same bits and stay one vertex.
            let near = around.iter().map(|&i| corners[i]).filter(joins);
            let sum: Vec3 = near.map(|corner| corner.face * corner.angle_rad).sum();
            normals[own] = sum.try_normalize().unwrap_or(Vec3::Y);
            if all {
                around.iter().for_each(|&i| normals[i] = normals[own]);
                break;
            }
        }
    }
    normals
}

/// The corners at each place, in the mesh's order.
fn corners_by_place(mesh: &Mesh) -> Vec<Vec<usize>> {
    let mut place_of: HashMap<[u32; 3], usize> = HashMap::with_capacity(mesh.positions.len());
    let mut places: Vec<Vec<usize>> = Vec::new();
    for (corner, &vertex) in mesh.triangles.iter().flatten().enumerate() {
        // Adding zero makes -0 and 0 the same place.
        let bits = (mesh.positions[vertex as usize] + Vec3::ZERO).to_array().map(f32::to_bits);
        let place = *place_of.entry(bits).or_insert_with(|| {
            places.push(Vec::new());
            places.len() - 1
        });
        places[place].push(corner);
    }
    places
}

/// Makes each pair of a vertex and a normal a vertex of its own.
fn split_by_normal(mesh: &mut Mesh, normals: &[Vec3]) {
    let mut split: HashMap<(u32, [u32; 3]), u32> = HashMap::with_capacity(mesh.positions.len());
    let mut parted = Mesh { parts: std::mem::take(&mut mesh.parts), ..Mesh::default() };
    for (t, triangle) in mesh.triangles.iter().enumerate() {
        let indices = [0, 1, 2].map(|k| {
            let (vertex, normal) = (triangle[k], normals[3 * t + k]);
            *split.entry((vertex, normal.to_array().map(f32::to_bits))).or_insert_with(|| {
                parted.positions.push(mesh.positions[vertex as usize]);
                parted.normals.push(normal);
                parted.uvs.extend(mesh.uvs.get(vertex as usize));
                parted.positions.len() as u32 - 1
            })
        });
        parted.triangles.push(indices);
    }
    *mesh = parted;
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scene::{Shape, tessellate};

    /// A shape of the shelf as a file without normals would give it: places welded.
    fn bare(shape: &Shape) -> Mesh {
        let mut mesh = tessellate(shape).unwrap();
        mesh.normals.clear();
        mesh.uvs.clear();
        mesh
    }

    #[test]
    fn a_box_without_normals_has_flat_faces_and_hard_edges() {
        let mut cube = bare(&Shape::Box { size_m: Vec3::ONE });
        compute_normals(&mut cube, CREASE_DEG);
        assert_eq!(cube.positions.len(), 24);
        for t in 0..cube.triangles.len() {
            let [a, b, c] = cube.corners(t);
            let face = (b - a).cross(c - a).normalize();
            for k in cube.triangles[t] {
                assert!((cube.normals[k as usize] - face).length() < 1e-6);
            }
        }
    }

    #[test]
    fn a_cylinder_without_normals_is_round_with_hard_rims() {
        let mut cylinder = bare(&Shape::Cylinder { radius_m: 0.5, height_m: 1.0 });
        let right = tessellate(&Shape::Cylinder { radius_m: 0.5, height_m: 1.0 }).unwrap();
        compute_normals(&mut cylinder, CREASE_DEG);
        for (t, exact) in cylinder.triangles.iter().zip(&right.triangles) {
            for (k, e) in t.iter().zip(exact) {
                let (ours, exact) = (cylinder.normals[*k as usize], right.normals[*e as usize]);
                // Three triangles meet at a corner of the side; their angles weight one neighbour more: 1.4 degrees at
                // most of 128 segments' 2.8.
                assert!(ours.dot(exact) > 1.4_f32.to_radians().cos(), "{ours} for {exact}");
            }
        }
    }

    #[test]
    fn a_fan_of_a_million_triangles_does_not_hang() {
        let mut fan = Mesh { positions: vec![Vec3::ZERO], ..Mesh::default() };
        let count = 1_000_000;
        fan.positions.extend((0..count).map(|i| Vec3::new((i as f32).cos(), 0.1, (i as f32).sin())));
        fan.triangles = (1..count).map(|i| [0, i, i + 1]).collect();
        compute_normals(&mut fan, CREASE_DEG);
        assert!(fan.normals.iter().all(|n| n.is_finite()));
    }

    #[test]
    fn faces_without_area_do_not_spoil_their_neighbours() {
        let mut mesh = Mesh {
            positions: vec![Vec3::ZERO, Vec3::X, Vec3::Z],
            triangles: vec![[0, 2, 1], [0, 0, 1], [1, 1, 1]],
            ..Mesh::default()
        };
        compute_normals(&mut mesh, CREASE_DEG);
        assert!(mesh.triangles[0].iter().all(|&k| (mesh.normals[k as usize] - Vec3::Y).length() < 1e-6));
        assert!(mesh.normals.iter().all(|n| n.is_finite()));
    }
}

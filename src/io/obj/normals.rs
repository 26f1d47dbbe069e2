//! Computes vertex normals: smooth, except at edges sharper than a crease angle.

use super::lines::CornerIndices;
use super::mesh_index::to_index;
use super::weld::VertexWelder;
use crate::math::angle_between;
use crate::scene::Mesh;
use glam::Vec3;
use rayon::prelude::*;

/// Crease angle, degrees: faces that meet at more keep a hard edge. A cylinder of eight sides (45) is still smooth, a
/// box (90) or a hexagonal prism (60) is not.
pub(super) const CREASE_DEG: f32 = 50.0;
/// Corners at a position above which all are smoothed (the tip of a fine cone): comparing every pair is quadratic.
const CREASE_CORNER_LIMIT: usize = 128;

/// Gives every corner the angle-weighted mean normal of the faces around its vertex that lie within `crease_deg` of its
/// own face (Thurmer and Wuthrich 1998 for the weights). Vertices at the same position count as one, so that texture
/// coordinates and groups leave no seams; a vertex whose corners differ is split. Corners of faces without area get +Y.
pub(super) fn compute_normals(mesh: &mut Mesh, crease_deg: f32) {
    let corners: Vec<[FaceCorner; 3]> =
        (0..mesh.triangles.len()).into_par_iter().map(|t| corners_of(mesh, t)).collect();
    let corners = corners.as_flattened();
    let positions = CornersByPosition::new(mesh);
    let cos_crease = crease_deg.to_radians().cos();
    let smooth = |position| smooth_position(corners, positions.corners_at(position), cos_crease);
    let smoothed: Vec<SmoothedCorner> = (0..positions.len()).into_par_iter().flat_map_iter(smooth).collect();
    let mut by_corner = vec![(0, Vec3::ZERO); corners.len()];
    for smoothed in smoothed {
        by_corner[smoothed.corner as usize] = (smoothed.first_equal, smoothed.normal);
    }
    split_by_normal(mesh, &by_corner);
}

/// A corner of a triangle.
#[derive(Clone, Copy)]
struct FaceCorner {
    /// Unit normal of the triangle; zero without area.
    face_normal: Vec3,
    /// Interior angle.
    angle_rad: f32,
}

fn corners_of(mesh: &Mesh, triangle: usize) -> [FaceCorner; 3] {
    let p = mesh.corners(triangle);
    let face_normal = (p[1] - p[0]).cross(p[2] - p[0]).normalize_or_zero();
    std::array::from_fn(|k| FaceCorner {
        face_normal,
        angle_rad: angle_between(p[(k + 1) % 3] - p[k], p[(k + 2) % 3] - p[k]),
    })
}

/// The corners at each position. A position has the index of the first vertex that lies there.
struct CornersByPosition {
    /// Index of the first corner at each position, and the end of the last.
    starts: Vec<u32>,
    /// Corners by position, in the mesh's order at each.
    corners: Vec<u32>,
}

impl CornersByPosition {
    fn new(mesh: &Mesh) -> Self {
        let position_of = first_at_same_position(&mesh.positions);
        let mut starts = vec![0; mesh.positions.len() + 1];
        let vertices = || mesh.triangles.as_flattened().iter().map(|&vertex| position_of[vertex as usize] as usize);
        vertices().for_each(|position| starts[position + 1] += 1);
        let mut sum = 0;
        for start in &mut starts {
            sum += *start;
            *start = sum;
        }
        let (mut next, mut corners) = (starts.clone(), vec![0; sum as usize]);
        for (corner, position) in (0..).zip(vertices()) {
            corners[next[position] as usize] = corner;
            next[position] += 1;
        }
        CornersByPosition { starts, corners }
    }

    fn len(&self) -> usize {
        self.starts.len() - 1
    }

    fn corners_at(&self, position: usize) -> &[u32] {
        &self.corners[self.starts[position] as usize..self.starts[position + 1] as usize]
    }
}

/// Returns for each vertex the first vertex at the same position.
pub(super) fn first_at_same_position(positions: &[Vec3]) -> Vec<u32> {
    // Adding zero turns -0 into 0.
    let bits = |p: &Vec3| (*p + Vec3::ZERO).to_array().map(f32::to_bits);
    let mut sorted: Vec<([u32; 3], u32)> = positions.par_iter().map(bits).zip(0..to_index(positions.len())).collect();
    sorted.par_sort_unstable();
    let mut position_of = vec![0; positions.len()];
    for run in sorted.chunk_by(|a, b| a.0 == b.0) {
        for (_, vertex) in run {
            position_of[*vertex as usize] = run[0].1;
        }
    }
    position_of
}

/// A corner with its smoothed normal.
struct SmoothedCorner {
    corner: u32,
    /// First corner at the position with the same normal.
    first_equal: u32,
    normal: Vec3,
}

/// Computes the normals of the corners at a position.
fn smooth_position(corners: &[FaceCorner], around: &[u32], cos_crease: f32) -> Vec<SmoothedCorner> {
    let corner = |index: &u32| corners[*index as usize];
    let sum = |near: &mut dyn Iterator<Item = FaceCorner>| -> Vec3 {
        near.map(|corner| corner.face_normal * corner.angle_rad).sum::<Vec3>().try_normalize().unwrap_or(Vec3::Y)
    };
    if cos_crease <= -1.0 || around.len() > CREASE_CORNER_LIMIT {
        let normal = sum(&mut around.iter().map(corner));
        return around.iter().map(|&corner| SmoothedCorner { corner, first_equal: around[0], normal }).collect();
    }
    let mut smoothed: Vec<SmoothedCorner> = Vec::with_capacity(around.len());
    for own in around {
        let joins = |other: &FaceCorner| other.face_normal.dot(corner(own).face_normal) >= cos_crease;
        // Sum in the same order for all: corners with the same neighbours get the same bits and stay one vertex.
        let normal = sum(&mut around.iter().map(corner).filter(joins));
        let equal =
            smoothed.iter().find(|s| s.normal.to_array().map(f32::to_bits) == normal.to_array().map(f32::to_bits));
        let first_equal = equal.map_or(*own, |s| s.first_equal);
        smoothed.push(SmoothedCorner { corner: *own, first_equal, normal });
    }
    smoothed
}

/// Splits vertices whose corners have different normals. `by_corner` holds the first corner with an equal normal at the
/// position, and the normal.
fn split_by_normal(mesh: &mut Mesh, by_corner: &[(u32, Vec3)]) {
    let mut welder = VertexWelder::new(mesh.positions.len());
    for (triangle, by_corner) in mesh.triangles.iter_mut().zip(by_corner.chunks_exact(3)) {
        for (vertex, (first_equal, _)) in triangle.iter_mut().zip(by_corner) {
            *vertex = welder.vertex([*vertex, *first_equal, 0]);
        }
    }
    let old = |indices: &CornerIndices| indices[0] as usize;
    mesh.normals = welder.vertices.par_iter().map(|indices| by_corner[indices[1] as usize].1).collect();
    mesh.positions = welder.vertices.par_iter().map(|indices| mesh.positions[old(indices)]).collect();
    if !mesh.uvs.is_empty() {
        mesh.uvs = welder.vertices.par_iter().map(|indices| mesh.uvs[old(indices)]).collect();
    }
    if !mesh.colors.is_empty() {
        mesh.colors = welder.vertices.par_iter().map(|indices| mesh.colors[old(indices)]).collect();
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scene::{Shape, tessellate};

    /// Returns a shape's mesh without normals and texture coordinates.
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
    fn a_fan_of_a_million_triangles_is_smoothed_in_linear_time() {
        let mut fan = Mesh { positions: vec![Vec3::ZERO], ..Mesh::default() };
        let count = 1_000_000;
        fan.positions.extend((0..count).map(|i| Vec3::new((i as f32).cos(), 0.1, (i as f32).sin())));
        fan.triangles = (1..count).map(|i| [0, i, i + 1]).collect();
        compute_normals(&mut fan, CREASE_DEG);
        assert!(fan.normals.iter().all(|n| n.is_finite()));
    }

    #[test]
    fn faces_without_area_do_not_affect_their_neighbours() {
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

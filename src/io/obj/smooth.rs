//! Normals for models that have none: smooth where the surface is, hard at edges.

use super::lines::Corner as Named;
use super::weld::Welder;
use crate::math::angle_between;
use crate::scene::Mesh;
use glam::Vec3;
use rayon::prelude::*;

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
    let corners: Vec<[Corner; 3]> = (0..mesh.triangles.len()).into_par_iter().map(|t| corners_of(mesh, t)).collect();
    let corners = corners.as_flattened();
    let places = Places::new(mesh);
    let cos_crease = crease_deg.to_radians().cos();
    let smooth = |place| smooth_place(corners, places.corners_at(place), cos_crease);
    let smoothed: Vec<Smoothed> = (0..places.len()).into_par_iter().flat_map_iter(smooth).collect();
    let mut by_corner = vec![(0, Vec3::ZERO); corners.len()];
    for smoothed in smoothed {
        by_corner[smoothed.corner as usize] = (smoothed.first_alike, smoothed.normal);
    }
    split_by_normal(mesh, &by_corner);
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

/// The corners at each place. A place has the number of the first vertex that lies there.
struct Places {
    /// Where the corners at each place begin, and one end mark.
    starts: Vec<u32>,
    /// In the mesh's order at each place.
    corners: Vec<u32>,
}

impl Places {
    fn new(mesh: &Mesh) -> Self {
        let place_of = places_of_vertices(&mesh.positions);
        let mut starts = vec![0; mesh.positions.len() + 1];
        let vertices = || mesh.triangles.as_flattened().iter().map(|&vertex| place_of[vertex as usize] as usize);
        vertices().for_each(|place| starts[place + 1] += 1);
        let mut sum = 0;
        for start in &mut starts {
            sum += *start;
            *start = sum;
        }
        let (mut next, mut corners) = (starts.clone(), vec![0; sum as usize]);
        for (corner, place) in (0..).zip(vertices()) {
            corners[next[place] as usize] = corner;
            next[place] += 1;
        }
        Places { starts, corners }
    }

    fn len(&self) -> usize {
        self.starts.len() - 1
    }

    fn corners_at(&self, place: usize) -> &[u32] {
        &self.corners[self.starts[place] as usize..self.starts[place + 1] as usize]
    }
}

/// For each vertex the first that lies at the same place.
fn places_of_vertices(positions: &[Vec3]) -> Vec<u32> {
    // Adding zero makes -0 and 0 the same place.
    let bits = |p: &Vec3| (*p + Vec3::ZERO).to_array().map(f32::to_bits);
    let mut sorted: Vec<([u32; 3], u32)> = positions.par_iter().map(bits).zip(0..positions.len() as u32).collect();
    sorted.par_sort_unstable();
    let mut place_of = vec![0; positions.len()];
    for run in sorted.chunk_by(|a, b| a.0 == b.0) {
        for (_, vertex) in run {
            place_of[*vertex as usize] = run[0].1;
        }
    }
    place_of
}

/// A corner's normal, and the first corner at its place with the same.
struct Smoothed {
    corner: u32,
    first_alike: u32,
    normal: Vec3,
}

/// The normals of the corners around a place.
fn smooth_place(corners: &[Corner], around: &[u32], cos_crease: f32) -> Vec<Smoothed> {
    let corner = |index: &u32| corners[*index as usize];
    let sum = |near: &mut dyn Iterator<Item = Corner>| -> Vec3 {
        near.map(|corner| corner.face * corner.angle_rad).sum::<Vec3>().try_normalize().unwrap_or(Vec3::Y)
    };
    if cos_crease <= -1.0 || around.len() > MOST_CORNERS {
        let normal = sum(&mut around.iter().map(corner));
        return around.iter().map(|&corner| Smoothed { corner, first_alike: around[0], normal }).collect();
    }
    let mut smoothed: Vec<Smoothed> = Vec::with_capacity(around.len());
    for own in around {
        let joins = |other: &Corner| other.face.dot(corner(own).face) >= cos_crease;
        // Always in the same order, so that corners with the same neighbours get the same bits and stay one vertex.
        let normal = sum(&mut around.iter().map(corner).filter(joins));
        let alike =
            smoothed.iter().find(|s| s.normal.to_array().map(f32::to_bits) == normal.to_array().map(f32::to_bits));
        let first_alike = alike.map_or(*own, |s| s.first_alike);
        smoothed.push(Smoothed { corner: *own, first_alike, normal });
    }
    smoothed
}

/// Makes each pair of a vertex and a normal a vertex of its own. Each corner has the first corner that shares its normal,
/// and the normal.
fn split_by_normal(mesh: &mut Mesh, by_corner: &[(u32, Vec3)]) {
    let mut welder = Welder::new(mesh.positions.len());
    for (triangle, by_corner) in mesh.triangles.iter_mut().zip(by_corner.chunks_exact(3)) {
        for (vertex, (first_alike, _)) in triangle.iter_mut().zip(by_corner) {
            *vertex = welder.vertex([*vertex, *first_alike, 0]);
        }
    }
    let old = |named: &Named| named[0] as usize;
    mesh.normals = welder.vertices.par_iter().map(|named| by_corner[named[1] as usize].1).collect();
    mesh.positions = welder.vertices.par_iter().map(|named| mesh.positions[old(named)]).collect();
    if !mesh.uvs.is_empty() {
        mesh.uvs = welder.vertices.par_iter().map(|named| mesh.uvs[old(named)]).collect();
    }
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

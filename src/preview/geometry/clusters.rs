//! Triangles in clusters of neighbours that face about the same way, so that a frame draws only those that can be seen.
//!
//! Rasterisers on a processor set triangles up one after the other: half of a figure faces away, and costs as much as
//! what is seen. The test is that of Shirman and Abi-Ezzi (1993, The cone of normals technique): a cluster is hidden if
//! the eye lies behind all of its triangles' planes.

use crate::scene::Mesh;
use glam::{Mat4, Vec3, Vec4, Vec4Swizzles as _};
use std::ops::Range;

/// Most triangles of a cluster.
const MOST_TRIANGLES: usize = 128;
/// Runs of more triangles than this are split on both cores.
const SPLIT_ALONE: usize = 1 << 14;
/// Least cosine between a cluster's axis and its normals for which its cone is of use.
const WIDEST_CONE: f32 = 0.1;

/// A run of neighbouring triangles.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Cluster {
    /// Its indices, three a triangle.
    pub indices: Range<u32>,
    /// Ball around it, object space.
    centre: Vec3,
    radius: f32,
    /// Cone around its normals: axis, and sine of its half angle; above 1 where it is too wide to hide anything.
    axis: Vec3,
    spread: f32,
}

/// A mesh in the order of its clusters.
#[derive(Debug)]
pub(crate) struct Clustered {
    /// Indices into `vertices`; each part keeps its run.
    pub triangles: Vec<[u32; 3]>,
    /// The mesh's own number of each vertex, in the order in which triangles first use them.
    pub vertices: Vec<u32>,
    /// In the order of their triangles.
    pub clusters: Vec<Cluster>,
}

/// From where a mesh is seen, in its own space.
#[derive(Clone, Copy, Debug)]
pub(crate) struct ObjectFrustum {
    position: Vec3,
    /// The picture's four sides: points inside are on the positive side of each.
    sides: [Vec4; 4],
    /// Whether what faces away is not drawn.
    front_only: bool,
}

impl ObjectFrustum {
    /// The eye at `position` in the object's space that sees what `clip_from_object` puts into the picture.
    pub fn new(position: Vec3, clip_from_object: Mat4, front_only: bool) -> Self {
        let row = |i| clip_from_object.row(i);
        let sides = [row(3) + row(0), row(3) - row(0), row(3) + row(1), row(3) - row(1)];
        ObjectFrustum { position, sides, front_only }
    }

    /// Whether something of a cluster may be seen. Not a number is seen.
    fn sees(&self, cluster: &Cluster) -> bool {
        let towards = cluster.centre - self.position;
        let faces_away = towards.dot(cluster.axis) >= cluster.spread * towards.length() + cluster.radius;
        let beyond = |side: &Vec4| side.xyz().dot(cluster.centre) + side.w < -cluster.radius * side.xyz().length();
        !(self.front_only && faces_away || self.sides.iter().any(beyond))
    }

    /// The indices of those of `clusters` that may be seen, as few runs as it takes.
    pub fn visible(&self, clusters: &[Cluster]) -> Vec<Range<u32>> {
        let mut runs: Vec<Range<u32>> = Vec::new();
        for cluster in clusters.iter().filter(|cluster| self.sees(cluster)) {
            match runs.last_mut() {
                Some(last) if last.end == cluster.indices.start => last.end = cluster.indices.end,
                _ => runs.push(cluster.indices.clone()),
            }
        }
        runs
    }
}

/// A triangle while it is sorted.
#[derive(Clone, Copy, Debug)]
struct Face {
    triangle: [u32; 3],
    middle: Vec3,
    normal: Vec3,
}

impl Face {
    fn new(mesh: &Mesh, triangle: usize) -> Self {
        let [a, b, c] = mesh.corners(triangle);
        let normal = (b - a).cross(c - a).normalize_or_zero();
        Face { triangle: mesh.triangles[triangle], middle: (a + b + c) / 3.0, normal }
    }

    /// Which of the six directions of the axes it faces.
    fn direction(&self) -> usize {
        let size = self.normal.abs();
        let axis = if size.x >= size.max_element() { 0 } else { 1 + usize::from(size.z > size.y) };
        // One half of the studio after the other, so that what can be seen from a place lies in few runs.
        if self.normal[axis] > 0.0 { axis } else { axis + 3 }
    }
}

impl Clustered {
    /// Sorts a mesh whose indices are all in range.
    pub fn new(mesh: &Mesh) -> Self {
        let mut faces: Vec<Face> = (0..mesh.triangles.len()).map(|triangle| Face::new(mesh, triangle)).collect();
        let mut runs: Vec<Range<usize>> = Vec::new();
        for part in &mesh.parts {
            let run = part.triangles.start as usize..(part.triangles.end as usize).min(faces.len());
            if run.len() > MOST_TRIANGLES {
                faces[run.clone()].sort_by_key(Face::direction);
                let mut first = run.start;
                for group in faces[run].chunk_by_mut(|a, b| a.direction() == b.direction()) {
                    split(group);
                    leaves(first..first + group.len(), &mut runs);
                    first += group.len();
                }
            } else if !run.is_empty() {
                runs.push(run);
            }
        }
        let clusters = runs.iter().map(|run| cluster(mesh, &faces[run.clone()], run)).collect();
        let (triangles, vertices) = renumbered(&faces, mesh.positions.len());
        Clustered { triangles, vertices, clusters }
    }
}

/// Sorts faces so that each of their `leaves` holds neighbours.
fn split(faces: &mut [Face]) {
    if faces.len() <= MOST_TRIANGLES {
        return;
    }
    let bounds = |(low, high): (Vec3, Vec3), face: &Face| (low.min(face.middle), high.max(face.middle));
    let (low, high) = faces.iter().fold((Vec3::INFINITY, Vec3::NEG_INFINITY), bounds);
    let axis = (high - low).max_position();
    let middle = faces.len() / 2;
    faces.select_nth_unstable_by(middle, |a, b| a.middle[axis].total_cmp(&b.middle[axis]));
    let alone = faces.len() <= SPLIT_ALONE;
    let (left, right) = faces.split_at_mut(middle);
    if alone {
        split(left);
        split(right);
    } else {
        rayon::join(|| split(left), || split(right));
    }
}

/// The runs into which `split` takes a run of faces.
fn leaves(run: Range<usize>, runs: &mut Vec<Range<usize>>) {
    if run.len() <= MOST_TRIANGLES {
        runs.push(run);
        return;
    }
    let middle = run.start + run.len() / 2;
    leaves(run.start..middle, runs);
    leaves(middle..run.end, runs);
}

fn cluster(mesh: &Mesh, faces: &[Face], run: &Range<usize>) -> Cluster {
    let corners = || faces.iter().flat_map(|face| face.triangle).map(|vertex| mesh.positions[vertex as usize]);
    let (low, high) = corners().fold((Vec3::INFINITY, Vec3::NEG_INFINITY), |(low, high), p| (low.min(p), high.max(p)));
    let centre = 0.5 * (low + high);
    let radius = corners().map(|corner| corner.distance(centre)).fold(0.0, f32::max);
    let axis = faces.iter().map(|face| face.normal).sum::<Vec3>().normalize_or_zero();
    // A triangle without area is not seen from anywhere.
    let normals = faces.iter().map(|face| face.normal).filter(|normal| *normal != Vec3::ZERO);
    let least = normals.map(|normal| normal.dot(axis)).fold(1.0, f32::min);
    // A little wider than it is, for what rounding does to planes that are seen edge-on.
    let spread = if least > WIDEST_CONE { (1.0 - least * least).max(0.0).sqrt() + 1e-3 } else { 2.0 };
    Cluster { indices: 3 * run.start as u32..3 * run.end as u32, centre, radius, axis, spread }
}

/// The triangles by the numbers of their vertices in the order of their first use, and the former numbers.
fn renumbered(faces: &[Face], count: usize) -> (Vec<[u32; 3]>, Vec<u32>) {
    let mut numbers = vec![u32::MAX; count];
    let mut vertices = Vec::with_capacity(count);
    let mut number = |vertex: u32| {
        let place = &mut numbers[vertex as usize];
        if *place == u32::MAX {
            *place = vertices.len() as u32;
            vertices.push(vertex);
        }
        *place
    };
    let triangles = faces.iter().map(|face| face.triangle.map(&mut number)).collect();
    (triangles, vertices)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::math::look_at;
    use crate::scene::{CameraFrame, Shape, tessellate};
    use glam::Vec2;
    use std::collections::HashSet;

    fn ball() -> Mesh {
        let mut mesh = tessellate(&Shape::Sphere { radius_m: 0.5 }).unwrap();
        let half = mesh.triangles.len() as u32 / 2;
        mesh.parts[0].triangles.end = half;
        mesh.parts.push(crate::scene::MeshPart { name: "rest".to_owned(), triangles: half..2 * half });
        mesh
    }

    fn corners_of(clustered: &Clustered, mesh: &Mesh, triangle: usize) -> [Vec3; 3] {
        clustered.triangles[triangle].map(|i| mesh.positions[clustered.vertices[i as usize] as usize])
    }

    #[test]
    fn every_part_keeps_its_triangles_and_clusters_hold_all_of_them_once() {
        let mesh = ball();
        let clustered = Clustered::new(&mesh);
        let key = |corners: [Vec3; 3]| corners.map(|p| p.to_array().map(f32::to_bits));
        for part in &mesh.parts {
            let run = part.triangles.start as usize..part.triangles.end as usize;
            let before: HashSet<_> = run.clone().map(|t| key(mesh.corners(t))).collect();
            let after: HashSet<_> = run.map(|t| key(corners_of(&clustered, &mesh, t))).collect();
            assert_eq!(before, after);
        }
        let ends: Vec<u32> = clustered.clusters.iter().map(|cluster| cluster.indices.end).collect();
        let starts: Vec<u32> = clustered.clusters.iter().map(|cluster| cluster.indices.start).collect();
        assert_eq!(
            (starts[0], &starts[1..], ends.last()),
            (0, &ends[..ends.len() - 1], Some(&(mesh.triangles.len() as u32 * 3)))
        );
        assert!(clustered.clusters.len() > mesh.triangles.len() / MOST_TRIANGLES);
    }

    #[test]
    fn what_is_left_out_faces_away_or_lies_outside_of_the_picture_and_that_is_most_of_it() {
        let mesh = ball();
        let clustered = Clustered::new(&mesh);
        let all = 3 * mesh.triangles.len();
        let mut drawn = 0;
        for step in 0..40 {
            let turn = Vec2::from_angle(step as f32 * 2.4) * 1.2;
            let eye = Vec3::new(turn.x, step as f32 * 0.05 - 1.0, turn.y);
            // The ball stands half outside of the picture.
            let world_from_camera = look_at(eye, Vec3::new(0.3, 0.0, 0.0), 0.0);
            let camera = CameraFrame { world_from_camera, half_extent: Vec2::splat(0.3) };
            let runs = ObjectFrustum::new(eye, camera.clip_from_world(0.01), true).visible(&clustered.clusters);
            let is_drawn = |index: u32| runs.iter().any(|run| run.contains(&index));
            for triangle in (0..mesh.triangles.len()).filter(|t| !is_drawn(3 * *t as u32)) {
                let corners = corners_of(&clustered, &mesh, triangle);
                let normal = (corners[1] - corners[0]).cross(corners[2] - corners[0]);
                let faces_eye = normal.dot(eye - corners[0]) > 0.0;
                let inside = corners.iter().any(|corner| {
                    camera.project(*corner).is_some_and(|p| p.min_element() >= 0.0 && p.max_element() <= 1.0)
                });
                assert!(!(faces_eye && inside), "step {step}, triangle {triangle}");
            }
            drawn += runs.iter().map(|run| run.len()).sum::<usize>();
        }
        assert!(drawn < 40 * all / 2, "{drawn} of {}", 40 * all);
    }
}

//! Mesh clusters: neighbouring triangles of similar orientation, culled by frustum and by normal cone.
//!
//! CPU rasterisers set up triangles one after the other, and back faces cost as much as front faces. The normal cone
//! test (Shirman and Abi-Ezzi 1993, The Cone of Normals Technique) discards clusters whose triangles all face away.

use crate::scene::Mesh;
use glam::{Mat4, Vec3, Vec4, Vec4Swizzles as _};
use std::ops::Range;

/// Maximum number of triangles of a cluster.
const MAX_TRIANGLES: usize = 128;
/// Number of triangles above which the halves of a run are split in parallel.
const PARALLEL_SPLIT: usize = 1 << 14;
/// Smallest cosine between a cluster's axis and its normals for which the cone can cull anything.
const MIN_CONE_COSINE: f32 = 0.1;

/// A run of neighbouring triangles.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Cluster {
    /// Range of the index buffer, three per triangle.
    pub indices: Range<u32>,
    /// Bounding sphere, object space.
    centre: Vec3,
    radius: f32,
    /// Normal cone: axis and sine of the half angle, above 1 if the cone is too wide to cull.
    axis: Vec3,
    cone_sine: f32,
}

/// A mesh with its triangles sorted by cluster.
#[derive(Debug)]
pub(crate) struct Clustered {
    /// Indices into `vertices`; each part keeps its range.
    pub triangles: Vec<[u32; 3]>,
    /// Source index of each vertex, in the order of first use.
    pub vertices: Vec<u32>,
    /// Clusters in the order of their triangles.
    pub clusters: Vec<Cluster>,
}

/// The camera frustum in the space of a mesh.
#[derive(Clone, Copy, Debug)]
pub(crate) struct ObjectFrustum {
    eye: Vec3,
    /// The four side planes, positive inside.
    sides: [Vec4; 4],
    cull_back_faces: bool,
}

impl ObjectFrustum {
    /// Returns the frustum of a projection, with the eye in object space.
    pub fn new(eye: Vec3, clip_from_object: Mat4, cull_back_faces: bool) -> Self {
        let row = |i| clip_from_object.row(i);
        let sides = [row(3) + row(0), row(3) - row(0), row(3) + row(1), row(3) - row(1)];
        ObjectFrustum { eye, sides, cull_back_faces }
    }

    /// Returns true if a cluster may be visible. Phrased so that NaN means visible.
    fn may_see(&self, cluster: &Cluster) -> bool {
        let towards = cluster.centre - self.eye;
        let faces_away = towards.dot(cluster.axis) >= cluster.cone_sine * towards.length() + cluster.radius;
        let outside = |side: &Vec4| side.xyz().dot(cluster.centre) + side.w < -cluster.radius * side.xyz().length();
        !(self.cull_back_faces && faces_away || self.sides.iter().any(outside))
    }

    /// Returns the index ranges of the clusters that may be visible, adjacent ones merged.
    pub fn visible(&self, clusters: &[Cluster]) -> Vec<Range<u32>> {
        let mut runs: Vec<Range<u32>> = Vec::new();
        for cluster in clusters.iter().filter(|cluster| self.may_see(cluster)) {
            match runs.last_mut() {
                Some(last) if last.end == cluster.indices.start => last.end = cluster.indices.end,
                _ => runs.push(cluster.indices.clone()),
            }
        }
        runs
    }
}

/// A triangle during sorting.
#[derive(Clone, Copy, Debug)]
struct Face {
    triangle: [u32; 3],
    centroid: Vec3,
    normal: Vec3,
}

impl Face {
    fn new(mesh: &Mesh, triangle: usize) -> Self {
        let [a, b, c] = mesh.corners(triangle);
        let normal = (b - a).cross(c - a).normalize_or_zero();
        Face { triangle: mesh.triangles[triangle], centroid: (a + b + c) / 3.0, normal }
    }

    /// Returns the axis direction (0..6) nearest to the normal.
    fn direction(&self) -> usize {
        let size = self.normal.abs();
        let axis = if size.x >= size.max_element() { 0 } else { 1 + usize::from(size.z > size.y) };
        // Positive directions first: the directions visible from one point are then mostly adjacent
        if self.normal[axis] > 0.0 { axis } else { axis + 3 }
    }
}

impl Clustered {
    /// Sorts the triangles of a mesh into clusters. All indices must be in range.
    pub fn new(mesh: &Mesh) -> Self {
        let mut faces: Vec<Face> = (0..mesh.triangles.len()).map(|triangle| Face::new(mesh, triangle)).collect();
        let mut runs: Vec<Range<usize>> = Vec::new();
        for part in &mesh.parts {
            let run = part.triangles.start as usize..(part.triangles.end as usize).min(faces.len());
            if run.len() > MAX_TRIANGLES {
                // Group faces by direction, then split each group spatially
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

/// Sorts faces so that each of their `leaves` is spatially compact: median splits along the longest axis.
fn split(faces: &mut [Face]) {
    if faces.len() <= MAX_TRIANGLES {
        return;
    }
    let bounds = |(low, high): (Vec3, Vec3), face: &Face| (low.min(face.centroid), high.max(face.centroid));
    let (low, high) = faces.iter().fold((Vec3::INFINITY, Vec3::NEG_INFINITY), bounds);
    let axis = (high - low).max_position();
    let middle = faces.len() / 2;
    faces.select_nth_unstable_by(middle, |a, b| a.centroid[axis].total_cmp(&b.centroid[axis]));
    let is_serial = faces.len() <= PARALLEL_SPLIT;
    let (left, right) = faces.split_at_mut(middle);
    if is_serial {
        split(left);
        split(right);
    } else {
        rayon::join(|| split(left), || split(right));
    }
}

/// Appends the leaf ranges of `split` for a range of faces.
fn leaves(run: Range<usize>, runs: &mut Vec<Range<usize>>) {
    if run.len() <= MAX_TRIANGLES {
        runs.push(run);
        return;
    }
    let middle = run.start + run.len() / 2;
    leaves(run.start..middle, runs);
    leaves(middle..run.end, runs);
}

/// Computes the bounding sphere and the normal cone of a run of faces.
fn cluster(mesh: &Mesh, faces: &[Face], run: &Range<usize>) -> Cluster {
    let corners = || faces.iter().flat_map(|face| face.triangle).map(|vertex| mesh.positions[vertex as usize]);
    let (low, high) = corners().fold((Vec3::INFINITY, Vec3::NEG_INFINITY), |(low, high), p| (low.min(p), high.max(p)));
    let centre = 0.5 * (low + high);
    let radius = corners().map(|corner| corner.distance(centre)).fold(0.0, f32::max);
    let axis = faces.iter().map(|face| face.normal).sum::<Vec3>().normalize_or_zero();
    // Degenerate triangles are never visible
    let normals = faces.iter().map(|face| face.normal).filter(|normal| *normal != Vec3::ZERO);
    let min_cosine = normals.map(|normal| normal.dot(axis)).fold(1.0, f32::min);
    // The margin covers rounding for planes seen edge-on
    let cone_sine =
        if min_cosine > MIN_CONE_COSINE { (1.0 - min_cosine * min_cosine).max(0.0).sqrt() + 1e-3 } else { 2.0 };
    Cluster { indices: 3 * run.start as u32..3 * run.end as u32, centre, radius, axis, cone_sine }
}

/// Renumbers vertices in the order of first use. Returns the triangles and the source index of each vertex.
fn renumbered(faces: &[Face], count: usize) -> (Vec<[u32; 3]>, Vec<u32>) {
    let mut new_indices = vec![u32::MAX; count];
    let mut vertices = Vec::with_capacity(count);
    let mut number = |vertex: u32| {
        let new_index = &mut new_indices[vertex as usize];
        if *new_index == u32::MAX {
            *new_index = vertices.len() as u32;
            vertices.push(vertex);
        }
        *new_index
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

    fn sphere() -> Mesh {
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
    fn every_part_keeps_its_triangles_and_clusters_contain_each_once() {
        let mesh = sphere();
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
        assert!(clustered.clusters.len() > mesh.triangles.len() / MAX_TRIANGLES);
    }

    #[test]
    fn culled_triangles_face_away_or_are_outside_of_the_frustum_and_are_the_majority() {
        let mesh = sphere();
        let clustered = Clustered::new(&mesh);
        let all = 3 * mesh.triangles.len();
        let mut drawn = 0;
        for step in 0..40 {
            let turn = Vec2::from_angle(step as f32 * 2.4) * 1.2;
            let eye = Vec3::new(turn.x, step as f32 * 0.05 - 1.0, turn.y);
            // Half of the sphere is outside of the picture
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

//! Clipping of triangles at the six planes of clip space, in homogeneous coordinates (Sutherland and Hodgman 1974).
//!
//! Depth is reversed and infinite: near at z = w, far at z = 0. An intersection is always computed from the vertex
//! inside to the one outside, so that two triangles with a common edge clip it at the very same point and leave no
//! crack.

use glam::{Vec3, Vec4};

/// A vertex of a clipped triangle.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct ClippedVertex {
    /// Position in clip space.
    pub clip: Vec4,
    /// Barycentric coordinates in the unclipped triangle.
    pub barycentric: Vec3,
}

/// Three vertices and one more for each plane.
const MAX_VERTICES: usize = 9;

/// A convex polygon.
#[derive(Clone, Copy, Debug)]
pub(super) struct ClippedPolygon {
    vertices: [ClippedVertex; MAX_VERTICES],
    count: usize,
}

impl ClippedPolygon {
    /// Returns the vertices in order; none or at least three.
    pub fn vertices(&self) -> &[ClippedVertex] {
        &self.vertices[..self.count]
    }

    fn push(&mut self, vertex: ClippedVertex) {
        // Rounding may make a sliver cross a plane once too often; its vertex is discarded.
        if let Some(slot) = self.vertices.get_mut(self.count) {
            *slot = vertex;
            self.count += 1;
        }
    }
}

/// Returns the signed distances from the planes left, right, bottom, top, near, far, each times w: inside where not
/// negative.
fn plane_distances(p: Vec4) -> [f32; 6] {
    [p.w + p.x, p.w - p.x, p.w + p.y, p.w - p.y, p.w - p.z, p.z]
}

/// A triangle against the clip volume.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum ClipTest {
    /// Wholly inside.
    Inside,
    /// Wholly outside of one of the planes.
    Outside,
    /// Neither: it must be clipped.
    Straddles,
}

/// One bit for each plane that a vertex is outside of (Cohen and Sutherland).
pub(super) type Outcode = u8;

/// Returns the outcode of a vertex: all bits for NaN.
pub(super) fn outcode(vertex: Vec4) -> Outcode {
    plane_distances(vertex).iter().enumerate().fold(0, |bits, (plane, distance)| {
        let inside = *distance >= 0.0;
        bits | (Outcode::from(!inside) << plane)
    })
}

/// Returns the trivial accept or reject of a triangle from its outcodes.
pub(super) fn clip_test(outcodes: [Outcode; 3]) -> ClipTest {
    match outcodes {
        [0, 0, 0] => ClipTest::Inside,
        [a, b, c] if a & b & c != 0 => ClipTest::Outside,
        _ => ClipTest::Straddles,
    }
}

/// Returns the part of a triangle inside all six planes.
pub(super) fn clip_triangle(triangle: [Vec4; 3]) -> ClippedPolygon {
    let unset = ClippedVertex { clip: Vec4::ZERO, barycentric: Vec3::ZERO };
    let empty = ClippedPolygon { vertices: [unset; MAX_VERTICES], count: 0 };
    let mut polygon = empty;
    for (clip, barycentric) in triangle.into_iter().zip([Vec3::X, Vec3::Y, Vec3::Z]) {
        polygon.push(ClippedVertex { clip, barycentric });
    }
    for plane in 0..6 {
        // Clip the polygon at one plane, edge by edge
        let mut inside = empty;
        let vertices = polygon.vertices();
        for (i, &to) in vertices.iter().enumerate() {
            let from = vertices[(i + vertices.len() - 1) % vertices.len()];
            let (a, b) = (plane_distances(from.clip)[plane], plane_distances(to.clip)[plane]);
            match (a >= 0.0, b >= 0.0) {
                (true, true) => inside.push(to),
                (true, false) => inside.push(intersect(from, a, to, b)),
                (false, true) => {
                    inside.push(intersect(to, b, from, a));
                    inside.push(to);
                }
                (false, false) => {}
            }
        }
        polygon = inside;
    }
    if polygon.count < 3 { empty } else { polygon }
}

/// Returns the point where the edge from a vertex inside to one outside crosses the plane.
fn intersect(
    inside: ClippedVertex,
    distance_inside: f32,
    outside: ClippedVertex,
    distance_outside: f32,
) -> ClippedVertex {
    let t = distance_inside / (distance_inside - distance_outside);
    ClippedVertex {
        clip: inside.clip + (outside.clip - inside.clip) * t,
        barycentric: inside.barycentric + (outside.barycentric - inside.barycentric) * t,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_triangle_that_covers_the_screen_is_kept_though_all_its_vertices_are_outside() {
        let at = |x: f32, y: f32| Vec4::new(x, y, 0.5, 1.0);
        let triangle = [at(-9.0, -9.0), at(9.0, -9.0), at(0.0, 20.0)];
        assert_eq!(clip_test(triangle.map(outcode)), ClipTest::Straddles);
        let polygon = clip_triangle(triangle);
        assert_eq!(polygon.vertices().len(), 4, "the whole screen");
        for vertex in polygon.vertices() {
            assert!(vertex.clip.x.abs() == 1.0 && vertex.clip.y.abs() == 1.0, "{vertex:?}");
        }
    }

    #[test]
    fn triangles_behind_the_camera_are_clipped_at_the_near_plane() {
        // Reversed depth: z is the near distance, w the distance.
        let near = 0.1;
        let triangle =
            [Vec4::new(0.0, 0.0, near, 2.0), Vec4::new(0.5, 0.0, near, -1.0), Vec4::new(0.0, 0.5, near, -1.0)];
        let polygon = clip_triangle(triangle);
        assert!(polygon.vertices().len() >= 3);
        for vertex in polygon.vertices() {
            assert!(vertex.clip.w >= near * 0.999, "{vertex:?}");
            let b = vertex.barycentric;
            assert!((b.element_sum() - 1.0).abs() < 1e-5);
            let interpolated = triangle[0] * b.x + triangle[1] * b.y + triangle[2] * b.z;
            assert!((interpolated - vertex.clip).length() < 1e-5, "barycentric coordinates give the same point");
        }
        assert_eq!(clip_test([outcode(Vec4::new(0.0, 0.0, near, -1.0)); 3]), ClipTest::Outside);
        assert_eq!(clip_test([outcode(Vec4::NAN); 3]), ClipTest::Outside);
    }

    #[test]
    fn neighbours_clip_their_common_edge_at_the_same_point() {
        let (a, b) = (Vec4::new(0.3, -0.2, 0.1, 0.7), Vec4::new(3.1, 0.4, 0.1, 1.3));
        let (c, d) = (Vec4::new(0.2, 0.6, 0.1, 0.9), Vec4::new(0.1, -0.7, 0.1, 0.8));
        let on_edge = |triangle: [Vec4; 3]| -> Vec<[u32; 4]> {
            let bits = |p: Vec4| p.to_array().map(f32::to_bits);
            let polygon = clip_triangle(triangle);
            let on_edge = polygon.vertices().iter().filter(|v| v.barycentric.min_element() == 0.0);
            on_edge.map(|v| bits(v.clip)).collect()
        };
        let (one, other) = (on_edge([a, b, c]), on_edge([b, a, d]));
        assert!(one.iter().filter(|point| other.contains(point)).count() >= 2, "{one:?} {other:?}");
    }
}

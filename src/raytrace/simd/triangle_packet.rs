//! Eight triangles as a structure of arrays, and a ray prepared for the watertight test against them.
//!
//! Woop, Benthin and Wald 2013, "Watertight Ray/Triangle Intersection" (JCGT 2, 1): the ray is sheared onto an axis,
//! and the edge functions are evaluated in 2D. Both triangles of a shared edge evaluate the same function, so that no
//! ray passes between them. Edge functions of exactly 0 are evaluated again in f64.

use crate::math::simd::LANES;
use glam::Vec3;

/// Up to eight triangles. Unused lanes hold NaN, which fails every comparison.
#[derive(Clone, Copy, Debug)]
#[repr(C, align(64))]
pub struct TrianglePacket {
    /// By vertex, axis and lane.
    pub(super) corners: [[[f32; LANES]; 3]; 3],
    /// Triangle indices in the mesh.
    triangles: [u32; LANES],
}

/// A ray prepared for the triangle test: axes permuted so that Z is the largest direction component, then sheared onto
/// Z.
#[derive(Clone, Copy, Debug)]
pub struct ShearedRay {
    pub(super) origin: [f32; 3],
    /// World axes that become X, Y and Z.
    pub(super) axes: [usize; 3],
    /// Shear of X and Y, scale of Z.
    pub(super) shear: [f32; 3],
}

/// The intersection of a ray with a triangle.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct TriangleHit {
    /// Distance in multiples of the ray's direction vector.
    pub t: f32,
    /// Triangle index in the mesh.
    pub triangle: u32,
    /// Barycentric coordinates of the second and third corner.
    pub barycentric: [f32; 2],
}

impl ShearedRay {
    /// Prepares a ray. The direction must not be zero.
    #[inline(always)]
    pub fn new(origin: Vec3, direction: Vec3) -> Self {
        let abs = direction.abs();
        let z = if abs.x > abs.y && abs.x > abs.z {
            0
        } else if abs.y > abs.z {
            1
        } else {
            2
        };
        let direction = direction.to_array();
        // Swap X and Y for rays along -Z: this preserves the winding of the triangles
        let (x, y) = if direction[z] < 0.0 { (PREVIOUS[z], NEXT[z]) } else { (NEXT[z], PREVIOUS[z]) };
        let inverse = 1.0 / direction[z];
        let shear = [direction[x] * inverse, direction[y] * inverse, inverse];
        ShearedRay { origin: origin.to_array(), axes: [x, y, z], shear }
    }
}

/// The cyclic successor and predecessor of each axis.
const NEXT: [usize; 3] = [1, 2, 0];
const PREVIOUS: [usize; 3] = [2, 0, 1];

impl TrianglePacket {
    /// Packs up to eight triangles, given by index and corners.
    pub fn new(triangles: impl IntoIterator<Item = (u32, [Vec3; 3])>) -> Self {
        let mut packet = TrianglePacket { corners: [[[f32::NAN; LANES]; 3]; 3], triangles: [u32::MAX; LANES] };
        for (lane, (index, corners)) in triangles.into_iter().take(LANES).enumerate() {
            packet.triangles[lane] = index;
            for (vertex, corner) in corners.iter().enumerate() {
                for axis in 0..3 {
                    packet.corners[vertex][axis][lane] = corner[axis];
                }
            }
        }
        packet
    }

    /// Returns the hit in a lane, given its distance and edge functions.
    #[inline(always)]
    pub(super) fn hit(&self, lane: usize, t: f32, edges: [f32; 3]) -> TriangleHit {
        let inverse = 1.0 / (edges[0] + edges[1] + edges[2]);
        TriangleHit { t, triangle: self.triangles[lane], barycentric: [edges[1] * inverse, edges[2] * inverse] }
    }
}

/// Evaluates the edge functions again in f64 in the lanes where one is 0. The products of f32 factors are exact.
#[cold]
pub(super) fn edges_in_f64(e: &mut [[f32; LANES]; 3], x: &[[f32; LANES]; 3], y: &[[f32; LANES]; 3]) {
    for i in 0..LANES {
        if e.iter().all(|edge| edge[i] != 0.0) {
            continue;
        }
        for (k, edge) in e.iter_mut().enumerate() {
            let (a, b) = ((k + 1) % 3, (k + 2) % 3);
            let exact = f64::from(x[b][i]) * f64::from(y[a][i]) - f64::from(y[b][i]) * f64::from(x[a][i]);
            edge[i] = exact as f32;
        }
    }
}

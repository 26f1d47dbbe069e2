//! Methods of finding the closest hit in a mesh, from brute force to the BVH, for `catchlight chart --traversal`.
//!
//! All use the same watertight triangle kernel, so that distances have the same bits; they differ in the number of
//! triangles that they test.

use super::blas::Blas;
use super::bvh::TraversalStack;
use super::simd::{self, KernelTask, Kernels, LANES, ShearedRay, SlabRay, TrianglePacket};
use crate::math::Ray;
use crate::scene::Mesh;
use glam::Vec3;
use std::sync::Arc;

/// A method of finding the closest hit.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum IntersectionMethod {
    /// Tests every triangle of the mesh.
    BruteForce,
    /// Tests the bounding box of each part of the mesh, dividing by the direction; then every triangle of the part.
    PartBoxes,
    /// The same, with the inverse direction and its signs computed once a ray.
    PartBoxesPrecomputed,
    /// Traverses the eight-wide BVH of the renderer.
    Bvh,
}

impl IntersectionMethod {
    /// All methods, slowest first.
    pub const ALL: [IntersectionMethod; 4] = [
        IntersectionMethod::BruteForce,
        IntersectionMethod::PartBoxes,
        IntersectionMethod::PartBoxesPrecomputed,
        IntersectionMethod::Bvh,
    ];

    /// Returns the name in tables.
    pub fn label(self) -> &'static str {
        match self {
            IntersectionMethod::BruteForce => "brute",
            IntersectionMethod::PartBoxes => "box",
            IntersectionMethod::PartBoxesPrecomputed => "box-precomputed",
            IntersectionMethod::Bvh => "bvh",
        }
    }
}

/// A mesh prepared for a method.
#[derive(Debug)]
pub struct Intersector {
    method: IntersectionMethod,
    parts: Vec<BoxedPart>,
    blas: Option<Blas>,
}

/// Triangles with their bounding box.
#[derive(Debug)]
struct BoxedPart {
    low: Vec3,
    high: Vec3,
    packets: Vec<TrianglePacket>,
}

impl BoxedPart {
    fn new(mesh: &Mesh, triangles: std::ops::Range<u32>) -> Self {
        let all: Vec<u32> = triangles.collect();
        let corners = all.iter().flat_map(|&t| mesh.corners(t as usize));
        let start = (Vec3::INFINITY, Vec3::NEG_INFINITY);
        let (low, high) = corners.fold(start, |(low, high), p| (low.min(p), high.max(p)));
        let pack = |chunk: &[u32]| TrianglePacket::new(chunk.iter().map(|&t| (t, mesh.corners(t as usize))));
        BoxedPart { low, high, packets: all.chunks(LANES).map(pack).collect() }
    }

    /// Tests the box by dividing by the direction; min and max order the slabs.
    fn is_hit_by_division(&self, ray: &Ray) -> bool {
        let (mut enter, mut exit) = (0.0_f32, ray.t_max);
        for axis in 0..3 {
            let a = (self.low[axis] - ray.origin[axis]) / ray.direction[axis];
            let b = (self.high[axis] - ray.origin[axis]) / ray.direction[axis];
            // min and max drop the NaN of a ray in the plane of a slab.
            enter = a.min(b).max(enter);
            exit = a.max(b).min(exit);
        }
        enter <= exit * (1.0 + 4.0 * f32::EPSILON)
    }

    /// Tests the box with the precomputed inverse direction and its signs.
    fn is_hit(&self, ray: &Ray, inverse: Vec3, negative: [bool; 3]) -> bool {
        let (mut enter, mut exit) = (0.0_f32, ray.t_max);
        for axis in 0..3 {
            let (near, far) =
                if negative[axis] { (self.high[axis], self.low[axis]) } else { (self.low[axis], self.high[axis]) };
            enter = ((near - ray.origin[axis]) * inverse[axis]).max(enter);
            exit = ((far - ray.origin[axis]) * inverse[axis]).min(exit);
        }
        enter <= exit * (1.0 + 4.0 * f32::EPSILON)
    }
}

impl Intersector {
    /// Prepares a mesh for a method.
    pub fn new(mesh: &Arc<Mesh>, method: IntersectionMethod) -> Self {
        let whole: Vec<_> = std::iter::once(0..mesh.triangles.len() as u32).collect();
        let (ranges, blas) = match method {
            IntersectionMethod::BruteForce => (whole, None),
            IntersectionMethod::PartBoxes | IntersectionMethod::PartBoxesPrecomputed => {
                (mesh.parts.iter().map(|part| part.triangles.clone()).collect(), None)
            }
            IntersectionMethod::Bvh => (Vec::new(), Some(Blas::new(mesh.triangles.len(), |t| mesh.corners(t)))),
        };
        let parts = ranges.into_iter().map(|range| BoxedPart::new(mesh, range)).collect();
        Intersector { method, parts, blas }
    }

    /// Returns the distances of the closest hits, in multiples of each ray's direction; infinite for a miss.
    pub fn distances(&self, rays: &[Ray]) -> Vec<f32> {
        simd::dispatch(Distances { intersector: self, rays })
    }

    #[inline(always)]
    fn closest<K: Kernels>(&self, ray: &Ray, stack: &mut TraversalStack) -> Option<f32> {
        if let Some(blas) = &self.blas {
            return blas.intersect::<K>(ray, &SlabRay::new(ray.origin, ray.direction), stack).map(|hit| hit.t);
        }
        let sheared = ShearedRay::new(ray.origin, ray.direction);
        let inverse = ray.direction.recip();
        let negative = inverse.to_array().map(f32::is_sign_negative);
        let mut nearest = None;
        let mut ray = *ray;
        for part in &self.parts {
            let is_hit = match self.method {
                IntersectionMethod::PartBoxes => part.is_hit_by_division(&ray),
                IntersectionMethod::PartBoxesPrecomputed => part.is_hit(&ray, inverse, negative),
                IntersectionMethod::BruteForce | IntersectionMethod::Bvh => true,
            };
            for packet in part.packets.iter().filter(|_| is_hit) {
                if let Some(hit) = K::intersect_triangles(&sheared, packet, ray.t_max) {
                    ray.t_max = hit.t;
                    nearest = Some(hit.t);
                }
            }
        }
        nearest
    }
}

/// The task of [`Intersector::distances`].
struct Distances<'a> {
    intersector: &'a Intersector,
    rays: &'a [Ray],
}

impl KernelTask for Distances<'_> {
    type Output = Vec<f32>;

    #[inline(always)]
    fn run<K: Kernels>(self) -> Vec<f32> {
        let mut stack = TraversalStack::default();
        let distance = |ray: &Ray| self.intersector.closest::<K>(ray, &mut stack).unwrap_or(f32::INFINITY);
        self.rays.iter().map(distance).collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::math::warp;
    use crate::scene::{Shape, tessellate};
    use glam::Vec2;

    #[test]
    fn all_methods_return_the_same_bits() {
        let mut mesh = tessellate(&Shape::Sphere { radius_m: 1.0 }).unwrap();
        mesh.append(&tessellate(&Shape::Box { size_m: Vec3::new(3.0, 0.5, 0.5) }).unwrap());
        let mesh = Arc::new(mesh);
        assert!(mesh.parts.len() > 1, "the test needs several parts");
        let ray = |i: u32| {
            let [a, b, c, d] = sobol_burley::sample_4d(i, 0, 1);
            let origin = 2.5 * warp::uniform_sphere(Vec2::new(a, b));
            Ray { origin, direction: warp::uniform_sphere(Vec2::new(c, d)), t_max: f32::INFINITY }
        };
        let rays: Vec<Ray> = (0..4096).map(ray).collect();
        let truth = Intersector::new(&mesh, IntersectionMethod::BruteForce).distances(&rays);
        assert!(truth.iter().filter(|t| t.is_finite()).count() > 150);
        for method in IntersectionMethod::ALL {
            assert_eq!(Intersector::new(&mesh, method).distances(&rays), truth, "{}", method.label());
        }
    }
}

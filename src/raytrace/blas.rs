//! The bottom-level acceleration structure (BLAS): a BVH over triangles or other primitives.

use super::bvh::{self, BuildEffort, TraversalStack, WideBvh};
use super::simd::{Kernels, LANES, ShearedRay, SlabRay, TriangleHit, TrianglePacket};
use crate::math::Ray;
use glam::Vec3;
use rayon::prelude::*;

/// The primitives of a leaf, which are intersected together.
pub trait LeafPacket: Send {
    /// A ray prepared for their intersection.
    type PreparedRay;
    /// Their intersection with a ray.
    type Hit: Copy;
    /// The work of the build that pays in the traversal.
    const BUILD_EFFORT: BuildEffort;

    /// Prepares a ray.
    fn prepare(ray: &Ray) -> Self::PreparedRay;

    /// Returns the closest hit nearer than `t_max`.
    fn intersect<K: Kernels>(&self, ray: &Self::PreparedRay, t_max: f32) -> Option<Self::Hit>;

    /// Returns the distance of a hit, in multiples of the ray's direction vector.
    fn distance(hit: &Self::Hit) -> f32;
}

impl LeafPacket for TrianglePacket {
    type PreparedRay = ShearedRay;
    type Hit = TriangleHit;
    const BUILD_EFFORT: BuildEffort = BuildEffort::Reinsertion;

    #[inline(always)]
    fn prepare(ray: &Ray) -> ShearedRay {
        ShearedRay::new(ray.origin, ray.direction)
    }

    #[inline(always)]
    fn intersect<K: Kernels>(&self, ray: &ShearedRay, t_max: f32) -> Option<TriangleHit> {
        K::intersect_triangles(ray, self, t_max)
    }

    #[inline(always)]
    fn distance(hit: &TriangleHit) -> f32 {
        hit.t
    }
}

/// Primitives and the BVH over them, in the space of the caller's bounding boxes.
#[derive(Debug)]
pub struct Blas<P = TrianglePacket> {
    bvh: WideBvh,
    /// One packet a leaf.
    packets: Vec<P>,
}

impl<P> Default for Blas<P> {
    fn default() -> Self {
        Blas { bvh: WideBvh::default(), packets: Vec::new() }
    }
}

impl Blas {
    /// Builds the BVH over triangles 0 to `count`.
    pub fn new(count: usize, corners: impl Fn(usize) -> [Vec3; 3] + Sync) -> Self {
        let bounds = |t: usize| {
            let [a, b, c] = corners(t);
            (a.min(b).min(c), a.max(b).max(c))
        };
        let boxes: Vec<(Vec3, Vec3)> = (0..count).into_par_iter().map(bounds).collect();
        Blas::build(&boxes, |leaf| TrianglePacket::new(leaf.iter().map(|&t| (t, corners(t as usize)))))
    }
}

impl<P: LeafPacket> Blas<P> {
    /// Builds the BVH over primitives with these bounding boxes. `pack` makes the packet of a leaf from the indices of
    /// its primitives.
    pub fn build(boxes: &[(Vec3, Vec3)], pack: impl Fn(&[u32]) -> P + Sync) -> Self {
        let bvh = bvh::build(boxes, LANES as u32, P::BUILD_EFFORT);
        let packets = (0..bvh.leaf_count() as u32).into_par_iter().map(|leaf| pack(bvh.leaf(leaf))).collect();
        Blas { bvh, packets }
    }

    /// Returns the bounding box of all primitives; none without primitives.
    pub fn bounds(&self) -> Option<(Vec3, Vec3)> {
        self.bvh.bounds
    }

    /// Returns the closest hit. `slab_ray` is the same ray, prepared for the slab test.
    #[inline(always)]
    pub fn intersect<K: Kernels>(&self, ray: &Ray, slab_ray: &SlabRay, stack: &mut TraversalStack) -> Option<P::Hit> {
        let prepared = P::prepare(ray);
        let mut closest = None;
        self.bvh.traverse_front_to_back::<K>(
            slab_ray,
            ray.t_max,
            stack,
            #[inline(always)]
            |leaf, t_max, _| match self.packets[leaf as usize].intersect::<K>(&prepared, t_max) {
                Some(hit) => {
                    closest = Some(hit);
                    P::distance(&hit)
                }
                None => t_max,
            },
        );
        closest
    }

    /// Returns true if the ray hits anything. `slab_ray` is the same ray, prepared for the slab test.
    #[inline(always)]
    pub fn occluded<K: Kernels>(&self, ray: &Ray, slab_ray: &SlabRay, stack: &mut TraversalStack) -> bool {
        let prepared = P::prepare(ray);
        self.bvh.traverse_any::<K>(
            slab_ray,
            ray.t_max,
            stack,
            #[inline(always)]
            |leaf, _| self.packets[leaf as usize].intersect::<K>(&prepared, ray.t_max).is_some(),
        )
    }
}

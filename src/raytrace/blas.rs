//! The bottom-level acceleration structure (BLAS): a BVH over triangles.

use super::bvh::{self, TraversalStack, WideBvh};
use super::simd::{Kernels, LANES, ShearedRay, SlabRay, TriangleHit, TrianglePacket};
use crate::math::Ray;
use glam::Vec3;
use rayon::prelude::*;

/// Triangles and the BVH over them, in the space of the caller's corners.
#[derive(Debug, Default)]
pub struct Blas {
    bvh: WideBvh,
    /// One packet a leaf.
    packets: Vec<TrianglePacket>,
}

impl Blas {
    /// Builds the BVH over triangles 0 to `count`.
    pub fn new(count: usize, corners: impl Fn(usize) -> [Vec3; 3] + Sync) -> Self {
        let bounds = |t: usize| {
            let [a, b, c] = corners(t);
            (a.min(b).min(c), a.max(b).max(c))
        };
        let boxes: Vec<(Vec3, Vec3)> = (0..count).into_par_iter().map(bounds).collect();
        let bvh = bvh::build(&boxes, LANES as u32);
        let packets = (0..bvh.leaf_count() as u32)
            .into_par_iter()
            .map(|leaf| TrianglePacket::new(bvh.leaf(leaf).iter().map(|&t| (t, corners(t as usize)))))
            .collect();
        Blas { bvh, packets }
    }

    /// Returns the bounding box of all triangles; none without triangles.
    pub fn bounds(&self) -> Option<(Vec3, Vec3)> {
        self.bvh.bounds
    }

    /// Returns the closest hit. `slab_ray` is the same ray, prepared for the slab test.
    #[inline(always)]
    pub fn intersect<K: Kernels>(
        &self,
        ray: &Ray,
        slab_ray: &SlabRay,
        stack: &mut TraversalStack,
    ) -> Option<TriangleHit> {
        let sheared = ShearedRay::new(ray.origin, ray.direction);
        let mut closest = None;
        self.bvh.traverse_front_to_back::<K>(
            slab_ray,
            ray.t_max,
            stack,
            #[inline(always)]
            |leaf, t_max, _| match K::intersect_triangles(&sheared, &self.packets[leaf as usize], t_max) {
                Some(hit) => {
                    closest = Some(hit);
                    hit.t
                }
                None => t_max,
            },
        );
        closest
    }

    /// Returns true if the ray hits anything. `slab_ray` is the same ray, prepared for the slab test.
    #[inline(always)]
    pub fn occluded<K: Kernels>(&self, ray: &Ray, slab_ray: &SlabRay, stack: &mut TraversalStack) -> bool {
        let sheared = ShearedRay::new(ray.origin, ray.direction);
        self.bvh.traverse_any::<K>(
            slab_ray,
            ray.t_max,
            stack,
            #[inline(always)]
            |leaf, _| K::intersect_triangles(&sheared, &self.packets[leaf as usize], ray.t_max).is_some(),
        )
    }
}

//! A tree over triangles, the lowest level of every ray's way.

use super::bvh::{self, Slabs, TraversalStack, WideBvh};
use super::simd::{Kernels, WIDTH};
use super::triangle::{Packet, ShearedRay, TriangleHit};
use crate::math::Ray;
use glam::Vec3;
use rayon::prelude::*;

/// Triangles with their tree, in whatever space they were given.
#[derive(Debug, Default)]
pub struct Blas {
    bvh: WideBvh,
    /// One packet a leaf.
    packets: Vec<Packet>,
}

impl Blas {
    /// Builds the tree over triangles 0 to `count`.
    pub fn new(count: usize, corners: impl Fn(usize) -> [Vec3; 3] + Sync) -> Self {
        let bounds = |t: usize| {
            let [a, b, c] = corners(t);
            (a.min(b).min(c), a.max(b).max(c))
        };
        let boxes: Vec<(Vec3, Vec3)> = (0..count).into_par_iter().map(bounds).collect();
        let bvh = bvh::build(&boxes, WIDTH as u32);
        let packets = (0..bvh.leaf_count() as u32)
            .into_par_iter()
            .map(|leaf| Packet::new(bvh.leaf(leaf).iter().map(|&t| (t, corners(t as usize)))))
            .collect();
        Blas { bvh, packets }
    }

    /// Smallest box around everything; none when there is nothing.
    pub fn bounds(&self) -> Option<(Vec3, Vec3)> {
        self.bvh.bounds
    }

    /// The closest hit of a ray, whose slabs these are.
    #[inline(always)]
    pub fn intersect<K: Kernels>(&self, ray: &Ray, slabs: &Slabs, stack: &mut TraversalStack) -> Option<TriangleHit> {
        let sheared = ShearedRay::new(ray.origin, ray.direction);
        let mut best = None;
        self.bvh.traverse_front_to_back::<K>(
            slabs,
            ray.t_max,
            stack,
            #[inline(always)]
            |leaf, t_max, _| match K::triangles(&self.packets[leaf as usize], &sheared, t_max) {
                Some(hit) => {
                    best = Some(hit);
                    hit.t
                }
                None => t_max,
            },
        );
        best
    }

    /// Whether anything lies on the ray, whose slabs these are.
    #[inline(always)]
    pub fn occluded<K: Kernels>(&self, ray: &Ray, slabs: &Slabs, stack: &mut TraversalStack) -> bool {
        let sheared = ShearedRay::new(ray.origin, ray.direction);
        self.bvh.traverse_any::<K>(
            slabs,
            ray.t_max,
            stack,
            #[inline(always)]
            |leaf, _| K::triangles(&self.packets[leaf as usize], &sheared, ray.t_max).is_some(),
        )
    }
}

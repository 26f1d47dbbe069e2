//! Finding the emitters that a ray hits: a BVH over the boxes of local emitters, and a list of those at infinity.

use super::traced_light::{EmitterHit, TracedLight};
use crate::math::Ray;
use crate::raytrace::bvh::{self, BuildEffort, TraversalStack, WideBvh};
use crate::raytrace::simd::{self, KernelTask, Kernels, SlabRay};

/// The emitters that rays can hit.
#[derive(Debug, Default)]
pub struct EmitterBvh {
    bvh: WideBvh,
    /// Light of each box.
    local: Vec<u32>,
    /// Lights at infinity: suns and surrounds.
    distant: Vec<u32>,
}

impl EmitterBvh {
    /// Builds the BVH over a scene's lights, which keep their indices.
    pub fn new(lights: &[TracedLight]) -> Self {
        let mut emitters = EmitterBvh::default();
        let mut boxes = Vec::new();
        for (light, index) in lights.iter().zip(0..) {
            match light.bounds() {
                Some(bounds) => {
                    emitters.local.push(index);
                    boxes.push(bounds);
                }
                None if !light.is_delta() => emitters.distant.push(index),
                None => {}
            }
        }
        emitters.bvh = bvh::build(&boxes, 1, BuildEffort::Reinsertion);
        emitters
    }

    /// Calls `found` for every light that the ray hits before its `t_max`, in no order. Hits beyond `t_max` may be
    /// included: the caller compares the distance.
    #[inline]
    pub fn for_each_hit(
        &self,
        lights: &[TracedLight],
        ray: &Ray,
        stack: &mut TraversalStack,
        mut found: impl FnMut(u32, EmitterHit),
    ) {
        if !self.local.is_empty() {
            simd::dispatch(ForEachLocalHit { emitters: self, lights, ray, stack, found: &mut found });
        }
        if ray.t_max.is_infinite() {
            for &light in &self.distant {
                if let Some(hit) = lights[light as usize].intersect(ray.origin, ray.direction) {
                    found(light, hit);
                }
            }
        }
    }
}

/// The task of [`EmitterBvh::for_each_hit`].
struct ForEachLocalHit<'a, F> {
    emitters: &'a EmitterBvh,
    lights: &'a [TracedLight],
    ray: &'a Ray,
    stack: &'a mut TraversalStack,
    found: &'a mut F,
}

impl<F: FnMut(u32, EmitterHit)> KernelTask for ForEachLocalHit<'_, F> {
    type Output = ();

    #[inline(always)]
    fn run<K: Kernels>(self) {
        let ForEachLocalHit { emitters, lights, ray, stack, found } = self;
        let slab_ray = SlabRay::new(ray.origin, ray.direction);
        emitters.bvh.traverse_front_to_back::<K>(
            &slab_ray,
            ray.t_max,
            stack,
            #[inline(always)]
            |leaf, t_max, _| {
                for &index in emitters.bvh.leaf(leaf) {
                    let light = emitters.local[index as usize];
                    if let Some(hit) = lights[light as usize].intersect(ray.origin, ray.direction) {
                        found(light, hit);
                    }
                }
                t_max
            },
        );
    }
}

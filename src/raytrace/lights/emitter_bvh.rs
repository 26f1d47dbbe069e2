//! Which emitters a ray crosses: those with a place in a tree over their boxes, sun and surround by asking them.

use super::{EmitterHit, Source, TracedLight};
use crate::math::Ray;
use crate::raytrace::bvh::{self, TraversalStack, WideBvh};
use crate::raytrace::simd::{self, KernelTask, Kernels, SlabRay};
use glam::Vec3;

/// Emitters that rays can meet.
#[derive(Debug, Default)]
pub struct EmitterBvh {
    bvh: WideBvh,
    /// Light of each box.
    placed: Vec<u32>,
    /// Lights at infinity.
    distant: Vec<u32>,
}

impl EmitterBvh {
    /// Over a scene's lights, in their order.
    pub fn new(lights: &[TracedLight]) -> Self {
        let mut emitter_bvh = EmitterBvh::default();
        let mut boxes = Vec::new();
        for (light, index) in lights.iter().zip(0..) {
            match light.bounds() {
                Some(bounds) => {
                    emitter_bvh.placed.push(index);
                    boxes.push(bounds);
                }
                None if !light.is_delta() => emitter_bvh.distant.push(index),
                None => {}
            }
        }
        emitter_bvh.bvh = bvh::build(&boxes, 1);
        emitter_bvh
    }

    /// Gives every light that the ray sees before its end, in no order, with what it sees of it.
    #[inline]
    pub fn for_each_hit(
        &self,
        lights: &[TracedLight],
        ray: &Ray,
        stack: &mut TraversalStack,
        mut found: impl FnMut(u32, EmitterHit),
    ) {
        if !self.placed.is_empty() {
            simd::dispatch(Cross { emitter_bvh: self, lights, ray, stack, found: &mut found });
        }
        if ray.t_max.is_infinite() {
            for &light in &self.distant {
                if let Some(seen) = lights[light as usize].intersect(ray.origin, ray.direction) {
                    found(light, seen);
                }
            }
        }
    }
}

impl TracedLight {
    /// A box around what a ray can meet of it, a little wider than it is; none for what has no place or no size.
    fn bounds(&self) -> Option<(Vec3, Vec3)> {
        let (centre, reach) = match self.source {
            Source::Rect { rect, .. } => (rect.centre, rect.right.abs() * rect.half.x + rect.up.abs() * rect.half.y),
            Source::Disc { disc, .. } => (disc.centre, (disc.right.abs() + disc.up.abs()) * disc.radius),
            Source::Ball { ball, .. } => (ball.centre, Vec3::splat(ball.radius)),
            Source::Point { .. } | Source::Spot { .. } | Source::Sun { .. } | Source::Surround { .. } => return None,
        };
        // Rounding of the box test and of the emitter's own differ.
        let reach = reach + Vec3::splat(1e-5 * (centre.abs() + reach).max_element());
        Some((centre - reach, centre + reach))
    }
}

/// See [`EmitterBvh::for_each_hit`].
struct Cross<'a, F> {
    emitter_bvh: &'a EmitterBvh,
    lights: &'a [TracedLight],
    ray: &'a Ray,
    stack: &'a mut TraversalStack,
    found: &'a mut F,
}

impl<F: FnMut(u32, EmitterHit)> KernelTask for Cross<'_, F> {
    type Output = ();

    #[inline(always)]
    fn run<K: Kernels>(self) {
        let Cross { emitter_bvh, lights, ray, stack, found } = self;
        let slab_ray = SlabRay::new(ray.origin, ray.direction);
        emitter_bvh.bvh.traverse_front_to_back::<K>(
            &slab_ray,
            ray.t_max,
            stack,
            #[inline(always)]
            |leaf, t_max, _| {
                for &place in emitter_bvh.bvh.leaf(leaf) {
                    let light = emitter_bvh.placed[place as usize];
                    if let Some(seen) = lights[light as usize].intersect(ray.origin, ray.direction) {
                        found(light, seen);
                    }
                }
                t_max
            },
        );
    }
}

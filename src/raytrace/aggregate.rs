//! All that a ray can hit: the tree over the instances.

use super::bvh::{self, Slabs, Stack, WideBvh};
use super::geometry::{Instance, Surface};
use super::triangle::TriangleHit;
use crate::math::Ray;

/// Instances and the tree over them.
#[derive(Debug, Default)]
pub struct Aggregate {
    instances: Vec<Instance>,
    bvh: WideBvh,
}

/// A hit of some instance.
#[derive(Clone, Copy, Debug)]
pub struct Hit {
    /// Index of the instance.
    pub instance: u32,
    /// Where on its mesh.
    pub triangle: TriangleHit,
}

impl Aggregate {
    /// Builds the top tree. Instances without triangles are dropped.
    pub fn new(instances: Vec<Instance>) -> Self {
        let (instances, boxes): (Vec<_>, Vec<_>) =
            instances.into_iter().filter_map(|i| i.world_bounds().map(|b| (i, b))).unzip();
        let bvh = bvh::build(&boxes, 1);
        Aggregate { instances, bvh }
    }

    /// The instances, in the order that [`Hit::instance`] counts.
    pub fn instances(&self) -> &[Instance] {
        &self.instances
    }

    /// The closest hit.
    #[inline]
    pub fn closest(&self, ray: &Ray, stack: &mut Stack) -> Option<Hit> {
        let slabs = Slabs::new(ray.origin, ray.direction);
        let mut best = None;
        self.bvh.traverse(&slabs, ray.t_max, stack, |leaf, t_max, stack| {
            let mut end = t_max;
            for &index in self.bvh.leaf(leaf) {
                let instance = &self.instances[index as usize];
                let local = instance.to_object(&Ray { t_max: end, ..*ray });
                if let Some(triangle) = instance.geometry.closest(&local, stack) {
                    end = triangle.t;
                    best = Some(Hit { instance: index, triangle });
                }
            }
            end
        });
        best
    }

    /// Whether anything lies on the ray before its end.
    #[inline]
    pub fn blocked(&self, ray: &Ray, stack: &mut Stack) -> bool {
        let slabs = Slabs::new(ray.origin, ray.direction);
        let mut found = false;
        self.bvh.traverse(&slabs, ray.t_max, stack, |leaf, t_max, stack| {
            found = self.bvh.leaf(leaf).iter().any(|&index| {
                let instance = &self.instances[index as usize];
                instance.geometry.any(&instance.to_object(ray), stack)
            });
            if found { -1.0 } else { t_max }
        });
        found
    }

    /// The surface at a hit.
    pub fn surface(&self, hit: &Hit) -> Surface {
        self.instances[hit.instance as usize].surface(&hit.triangle)
    }
}

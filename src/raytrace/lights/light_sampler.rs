//! Selection of one light at a shading point, in proportion to its importance.

use super::light_bvh::{ChildImportances, LightBvh, LightChild};
use super::traced_light::TracedLight;
use glam::Vec3;

/// Samples one of a scene's lights by its importance at a shading point.
#[derive(Clone, Debug, Default)]
pub struct LightSampler {
    bvh: LightBvh,
}

impl LightSampler {
    /// Builds the sampler over a scene's lights, which keep their indices.
    pub fn new(lights: &[TracedLight]) -> Self {
        LightSampler { bvh: LightBvh::new(lights) }
    }

    /// Computes the importances at a shading point with this normal, from which several lights can be sampled. Returns
    /// none without lights.
    pub fn importances(&self, lights: &[TracedLight], point: Vec3, normal: Vec3) -> Option<LightImportances<'_>> {
        let importances = self.bvh.importances(lights, self.bvh.root()?, point, normal);
        Some(LightImportances { bvh: &self.bvh, point, normal, importances })
    }

    /// Samples a light for `u` in 0..1. Returns its index and its probability; none if no light contributes.
    pub fn sample(&self, lights: &[TracedLight], point: Vec3, normal: Vec3, u: f32) -> Option<(u32, f32)> {
        self.importances(lights, point, normal)?.sample(lights, u)
    }

    /// Returns the probability of sampling a light at a shading point.
    pub fn pmf(&self, lights: &[TracedLight], light: u32, point: Vec3, normal: Vec3) -> f32 {
        // Multiply the probabilities from the light's slot up to the root
        let mut pmf = 1.0;
        let mut slot = self.bvh.slot(light);
        if slot.is_none() {
            return 0.0;
        }
        while let Some((node, child)) = slot {
            let node = self.bvh.node(node);
            let importances = self.bvh.importances(lights, node, point, normal);
            if !importances.is_valid() {
                return 0.0;
            }
            pmf *= importances.pmf(child as usize);
            slot = node.parent;
        }
        pmf
    }

    /// Returns the number of nodes on the longest path to a light.
    #[cfg(test)]
    pub fn depth(&self) -> usize {
        self.bvh.depth()
    }
}

/// The importances of the root's children at a shading point.
#[derive(Clone, Copy, Debug)]
pub struct LightImportances<'a> {
    bvh: &'a LightBvh,
    point: Vec3,
    normal: Vec3,
    importances: ChildImportances,
}

impl LightImportances<'_> {
    /// Samples a light for `u` in 0..1. Returns its index and its probability; none if no light contributes.
    pub fn sample(&self, lights: &[TracedLight], u: f32) -> Option<(u32, f32)> {
        let LightImportances { bvh, point, normal, .. } = *self;
        let (mut node, mut u, mut pmf) = (bvh.root()?, u, 1.0);
        let mut node_importances;
        let mut importances = &self.importances;
        // Descend from the root, one sampled child at a time
        loop {
            if !importances.is_valid() {
                return None;
            }
            let (child, probability, remapped) = importances.sample(u)?;
            pmf *= probability;
            match bvh.child(node, child) {
                LightChild::Light(light) => return Some((light, pmf)),
                LightChild::Node(next) => {
                    // The remapped number is uniform again
                    u = remapped.clamp(0.0, 1.0 - f32::EPSILON);
                    node = bvh.node(next);
                    node_importances = bvh.importances(lights, node, point, normal);
                    importances = &node_importances;
                }
            }
        }
    }
}

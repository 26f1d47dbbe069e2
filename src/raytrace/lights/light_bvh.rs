//! A wide BVH over the bounds of lights, from which one light is sampled by importance.
//!
//! Conty Estevez and Kulla 2018, "Importance Sampling of Many Lights with Adaptive Tree Splitting", without the
//! splitting, and with up to 64 children a node instead of two: up to 64 lights are compared one by one.

use super::light_bounds::{LightBounds, LightBoundsPacket};
use super::traced_light::TracedLight;
use crate::math::find_interval;
use crate::raytrace::simd::{self, KernelTask, Kernels, LANES};
use glam::Vec3;

/// Largest number of children of a node.
const MAX_CHILDREN: usize = PACKETS * LANES;

/// Largest number of packets of a node.
const PACKETS: usize = 8;

/// Lower bound of a modifier's transmission in the importance: it is evaluated at the centre of the emitter, and may be
/// larger for other points of it.
const MIN_BEAM_TRANSMISSION: f32 = 0.02;

/// A child of a node.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum LightChild {
    /// Index of a light.
    Light(u32),
    /// Index of a node.
    Node(u32),
}

/// The position of a child: node index, and index among its children.
pub type ChildSlot = (u32, u32);

/// A node: a run of packets with the bounds of its children.
#[derive(Clone, Copy, Debug)]
pub struct LightNode {
    first_packet: u32,
    packets: u32,
    /// None for the root.
    pub parent: Option<ChildSlot>,
}

/// A BVH over all lights that next-event estimation samples. Node 0 is the root.
#[derive(Clone, Debug, Default)]
pub struct LightBvh {
    packets: Vec<LightBoundsPacket>,
    /// By packet and lane.
    children: Vec<LightChild>,
    nodes: Vec<LightNode>,
    /// Slot of each light; none for lights that are not sampled.
    slots: Vec<Option<ChildSlot>>,
    /// True if a light has a modifier that limits its directions.
    has_beams: bool,
}

/// The bounds and index of a light, during the build.
type BoundedLight = (LightBounds, u32);

impl LightBvh {
    /// Builds the BVH over a scene's lights, which keep their indices.
    pub fn new(lights: &[TracedLight]) -> Self {
        let mut bounded: Vec<BoundedLight> =
            lights.iter().zip(0..).filter_map(|(light, i)| Some((LightBounds::of(light)?, i))).collect();
        let has_beams = lights.iter().any(TracedLight::has_beam);
        let mut bvh = LightBvh { slots: vec![None; lights.len()], has_beams, ..LightBvh::default() };
        if !bounded.is_empty() {
            bvh.add_node(&mut bounded, None);
        }
        bvh
    }

    /// Adds a node over lights, and its subtree. Returns its index.
    fn add_node(&mut self, lights: &mut [BoundedLight], parent: Option<ChildSlot>) -> u32 {
        // Divide the lights into clusters; a sun shares no cluster with local lights
        lights.sort_by(|a, b| a.0.is_local.total_cmp(&b.0.is_local));
        let (suns, local) = lights.split_at_mut(lights.partition_point(|light| light.0.is_local == 0.0));
        let mut clusters = Vec::with_capacity(MAX_CHILDREN);
        split(suns, if local.is_empty() { MAX_CHILDREN } else { MAX_CHILDREN / 2 }, &mut clusters);
        split(local, MAX_CHILDREN - clusters.len(), &mut clusters);
        // Allocate the node and its packets
        let (index, first) = (self.nodes.len() as u32, self.packets.len());
        let packets = clusters.len().div_ceil(LANES);
        self.nodes.push(LightNode { first_packet: first as u32, packets: packets as u32, parent });
        self.packets.resize(first + packets, LightBoundsPacket::default());
        self.children.resize((first + packets) * LANES, LightChild::Node(0));
        // Add a child for each cluster: the light itself, or a node with its own children
        for (at, mut cluster) in clusters.into_iter().enumerate() {
            let slot = (index, at as u32);
            let (bounds, child) = if let [(bounds, light)] = cluster[..] {
                self.slots[light as usize] = Some(slot);
                (bounds, LightChild::Light(light))
            } else {
                let bounds = LightBounds::union(cluster.iter().map(|light| light.0));
                (bounds, LightChild::Node(self.add_node(&mut cluster, Some(slot))))
            };
            self.packets[first + at / LANES].set(at % LANES, &bounds);
            self.children[first * LANES + at] = child;
        }
        index
    }

    /// Returns the root; none without lights.
    #[inline]
    pub fn root(&self) -> Option<&LightNode> {
        self.nodes.first()
    }

    /// Returns a node.
    #[inline]
    pub fn node(&self, index: u32) -> &LightNode {
        &self.nodes[index as usize]
    }

    /// Returns a child of a node.
    #[inline]
    pub fn child(&self, node: &LightNode, index: usize) -> LightChild {
        self.children[node.first_packet as usize * LANES + index]
    }

    /// Returns the slot of a light; none for lights that are not sampled.
    #[inline]
    pub fn slot(&self, light: u32) -> Option<ChildSlot> {
        self.slots[light as usize]
    }

    /// Computes the importances of a node's children at a shading point.
    #[inline]
    pub fn importances(&self, lights: &[TracedLight], node: &LightNode, point: Vec3, normal: Vec3) -> ChildImportances {
        // Evaluate the bounds of all children
        let first = node.first_packet as usize;
        let packets = &self.packets[first..first + node.packets as usize];
        let mut importances = ChildImportances::ZERO;
        simd::dispatch(ComputeImportances { packets, point, normal, importances: &mut importances });
        // Multiply those of lights with a modifier by its transmission
        if self.has_beams {
            let lanes = importances.lanes.as_flattened_mut().iter_mut();
            for (lane, child) in lanes.zip(&self.children[first * LANES..]).take(packets.len() * LANES) {
                if let (true, LightChild::Light(light)) = (*lane > 0.0, *child) {
                    *lane *= lights[light as usize].beam_transmission_towards(point).max(MIN_BEAM_TRANSMISSION);
                }
            }
            importances.update_sums();
        }
        importances
    }

    /// Returns the number of nodes on the longest path to a light.
    #[cfg(test)]
    pub fn depth(&self) -> usize {
        let ancestors =
            |node: &LightNode| std::iter::successors(Some(*node), |n| Some(self.nodes[n.parent?.0 as usize])).count();
        self.nodes.iter().map(ancestors).max().unwrap_or(0)
    }
}

/// Halves a set of lights along the longest axis of their centres' bounds until there are `count` clusters of about the
/// same size.
fn split(lights: &mut [BoundedLight], count: usize, clusters: &mut Vec<Vec<BoundedLight>>) {
    if count <= 1 || lights.len() <= 1 {
        if !lights.is_empty() {
            clusters.push(lights.to_vec());
        }
        return;
    }
    let (low, high) = lights
        .iter()
        .fold((Vec3::INFINITY, Vec3::NEG_INFINITY), |(low, high), (b, _)| (low.min(b.centre), high.max(b.centre)));
    let size = high - low;
    let axis = if size.x >= size.y && size.x >= size.z {
        0
    } else if size.y >= size.z {
        1
    } else {
        2
    };
    lights.sort_by(|a, b| a.0.centre[axis].total_cmp(&b.0.centre[axis]));
    let middle = lights.len() / 2;
    let (lower, upper) = lights.split_at_mut(middle);
    split(lower, count / 2, clusters);
    split(upper, count - count / 2, clusters);
}

/// The importances of a node's children at a shading point.
#[derive(Clone, Copy, Debug)]
pub struct ChildImportances {
    lanes: [[f32; LANES]; PACKETS],
    /// Sum of each packet.
    sums: [f32; PACKETS],
    total: f32,
}

impl ChildImportances {
    const ZERO: ChildImportances =
        ChildImportances { lanes: [[0.0; LANES]; PACKETS], sums: [0.0; PACKETS], total: 0.0 };

    #[inline(always)]
    fn update_sums(&mut self) {
        for (sum, lanes) in self.sums.iter_mut().zip(&self.lanes) {
            *sum = lanes.iter().sum();
        }
        self.total = self.sums.iter().sum();
    }

    /// Returns true if a child can be sampled: the total is positive and finite.
    pub fn is_valid(&self) -> bool {
        self.total > 0.0 && self.total.is_finite()
    }

    /// Returns the probability of a child.
    #[inline]
    pub fn pmf(&self, child: usize) -> f32 {
        self.lanes.as_flattened()[child] / self.total
    }

    /// Samples a child in proportion to its importance. Returns it with its probability and `u` remapped to 0..1.
    #[inline]
    pub fn sample(&self, u: f32) -> Option<(usize, f32, f32)> {
        let (packet, _, rest) = find_interval(&self.sums, u * self.total)?;
        let (lane, importance, rest) = find_interval(&self.lanes[packet], rest)?;
        Some((packet * LANES + lane, importance / self.total, rest / importance))
    }
}

/// The task of [`LightBvh::importances`].
struct ComputeImportances<'a> {
    packets: &'a [LightBoundsPacket],
    point: Vec3,
    normal: Vec3,
    /// Output; zero before.
    importances: &'a mut ChildImportances,
}

impl KernelTask for ComputeImportances<'_> {
    type Output = ();

    #[inline(always)]
    fn run<K: Kernels>(self) {
        for (packet, lanes) in self.packets.iter().zip(&mut self.importances.lanes) {
            *lanes = packet.importances(self.point, self.normal);
        }
        self.importances.update_sums();
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::raytrace::lights::tests::random_lights;
    use crate::raytrace::simd::Scalar;
    use crate::statistics::TestRng;

    /// Returns the bits of lanes, sums and total.
    fn bits(importances: &ChildImportances) -> Vec<u32> {
        let ChildImportances { lanes, sums, total } = importances;
        lanes.as_flattened().iter().chain(sums).chain([total]).map(|value| value.to_bits()).collect()
    }

    #[test]
    fn avx2_and_scalar_importances_have_the_same_bits() {
        let mut rng = TestRng::new(21);
        let lights = random_lights(700, &mut rng);
        let bvh = LightBvh::new(&lights);
        assert!(bvh.nodes.len() > 1, "the test includes clusters");
        // Between the lights, exactly at their centres, and so far away that squares overflow.
        let mut points: Vec<Vec3> = (0..300).map(|_| rng.direction() * rng.range(0.0, 6.0)).collect();
        points.extend(lights.iter().step_by(9).filter_map(TracedLight::centre));
        points.extend((0..20).map(|_| rng.direction() * 1e25));
        let (mut positive, mut zero) = (0, 0);
        for point in points {
            let normal = rng.direction();
            for node in &bvh.nodes {
                let first = node.first_packet as usize;
                let packets = &bvh.packets[first..first + node.packets as usize];
                let (mut ours, mut scalar) = (ChildImportances::ZERO, ChildImportances::ZERO);
                simd::dispatch(ComputeImportances { packets, point, normal, importances: &mut ours });
                ComputeImportances { packets, point, normal, importances: &mut scalar }.run::<Scalar>();
                assert_eq!(bits(&ours), bits(&scalar), "at {point}, normal {normal}");
                let lanes = &ours.lanes.as_flattened()[..packets.len() * LANES];
                positive += lanes.iter().filter(|lane| **lane > 0.0).count();
                zero += lanes.iter().filter(|lane| **lane == 0.0).count();
            }
        }
        assert!(positive.min(zero) > 10_000, "{positive} importances are positive, {zero} are 0: too few for the test");
    }
}

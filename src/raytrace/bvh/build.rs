//! Building: PLOC with reinsertion (obvhs), then the collapse to eight children.

use super::wide::{LEAF, Node, WideBvh};
use crate::raytrace::simd::WIDTH;
use glam::Vec3;
use obvhs::aabb::Aabb;
use obvhs::bvh2::leaf_collapser::collapse;
use obvhs::bvh2::reinsertion::ReinsertionOptimizer;
use obvhs::bvh2::{Bvh2, node::Bvh2Node};
use obvhs::ploc::{PlocBuilder, PlocSearchDistance, SortPrecision};

/// Cost of a node step against a primitive test, for the choice of leaves.
const TRAVERSAL_COST: f32 = 1.5;
/// Share of the nodes that reinsertion tries; more buys little.
const REINSERTION_RATIO: f32 = 0.05;

/// Builds the tree over boxes, with at most `max_leaf` primitives a leaf. Deterministic.
pub fn build(boxes: &[(Vec3, Vec3)], max_leaf: u32) -> WideBvh {
    let Some(&first) = boxes.first() else { return WideBvh::default() };
    let bounds = boxes.iter().fold(first, |(low, high), b| (low.min(b.0), high.max(b.1)));
    let aabbs: Vec<Aabb> = boxes.iter().map(|b| Aabb::new(b.0.to_array().into(), b.1.to_array().into())).collect();
    let indices = (0..boxes.len() as u32).collect();
    let mut binary =
        PlocBuilder::with_capacity(aabbs.len()).build(PlocSearchDistance::Low, &aabbs, indices, SortPrecision::U64, 0);
    let mut optimizer = ReinsertionOptimizer::default();
    optimizer.run(&mut binary, REINSERTION_RATIO, None);
    if max_leaf > 1 {
        collapse(&mut binary, max_leaf, TRAVERSAL_COST);
    }
    let mut wide = WideBvh { nodes: Vec::with_capacity(binary.nodes.len() / 4 + 1), ..WideBvh::default() };
    wide.bounds = Some(bounds);
    wide.leaf_starts.push(0);
    collapse_to_wide(&binary, &mut wide);
    wide
}

/// Opens the largest inner child until a node has eight, then goes on with those that are left.
fn collapse_to_wide(binary: &Bvh2, wide: &mut WideBvh) {
    wide.nodes.push(Node::EMPTY);
    let mut open = vec![(0_usize, 0_usize)];
    while let Some((binary_index, wide_index)) = open.pop() {
        let children = widest_cut(binary, binary_index);
        for (slot, &child) in children.iter().enumerate() {
            let node = &binary.nodes[child];
            let reference = if node.is_leaf() {
                wide.push_leaf(primitives(binary, node))
            } else {
                wide.nodes.push(Node::EMPTY);
                open.push((child, wide.nodes.len() - 1));
                wide.nodes.len() as u32 - 1
            };
            let aabb = node.aabb();
            let (low, high) = (Vec3::from(aabb.min.to_array()), Vec3::from(aabb.max.to_array()));
            wide.nodes[wide_index].set(slot, low, high, reference);
        }
    }
}

impl WideBvh {
    /// Adds a leaf and returns the reference to it.
    fn push_leaf(&mut self, primitives: &[u32]) -> u32 {
        self.primitives.extend(primitives);
        self.leaf_starts.push(self.primitives.len() as u32);
        LEAF | (self.leaf_starts.len() as u32 - 2)
    }
}

fn primitives<'a>(binary: &'a Bvh2, leaf: &Bvh2Node) -> &'a [u32] {
    let start = leaf.first_index as usize;
    &binary.primitive_indices[start..start + leaf.prim_count as usize]
}

/// Up to eight descendants of a node that cover it. A leaf at the root covers itself.
fn widest_cut(binary: &Bvh2, root: usize) -> Vec<usize> {
    let mut cut = vec![root];
    while cut.len() < WIDTH {
        let area = |index: usize| binary.nodes[index].aabb().half_area();
        let largest = (0..cut.len())
            .filter(|&i| !binary.nodes[cut[i]].is_leaf())
            .max_by(|&a, &b| area(cut[a]).total_cmp(&area(cut[b])));
        let Some(largest) = largest else { break };
        let first_child = binary.nodes[cut[largest]].first_index as usize;
        cut[largest] = first_child;
        cut.push(first_child + 1);
    }
    cut
}

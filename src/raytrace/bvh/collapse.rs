//! From the binary tree to the eight-wide one that costs a ray least.
//!
//! By the surface area heuristic, with dynamic programming over the ways to cover each binary subtree by up to eight
//! wide nodes (Ylitie, Karras and Laine 2017, "Efficient Incoherent Ray Traversal on GPUs Through Compressed Wide BVHs",
//! section 3.1). A packet of triangles costs the same however few it holds, so leaves come out full.

use super::wide::{LEAF, Node, WideBvh};
use crate::raytrace::simd::WIDTH;
use obvhs::bvh2::Bvh2;

/// Time of a packet test against a node test, measured.
const LEAF_COST: f32 = 1.2;

/// How a binary subtree is covered at least cost.
#[derive(Clone, Copy, Debug)]
struct Cover {
    primitives: u32,
    /// `cost[i]`: by at most `i + 1` wide nodes or leaves; the last entry by the children of one wide node.
    cost: [f32; WIDTH],
    /// With `i + 1` nodes, how many of them cover the left child; 0: no more than `i` are of use. `split[0]` is 1 where
    /// the subtree becomes a leaf.
    split: [u8; WIDTH],
}

/// Makes the tree, with at most `max_leaf` primitives a leaf.
pub fn to_wide(binary: &Bvh2, max_leaf: u32) -> WideBvh {
    let covers = covers(binary, max_leaf);
    let mut wide = WideBvh { nodes: vec![Node::EMPTY], ..WideBvh::default() };
    wide.leaf_starts.push(0);
    let mut open = vec![(0_usize, 0_usize)];
    while let Some((binary_index, wide_index)) = open.pop() {
        let mut children = Vec::with_capacity(WIDTH);
        if covers[binary_index].split[0] == 1 {
            children.push(binary_index);
        } else {
            gather(binary, &covers, binary_index, WIDTH, &mut children);
        }
        for (slot, &child) in children.iter().enumerate() {
            let reference = if covers[child].split[0] == 1 {
                push_leaf(binary, child, &mut wide)
            } else {
                wide.nodes.push(Node::EMPTY);
                open.push((child, wide.nodes.len() - 1));
                wide.nodes.len() as u32 - 1
            };
            let aabb = binary.nodes[child].aabb();
            wide.nodes[wide_index].set(slot, aabb.min.to_array().into(), aabb.max.to_array().into(), reference);
        }
    }
    wide
}

/// The cheapest covers of all subtrees, from the leaves up.
fn covers(binary: &Bvh2, max_leaf: u32) -> Vec<Cover> {
    let nothing = Cover { primitives: 0, cost: [0.0; WIDTH], split: [0; WIDTH] };
    let mut covers = vec![nothing; binary.nodes.len()];
    for index in top_down(binary).into_iter().rev() {
        let node = &binary.nodes[index];
        let area = node.aabb().half_area();
        covers[index] = if node.is_leaf() {
            let mut split = [0; WIDTH];
            split[0] = 1;
            Cover { primitives: node.prim_count, cost: [area * LEAF_COST; WIDTH], split }
        } else {
            let first = node.first_index as usize;
            cover(area, &covers[first], &covers[first + 1], max_leaf)
        };
    }
    covers
}

fn cover(area: f32, left: &Cover, right: &Cover, max_leaf: u32) -> Cover {
    let mut cover = Cover { primitives: left.primitives + right.primitives, cost: [0.0; WIDTH], split: [0; WIDTH] };
    // The best way to share `nodes` between the two children.
    let shared = |nodes: usize| {
        let ways = (1..nodes).map(|k| (left.cost[k - 1] + right.cost[nodes - k - 1], k));
        ways.min_by(|a, b| a.0.total_cmp(&b.0)).unwrap_or((f32::INFINITY, 0))
    };
    let (distributed, k) = shared(WIDTH);
    let inner = area + distributed;
    let leaf = if cover.primitives <= max_leaf { area * LEAF_COST } else { f32::INFINITY };
    cover.cost[0] = inner.min(leaf);
    cover.split[0] = u8::from(leaf <= inner);
    for nodes in 2..WIDTH {
        let (cost, k) = shared(nodes);
        let i = nodes - 1;
        let better = cost < cover.cost[i - 1];
        cover.cost[i] = if better { cost } else { cover.cost[i - 1] };
        cover.split[i] = if better { k as u8 } else { 0 };
    }
    cover.cost[WIDTH - 1] = distributed;
    cover.split[WIDTH - 1] = k as u8;
    cover
}

/// All nodes, parents before children.
fn top_down(binary: &Bvh2) -> Vec<usize> {
    let mut order = Vec::with_capacity(binary.nodes.len());
    let mut open = vec![0];
    while let Some(index) = open.pop() {
        order.push(index);
        let node = &binary.nodes[index];
        if !node.is_leaf() {
            open.extend([node.first_index as usize, node.first_index as usize + 1]);
        }
    }
    order
}

/// The binary nodes that `nodes` wide ones cover this subtree by.
fn gather(binary: &Bvh2, covers: &[Cover], index: usize, nodes: usize, children: &mut Vec<usize>) {
    let mut i = nodes - 1;
    while i > 0 && covers[index].split[i] == 0 {
        i -= 1;
    }
    if i == 0 {
        children.push(index);
        return;
    }
    let (first, left) = (binary.nodes[index].first_index as usize, usize::from(covers[index].split[i]));
    gather(binary, covers, first, left, children);
    gather(binary, covers, first + 1, i + 1 - left, children);
}

/// Adds all primitives of a subtree as a leaf and returns the reference to it.
fn push_leaf(binary: &Bvh2, root: usize, wide: &mut WideBvh) -> u32 {
    let mut open = vec![root];
    while let Some(index) = open.pop() {
        let node = &binary.nodes[index];
        let first = node.first_index as usize;
        if node.is_leaf() {
            wide.primitives.extend(&binary.primitive_indices[first..first + node.prim_count as usize]);
        } else {
            open.extend([first, first + 1]);
        }
    }
    wide.leaf_starts.push(wide.primitives.len() as u32);
    LEAF | (wide.leaf_starts.len() as u32 - 2)
}

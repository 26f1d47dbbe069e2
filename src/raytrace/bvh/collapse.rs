//! Conversion of a binary BVH to the wide BVH of least expected traversal cost.
//!
//! The cost is the surface area heuristic. Dynamic programming finds, for each binary subtree, the cheapest cover by
//! one to eight wide nodes or leaves (Ylitie, Karras and Laine 2017, "Efficient Incoherent Ray Traversal on GPUs
//! Through Compressed Wide BVHs", section 3.1). A packet test costs the same for any number of triangles, so that
//! leaves come out full.
//!
//! Subtrees are processed in parallel. Their choice depends on the BVH alone, so that the result is deterministic.

use super::wide::{LEAF_BIT, WideBvh, WideNode};
use crate::raytrace::simd::LANES;
use obvhs::bvh2::Bvh2;
use rayon::prelude::*;
use std::collections::{HashMap, VecDeque};
use std::sync::atomic::{AtomicU64, Ordering};

/// Cost of a packet test relative to a node test, measured.
const LEAF_COST: f32 = 1.2;

/// Number of subtrees that are processed in parallel: enough to keep all cores busy to the end.
const PARALLEL_SUBTREES: usize = 256;

/// The cheapest distribution of `i + 1` wide nodes over the children of a binary node: entry `i` is the number for the
/// left child; 0 where `i` nodes are as cheap. Entry 0 is 1 where the subtree becomes a leaf.
type Split = [u8; LANES];

/// The cheapest covers of a binary subtree.
#[derive(Clone, Copy, Debug)]
struct SubtreeCover {
    primitives: u32,
    /// `cost[i]`: SAH cost of a cover by at most `i + 1` wide nodes or leaves; the last entry covers the subtree by the
    /// children of one wide node.
    cost: [f32; LANES],
    split: Split,
}

impl SubtreeCover {
    const EMPTY: SubtreeCover = SubtreeCover { primitives: 0, cost: [0.0; LANES], split: [0; LANES] };

    fn leaf(area: f32, primitives: u32) -> Self {
        let mut split = [0; LANES];
        split[0] = 1;
        SubtreeCover { primitives, cost: [area * LEAF_COST; LANES], split }
    }

    /// Combines the covers of two children into those of their parent.
    fn parent(area: f32, left: &SubtreeCover, right: &SubtreeCover, max_leaf: u32) -> Self {
        let mut cover = SubtreeCover { primitives: left.primitives + right.primitives, ..SubtreeCover::EMPTY };
        // Find the cheapest distribution of `i + 1` nodes over both children. The right child's costs are padded with
        // infinity, so that one vector loop serves all `i`.
        let mut padded = [f32::INFINITY; 2 * LANES];
        padded[LANES..].copy_from_slice(&right.cost);
        let (mut distributed, mut left_nodes) = ([f32::INFINITY; LANES], [0_u32; LANES]);
        for k in 1..LANES {
            for i in 0..LANES {
                let cost = left.cost[k - 1] + padded[LANES - k + i];
                let better = cost < distributed[i];
                distributed[i] = if better { cost } else { distributed[i] };
                left_nodes[i] = if better { k as u32 } else { left_nodes[i] };
            }
        }
        // Cover the subtree by one node: an inner node or a leaf
        let last = LANES - 1;
        let inner = area + distributed[last];
        let leaf = if cover.primitives <= max_leaf { area * LEAF_COST } else { f32::INFINITY };
        cover.cost[0] = inner.min(leaf);
        cover.split[0] = u8::from(leaf <= inner);
        // Cover it by up to `i + 1` nodes
        for i in 1..last {
            let better = distributed[i] < cover.cost[i - 1];
            cover.cost[i] = if better { distributed[i] } else { cover.cost[i - 1] };
            cover.split[i] = if better { left_nodes[i] as u8 } else { 0 };
        }
        cover.cost[last] = distributed[last];
        cover.split[last] = left_nodes[last] as u8;
        cover
    }
}

/// Converts a binary BVH, with at most `max_leaf` primitives a leaf.
pub fn to_wide(binary: &Bvh2, max_leaf: u32) -> WideBvh {
    // Find the cheapest splits bottom up
    let splits = Splits::new(binary, max_leaf);
    // Write the upper nodes breadth first, until there are enough subtrees for all threads
    let mut top = WideBvhWriter::new(binary, &splits, 0);
    while let Some((subtree, node)) = top.queue.pop_front() {
        top.add_children(subtree, node);
        if top.queue.len() >= PARALLEL_SUBTREES {
            break;
        }
    }
    // Write the subtrees in parallel, depth first
    let write_subtree = |&(subtree, _): &(usize, u32)| {
        let mut writer = WideBvhWriter::new(binary, &splits, subtree);
        while let Some((subtree, node)) = writer.queue.pop_back() {
            writer.add_children(subtree, node);
        }
        writer.wide
    };
    let (mut wide, queue) = (top.wide, Vec::from(top.queue));
    let subtrees: Vec<WideBvh> = queue.par_iter().map(write_subtree).collect();
    // Append them in a fixed order
    for (subtree, (_, node)) in subtrees.iter().zip(queue) {
        wide.graft(node, subtree);
    }
    wide
}

/// The cheapest split of every binary subtree, packed into eight bytes.
struct Splits(Vec<AtomicU64>);

impl Splits {
    fn new(binary: &Bvh2, max_leaf: u32) -> Self {
        let splits = Splits((0..binary.nodes.len()).into_par_iter().map(|_| AtomicU64::new(0)).collect());
        let roots = disjoint_subtrees(binary);
        let covers: Vec<SubtreeCover> =
            roots.par_iter().map(|&root| splits.fill(binary, root, max_leaf, &HashMap::new())).collect();
        splits.fill(binary, 0, max_leaf, &roots.into_iter().zip(covers).collect());
        splits
    }

    fn get(&self, index: usize) -> Split {
        self.0[index].load(Ordering::Relaxed).to_le_bytes()
    }

    fn is_leaf(&self, index: usize) -> bool {
        self.get(index)[0] == 1
    }

    /// Computes the cheapest splits of a subtree bottom up. The subtrees in `known` are not descended into.
    fn fill(&self, binary: &Bvh2, root: usize, max_leaf: u32, known: &HashMap<usize, SubtreeCover>) -> SubtreeCover {
        let mut finished: Vec<SubtreeCover> = Vec::new();
        for index in preorder(binary, root, known).into_iter().rev() {
            let node = &binary.nodes[index];
            let area = node.aabb().half_area();
            let cover = if let Some(cover) = known.get(&index) {
                *cover
            } else if node.is_leaf() {
                SubtreeCover::leaf(area, node.prim_count)
            } else if let [.., left, right] = finished.as_slice() {
                // Both children are finished, the right one last.
                let cover = SubtreeCover::parent(area, left, right, max_leaf);
                finished.truncate(finished.len() - 2);
                cover
            } else {
                SubtreeCover::EMPTY
            };
            self.0[index].store(u64::from_le_bytes(cover.split), Ordering::Relaxed);
            finished.push(cover);
        }
        finished.pop().unwrap_or(SubtreeCover::EMPTY)
    }
}

/// Returns the roots of disjoint subtrees that together hold all leaves.
fn disjoint_subtrees(binary: &Bvh2) -> Vec<usize> {
    let (mut found, mut queue) = (Vec::new(), VecDeque::from([0]));
    while let Some(index) = queue.pop_front() {
        let node = &binary.nodes[index];
        if node.is_leaf() || found.len() + queue.len() >= PARALLEL_SUBTREES {
            found.push(index);
        } else {
            queue.extend([node.first_index as usize, node.first_index as usize + 1]);
        }
    }
    found
}

/// Returns the nodes of a subtree, parents before children and right children before left ones. Nodes below those in
/// `known` are left out.
fn preorder(binary: &Bvh2, root: usize, known: &HashMap<usize, SubtreeCover>) -> Vec<usize> {
    let mut order = Vec::new();
    let mut stack = vec![root];
    while let Some(index) = stack.pop() {
        order.push(index);
        let node = &binary.nodes[index];
        if !node.is_leaf() && !known.contains_key(&index) {
            stack.extend([node.first_index as usize, node.first_index as usize + 1]);
        }
    }
    order
}

/// Writes the nodes of a wide BVH.
struct WideBvhWriter<'a> {
    binary: &'a Bvh2,
    splits: &'a Splits,
    wide: WideBvh,
    /// Binary subtrees and their wide nodes, which have no children yet.
    queue: VecDeque<(usize, u32)>,
    /// Binary subtrees of a leaf that are not written yet.
    of_leaf: Vec<usize>,
}

impl<'a> WideBvhWriter<'a> {
    fn new(binary: &'a Bvh2, splits: &'a Splits, root: usize) -> Self {
        let wide = WideBvh { nodes: vec![WideNode::EMPTY], leaf_starts: vec![0], ..WideBvh::default() };
        WideBvhWriter { binary, splits, wide, queue: VecDeque::from([(root, 0)]), of_leaf: Vec::new() }
    }

    /// Adds the children of a wide node.
    fn add_children(&mut self, subtree: usize, node: u32) {
        let (mut children, mut count) = ([0; LANES], 0);
        if self.splits.is_leaf(subtree) {
            (children[0], count) = (subtree, 1);
        } else {
            self.collect_children(subtree, LANES, &mut children, &mut count);
        }
        for (slot, &child) in children[..count].iter().enumerate() {
            let reference = if self.splits.is_leaf(child) {
                self.push_leaf(child)
            } else {
                let new = self.wide.nodes.len() as u32;
                self.wide.nodes.push(WideNode::EMPTY);
                self.queue.push_back((child, new));
                new
            };
            let aabb = self.binary.nodes[child].aabb();
            self.wide.nodes[node as usize].set(slot, aabb.min.to_array().into(), aabb.max.to_array().into(), reference);
        }
    }

    /// Collects the roots of the binary subtrees that `nodes` wide nodes cover.
    fn collect_children(&self, index: usize, nodes: usize, children: &mut [usize; LANES], count: &mut usize) {
        let split = self.splits.get(index);
        let mut i = nodes - 1;
        while i > 0 && split[i] == 0 {
            i -= 1;
        }
        if i == 0 {
            children[*count] = index;
            *count += 1;
            return;
        }
        let (first, left) = (self.binary.nodes[index].first_index as usize, usize::from(split[i]));
        self.collect_children(first, left, children, count);
        self.collect_children(first + 1, i + 1 - left, children, count);
    }

    /// Adds all primitives of a subtree as one leaf and returns the reference to it.
    fn push_leaf(&mut self, root: usize) -> u32 {
        let wide = &mut self.wide;
        self.of_leaf.push(root);
        while let Some(index) = self.of_leaf.pop() {
            let node = &self.binary.nodes[index];
            let first = node.first_index as usize;
            if node.is_leaf() {
                wide.primitives.extend(&self.binary.primitive_indices[first..first + node.prim_count as usize]);
            } else {
                self.of_leaf.extend([first, first + 1]);
            }
        }
        wide.leaf_starts.push(wide.primitives.len() as u32);
        LEAF_BIT | (wide.leaf_starts.len() as u32 - 2)
    }
}

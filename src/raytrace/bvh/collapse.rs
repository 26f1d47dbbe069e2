//! From the binary tree to the eight-wide one that costs a ray least.
//!
//! By the surface area heuristic, with dynamic programming over the ways to cover each binary subtree by up to eight
//! wide nodes (Ylitie, Karras and Laine 2017, "Efficient Incoherent Ray Traversal on GPUs Through Compressed Wide BVHs",
//! section 3.1). A packet of triangles costs the same however few it holds, so leaves come out full.
//!
//! Subtrees are worked on side by side. Which they are depends on the tree alone, and so does what comes out.

use super::wide::{LEAF, Node, WideBvh};
use crate::raytrace::simd::WIDTH;
use obvhs::bvh2::Bvh2;
use rayon::prelude::*;
use std::collections::{HashMap, VecDeque};
use std::sync::atomic::{AtomicU64, Ordering};

/// Time of a packet test against a node test, measured.
const LEAF_COST: f32 = 1.2;

/// Subtrees that are worked on side by side: enough that all cores are busy to the end.
const SUBTREES: usize = 256;

/// With `i + 1` nodes, how many of them cover the left child; 0: no more than `i` are of use. Entry 0 is 1 where the
/// subtree becomes a leaf.
type Split = [u8; WIDTH];

/// How a binary subtree is covered at least cost.
#[derive(Clone, Copy, Debug)]
struct Cover {
    primitives: u32,
    /// `cost[i]`: by at most `i + 1` wide nodes or leaves; the last entry by the children of one wide node.
    cost: [f32; WIDTH],
    split: Split,
}

impl Cover {
    const NOTHING: Cover = Cover { primitives: 0, cost: [0.0; WIDTH], split: [0; WIDTH] };

    fn leaf(area: f32, primitives: u32) -> Self {
        let mut split = [0; WIDTH];
        split[0] = 1;
        Cover { primitives, cost: [area * LEAF_COST; WIDTH], split }
    }
}

/// Makes the tree, with at most `max_leaf` primitives a leaf.
pub fn to_wide(binary: &Bvh2, max_leaf: u32) -> WideBvh {
    let splits = Splits::new(binary, max_leaf);
    let mut top = Emitter::new(binary, &splits, 0);
    while let Some((subtree, node)) = top.open.pop_front() {
        top.add_children(subtree, node);
        if top.open.len() >= SUBTREES {
            break;
        }
    }
    let below = |&(subtree, _): &(usize, u32)| {
        let mut emitter = Emitter::new(binary, &splits, subtree);
        while let Some((subtree, node)) = emitter.open.pop_back() {
            emitter.add_children(subtree, node);
        }
        emitter.wide
    };
    let (mut wide, open) = (top.wide, Vec::from(top.open));
    let below: Vec<WideBvh> = open.par_iter().map(below).collect();
    for (below, (_, node)) in below.iter().zip(open) {
        wide.put_in_place_of(node, below);
    }
    wide
}

/// The best split of every binary subtree, packed into eight bytes.
struct Splits(Vec<AtomicU64>);

impl Splits {
    fn new(binary: &Bvh2, max_leaf: u32) -> Self {
        let splits = Splits((0..binary.nodes.len()).into_par_iter().map(|_| AtomicU64::new(0)).collect());
        let roots = subtrees(binary);
        let covers: Vec<Cover> =
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

    /// Finds the best splits in a subtree, from the leaves up, down to where they are known already.
    fn fill(&self, binary: &Bvh2, root: usize, max_leaf: u32, known: &HashMap<usize, Cover>) -> Cover {
        let mut finished: Vec<Cover> = Vec::new();
        for index in top_down(binary, root, known).into_iter().rev() {
            let node = &binary.nodes[index];
            let area = node.aabb().half_area();
            let cover = if let Some(cover) = known.get(&index) {
                *cover
            } else if node.is_leaf() {
                Cover::leaf(area, node.prim_count)
            } else {
                // Both children were finished before, the right one last.
                let [right, left] = [(); 2].map(|()| finished.pop().unwrap_or(Cover::NOTHING));
                cover(area, &left, &right, max_leaf)
            };
            self.0[index].store(u64::from_le_bytes(cover.split), Ordering::Relaxed);
            finished.push(cover);
        }
        finished.pop().unwrap_or(Cover::NOTHING)
    }
}

/// Disjoint subtrees that together hold all leaves.
fn subtrees(binary: &Bvh2) -> Vec<usize> {
    let (mut found, mut open) = (Vec::new(), VecDeque::from([0]));
    while let Some(index) = open.pop_front() {
        let node = &binary.nodes[index];
        if node.is_leaf() || found.len() + open.len() >= SUBTREES {
            found.push(index);
        } else {
            open.extend([node.first_index as usize, node.first_index as usize + 1]);
        }
    }
    found
}

fn cover(area: f32, left: &Cover, right: &Cover, max_leaf: u32) -> Cover {
    let mut cover = Cover { primitives: left.primitives + right.primitives, ..Cover::NOTHING };
    // The best way to share `i + 1` nodes between the two children, and the left one's nodes in it. The right one's costs
    // lie behind as many infinite ones, so that all `i` are asked at once.
    let mut padded = [f32::INFINITY; 2 * WIDTH];
    padded[WIDTH..].copy_from_slice(&right.cost);
    let (mut shared, mut ways) = ([f32::INFINITY; WIDTH], [0_u32; WIDTH]);
    for k in 1..WIDTH {
        for i in 0..WIDTH {
            let cost = left.cost[k - 1] + padded[WIDTH - k + i];
            let better = cost < shared[i];
            shared[i] = if better { cost } else { shared[i] };
            ways[i] = if better { k as u32 } else { ways[i] };
        }
    }
    let last = WIDTH - 1;
    let inner = area + shared[last];
    let leaf = if cover.primitives <= max_leaf { area * LEAF_COST } else { f32::INFINITY };
    cover.cost[0] = inner.min(leaf);
    cover.split[0] = u8::from(leaf <= inner);
    for i in 1..last {
        let better = shared[i] < cover.cost[i - 1];
        cover.cost[i] = if better { shared[i] } else { cover.cost[i - 1] };
        cover.split[i] = if better { ways[i] as u8 } else { 0 };
    }
    cover.cost[last] = shared[last];
    cover.split[last] = ways[last] as u8;
    cover
}

/// The nodes of a subtree, parents before their children and the right child's before the left one's, without those below
/// what is known.
fn top_down(binary: &Bvh2, root: usize, known: &HashMap<usize, Cover>) -> Vec<usize> {
    let mut order = Vec::new();
    let mut open = vec![root];
    while let Some(index) = open.pop() {
        order.push(index);
        let node = &binary.nodes[index];
        if !node.is_leaf() && !known.contains_key(&index) {
            open.extend([node.first_index as usize, node.first_index as usize + 1]);
        }
    }
    order
}

/// Writes a wide tree.
struct Emitter<'a> {
    binary: &'a Bvh2,
    splits: &'a Splits,
    wide: WideBvh,
    /// Binary subtrees whose wide nodes have no children yet.
    open: VecDeque<(usize, u32)>,
}

impl<'a> Emitter<'a> {
    fn new(binary: &'a Bvh2, splits: &'a Splits, root: usize) -> Self {
        let wide = WideBvh { nodes: vec![Node::EMPTY], leaf_starts: vec![0], ..WideBvh::default() };
        Emitter { binary, splits, wide, open: VecDeque::from([(root, 0)]) }
    }

    /// Gives a wide node its children.
    fn add_children(&mut self, subtree: usize, node: u32) {
        let (mut children, mut count) = ([0; WIDTH], 0);
        if self.splits.is_leaf(subtree) {
            (children[0], count) = (subtree, 1);
        } else {
            self.gather(subtree, WIDTH, &mut children, &mut count);
        }
        for (slot, &child) in children[..count].iter().enumerate() {
            let reference = if self.splits.is_leaf(child) {
                self.push_leaf(child)
            } else {
                let new = self.wide.nodes.len() as u32;
                self.wide.nodes.push(Node::EMPTY);
                self.open.push_back((child, new));
                new
            };
            let aabb = self.binary.nodes[child].aabb();
            self.wide.nodes[node as usize].set(slot, aabb.min.to_array().into(), aabb.max.to_array().into(), reference);
        }
    }

    /// Finds the binary nodes that `nodes` wide ones cover a subtree by.
    fn gather(&self, index: usize, nodes: usize, children: &mut [usize; WIDTH], count: &mut usize) {
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
        self.gather(first, left, children, count);
        self.gather(first + 1, i + 1 - left, children, count);
    }

    /// Adds all primitives of a subtree as a leaf and returns the reference to it.
    fn push_leaf(&mut self, root: usize) -> u32 {
        let wide = &mut self.wide;
        let mut open = vec![root];
        while let Some(index) = open.pop() {
            let node = &self.binary.nodes[index];
            let first = node.first_index as usize;
            if node.is_leaf() {
                wide.primitives.extend(&self.binary.primitive_indices[first..first + node.prim_count as usize]);
            } else {
                open.extend([first, first + 1]);
            }
        }
        wide.leaf_starts.push(wide.primitives.len() as u32);
        LEAF | (wide.leaf_starts.len() as u32 - 2)
    }
}

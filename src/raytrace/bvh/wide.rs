//! The tree in memory: nodes of eight boxes as structures of arrays, four cache lines each.

use super::traverse::Slabs;
use crate::raytrace::simd::WIDTH;
use glam::Vec3;

/// Marks a child that is a leaf; the rest of the bits is the leaf's number.
pub const LEAF: u32 = 1 << 31;

/// Eight child boxes. Unused slots have an inverted box, which no ray hits.
#[derive(Clone, Copy, Debug)]
#[repr(C, align(64))]
pub struct Node {
    /// `bounds[0]` lower and `bounds[1]` upper corners, by axis and child.
    pub bounds: [[[f32; WIDTH]; 3]; 2],
    /// Node index, or `LEAF | leaf index`.
    pub children: [u32; WIDTH],
}

impl Node {
    /// A node without children.
    pub const EMPTY: Node =
        Node { bounds: [[[f32::INFINITY; WIDTH]; 3], [[f32::NEG_INFINITY; WIDTH]; 3]], children: [LEAF; WIDTH] };

    /// Puts a child into a slot.
    pub fn set(&mut self, slot: usize, low: Vec3, high: Vec3, child: u32) {
        for axis in 0..3 {
            self.bounds[0][axis][slot] = low[axis];
            self.bounds[1][axis][slot] = high[axis];
        }
        self.children[slot] = child;
    }

    /// The sides of all boxes that a ray meets first and last along an axis.
    #[inline(always)]
    pub fn sides(&self, slabs: &Slabs, axis: usize) -> (&[f32; WIDTH], &[f32; WIDTH]) {
        let near = slabs.near[axis] & 1;
        (&self.bounds[near][axis], &self.bounds[near ^ 1][axis])
    }
}

/// An eight-wide tree. Node 0 is the root.
#[derive(Clone, Debug, Default)]
pub struct WideBvh {
    pub(super) nodes: Vec<Node>,
    /// Where each leaf's run in `primitives` starts, and one end mark.
    pub(super) leaf_starts: Vec<u32>,
    pub(super) primitives: Vec<u32>,
    /// Smallest box around everything; none when there is nothing.
    pub bounds: Option<(Vec3, Vec3)>,
}

impl WideBvh {
    /// Number of leaves.
    pub fn leaf_count(&self) -> usize {
        self.leaf_starts.len().saturating_sub(1)
    }

    /// Puts another tree in the place of a node without children.
    pub(super) fn put_in_place_of(&mut self, node: u32, tree: &WideBvh) {
        let (leaves, primitives) = (self.leaf_count() as u32, self.primitives.len() as u32);
        // Its root takes the node's place, so that its second node becomes the next here.
        let nodes = self.nodes.len() as u32 - 1;
        let moved = |mut node: Node| {
            for child in &mut node.children {
                *child += if *child & LEAF == 0 { nodes } else { leaves };
            }
            node
        };
        self.nodes.reserve(tree.nodes.len());
        let mut moved = tree.nodes.iter().map(|&node| moved(node));
        if let Some(root) = moved.next() {
            self.nodes[node as usize] = root;
        }
        self.nodes.extend(moved);
        self.leaf_starts.extend(tree.leaf_starts[1..].iter().map(|start| start + primitives));
        self.primitives.extend(&tree.primitives);
    }

    /// Primitive indices of a leaf.
    #[inline(always)]
    pub fn leaf(&self, leaf: u32) -> &[u32] {
        let i = leaf as usize;
        &self.primitives[self.leaf_starts[i] as usize..self.leaf_starts[i + 1] as usize]
    }
}

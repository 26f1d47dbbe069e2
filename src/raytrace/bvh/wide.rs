//! The memory layout of the BVH: nodes of eight child boxes in four cache lines, and leaves as runs of primitive
//! indices.

use crate::raytrace::simd::{BoxPacket, LANES};
use glam::Vec3;

/// Bit of a child reference that marks a leaf. The other bits are the index of the leaf or node.
pub(super) const LEAF_BIT: u32 = 1 << 31;

/// Eight children and their boxes.
#[derive(Clone, Copy, Debug)]
#[repr(C, align(64))]
pub(super) struct WideNode {
    /// Boxes of the children. Unused slots are empty boxes.
    pub boxes: BoxPacket,
    /// Node index, or `LEAF_BIT | leaf index`.
    pub children: [u32; LANES],
}

impl WideNode {
    /// A node without children.
    pub const EMPTY: WideNode = WideNode { boxes: BoxPacket::EMPTY, children: [LEAF_BIT; LANES] };

    /// Stores a child in a slot.
    pub fn set(&mut self, slot: usize, low: Vec3, high: Vec3, child: u32) {
        self.boxes.set(slot, low, high);
        self.children[slot] = child;
    }
}

/// A BVH with eight children a node. Node 0 is the root.
#[derive(Clone, Debug, Default)]
pub struct WideBvh {
    pub(super) nodes: Vec<WideNode>,
    /// Start of each leaf's run in `primitives`, and the end of the last one.
    pub(super) leaf_starts: Vec<u32>,
    pub(super) primitives: Vec<u32>,
    /// Bounding box of all primitives; none for an empty BVH.
    pub bounds: Option<(Vec3, Vec3)>,
}

impl WideBvh {
    /// Returns the number of leaves.
    pub fn leaf_count(&self) -> usize {
        self.leaf_starts.len().saturating_sub(1)
    }

    /// Replaces a node without children by another BVH.
    pub(super) fn graft(&mut self, node: u32, subtree: &WideBvh) {
        let (leaves, primitives) = (self.leaf_count() as u32, self.primitives.len() as u32);
        // The subtree's root replaces the node; its second node is appended first.
        let nodes = self.nodes.len() as u32 - 1;
        let renumbered = |mut node: WideNode| {
            for child in &mut node.children {
                *child += if *child & LEAF_BIT == 0 { nodes } else { leaves };
            }
            node
        };
        self.nodes.reserve(subtree.nodes.len());
        let mut renumbered = subtree.nodes.iter().map(|&node| renumbered(node));
        if let Some(root) = renumbered.next() {
            self.nodes[node as usize] = root;
        }
        self.nodes.extend(renumbered);
        self.leaf_starts.extend(subtree.leaf_starts[1..].iter().map(|start| start + primitives));
        self.primitives.extend(&subtree.primitives);
    }

    /// Returns the primitive indices of a leaf.
    #[inline(always)]
    pub fn leaf(&self, leaf: u32) -> &[u32] {
        let i = leaf as usize;
        &self.primitives[self.leaf_starts[i] as usize..self.leaf_starts[i + 1] as usize]
    }
}

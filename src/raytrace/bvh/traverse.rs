//! Walking a ray through the tree, nearest box first.

use super::wide::{LEAF, Node, WIDTH, WideBvh};
use crate::math::gamma;
use glam::Vec3;

/// What the box test wants of a ray: origin, inverse direction, and which side of each box is near.
///
/// A direction component of zero gives an infinite inverse; `0 * inf` is NaN, and [`max_or`] and [`min_or`] drop it,
/// so that a ray along a box's face is tested by the other axes alone.
#[derive(Clone, Copy, Debug)]
pub struct Slabs {
    origin: Vec3,
    inverse: Vec3,
    near: [usize; 3],
}

/// The far side is widened by this factor to cover the rounding of both products (Ize 2013).
const WIDEN: f32 = 1.0 + 2.0 * gamma(3);

/// `a` where it is larger than `b`; else `b`, also when `a` is NaN.
#[inline(always)]
fn max_or(a: f32, b: f32) -> f32 {
    if a > b { a } else { b }
}

/// `a` where it is smaller than `b`; else `b`, also when `a` is NaN.
#[inline(always)]
fn min_or(a: f32, b: f32) -> f32 {
    if a < b { a } else { b }
}

impl Slabs {
    /// Prepares a ray.
    #[inline(always)]
    pub fn new(origin: Vec3, direction: Vec3) -> Self {
        let inverse = direction.recip();
        let near = inverse.to_array().map(|x| usize::from(x.is_sign_negative()));
        Slabs { origin, inverse, near }
    }

    /// Entry distance into each child, and which children are entered before `t_max`.
    #[inline(always)]
    fn test(&self, node: &Node, t_max: f32) -> ([f32; WIDTH], u32) {
        let mut enter = [0.0_f32; WIDTH];
        let mut leave = [t_max; WIDTH];
        for axis in 0..3 {
            let near = &node.bounds[self.near[axis]][axis];
            let far = &node.bounds[1 - self.near[axis]][axis];
            let (origin, inverse) = (self.origin[axis], self.inverse[axis]);
            for i in 0..WIDTH {
                enter[i] = max_or((near[i] - origin) * inverse, enter[i]);
                leave[i] = min_or((far[i] - origin) * inverse * WIDEN, leave[i]);
            }
        }
        let mut mask = 0;
        for i in 0..WIDTH {
            mask |= u32::from(enter[i] <= leave[i]) << i;
        }
        (enter, mask)
    }
}

/// Open nodes of a traversal. Kept between rays so that the inner loop allocates nothing; nested traversals (a mesh
/// inside an instance) use the same one above a mark.
#[derive(Clone, Debug, Default)]
pub struct Stack {
    open: Vec<(u32, f32)>,
}

impl WideBvh {
    /// Visits the leaves that a ray meets before `t_max`, roughly from near to far. `visit` gets the leaf's number and
    /// the current end of the ray and returns the new one (smaller after a hit; negative stops the walk).
    #[inline(always)]
    pub fn traverse(
        &self,
        slabs: &Slabs,
        mut t_max: f32,
        stack: &mut Stack,
        mut visit: impl FnMut(u32, f32, &mut Stack) -> f32,
    ) {
        if self.nodes.is_empty() {
            return;
        }
        let mark = stack.open.len();
        let mut current = 0;
        loop {
            if current & LEAF != 0 {
                t_max = visit(current & !LEAF, t_max, stack);
                if t_max < 0.0 {
                    stack.open.truncate(mark);
                    return;
                }
            } else if let Some(nearest) = self.descend(current, slabs, t_max, stack) {
                current = nearest;
                continue;
            }
            current = loop {
                if stack.open.len() == mark {
                    return;
                }
                // The mark keeps this pop inside our own part of the stack.
                if let Some((child, enter)) = stack.open.pop()
                    && enter < t_max
                {
                    break child;
                }
            };
        }
    }

    /// Tests a node's children: the nearest one hit is returned, the others are pushed, farthest first.
    #[inline(always)]
    fn descend(&self, index: u32, slabs: &Slabs, t_max: f32, stack: &mut Stack) -> Option<u32> {
        let node = &self.nodes[index as usize];
        let (enter, mut mask) = slabs.test(node, t_max);
        if mask == 0 {
            return None;
        }
        let first = mask.trailing_zeros() as usize;
        mask &= mask - 1;
        if mask == 0 {
            return Some(node.children[first]);
        }
        let base = stack.open.len();
        stack.open.push((node.children[first], enter[first]));
        while mask != 0 {
            let slot = mask.trailing_zeros() as usize;
            mask &= mask - 1;
            // Insertion sort, farthest at the bottom: rarely more than three children are hit.
            let entry = (node.children[slot], enter[slot]);
            stack.open.push(entry);
            let mut i = stack.open.len() - 1;
            while i > base && stack.open[i - 1].1 < entry.1 {
                stack.open[i] = stack.open[i - 1];
                i -= 1;
            }
            stack.open[i] = entry;
        }
        stack.open.pop().map(|(child, _)| child)
    }
}

//! Traversal of the wide BVH: front to back for the closest hit, in any order for occlusion.

use super::wide::{LEAF_BIT, WideBvh, WideNode};
use crate::raytrace::simd::{Kernels, LANES, SlabRay};

/// The stack of nodes still to visit. It is kept between rays, so that the inner loop does not allocate. A nested
/// traversal (a BLAS inside the TLAS) uses the same stack above the entries of the outer one.
#[derive(Clone, Debug, Default)]
pub struct TraversalStack {
    /// Entry distance in the upper half (the bits of non-negative floats sort like their values), child reference in
    /// the lower half.
    entries: Vec<u64>,
    /// Entries in use.
    top: usize,
}

impl TraversalStack {
    /// Returns room above `top` for all children of a node.
    #[inline(always)]
    fn room(&mut self, top: usize) -> &mut [u64] {
        if self.entries.len() < top + LANES {
            self.grow(top);
        }
        &mut self.entries[top..top + LANES]
    }

    #[cold]
    fn grow(&mut self, top: usize) {
        self.entries.resize(2 * (top + LANES).max(128), 0);
    }
}

#[inline(always)]
fn stack_entry(enter: f32, child: u32) -> u64 {
    u64::from(enter.to_bits()) << 32 | u64::from(child)
}

#[inline(always)]
fn enter_distance(entry: u64) -> f32 {
    f32::from_bits((entry >> 32) as u32)
}

impl WideBvh {
    /// Visits the leaves whose boxes a ray enters before `t_max`, roughly front to back. `visit` takes the leaf index
    /// and the current `t_max`, and returns the new `t_max` (smaller after a hit).
    #[inline(always)]
    pub fn traverse_front_to_back<K: Kernels>(
        &self,
        ray: &SlabRay,
        mut t_max: f32,
        stack: &mut TraversalStack,
        mut visit: impl FnMut(u32, f32, &mut TraversalStack) -> f32,
    ) {
        if self.nodes.is_empty() {
            return;
        }
        let base = stack.top;
        let mut top = base;
        let mut current = 0;
        loop {
            let mut nearest_child = None;
            if current & LEAF_BIT == 0 {
                // Intersect the ray with the children's boxes and push those that it enters
                let node = &self.nodes[current as usize];
                let mut enter = [0.0; LANES];
                let mask = K::intersect_boxes(ray, &node.boxes, t_max, &mut enter);
                nearest_child = push_all_but_nearest(node, &enter, mask, stack.room(top), &mut top);
            } else {
                // Visit the leaf and shorten the ray
                stack.top = top;
                t_max = visit(current & !LEAF_BIT, t_max, stack);
            }
            // Continue with the nearest child, or pop the next entry that is closer than the last hit
            current = match nearest_child {
                Some(nearest) => nearest,
                None => loop {
                    if top == base {
                        stack.top = base;
                        return;
                    }
                    top -= 1;
                    let entry = stack.entries[top];
                    if enter_distance(entry) < t_max {
                        break entry as u32;
                    }
                },
            };
        }
    }

    /// Returns true as soon as `visit` does for a leaf whose box a ray enters before `t_max`, in no order.
    #[inline(always)]
    pub fn traverse_any<K: Kernels>(
        &self,
        ray: &SlabRay,
        t_max: f32,
        stack: &mut TraversalStack,
        mut visit: impl FnMut(u32, &mut TraversalStack) -> bool,
    ) -> bool {
        if self.nodes.is_empty() {
            return false;
        }
        let base = stack.top;
        let mut top = base;
        let mut current = 0;
        loop {
            if current & LEAF_BIT == 0 {
                // Push every child whose box the ray enters
                let node = &self.nodes[current as usize];
                let mut mask = K::intersect_boxes(ray, &node.boxes, t_max, &mut [0.0; LANES]);
                let room = stack.room(top);
                let mut count = 0;
                while mask != 0 {
                    room[count % LANES] = u64::from(node.children[mask.trailing_zeros() as usize % LANES]);
                    mask &= mask - 1;
                    count += 1;
                }
                top += count;
            } else {
                // Visit the leaf; the first hit ends the traversal
                stack.top = top;
                if visit(current & !LEAF_BIT, stack) {
                    stack.top = base;
                    return true;
                }
            }
            // Pop the next entry
            if top == base {
                stack.top = base;
                return false;
            }
            top -= 1;
            current = stack.entries[top] as u32;
        }
    }
}

/// Pushes the children of the mask, except the nearest, which is returned. They are not sorted: an entry beyond a later
/// hit costs one comparison when it is popped.
#[inline(always)]
fn push_all_but_nearest(
    node: &WideNode,
    enter: &[f32; LANES],
    mut mask: u32,
    room: &mut [u64],
    top: &mut usize,
) -> Option<u32> {
    if mask == 0 {
        return None;
    }
    let mut next = || {
        let slot = mask.trailing_zeros() as usize % LANES;
        mask &= mask - 1;
        (stack_entry(enter[slot], node.children[slot]), mask)
    };
    let (mut nearest, mut remaining) = next();
    let mut count = 0;
    while remaining != 0 {
        let (other, rest) = next();
        room[count % LANES] = nearest.max(other);
        nearest = nearest.min(other);
        count += 1;
        remaining = rest;
    }
    *top += count;
    Some(nearest as u32)
}

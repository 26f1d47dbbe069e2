//! Walking a ray through the tree.

use super::wide::{LEAF, Node, WideBvh};
use crate::math::gamma;
use crate::raytrace::simd::{Kernels, WIDTH};
use glam::Vec3;

/// What the box test wants of a ray: origin, inverse direction, and which side of each box is near.
///
/// A direction component of zero gives an infinite inverse; `0 * inf` is NaN, and the kernels drop it, so that a ray
/// along a box's face is tested by the other axes alone.
#[derive(Clone, Copy, Debug)]
pub struct Slabs {
    pub(in crate::raytrace) origin: [f32; 3],
    /// One over the direction, negated: kernels take the planes from the origin.
    pub(in crate::raytrace) minus_inverse: [f32; 3],
    /// 0 where the lower side is near, 1 where the upper is.
    pub(in crate::raytrace) near: [usize; 3],
}

/// Far sides are widened by this, to cover the rounding of both products (Ize 2013).
pub const WIDEN: f32 = 1.0 + 2.0 * gamma(3);

impl Slabs {
    /// Prepares a ray.
    #[inline(always)]
    pub fn new(origin: Vec3, direction: Vec3) -> Self {
        let inverse = direction.recip();
        let near = inverse.to_array().map(|x| usize::from(x.is_sign_negative()));
        Slabs { origin: origin.to_array(), minus_inverse: (-inverse).to_array(), near }
    }
}

/// Open nodes of a traversal. Kept between rays so that the inner loop allocates nothing; nested traversals (a mesh
/// inside an instance) use the same one above a mark.
#[derive(Clone, Debug, Default)]
pub struct TraversalStack {
    /// Entry distance in the upper half (as bits, which sort like the distance because it is not negative), child
    /// below.
    open: Vec<u64>,
    /// Entries in use.
    top: usize,
}

impl TraversalStack {
    /// Room for all children of a node above `top`.
    #[inline(always)]
    fn room(&mut self, top: usize) -> &mut [u64] {
        if self.open.len() < top + WIDTH {
            self.grow(top);
        }
        &mut self.open[top..top + WIDTH]
    }

    #[cold]
    fn grow(&mut self, top: usize) {
        self.open.resize(2 * (top + WIDTH).max(128), 0);
    }
}

#[inline(always)]
fn entry(enter: f32, child: u32) -> u64 {
    u64::from(enter.to_bits()) << 32 | u64::from(child)
}

#[inline(always)]
fn enter_of(entry: u64) -> f32 {
    f32::from_bits((entry >> 32) as u32)
}

impl WideBvh {
    /// Visits the leaves that a ray meets before `t_max`, roughly from near to far. `visit` gets the leaf's number and
    /// the current end of the ray and returns the new one (smaller after a hit).
    #[inline(always)]
    pub fn traverse_front_to_back<K: Kernels>(
        &self,
        slabs: &Slabs,
        mut t_max: f32,
        stack: &mut TraversalStack,
        mut visit: impl FnMut(u32, f32, &mut TraversalStack) -> f32,
    ) {
        if self.nodes.is_empty() {
            return;
        }
        let mark = stack.top;
        let mut top = mark;
        let mut current = 0;
        loop {
            let mut met = None;
            if current & LEAF == 0 {
                let node = &self.nodes[current as usize];
                let mut enter = [0.0; WIDTH];
                let mask = K::boxes(slabs, node, t_max, &mut enter);
                met = nearest_on_top(node, &enter, mask, stack.room(top), &mut top);
            } else {
                stack.top = top;
                t_max = visit(current & !LEAF, t_max, stack);
            }
            current = match met {
                Some(nearest) => nearest,
                None => loop {
                    if top == mark {
                        stack.top = mark;
                        return;
                    }
                    top -= 1;
                    let entry = stack.open[top];
                    if enter_of(entry) < t_max {
                        break entry as u32;
                    }
                },
            };
        }
    }

    /// Whether `visit` says yes for some leaf that a ray meets before `t_max`, in no order.
    #[inline(always)]
    pub fn traverse_any<K: Kernels>(
        &self,
        slabs: &Slabs,
        t_max: f32,
        stack: &mut TraversalStack,
        mut visit: impl FnMut(u32, &mut TraversalStack) -> bool,
    ) -> bool {
        if self.nodes.is_empty() {
            return false;
        }
        let mark = stack.top;
        let mut top = mark;
        let mut current = 0;
        loop {
            if current & LEAF == 0 {
                let node = &self.nodes[current as usize];
                let mut mask = K::boxes(slabs, node, t_max, &mut [0.0; WIDTH]);
                let room = stack.room(top);
                let mut count = 0;
                while mask != 0 {
                    room[count % WIDTH] = u64::from(node.children[mask.trailing_zeros() as usize % WIDTH]);
                    mask &= mask - 1;
                    count += 1;
                }
                top += count;
            } else {
                stack.top = top;
                if visit(current & !LEAF, stack) {
                    stack.top = mark;
                    return true;
                }
            }
            if top == mark {
                stack.top = mark;
                return false;
            }
            top -= 1;
            current = stack.open[top] as u32;
        }
    }
}

/// Puts the children of the mask on the stack, all but the nearest, which is returned. The others lie in no order:
/// those that a hit has overtaken by the time they are taken up cost one comparison.
#[inline(always)]
fn nearest_on_top(node: &Node, enter: &[f32; WIDTH], mut mask: u32, room: &mut [u64], top: &mut usize) -> Option<u32> {
    if mask == 0 {
        return None;
    }
    let mut next = || {
        let slot = mask.trailing_zeros() as usize % WIDTH;
        mask &= mask - 1;
        (entry(enter[slot], node.children[slot]), mask)
    };
    let (mut nearest, mut left) = next();
    let mut count = 0;
    while left != 0 {
        let (other, rest) = next();
        room[count % WIDTH] = nearest.max(other);
        nearest = nearest.min(other);
        count += 1;
        left = rest;
    }
    *top += count;
    Some(nearest as u32)
}

//! Walking a ray through the tree.

use super::wide::{LEAF, WideBvh};
use crate::math::gamma;
use crate::raytrace::simd::{Kernels, WIDTH};
use glam::Vec3;

/// What the box test wants of a ray: origin, inverse direction, and which side of each box is near.
///
/// A direction component of zero gives an infinite inverse; `0 * inf` is NaN, and the kernels drop it, so that a ray
/// along a box's face is tested by the other axes alone.
#[derive(Clone, Copy, Debug)]
pub struct Slabs {
    pub(in crate::raytrace) origin: Vec3,
    pub(in crate::raytrace) inverse: Vec3,
    /// `inverse`, widened for the far sides to cover the rounding of both products (Ize 2013).
    pub(in crate::raytrace) inverse_far: Vec3,
    /// 0 where the lower side is near, 1 where the upper is.
    pub(in crate::raytrace) near: [usize; 3],
}

const WIDEN: f32 = 1.0 + 2.0 * gamma(3);

impl Slabs {
    /// Prepares a ray.
    #[inline(always)]
    pub fn new(origin: Vec3, direction: Vec3) -> Self {
        let inverse = direction.recip();
        let near = inverse.to_array().map(|x| usize::from(x.is_sign_negative()));
        Slabs { origin, inverse, inverse_far: inverse * WIDEN, near }
    }
}

/// Open nodes of a traversal. Kept between rays so that the inner loop allocates nothing; nested traversals (a mesh
/// inside an instance) use the same one above a mark.
#[derive(Clone, Debug, Default)]
pub struct Stack {
    /// Entry distance in the upper half (as bits, which sort like the distance because it is not negative), child
    /// below.
    open: Vec<u64>,
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
    pub fn nearest_first<K: Kernels>(
        &self,
        slabs: &Slabs,
        mut t_max: f32,
        stack: &mut Stack,
        mut visit: impl FnMut(u32, f32, &mut Stack) -> f32,
    ) {
        let mark = stack.open.len();
        let mut current = self.root();
        loop {
            if current & LEAF == 0 {
                let node = &self.nodes[current as usize];
                let mut enter = [0.0; WIDTH];
                let mut mask = K::boxes(slabs, node, t_max, &mut enter);
                if mask != 0 {
                    let slot = mask.trailing_zeros() as usize % WIDTH;
                    mask &= mask - 1;
                    if mask == 0 {
                        current = node.children[slot];
                        continue;
                    }
                    let base = stack.open.len();
                    stack.open.push(entry(enter[slot], node.children[slot]));
                    while mask != 0 {
                        let slot = mask.trailing_zeros() as usize % WIDTH;
                        mask &= mask - 1;
                        insert(&mut stack.open, base, entry(enter[slot], node.children[slot]));
                    }
                }
            } else if current != NOTHING {
                t_max = visit(current & !LEAF, t_max, stack);
            }
            current = loop {
                if stack.open.len() <= mark {
                    return;
                }
                // The mark keeps this pop inside our own part of the stack.
                match stack.open.pop() {
                    Some(entry) if enter_of(entry) < t_max => break entry as u32,
                    _ => {}
                }
            };
        }
    }

    /// Whether `visit` says yes for some leaf that a ray meets before `t_max`, in no order.
    #[inline(always)]
    pub fn any<K: Kernels>(
        &self,
        slabs: &Slabs,
        t_max: f32,
        stack: &mut Stack,
        mut visit: impl FnMut(u32, &mut Stack) -> bool,
    ) -> bool {
        let mark = stack.open.len();
        let mut current = self.root();
        loop {
            if current & LEAF == 0 {
                let node = &self.nodes[current as usize];
                let mut mask = K::boxes(slabs, node, t_max, &mut [0.0; WIDTH]);
                if mask != 0 {
                    current = node.children[mask.trailing_zeros() as usize % WIDTH];
                    mask &= mask - 1;
                    while mask != 0 {
                        stack.open.push(u64::from(node.children[mask.trailing_zeros() as usize % WIDTH]));
                        mask &= mask - 1;
                    }
                    continue;
                }
            } else if current != NOTHING && visit(current & !LEAF, stack) {
                stack.open.truncate(mark);
                return true;
            }
            if stack.open.len() <= mark {
                return false;
            }
            let Some(entry) = stack.open.pop() else { return false };
            current = entry as u32;
        }
    }

    /// The root; [`NOTHING`] in an empty tree.
    #[inline(always)]
    fn root(&self) -> u32 {
        if self.nodes.is_empty() { NOTHING } else { 0 }
    }
}

/// A reference to no leaf.
const NOTHING: u32 = u32::MAX;

/// Adds an entry to the part of the stack from `base` on, which is sorted with the nearest on top: rarely more than
/// three.
#[inline(always)]
fn insert(open: &mut Vec<u64>, base: usize, entry: u64) {
    open.push(entry);
    let mut i = open.len() - 1;
    while i > base && open[i - 1] < entry {
        open[i] = open[i - 1];
        i -= 1;
    }
    open[i] = entry;
}

//! Building: PLOC with reinsertion (obvhs) gives a binary tree, [`super::collapse`] makes it eight wide.

use super::collapse;
use super::wide::WideBvh;
use glam::Vec3;
use obvhs::aabb::Aabb;
use obvhs::bvh2::reinsertion::ReinsertionOptimizer;
use obvhs::ploc::{PlocBuilder, PlocSearchDistance, SortPrecision};

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
    ReinsertionOptimizer::default().run(&mut binary, REINSERTION_RATIO, None);
    let mut wide = collapse::to_wide(&binary, max_leaf);
    wide.bounds = Some(bounds);
    wide
}

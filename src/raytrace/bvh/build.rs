//! Building: PLOC with reinsertion (obvhs) gives a binary tree, [`super::collapse`] makes it eight wide.

use super::collapse;
use super::wide::WideBvh;
use glam::Vec3;
use obvhs::aabb::Aabb;
use obvhs::bvh2::Bvh2;
use obvhs::bvh2::node::Bvh2Node;
use obvhs::bvh2::reinsertion::ReinsertionOptimizer;
use obvhs::ploc::{PlocBuilder, PlocSearchDistance, SortPrecision};
use rayon::prelude::*;
use std::collections::HashMap;

/// Share of the nodes that reinsertion tries; more buys little.
const REINSERTION_RATIO: f32 = 0.05;

/// Reinsertion searches the tree by surface area. Where a ray through the whole box would meet more nodes than this (some
/// hundred are usual), boxes overlap so much that the search goes through most of the tree for every node and takes
/// minutes: copies of one triangle, a fan of needles. No order of such boxes is much better than another.
const HOPELESS_NODES: f32 = 2000.0;

/// So many equal boxes among the others are put aside while the tree is built: the search for pairs makes one pair a round
/// of them, which takes minutes for a hundred thousand.
const MANY_COPIES: usize = 64;

/// Builds the tree over boxes, with at most `max_leaf` primitives a leaf. Deterministic. Boxes that are points or lines
/// are left out: what is in them has no area, and no ray meets it.
pub fn build(boxes: &[(Vec3, Vec3)], max_leaf: u32) -> WideBvh {
    let aabb = |b: &(Vec3, Vec3)| Aabb::new(b.0.to_array().into(), b.1.to_array().into());
    let has_area = |&i: &u32| aabb(&boxes[i as usize]).half_area() > 0.0;
    let primitives: Vec<u32> = (0..boxes.len() as u32).into_par_iter().filter(has_area).collect();
    let Some(&first) = primitives.first() else { return WideBvh::default() };
    let join = |(low, high): (Vec3, Vec3), &i: &u32| (low.min(boxes[i as usize].0), high.max(boxes[i as usize].1));
    let bounds = primitives.iter().fold(boxes[first as usize], join);
    let groups = has_many_copies(boxes, &primitives).then(|| group_copies(boxes, &primitives));
    let kept: Vec<u32> = groups.as_ref().map_or(primitives, |groups| groups.iter().map(|group| group[0]).collect());
    let aabbs: Vec<Aabb> = kept.par_iter().map(|&i| aabb(&boxes[i as usize])).collect();
    let indices = (0..kept.len() as u32).collect();
    let mut binary =
        PlocBuilder::with_capacity(aabbs.len()).build(PlocSearchDistance::Low, &aabbs, indices, SortPrecision::U64, 0);
    if nodes_met(&binary) < HOPELESS_NODES {
        ReinsertionOptimizer::default().run(&mut binary, REINSERTION_RATIO, None);
    }
    match groups {
        Some(groups) => put_copies_back(&mut binary, &groups),
        None => binary.primitive_indices.iter_mut().for_each(|index| *index = kept[*index as usize]),
    }
    let mut wide = collapse::to_wide(&binary, max_leaf);
    wide.bounds = Some(bounds);
    wide
}

fn bits(b: &(Vec3, Vec3)) -> [u32; 6] {
    // Adding zero makes -0 and 0 the same.
    let (low, high) =
        ((b.0 + Vec3::ZERO).to_array().map(f32::to_bits), (b.1 + Vec3::ZERO).to_array().map(f32::to_bits));
    [low[0], low[1], low[2], high[0], high[1], high[2]]
}

/// Whether some box occurs more than [`MANY_COPIES`] times (or, with luck against us, some hash of a box).
fn has_many_copies(boxes: &[(Vec3, Vec3)], primitives: &[u32]) -> bool {
    let slots = (4 * primitives.len()).next_power_of_two();
    let slot = |&i: &u32| {
        let mix = |h: u64, x: u32| (h.rotate_left(23) ^ u64::from(x)).wrapping_mul(0x9e37_79b9_7f4a_7c15);
        // The highest bits of a product depend on all of its factors' bits.
        (bits(&boxes[i as usize]).into_iter().fold(0, mix) >> 32) as u32 & (slots - 1) as u32
    };
    let hashes: Vec<u32> = primitives.par_iter().map(slot).collect();
    let mut times = vec![0_u8; slots];
    hashes.into_iter().any(|slot| {
        let count = &mut times[slot as usize];
        *count += 1;
        usize::from(*count) == MANY_COPIES
    })
}

/// Primitives with equal boxes, in the order of their first.
fn group_copies(boxes: &[(Vec3, Vec3)], primitives: &[u32]) -> Vec<Vec<u32>> {
    let mut known: HashMap<[u32; 6], usize> = HashMap::new();
    let mut groups: Vec<Vec<u32>> = Vec::new();
    for &i in primitives {
        let group = *known.entry(bits(&boxes[i as usize])).or_insert(groups.len());
        if group == groups.len() {
            groups.push(Vec::new());
        }
        groups[group].push(i);
    }
    groups
}

/// Makes each leaf, which names a group, a balanced tree over the group's primitives.
fn put_copies_back(binary: &mut Bvh2, groups: &[Vec<u32>]) {
    let names = std::mem::take(&mut binary.primitive_indices);
    for index in 0..binary.nodes.len() {
        let leaf = binary.nodes[index];
        if leaf.is_leaf() {
            let start = leaf.first_index as usize;
            let all: Vec<u32> = names[start..start + leaf.prim_count as usize]
                .iter()
                .flat_map(|&g| groups[g as usize].clone())
                .collect();
            grow(binary, index, &all);
        }
    }
    binary.parents.clear();
}

/// A balanced tree over primitives that fill the node's box alike.
fn grow(binary: &mut Bvh2, index: usize, primitives: &[u32]) {
    let aabb = *binary.nodes[index].aabb();
    if let [primitive] = *primitives {
        binary.nodes[index] = Bvh2Node::new(aabb, 1, binary.primitive_indices.len() as u32);
        binary.primitive_indices.push(primitive);
        return;
    }
    let first = binary.nodes.len();
    binary.nodes[index] = Bvh2Node::new(aabb, 0, first as u32);
    binary.nodes.extend([Bvh2Node::new(aabb, 1, 0); 2]);
    let (left, right) = primitives.split_at(primitives.len() / 2);
    grow(binary, first, left);
    grow(binary, first + 1, right);
}

/// Nodes that a random ray through the root's box meets on the mean (Goldsmith and Salmon 1987).
fn nodes_met(binary: &Bvh2) -> f32 {
    // By runs of one length, so that the sum has the same bits on any number of threads.
    let areas = |run: &[Bvh2Node]| run.iter().map(|node| f64::from(node.aabb().half_area())).sum::<f64>();
    let sum: f64 = binary.nodes.par_chunks(1 << 14).map(areas).collect::<Vec<f64>>().into_iter().sum();
    let root = f64::from(binary.nodes[0].aabb().half_area());
    if root > 0.0 { (sum / root) as f32 } else { binary.nodes.len() as f32 }
}

#[cfg(test)]
mod tests {
    use super::*;

    const MANY: usize = 100_000;

    /// Builds in at most so many times what as many boxes beside each other take: on a machine with other work to do, too.
    /// The needles take some seventy times as long, the copies as long; once it was minutes, which is thousands of times.
    const MOST_TIMES: u32 = 200;

    fn in_time(boxes: &[(Vec3, Vec3)]) -> WideBvh {
        let seconds = |boxes: &[(Vec3, Vec3)]| {
            let started = std::time::Instant::now();
            (build(boxes, 8), started.elapsed())
        };
        let beside = |i: usize| Vec3::new((i % 317) as f32, (i / 317) as f32, (i % 7) as f32);
        let (_, usual) = seconds(&(0..MANY).map(|i| (beside(i), beside(i) + 0.5)).collect::<Vec<_>>());
        let (tree, taken) = seconds(boxes);
        assert!(taken < MOST_TIMES * usual, "{taken:?}, and {usual:?} for boxes beside each other");
        let mut seen: Vec<u32> = (0..tree.leaf_count() as u32).flat_map(|leaf| tree.leaf(leaf).to_vec()).collect();
        seen.sort_unstable();
        seen.dedup();
        let whole = boxes.iter().filter(|(low, high)| low != high).count();
        assert_eq!(seen.len(), whole, "every box is in the tree once");
        tree
    }

    #[test]
    fn a_hundred_thousand_copies_of_a_triangle_are_built_at_once() {
        in_time(&vec![(Vec3::ZERO, Vec3::ONE); MANY]);
        // Some hidden among others, whose boxes are large beside them.
        let place =
            |i: usize| if i < MANY / 2 { Vec3::splat(0.1) } else { Vec3::new((i % 317) as f32, (i / 317) as f32, 0.0) };
        in_time(&(0..MANY).map(|i| (place(i), place(i) + 1e-3)).collect::<Vec<_>>());
    }

    #[test]
    fn a_fan_of_needles_is_built_at_once() {
        let needle = |i: usize| (Vec3::ZERO, Vec3::new((i as f32).cos().abs(), (i as f32).sin().abs(), 1e-3));
        in_time(&(0..MANY).map(needle).collect::<Vec<_>>());
    }

    #[test]
    fn points_and_lines_are_nothing_to_hit() {
        assert_eq!(in_time(&vec![(Vec3::ONE, Vec3::ONE); MANY]).leaf_count(), 0);
        assert!(build(&[(Vec3::ZERO, Vec3::X)], 8).bounds.is_none());
        assert_eq!(build(&[(Vec3::ZERO, Vec3::X), (Vec3::ONE, Vec3::ONE * 2.0)], 8).leaf(0), [1]);
    }
}

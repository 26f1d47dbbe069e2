//! Building the BVH: PLOC and reinsertion (obvhs) build a binary BVH, [`super::collapse`] converts it to eight children
//! a node.

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

/// Fraction of the nodes that reinsertion considers; larger ones improve the BVH little.
const REINSERTION_RATIO: f32 = 0.05;

/// Expected node visits of a random ray above which reinsertion is skipped (a few hundred are usual). Reinsertion
/// prunes its search by surface area: where boxes overlap this much (copies of one triangle, a fan of needles), it
/// visits most of the BVH for every node and takes minutes. No other order of such boxes is much better.
const MAX_VISITS_FOR_REINSERTION: f32 = 2000.0;

/// Number of equal boxes above which duplicates are grouped before the build. PLOC merges one pair of them a round,
/// which takes minutes for 100 000 copies.
const MANY_COPIES: usize = 64;

fn aabb((low, high): &(Vec3, Vec3)) -> Aabb {
    Aabb::new(low.to_array().into(), high.to_array().into())
}

/// How much work a build does for a faster traversal.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum BuildEffort {
    /// Clustering alone.
    Clustering,
    /// Clustering and reinsertion.
    Reinsertion,
}

/// Builds the BVH over boxes, with at most `max_leaf` primitives a leaf. Deterministic. Boxes that are points or lines
/// are left out: their primitives have no area, and no ray hits them.
pub fn build(boxes: &[(Vec3, Vec3)], max_leaf: u32, effort: BuildEffort) -> WideBvh {
    // Leave out degenerate boxes and compute the bounds of the others
    let has_area = |&i: &u32| aabb(&boxes[i as usize]).half_area() > 0.0;
    let primitives: Vec<u32> = (0..boxes.len() as u32).into_par_iter().filter(has_area).collect();
    let Some(&first) = primitives.first() else { return WideBvh::default() };
    let union = |(low, high): (Vec3, Vec3), &i: &u32| (low.min(boxes[i as usize].0), high.max(boxes[i as usize].1));
    let bounds = primitives.iter().fold(boxes[first as usize], union);
    // Keep one box of each group of equal boxes
    let groups = has_many_copies(boxes, &primitives).then(|| group_copies(boxes, &primitives));
    let kept: Vec<u32> = groups.as_ref().map_or(primitives, |groups| groups.iter().map(|group| group[0]).collect());
    // Build the binary BVH (Meister and Bittner 2018, "Parallel Locally-Ordered Clustering")
    let aabbs: Vec<Aabb> = kept.par_iter().map(|&i| aabb(&boxes[i as usize])).collect();
    let mut binary = locally_ordered_clustering(&aabbs);
    // Improve it by reinsertion (Meister and Bittner 2018, "Parallel Reinsertion for BVH Optimization")
    if effort == BuildEffort::Reinsertion && expected_visits(&binary) < MAX_VISITS_FOR_REINSERTION {
        ReinsertionOptimizer::default().run(&mut binary, REINSERTION_RATIO, None);
    }
    // Restore the primitive indices, copies included
    match groups {
        Some(groups) => restore_copies(&mut binary, &groups),
        None => binary.primitive_indices.par_iter_mut().for_each(|index| *index = kept[*index as usize]),
    }
    // Collapse it to eight children a node
    let mut wide = collapse::to_wide(&binary, max_leaf);
    wide.bounds = Some(bounds);
    wide
}

fn locally_ordered_clustering(aabbs: &[Aabb]) -> Bvh2 {
    let indices = (0..aabbs.len() as u32).collect();
    PlocBuilder::with_capacity(aabbs.len()).build(PlocSearchDistance::Low, aabbs, indices, SortPrecision::U64, 0)
}

fn bits(b: &(Vec3, Vec3)) -> [u32; 6] {
    // Adding zero makes -0 equal to 0.
    let (low, high) =
        ((b.0 + Vec3::ZERO).to_array().map(f32::to_bits), (b.1 + Vec3::ZERO).to_array().map(f32::to_bits));
    [low[0], low[1], low[2], high[0], high[1], high[2]]
}

/// Returns true if a box occurs [`MANY_COPIES`] times or more, and in the rare case that as many hashes collide.
fn has_many_copies(boxes: &[(Vec3, Vec3)], primitives: &[u32]) -> bool {
    let slots = (4 * primitives.len()).next_power_of_two();
    let slot = |&i: &u32| {
        let mix = |h: u64, x: u32| (h.rotate_left(23) ^ u64::from(x)).wrapping_mul(0x9e37_79b9_7f4a_7c15);
        // The highest bits of a product depend on all bits of its factors.
        (bits(&boxes[i as usize]).into_iter().fold(0, mix) >> 32) as u32 & (slots - 1) as u32
    };
    let hashes: Vec<u32> = primitives.par_iter().map(slot).collect();
    let mut counts = vec![0_u8; slots];
    hashes.into_iter().any(|slot| {
        let count = &mut counts[slot as usize];
        *count += 1;
        usize::from(*count) == MANY_COPIES
    })
}

/// Groups primitives with equal boxes, ordered by the first of each group.
fn group_copies(boxes: &[(Vec3, Vec3)], primitives: &[u32]) -> Vec<Vec<u32>> {
    let mut group_of_box: HashMap<[u32; 6], usize> = HashMap::new();
    let mut groups: Vec<Vec<u32>> = Vec::new();
    for &i in primitives {
        let group = *group_of_box.entry(bits(&boxes[i as usize])).or_insert(groups.len());
        if group == groups.len() {
            groups.push(Vec::new());
        }
        groups[group].push(i);
    }
    groups
}

/// Replaces each leaf, which references a group, by a balanced subtree over the primitives of the group.
fn restore_copies(binary: &mut Bvh2, groups: &[Vec<u32>]) {
    let group_indices = std::mem::take(&mut binary.primitive_indices);
    for index in 0..binary.nodes.len() {
        let leaf = binary.nodes[index];
        if leaf.is_leaf() {
            let start = leaf.first_index as usize;
            let all: Vec<u32> = group_indices[start..start + leaf.prim_count as usize]
                .iter()
                .flat_map(|&g| groups[g as usize].clone())
                .collect();
            add_balanced_subtree(binary, index, &all);
        }
    }
    binary.parents.clear();
}

/// Replaces a node by a balanced subtree over primitives that all have the node's box.
fn add_balanced_subtree(binary: &mut Bvh2, index: usize, primitives: &[u32]) {
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
    add_balanced_subtree(binary, first, left);
    add_balanced_subtree(binary, first + 1, right);
}

/// Returns the expected number of nodes that a random ray through the root's box visits (Goldsmith and Salmon 1987).
fn expected_visits(binary: &Bvh2) -> f32 {
    // Summed in chunks of one length, so that the sum has the same bits for any number of threads.
    let areas = |chunk: &[Bvh2Node]| chunk.iter().map(|node| f64::from(node.aabb().half_area())).sum::<f64>();
    let sum: f64 = binary.nodes.par_chunks(1 << 14).map(areas).collect::<Vec<f64>>().into_iter().sum();
    let root = f64::from(binary.nodes[0].aabb().half_area());
    if root > 0.0 { (sum / root) as f32 } else { binary.nodes.len() as f32 }
}

#[cfg(test)]
mod tests {
    use super::*;

    const MANY: usize = 100_000;
    const FEWER: usize = 30_000;

    fn built(boxes: &[(Vec3, Vec3)]) -> WideBvh {
        let bvh = build(boxes, 8, BuildEffort::Reinsertion);
        let mut seen: Vec<u32> = (0..bvh.leaf_count() as u32).flat_map(|leaf| bvh.leaf(leaf).to_vec()).collect();
        seen.sort_unstable();
        seen.dedup();
        let non_empty = boxes.iter().filter(|(low, high)| low != high).count();
        assert_eq!(seen.len(), non_empty, "every box is in the BVH once");
        bvh
    }

    fn disjoint(i: usize) -> (Vec3, Vec3) {
        let low = Vec3::new((i % 317) as f32, (i / 317) as f32, (i % 7) as f32);
        (low, low + 0.5)
    }

    /// Returns the number of boxes that are clustered.
    fn clustered(boxes: &[(Vec3, Vec3)]) -> usize {
        let primitives: Vec<u32> = (0..boxes.len() as u32).collect();
        if has_many_copies(boxes, &primitives) { group_copies(boxes, &primitives).len() } else { boxes.len() }
    }

    #[test]
    fn a_hundred_thousand_copies_of_a_triangle_are_clustered_as_one() {
        let copies = vec![(Vec3::ZERO, Vec3::ONE); MANY];
        assert_eq!(clustered(&copies), 1);
        built(&copies);
        // Copies among other boxes, which are large relative to them.
        let position =
            |i: usize| if i < MANY / 2 { Vec3::splat(0.1) } else { Vec3::new((i % 317) as f32, (i / 317) as f32, 0.0) };
        let mixed: Vec<_> = (0..MANY).map(|i| (position(i), position(i) + 1e-3)).collect();
        assert_eq!(clustered(&mixed), MANY / 2 + 1);
        built(&mixed);
    }

    #[test]
    fn reinsertion_is_skipped_for_a_fan_of_needles() {
        let visits = |boxes: &[(Vec3, Vec3)]| {
            expected_visits(&locally_ordered_clustering(&boxes.iter().map(aabb).collect::<Vec<_>>()))
        };
        let needle = |i: usize| (Vec3::ZERO, Vec3::new((i as f32).cos().abs(), (i as f32).sin().abs(), 1e-3));
        let needles: Vec<_> = (0..FEWER).map(needle).collect();
        let many = visits(&needles);
        assert!(many > 2.0 * MAX_VISITS_FOR_REINSERTION, "{many} for needles");
        built(&needles);
        let usual = visits(&(0..FEWER).map(disjoint).collect::<Vec<_>>());
        assert!(usual < 0.5 * MAX_VISITS_FOR_REINSERTION, "{usual} for disjoint boxes");
    }

    #[test]
    fn points_and_lines_are_left_out() {
        assert_eq!(built(&vec![(Vec3::ONE, Vec3::ONE); MANY]).leaf_count(), 0);
        assert!(build(&[(Vec3::ZERO, Vec3::X)], 8, BuildEffort::Reinsertion).bounds.is_none());
        assert_eq!(
            build(&[(Vec3::ZERO, Vec3::X), (Vec3::ONE, Vec3::ONE * 2.0)], 8, BuildEffort::Reinsertion).leaf(0),
            [1]
        );
    }
}

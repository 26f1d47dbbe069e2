//! Points to search for those nearest to a place.

use super::simd::{self, Avx2, LANES, SimdTask};
use glam::Vec3;

/// Points, eight to a block: X, Y and Z of each, infinitely far where there are fewer. For some hundreds of points.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct PointSet(Vec<[[f32; LANES]; 3]>);

impl PointSet {
    /// Collects points; their indices are their places in this order.
    pub fn new(points: impl IntoIterator<Item = Vec3>) -> PointSet {
        let mut blocks = Vec::new();
        for (index, point) in points.into_iter().enumerate() {
            if index % LANES == 0 {
                blocks.push([[f32::INFINITY; LANES]; 3]);
            }
            for axis in 0..3 {
                blocks[index / LANES][axis][index % LANES] = point[axis];
            }
        }
        PointSet(blocks)
    }

    /// Returns the `N` points nearest to a position: squared distances and indices, the nearest first, and of those
    /// that are equally near those of lower index. With fewer points the rest are infinitely far.
    pub fn nearest<const N: usize>(&self, position: Vec3) -> [(f32, usize); N] {
        simd::dispatch(Nearest::<N> { blocks: &self.0, position })
    }
}

/// A search for the `N` nearest points.
struct Nearest<'a, const N: usize> {
    blocks: &'a [[[f32; LANES]; 3]],
    position: Vec3,
}

impl<const N: usize> SimdTask for Nearest<'_, N> {
    type Output = [(f32, usize); N];

    #[inline(always)]
    fn run(self, _: Option<Avx2>) -> [(f32, usize); N] {
        let Vec3 { x: to_x, y: to_y, z: to_z } = self.position;
        let mut near = [(f32::INFINITY, 0); N];
        for (block, [x, y, z]) in self.blocks.iter().enumerate() {
            let mut distances = [0.0; LANES];
            let mut is_near = false;
            for i in 0..LANES {
                let [x, y, z] = [to_x - x[i], to_y - y[i], to_z - z[i]];
                distances[i] = x * x + y * y + z * z;
                is_near |= distances[i] < near[N - 1].0;
            }
            // Skip blocks without a point nearer than those found
            if !is_near {
                continue;
            }
            for (lane, &distance) in distances.iter().enumerate() {
                if distance < near[N - 1].0 {
                    near[N - 1] = (distance, block * LANES + lane);
                    near.sort_by(|a, b| a.0.total_cmp(&b.0));
                }
            }
        }
        near
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::math::sin_cos_turn;

    #[test]
    fn the_nearest_points_are_those_that_sorting_finds() {
        // Points on a curve that fills a box without repeating
        let place = |index: usize| {
            let along = |speed: f32| sin_cos_turn((index as f32 * speed).fract()).0;
            Vec3::new(along(0.618), along(0.414), along(0.732))
        };
        for count in [0, 2, 8, 419] {
            let points: Vec<Vec3> = (0..count).map(place).collect();
            let set = PointSet::new(points.iter().copied());
            for position in (1000..1050).map(place) {
                let mut all: Vec<(f32, usize)> = points.iter().map(|p| p.distance_squared(position)).zip(0..).collect();
                all.sort_by(|a, b| a.0.total_cmp(&b.0));
                all.resize(all.len().max(3), (f32::INFINITY, 0));
                assert_eq!(set.nearest::<3>(position), all[..3]);
                assert_eq!(set.nearest::<1>(position), all[..1]);
            }
        }
    }
}

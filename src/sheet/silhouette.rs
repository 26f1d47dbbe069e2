//! Outlines of meshes in parallel projection, for plans: the projected triangles fill cells of a grid, and the borders
//! of the filled cells are simplified.

use glam::{IVec2, Vec2};
use std::collections::BTreeMap;

/// Most cells along an edge of the grid: larger things have larger cells.
const MOST_CELLS: f32 = 1500.0;
/// Cells by which a simplified outline may differ from the border of the cells: more than the steps of a slanted
/// border.
const TOLERANCE: f32 = 0.8;

/// Cells that are filled or not.
struct Grid {
    low: Vec2,
    cell: f32,
    size: IVec2,
    filled: Vec<bool>,
}

/// Returns the outlines of triangles and points, holes included, with details of a cell's size.
pub fn outlines(triangles: &[[Vec2; 3]], points: &[Vec2], cell: f32) -> Vec<Vec<Vec2>> {
    let corners = || triangles.iter().flatten().chain(points).copied().filter(|corner| corner.is_finite());
    let Some(low) = corners().reduce(Vec2::min) else { return Vec::new() };
    let high = corners().fold(low, Vec2::max);
    let cell = cell.max((high - low).max_element() / MOST_CELLS);
    let mut grid = Grid::new(low - cell, high + cell, cell);
    triangles.iter().for_each(|triangle| grid.fill(triangle));
    points.iter().for_each(|point| grid.fill(&[*point; 3]));
    grid.borders().iter().map(|border| simplified(border, TOLERANCE * cell)).filter(|line| line.len() > 2).collect()
}

impl Grid {
    fn new(low: Vec2, high: Vec2, cell: f32) -> Self {
        let size = ((high - low) / cell).ceil().as_ivec2().max(IVec2::ONE);
        Grid { low, cell, size, filled: vec![false; (size.x * size.y) as usize] }
    }

    /// Fills the cells of each row of cells that a triangle crosses, from its left to its right within the row.
    fn fill(&mut self, triangle: &[Vec2; 3]) {
        let corners = triangle.map(|corner| (corner - self.low) / self.cell);
        if !corners.iter().all(|corner| corner.is_finite()) {
            return;
        }
        let edges = [(corners[0], corners[1]), (corners[1], corners[2]), (corners[2], corners[0])];
        let heights = corners.map(|corner| corner.y);
        let [top, bottom] = [f32::min, f32::max].map(|choose| heights.into_iter().fold(heights[0], choose));
        let last = (bottom.floor() as i32).min(self.size.y - 1);
        for y in (top.floor() as i32).max(0)..=last {
            // The part of each edge within the row
            let [above, below] = [y as f32, (y + 1) as f32];
            let (mut left, mut right) = (f32::INFINITY, f32::NEG_INFINITY);
            for (a, b) in edges.map(|(a, b)| if a.y <= b.y { (a, b) } else { (b, a) }) {
                if b.y < above || a.y > below {
                    continue;
                }
                let height = b.y - a.y;
                let at = |row: f32| a.lerp(b, ((row - a.y) / height).clamp(0.0, 1.0)).x;
                let ends = if height > 0.0 { [at(above), at(below)] } else { [a.x, b.x] };
                (left, right) = (left.min(ends[0]).min(ends[1]), right.max(ends[0]).max(ends[1]));
            }
            let [first, last] = [left.floor() as i32, right.floor() as i32];
            for x in first.max(0)..=last.min(self.size.x - 1) {
                self.filled[(y * self.size.x + x) as usize] = true;
            }
        }
    }

    fn is_filled(&self, x: i32, y: i32) -> bool {
        x >= 0 && y >= 0 && x < self.size.x && y < self.size.y && self.filled[(y * self.size.x + x) as usize]
    }

    /// Returns the closed borders of the filled cells, which lie to the right of each.
    fn borders(&self) -> Vec<Vec<Vec2>> {
        let mut next: BTreeMap<(i32, i32), Vec<(i32, i32)>> = BTreeMap::new();
        for y in 0..self.size.y {
            for x in (0..self.size.x).filter(|x| self.is_filled(*x, y)) {
                let sides = [
                    ((x, y - 1), (x, y), (x + 1, y)),
                    ((x + 1, y), (x + 1, y), (x + 1, y + 1)),
                    ((x, y + 1), (x + 1, y + 1), (x, y + 1)),
                    ((x - 1, y), (x, y + 1), (x, y)),
                ];
                for (neighbour, from, to) in sides {
                    if !self.is_filled(neighbour.0, neighbour.1) {
                        next.entry(from).or_default().push(to);
                    }
                }
            }
        }
        let mut borders = Vec::new();
        while let Some((start, _)) = next.first_key_value() {
            let start = *start;
            let (mut border, mut at) = (Vec::new(), start);
            while let Some(ways) = next.get_mut(&at) {
                let to = ways.pop();
                if ways.is_empty() {
                    next.remove(&at);
                }
                let Some(to) = to else { break };
                border.push(self.low + Vec2::new(at.0 as f32, at.1 as f32) * self.cell);
                at = to;
                if at == start {
                    break;
                }
            }
            borders.push(border);
        }
        borders
    }
}

fn distance_to_segment(a: Vec2, b: Vec2, point: Vec2) -> f32 {
    let along = ((point - a).dot(b - a) / (b - a).length_squared().max(f32::MIN_POSITIVE)).clamp(0.0, 1.0);
    (a + (b - a) * along - point).length()
}

/// Returns a closed outline with fewer points, none of which is farther from the result than `tolerance` (Douglas and
/// Peucker 1973).
fn simplified(outline: &[Vec2], tolerance: f32) -> Vec<Vec2> {
    let farthest = |from: Vec2| {
        let distances = outline.iter().map(|point| (*point - from).length_squared()).enumerate();
        distances.max_by(|a, b| a.1.total_cmp(&b.1)).map_or(0, |(index, _)| index)
    };
    let Some(first) = outline.first() else { return Vec::new() };
    let middle = farthest(*first);
    let mut kept = vec![false; outline.len()];
    (kept[0], kept[middle]) = (true, true);
    let mut open = vec![(0, middle), (middle, outline.len())];
    while let Some((from, to)) = open.pop() {
        let (a, b) = (outline[from], outline[to % outline.len()]);
        let between = (from + 1..to).map(|index| (index, distance_to_segment(a, b, outline[index])));
        if let Some((index, _)) = between.max_by(|a, b| a.1.total_cmp(&b.1)).filter(|(_, away)| *away > tolerance) {
            kept[index] = true;
            open.extend([(from, index), (index, to)]);
        }
    }
    outline.iter().zip(kept).filter(|(_, kept)| *kept).map(|(point, _)| *point).collect()
}

/// Returns the convex hull of points (Andrew's monotone chain).
pub fn convex_hull(mut points: Vec<Vec2>) -> Vec<Vec2> {
    points.retain(|point| point.is_finite());
    points.sort_by(|a, b| a.x.total_cmp(&b.x).then(a.y.total_cmp(&b.y)));
    let half = |points: &mut dyn Iterator<Item = &Vec2>| {
        let mut hull: Vec<Vec2> = Vec::new();
        for point in points {
            while let [.., a, b] = hull[..]
                && (b - a).perp_dot(*point - a) <= 0.0
            {
                hull.pop();
            }
            hull.push(*point);
        }
        hull.pop();
        hull
    };
    let mut hull = half(&mut points.iter());
    hull.extend(half(&mut points.iter().rev()));
    hull
}

#[cfg(test)]
mod tests {
    use super::*;

    fn area(outline: &[Vec2]) -> f32 {
        let next = outline.iter().cycle().skip(1);
        0.5 * outline.iter().zip(next).map(|(a, b)| a.perp_dot(*b)).sum::<f32>()
    }

    #[test]
    fn a_disc_has_the_outline_and_the_area_of_its_circle() {
        let rim = |i: u32| Vec2::from_angle(std::f32::consts::TAU * i as f32 / 64.0);
        let fan: Vec<[Vec2; 3]> = (0..64).map(|i| [Vec2::ZERO, rim(i), rim(i + 1)]).collect();
        let found = outlines(&fan, &[], 0.01);
        assert_eq!(found.len(), 1);
        assert!(found[0].len() < 200, "{}", found[0].len());
        assert!(found[0].iter().all(|point| (point.length() - 1.0).abs() < 0.03));
        assert!((area(&found[0]).abs() / std::f32::consts::PI - 1.0).abs() < 0.03);
    }

    #[test]
    fn a_frame_has_an_inner_outline_and_two_things_have_two() {
        let corners = [(-1.0, -1.0), (1.0, -1.0), (1.0, 1.0), (-1.0, 1.0)].map(|(x, y)| Vec2::new(x, y));
        let sides = (0..4).flat_map(|i| {
            let (a, b) = (corners[i], corners[(i + 1) % 4]);
            [[a, b, 0.5 * a], [b, 0.5 * b, 0.5 * a]]
        });
        let frame: Vec<[Vec2; 3]> = sides.collect();
        let areas: Vec<f32> = outlines(&frame, &[], 0.02).iter().map(|line| area(line)).collect();
        assert!(areas.len() == 2 && areas[0] * areas[1] < 0.0, "{areas:?}");
        let beside = [(3.0, 0.0), (3.2, 0.0), (3.0, 0.2)].map(|(x, y)| Vec2::new(x, y));
        assert_eq!(outlines(&[frame.as_slice(), &[beside]].concat(), &[], 0.02).len(), 3);
        assert!(outlines(&[], &[], 0.02).is_empty());
        assert!(outlines(&[[Vec2::NAN; 3]], &[], 0.02).is_empty());
    }

    #[test]
    fn a_hull_goes_round_its_points() {
        let points = [(0.0, 0.0), (2.0, 0.0), (1.0, 0.5), (2.0, 2.0), (0.0, 2.0), (1.0, 2.0)];
        let hull = convex_hull(points.map(|(x, y)| Vec2::new(x, y)).to_vec());
        assert_eq!((hull.len(), area(&hull)), (4, 4.0));
        assert!(convex_hull(Vec::new()).is_empty());
    }
}

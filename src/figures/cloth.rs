//! Drapes cloth over a body by position based dynamics (Müller et al. 2007, "Position Based Dynamics").
//!
//! A garment starts as it fits the posed body. Its rest lengths are those on the body in the rest pose, whose arms are
//! spread, with some ease: it folds where the pose shortens it and sags where it is loose. The fitted garment, some
//! millimetres over the skin, is what it collides with: a vertex stays outside the tangent plane of the nearest fitted
//! vertex. Cloth does not collide with itself. A few steps are enough: clothes move by centimetres.

use super::random::Random;
use super::subdivide::{Edges, SubdivisionSurface};
use glam::{Vec3, Vec3A};

/// Time steps, and iterations over all constraints in each.
const STEPS: usize = 20;
const ITERATIONS: usize = 8;
/// Distance that free cloth falls in the first step, metres.
const FALL_M: f32 = 0.001;
/// Part of its velocity that cloth keeps from step to step (damping).
const DAMPING: f32 = 0.9;
/// Rest lengths of cloth, as factors of those of the fitted garment in the rest pose.
const EASE: f32 = 1.04;
/// Stiffnesses, the parts of an error in length that an iteration corrects: along edges, along the diagonals of quads,
/// and between the ends of two edges in a line, which keeps folds wide.
const STRETCH: f32 = 1.0;
const SHEAR: f32 = 0.3;
const BEND: f32 = 0.05;
/// The same between the ends of two edges of a border: a hem is folded over and stitched.
const HEM: f32 = 0.5;
/// Rest length between the ends of two edges in a line, as a part of their sum.
const FLATNESS: f32 = 0.98;
/// Depth to which cloth may sink below the fitted garment, metres; it is still over the skin there.
const SINK_M: f32 = 0.004;
/// Part of a movement along the body that friction takes away in a step.
const FRICTION: f32 = 0.8;
/// Distance in the list between constraints that may share a vertex.
const APART: usize = 8;
/// Standard deviation of the noise on the start, metres: without it smooth cloth would not buckle.
const NOISE_M: f32 = 0.001;

/// A garment on a body.
#[derive(Clone, Copy, Debug)]
pub struct Cloth<'a> {
    /// The garment as it fits the posed body.
    pub fitted: &'a SubdivisionSurface,
    /// The positions of its vertices on the body at rest, metres.
    pub rest: &'a [Vec3],
    /// How freely each vertex moves: 0 where it is held, 1 where nothing holds it.
    pub mobility: &'a [f32],
    /// Height of the floor or the seat, metres: what the garment has above it does not fall below.
    pub support_m: f32,
}

/// A distance that two vertices keep.
#[derive(Clone, Copy, Debug)]
struct DistanceConstraint {
    ends: [u32; 2],
    rest_length_m: f32,
    /// Part of an error in length that each end corrects.
    shares: [f32; 2],
}

impl Cloth<'_> {
    /// Returns the positions of the vertices after the last step, metres.
    pub fn draped(&self) -> Vec<Vec3> {
        let SubdivisionSurface { mesh, edges } = self.fitted;
        let fitted: Vec<Vec3A> = mesh.positions.iter().map(|p| (*p).into()).collect();
        let normals: Vec<Vec3A> = mesh.normals().into_iter().map(Vec3A::from).collect();
        let neighbors = neighbors(edges, fitted.len());
        let constraints = self.constraints(edges, &neighbors);
        let mut random = Random::new(0, 0);
        let noisy = |((p, normal), m): ((&Vec3A, &Vec3A), &f32)| *p + *normal * (random.bell() * NOISE_M * m);
        let mut positions: Vec<Vec3A> = fitted.iter().zip(&normals).zip(self.mobility).map(noisy).collect();
        let mut before = positions.clone();
        // The fitted vertex nearest to each vertex
        let mut nearest: Vec<u32> = (0..fitted.len() as u32).collect();
        for _ in 0..STEPS {
            // Fall
            for ((position, before), mobility) in positions.iter_mut().zip(&mut before).zip(self.mobility) {
                let way = (*position - *before) * DAMPING + Vec3A::NEG_Y * FALL_M;
                *before = *position;
                *position += way * *mobility;
            }
            // Project the constraints
            for _ in 0..ITERATIONS {
                constraints.iter().for_each(|constraint| constraint.project(&mut positions));
            }
            // Collide with the body and the seat
            for (vertex, position) in positions.iter_mut().enumerate().filter(|(v, _)| self.mobility[*v] > 0.0) {
                position.y = position.y.max(self.support_m.min(fitted[vertex].y));
                let body = walk_to_nearest(&fitted, &neighbors, nearest[vertex], *position);
                nearest[vertex] = body;
                let (point, normal) = (fitted[body as usize], normals[body as usize]);
                let depth = (point - *position).dot(normal) - SINK_M;
                if depth > 0.0 {
                    *position += normal * depth;
                    let way = *position - before[vertex];
                    *position -= way.reject_from_normalized(normal) * FRICTION;
                }
            }
        }
        positions.into_iter().map(Vec3::from).collect()
    }

    /// Returns the constraints against stretch, shear and bending.
    fn constraints(&self, edges: &Edges, neighbors: &[Vec<u32>]) -> Vec<DistanceConstraint> {
        let rest = |a: u32, b: u32| self.rest[a as usize].distance(self.rest[b as usize]) * EASE;
        let mut constraints = Vec::new();
        let mut keep = |a: u32, b: u32, rest_length_m: f32, stiffness: f32| {
            // Two held vertices do not move
            let mobility = [a, b].map(|end| self.mobility[end as usize]);
            let sum = mobility[0] + mobility[1];
            if sum > 0.0 {
                let shares = mobility.map(|m| stiffness * m / sum);
                constraints.push(DistanceConstraint { ends: [a, b], rest_length_m, shares });
            }
        };
        for [a, b] in edges.edges.iter().map(|edge| edge.ends) {
            keep(a, b, rest(a, b), STRETCH);
        }
        for &[a, b, c, d] in &self.fitted.mesh.quads {
            keep(a, c, rest(a, c), SHEAR);
            keep(b, d, rest(b, d), SHEAR);
        }
        let straight = |vertex: u32, [a, b]: [u32; 2]| (rest(a, vertex) + rest(vertex, b)) * FLATNESS;
        for (vertex, ends) in lines(&self.fitted.mesh.quads, neighbors) {
            keep(ends[0], ends[1], straight(vertex, ends), BEND);
        }
        for (vertex, ends) in border_lines(edges, self.rest.len()) {
            keep(ends[0], ends[1], straight(vertex, ends), HEM);
        }
        interleaved(&constraints)
    }
}

impl DistanceConstraint {
    /// Moves the ends towards the rest length, each by its share of their mobility.
    fn project(&self, positions: &mut [Vec3A]) {
        let [a, b] = self.ends.map(|end| end as usize);
        let way = positions[b] - positions[a];
        let distance = way.length();
        if distance > 1e-9 {
            let excess = way * (1.0 - self.rest_length_m / distance);
            positions[a] += excess * self.shares[0];
            positions[b] -= excess * self.shares[1];
        }
    }
}

/// Returns items in an order in which those that were neighbours lie [`APART`] from each other. Constraints in a row then
/// have no vertex in common, so that the CPU overlaps their computation.
fn interleaved<T: Copy>(items: &[T]) -> Vec<T> {
    let rows = items.len().div_ceil(APART).max(1);
    (0..rows).flat_map(|row| items.iter().skip(row).step_by(rows).copied()).collect()
}

/// Returns the vertices at the other ends of each vertex's edges.
fn neighbors(edges: &Edges, count: usize) -> Vec<Vec<u32>> {
    let mut neighbors = vec![Vec::with_capacity(4); count];
    for [a, b] in edges.edges.iter().map(|edge| edge.ends) {
        neighbors[a as usize].push(b);
        neighbors[b as usize].push(a);
    }
    neighbors
}

/// Returns the vertices with four quads, twice, each time with two opposite neighbours: two that no quad has in common.
fn lines(quads: &[[u32; 4]], neighbors: &[Vec<u32>]) -> Vec<(u32, [u32; 2])> {
    // The pairs of each vertex's neighbours that have a quad in common
    let mut joined = vec![Vec::with_capacity(4); neighbors.len()];
    for quad in quads {
        for k in 0..4 {
            joined[quad[k] as usize].push([quad[(k + 1) % 4], quad[(k + 3) % 4]]);
        }
    }
    let mut lines = Vec::with_capacity(2 * neighbors.len());
    for (vertex, (around, joined)) in neighbors.iter().zip(&joined).enumerate() {
        if around.len() != 4 || joined.len() != 4 {
            continue;
        }
        for (k, &a) in around.iter().enumerate() {
            for &b in &around[k + 1..] {
                if !joined.contains(&[a, b]) && !joined.contains(&[b, a]) {
                    lines.push((vertex as u32, [a, b]));
                }
            }
        }
    }
    lines
}

/// Returns the vertices of borders, each with the two beside it.
fn border_lines(edges: &Edges, count: usize) -> Vec<(u32, [u32; 2])> {
    let mut beside = vec![Vec::with_capacity(2); count];
    for [a, b] in edges.edges.iter().filter(|edge| edge.is_border()).map(|edge| edge.ends) {
        beside[a as usize].push(b);
        beside[b as usize].push(a);
    }
    let line = |(vertex, ends): (usize, Vec<u32>)| Some((vertex as u32, <[u32; 2]>::try_from(ends).ok()?));
    beside.into_iter().enumerate().filter_map(line).collect()
}

/// Returns the vertex of a mesh that is nearest to a position, by a descent along edges from a start.
fn walk_to_nearest(mesh: &[Vec3A], neighbors: &[Vec<u32>], start: u32, position: Vec3A) -> u32 {
    let with_distance = |vertex: u32| (mesh[vertex as usize].distance_squared(position), vertex);
    let mut nearest = with_distance(start);
    loop {
        let around = neighbors[nearest.1 as usize].iter().map(|&vertex| with_distance(vertex));
        let next = around.fold(nearest, |nearest, next| if next.0 < nearest.0 { next } else { nearest });
        if next.1 == nearest.1 {
            return nearest.1;
        }
        nearest = next;
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::figures::subdivide::QuadMesh;
    use glam::Vec2;

    /// Squares along each edge of a sheet, and its width, metres.
    const SQUARES: u32 = 10;
    const WIDTH_M: f32 = 0.3;

    /// A level sheet whose outside is above, or below, held at two of its edges.
    fn sheet(is_upright: bool) -> (SubdivisionSurface, Vec<f32>) {
        let side = SQUARES + 1;
        let at = |v: u32| Vec2::new((v % side) as f32, (v / side) as f32) / SQUARES as f32;
        let corners = |v: u32| [v, v + side, v + side + 1, v + 1];
        let quads = (0..side * side).filter(|v| v % side < SQUARES && v / side < SQUARES).map(corners);
        let turned = |[a, b, c, d]: [u32; 4]| if is_upright { [a, b, c, d] } else { [d, c, b, a] };
        let mesh = QuadMesh {
            positions: (0..side * side).map(|v| Vec3::new(at(v).x, 0.0, at(v).y) * WIDTH_M).collect(),
            quads: quads.map(turned).collect(),
            ..QuadMesh::default()
        };
        let mobility = (0..side * side).map(|v| f32::from(at(v).x > 0.0 && at(v).x < 1.0)).collect();
        (SubdivisionSurface::new(mesh), mobility)
    }

    /// A sheet of a length (1 + e) L between two bars at a distance L hangs in a shallow arc of the depth L sqrt(3 e / 8).
    #[test]
    fn a_sheet_between_bars_hangs_as_deep_as_its_ease_allows() {
        let (sheet, mobility) = sheet(false);
        let draped =
            Cloth { fitted: &sheet, rest: &sheet.mesh.positions, mobility: &mobility, support_m: -1.0 }.draped();
        // The edges across the bars stretch by less than 4 % under their weight
        let (middle, squares) = (draped.len() / 2, SQUARES as usize);
        let line = &draped[middle - squares / 2..=middle + squares / 2];
        let length = line.windows(2).map(|pair| pair[0].distance(pair[1])).sum::<f32>();
        let stretch = length / (WIDTH_M * EASE);
        assert!((1.0..1.04).contains(&stretch), "{stretch}");
        let expected = WIDTH_M * (3.0 * (length / WIDTH_M - 1.0) / 8.0).sqrt();
        let depth = -draped[middle].y;
        assert!((depth / expected - 1.0).abs() < 0.05, "{depth} m, expected {expected} m");
    }

    #[test]
    fn cloth_that_lies_on_a_body_stays_on_it() {
        let (sheet, mobility) = sheet(true);
        let draped =
            Cloth { fitted: &sheet, rest: &sheet.mesh.positions, mobility: &mobility, support_m: -1.0 }.draped();
        assert!(draped.iter().all(|p| p.y > -SINK_M - 1e-4), "{draped:?}");
        let held = draped.iter().zip(&sheet.mesh.positions).zip(&mobility).filter(|(_, m)| **m == 0.0);
        assert!(held.into_iter().all(|((p, start), _)| p == start));
    }

    #[test]
    fn a_line_through_a_vertex_joins_the_ends_of_two_edges() {
        let (SubdivisionSurface { mesh, edges }, _) = sheet(true);
        let lines = lines(&mesh.quads, &neighbors(&edges, mesh.positions.len()));
        assert_eq!(lines.len() as u32, 2 * (SQUARES - 1) * (SQUARES - 1), "two at each inner vertex");
        for (vertex, [a, b]) in lines {
            let [v, a, b] = [vertex, a, b].map(|v| mesh.positions[v as usize]);
            assert!(((a + b) / 2.0).distance(v) < 1e-6, "{a} {v} {b}");
        }
    }
}

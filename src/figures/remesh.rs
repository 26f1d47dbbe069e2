//! Isotropic remeshing (Botsch and Kobbelt 2004): splits long edges, collapses short ones, flips edges towards six
//! neighbours a vertex, relaxes vertices along the surface and projects them back onto it.
//!
//! All passes visit edges in index order, so the result is deterministic. No operation changes the topology: a closed
//! surface stays closed.

use super::culled_field::CulledField;
use crate::scene::Mesh;
use glam::Vec3;
use rayon::prelude::*;

/// Index of a removed vertex.
const GONE: u32 = u32::MAX;

/// A closed surface with its adjacency.
struct EditableMesh {
    positions: Vec<Vec3>,
    /// Triangles; `GONE` marks removed ones.
    triangles: Vec<[u32; 3]>,
    /// Triangles around each vertex; empty for a removed vertex.
    around: Vec<Vec<u32>>,
}

/// Remeshes a closed mesh to edges of about `target` metres, with its vertices on the surface of the field.
pub fn remesh(mesh: Mesh, field: &CulledField, target: impl Fn(Vec3) -> f32) -> Mesh {
    let mut net = EditableMesh::new(mesh);
    for round in 0..6 {
        net.split_long(&target);
        net.collapse_short(&target);
        net.flip_for_valence();
        let steps = if round == 5 { 3 } else { 1 };
        net.relax(field, steps);
    }
    net.into_mesh()
}

impl EditableMesh {
    fn new(mesh: Mesh) -> EditableMesh {
        let mut around = vec![Vec::with_capacity(8); mesh.positions.len()];
        for (i, t) in mesh.triangles.iter().enumerate() {
            t.iter().for_each(|&v| around[v as usize].push(i as u32));
        }
        EditableMesh { positions: mesh.positions, triangles: mesh.triangles, around }
    }

    /// Returns every edge once, smaller index first.
    fn edges(&self) -> Vec<(u32, u32)> {
        let mut edges = Vec::with_capacity(self.triangles.len() * 3 / 2);
        for t in self.triangles.iter().filter(|t| t[0] != GONE) {
            edges.extend((0..3).map(|k| (t[k], t[(k + 1) % 3])).filter(|(a, b)| a < b));
        }
        edges
    }

    fn length(&self, a: u32, b: u32) -> f32 {
        (self.positions[a as usize] - self.positions[b as usize]).length()
    }

    /// Returns the length of an edge relative to the target length there.
    fn excess(&self, a: u32, b: u32, target: &impl Fn(Vec3) -> f32) -> f32 {
        self.length(a, b) / target((self.positions[a as usize] + self.positions[b as usize]) * 0.5)
    }

    /// Returns the two triangles at an edge; `None` if there is no such edge any more.
    fn at_edge(&self, a: u32, b: u32) -> Option<[u32; 2]> {
        let mut found = self.around[a as usize].iter().copied().filter(|&t| self.triangles[t as usize].contains(&b));
        match (found.next(), found.next(), found.next()) {
            (Some(first), Some(second), None) => Some([first, second]),
            _ => None,
        }
    }

    /// Returns the corner of a triangle that is neither `a` nor `b`.
    fn opposite(&self, triangle: u32, a: u32, b: u32) -> u32 {
        let t = self.triangles[triangle as usize];
        t.into_iter().find(|&v| v != a && v != b).unwrap_or(GONE)
    }

    fn neighbours(&self, v: u32) -> Vec<u32> {
        let mut ring: Vec<u32> = self.around[v as usize]
            .iter()
            .flat_map(|&t| self.triangles[t as usize])
            .filter(|&other| other != v)
            .collect();
        ring.sort_unstable();
        ring.dedup();
        ring
    }

    /// Returns twice the area vector of a triangle.
    fn cross(&self, t: [u32; 3]) -> Vec3 {
        let [a, b, c] = t.map(|i| self.positions[i as usize]);
        (b - a).cross(c - a)
    }

    fn split_long(&mut self, target: &impl Fn(Vec3) -> f32) {
        for (a, b) in self.edges() {
            if self.excess(a, b, target) < 1.4 {
                continue;
            }
            let Some(sides) = self.at_edge(a, b) else { continue };
            let middle = self.positions.len() as u32;
            self.positions.push((self.positions[a as usize] + self.positions[b as usize]) * 0.5);
            self.around.push(Vec::with_capacity(8));
            for side in sides {
                // The old triangle keeps `a`; the new one takes `b`.
                let old = self.triangles[side as usize];
                let new = self.triangles.len() as u32;
                self.triangles.push(old.map(|v| if v == a { middle } else { v }));
                self.triangles[side as usize] = old.map(|v| if v == b { middle } else { v });
                let far = self.opposite(side, a, middle);
                self.around[b as usize].retain(|&t| t != side);
                self.around[b as usize].push(new);
                self.around[far as usize].push(new);
                self.around[middle as usize].extend([side, new]);
            }
        }
    }

    fn collapse_short(&mut self, target: &impl Fn(Vec3) -> f32) {
        for (a, b) in self.edges() {
            if self.excess(a, b, target) < 0.75 {
                self.collapse(a, b, target);
            }
        }
    }

    /// Merges `b` into `a` if the surface stays manifold and no triangle flips its normal.
    fn collapse(&mut self, a: u32, b: u32, target: &impl Fn(Vec3) -> f32) {
        let Some(sides) = self.at_edge(a, b) else { return };
        let (ring_a, ring_b) = (self.neighbours(a), self.neighbours(b));
        // Link condition: exactly the two corners across the edge are shared.
        if ring_a.iter().filter(|v| ring_b.binary_search(v).is_ok()).count() != 2 {
            return;
        }
        let corners = sides.map(|t| self.opposite(t, a, b));
        if corners.iter().any(|&c| self.around[c as usize].len() < 5) {
            return;
        }
        let middle = (self.positions[a as usize] + self.positions[b as usize]) * 0.5;
        let limit = 1.4 * target(middle);
        let rim = ring_a.iter().chain(&ring_b).filter(|&&v| v != a && v != b);
        if rim.clone().any(|&v| (self.positions[v as usize] - middle).length() > limit) {
            return;
        }
        for &t in self.around[a as usize].iter().chain(&self.around[b as usize]).filter(|t| !sides.contains(t)) {
            let before = self.cross(self.triangles[t as usize]);
            let p =
                self.triangles[t as usize].map(|v| if v == a || v == b { middle } else { self.positions[v as usize] });
            let after = (p[1] - p[0]).cross(p[2] - p[0]);
            if after.dot(before) <= 0.5 * after.length() * before.length() {
                return;
            }
        }
        self.positions[a as usize] = middle;
        for side in sides {
            for v in self.triangles[side as usize] {
                self.around[v as usize].retain(|&t| t != side);
            }
            self.triangles[side as usize] = [GONE; 3];
        }
        for t in std::mem::take(&mut self.around[b as usize]) {
            let triangle = &mut self.triangles[t as usize];
            *triangle = triangle.map(|v| if v == b { a } else { v });
            self.around[a as usize].push(t);
        }
    }

    fn flip_for_valence(&mut self) {
        for (a, b) in self.edges() {
            let Some([left, right]) = self.at_edge(a, b) else { continue };
            let (c, d) = (self.opposite(left, a, b), self.opposite(right, a, b));
            let off = |v: u32, change: i32| (self.around[v as usize].len() as i32 + change - 6).pow(2);
            let before = off(a, 0) + off(b, 0) + off(c, 0) + off(d, 0);
            let after = off(a, -1) + off(b, -1) + off(c, 1) + off(d, 1);
            if after < before && self.around[a as usize].len() > 3 && self.around[b as usize].len() > 3 {
                self.flip([a, b], [c, d], [left, right]);
            }
        }
    }

    /// Flips the edge `a b` to `c d` if the four corners are nearly planar and convex.
    fn flip(&mut self, [a, b]: [u32; 2], [c, d]: [u32; 2], [left, right]: [u32; 2]) {
        if self.at_edge(c, d).is_some() || self.around[c as usize].iter().any(|t| self.around[d as usize].contains(t)) {
            return;
        }
        let (old_left, old_right) = (self.triangles[left as usize], self.triangles[right as usize]);
        let new_left = old_left.map(|v| if v == b { d } else { v });
        let new_right = old_right.map(|v| if v == a { c } else { v });
        let facing = self.cross(old_left).normalize_or_zero() + self.cross(old_right).normalize_or_zero();
        for t in [new_left, new_right] {
            let n = self.cross(t);
            let longest = (0..3).map(|k| self.length(t[k], t[(k + 1) % 3])).fold(0.0, f32::max);
            // Reject a flipped normal or a sliver.
            if n.dot(facing) < 1.4 * n.length() || n.length() < 0.15 * longest * longest {
                return;
            }
        }
        self.triangles[left as usize] = new_left;
        self.triangles[right as usize] = new_right;
        self.around[b as usize].retain(|&t| t != left);
        self.around[a as usize].retain(|&t| t != right);
        self.around[d as usize].push(left);
        self.around[c as usize].push(right);
    }

    /// Moves each vertex along the surface towards the centroid of its neighbours, then projects it onto the surface.
    fn relax(&mut self, field: &CulledField, newton_steps: u32) {
        let moved = (0..self.positions.len()).into_par_iter().map(|i| {
            let p = self.positions[i];
            if self.around[i].is_empty() {
                return p;
            }
            let ring = self.neighbours(i as u32);
            let middle = ring.iter().map(|&v| self.positions[v as usize]).sum::<Vec3>() / ring.len() as f32;
            let normal = self.around[i].iter().map(|&t| self.cross(self.triangles[t as usize])).sum::<Vec3>();
            let normal = normal.normalize_or_zero();
            let slide = middle - p;
            field.project(p + 0.6 * (slide - normal * slide.dot(normal)), newton_steps)
        });
        self.positions = moved.collect();
    }

    fn into_mesh(self) -> Mesh {
        let mut renumbered = vec![GONE; self.positions.len()];
        let mut mesh = Mesh::default();
        for t in self.triangles.iter().filter(|t| t[0] != GONE) {
            mesh.triangles.push(t.map(|v| {
                let new = &mut renumbered[v as usize];
                if *new == GONE {
                    *new = mesh.positions.len() as u32;
                    mesh.positions.push(self.positions[v as usize]);
                }
                *new
            }));
        }
        mesh
    }
}

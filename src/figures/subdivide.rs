//! Catmull-Clark subdivision of quad meshes (Catmull and Clark 1978), with smooth curves along open borders.

use glam::{Vec2, Vec3};
use rayon::prelude::*;
use std::collections::BTreeMap;

/// A mesh of quads with texture coordinates and a part for each quad.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct QuadMesh {
    /// Vertices.
    pub positions: Vec<Vec3>,
    /// Corners, counter-clockwise from outside.
    pub quads: Vec<[u32; 4]>,
    /// Texture coordinates of the corners.
    pub uvs: Vec<[Vec2; 4]>,
    /// Part of each quad, an index into the caller's list.
    pub parts: Vec<u8>,
    /// A value of each vertex, which is split and not smoothed; empty if there is none.
    pub values: Vec<Vec3>,
}

/// An edge with the quads beside it.
#[derive(Clone, Copy, Debug)]
pub struct Edge {
    /// Vertices.
    pub ends: [u32; 2],
    quads: [u32; 2],
}

/// No quad: the edge is a border.
const NONE: u32 = u32::MAX;

impl Edge {
    /// Returns true for an edge of one quad.
    pub fn is_border(&self) -> bool {
        self.quads[1] == NONE
    }
}

impl QuadMesh {
    /// Appends another mesh.
    pub fn append(&mut self, other: &QuadMesh) {
        let first = self.positions.len() as u32;
        self.positions.extend(&other.positions);
        self.quads.extend(other.quads.iter().map(|quad| quad.map(|v| v + first)));
        self.uvs.extend(&other.uvs);
        self.parts.extend(&other.parts);
        self.values.extend(&other.values);
    }

    /// Returns the area-weighted unit normal at each vertex.
    pub fn normals(&self) -> Vec<Vec3> {
        let mut normals = vec![Vec3::ZERO; self.positions.len()];
        for quad in &self.quads {
            let [a, b, c, d] = quad.map(|v| self.positions[v as usize]);
            let normal = (c - a).cross(d - b);
            for &vertex in quad {
                normals[vertex as usize] += normal;
            }
        }
        normals.into_par_iter().map(|n| n.normalize_or(Vec3::Y)).collect()
    }
}

/// A mesh with its edges: those of a subdivided mesh follow from those of the mesh, without a search.
#[derive(Clone, Debug)]
pub struct SubdivisionSurface {
    /// The mesh.
    pub mesh: QuadMesh,
    /// Its edges.
    pub edges: Edges,
}

impl SubdivisionSurface {
    /// Finds the edges of a mesh.
    pub fn new(mesh: QuadMesh) -> SubdivisionSurface {
        let edges = Edges::new(&mesh);
        SubdivisionSurface { mesh, edges }
    }

    /// Appends another surface.
    pub fn append(&mut self, other: &SubdivisionSurface) {
        self.edges.append(&other.edges, self.mesh.positions.len() as u32);
        self.mesh.append(&other.mesh);
    }

    /// Returns the surface with every quad split into four, smoothed.
    pub fn subdivided(&self) -> SubdivisionSurface {
        let SubdivisionSurface { mesh, edges } = self;
        let (vertex_count, edge_count) = (mesh.positions.len() as u32, edges.edges.len() as u32);
        // Four quads for each, one at each corner
        let split = |(index, quad): (usize, &[u32; 4])| {
            let side = |k: usize| vertex_count + edges.of_quad[index][k];
            let centre = vertex_count + edge_count + index as u32;
            std::array::from_fn::<_, 4, _>(|k| [quad[k], side(k), centre, side((k + 3) % 4)])
        };
        let quads = mesh.quads.par_iter().enumerate().flat_map_iter(split).collect();
        let split_uv = |corners: &[Vec2; 4]| {
            let corners = *corners;
            let side = move |k: usize| (corners[k] + corners[(k + 1) % 4]) / 2.0;
            let centre = corners.into_iter().sum::<Vec2>() / 4.0;
            std::array::from_fn::<_, 4, _>(|k| [corners[k], side(k), centre, side((k + 3) % 4)])
        };
        let subdivided = QuadMesh {
            positions: self.subdivided_positions(&mesh.positions),
            quads,
            uvs: mesh.uvs.par_iter().flat_map_iter(split_uv).collect(),
            parts: mesh.parts.iter().flat_map(|&part| [part; 4]).collect(),
            values: self.split_values(),
        };
        SubdivisionSurface { mesh: subdivided, edges: edges.subdivided(mesh) }
    }

    /// Returns the positions of the subdivided surface's vertices if this one's are at `positions`: those of the old
    /// vertices, of edges and of quads.
    pub fn subdivided_positions(&self, positions: &[Vec3]) -> Vec<Vec3> {
        let quad_points = self.quad_points(positions);
        let edge_point = |edge: &Edge| {
            let [a, b] = edge.ends.map(|v| positions[v as usize]);
            match edge.quads {
                [_, NONE] => (a + b) / 2.0,
                [left, right] => (a + b + quad_points[left as usize] + quad_points[right as usize]) / 4.0,
            }
        };
        let rings = self.rings(positions, &quad_points);
        let old = positions.par_iter().zip(rings).map(|(position, ring)| ring.smoothed(*position));
        let edge_points = self.edges.edges.par_iter().map(edge_point);
        let mut subdivided: Vec<Vec3> = old.chain(edge_points).collect();
        subdivided.extend(quad_points);
        subdivided
    }

    /// Returns the middle of each quad.
    fn quad_points(&self, positions: &[Vec3]) -> Vec<Vec3> {
        let middle = |quad: &[u32; 4]| quad.iter().map(|&v| positions[v as usize]).sum::<Vec3>() / 4.0;
        self.mesh.quads.par_iter().map(middle).collect()
    }

    /// Returns the values of the old vertices, and of the middles of edges and quads.
    fn split_values(&self) -> Vec<Vec3> {
        let values = &self.mesh.values;
        if values.is_empty() {
            return Vec::new();
        }
        let mean =
            |vertices: &[u32]| vertices.iter().map(|&v| values[v as usize]).sum::<Vec3>() / vertices.len() as f32;
        let of_edges = self.edges.edges.iter().map(|edge| mean(&edge.ends));
        values.iter().copied().chain(of_edges).chain(self.mesh.quads.iter().map(|quad| mean(quad))).collect()
    }

    /// Returns what lies round each vertex.
    fn rings(&self, positions: &[Vec3], quad_points: &[Vec3]) -> Vec<Ring> {
        let mut rings = vec![Ring::default(); positions.len()];
        for (quad, point) in self.mesh.quads.iter().zip(quad_points) {
            for &vertex in quad {
                rings[vertex as usize].quads += *point;
                rings[vertex as usize].quad_count += 1.0;
            }
        }
        for edge in &self.edges.edges {
            for [vertex, other] in [edge.ends, [edge.ends[1], edge.ends[0]]] {
                let other = positions[other as usize];
                let ring = &mut rings[vertex as usize];
                ring.edges += (positions[vertex as usize] + other) / 2.0;
                ring.edge_count += 1.0;
                if edge.is_border() {
                    ring.border += other;
                    ring.border_count += 1.0;
                }
            }
        }
        rings
    }

    /// Returns the vertices along each border, in the order in which the surface lies left of it, seen from outside.
    pub fn border_loops(&self) -> Vec<Vec<u32>> {
        let sides = self.mesh.quads.iter().zip(&self.edges.of_quad).flat_map(|(quad, sides)| {
            let side = |k: usize| (self.edges.edges[sides[k] as usize].is_border(), quad[k], quad[(k + 1) % 4]);
            [0, 1, 2, 3].map(side)
        });
        let mut next: BTreeMap<u32, u32> =
            sides.filter(|(is_border, ..)| *is_border).map(|(_, from, to)| (from, to)).collect();
        let mut loops = Vec::new();
        while let Some((start, mut vertex)) = next.pop_first() {
            let mut border = vec![start];
            while vertex != start {
                border.push(vertex);
                let Some(following) = next.remove(&vertex) else { break };
                vertex = following;
            }
            loops.push(border);
        }
        loops
    }

    /// Moves every vertex to where further subdivisions would take it.
    pub fn move_to_limit(&mut self) {
        let rings = self.rings(&self.mesh.positions, &self.quad_points(&self.mesh.positions));
        let limit = |(position, ring): (&Vec3, Ring)| ring.limit(*position);
        self.mesh.positions = self.mesh.positions.par_iter().zip(rings).map(limit).collect();
    }
}

/// What lies round a vertex.
#[derive(Clone, Copy, Debug, Default)]
struct Ring {
    quads: Vec3,
    quad_count: f32,
    edges: Vec3,
    edge_count: f32,
    border: Vec3,
    border_count: f32,
}

impl Ring {
    fn smoothed(&self, position: Vec3) -> Vec3 {
        if self.border_count == 2.0 {
            return (self.border + position * 6.0) / 8.0;
        }
        if self.border_count > 0.0 || self.quad_count == 0.0 {
            return position;
        }
        let n = self.edge_count;
        (self.quads / self.quad_count + self.edges * 2.0 / n + position * (n - 3.0)) / n
    }

    /// Returns the position on the limit surface (Halstead, Kass and DeRose 1993), (n^2 v + 4 E + F) / (n (n + 5)) with
    /// the sums of the n neighbours E along edges and F across quads; on a border that of a cubic B-spline.
    fn limit(&self, position: Vec3) -> Vec3 {
        if self.border_count == 2.0 {
            return (self.border + position * 4.0) / 6.0;
        }
        if self.border_count > 0.0 || self.quad_count == 0.0 {
            return position;
        }
        let n = self.edge_count;
        // E and F from the middles of edges and quads
        let along = self.edges * 2.0 - position * n;
        let across = self.quads * 4.0 - position * n - along * 2.0;
        (position * n * n + along * 4.0 + across) / (n * (n + 5.0))
    }
}

/// The edges of a mesh.
#[derive(Clone, Debug)]
pub struct Edges {
    /// All edges.
    pub edges: Vec<Edge>,
    /// Edges of each quad; edge `k` goes from corner `k` to the next.
    of_quad: Vec<[u32; 4]>,
}

impl Edges {
    /// Returns the edges of a mesh.
    pub fn new(mesh: &QuadMesh) -> Edges {
        // Sort the quads' sides by their ends: those of one edge become neighbours
        let sides = |(quad, corners): (usize, &[u32; 4])| {
            let corners = *corners;
            (0..4).map(move |k| {
                let (a, b) = (corners[k], corners[(k + 1) % 4]);
                (u64::from(a.min(b)) << 32 | u64::from(a.max(b)), (quad * 4 + k) as u32)
            })
        };
        let mut sides: Vec<(u64, u32)> = mesh.quads.par_iter().enumerate().flat_map_iter(sides).collect();
        sides.par_sort_unstable();
        let mut edges = Vec::with_capacity(sides.len() / 2 + 1);
        let mut of_quad = vec![[0; 4]; mesh.quads.len()];
        for same in sides.chunk_by(|a, b| a.0 == b.0) {
            // More than two quads at an edge do not occur in these meshes; the rest are borders of their own.
            for pair in same.chunks(2) {
                let quad = |side: usize| pair.get(side).map_or(NONE, |(_, corner)| corner / 4);
                for (_, corner) in pair {
                    of_quad[*corner as usize / 4][*corner as usize % 4] = edges.len() as u32;
                }
                let ends = [(pair[0].0 >> 32) as u32, pair[0].0 as u32];
                edges.push(Edge { ends, quads: [quad(0), quad(1)] });
            }
        }
        Edges { edges, of_quad }
    }
    /// Returns the edges of the subdivided mesh: two halves of each edge, and four edges in each quad.
    fn subdivided(&self, mesh: &QuadMesh) -> Edges {
        let (vertex_count, edge_count) = (mesh.positions.len() as u32, self.edges.len() as u32);
        let corner_of = |quad: u32, vertex: u32| mesh.quads[quad as usize].iter().zip(0..).find(|(v, _)| **v == vertex);
        // The quad at a corner of a quad
        let at_corner =
            |quad: u32, vertex: u32| corner_of(quad, vertex).map_or(NONE, |(_, corner): (_, u32)| quad * 4 + corner);
        let halves = |(index, edge): (usize, &Edge)| {
            let (middle, edge) = (vertex_count + index as u32, *edge);
            edge.ends.map(|end| {
                let quads = edge.quads.map(|quad| if quad == NONE { NONE } else { at_corner(quad, end) });
                Edge { ends: [end, middle], quads }
            })
        };
        // From the middle of each side of a quad to the quad's middle
        let spokes = |(index, sides): (usize, &[u32; 4])| {
            let (quad, sides) = (index as u32, *sides);
            let spoke = move |k: u32| Edge {
                ends: [vertex_count + sides[k as usize], vertex_count + edge_count + quad],
                quads: [quad * 4 + k, quad * 4 + (k + 1) % 4],
            };
            [0, 1, 2, 3].map(spoke)
        };
        let mut edges: Vec<Edge> = self.edges.par_iter().enumerate().flat_map_iter(halves).collect();
        edges.par_extend(self.of_quad.par_iter().enumerate().flat_map_iter(spokes));
        let of_quad = |(index, sides): (usize, &[u32; 4])| {
            let (quad, sides) = (index as u32, *sides);
            // The half of a side that begins at a corner
            let half = |side: u32, vertex: u32| side * 2 + u32::from(self.edges[side as usize].ends[0] != vertex);
            let spoke = |k: u32| edge_count * 2 + quad * 4 + k;
            std::array::from_fn::<_, 4, _>(|k| {
                let (corner, before) = (mesh.quads[index][k], (k + 3) % 4);
                [half(sides[k], corner), spoke(k as u32), spoke(before as u32), half(sides[before], corner)]
            })
        };
        let of_quad = self.of_quad.par_iter().enumerate().flat_map_iter(of_quad).collect();
        Edges { edges, of_quad }
    }

    /// Appends the edges of a mesh whose vertices begin at `first_vertex`.
    fn append(&mut self, other: &Edges, first_vertex: u32) {
        let (first_edge, first_quad) = (self.edges.len() as u32, self.of_quad.len() as u32);
        let moved = |edge: &Edge| Edge {
            ends: edge.ends.map(|vertex| vertex + first_vertex),
            quads: edge.quads.map(|quad| if quad == NONE { NONE } else { quad + first_quad }),
        };
        self.edges.extend(other.edges.iter().map(moved));
        self.of_quad.extend(other.of_quad.iter().map(|sides| sides.map(|edge| edge + first_edge)));
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn cube() -> SubdivisionSurface {
        let corner = |i: usize| Vec3::new((i & 1) as f32, (i >> 1 & 1) as f32, (i >> 2) as f32) * 2.0 - Vec3::ONE;
        let quads = vec![[0, 2, 3, 1], [4, 5, 7, 6], [0, 1, 5, 4], [2, 6, 7, 3], [0, 4, 6, 2], [1, 3, 7, 5]];
        let count = quads.len();
        SubdivisionSurface::new(QuadMesh {
            positions: (0..8).map(corner).collect(),
            quads,
            uvs: vec![[Vec2::ZERO, Vec2::X, Vec2::ONE, Vec2::Y]; count],
            parts: vec![0; count],
            ..QuadMesh::default()
        })
    }

    /// The first step of a cube of edge 2: quad points at 1, edge points at (1 + 1/2)/2 twice, corners at 5/9.
    #[test]
    fn a_cube_follows_the_rules_and_tends_to_a_round_closed_body() {
        let subdivided = cube().subdivided();
        let once = &subdivided.mesh;
        assert_eq!((once.positions.len(), once.quads.len()), (8 + 12 + 6, 24));
        assert!(once.positions[7].distance(Vec3::splat(5.0 / 9.0)) < 1e-6, "{}", once.positions[7]);
        assert!(once.positions[8..20].iter().all(|p| (p.length() - 0.75 * 2_f32.sqrt()).abs() < 1e-6));
        assert!(once.positions[20..].iter().all(|p| (p.length() - 1.0).abs() < 1e-6));
        let thrice = subdivided.subdivided().subdivided().mesh;
        let radii: Vec<f32> = thrice.positions.iter().map(|p| p.length()).collect();
        let (low, high) = radii.iter().fold((9.0_f32, 0.0_f32), |(l, h), r| (l.min(*r), h.max(*r)));
        assert!(high / low < 1.2, "{low} {high}");
        assert!(thrice.normals().iter().zip(&thrice.positions).all(|(n, p)| n.dot(p.normalize()) > 0.9));
        assert!(thrice.uvs.iter().flatten().all(|uv| uv.min_element() >= 0.0 && uv.max_element() <= 1.0));
    }

    #[test]
    fn positions_at_the_limit_are_those_of_many_subdivisions() {
        let mut limit = cube().subdivided();
        let many = limit.subdivided().subdivided().subdivided().subdivided().subdivided();
        limit.move_to_limit();
        for (limit, many) in limit.mesh.positions.iter().zip(&many.mesh.positions) {
            assert!(limit.distance(*many) < 1e-3, "{limit} {many}");
        }
    }

    /// An open square keeps its corner region as the cubic B-spline of its border: end points move by the 1-6-1 rule.
    #[test]
    fn borders_follow_their_own_curve() {
        let square = QuadMesh {
            positions: [[0., 0.], [1., 0.], [2., 0.], [0., 1.], [1., 1.], [2., 1.]]
                .map(|[x, y]| Vec3::new(x, y, 0.0))
                .into(),
            quads: vec![[0, 1, 4, 3], [1, 2, 5, 4]],
            uvs: vec![[Vec2::ZERO; 4]; 2],
            parts: vec![0, 1],
            ..QuadMesh::default()
        };
        let once = SubdivisionSurface::new(square).subdivided().mesh;
        assert_eq!(once.positions[1], Vec3::new(1.0, 0.0, 0.0), "on a straight border a vertex stays");
        assert_eq!(once.positions[0], Vec3::new(1.0 / 8.0, 1.0 / 8.0, 0.0));
        assert_eq!(once.parts, [0, 0, 0, 0, 1, 1, 1, 1]);
    }
    /// The edges as sets of vertices, with the vertices of the quads beside each.
    fn described(surface: &SubdivisionSurface) -> Vec<([u32; 2], Vec<[u32; 4]>)> {
        let sorted = |mut ends: [u32; 2]| {
            ends.sort_unstable();
            ends
        };
        let beside = |edge: &Edge| {
            let mut quads: Vec<[u32; 4]> =
                edge.quads.into_iter().filter(|q| *q != NONE).map(|q| surface.mesh.quads[q as usize]).collect();
            quads.sort_unstable();
            quads
        };
        let mut edges: Vec<_> = surface.edges.edges.iter().map(|edge| (sorted(edge.ends), beside(edge))).collect();
        edges.sort_unstable();
        edges
    }

    #[test]
    fn derived_edges_are_those_that_a_search_finds() {
        let mut both = cube();
        both.append(&SubdivisionSurface::new(QuadMesh {
            positions: (0..6).map(|i| Vec3::new((i % 3) as f32, (i / 3) as f32, 0.0)).collect(),
            quads: vec![[0, 1, 4, 3], [1, 2, 5, 4]],
            uvs: vec![[Vec2::ZERO; 4]; 2],
            parts: vec![0; 2],
            ..QuadMesh::default()
        }));
        for surface in [both.clone(), both.subdivided(), both.subdivided().subdivided()] {
            assert_eq!(described(&surface), described(&SubdivisionSurface::new(surface.mesh.clone())));
            for (quad, sides) in surface.mesh.quads.iter().zip(&surface.edges.of_quad) {
                for k in 0..4 {
                    let ends = surface.edges.edges[sides[k] as usize].ends;
                    assert!(ends.contains(&quad[k]) && ends.contains(&quad[(k + 1) % 4]), "{quad:?} {ends:?}");
                }
            }
        }
    }
}

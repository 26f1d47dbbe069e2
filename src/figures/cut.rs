//! Cuts patches where a field is 0: quads on the cut are clipped, and the rest of each is split into quads.

use super::patch::Patch;
use glam::{Vec2, Vec3};
use std::collections::HashMap;

/// Part of an edge within which a vertex is moved to the cut: shorter rests of edges would make slivers.
const SNAP: f32 = 0.3;
/// Vertex that is not in the cut patch.
const NONE: u32 = u32::MAX;

impl Patch {
    /// Returns the part of the patch in which a field of the body's vertices is positive. It ends in the line where the
    /// field, which is linear along edges, is 0. Vertices on the line have the sources of vertices outside.
    pub fn cut(mut self, field: &dyn Fn(u16) -> f32) -> Patch {
        let mut fields: Vec<f32> = self.sources.iter().map(|&v| field(v)).collect();
        if fields.iter().all(|field| *field > 0.0) {
            return self;
        }
        self.snap(&mut fields);
        let mut cut = Cut { vertices: vec![NONE; fields.len()], fields, old: self, ..Cut::default() };
        for quad in 0..cut.old.quads.len() {
            cut.add_quad(quad);
        }
        cut.patch
    }

    /// Moves vertices near the line where the field is 0 along an edge to it. Their field becomes 0.
    fn snap(&mut self, fields: &mut [f32]) {
        let (old, old_fields) = (self.positions.clone(), fields.to_vec());
        // Part of the edge and the other end of the shortest way to the line, for each vertex
        let mut nearest = vec![(SNAP, NONE); old.len()];
        for quad in &self.quads {
            for k in 0..4 {
                for (from, to) in [(quad[k], quad[(k + 1) % 4]), (quad[(k + 1) % 4], quad[k])] {
                    let [a, b] = [from, to].map(|v| old_fields[v as usize]);
                    let is_crossed = (a > 0.0) != (b > 0.0);
                    if is_crossed && a / (a - b) < nearest[from as usize].0 {
                        nearest[from as usize] = (a / (a - b), to);
                    }
                }
            }
        }
        let sources = self.sources.clone();
        for (vertex, &(t, other)) in nearest.iter().enumerate().filter(|(_, (_, other))| *other != NONE) {
            self.positions[vertex] = old[vertex].lerp(old[other as usize], t);
            if old_fields[vertex] > 0.0 {
                self.sources[vertex] = sources[other as usize];
            }
            fields[vertex] = 0.0;
        }
    }
}

/// A corner of a clipped quad.
#[derive(Clone, Copy, Debug)]
struct Corner {
    /// Vertex of the cut patch.
    vertex: u32,
    uv: Vec2,
    /// False on the line.
    is_inside: bool,
}

/// A patch that is being cut.
#[derive(Debug, Default)]
struct Cut {
    old: Patch,
    fields: Vec<f32>,
    /// The vertex of the cut patch for each old one.
    vertices: Vec<u32>,
    /// The vertex of the cut patch on each old edge that crosses the line.
    on_edges: HashMap<[u32; 2], u32>,
    patch: Patch,
}

impl Cut {
    /// Adds what is inside of a quad.
    fn add_quad(&mut self, quad: usize) {
        let (corners, uvs) = (self.old.quads[quad], self.old.uvs[quad]);
        let fields = corners.map(|v| self.fields[v as usize]);
        if fields.iter().all(|field| *field <= 0.0) {
            return;
        }
        // Clip the quad (Sutherland and Hodgman 1974)
        let mut polygon: Vec<Corner> = Vec::with_capacity(6);
        for k in 0..4 {
            let next = (k + 1) % 4;
            if fields[k] >= 0.0 {
                polygon.push(Corner { vertex: self.vertex(corners[k]), uv: uvs[k], is_inside: fields[k] > 0.0 });
            }
            if fields[k] * fields[next] < 0.0 {
                let uv = uvs[k].lerp(uvs[next], fields[k] / (fields[k] - fields[next]));
                let vertex = self.on_edge([corners[k], corners[next]]);
                polygon.push(Corner { vertex, uv, is_inside: false });
            }
        }
        self.add_polygon(&polygon);
    }

    /// Adds a clipped quad as one quad or two. Those that are triangles have a fourth corner in the middle of the line.
    fn add_polygon(&mut self, polygon: &[Corner]) {
        let count = polygon.len();
        // The side on the line begins at this corner
        let line = (0..count).find(|&k| !polygon[k].is_inside && !polygon[(k + 1) % count].is_inside);
        let at = |k: usize| polygon[(line.unwrap_or(0) + k) % count];
        match count {
            3 if line.is_some() => self.add_triangle([at(2), at(0), at(1)]),
            4 => self.add([at(0), at(1), at(2), at(3)]),
            5 => {
                self.add([at(1), at(2), at(3), at(4)]);
                self.add_triangle([at(4), at(0), at(1)]);
            }
            // Two corners across are inside
            6 => {
                for first in (0..6).filter(|&k| polygon[k].is_inside) {
                    self.add_triangle([0, 1, 5].map(|k| polygon[(first + k) % 6]));
                }
            }
            _ => {}
        }
    }

    /// Adds a triangle whose second and third corner are on the line.
    fn add_triangle(&mut self, [inside, a, b]: [Corner; 3]) {
        let [p, q] = [a, b].map(|corner| self.patch.positions[corner.vertex as usize]);
        let vertex = self.push((p + q) / 2.0, self.patch.sources[a.vertex as usize]);
        let middle = Corner { vertex, uv: (a.uv + b.uv) / 2.0, is_inside: false };
        self.add([inside, a, middle, b]);
    }

    fn add(&mut self, corners: [Corner; 4]) {
        self.patch.quads.push(corners.map(|corner| corner.vertex));
        self.patch.uvs.push(corners.map(|corner| corner.uv));
    }

    fn push(&mut self, position: Vec3, source: u16) -> u32 {
        self.patch.positions.push(position);
        self.patch.sources.push(source);
        self.patch.positions.len() as u32 - 1
    }

    /// Returns the vertex of the cut patch for an old one.
    fn vertex(&mut self, old: u32) -> u32 {
        if self.vertices[old as usize] == NONE {
            self.vertices[old as usize] = self.push(self.old.positions[old as usize], self.old.sources[old as usize]);
        }
        self.vertices[old as usize]
    }

    /// Returns the vertex of the cut patch where an old edge crosses the line.
    fn on_edge(&mut self, [a, b]: [u32; 2]) -> u32 {
        let ends = [a.min(b), a.max(b)];
        if let Some(&vertex) = self.on_edges.get(&ends) {
            return vertex;
        }
        let [from, to] = ends.map(|end| self.fields[end as usize]);
        let [p, q] = ends.map(|end| self.old.positions[end as usize]);
        let outside = ends[usize::from(to < from)];
        let vertex = self.push(p.lerp(q, from / (from - to)), self.old.sources[outside as usize]);
        self.on_edges.insert(ends, vertex);
        vertex
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Squares along each edge of a sheet of 1 m.
    const SQUARES: u16 = 12;

    fn sheet() -> Patch {
        let side = SQUARES + 1;
        let at = |v: u16| Vec2::new(f32::from(v % side), f32::from(v / side)) / f32::from(SQUARES);
        let corners = |v: u16| [v, v + 1, v + side + 1, v + side];
        let starts: Vec<u16> = (0..side * side).filter(|v| v % side < SQUARES && v / side < SQUARES).collect();
        Patch {
            positions: (0..side * side).map(|v| at(v).extend(0.0)).collect(),
            quads: starts.iter().map(|&v| corners(v).map(u32::from)).collect(),
            uvs: starts.iter().map(|&v| corners(v).map(at)).collect(),
            sources: (0..side * side).collect(),
        }
    }

    #[test]
    fn a_cut_patch_ends_on_the_line_and_no_quad_is_folded() {
        let sheet = sheet();
        for angle_deg in (0..360).step_by(7) {
            let normal = Vec2::from_angle((angle_deg as f32).to_radians());
            let middle = Vec2::new(0.52, 0.47);
            let height = |p: Vec3| (p.truncate() - middle).dot(normal);
            let cut = sheet.clone().cut(&|v| height(sheet.positions[usize::from(v)]));
            let surface = |quad: &[u32; 4]| {
                let [a, b, c, d] = quad.map(|v| cut.positions[v as usize]);
                (c - a).cross(d - b).z / 2.0
            };
            // Quads that are triangles have an area, too
            let smallest = cut.quads.iter().map(surface).fold(f32::MAX, f32::min);
            let square = 1.0 / f32::from(SQUARES).powi(2);
            assert!(smallest > 0.02 * square, "{angle_deg}: {smallest} m2 of {square} m2");
            let lowest = cut.positions.iter().map(|p| height(*p)).fold(f32::MAX, f32::min);
            assert!(lowest > -1e-5, "{angle_deg}: {lowest} m");
            // The patch reaches the line: what is left of the sheet is inside of it
            let area = cut.quads.iter().map(surface).sum::<f32>();
            let samples = (0..100_u16)
                .flat_map(|y| (0..100_u16).map(move |x| Vec2::new(f32::from(x) + 0.5, f32::from(y) + 0.5) / 100.0));
            let expected = samples.filter(|p| height(p.extend(0.0)) > 0.0).count() as f32 / 1e4;
            assert!((area - expected).abs() < 0.015, "{angle_deg}: {area} m2, expected {expected} m2");
        }
    }

    #[test]
    fn the_border_of_a_cut_patch_is_one_line() {
        use crate::figures::subdivide::SubdivisionSurface;
        let sheet = sheet();
        // A disc: cut lines of all directions
        let field = |v: u16| 0.37 - sheet.positions[usize::from(v)].distance(Vec3::new(0.5, 0.5, 0.0));
        let cut = sheet.clone().cut(&field).into_mesh(0, &|_| Vec3::ZERO);
        let surface = SubdivisionSurface::new(cut);
        let [border] = &surface.border_loops()[..] else { panic!("one border") };
        let farthest = border.iter().map(|&v| surface.mesh.positions[v as usize].distance(Vec3::new(0.5, 0.5, 0.0)));
        assert!(farthest.clone().fold(f32::MAX, f32::min) > 0.36 && farthest.fold(0.0, f32::max) < 0.375);
    }
}

//! Indexed triangle meshes, with strands.

use super::Strands;
use glam::{Vec2, Vec3};
use std::cmp::Ordering;
use std::collections::HashMap;
use std::hash::{Hash, Hasher};

/// A named range of triangles that can have its own material.
#[derive(Clone, Debug, PartialEq, Eq, Hash)]
pub struct MeshPart {
    /// `eyes`, `floor`, an OBJ group.
    pub name: String,
    /// Range of `Mesh::triangles`.
    pub triangles: std::ops::Range<u32>,
}

/// An indexed triangle mesh in object space, metres. Front faces wind counter-clockwise.
///
/// `normals`, `uvs`, `second_uvs`, `colors` and `velocities` are either empty or as long as `positions`. `parts` cover all triangles, in order.
#[derive(Clone, Debug, PartialEq, Default)]
pub struct Mesh {
    /// Vertex positions, metres.
    pub positions: Vec<Vec3>,
    /// Unit vertex normals; empty means flat shading.
    pub normals: Vec<Vec3>,
    /// Texture coordinates, (0, 0) at the picture's bottom left; empty where the mesh has none.
    pub uvs: Vec<Vec2>,
    /// A second set of texture coordinates, for textures whose placement asks for it; empty where the mesh has none.
    pub second_uvs: Vec<Vec2>,
    /// Vertex colours, scene-linear, 0 to 1: factors of the base colour. Empty means 1.
    pub colors: Vec<Vec3>,
    /// Velocities of the vertices, m/s; empty for a mesh at rest.
    pub velocities: Vec<Vec3>,
    /// Vertex indices, three a triangle.
    pub triangles: Vec<[u32; 3]>,
    /// Named ranges of triangles.
    pub parts: Vec<MeshPart>,
    /// Hair and the like, in the same space, with parts of its own.
    pub strands: Strands,
}

impl Mesh {
    /// Returns the lower and upper corner of the bounding box, strands included; both zero without either.
    pub fn bounds(&self) -> (Vec3, Vec3) {
        let vertices = self.positions.iter().map(|&p| (p, p));
        let bounds = vertices.chain(self.strands.bounds()).reduce(|(low, high), (l, h)| (low.min(l), high.max(h)));
        bounds.unwrap_or((Vec3::ZERO, Vec3::ZERO))
    }

    /// Returns the names of the parts that can have a material: those of the triangles, then those of the strands.
    pub fn part_names(&self) -> impl Iterator<Item = &str> {
        let strands = self.strands.parts().iter().map(|part| part.name.as_str());
        self.parts.iter().map(|part| part.name.as_str()).chain(strands)
    }

    /// Returns the vertex positions of a triangle.
    pub fn corners(&self, triangle: usize) -> [Vec3; 3] {
        self.triangles[triangle].map(|i| self.positions[i as usize])
    }

    /// Returns the mesh with a single part.
    pub fn with_single_part(mut self, name: &str) -> Self {
        self.parts = vec![MeshPart { name: name.to_owned(), triangles: 0..self.triangles.len() as u32 }];
        self
    }

    /// Appends another mesh, its strands and the parts of both. Attributes that only one of the two has are dropped.
    pub fn append(&mut self, other: &Mesh) {
        self.strands.append(&other.strands);
        let (base, first) = (self.positions.len() as u32, self.triangles.len() as u32);
        let keep = |ours: usize, theirs: usize| (ours as u32 == base) && theirs == other.positions.len();
        if keep(self.normals.len(), other.normals.len()) {
            self.normals.extend(&other.normals);
        } else {
            self.normals.clear();
        }
        if keep(self.uvs.len(), other.uvs.len()) {
            self.uvs.extend(&other.uvs);
        } else {
            self.uvs.clear();
        }
        if !(self.second_uvs.is_empty() && other.second_uvs.is_empty()) {
            self.second_uvs.resize(self.positions.len(), Vec2::ZERO);
            self.second_uvs.extend(&other.second_uvs);
            self.second_uvs.resize(self.positions.len() + other.positions.len(), Vec2::ZERO);
        }
        if !(self.colors.is_empty() && other.colors.is_empty()) {
            self.colors.resize(self.positions.len(), Vec3::ONE);
            self.colors.extend(&other.colors);
            self.colors.resize(self.positions.len() + other.positions.len(), Vec3::ONE);
        }
        if !(self.velocities.is_empty() && other.velocities.is_empty()) {
            self.velocities.resize(self.positions.len(), Vec3::ZERO);
            self.velocities.extend(&other.velocities);
            self.velocities.resize(self.positions.len() + other.positions.len(), Vec3::ZERO);
        }
        self.positions.extend(&other.positions);
        self.triangles.extend(other.triangles.iter().map(|t| t.map(|i| i + base)));
        self.parts.extend(
            other.parts.iter().map(|p| MeshPart {
                name: p.name.clone(),
                triangles: p.triangles.start + first..p.triangles.end + first,
            }),
        );
    }

    /// Returns the mesh, at rest, where it is after some time, seconds: each vertex goes on straight.
    pub fn moved(&self, time_s: f32) -> Self {
        let mut mesh = Mesh { velocities: Vec::new(), ..self.clone() };
        mesh.positions.iter_mut().zip(&self.velocities).for_each(|(at, velocity)| *at += *velocity * time_s);
        mesh
    }

    /// Feeds everything that the mesh consists of into a hasher.
    pub fn hash_content(&self, hasher: &mut impl Hasher) {
        let bits = |v: &Vec3| [u64::from(v.x.to_bits()) << 32 | u64::from(v.y.to_bits()), v.z.to_bits().into()];
        for vectors in [&self.positions, &self.normals, &self.colors, &self.velocities] {
            vectors.len().hash(hasher);
            vectors.iter().for_each(|v| bits(v).hash(hasher));
        }
        for uvs in [&self.uvs, &self.second_uvs] {
            uvs.iter().for_each(|uv| [uv.x.to_bits(), uv.y.to_bits()].hash(hasher));
        }
        self.triangles.hash(hasher);
        self.parts.hash(hasher);
        self.strands.hash_content(hasher);
    }

    /// Returns true if the mesh encloses a volume: every edge has as many triangles in one direction as in the other.
    /// Vertices at the same position count as one. Up to 1 % of open edges is tolerated if the area-weighted normals
    /// cancel.
    pub fn is_closed(&self) -> bool {
        let position_bits = |i: u32| (self.positions[i as usize] + Vec3::ZERO).to_array().map(f32::to_bits);
        let mut edges: HashMap<[[u32; 3]; 2], i32> = HashMap::with_capacity(self.triangles.len() * 3 / 2);
        let (mut area_vector, mut area) = (Vec3::ZERO, 0.0);
        for (index, triangle) in self.triangles.iter().enumerate() {
            let [a, b, c] = self.corners(index);
            let face = (b - a).cross(c - a);
            area_vector += face;
            area += face.length();
            let p = triangle.map(position_bits);
            for [from, to] in [[p[0], p[1]], [p[1], p[2]], [p[2], p[0]]] {
                match from.cmp(&to) {
                    Ordering::Less => *edges.entry([from, to]).or_default() += 1,
                    Ordering::Greater => *edges.entry([to, from]).or_default() -= 1,
                    Ordering::Equal => {}
                }
            }
        }
        let open = edges.values().filter(|&&balance| balance != 0).count();
        open == 0 || (open * 100 < edges.len() && area_vector.length() < 1e-2 * area)
    }

    /// Replaces the normals by the angle-weighted mean of the faces around each vertex (Thurmer and Wuthrich 1998).
    /// Vertices of zero-area faces alone get +Y.
    pub fn compute_smooth_normals(&mut self) {
        let mut sums = vec![Vec3::ZERO; self.positions.len()];
        for t in &self.triangles {
            let p = t.map(|i| self.positions[i as usize]);
            let face = (p[1] - p[0]).cross(p[2] - p[0]).normalize_or_zero();
            for k in 0..3 {
                let (a, b) = (p[(k + 1) % 3] - p[k], p[(k + 2) % 3] - p[k]);
                let angle = crate::math::angle_between(a, b);
                sums[t[k] as usize] += face * angle;
            }
        }
        self.normals = sums.into_iter().map(|n| n.try_normalize().unwrap_or(Vec3::Y)).collect();
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scene::{Room, Shape, room_mesh, tessellate};

    #[test]
    fn solids_are_closed_and_sheets_are_open() {
        for (shape, closed) in [
            (Shape::Box { size_m: Vec3::new(1.0, 2.0, 0.01) }, true),
            (Shape::Sphere { radius_m: 0.1 }, true),
            (Shape::Cylinder { radius_m: 0.3, height_m: 2.0 }, true),
            (Shape::Plane { width_m: 1.0, depth_m: 2.0 }, false),
            (Shape::Sweep { width_m: 2.0, height_m: 3.0, depth_m: 2.0, radius_m: 0.5 }, false),
            (Shape::VFlat { wing_m: 1.2, height_m: 2.4, angle_deg: 90.0 }, false),
        ] {
            assert_eq!(tessellate(&shape).unwrap().is_closed(), closed, "{shape:?}");
        }
        assert!(room_mesh(&Room::default()).is_closed());
        let mut holed = tessellate(&Shape::Sphere { radius_m: 1.0 }).unwrap();
        holed.triangles.truncate(holed.triangles.len() - 1);
        assert!(holed.is_closed(), "one missing triangle of thousands is tolerated");
        holed.triangles.truncate(holed.triangles.len() / 2);
        assert!(!holed.is_closed(), "half a sphere is open");
    }
}

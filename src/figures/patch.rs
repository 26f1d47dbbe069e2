//! A patch of the posed body: some quads of a group, cut at the edge of a garment.

use super::body_data::BodyData;
use super::subdivide::{QuadMesh, SubdivisionSurface};
use crate::math::PointSet;
use glam::{Vec2, Vec3};

/// Rounds in which hollows are filled.
const FILL_ROUNDS: usize = 40;

/// Quads with their own vertices.
#[derive(Clone, Debug, Default)]
pub struct Patch {
    /// Vertices, metres.
    pub positions: Vec<Vec3>,
    /// Corners.
    pub quads: Vec<[u32; 4]>,
    /// Texture coordinates of the corners.
    pub uvs: Vec<[Vec2; 4]>,
    /// Vertex of the body data for each vertex.
    pub sources: Vec<u16>,
}

/// Skin that clothes lie on, taken as flat round each of its vertices.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Skin {
    positions: Vec<Vec3>,
    /// Unit normals of the vertices.
    normals: Vec<Vec3>,
    /// The positions, for the search of the nearest one.
    search: PointSet,
}

impl Skin {
    fn new(positions: Vec<Vec3>, normals: Vec<Vec3>) -> Skin {
        Skin { search: PointSet::new(positions.iter().copied()), positions, normals }
    }

    /// Returns the height of a point over the tangent plane of the nearest vertex, metres, and its unit normal. None for
    /// skin without vertices.
    pub fn height(&self, point: Vec3) -> Option<(f32, Vec3)> {
        let [(_, nearest)] = self.search.nearest(point);
        let (normal, position) = (*self.normals.get(nearest)?, self.positions[nearest]);
        Some(((point - position).dot(normal), normal))
    }
}

impl Patch {
    /// Returns the skin of this patch.
    pub fn skin(self) -> Skin {
        let normals = self.normals();
        Skin::new(self.positions, normals)
    }

    /// Returns the skin of this patch, subdivided once.
    pub fn subdivided_skin(self) -> Skin {
        let mesh = SubdivisionSurface::new(self.into_mesh(0, &|_| Vec3::ZERO)).subdivided().mesh;
        let normals = mesh.normals();
        Skin::new(mesh.positions, normals)
    }

    /// Returns the wanted quads of a group of the body data.
    pub fn new(data: &BodyData, group: &str, positions: &[Vec3], wanted: &dyn Fn(&[u16; 4]) -> bool) -> Patch {
        let mut patch = Patch::default();
        let Some(group) = data.group(group) else { return patch };
        // The vertex of the patch for each of the body data
        const NONE: u32 = u32::MAX;
        let mut vertices = vec![NONE; data.positions.len()];
        for (quad, uvs) in group.quads.iter().zip(&group.uvs).filter(|(quad, _)| wanted(quad)) {
            let corners = quad.map(|v| {
                let vertex = &mut vertices[usize::from(v)];
                if *vertex == NONE {
                    *vertex = patch.sources.len() as u32;
                    patch.positions.push(positions[usize::from(v)]);
                    patch.sources.push(v);
                }
                *vertex
            });
            patch.quads.push(corners);
            patch.uvs.push(uvs.map(|uv| data.uvs[usize::from(uv)]));
        }
        patch
    }

    /// Moves vertices to a height over skin, metres: by a weight of 0 (not at all) to 1 (all the way).
    pub fn lay_on(&mut self, skin: &Skin, height_m: f32, weight: &dyn Fn(u16) -> f32) {
        for (position, &source) in self.positions.iter_mut().zip(&self.sources) {
            let weight = weight(source);
            if weight > 0.0
                && let Some((height, normal)) = skin.height(*position)
            {
                *position += normal * (weight * (height_m - height));
            }
        }
    }

    /// Fills hollows, as cloth spans them: moves vertices along their normals towards the mean of their neighbours where
    /// that is outwards, by a weight of 0 (not at all) to 1.
    pub fn fill_hollows(&mut self, weight: &dyn Fn(u16) -> f32) {
        let weights: Vec<f32> = self.sources.iter().map(|&v| weight(v)).collect();
        if weights.iter().all(|weight| *weight <= 0.0) {
            return;
        }
        let quads: Vec<_> = self.quads.iter().filter(|quad| quad.iter().any(|v| weights[*v as usize] > 0.0)).collect();
        for _ in 0..FILL_ROUNDS {
            // Sum of the neighbours, their count and the normal of each vertex
            let mut around = vec![(Vec3::ZERO, 0.0, Vec3::ZERO); self.positions.len()];
            for quad in &quads {
                let corners = quad.map(|v| self.positions[v as usize]);
                let normal = (corners[2] - corners[0]).cross(corners[3] - corners[1]);
                for k in 0..4 {
                    let (sum, count, normals) = &mut around[quad[k] as usize];
                    *sum += corners[(k + 1) % 4] + corners[(k + 3) % 4];
                    *count += 2.0;
                    *normals += normal;
                }
            }
            for (vertex, position) in self.positions.iter_mut().enumerate().filter(|(v, _)| weights[*v] > 0.0) {
                let (sum, count, normal) = around[vertex];
                let normal = normal.normalize_or_zero();
                let outwards = (sum / f32::max(count, 1.0) - *position).dot(normal).max(0.0);
                *position += normal * (outwards * weights[vertex]);
            }
        }
    }

    /// Moves every vertex by a vector, metres, that a function computes from its source and its unit normal.
    pub fn move_by(&mut self, offset: &dyn Fn(u16, Vec3) -> Vec3) {
        let normals = self.normals();
        for ((position, normal), &source) in self.positions.iter_mut().zip(normals).zip(&self.sources) {
            *position += offset(source, normal);
        }
    }

    /// Returns the mesh of one part, with a value for each vertex of the body data.
    pub fn into_mesh(self, part: u8, value: &dyn Fn(u16) -> Vec3) -> QuadMesh {
        QuadMesh {
            positions: self.positions,
            parts: vec![part; self.quads.len()],
            quads: self.quads,
            uvs: self.uvs,
            values: self.sources.iter().map(|&v| value(v)).collect(),
        }
    }

    /// Returns the unit normals of the vertices.
    fn normals(&self) -> Vec<Vec3> {
        let mut normals = vec![Vec3::ZERO; self.positions.len()];
        for quad in &self.quads {
            let [a, b, c, d] = quad.map(|v| self.positions[v as usize]);
            for &v in quad {
                normals[v as usize] += (c - a).cross(d - b);
            }
        }
        normals.iter().map(|normal| normal.normalize_or_zero()).collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Squares along each edge of a level sheet whose outside is above.
    const SQUARES: u16 = 10;

    #[test]
    fn hollows_are_filled_and_ridges_stay() {
        let side = SQUARES + 1;
        let corners = |v: u16| [v, v + side, v + side + 1, v + 1].map(u32::from);
        let starts = (0..side * side).filter(|v| v % side < SQUARES && v / side < SQUARES);
        for depth_m in [0.02, -0.02] {
            let height = |v: u16| if v % side == SQUARES / 2 { -depth_m } else { 0.0 };
            let position = |v: u16| Vec3::new(f32::from(v % side) * 0.02, height(v), f32::from(v / side) * 0.02);
            let mut patch = Patch {
                positions: (0..side * side).map(position).collect(),
                quads: starts.clone().map(corners).collect(),
                uvs: Vec::new(),
                sources: (0..side * side).collect(),
            };
            patch.fill_hollows(&|_| 1.0);
            let middle = patch.positions[usize::from(side * side / 2)].y;
            if depth_m > 0.0 {
                assert!(middle > -0.3 * depth_m, "{middle} m of {depth_m} m");
            } else {
                assert!((middle + depth_m).abs() < 1e-6, "{middle} m of {depth_m} m");
            }
        }
    }
}

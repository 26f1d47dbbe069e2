//! Surface nets (Gibson 1998, "Constrained Elastic Surface Nets"), without relaxation: a vertex in each cube of samples
//! that the surface crosses, at the mean of its crossings of the cube's edges, and a quad for each edge of the lattice
//! that it crosses. The surface is closed if the outermost samples are outside.

use crate::scene::Mesh;
use glam::Vec3;

/// Samples on a lattice of edge 1, positive inside. Columns along Y are adjacent in memory, then rows along X.
#[derive(Debug)]
pub struct Field {
    size: [usize; 3],
    values: Vec<f32>,
}

/// No vertex.
const NONE: u32 = u32::MAX;

impl Field {
    /// Returns the field of this size, column by column; `fill` sets the samples of the column at (x, z).
    pub fn new(size: [usize; 3], mut fill: impl FnMut(usize, usize, &mut [f32])) -> Self {
        let mut values = vec![-1.0; size.iter().product()];
        for (column, samples) in values.chunks_mut(size[1].max(1)).enumerate() {
            fill(column % size[0], column / size[0], samples);
        }
        Field { size, values }
    }

    /// Returns the field of these samples: columns along Y, then rows along X, then planes along Z.
    pub fn from_values(size: [usize; 3], mut values: Vec<f32>) -> Self {
        values.resize(size.iter().product(), -1.0);
        Field { size, values }
    }

    fn strides(&self) -> [usize; 3] {
        [self.size[1], 1, self.size[0] * self.size[1]]
    }

    /// Returns the surface; sample 0 lies at `origin` on each axis.
    pub fn surface(&self, origin: f32) -> Mesh {
        let mut mesh = Mesh::default();
        let vertices = self.vertices(origin, &mut mesh.positions);
        for axis in 0..3 {
            self.faces(axis, &vertices, &mut mesh);
        }
        mesh.compute_smooth_normals();
        mesh
    }

    /// Returns the surface with the normals of the field, in samples.
    pub fn smooth_surface(&self) -> Mesh {
        let mut mesh = self.surface(0.0);
        for (normal, at) in mesh.normals.iter_mut().zip(&mesh.positions) {
            let value = |axis: Vec3| self.value(*at + axis) - self.value(*at - axis);
            let slope = Vec3::new(value(Vec3::X), value(Vec3::Y), value(Vec3::Z));
            // Where the field has no slope, or another than the faces, those count
            *normal = (-slope).try_normalize().filter(|smooth| smooth.dot(*normal) > 0.5).unwrap_or(*normal);
        }
        mesh
    }

    /// Returns the value between the samples, by linear interpolation.
    fn value(&self, at: Vec3) -> f32 {
        let strides = self.strides();
        let (mut base, mut t) = (0, Vec3::ZERO);
        for axis in 0..3 {
            let last = self.size[axis] - 1;
            let from = at[axis].clamp(0.0, last as f32);
            let low = (from as usize).min(last.saturating_sub(1));
            base += low * strides[axis];
            t[axis] = from - low as f32;
        }
        let weight = |axis: usize, corner: usize| if corner >> axis & 1 == 1 { t[axis] } else { 1.0 - t[axis] };
        let corner = |i: usize| {
            let offset: usize = (0..3).map(|axis| (i >> axis & 1) * strides[axis]).sum();
            let sample = self.values.get(base + offset).copied().unwrap_or(-1.0);
            weight(0, i) * weight(1, i) * weight(2, i) * sample
        };
        (0..8).map(corner).sum()
    }

    /// Places the vertices, and returns that of each cube by its lowest sample.
    fn vertices(&self, origin: f32, positions: &mut Vec<Vec3>) -> Vec<u32> {
        let mut vertices = vec![NONE; self.values.len()];
        let [sx, sy, sz] = self.size;
        let [dx, dy, dz] = self.strides();
        let corners: [usize; 8] = std::array::from_fn(|i| (i & 1) * dx + (i >> 1 & 1) * dy + (i >> 2) * dz);
        for z in 0..sz.saturating_sub(1) {
            for x in 0..sx.saturating_sub(1) {
                let column = z * dz + x * dx;
                for y in 0..sy.saturating_sub(1) {
                    let values = corners.map(|corner| self.values[column + y + corner]);
                    let inside = values.iter().filter(|value| **value > 0.0).count();
                    if inside % 8 == 0 {
                        continue;
                    }
                    vertices[column + y] = positions.len() as u32;
                    let corner = Vec3::new(x as f32, y as f32, z as f32) + origin;
                    positions.push(corner + mean_crossing(&values));
                }
            }
        }
        vertices
    }

    /// Adds the faces across the edges along an axis.
    fn faces(&self, axis: usize, vertices: &[u32], mesh: &mut Mesh) {
        let strides = self.strides();
        let (step, u, v) = (strides[axis], strides[(axis + 1) % 3], strides[(axis + 2) % 3]);
        let edges = self.values.len().saturating_sub(step);
        for from in 0..edges {
            let is_inside = self.values[from] > 0.0;
            if is_inside == (self.values[from + step] > 0.0) || from < u + v {
                continue;
            }
            // The four cubes around the edge, counter-clockwise as seen from its end
            let cubes = [from - u - v, from - v, from, from - u].map(|cube| vertices[cube]);
            if cubes.contains(&NONE) {
                continue;
            }
            let [a, b, c, d] = if is_inside { cubes } else { [cubes[0], cubes[3], cubes[2], cubes[1]] };
            let length =
                |from: u32, to: u32| mesh.positions[from as usize].distance_squared(mesh.positions[to as usize]);
            // Along the shorter diagonal
            if length(a, c) <= length(b, d) {
                mesh.triangles.extend([[a, b, c], [a, c, d]]);
            } else {
                mesh.triangles.extend([[b, c, d], [b, d, a]]);
            }
        }
    }
}

/// Returns the mean of the points where the edges of a unit cube cross the surface.
fn mean_crossing(values: &[f32; 8]) -> Vec3 {
    let (mut sum, mut count) = (Vec3::ZERO, 0.0);
    for axis in 0..3 {
        for from in (0..8).filter(|corner| corner >> axis & 1 == 0) {
            let (a, b) = (values[from], values[from | 1 << axis]);
            if (a > 0.0) != (b > 0.0) {
                let mut point = Vec3::from([0, 1, 2].map(|other| (from >> other & 1) as f32));
                point[axis] = a / (a - b);
                sum += point;
                count += 1.0;
            }
        }
    }
    sum / f32::max(count, 1.0)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Returns the volume of a closed mesh by the divergence theorem.
    fn volume(mesh: &Mesh) -> f32 {
        (0..mesh.triangles.len()).map(|t| mesh.corners(t)).map(|[a, b, c]| a.dot(b.cross(c)) / 6.0).sum()
    }

    #[test]
    fn a_ball_is_closed_faces_outwards_and_has_its_volume() {
        let field = Field::new([24, 24, 24], |x, z, column| {
            for (y, value) in column.iter_mut().enumerate() {
                *value = 9.0 - (Vec3::new(x as f32, y as f32, z as f32) - 11.7).length();
            }
        });
        let mesh = field.surface(-11.7);
        assert!(mesh.is_closed());
        let expected = 4.0 / 3.0 * std::f32::consts::PI * 9.0_f32.powi(3);
        // The vertices lie on the ball, the faces inside of it
        assert!((volume(&mesh) / expected - 1.0).abs() < 0.02, "{} for {expected}", volume(&mesh));
        for (position, normal) in mesh.positions.iter().zip(&mesh.normals) {
            assert!((position.length() - 9.0).abs() < 0.1, "{position}");
            assert!(position.normalize().dot(*normal) > 0.99, "{position} {normal}");
        }
    }

    #[test]
    fn random_samples_give_a_closed_surface() {
        let mut state = 1_u32;
        let field = Field::new([9, 8, 7], |x, z, column| {
            for (y, value) in column.iter_mut().enumerate() {
                state = state.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
                let is_inner = (1..8).contains(&x) && (1..7).contains(&y) && (1..6).contains(&z);
                *value = if is_inner { (state >> 8) as f32 / (1 << 23) as f32 - 1.0 } else { -0.5 };
            }
        });
        let mesh = field.surface(0.0);
        assert!(mesh.triangles.len() > 300 && mesh.is_closed());
        assert!(volume(&mesh) > 0.0);
    }

    #[test]
    fn a_field_without_inside_or_of_one_sample_has_no_surface() {
        assert_eq!(Field::new([5, 5, 5], |_, _, _| ()).surface(0.0), Mesh::default());
        assert_eq!(Field::new([1, 1, 1], |_, _, column| column[0] = 1.0).surface(0.0), Mesh::default());
    }
}

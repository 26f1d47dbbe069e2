//! The builder of meshes of gear: closed solids from rings, profiles, tubes and boxes, in named parts.

use crate::scene::{Mesh, MeshPart};
use glam::{Vec2, Vec3};
use std::f32::consts::TAU;

/// Least cosine between two segments of a profile across which its normals are smooth.
const SMOOTH_COSINE: f32 = 0.6;

/// Builds a mesh, part after part. All solids are closed, and their front faces are outside.
#[derive(Debug, Default)]
pub(in crate::scene) struct Builder {
    mesh: Mesh,
}

impl Builder {
    /// Begins a part with a material; the triangles that follow belong to it.
    pub fn part(&mut self, name: &str) {
        let now = self.mesh.triangles.len() as u32;
        match self.mesh.parts.last_mut() {
            Some(last) if last.triangles.is_empty() || last.name == name => last.name = name.to_owned(),
            _ => self.mesh.parts.push(MeshPart { name: name.to_owned(), triangles: now..now }),
        }
    }

    /// Returns the mesh.
    pub fn finish(self) -> Mesh {
        self.mesh
    }

    /// Adds a quadrilateral, counter-clockwise as seen from its front.
    fn quad(&mut self, corners: [Vec3; 4], normals: [Vec3; 4]) {
        let first = self.mesh.positions.len() as u32;
        self.mesh.positions.extend(corners);
        self.mesh.normals.extend(normals);
        let [a, b, c, d] = corners;
        // Triangles without area are left out: those of a quadrilateral that touches the axis of a profile
        for (is_flat, triangle) in [(a == b || b == c || a == c, [0, 1, 2]), (a == c || c == d || a == d, [0, 2, 3])] {
            if !is_flat {
                self.mesh.triangles.push(triangle.map(|corner| first + corner));
            }
        }
        if let Some(part) = self.mesh.parts.last_mut() {
            part.triangles.end = self.mesh.triangles.len() as u32;
        }
    }

    /// Returns the number of vertices so far.
    pub fn vertex_count(&self) -> usize {
        self.mesh.positions.len()
    }

    /// Adds a flat quadrilateral.
    pub fn flat_quad(&mut self, corners: [Vec3; 4]) {
        let normal = (corners[2] - corners[0]).cross(corners[3] - corners[1]).try_normalize().unwrap_or(Vec3::Y);
        self.quad(corners, [normal; 4]);
    }

    /// Adds the flat strip between two rings of as many points. Rings run counter-clockwise as seen from +Z; the strip
    /// faces away from the axis if the second lies towards +Z.
    pub fn strip(&mut self, from: &[Vec3], to: &[Vec3]) {
        for (i, j) in (0..from.len()).map(|i| (i, (i + 1) % from.len())) {
            self.flat_quad([from[i], from[j], to[j], to[i]]);
        }
    }

    /// Closes a ring that is convex, facing +Z or -Z.
    pub fn cap(&mut self, ring: &[Vec3], faces_back: bool) {
        let normal = if faces_back { Vec3::Z } else { Vec3::NEG_Z };
        for i in 1..ring.len().saturating_sub(1) {
            let [a, b, c] = if faces_back { [ring[0], ring[i], ring[i + 1]] } else { [ring[0], ring[i + 1], ring[i]] };
            self.quad([a, b, c, c], [normal; 4]);
        }
    }

    /// Adds a surface of revolution about the Z axis. The profile, of (radius, z), starts and ends on the axis, so that
    /// it encloses a volume; it faces outwards if it runs from -Z over the outside to +Z.
    pub fn lathe(&mut self, profile: &[(f32, f32)], sides: u32) {
        let points: Vec<Vec2> = profile.iter().map(|&(radius, z)| Vec2::new(radius, z)).collect();
        let normals: Vec<Vec2> = points
            .windows(2)
            .map(|pair| Vec2::new(pair[1].y - pair[0].y, pair[0].x - pair[1].x).normalize_or(Vec2::X))
            .collect();
        let smooth = |own: usize, other: Option<usize>| match other.and_then(|other| normals.get(other)) {
            Some(other) if other.dot(normals[own]) > SMOOTH_COSINE => (*other + normals[own]).normalize_or(Vec2::X),
            _ => normals[own],
        };
        for (segment, pair) in points.windows(2).enumerate() {
            let ends = [smooth(segment, segment.checked_sub(1)), smooth(segment, Some(segment + 1))];
            for side in 0..sides {
                let [this, next] = [side, (side + 1) % sides].map(|side| Vec2::from_angle(turn(side, sides)));
                let at = |around: Vec2, flat: Vec2| (around * flat.x).extend(flat.y);
                let corners = [at(this, pair[0]), at(next, pair[0]), at(next, pair[1]), at(this, pair[1])];
                let normals = [at(this, ends[0]), at(next, ends[0]), at(next, ends[1]), at(this, ends[1])];
                self.quad(corners, normals);
            }
        }
    }

    /// Adds a closed cone or cylinder between two points, with the radius at each.
    pub fn tube(&mut self, ends: [Vec3; 2], radii: [f32; 2], sides: u32) {
        let axis = (ends[1] - ends[0]).normalize_or(Vec3::Y);
        let (u, v) = crate::math::orthonormal_basis(axis);
        let ring = |end: usize| -> Vec<(Vec3, Vec3)> {
            let around = (0..sides).map(|side| Vec2::from_angle(turn(side, sides)));
            around.map(|around| u * around.x + v * around.y).map(|out| (ends[end] + out * radii[end], out)).collect()
        };
        let (low, high) = (ring(0), ring(1));
        for i in 0..sides as usize {
            let j = (i + 1) % sides as usize;
            let corners = [low[i], low[j], high[j], high[i]];
            self.quad(corners.map(|corner| corner.0), corners.map(|corner| corner.1));
            self.quad([low[0].0, low[j].0, low[i].0, low[i].0], [-axis; 4]);
            self.quad([high[0].0, high[i].0, high[j].0, high[j].0], [axis; 4]);
        }
    }

    /// Adds a box about a centre with three half axes, right-handed.
    pub fn cuboid(&mut self, centre: Vec3, [x, y, z]: [Vec3; 3]) {
        // Faces share the corners to the bit, so that the box is closed
        let corner = |i: usize| {
            let side = |bit: usize| if i >> bit & 1 == 0 { -1.0 } else { 1.0 };
            centre + x * side(0) + y * side(1) + z * side(2)
        };
        for face in [[4, 5, 7, 6], [1, 0, 2, 3], [0, 4, 6, 2], [5, 1, 3, 7], [6, 7, 3, 2], [0, 1, 5, 4]] {
            self.flat_quad(face.map(corner));
        }
    }
}

/// Returns the angle of a side of a regular polygon, radians.
pub(super) fn turn(side: u32, sides: u32) -> f32 {
    side as f32 / sides as f32 * TAU
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Returns six times the volume that a mesh encloses: positive if its front faces are outside.
    fn volume(mesh: &Mesh) -> f32 {
        (0..mesh.triangles.len()).map(|t| mesh.corners(t)).map(|[a, b, c]| a.dot(b.cross(c))).sum::<f32>() / 6.0
    }

    fn built(build: impl FnOnce(&mut Builder)) -> Mesh {
        let mut builder = Builder::default();
        builder.part("solid");
        build(&mut builder);
        builder.finish()
    }

    #[test]
    fn solids_are_closed_and_have_their_front_outside() {
        let (a, b) = (Vec3::new(0.3, 0.1, 0.2), Vec3::new(0.1, 1.1, 0.5));
        let ring = |size: f32, z: f32| -> Vec<Vec3> {
            [(-1.0, -1.0), (1.0, -1.0), (1.0, 1.0), (-1.0, 1.0)].map(|(x, y)| Vec3::new(size * x, size * y, z)).to_vec()
        };
        let length = (b - a).length();
        let prism = 0.5 * 12.0 * (TAU / 12.0).sin();
        for (name, mesh, expected) in [
            ("box", built(|b| b.cuboid(a, [Vec3::X * 0.5, Vec3::Y * 0.2, Vec3::Z * 0.1])), 0.08),
            ("tube", built(|build| build.tube([a, b], [0.1, 0.1], 12)), prism * 0.01 * length),
            ("lathe", built(|b| b.lathe(&[(0.0, 0.0), (0.5, 0.0), (0.5, 2.0), (0.0, 2.0)], 12)), prism * 0.25 * 2.0),
            (
                "prism",
                built(|b| {
                    b.cap(&ring(1.0, 0.0), false);
                    b.strip(&ring(1.0, 0.0), &ring(1.0, 3.0));
                    b.cap(&ring(1.0, 3.0), true);
                }),
                12.0,
            ),
        ] {
            assert!(mesh.is_closed(), "{name}");
            assert!((volume(&mesh) / expected - 1.0).abs() < 1e-4, "{name}: {} for {expected}", volume(&mesh));
            for triangle in &mesh.triangles {
                let [a, b, c] = triangle.map(|i| mesh.positions[i as usize]);
                let face = (b - a).cross(c - a);
                assert!(triangle.iter().all(|&i| face.dot(mesh.normals[i as usize]) > 0.0), "{name}");
            }
        }
    }
}

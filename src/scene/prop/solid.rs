//! Builds the meshes of props, upright: metres, +Y up, the front towards +Z.

use crate::scene::Mesh;
use crate::scene::body::builder::Builder;
use glam::{Vec2, Vec3};

/// Sides of turned solids.
const SIDES: u32 = 72;
/// Sides of rods and legs.
const ROD_SIDES: u32 = 20;
/// Ratio to a neighbour's length from which a segment of a profile is long.
const LONG_SEGMENT: f32 = 2.5;
/// Points between two of a smooth profile's.
const SMOOTH_STEPS: usize = 6;

/// A prop under construction. The builder's solids turn about its Z axis, which is up here.
#[derive(Debug, Default)]
pub(super) struct Solid {
    builder: Builder,
    turned: Vec<(std::ops::Range<usize>, Vec3)>,
}

impl Solid {
    /// Begins a part with a material.
    pub fn part(&mut self, name: &str) -> &mut Self {
        self.builder.part(name);
        self
    }

    /// Adds a solid of revolution about the vertical through a point of the floor. Its profile, of (radius, height),
    /// starts and ends on the axis, from the bottom over the outside to the top.
    pub fn turned_at(&mut self, place: Vec3, profile: &[(f32, f32)]) -> &mut Self {
        let first = self.builder.vertex_count();
        self.builder.lathe(&held(profile), SIDES);
        self.turned.push((first..self.builder.vertex_count(), place));
        self
    }

    /// Adds a solid of revolution about the vertical through the origin.
    pub fn turned(&mut self, profile: &[(f32, f32)]) -> &mut Self {
        self.turned_at(Vec3::ZERO, profile)
    }

    /// Adds a rod between two points.
    pub fn rod(&mut self, from: Vec3, to: Vec3, radius: f32) -> &mut Self {
        self.builder.tube([from, to].map(z_up), [radius; 2], ROD_SIDES);
        self
    }

    /// Adds a disc or a wheel between two points.
    pub fn wheel(&mut self, from: Vec3, to: Vec3, radius: f32) -> &mut Self {
        self.builder.tube([from, to].map(z_up), [radius; 2], SIDES);
        self
    }

    /// Adds a box of edges along the axes.
    pub fn slab(&mut self, centre: Vec3, size: Vec3) -> &mut Self {
        let half = [Vec3::X * size.x, Vec3::Y * size.y, Vec3::Z * size.z].map(|axis| z_up(axis * 0.5));
        self.builder.cuboid(z_up(centre), half);
        self
    }

    /// Adds a box with chamfered edges.
    pub fn chamfered(&mut self, centre: Vec3, size: Vec3, chamfer: f32) -> &mut Self {
        let c = chamfer;
        // Counter-clockwise as seen from above
        let ring = |inset: f32, height: f32| -> Vec<Vec3> {
            let (x, y) = (0.5 * size.x - inset, 0.5 * size.z - inset);
            let (cut_x, cut_y) = (x - c, y - c);
            let corners = [
                (x, -cut_y),
                (x, cut_y),
                (cut_x, y),
                (-cut_x, y),
                (-x, cut_y),
                (-x, -cut_y),
                (-cut_x, -y),
                (cut_x, -y),
            ];
            let to = Vec3::new(centre.x, -centre.z, centre.y + height);
            corners.map(|(x, y)| Vec3::new(x, y, 0.0) + to).to_vec()
        };
        let h = 0.5 * size.y;
        let rings = [ring(chamfer, -h), ring(0.0, chamfer - h), ring(0.0, h - chamfer), ring(chamfer, h)];
        self.builder.cap(&rings[0], false);
        for pair in rings.windows(2) {
            self.builder.strip(&pair[0], &pair[1]);
        }
        self.builder.cap(&rings[3], true);
        self
    }

    /// Adds an open sheet of cloth: a rectangle of half axes `u` and `v`, seen from both sides.
    pub fn sheet(&mut self, centre: Vec3, u: Vec3, v: Vec3) -> &mut Self {
        self.builder.flat_quad([centre - u - v, centre + u - v, centre + u + v, centre - u + v].map(z_up));
        self
    }

    /// Returns the mesh.
    pub fn finish(&mut self) -> Mesh {
        let mut mesh = std::mem::take(&mut self.builder).finish();
        mesh.positions.iter_mut().chain(&mut mesh.normals).for_each(|v| *v = Vec3::new(v.x, v.z, -v.y));
        for (vertices, place) in self.turned.drain(..) {
            mesh.positions[vertices].iter_mut().for_each(|position| *position += place);
        }
        mesh
    }
}

/// Returns a vector of upright coordinates in those of the builder, whose +Z is up.
fn z_up(v: Vec3) -> Vec3 {
    Vec3::new(v.x, -v.z, v.y)
}

/// Returns a profile with another point near the end of each segment that is much longer than its neighbour: its normals
/// then bend towards those of the neighbour there, and not along all of it.
fn held(profile: &[(f32, f32)]) -> Vec<(f32, f32)> {
    let point = |i: usize| Vec2::new(profile[i].0, profile[i].1);
    let length = |i: usize| (point(i + 1) - point(i)).length();
    let last = profile.len().saturating_sub(1);
    let mut points = Vec::new();
    for (i, start) in profile.iter().enumerate().take(last) {
        points.push(*start);
        let way = (point(i + 1) - point(i)).normalize_or_zero();
        let hold = |neighbour: f32| (length(i) > LONG_SEGMENT * neighbour).then_some(0.5 * neighbour);
        let from_start = i.checked_sub(1).and_then(|before| hold(length(before)));
        let from_end = (i + 1 < last).then(|| hold(length(i + 1))).flatten();
        let near_start = from_start.map(|distance| point(i) + way * distance);
        let near_end = from_end.map(|distance| point(i + 1) - way * distance);
        points.extend(near_start.into_iter().chain(near_end).map(|point| (point.x, point.y)));
    }
    points.extend(profile.last());
    points
}

/// Returns a profile that passes the points smoothly (Catmull and Rom 1974).
pub(super) fn smooth(points: &[(f32, f32)]) -> Vec<(f32, f32)> {
    let at = |i: usize| points.get(i).or(points.last()).map_or(Vec2::ZERO, |&(r, h)| Vec2::new(r, h));
    let mut profile = Vec::new();
    for (i, start) in points.iter().enumerate().take(points.len().saturating_sub(1)) {
        let [a, b, c, d] = [at(i.saturating_sub(1)), at(i), at(i + 1), at(i + 2)];
        for step in 0..SMOOTH_STEPS {
            let t = step as f32 / SMOOTH_STEPS as f32;
            let cubic = (b * 2.0)
                + (c - a) * t
                + (a * 2.0 - b * 5.0 + c * 4.0 - d) * (t * t)
                + (b * 3.0 - a - c * 3.0 + d) * (t * t * t);
            let point = cubic * 0.5;
            profile.push(if step == 0 { *start } else { (point.x.max(1e-5), point.y.max(0.0)) });
        }
    }
    profile.extend(points.last());
    profile
}

/// Returns smooth noise of mean 0 between -1 and 1, with details of a half, a quarter and an eighth of the size.
pub(super) fn noise(p: Vec3) -> f32 {
    let octave = |scale: f32| value_noise(p * scale + Vec3::splat(17.3 * scale)) / scale;
    (octave(1.0) + octave(2.0) + octave(4.0) + octave(8.0)) / 1.875
}

/// Returns random values at the points of a unit grid, interpolated, -1 to 1.
fn value_noise(p: Vec3) -> f32 {
    let cell = p.floor();
    let t = (p - cell) * (p - cell) * (Vec3::splat(3.0) - (p - cell) * 2.0);
    let corner = |x: i32, y: i32, z: i32| random(cell.x as i32 + x, cell.y as i32 + y, cell.z as i32 + z);
    let along = |y: i32, z: i32| corner(0, y, z) + (corner(1, y, z) - corner(0, y, z)) * t.x;
    let across = |z: i32| along(0, z) + (along(1, z) - along(0, z)) * t.y;
    across(0) + (across(1) - across(0)) * t.z
}

/// Returns a fixed random number between -1 and 1 for a point of the grid, by mixing its bits.
fn random(x: i32, y: i32, z: i32) -> f32 {
    let mut bits = (x as u32).wrapping_mul(0x9e37_79b1)
        ^ (y as u32).wrapping_mul(0x85eb_ca77)
        ^ (z as u32).wrapping_mul(0xc2b2_ae3d);
    bits = (bits ^ (bits >> 15)).wrapping_mul(0x2c1b_3c6d);
    bits = (bits ^ (bits >> 12)).wrapping_mul(0x297a_2d39);
    bits ^= bits >> 15;
    bits as f32 / u32::MAX as f32 * 2.0 - 1.0
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_long_wall_beside_a_bevel_has_its_own_normals_but_for_its_end() {
        // Normals that bent along all of the wall lifted rays off it by more than the gap to what it holds
        let profile = held(&[(0.0, 0.0), (0.9, 0.0), (1.0, 0.1), (1.0, 5.0), (0.0, 5.0)]);
        let bevel = 0.02_f32.sqrt();
        assert!(profile.iter().any(|&(r, h)| r == 1.0 && (h - (0.1 + 0.5 * bevel)).abs() < 1e-5), "{profile:?}");
        assert!(profile.iter().any(|&(r, h)| h == 0.0 && (r - (0.9 - 0.5 * bevel)).abs() < 1e-5), "{profile:?}");
        // Segments of like length stay
        let even = [(0.0, 0.0), (1.0, 0.0), (1.0, 1.0), (0.0, 1.0)];
        assert_eq!(held(&even), even);
    }
}

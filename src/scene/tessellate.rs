//! Tessellation of the parametric shapes, the same for all renderers.

use super::{Mesh, MeshPart, Room, Shape};
use glam::{Vec2, Vec3};
use std::f32::consts::{FRAC_PI_2, PI, TAU};

/// Segments around a sphere or cylinder: the outline deviates from the circle by 0.03 % of the radius.
const AROUND: u32 = 128;
/// Rows of a sphere from pole to pole.
const ROWS: u32 = 64;
/// Segments of a sweep's curve.
const CURVE: u32 = 48;

/// Returns the mesh of a parametric shape; `None` for shapes that are loaded or computed.
pub fn tessellate(shape: &Shape) -> Option<Mesh> {
    let mesh = match *shape {
        Shape::MeshFile { .. } | Shape::Figure(_) | Shape::Tank(_) => return None,
        Shape::Prop(model) => return Some(model.mesh()),
        Shape::Plane { width_m, depth_m } => quad(Vec3::ZERO, Vec3::X * width_m * 0.5, Vec3::NEG_Z * depth_m * 0.5),
        Shape::Box { size_m } => cuboid(Vec3::ZERO, size_m * 0.5),
        Shape::Sphere { radius_m } => sphere(radius_m),
        Shape::Cylinder { radius_m, height_m } => cylinder(radius_m, height_m),
        Shape::Sweep { width_m, height_m, depth_m, radius_m } => sweep(width_m, height_m, depth_m, radius_m),
        Shape::VFlat { wing_m, height_m, angle_deg } => v_flat(wing_m, height_m, angle_deg),
    };
    Some(mesh.with_single_part("surface"))
}

/// Offset of floor, walls and ceiling to the outside, metres, so that objects flush with them (paper on the floor, a
/// light in the ceiling) lie in front and do not z-fight.
pub const ROOM_STANDS_BACK_M: f32 = 2e-4;

/// Returns the mesh of a room, front faces inwards, with the parts `floor`, `walls` and `ceiling`.
pub fn room_mesh(room: &Room) -> Mesh {
    let middle = Vec3::Y * (room.size_m.y * 0.5);
    let h = room.size_m * 0.5 + ROOM_STANDS_BACK_M;
    let (x, y, z) = (Vec3::X * h.x, Vec3::Y * h.y, Vec3::Z * h.z);
    let mut mesh = quad(middle - y, x, -z).with_single_part("floor");
    let mut walls = quad(middle - z, x, y);
    for wall in [quad(middle + z, -x, y), quad(middle - x, -z, y), quad(middle + x, z, y)] {
        walls.append(&wall);
    }
    mesh.append(&walls.with_single_part("walls"));
    mesh.append(&quad(middle + y, x, z).with_single_part("ceiling"));
    mesh
}

/// Returns the rectangle of half axes `u` and `v`, facing u x v.
fn quad(centre: Vec3, u: Vec3, v: Vec3) -> Mesh {
    let normal = u.cross(v).try_normalize().unwrap_or(Vec3::Y);
    Mesh {
        positions: vec![centre - u - v, centre + u - v, centre + u + v, centre - u + v],
        normals: vec![normal; 4],
        uvs: vec![Vec2::ZERO, Vec2::X, Vec2::ONE, Vec2::Y],
        triangles: vec![[0, 1, 2], [0, 2, 3]],
        ..Mesh::default()
    }
}

fn cuboid(centre: Vec3, h: Vec3) -> Mesh {
    let (x, y, z) = (Vec3::X * h.x, Vec3::Y * h.y, Vec3::Z * h.z);
    let mut mesh = quad(centre + z, x, y);
    for (offset, u, v) in [(-z, -x, y), (x, -z, y), (-x, z, y), (y, x, -z), (-y, x, z)] {
        mesh.append(&quad(centre + offset, u, v));
    }
    mesh
}

/// Returns a grid of `(columns + 1) x (rows + 1)` vertices; `vertex` maps (column, row) fractions in 0..=1 to position
/// and normal. Front faces have columns to the right and rows upwards.
fn grid(columns: u32, rows: u32, vertex: impl Fn(f32, f32) -> (Vec3, Vec3)) -> Mesh {
    let mut mesh = Mesh::default();
    for row in 0..=rows {
        for column in 0..=columns {
            let uv = Vec2::new(column as f32 / columns as f32, row as f32 / rows as f32);
            let (position, normal) = vertex(uv.x, uv.y);
            mesh.positions.push(position);
            mesh.normals.push(normal);
            mesh.uvs.push(uv);
        }
    }
    for row in 0..rows {
        for column in 0..columns {
            let a = row * (columns + 1) + column;
            let (b, d) = (a + 1, a + columns + 1);
            mesh.triangles.extend([[a, b, d + 1], [a, d + 1, d]]);
        }
    }
    mesh
}

/// Returns the direction at a fraction of a turn (0..=1) about Y; both ends are equal to the bit.
fn around(turn: f32) -> Vec3 {
    let angle = if turn >= 1.0 { 0.0 } else { turn * TAU };
    Vec3::new(angle.sin(), 0.0, angle.cos())
}

fn sphere(radius: f32) -> Mesh {
    let mut mesh = grid(AROUND, ROWS, |u, v| {
        let latitude = (v - 0.5) * PI;
        // The cosine is exactly 0 at the poles, so that their vertices coincide and the mesh is closed.
        let cos = if v == 0.0 || v == 1.0 { 0.0 } else { latitude.cos() };
        let normal = around(u) * cos + Vec3::Y * latitude.sin();
        (normal * radius, normal)
    });
    // Remove the zero-area triangle of each quad at a pole.
    let mesh_positions = &mesh.positions;
    mesh.triangles.retain(|t| {
        let [a, b, c] = t.map(|i| mesh_positions[i as usize]);
        a != b && b != c && c != a
    });
    mesh
}

fn cylinder(radius: f32, height: f32) -> Mesh {
    let half = height * 0.5;
    let mut mesh = grid(AROUND, 1, |u, v| {
        let normal = around(u);
        (normal * radius + Vec3::Y * (2.0 * v - 1.0) * half, normal)
    });
    for side in [1.0_f32, -1.0] {
        mesh.append(&disc(radius, side * half, Vec3::Y * side));
    }
    mesh
}

fn disc(radius: f32, y: f32, normal: Vec3) -> Mesh {
    let mut mesh =
        Mesh { positions: vec![Vec3::Y * y], normals: vec![normal], uvs: vec![Vec2::splat(0.5)], ..Mesh::default() };
    for i in 0..AROUND {
        let direction = around(i as f32 / AROUND as f32);
        mesh.positions.push(direction * radius + Vec3::Y * y);
        mesh.normals.push(normal);
        mesh.uvs.push(Vec2::new(0.5 + 0.5 * direction.x, 0.5 - 0.5 * direction.z));
        let (a, b) = (1 + i, 1 + (i + 1) % AROUND);
        mesh.triangles.push(if normal.y > 0.0 { [0, a, b] } else { [0, b, a] });
    }
    mesh
}

/// Returns the two boards of a V-flat, which face each other.
fn v_flat(wing: f32, height: f32, angle_deg: f32) -> Mesh {
    let (sin, cos) = (0.5 * angle_deg.to_radians()).sin_cos();
    let [left, right] = [-1.0, 1.0].map(|side| Vec3::new(side * sin, 0.0, cos) * (0.5 * wing));
    let up = Vec3::Y * (0.5 * height);
    // The edge is the right end of the left board, and the left end of the right one
    let mut mesh = quad(left, -left, up);
    mesh.append(&quad(right, right, up));
    mesh
}

/// Returns the surface of a profile from the front edge of the floor over the curve to the top of the wall.
fn sweep(width: f32, height: f32, depth: f32, radius: f32) -> Mesh {
    let radius = radius.min(height).min(depth).max(0.0);
    let mut profile = vec![(Vec3::new(0.0, 0.0, depth), Vec3::Y)];
    for i in 0..=CURVE {
        let (sin, cos) = (i as f32 / CURVE as f32 * FRAC_PI_2).sin_cos();
        profile.push((Vec3::new(0.0, radius * (1.0 - cos), radius * (1.0 - sin)), Vec3::new(0.0, cos, sin)));
    }
    profile.push((Vec3::new(0.0, height, 0.0), Vec3::Z));
    let rows = profile.len() as u32 - 1;
    let mut mesh = grid(1, rows, |u, v| {
        let (point, normal) = profile[(v * rows as f32).round() as usize];
        (point + Vec3::X * (u - 0.5) * width, normal)
    });
    let lengths: Vec<f32> = profile
        .windows(2)
        .scan(0.0, |sum, pair| {
            *sum += (pair[1].0 - pair[0].0).length();
            Some(*sum)
        })
        .collect();
    let total = lengths.last().copied().unwrap_or(1.0).max(f32::MIN_POSITIVE);
    for (i, uv) in mesh.uvs.iter_mut().enumerate() {
        let row = i / 2;
        uv.y = if row == 0 { 0.0 } else { lengths[row - 1] / total };
    }
    mesh
}

impl MeshPart {
    /// Returns a part with this name and these triangles.
    pub fn new(name: &str, triangles: std::ops::Range<u32>) -> Self {
        MeshPart { name: name.to_owned(), triangles }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Signed volume by the divergence theorem.
    fn volume(mesh: &Mesh) -> f32 {
        (0..mesh.triangles.len()).map(|t| mesh.corners(t)).map(|[a, b, c]| a.dot(b.cross(c)) / 6.0).sum()
    }

    fn winding_agrees_with_normals(mesh: &Mesh) {
        for (i, t) in mesh.triangles.iter().enumerate() {
            let [a, b, c] = mesh.corners(i);
            let face = (b - a).cross(c - a);
            for k in t {
                assert!(face.dot(mesh.normals[*k as usize]) > 0.0, "triangle {i} winds against its normal");
            }
        }
    }

    #[test]
    fn solids_are_closed_outward_and_have_their_volume() {
        for (shape, expected) in [
            (Shape::Box { size_m: Vec3::new(1.0, 2.0, 3.0) }, 6.0),
            (Shape::Sphere { radius_m: 0.5 }, 4.0 / 3.0 * PI * 0.125),
            (Shape::Cylinder { radius_m: 0.5, height_m: 2.0 }, PI * 0.5),
        ] {
            let mesh = tessellate(&shape).unwrap();
            winding_agrees_with_normals(&mesh);
            // 128 segments lose about 0.1 % of a round solid.
            assert!((volume(&mesh) / expected - 1.0).abs() < 2e-3, "{shape:?}: {}", volume(&mesh));
        }
    }

    #[test]
    fn sheets_face_their_documented_direction() {
        let plane = tessellate(&Shape::Plane { width_m: 2.0, depth_m: 1.0 }).unwrap();
        winding_agrees_with_normals(&plane);
        assert_eq!(plane.normals[0], Vec3::Y);
        let v_flat = tessellate(&Shape::VFlat { wing_m: 1.2, height_m: 2.4, angle_deg: 60.0 }).unwrap();
        winding_agrees_with_normals(&v_flat);
        let (low, high) = v_flat.bounds();
        assert!((low - Vec3::new(-0.6, -1.2, 0.0)).length() < 1e-6, "{low}");
        assert!((high - Vec3::new(0.6, 1.2, 1.2 * 0.75_f32.sqrt())).length() < 1e-6, "{high}");
        assert!(v_flat.normals[0].x > 0.8 && v_flat.normals[4].x < -0.8, "the boards face each other");
        let sweep = Shape::Sweep { width_m: 2.72, height_m: 3.0, depth_m: 4.0, radius_m: 0.8 };
        let sweep = tessellate(&sweep).unwrap();
        winding_agrees_with_normals(&sweep);
        assert_eq!(sweep.bounds(), (Vec3::new(-1.36, 0.0, 0.0), Vec3::new(1.36, 3.0, 4.0)));
    }

    #[test]
    fn the_room_faces_inwards() {
        let mesh = room_mesh(&Room::default());
        winding_agrees_with_normals(&mesh);
        let expected = -(Room::default().size_m + 2.0 * ROOM_STANDS_BACK_M).element_product();
        // The volume about a point of the floor: a closed surface that faces inwards.
        assert!((volume(&mesh) / expected - 1.0).abs() < 1e-5);
        assert_eq!(mesh.parts.len(), 3);
    }
}

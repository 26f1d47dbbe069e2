//! Writes figures as OBJ text, the files in `assets/mannequins`.

use crate::scene::Mesh;
use std::fmt::Write;

/// Returns OBJ text with a group for each part, positions rounded to 0.01 mm. Readers compute the normals
/// (`Mesh::compute_smooth_normals`): the triangles are even and small, and the file is half as long.
pub fn to_obj(mesh: &Mesh) -> String {
    let mut text = String::with_capacity(mesh.positions.len() * 28 + mesh.triangles.len() * 21);
    text.push_str("# Catchlight mannequin: metres, Y up, looks along +Z. Made by `catchlight bake-mannequins`.\n");
    let mut written = 0;
    for part in &mesh.parts {
        let triangles = &mesh.triangles[part.triangles.start as usize..part.triangles.end as usize];
        // The vertices of each part follow those of the part before.
        let end = triangles.iter().flatten().map(|&i| i as usize + 1).max().unwrap_or(written).max(written);
        put(&mut text, format_args!("g {}\n", part.name));
        for p in &mesh.positions[written..end] {
            let [x, y, z] = p.to_array().map(rounded);
            put(&mut text, format_args!("v {x:.5} {y:.5} {z:.5}\n"));
        }
        written = end;
        for [a, b, c] in triangles.iter().map(|t| t.map(|i| i + 1)) {
            put(&mut text, format_args!("f {a} {b} {c}\n"));
        }
    }
    text
}

fn put(text: &mut String, line: std::fmt::Arguments) {
    // Writing to a string cannot fail.
    let _ = text.write_fmt(line);
}

/// Replaces values that round to zero by zero, which has no minus sign.
fn rounded(x: f32) -> f32 {
    if x.abs() < 0.5e-5 { 0.0 } else { x }
}

#[cfg(test)]
mod tests {
    use super::*;
    use glam::Vec3;

    #[test]
    fn each_part_is_a_group_with_its_own_vertices() {
        let triangle = |x: f32| Mesh {
            positions: vec![Vec3::new(x, -1e-9, 0.0), Vec3::X, Vec3::Y],
            triangles: vec![[0, 1, 2]],
            ..Mesh::default()
        };
        let mut mesh = triangle(0.125).with_single_part("skin");
        mesh.append(&triangle(0.5).with_single_part("eyes"));
        let text = to_obj(&mesh);
        let lines: Vec<&str> = text.lines().skip(1).collect();
        assert_eq!(lines[..2], ["g skin", "v 0.12500 0.00000 0.00000"]);
        assert_eq!(lines[4..7], ["f 1 2 3", "g eyes", "v 0.50000 0.00000 0.00000"]);
        assert_eq!(lines[9], "f 4 5 6");
    }
}

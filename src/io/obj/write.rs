//! Writes a mesh as an OBJ file, for a model whose file no longer exists.

use crate::scene::{Mesh, MeshPart};
use std::fmt::Write;

/// Returns the text of an OBJ file with the mesh's vertices and parts. The materials of parts are the scene's.
pub(in crate::io) fn write(mesh: &Mesh) -> String {
    let mut text = String::from("# Written by Catchlight: the imported file was gone when the studio was saved.\n");
    // Writing to a string can't fail.
    let mut line = |arguments: std::fmt::Arguments<'_>| {
        let _ = writeln!(text, "{arguments}");
    };
    mesh.positions.iter().for_each(|p| line(format_args!("v {} {} {}", p.x, p.y, p.z)));
    mesh.uvs.iter().for_each(|uv| line(format_args!("vt {} {}", uv.x, uv.y)));
    mesh.normals.iter().for_each(|n| line(format_args!("vn {} {} {}", n.x, n.y, n.z)));
    let corner = |vertex: u32| {
        let vertex = u64::from(vertex) + 1;
        match (mesh.uvs.is_empty(), mesh.normals.is_empty()) {
            (true, true) => format!("{vertex}"),
            (false, true) => format!("{vertex}/{vertex}"),
            (true, false) => format!("{vertex}//{vertex}"),
            (false, false) => format!("{vertex}/{vertex}/{vertex}"),
        }
    };
    for MeshPart { name, triangles } in &mesh.parts {
        line(format_args!("g {name}"));
        for triangle in mesh.triangles.get(triangles.start as usize..triangles.end as usize).unwrap_or_default() {
            let [a, b, c] = triangle.map(corner);
            line(format_args!("f {a} {b} {c}"));
        }
    }
    text
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::io::importers::import_model;
    use glam::{Vec2, Vec3};

    #[test]
    fn a_written_mesh_is_read_back_with_its_parts() {
        let quad = [Vec3::ZERO, Vec3::X * 0.1, Vec3::new(1.0 / 3.0, 1e-7, 0.0), Vec3::new(0.0, 2e5, 0.0)];
        let mut mesh = Mesh {
            positions: quad.to_vec(),
            normals: vec![Vec3::Z; 4],
            uvs: quad.map(|p| Vec2::new(p.x, 0.3)).to_vec(),
            triangles: vec![[0, 1, 2], [0, 2, 3]],
            parts: vec![
                MeshPart { name: "a cup".to_owned(), triangles: 0..1 },
                MeshPart { name: "its rim".to_owned(), triangles: 1..2 },
            ],
            ..Mesh::default()
        };
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("cup.obj");
        for _ in 0..3 {
            std::fs::write(&path, write(&mesh)).unwrap();
            let read = import_model(&path).unwrap().mesh;
            assert_eq!(read.parts, mesh.parts);
            for (ours, theirs) in mesh.triangles.iter().flatten().zip(read.triangles.iter().flatten()) {
                let [ours, theirs] = [*ours, *theirs].map(|vertex| vertex as usize);
                assert_eq!(mesh.positions[ours], read.positions[theirs]);
                assert_eq!(mesh.uvs.get(ours), read.uvs.get(theirs));
                assert_eq!(mesh.normals.get(ours), read.normals.get(theirs).filter(|_| !mesh.normals.is_empty()));
            }
            // Next without texture coordinates, then without normals, too, which reading computes.
            if mesh.uvs.is_empty() {
                mesh.normals.clear();
            }
            mesh.uvs.clear();
        }
    }
}

use super::*;
use crate::io::importers::import_model;
use crate::scene::{MeshPart, TextureRef};
use glam::Vec2;
use std::path::PathBuf;

fn folder_with(files: &[(&str, &str)]) -> (tempfile::TempDir, PathBuf) {
    let folder = tempfile::tempdir().unwrap();
    for (name, text) in files {
        std::fs::write(folder.path().join(name), text).unwrap();
    }
    let path = folder.path().join(files[0].0);
    (folder, path)
}

fn import(text: &str) -> Result<ImportedModel, AssetError> {
    let (_folder, path) = folder_with(&[("a.obj", text)]);
    import_model(&path)
}

const QUAD: &str = "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\n";

#[test]
fn a_quad_becomes_two_triangles_with_normals() {
    let imported = import(&format!("{QUAD}f 1 2 3 4\n")).unwrap();
    assert_eq!(imported.mesh.triangles, [[0, 1, 2], [0, 2, 3]]);
    assert_eq!(imported.mesh.normals, [Vec3::Z; 4]);
    assert_eq!(imported.mesh.parts, [MeshPart::new("surface", 0..2)]);
    assert_eq!(imported.warnings, [""; 0]);
}

#[test]
fn a_byte_order_mark_and_continued_lines_are_read() {
    // Regression: the first vertex was lost behind the mark, and a polygon on two lines was refused.
    let imported = import(&format!("\u{feff}{QUAD}f 1 2 \\\n3 4\n")).unwrap();
    assert_eq!((imported.mesh.positions.len(), imported.mesh.triangles.len()), (4, 2));
    let error = import(&format!("{QUAD}f 1 2 \\\n3 4\nf 1 2 9\n")).unwrap_err().to_string();
    assert!(error.contains("line 7: the face names vertex 9"), "{error}");
}

#[test]
fn a_word_of_ten_megabytes_makes_a_short_message() {
    let error = import(&format!("v {} 0 0\n", "x".repeat(10_000_000))).unwrap_err().to_string();
    assert!(error.len() < 500 && error.contains("is no number"), "{} bytes", error.len());
}

#[test]
fn relative_and_forward_indices_are_resolved() {
    assert_eq!(import(&format!("f 1 2 3\n{QUAD}f -4 -3 -2\n")).unwrap().mesh.triangles.len(), 2);
}

#[test]
fn groups_become_parts_with_their_materials() {
    let obj =
        format!("mtllib a.mtl\n{QUAD}vt 0 0\no body\nusemtl red\nf 1/1 2/1 3/1\no eyes\nusemtl glass\nf 1/1 3/1 4/1\n");
    let mtl = "newmtl red\nKd 1 0 0\nmap_Kd -s 1 1 1 red.png\nNs 98\nnewmtl glass\nKd 0.5\nd 0.1\nNi 1.52\n";
    let (_folder, path) = folder_with(&[("a.obj", &obj), ("a.mtl", mtl)]);
    let imported = import_model(&path).unwrap();
    let names: Vec<&str> = imported.mesh.parts.iter().map(|p| p.name.as_str()).collect();
    assert_eq!(names, ["body", "eyes"]);
    assert_eq!(imported.mesh.uvs.len(), imported.mesh.positions.len());
    let [(_, red), (_, glass)] = &imported.part_materials[..] else { panic!("{:?}", imported.part_materials) };
    assert_eq!(red.base_color, [0.95, 0.0, 0.0]);
    assert_eq!(red.textures.base_color, Some(TextureRef::file("red.png")));
    assert!((red.roughness - 0.02_f32.powf(0.25)).abs() < 1e-6);
    assert_eq!((glass.ior, glass.transmission), (1.52, 0.9));
}

#[test]
fn a_missing_material_library_is_a_warning() {
    let imported = import(&format!("mtllib none.mtl\n{QUAD}usemtl x\nf 1 2 3\n")).unwrap();
    assert_eq!(imported.warnings.len(), 1, "{:?}", imported.warnings);
    let imported = import(&format!("mtllib ../../etc/passwd\n{QUAD}f 1 2 3\n")).unwrap();
    assert!(imported.warnings[0].contains("must not lead out"), "{:?}", imported.warnings);
}

#[test]
fn errors_name_the_line() {
    for (faces, words) in [
        ("f 1 2 9", "line 5: the face names vertex 9, but there are 4"),
        ("f 1 2 -9", "line 5: the face's corner \"-9\" points to before the first"),
        ("f 1/9223372036854775807 2 3", "line 5"),
        ("f 1/-9223372036854775808 2 3", "line 5"),
        (
            "f 1/-999999999999999999 2 3",
            "line 5: the face's corner \"1/-999999999999999999\" points to before the first",
        ),
        ("f 1/ 2/- 3", "line 5: the face's corner \"2/-\" is no index"),
        ("f 1//5 2 3", "line 5: the face names normal 5, but there are 0"),
        ("f 0 1 2", "indices begin at 1"),
        ("f 1 2 x", "is no index"),
        ("f /1 /2 /3", "names no vertex"),
        ("f 1/1/1/1 2 3", "too many parts"),
        ("f", "polygon"),
        ("", "no faces"),
        ("v 1e20 0 0\nf 1 2 5", "not within"),
        ("v nan 0 0\nf 1 2 5", "not within"),
        ("v 1 x 0\nf 1 2 3", "line 5: the position's \"x\" is no number"),
        ("v 1 2\nf 1 2 3", "line 5: the position has fewer than 3 numbers"),
        ("v 1 2 3 0\nf 1 2 3", "line 5: the position's fourth number"),
        ("v 1 2 3 1 1\nf 1 2 3", "line 5: the position has neither 3, 4 nor 6 numbers"),
        ("vt 1\nf 1 2 3", "line 5: the texture coordinate has fewer than 2 numbers"),
        ("vn 1 0 .\nf 1 2 3", "line 5: the normal's \".\" is no number"),
        ("usemtl\nf 1 2 3", "line 5: it names no material"),
    ] {
        let error = import(&format!("{QUAD}{faces}\n")).unwrap_err().to_string();
        assert!(error.contains(words) && error.ends_with("a.obj"), "{faces:?}: {error}");
    }
}

#[test]
fn normals_without_direction_are_recomputed() {
    let imported = import(&format!("{QUAD}vn 0 0 0\nf 1//1 2//1 3//1\n")).unwrap();
    assert_eq!(imported.mesh.normals, [Vec3::Z; 3]);
    assert_eq!(imported.warnings.len(), 1);
}

#[test]
fn computed_normals_are_smooth_across_texture_seams() {
    // A flat tent whose ridge has two texture coordinates: its normal is the mean of both sides.
    let tent = "v -1 0 0\nv -1 0 1\nv 0 0.2 0\nv 0 0.2 1\nv 1 0 0\nv 1 0 1\nvt 0 0\nvt 1 1\n\
        f 1/1 2/1 4/1 3/1\nf 3/2 4/2 6/2 5/2\n";
    let mesh = import(tent).unwrap().mesh;
    let ridge: Vec<Vec3> =
        (0..mesh.positions.len()).filter(|&i| mesh.positions[i].y == 0.2).map(|i| mesh.normals[i]).collect();
    assert_eq!(ridge.len(), 4);
    assert!(ridge.iter().all(|n| (*n - Vec3::Y).length() < 1e-6), "{ridge:?}");
}

#[test]
fn a_truncated_file_is_an_error_or_a_smaller_model() {
    let whole = format!("{QUAD}vt 0 0\nvn 0 0 1\nf 1/1/1 2/1/1 3/1/1 4/1/1\n");
    for end in 0..whole.len() {
        let _ = import(&whole[..end]);
    }
}

/// Returns a model of several chunks: a strip of quads, every third with relative indices, in groups that share
/// corners.
fn long_model(quads: usize) -> String {
    let mut text = "# a strip\r\nv 0 0 0\r\nv 0 0 1\r\nvt 0 0\r\nvn 0 1 0\r\n".to_owned();
    for i in (1_i32..).take(quads) {
        if i % 1000 == 1 {
            text += &format!("g group {}\r\n", i / 1000);
        }
        text += &format!("v {i} 0 0\r\nv {i} 0 1\r\nvt {i} 0.5\r\n");
        let corners = if i % 3 == 0 { [-4, -3, -1, -2] } else { [2 * i - 1, 2 * i, 2 * i + 2, 2 * i + 1] };
        let corners = corners.map(|n| format!("{n}/{}/1", if n < 0 { -1 } else { i + 1 }));
        text += &format!("f {}\r\n", corners.join(" "));
    }
    text
}

#[test]
fn a_model_of_several_chunks_is_parsed_completely() {
    let quads = 40_000;
    let text = long_model(quads);
    assert!(text.len() > 3 << 20, "too few chunks");
    let mesh = import(&text).unwrap().mesh;
    assert_eq!(mesh.triangles.len(), 2 * quads);
    assert_eq!(mesh.parts.len(), 40);
    assert_eq!(mesh.parts[39], MeshPart::new("group 39", 78_000..80_000));
    // Each quad has a texture coordinate of its own, and so four vertices.
    assert_eq!(mesh.positions.len(), 4 * quads);
    for (t, triangle) in mesh.triangles.iter().enumerate() {
        let i = (t / 2) as f32;
        let corners = mesh.corners(t);
        let expected = [[i, i, i + 1.0], [i, i + 1.0, i + 1.0]][t % 2];
        assert_eq!(corners.map(|p| p.x), expected, "triangle {t}");
        assert!(triangle.iter().all(|&k| mesh.uvs[k as usize] == Vec2::new(i + 1.0, 0.5)), "triangle {t}");
    }
}

#[test]
fn the_first_error_of_a_long_file_is_reported_with_its_line() {
    let mut lines: Vec<String> = long_model(60_000).lines().map(str::to_owned).collect();
    lines[200_000] = "f 1 2 x".to_owned();
    lines[150_000] = "v 1 2".to_owned();
    let error = import(&lines.join("\n")).unwrap_err().to_string();
    assert!(error.contains("line 150001: the position"), "{error}");
}

#[test]
fn lines_and_points_make_no_triangles() {
    let imported = import(&format!("{QUAD}l 1 2 3 4\np 1\nf 1 2\nf 1\nf 1 2 3\n")).unwrap();
    assert_eq!(imported.mesh.triangles, [[0, 1, 2]]);
}

#[test]
fn vertex_colours_are_skipped_and_weights_divide() {
    let text = "v 0 0 0 1 0 0\nv 2 0 0 2\nv 0 1 0\nf 1 2 3\n";
    assert_eq!(import(text).unwrap().mesh.positions, [Vec3::ZERO, Vec3::X, Vec3::Y]);
}

#[test]
fn a_material_library_is_read_once_however_often_it_is_named() {
    let named = "mtllib none.mtl\n".repeat(1000);
    let imported = import(&format!("{named}{QUAD}f 1 2 3\n")).unwrap();
    assert_eq!(imported.warnings.len(), 1);
}

#[test]
fn the_mesh_equals_that_of_tobj() {
    let text = long_model(5000);
    let (models, _) =
        tobj::load_obj_buf(&mut text.as_bytes(), &tobj::GPU_LOAD_OPTIONS, |_| Ok(Default::default())).unwrap();
    let mesh = import(&text).unwrap().mesh;
    let flat =
        |field: fn(&tobj::Mesh) -> &[f32]| models.iter().flat_map(|m| field(&m.mesh)).copied().collect::<Vec<f32>>();
    assert_eq!(mesh.positions.iter().flat_map(|p| p.to_array()).collect::<Vec<f32>>(), flat(|m| &m.positions));
    assert_eq!(mesh.uvs.iter().flat_map(|uv| uv.to_array()).collect::<Vec<f32>>(), flat(|m| &m.texcoords));
    let mut base = 0;
    let mut triangles = Vec::new();
    for model in &models {
        triangles.extend(model.mesh.indices.chunks_exact(3).map(|t| [t[0] + base, t[1] + base, t[2] + base]));
        base += mesh_index::to_index(model.mesh.positions.len()) / 3;
    }
    assert_eq!(mesh.triangles, triangles);
}

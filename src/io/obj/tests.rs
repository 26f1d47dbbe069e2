use super::*;
use std::path::PathBuf;

fn folder_with(files: &[(&str, &str)]) -> (tempfile::TempDir, PathBuf) {
    let folder = tempfile::tempdir().unwrap();
    for (name, text) in files {
        std::fs::write(folder.path().join(name), text).unwrap();
    }
    let path = folder.path().join(files[0].0);
    (folder, path)
}

fn import(text: &str) -> Result<ImportedObj, AssetError> {
    let (_folder, path) = folder_with(&[("a.obj", text)]);
    import_obj(&path)
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
fn relative_and_forward_indices_are_fine() {
    assert_eq!(import(&format!("f 1 2 3\n{QUAD}f -4 -3 -2\n")).unwrap().mesh.triangles.len(), 2);
}

#[test]
fn groups_become_parts_and_materials_follow() {
    let obj =
        format!("mtllib a.mtl\n{QUAD}vt 0 0\no body\nusemtl red\nf 1/1 2/1 3/1\no eyes\nusemtl glass\nf 1/1 3/1 4/1\n");
    let mtl = "newmtl red\nKd 1 0 0\nmap_Kd -s 1 1 1 red.png\nNs 98\nnewmtl glass\nKd 0.5\nd 0.1\nNi 1.52\n";
    let (_folder, path) = folder_with(&[("a.obj", &obj), ("a.mtl", mtl)]);
    let imported = import_obj(&path).unwrap();
    let names: Vec<&str> = imported.mesh.parts.iter().map(|p| p.name.as_str()).collect();
    assert_eq!(names, ["body", "eyes"]);
    assert_eq!(imported.mesh.uvs.len(), imported.mesh.positions.len());
    let [(_, red), (_, glass)] = &imported.part_materials[..] else { panic!("{:?}", imported.part_materials) };
    assert_eq!(red.base_color, [0.95, 0.0, 0.0]);
    assert_eq!(red.base_color_texture.as_deref(), Some("red.png"));
    assert!((red.roughness - 0.02_f32.powf(0.25)).abs() < 1e-6);
    assert_eq!((glass.ior, glass.transmission), (1.52, 0.9));
}

#[test]
fn a_missing_library_is_a_warning() {
    let imported = import(&format!("mtllib none.mtl\n{QUAD}usemtl x\nf 1 2 3\n")).unwrap();
    assert_eq!(imported.warnings.len(), 1, "{:?}", imported.warnings);
    let imported = import(&format!("mtllib ../../etc/passwd\n{QUAD}f 1 2 3\n")).unwrap();
    assert!(imported.warnings[0].contains("must not lead out"), "{:?}", imported.warnings);
}

#[test]
fn mistakes_are_named_with_their_line() {
    for (faces, words) in [
        ("f 1 2 9", "line 5: the face names vertex 9, but there are 4"),
        ("f 1 2 -9", "line 5: the face's corner \"-9\" points to before the first"),
        ("f 1/9223372036854775807 2 3", "line 5"),
        ("f 1/-9223372036854775808 2 3", "line 5"),
        ("f 1//5 2 3", "line 5: the face names normal 5, but there are 0"),
        ("f 0 1 2", "indices begin at 1"),
        ("f 1 2 x", "is no index"),
        ("f /1 /2 /3", "names no vertex"),
        ("f 1/1/1/1 2 3", "too many parts"),
        ("f", "polygon"),
        ("", "no faces"),
        ("v 1e20 0 0\nf 1 2 5", "not within"),
        ("v nan 0 0\nf 1 2 5", "not within"),
        ("v 1 x 0\nf 1 2 3", "position"),
    ] {
        let error = import(&format!("{QUAD}{faces}\n")).unwrap_err().to_string();
        assert!(error.contains(words) && error.ends_with("a.obj"), "{faces:?}: {error}");
    }
}

#[test]
fn bad_normals_are_computed_anew() {
    let imported = import(&format!("{QUAD}vn 0 0 0\nf 1//1 2//1 3//1\n")).unwrap();
    assert_eq!(imported.mesh.normals, [Vec3::Z; 3]);
    assert_eq!(imported.warnings.len(), 1);
}

#[test]
fn computed_normals_do_not_see_texture_seams() {
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
fn a_cut_file_is_an_error_or_a_smaller_model() {
    let whole = format!("{QUAD}vt 0 0\nvn 0 0 1\nf 1/1/1 2/1/1 3/1/1 4/1/1\n");
    for end in 0..whole.len() {
        let _ = import(&whole[..end]);
    }
}

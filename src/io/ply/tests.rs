//! Tests of PLY models.

use super::*;

const LIMITS: ModelLimits = ModelLimits { file_bytes: 1 << 20, triangles: 12 };
/// A pyramid of a square and four triangles, with colours; an element and a property that are not read.
const TEXT: &str = "ply\nformat ascii 1.0\ncomment by hand\nelement vertex 5\nproperty float x\nproperty float y\nproperty \
                    double z\nproperty uchar red\nproperty uchar green\nproperty uchar blue\nelement edge 1\nproperty \
                    int a\nproperty list uchar short b\nelement face 5\nproperty uchar quality\nproperty list uchar int \
                    vertex_indices\nend_header\n-1 0 -1 255 0 0\n1 0 -1 255 0 0\n1 0 1 255 0 0\n-1 0 1 255 0 0\n0 1 0 \
                    188 188 188\n7\n2 8 9\n1 4 0 1 2 3\n1 3 1 0 4\n1 3 2 1 4\n1 3 3 2 4\n1 3 0 3 4\n";

fn imported(content: &[u8]) -> Result<ImportedModel, String> {
    let file = tempfile::NamedTempFile::new().unwrap();
    std::fs::write(file.path(), content).unwrap();
    import(file.path(), &LIMITS, &LoadProgress::default()).map_err(|error| error.to_string())
}

/// Returns the text as a binary file.
fn binary(name: &str) -> Vec<u8> {
    let is_big = name.contains("big");
    let end = TEXT.find("end_header\n").unwrap() + "end_header\n".len();
    let mut bytes = TEXT[..end].replace("ascii", name).into_bytes();
    let mut put = |mut number: Vec<u8>| {
        if is_big {
            number.reverse();
        }
        bytes.extend(number);
    };
    for (row, line) in TEXT[end..].lines().enumerate() {
        for (column, word) in line.split(' ').enumerate() {
            put(match (row, column) {
                (0..5, 0 | 1) => word.parse::<f32>().unwrap().to_le_bytes().to_vec(),
                (0..5, 2) => word.parse::<f64>().unwrap().to_le_bytes().to_vec(),
                (5, _) => word.parse::<i32>().unwrap().to_le_bytes().to_vec(),
                (6, 1..) => word.parse::<i16>().unwrap().to_le_bytes().to_vec(),
                (7.., 2..) => word.parse::<i32>().unwrap().to_le_bytes().to_vec(),
                _ => vec![word.parse().unwrap()],
            });
        }
    }
    bytes
}

#[test]
fn text_and_both_byte_orders_are_the_same_closed_model_with_its_colours() {
    let text = imported(TEXT.as_bytes()).unwrap();
    for name in ["binary_little_endian", "binary_big_endian"] {
        assert_eq!(imported(&binary(name)).unwrap(), text, "{name}");
    }
    let mesh = &text.mesh;
    assert_eq!((mesh.triangles.len(), mesh.is_closed(), text.part_materials.len()), (6, true, 1));
    assert_eq!(mesh.bounds(), (Vec3::new(-1.0, 0.0, -1.0), Vec3::ONE));
    let volume: f32 = (0..6).map(|t| mesh.corners(t)).map(|[a, b, c]| a.dot(b.cross(c)) / 6.0).sum();
    assert!((volume - 4.0 / 3.0).abs() < 1e-5, "{volume}");
    // 188 of 255 is a half of the light
    for (position, color) in mesh.positions.iter().zip(&mesh.colors) {
        let expected = if position.y > 0.5 { Vec3::splat(0.5029) } else { Vec3::X };
        assert!(color.distance(expected) < 1e-3, "{color} at {position}");
    }
    assert_eq!(mesh.colors.len(), mesh.normals.len());
}

#[test]
fn normals_and_texture_coordinates_of_the_file_are_kept() {
    let head = "ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float y\nproperty float z\nproperty \
                float nx\nproperty float ny\nproperty float nz\nproperty float s\nproperty float t\nelement face \
                1\nproperty list uchar uint vertex_index\nend_header\n";
    let rows = "0 0 0 0 0 2 0 0\n1 0 0 0 0 2 1 0\n0 1 0 0 0 2 0 1\n3 0 1 2\n";
    let model = imported(format!("{head}{rows}").as_bytes()).unwrap();
    assert_eq!(model.mesh.normals, [Vec3::Z; 3]);
    assert_eq!((model.mesh.uvs[1], model.part_materials.len()), (Vec2::X, 0));
    // More vertices without them
    let more = "element vertex 1\nproperty float x\nproperty float y\nproperty float z\nend_header\n";
    let model = imported(format!("{}{rows}5 5 5\n", head.replace("end_header\n", more)).as_bytes()).unwrap();
    assert!(model.mesh.uvs.is_empty() && model.mesh.normals.len() == model.mesh.positions.len());
}

#[test]
fn damaged_files_are_refused_with_the_reason() {
    let with = |from: &str, to: &str| TEXT.replacen(from, to, 1).into_bytes();
    let whole = binary("binary_little_endian");
    let cases = [
        (b"solid\n".to_vec(), "does not begin with the word ply"),
        (b"ply\nformat ascii 1.0\n".to_vec(), "its header has no end"),
        (with("format ascii 1.0\n", ""), "states no format"),
        (with("float x", "quaternion x"), "line 5: there is no type \"quaternion\""),
        (with("element vertex 5\n", ""), "line 4: a property needs an element before it"),
        (with("vertex 5", "vertex -5"), "line 4: an element needs a number of rows"),
        (with("float x", "float q"), "no x, y and z"),
        (with("vertex_indices", "corners"), "no list vertex_indices"),
        (with("vertex 5", "vertex 99999999999"), "it is cut off"),
        (with("1 3 0 3 4\n", "1 3 0 3"), "it is cut off"),
        (with("3 1 0 4", "3 1 0 5"), "the vertex 5, and there are 5"),
        (with("3 1 0 4", "3 1 -1 4"), "a face has the vertex -1"),
        (with("-1 0 -1 255", "nan 0 -1 255"), "is not within"),
        (with("-1 0 -1 255", "one 0 -1 255"), "\"one\" is no number"),
        (whole[..whole.len() - 1].to_vec(), "it is cut off"),
        (with("uchar int vertex", "float int vertex"), ""),
    ];
    for (content, words) in cases {
        let result = imported(&content);
        assert_eq!(result.is_err(), !words.is_empty(), "{words}");
        assert!(result.err().is_none_or(|error| error.contains(words)), "{words}");
    }
    let many =
        with("element face 5", "element face 9").into_iter().chain(*b"1 5 0 1 2 3 4\n1 5 0 1 2 3 4\n1 5 0 1 2 3 4\n");
    assert!(imported(&many.collect::<Vec<_>>()).unwrap_err().contains("more than 12 triangles"));
    let empty = "ply\nformat ascii 1.0\nelement nothing 4000000000\nend_header\n";
    assert!(imported(empty.as_bytes()).unwrap_err().contains("has no properties"));
}

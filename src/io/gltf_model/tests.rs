use super::*;
use crate::scene::TextureRef;
use glam::Vec2;

const LIMITS: ModelLimits = ModelLimits { file_bytes: 1 << 20, triangles: 100 };

/// Returns a GLB file of a document and its binary part.
fn glb(json: &str, bin: &[u8]) -> Vec<u8> {
    let chunk = |kind: &[u8; 4], bytes: &[u8], fill: u8| {
        let mut padded = bytes.to_vec();
        padded.resize(bytes.len().next_multiple_of(4), fill);
        [&u32::try_from(padded.len()).unwrap().to_le_bytes()[..], kind, &padded].concat()
    };
    let chunks = [chunk(b"JSON", json.as_bytes(), b' '), chunk(b"BIN\0", bin, 0)].concat();
    let header =
        [b"glTF", &2_u32.to_le_bytes()[..], &(12 + u32::try_from(chunks.len()).unwrap()).to_le_bytes()].concat();
    [header, chunks].concat()
}

/// The binary part of the tests: three positions, three normals, three texture coordinates, three indices of 16 bits, and
/// a red PNG image.
fn binary() -> (Vec<u8>, usize) {
    let floats: [f32; 24] = [
        0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 2.0, 0.0, // positions
        0.0, 0.0, 1.0, 0.0, 0.0, 1.0, 0.0, 0.0, 1.0, // normals
        0.0, 0.0, 1.0, 0.0, 0.0, 0.25, // texture coordinates
    ];
    let mut bytes: Vec<u8> = floats.iter().flat_map(|value| value.to_le_bytes()).collect();
    bytes.extend([0_u8, 0, 1, 0, 2, 0, 0, 0]);
    let mut image = std::io::Cursor::new(Vec::new());
    let red = image::RgbImage::from_pixel(2, 2, image::Rgb([255, 51, 0]));
    red.write_to(&mut image, image::ImageFormat::Png).unwrap();
    bytes.extend(image.get_ref());
    (bytes, image.get_ref().len())
}

/// A document of two nodes with one triangle: one is moved, and its child is mirrored and has no normals.
fn document(png: usize) -> String {
    format!(
        r#"{{"asset": {{"version": "2.0"}}, "scene": 0, "scenes": [{{"nodes": [0]}}],
        "nodes": [{{"name": "Bottle", "mesh": 0, "translation": [1, 2, 3], "children": [1]}},
                  {{"name": "Cap", "mesh": 1, "scale": [-1, 1, 1]}}, {{"name": "Elsewhere", "mesh": 0}}],
        "meshes": [{{"primitives": [{{"attributes": {{"POSITION": 0, "NORMAL": 1, "TEXCOORD_0": 2}}, "indices": 3, "material": 0}}]}},
                   {{"primitives": [{{"attributes": {{"POSITION": 0}}, "indices": 3, "material": 1}}]}}],
        "materials": [{{"name": "Label", "pbrMetallicRoughness": {{"baseColorTexture": {{"index": 0}}, "baseColorFactor": [1, 0.5, 0, 1], "metallicFactor": 0, "roughnessFactor": 0.4}}, "normalTexture": {{"index": 0}}}},
                      {{"name": "Glass", "pbrMetallicRoughness": {{"metallicRoughnessTexture": {{"index": 0}}}}, "emissiveFactor": [0, 0, 1],
                        "extensions": {{"KHR_materials_transmission": {{"transmissionFactor": 0.9}}, "KHR_materials_ior": {{"ior": 1.33}},
                                        "KHR_materials_emissive_strength": {{"emissiveStrength": 500}},
                                        "KHR_materials_volume": {{"attenuationDistance": 0.5, "attenuationColor": [0.36787944, 1, 1]}}}}}}],
        "textures": [{{"source": 0}}], "images": [{{"bufferView": 4, "mimeType": "image/png"}}],
        "accessors": [{{"bufferView": 0, "componentType": 5126, "count": 3, "type": "VEC3", "min": [0, 0, 0], "max": [1, 2, 0]}},
                      {{"bufferView": 1, "componentType": 5126, "count": 3, "type": "VEC3"}},
                      {{"bufferView": 2, "componentType": 5126, "count": 3, "type": "VEC2"}},
                      {{"bufferView": 3, "componentType": 5123, "count": 3, "type": "SCALAR"}}],
        "bufferViews": [{{"buffer": 0, "byteLength": 36}}, {{"buffer": 0, "byteOffset": 36, "byteLength": 36}},
                        {{"buffer": 0, "byteOffset": 72, "byteLength": 24}}, {{"buffer": 0, "byteOffset": 96, "byteLength": 6}},
                        {{"buffer": 0, "byteOffset": 104, "byteLength": {png}}}],
        "buffers": [{{"byteLength": {}}}]}}"#,
        104 + png
    )
}

fn imported(json: &str, bin: &[u8]) -> Result<ImportedModel, String> {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("bottle.glb");
    std::fs::write(&path, glb(json, bin)).unwrap();
    import(&path, &LIMITS).map_err(|error| error.to_string())
}

#[test]
fn nodes_become_parts_in_world_space_with_their_materials() {
    let (bin, png) = binary();
    let ImportedModel { mesh, part_materials, warnings } = imported(&document(png), &bin).unwrap();
    let names: Vec<&str> = mesh.part_names().collect();
    assert_eq!(names, ["Bottle", "Cap"], "a node outside of the scene is left out");
    assert_eq!(mesh.corners(0), [Vec3::new(1.0, 2.0, 3.0), Vec3::new(2.0, 2.0, 3.0), Vec3::new(1.0, 4.0, 3.0)]);
    // Mirrored: to the other side, and it still faces the front
    assert_eq!(mesh.corners(1), [Vec3::new(1.0, 2.0, 3.0), Vec3::new(1.0, 4.0, 3.0), Vec3::new(0.0, 2.0, 3.0)]);
    assert!(mesh.normals.len() == 6 && mesh.normals.iter().all(|normal| normal.distance(Vec3::Z) < 1e-6));
    // Texture coordinates from the bottom left, 0 where there are none
    assert_eq!(mesh.uvs[..3], [Vec2::new(0.0, 1.0), Vec2::new(1.0, 1.0), Vec2::new(0.0, 0.75)]);
    assert_eq!(mesh.uvs[3..], [Vec2::ZERO; 3]);

    let [(_, label), (_, glass)] = &part_materials[..] else { panic!("{part_materials:?}") };
    assert_eq!(label.base_color, [0.98, 0.5, 0.0]);
    assert_eq!((label.metallic, label.roughness, label.transmission), (0.0, 0.4, 0.0));
    assert_eq!(label.textures.base_color, Some(TextureRef::Embedded { model: "bottle.glb".to_owned(), image: 0 }));
    // The map has the mean green of 51 / 255 and no blue
    assert!((glass.roughness - 0.2).abs() < 1e-6 && glass.metallic == 0.0, "{glass:?}");
    assert_eq!((glass.transmission, glass.ior, glass.emission_cd_m2), (0.9, 1.33, [0.0, 0.0, 500.0]));
    assert!((glass.absorption_per_m[0] - 2.0).abs() < 1e-5 && glass.absorption_per_m[1] == 0.0, "{glass:?}");
    assert_eq!(warnings, ["maps of roughness and metal are taken as their mean", "normal maps are left out"]);
}

#[test]
fn images_inside_are_read_and_others_are_errors() {
    let (bin, png) = binary();
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("bottle.glb");
    std::fs::write(&path, glb(&document(png), &bin)).unwrap();
    let image = embedded_image(&path, 0, &LIMITS).unwrap();
    assert_eq!(image, bin[104..]);
    assert!(embedded_image(&path, 1, &LIMITS).unwrap_err().to_string().contains("no image 1"));
}

#[test]
fn joints_and_morph_targets_pose_the_mesh() {
    let floats: [f32; 34] = [
        0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0, 0.0, // positions
        0.0, 0.0, 2.0, 0.0, 0.0, 2.0, 0.0, 0.0, 2.0, // offsets of a morph target
        1.0, 0.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.5, 0.5, 0.0, 0.0, // weights of the joints
        0.0, 0.0, 0.0, 0.0,
    ];
    let mut bin: Vec<u8> = floats.iter().flat_map(|value| value.to_le_bytes()).collect();
    bin.extend([0_u8, 1, 0, 0].repeat(3));
    let json = format!(
        r#"{{"asset": {{"version": "2.0"}}, "scene": 0, "scenes": [{{"nodes": [0, 1, 2]}}],
        "nodes": [{{"mesh": 0, "skin": 0, "weights": [0.5], "translation": [9, 9, 9]}}, {{"translation": [0, 10, 0]}}, {{"translation": [0, 20, 0]}}],
        "skins": [{{"joints": [1, 2]}}],
        "meshes": [{{"primitives": [{{"attributes": {{"POSITION": 0, "WEIGHTS_0": 2, "JOINTS_0": 3}}, "targets": [{{"POSITION": 1}}]}}]}}],
        "accessors": [{{"bufferView": 0, "componentType": 5126, "count": 3, "type": "VEC3", "min": [0, 0, 0], "max": [1, 1, 0]}},
                      {{"bufferView": 0, "byteOffset": 36, "componentType": 5126, "count": 3, "type": "VEC3", "min": [0, 0, 0], "max": [1, 1, 0]}},
                      {{"bufferView": 0, "byteOffset": 72, "componentType": 5126, "count": 3, "type": "VEC4"}},
                      {{"bufferView": 1, "componentType": 5121, "count": 3, "type": "VEC4"}}],
        "bufferViews": [{{"buffer": 0, "byteLength": 136}}, {{"buffer": 0, "byteOffset": 136, "byteLength": 12}}],
        "buffers": [{{"byteLength": {}}}]}}"#,
        bin.len()
    );
    let mesh = imported(&json, &bin).unwrap().mesh;
    // Up by the joints, 10, 20 and 15; to the front by half of the target. The node's own place does not count
    assert_eq!(mesh.corners(0), [Vec3::new(0.0, 10.0, 1.0), Vec3::new(1.0, 20.0, 1.0), Vec3::new(0.0, 16.0, 1.0)]);
}

#[test]
fn damaged_files_and_unread_extensions_are_told() {
    let (bin, png) = binary();
    let good = document(png);
    let error = |from: &str, to: &str| imported(&good.replacen(from, to, 1), &bin).unwrap_err();
    let draco = r#""extensionsRequired": ["KHR_draco_mesh_compression"], "scene""#;
    assert!(error(r#""scene""#, draco).contains("it needs KHR_draco_mesh_compression, which is not read"));
    assert!(error(r#""byteLength": 36}"#, r#""byteLength": 35}"#).contains("beyond its data"));
    assert!(error(r#""count": 3, "type": "SCALAR""#, r#""count": 4, "type": "SCALAR""#).contains("beyond its data"));
    assert!(error(r#""type": "VEC2""#, r#""type": "VEC4""#).contains("wrong kind of numbers"));
    assert!(error(r#""buffers": [{"#, r#""buffers": [{"uri": "a.bin", "#).contains("export it as one GLB file"));
    let many = format!(r#""children": [1]}}, {}{{"#, r#"{"name": "x"},"#.repeat(3));
    assert!(imported(&good.replacen(r#""children": [1]}, {"#, &many, 1), &bin).is_ok());
    // A cycle of nodes ends
    let _ = imported(&good.replacen(r#""scale": [-1, 1, 1]"#, r#""children": [0]"#, 1), &bin);
    let used = r#""extensionsUsed": ["KHR_materials_sheen"], "cameras": [{"type": "perspective", "perspective": {"yfov": 1, "znear": 0.1}}], "scene""#;
    let warnings = imported(&good.replacen(r#""scene""#, used, 1), &bin).unwrap().warnings;
    for left_out in ["cameras are left out", "the properties of KHR_materials_sheen are left out"] {
        assert!(warnings.iter().any(|warning| warning == left_out), "{warnings:?}");
    }
    // Every byte of the file, one after the other: an error or a model, and no panic
    let whole = glb(&good, &bin);
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("a.glb");
    for at in 0..whole.len() {
        for change in [0x41, 0x01] {
            let mut damaged = whole.clone();
            damaged[at] ^= change;
            std::fs::write(&path, &damaged).unwrap();
            let _ = import(&path, &LIMITS);
        }
    }
    for length in (0..whole.len()).step_by(7) {
        std::fs::write(&path, &whole[..length]).unwrap();
        assert!(import(&path, &LIMITS).is_err(), "{length}");
    }
}

use super::*;
use crate::io::importers::EmbeddedImages;
use crate::scene::{Alpha, Clearcoat, Sheen, TextureRef, Wrap};
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
        "materials": [{{"name": "Label", "pbrMetallicRoughness": {{"baseColorTexture": {{"index": 0}}, "baseColorFactor": [1, 0.5, 0, 1], "metallicFactor": 0, "roughnessFactor": 0.4}}, "normalTexture": {{"index": 0, "scale": 0.5}}, "occlusionTexture": {{"index": 0}}}},
                      {{"name": "Glass", "pbrMetallicRoughness": {{"metallicRoughnessTexture": {{"index": 0}}}}, "emissiveFactor": [0, 0, 1], "emissiveTexture": {{"index": 0}},
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
    import(&path, &LIMITS, &LoadProgress::default()).map_err(|error| error.to_string())
}

#[test]
fn nodes_become_parts_in_world_space_with_their_materials() {
    let (bin, png) = binary();
    let ImportedModel { mesh, part_materials, warnings, set_up: _ } = imported(&document(png), &bin).unwrap();
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
    let image = Some(TextureRef::Embedded { model: "bottle.glb".to_owned(), image: 0 });
    assert_eq!((&label.textures.normal, label.textures.normal_scale), (&image, 0.5));
    assert_eq!((&glass.textures.metallic_roughness, &glass.textures.base_color), (&image, &None));
    assert_eq!((glass.roughness, glass.metallic), (1.0, 1.0), "factors of the map");
    assert_eq!(glass.textures.emission, image);
    assert_eq!((glass.transmission, glass.ior, glass.emission_cd_m2), (0.9, 1.33, [0.0, 0.0, 500.0]));
    assert!((glass.absorption_per_m[0] - 2.0).abs() < 1e-5 && glass.absorption_per_m[1] == 0.0, "{glass:?}");
    assert_eq!(warnings, ["occlusion maps are left out: the light itself finds what hides it"]);
}

#[test]
fn placements_of_textures_are_those_of_samplers_transforms_and_coordinate_sets() {
    let (bin, png) = binary();
    let label = |from: &str, to: &str| {
        let json = document(png).replacen(r#""asset""#, r#""extensionsUsed": ["KHR_texture_transform"], "asset""#, 1);
        assert!(json.contains(from));
        imported(&json.replacen(from, to, 1), &bin).unwrap()
    };
    let base = r#""baseColorTexture": {"index": 0}"#;
    let turned = label(
        base,
        r#""baseColorTexture": {"index": 0, "extensions": {"KHR_texture_transform": {"offset": [0.5, 0], "rotation": 1.5707964, "scale": [2, 3]}}}"#,
    );
    let placement = turned.part_materials[0].1.textures.placements[0];
    assert_eq!((placement.offset, placement.scale), ([0.5, 0.0], [2.0, 3.0]));
    assert!((placement.rotation_deg - 90.0).abs() < 1e-4);
    let normals = r#""normalTexture": {"index": 0, "scale": 0.5}"#;
    let second = label(
        normals,
        r#""normalTexture": {"index": 0, "texCoord": 0, "extensions": {"KHR_texture_transform": {"offset": [0, 2], "texCoord": 1}}}"#,
    );
    let placement = second.part_materials[0].1.textures.placements[3];
    assert!(placement.offset == [0.0, 2.0] && placement.second_uvs, "{placement:?}");
    // The mesh has no second set: there is no texture coordinate but 0
    assert!(second.mesh.second_uvs.is_empty());
    let with_set = label(r#""TEXCOORD_0": 2}"#, r#""TEXCOORD_0": 2, "TEXCOORD_1": 2}"#);
    assert!(with_set.mesh.second_uvs.is_empty(), "no texture lies by it");
    let sampler = label(
        r#""textures": [{"source": 0}]"#,
        r#""textures": [{"source": 0, "sampler": 0}], "samplers": [{"wrapS": 33071, "wrapT": 33648, "magFilter": 9728}]"#,
    );
    let placement = sampler.part_materials[0].1.textures.placements[0];
    assert!(placement.wrap == [Wrap::Clamp, Wrap::Mirror] && placement.nearest, "{placement:?}");
}

#[test]
fn the_second_set_of_coordinates_is_kept_where_a_texture_lies_by_it() {
    let (bin, png) = binary();
    let json = document(png)
        .replacen(
            r#""normalTexture": {"index": 0, "scale": 0.5}"#,
            r#""normalTexture": {"index": 0, "texCoord": 3}"#,
            1,
        )
        .replacen(r#""TEXCOORD_0": 2}"#, r#""TEXCOORD_0": 2, "TEXCOORD_3": 2}"#, 1);
    let model = imported(&json, &bin).unwrap();
    assert_eq!(model.mesh.second_uvs[..3], model.mesh.uvs[..3]);
    assert_eq!(model.mesh.second_uvs.len(), model.mesh.positions.len());
    let third = json.replacen(
        r#""occlusionTexture": {"index": 0}"#,
        r#""emissiveFactor": [1, 1, 1], "emissiveTexture": {"index": 0, "texCoord": 7}"#,
        1,
    );
    let warnings = imported(&third, &bin).unwrap().warnings;
    assert_eq!(warnings, ["textures by a third set of texture coordinates are left out"]);
}

#[test]
fn alpha_is_a_mask_or_a_blend_and_glass_needs_none() {
    let (bin, png) = binary();
    let alpha = |properties: &str| {
        let json = document(png).replacen(r#""name": "Label","#, &format!(r#""name": "Label", {properties},"#), 1);
        imported(&json, &bin).unwrap().part_materials[0].1.alpha
    };
    assert_eq!(alpha(r#""alphaMode": "MASK""#), Alpha::Mask { cutoff: 0.5 });
    assert_eq!(alpha(r#""alphaMode": "MASK", "alphaCutoff": 0.25"#), Alpha::Mask { cutoff: 0.25 });
    assert_eq!(alpha(r#""alphaMode": "MASK", "alphaCutoff": 0"#), Alpha::Opaque, "all of it is there");
    assert_eq!(alpha(r#""alphaMode": "BLEND""#), Alpha::Blend { opacity: 1.0 });
    assert_eq!(alpha(r#""alphaMode": "OPAQUE""#), Alpha::Opaque);
    let glass = document(png).replacen(r#""name": "Glass","#, r#""name": "Glass", "alphaMode": "BLEND","#, 1);
    assert_eq!(imported(&glass, &bin).unwrap().part_materials[1].1.alpha, Alpha::Opaque);
}

#[test]
fn images_inside_are_read_and_others_are_errors() {
    let (bin, png) = binary();
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("bottle.glb");
    std::fs::write(&path, glb(&document(png), &bin)).unwrap();
    let images = EmbeddedImages::default();
    assert_eq!(images.image(&path, 0).unwrap(), bin[104..]);
    // The file is read once for all its images
    std::fs::remove_file(&path).unwrap();
    assert_eq!(images.image(&path, 0).unwrap(), bin[104..]);
    assert!(images.image(&path, 1).unwrap_err().to_string().contains("no image 1"));
    assert!(EmbeddedImages::default().image(&path, 0).is_err());
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

/// Returns a document with a spot lamp, a sun and a camera on a node that stands at (0, 1, 4), and with a mask.
fn with_set_up(document: &str) -> String {
    let lamps = r#""extensionsUsed": ["KHR_lights_punctual", "KHR_texture_transform"], "extensions": {"KHR_lights_punctual": {"lights": [
        {"type": "spot", "name": "Beam", "intensity": 500, "color": [1, 1, 1], "spot": {"innerConeAngle": 0.1, "outerConeAngle": 0.3}},
        {"type": "directional", "intensity": 1000, "color": [1, 0, 0]}]}},
        "cameras": [{"type": "perspective", "perspective": {"yfov": 0.4, "aspectRatio": 1.5, "znear": 0.1}}], "asset""#;
    let nodes = r#"{"name": "Elsewhere", "mesh": 0},
        {"camera": 0, "translation": [0, 1, 4], "extensions": {"KHR_lights_punctual": {"light": 0}}},
        {"rotation": [-0.70710678, 0, 0, 0.70710678], "extensions": {"KHR_lights_punctual": {"light": 1}}}]"#;
    document
        .replacen(r#""asset""#, lamps, 1)
        .replacen(r#"{"name": "Elsewhere", "mesh": 0}]"#, nodes, 1)
        .replacen(r#""nodes": [0]"#, r#""nodes": [0, 3, 4]"#, 1)
        .replacen(r#""name": "Label","#, r#""name": "Label", "alphaMode": "MASK","#, 1)
}

#[test]
fn lamps_have_their_candela_and_lux_and_the_camera_its_field_of_view() {
    use crate::scene::{Emitter, Output};
    let (bin, png) = binary();
    let set_up = imported(&with_set_up(&document(png)), &bin).unwrap().set_up;
    let [beam, sun] = &set_up.lights[..] else { panic!("{set_up:?}") };
    assert_eq!(
        (beam.name.as_str(), beam.power.output, beam.position),
        ("Beam", Output::Candela(500.0), Vec3::new(0.0, 1.0, 4.0))
    );
    let Emitter::Spot { inner_deg, outer_deg } = beam.emitter else { panic!("{beam:?}") };
    assert!((inner_deg - 0.2_f32.to_degrees()).abs() < 1e-4 && (outer_deg - 0.6_f32.to_degrees()).abs() < 1e-4);
    // Red has 0.2126 of the luminance of white; the sun shines straight down
    let Output::Lux(lux) = sun.power.output else { panic!("{sun:?}") };
    assert!((lux - 212.6).abs() < 0.1, "{lux}");
    let crate::scene::Aim::Point(aim) = sun.aim else { panic!("{sun:?}") };
    assert!((aim - sun.position).distance(Vec3::NEG_Y) < 1e-5, "{aim}");
    let camera = set_up.camera.unwrap();
    assert!((camera.focal_length_mm - 12.0 / 0.2_f32.tan()).abs() < 1e-3 && camera.roll_deg.abs() < 1e-4, "{camera:?}");
    assert_eq!(camera.position, Vec3::new(0.0, 1.0, 4.0));
}

#[test]
fn data_in_a_file_beside_the_model_are_read_and_go_where_the_model_goes() {
    let (bin, png) = binary();
    let folder = tempfile::tempdir().unwrap();
    let json = document(png).replacen(r#""buffers": [{"#, r#""buffers": [{"uri": "data/two%20bottles.bin", "#, 1);
    let path = folder.path().join("bottle.gltf");
    std::fs::write(&path, json).unwrap();
    std::fs::create_dir(folder.path().join("data")).unwrap();
    std::fs::write(folder.path().join("data/two bottles.bin"), &bin).unwrap();
    let model = import(&path, &LIMITS, &LoadProgress::default()).unwrap();
    assert_eq!(model.mesh.triangles.len(), 2);
    assert_eq!(companions(&path, &LIMITS), ["data/two bottles.bin"]);
    // A studio elsewhere takes both along
    let elsewhere = tempfile::tempdir().unwrap();
    let studio = crate::io::studio_of(model, &path, elsewhere.path()).unwrap();
    let files = crate::io::AssetFiles { folder: None, imported: &studio.imported };
    for copy in files.copies_into(elsewhere.path(), &studio.scene, &Default::default()).0 {
        copy.make().unwrap();
    }
    assert_eq!(std::fs::read(elsewhere.path().join("models/data/two bottles.bin")).unwrap(), bin);
    assert!(import(&elsewhere.path().join("models/bottle.gltf"), &LIMITS, &LoadProgress::default()).is_ok());
    // Too large a file is refused before it is read
    let small = ModelLimits { file_bytes: 4000, ..LIMITS };
    std::fs::write(folder.path().join("data/two bottles.bin"), vec![0; 9000]).unwrap();
    assert!(import(&path, &small, &LoadProgress::default()).unwrap_err().to_string().contains("too large"));
}

#[test]
fn lacquer_sheen_brushing_and_translucency_are_those_of_the_extensions() {
    let (bin, png) = binary();
    let extensions = r#"{"name": "Label", "extensions": {
        "KHR_materials_clearcoat": {"clearcoatFactor": 0.75, "clearcoatRoughnessFactor": 7, "clearcoatTexture": {"index": 0}},
        "KHR_materials_sheen": {"sheenColorFactor": [0.25, "red", 0.5], "sheenRoughnessFactor": 0.5},
        "KHR_materials_anisotropy": {"anisotropyStrength": 0.5, "anisotropyRotation": 1.5707964},
        "KHR_materials_diffuse_transmission": {"diffuseTransmissionFactor": 0.25}},"#;
    let json = document(png).replacen(r#"{"name": "Label","#, extensions, 1);
    let used = r#""extensionsUsed": ["KHR_materials_clearcoat"], "scene""#;
    let model = imported(&json.replacen(r#""scene""#, used, 1), &bin).unwrap();
    let [(_, label), (_, glass)] = &model.part_materials[..] else { panic!("{:?}", model.part_materials) };
    assert_eq!(label.clearcoat, Some(Clearcoat { amount: 0.75, roughness: 1.0 }));
    assert_eq!(label.sheen, Some(Sheen { color: [0.25, 0.0, 0.5], roughness: 0.5 }));
    let anisotropy = label.anisotropy.unwrap();
    assert!(anisotropy.strength == 0.5 && (anisotropy.rotation_deg - 90.0).abs() < 1e-4);
    assert_eq!((label.translucency, label.frosting, glass.frosting), (0.25, 0.0, 1.0));
    assert!(
        model.warnings.contains(&"maps of KHR_materials_clearcoat are left out".to_owned()),
        "{:?}",
        model.warnings
    );
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
    assert!(error(r#""buffers": [{"#, r#""buffers": [{"uri": "a.bin", "#).contains("its data can't be read"));
    assert!(error(r#""buffers": [{"#, r#""buffers": [{"uri": "../a.bin", "#).contains("which is no file beside it"));
    assert!(
        error(r#""buffers": [{"#, r#""buffers": [{"uri": "https://a.b/c.bin", "#)
            .contains("which is no file beside it")
    );
    let many = format!(r#""children": [1]}}, {}{{"#, r#"{"name": "x"},"#.repeat(3));
    assert!(imported(&good.replacen(r#""children": [1]}, {"#, &many, 1), &bin).is_ok());
    // A cycle of nodes ends
    let _ = imported(&good.replacen(r#""scale": [-1, 1, 1]"#, r#""children": [0]"#, 1), &bin);
    let used = r#""extensionsUsed": ["KHR_materials_iridescence"], "cameras": [{"type": "perspective", "perspective": {"yfov": 1, "znear": 0.1}}], "scene""#;
    let warnings = imported(&good.replacen(r#""scene""#, used, 1), &bin).unwrap().warnings;
    assert!(
        warnings.iter().any(|warning| warning == "the properties of KHR_materials_iridescence are left out"),
        "{warnings:?}"
    );
    // Every byte of the file, one after the other: an error or a model, and no panic
    let whole = glb(&with_set_up(&good), &bin);
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("a.glb");
    for at in 0..whole.len() {
        for change in [0x41, 0x01] {
            let mut damaged = whole.clone();
            damaged[at] ^= change;
            std::fs::write(&path, &damaged).unwrap();
            let _ = import(&path, &LIMITS, &LoadProgress::default());
        }
    }
    for length in (0..whole.len()).step_by(7) {
        std::fs::write(&path, &whole[..length]).unwrap();
        assert!(import(&path, &LIMITS, &LoadProgress::default()).is_err(), "{length}");
    }
}

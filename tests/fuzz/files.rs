//! The kinds of files that the program reads: studios, models, textures, pictures, parts of pictures, checkpoints.

use super::fuzz;
use catchlight::io::{self, PictureFormat, PictureInfo, import_model, parse_scene, presets, write_scene};
use catchlight::photo::Picture;
use catchlight::raytrace::{RenderControl, Settings, prepare, render_part};
use catchlight::scene::{Assets, Material, MaterialTextures, Object, Scene, Shape, TextureRef};
use std::fs;
use std::path::Path;

#[test]
fn changed_studios_are_errors_or_studios_that_save_and_load_alike() {
    let corpus: Vec<Vec<u8>> = presets().iter().map(|preset| preset.text.as_bytes().to_vec()).collect();
    let words = [
        "(",
        ")",
        "[",
        "]",
        "Some(",
        "None",
        "Object(name: \"Man\")",
        "Preset(Chrome)",
        "format: 2,",
        "objects: [",
        "\"\\u{0}\"",
        "\"\\u{202e}\"",
        "/*",
        "//",
        "r#\"",
        "'",
        "solo: (lights: [\"Key\"]),",
        "variants: (others: [(name: \"B\", camera: (iso: 200), lights: [(light: \"Key\", on: false)])]),",
        "variants: (shown: \"B\", others: [(name: \"B\", removed_lights: [\"Key\"])]),",
        "true",
        "Sphere(radius_m: 1)",
        "Figure((body: (height_m: 9)))",
        "MeshFile(path: \"../../../etc/passwd\")",
        "é",
        "\u{feff}",
        "\r\n",
    ];
    fuzz("studio", &corpus, &words, |input| {
        let text = String::from_utf8_lossy(input);
        let Ok((scene, _)) = parse_scene(&text) else { return false };
        let written = write_scene(&scene);
        let (again, _) = parse_scene(&written).unwrap_or_else(|error| panic!("{error}\n{written}"));
        assert_eq!(write_scene(&again), written);
        true
    });
}

const CUBE: &str = "mtllib a.mtl\no Cube\nv 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nv 0 0 1\nv 1 0 1\nv 1 1 1\nv 0 1 1\n\
    vt 0 0\nvt 1 0\nvt 1 1\nvn 0 0 -1\nvn 0 0 1\ng front\nusemtl red\nf 1/1/1 4/2/1 3/3/1 2/1/1\n\
    g back\ns 1\nf 5//2 6//2 7//2 8//2\nf -8 -7 \\\n -3 -4\nf 3 4 8 7\nl 1 2\n";
const TRIANGLES: &str =
    "# a bust\nv 0.1 0.2 0.3\nv 1e-3 2e2 -3\nv 0.5 0.5 0.5 1.0 0.2 0.1\nv 0 1 2\nf 1 2 3\nf 2 3 4\nf 1 2 3 4\n";

#[test]
fn changed_models_are_errors_or_meshes_whose_numbers_are_finite() {
    let folder = tempfile::tempdir().unwrap();
    fs::write(folder.path().join("a.mtl"), "newmtl red\nKd 1 0 0\nmap_Kd none.png\nd 0.5\nNs nan\n").unwrap();
    let path = folder.path().join("a.obj");
    let words =
        ["\nf ", "\nv ", "\nvn ", "\nvt ", "/", "//", "-1", "\\\n", "\nusemtl ", "\ng ", "\no ", "\r", "\u{feff}", "#"];
    fuzz("model", &[CUBE.into(), TRIANGLES.into()], &words, |input| {
        fs::write(&path, input).unwrap();
        let Ok(model) = import_model(&path) else { return false };
        let mesh = &model.mesh;
        assert!(mesh.positions.iter().chain(&mesh.normals).all(|vector| vector.is_finite()));
        assert!(mesh.triangles.iter().flatten().all(|index| (*index as usize) < mesh.positions.len()));
        true
    });
}

/// Returns a small picture with all values from dark to bright.
fn gradient(width: u32, height: u32) -> Picture {
    let value = |i: u32| [i as f32 / 700.0, (i % 31) as f32 / 31.0, (i % 7) as f32];
    Picture { width, height, rgb: (0..width * height).map(value).collect() }
}

/// Returns the bytes of a picture in a format.
fn encoded(folder: &Path, format: PictureFormat) -> Vec<u8> {
    let name = match format {
        PictureFormat::Png => "a.png",
        PictureFormat::Jpeg => "a.jpg",
        PictureFormat::Tiff => "a.tif",
        PictureFormat::Exr => "a.exr",
    };
    let path = folder.join(name);
    io::export_picture(&path, &gradient(37, 23), &PictureInfo::new(&Scene::default(), "path", 4, 7)).unwrap();
    fs::read(path).unwrap()
}

#[test]
fn changed_textures_are_warnings_or_images() {
    let folder = tempfile::tempdir().unwrap();
    let corpus = [PictureFormat::Png, PictureFormat::Jpeg].map(|format| encoded(folder.path(), format));
    let textured = |name: &str| {
        let textures = MaterialTextures::with_base_color(TextureRef::File(name.to_owned()));
        let preset = presets()[0].load().unwrap();
        let ball = Object {
            shape: Shape::Sphere { radius_m: 0.1 },
            material: Material { textures, ..Material::default() },
            part_materials: Vec::new(),
            ..preset.scene.objects[0].clone()
        };
        Scene { objects: vec![ball], ..Scene::default() }
    };
    let scenes = ["x.png", "x.jpg"].map(textured);
    fuzz("texture", &corpus, &["IDAT", "IHDR", "PLTE", "tRNS", "\u{7f}", "IEND"], |input| {
        // The reader goes by the content, not by the name.
        let mut is_taken = false;
        for (scene, name) in scenes.iter().zip(["x.png", "x.jpg"]) {
            fs::write(folder.path().join(name), input).unwrap();
            let mut assets = Assets::default();
            let warnings = io::load_assets(scene, Some(folder.path()), &mut assets);
            is_taken |= warnings.is_empty();
        }
        is_taken
    });
}

#[test]
fn changed_pictures_and_parts_are_errors_or_pictures() {
    let folder = tempfile::tempdir().unwrap();
    let part_file = folder.path().join("part.exr");
    let loaded = presets()[0].load().unwrap();
    let prepared = prepare(&loaded.scene, &loaded.assets).unwrap();
    let settings = Settings { width: 24, height: 16, spp: 4, aovs: true, ..Settings::default() };
    let sums = render_part(&prepared, &loaded.scene, &settings, 1..3, &RenderControl::new(), &mut |_| {});
    let part = io::PicturePart {
        render: io::RenderId::new(&loaded.scene, &loaded.assets, "fuzz"),
        studio: "A studio".to_owned(),
        samples: 1..3,
        of: 4,
        info: PictureInfo::new(&loaded.scene, "path", 2, 0),
        sums,
    };
    io::encode_part(&part_file, &part).unwrap().write().unwrap();
    let corpus = [encoded(folder.path(), PictureFormat::Exr), fs::read(&part_file).unwrap()];
    let path = folder.path().join("x.exr");
    fuzz("picture", &corpus, &["R\0", "chlist\0", "samplesFirst\0", "tiledesc\0", "\u{1}", "compression\0"], |input| {
        fs::write(&path, input).unwrap();
        let (picture, part) = (io::read_exr(&path), io::read_part(&path));
        if let Ok(part) = &part {
            // What is read can be added up and developed.
            let mut twice = part.sums.clone();
            assert!(twice.merge(&part.sums));
            assert_eq!(twice.develop().rgb.len(), (twice.width * twice.height) as usize);
            twice.noise_stops();
        }
        picture.is_ok() || part.is_ok()
    });
}

#[test]
fn changed_checkpoints_are_refused() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("x.checkpoint");
    let loaded = presets()[0].load().unwrap();
    let prepared = prepare(&loaded.scene, &loaded.assets).unwrap();
    let settings = Settings { width: 40, height: 33, spp: 2, aovs: true, ..Settings::default() };
    let film = catchlight::raytrace::empty_film(&prepared, &settings);
    let render = io::RenderId::new(&loaded.scene, &loaded.assets, "fuzz");
    io::write_checkpoint(&path, render, &film).unwrap();
    let whole = fs::read(&path).unwrap();
    fuzz("checkpoint", std::slice::from_ref(&whole), &["Catchlight film1"], |input| {
        fs::write(&path, input).unwrap();
        let read = io::read_checkpoint(&path, render);
        assert!(input == whole || read.is_err(), "a changed checkpoint is taken");
        // The film's bytes alone, without the hash that tells of changes
        let _ = film.with_stored(&mut &input[24.min(input.len())..]);
        read.is_ok()
    });
}

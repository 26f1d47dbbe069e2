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

const PLY: &str = "ply\nformat ascii 1.0\nelement vertex 4\nproperty float x\nproperty float y\nproperty float z\n\
    property uchar red\nproperty uchar green\nproperty uchar blue\nelement face 2\n\
    property list uchar int vertex_indices\nend_header\n0 0 0 1 2 3\n1 0 0 4 5 6\n0 1 0 7 8 9\n0 0 1 9 9 9\n3 0 1 2\n\
    4 0 1 2 3\n";
const STL: &str = "solid a\nfacet normal 0 0 1\nouter loop\nvertex 0 0 0\nvertex 1 0 0\nvertex 0 1e-2 0\nendloop\nendfacet\n\
    endsolid a\n";

#[test]
fn changed_scans_are_errors_or_meshes_whose_numbers_are_finite() {
    let folder = tempfile::tempdir().unwrap();
    let binary_ply = {
        let head = PLY.replace("ascii", "binary_little_endian");
        let mut bytes = head.as_bytes()[..head.find("end_header\n").unwrap() + 11].to_vec();
        for k in 0..4_u8 {
            bytes.extend([k, 1, 2].iter().flat_map(|v| f32::from(*v).to_le_bytes()).chain([k; 3]));
        }
        bytes.extend([3, 0, 0, 0, 0, 1, 0, 0, 0, 2, 0, 0, 0, 3, 1, 0, 0, 0, 2, 0, 0, 0, 3, 0, 0, 0]);
        bytes
    };
    let triangle: Vec<u8> = [0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0, 0.5_f32]
        .iter()
        .flat_map(|value| value.to_le_bytes())
        .chain([0; 2])
        .collect();
    let binary_stl = [vec![32; 80], vec![2, 0, 0, 0], triangle.clone(), triangle].concat();
    let words =
        ["\nproperty list uchar int a", "\nelement b 3", "4294967295", "-1", "nan", "\nvertex ", "endfacet", "solid"];
    let corpus = [PLY.into(), binary_ply, STL.into(), binary_stl];
    fuzz("scan", &corpus, &words, |input| {
        let path = folder.path().join(if input.starts_with(b"pl") { "a.ply" } else { "a.stl" });
        fs::write(&path, input).unwrap();
        let Ok(model) = import_model(&path) else { return false };
        let mesh = &model.mesh;
        assert!(mesh.positions.iter().chain(&mesh.normals).all(|vector| vector.is_finite()));
        assert!(mesh.triangles.iter().flatten().all(|index| (*index as usize) < mesh.positions.len()));
        assert!(mesh.colors.is_empty() || mesh.colors.len() == mesh.positions.len());
        true
    });
}

const IES: &str = "IESNA:LM-63-2002\n[LUMINAIRE] Lamp\nTILT=INCLUDE\n1\n2\n0 90\n1 0.5\n1 -1 1.5 3 3 1 1 0.5 -0.5 0\n0.9 1 60\n\
    0 45 90\n0 90 180\n100 80 5\n100 60 4\n100 40 3\n";
const FLOODLIGHT: &str = "IESNA91\nTILT=NONE\n1 1000 1 3 2 2 2 0 0 0\n1 1 60\n-20 0 20\n0 30\n5 80 5\n4 60 4\n";

/// Returns a EULUMDAT file of four C-planes.
fn eulumdat() -> String {
    let head =
        "Works\n1\n4\n4\n90\n3\n45\nreport\nLamp\n1\na.ldt\ntoday\n600\n300\n80\n600\n300\n0\n0\n0\n0\n100\n90\n1\n0";
    let lamps = "1\n1\nLED\n2000\n3000\n80\n20";
    let ratios = ["0.5"; 10].join("\n");
    format!("{head}\n{lamps}\n{ratios}\n0\n90\n180\n270\n0\n45\n90\n300\n200\n10\n300\n150\n5\n")
}

#[test]
fn changed_photometric_files_are_errors_or_lights_whose_numbers_are_finite() {
    let folder = tempfile::tempdir().unwrap();
    let words = [" 1e38", " -1", " 0", "\n360\n", " 1e-30", "nan", "inf", "TILT=", "999999999", ",", "\r", "\u{1a}"];
    for (name, corpus) in [("ies", vec![IES.into(), FLOODLIGHT.into()]), ("ldt", vec![eulumdat().into_bytes()])] {
        let path = folder.path().join("a").with_extension(name);
        fuzz(name, &corpus, &words, |input| {
            fs::write(&path, input).unwrap();
            let Ok(file) = io::read_photometric_file(&path) else { return false };
            let table = file.table;
            assert!(table.flux_lm() > 0.0 && table.flux_lm().is_finite() && table.peak_cd().is_finite());
            assert!(table.solid_angle_sr() > 0.0 && table.solid_angle_sr() < 12.6, "{}", table.solid_angle_sr());
            for direction in [glam::Vec3::X, glam::Vec3::NEG_Y, glam::Vec3::NEG_Z, glam::Vec3::Z] {
                // Interpolation rounds
                assert!((0.0..=1.0001 * table.peak_cd()).contains(&table.candela_towards(direction)));
            }
            true
        });
    }
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
fn changed_environment_maps_are_errors_or_maps() {
    let folder = tempfile::tempdir().unwrap();
    let panorama = image::Rgb32FImage::from_fn(8, 4, |x, y| image::Rgb([x as f32, y as f32, 0.5]));
    let path = folder.path().join("x.hdr");
    image::DynamicImage::from(panorama).save(&path).unwrap();
    let corpus = [encoded(folder.path(), PictureFormat::Exr), fs::read(&path).unwrap()];
    fuzz("environment", &corpus, &["#?RADIANCE", "-Y 99999 +X 99999", "dataWindow", "channels", "\u{7f}"], |input| {
        fs::write(&path, input).unwrap();
        io::read_environment(&path).is_ok()
    });
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

//! Scene files: what is written reads back the same, and nothing that a file can say does harm.

use catchlight::io::{
    FILE_LIMIT_BYTES, LoadError, SaveError, load_scene, parse_scene, presets, save_scene, write_scene,
};
use catchlight::scene::*;
use glam::Vec3;
use proptest::prelude::*;
use std::time::{Duration, Instant};

fn preset_text() -> &'static str {
    presets()[0].text
}

// ---------------------------------------------------------------------------------------------- round trips

#[test]
fn every_shipped_studio_is_stored_as_we_write_it() {
    assert!(presets().len() >= 10);
    for preset in presets() {
        // After a change of the layout, or of a preset by hand: CATCHLIGHT_ACCEPT=1 cargo test --test scene_files
        if std::env::var_os("CATCHLIGHT_ACCEPT").is_some() {
            let scene = parse_scene(preset.text).unwrap_or_else(|e| panic!("{}: {e}", preset.file_name)).0;
            let folder = std::path::Path::new(env!("CARGO_MANIFEST_DIR")).join("studio_presets");
            save_scene(&scene, &folder.join(preset.file_name)).unwrap();
            continue;
        }
        let (scene, warnings) = parse_scene(preset.text).unwrap_or_else(|e| panic!("{}: {e}", preset.file_name));
        assert_eq!(warnings, [], "{}", preset.file_name);
        assert_eq!(write_scene(&scene), preset.text, "{}", preset.file_name);
        assert_eq!(
            (scene.name.as_str(), scene.description.as_str()),
            (preset.name.as_str(), preset.description.as_str())
        );
    }
}

#[test]
fn every_shipped_studio_loads_without_a_warning() {
    for preset in presets() {
        let loaded = preset.load().unwrap_or_else(|e| panic!("{}: {e}", preset.file_name));
        assert_eq!(loaded.warnings, [], "{}", preset.file_name);
        for object in &loaded.scene.objects {
            assert!(loaded.assets.mesh_of(&object.shape).is_some(), "{}: {}", preset.file_name, object.name);
        }
    }
}

#[test]
fn a_hand_written_file_may_leave_out_what_is_as_usual() {
    let text = r#"
        // Comments, odd spacing and a name for the struct are fine.
        Scene(
            name: "Hand-written", format: 1,
            camera: (position: (0, 1.5, 3), aim: Point(0, 1.5, 0), focal_length_mm: 50, f_number: 4, shutter_s: 0.01,
                     iso: 100, white_balance_k: 5500),
            lights: [(name: "Bulb", role: Key, position: (1, 2, 1), aim: Object(name: "Ball"), emitter: Point,
                      power: (output: Lumens(800)), color: Kelvin(2700))],
            objects: [(name: "Ball", shape: Sphere(radius_m: 0.5), material: Preset(Gold))],
        )"#;
    let (scene, warnings) = parse_scene(text).unwrap();
    assert_eq!(warnings.len(), 1, "comments are dropped by a save: {warnings:?}");
    assert_eq!(scene.lights[0].aim, Aim::Object { object: ObjectId(0), offset: Vec3::ZERO });
    assert_eq!(scene.objects[0].material, MaterialPreset::Gold.material());
    let written = write_scene(&scene);
    assert_eq!(parse_scene(&written).unwrap().0, scene);
    assert_eq!(write_scene(&parse_scene(&written).unwrap().0), written);
}

#[test]
fn windows_line_ends_and_a_byte_order_mark_are_read() {
    let windows = format!("\u{feff}{}", preset_text().replace('\n', "\r\n"));
    assert_eq!(parse_scene(&windows).unwrap().0, parse_scene(preset_text()).unwrap().0);
}

fn number(low: f32, high: f32) -> impl Strategy<Value = f32> {
    prop_oneof![3 => low..=high, 1 => Just(low), 1 => Just(high), 1 => (low..=high).prop_map(f32::round)]
        .prop_map(move |x| x.clamp(low, high))
}

fn vector(low: f32, high: f32) -> impl Strategy<Value = Vec3> {
    [number(low, high), number(low, high), number(low, high)].prop_map(Vec3::from)
}

fn color(high: f32) -> impl Strategy<Value = [f32; 3]> {
    // Never black: that is no colour of light.
    [number(0.001, high), number(0.001, high), number(0.001, high)]
}

fn material() -> impl Strategy<Value = Material> {
    let custom = (
        color(0.999),
        proptest::option::of("[a-z]{1,8}/[a-z ]{1,8}\\.png"),
        number(0.0, 1.0),
        number(0.0, 1.0),
        number(1.0, 4.0),
        color(1e6),
        color(1e9),
    )
        .prop_map(
            |(base_color, base_color_texture, metallic, roughness, ior, absorption_per_m, emission_cd_m2)| Material {
                base_color,
                base_color_texture,
                metallic,
                roughness,
                ior,
                transmission: if metallic > 0.0 { 0.0 } else { 0.7 },
                absorption_per_m,
                emission_cd_m2,
            },
        );
    prop_oneof![(0..MaterialPreset::ALL.len()).prop_map(|i| MaterialPreset::ALL[i].material()), custom]
}

fn shape() -> impl Strategy<Value = Shape> {
    let size = || number(1e-5, 1e5);
    prop_oneof![
        "[a-z]{1,8}\\.obj".prop_map(|path| Shape::MeshFile { path }),
        (0..4_usize, 0..4_usize).prop_map(|(f, p)| {
            let figure = [Figure::Woman, Figure::Man, Figure::Child, Figure::Bust][f];
            let pose = [Pose::Standing, Pose::Contrapposto, Pose::Seated, Pose::HeadTurned][p];
            Shape::Mannequin(Mannequin { figure, pose })
        }),
        (size(), size()).prop_map(|(width_m, depth_m)| Shape::Plane { width_m, depth_m }),
        vector(1e-5, 1e5).prop_map(|size_m| Shape::Box { size_m }),
        size().prop_map(|radius_m| Shape::Sphere { radius_m }),
        (size(), size()).prop_map(|(radius_m, height_m)| Shape::Cylinder { radius_m, height_m }),
        (size(), size(), size(), number(0.0, 1e5)).prop_map(|(width_m, height_m, depth_m, radius_m)| Shape::Sweep {
            width_m,
            height_m,
            depth_m,
            radius_m
        }),
    ]
}

/// Names with everything that could upset a text format.
fn name() -> impl Strategy<Value = String> {
    prop_oneof!["[A-Z][a-z]{1,8}", "\\PC{1,12}", "[\"\\\\/(),:\\[\\]{}#r'\n\t ]{0,6}x"]
}

fn aim(objects: usize) -> impl Strategy<Value = Aim> {
    let angles = (number(-1e5, 1e5), number(-90.0, 90.0))
        .prop_map(|(yaw_deg, pitch_deg)| Aim::Angles { yaw_deg, pitch_deg })
        .boxed();
    // Places are taken from 10 m around, aims from 20 m away, so that nothing aims at itself.
    let point = vector(20.0, 1e6).prop_map(Aim::Point);
    if objects == 0 {
        return prop_oneof![angles, point].boxed();
    }
    let object =
        (0..objects, vector(20.0, 1e6)).prop_map(|(i, offset)| Aim::Object { object: ObjectId(i as u32), offset });
    prop_oneof![angles, point, object].boxed()
}

fn object() -> impl Strategy<Value = Object> {
    let transform = (vector(-10.0, 10.0), vector(-360.0, 360.0), prop_oneof![Just(Vec3::ONE), vector(0.5, 2.0)])
        .prop_map(|(position, rotation_deg, scale)| Transform { position, rotation_deg, scale });
    let parts = proptest::collection::btree_map(name(), material(), 0..3).prop_map(|m| m.into_iter().collect());
    (name(), transform, shape(), material(), parts, any::<bool>()).prop_map(
        |(name, transform, shape, material, part_materials, visible)| Object {
            id: ObjectId(0),
            name,
            transform,
            shape,
            material,
            part_materials,
            visible,
        },
    )
}

fn emitter_and_output() -> impl Strategy<Value = (Emitter, Output)> {
    let size = || number(1e-5, 1e5);
    let emitter = prop_oneof![
        Just(Emitter::Point),
        size().prop_map(|radius_m| Emitter::Sphere { radius_m }),
        (number(0.1, 180.0), number(0.0, 1.0))
            .prop_map(|(outer_deg, share)| Emitter::Spot { inner_deg: outer_deg * share, outer_deg }),
        (size(), size()).prop_map(|(width_m, height_m)| Emitter::RectPanel { width_m, height_m }),
        size().prop_map(|diameter_m| Emitter::RoundPanel { diameter_m }),
        number(0.0, 90.0).prop_map(|angular_diameter_deg| Emitter::Sun { angular_diameter_deg }),
        Just(Emitter::Surround),
    ];
    (emitter, number(0.0, 1e4), number(0.01, 600.0), 0..5_usize).prop_map(|(emitter, a, b, kind)| {
        let finite = [
            Output::Lumens(a),
            Output::Candela(a),
            Output::LuxAt { lux: a, distance_m: b },
            Output::FlashWs { energy_ws: a, efficacy_lm_s_per_ws: b },
            Output::FlashGuideNumber(a),
        ];
        (emitter, if emitter.is_infinite() { Output::Lux(a) } else { finite[kind] })
    })
}

fn light(objects: usize) -> impl Strategy<Value = Light> {
    let source =
        prop_oneof![number(1000.0, 25_000.0).prop_map(ColorSource::Kelvin), color(1000.0).prop_map(ColorSource::Rgb)];
    let gel =
        prop_oneof![Just(Gel::None), number(-1000.0, 1000.0).prop_map(Gel::Mired), color(1.0).prop_map(Gel::Tint)];
    let power = (emitter_and_output(), prop_oneof![Just(0.0), number(-20.0, 10.0)]);
    (
        (name(), 0..Role::ALL.len(), vector(-10.0, 10.0), aim(objects), number(-180.0, 180.0)),
        (power, source, gel, any::<bool>(), any::<bool>()),
        modifier(),
    )
        .prop_map(
            |(
                (name, role, position, aim, roll_deg),
                (((emitter, output), dial_stops), source, gel, on, seen),
                modifier,
            )| Light {
                id: LightId(0),
                name,
                role: Role::ALL[role],
                position,
                aim,
                roll_deg,
                emitter,
                // Light from infinity can only be weakened.
                modifier: if emitter.is_infinite() { Modifier::loss(modifier.loss_stops) } else { modifier },
                power: Power { output, dial_stops },
                color: LightColor { source, gel },
                on,
                visible_to_camera: seen,
            },
        )
}

fn modifier() -> impl Strategy<Value = Modifier> {
    let cone = (0.0..60.0_f32, 60.0..180.0_f32).prop_map(|(inner_deg, outer_deg)| Cone { inner_deg, outer_deg });
    let doors = prop::array::uniform4(0.0..90.0_f32).prop_map(|[left_deg, right_deg, top_deg, bottom_deg]| BarnDoors {
        left_deg,
        right_deg,
        top_deg,
        bottom_deg,
    });
    let (beam, grid, doors) = (prop::option::of(cone), prop::option::of(1.0..90.0_f32), prop::option::of(doors));
    let all =
        (0.0..3.0_f32, 0.0..3.0_f32, beam, grid, doors).prop_map(|(loss_stops, scrim_stops, beam, grid_deg, doors)| {
            Modifier { loss_stops, scrim_stops, beam, grid_deg, doors }
        });
    prop_oneof![Just(Modifier::default()), all]
}

fn camera(objects: usize) -> impl Strategy<Value = Camera> {
    let sensor = prop_oneof![
        (0..5_usize).prop_map(|i| Sensor::NAMED[i].1),
        (number(1.0, 100.0), number(1.0, 100.0))
            .prop_map(|(width_mm, height_mm)| Sensor::Custom { width_mm, height_mm }),
    ];
    let orientation = prop_oneof![Just(Orientation::Landscape), Just(Orientation::Portrait)];
    let focus = (0..=objects, vector(-1.0, 1.0), number(0.1, 100.0)).prop_map(move |(i, offset, distance)| {
        if i < objects {
            Focus::OnObject { object: ObjectId(i as u32), offset }
        } else if distance > 50.0 {
            Focus::OnAim
        } else {
            Focus::Distance(distance)
        }
    });
    (
        (vector(-10.0, 10.0), aim(objects), number(-180.0, 180.0), sensor, orientation, focus, any::<bool>()),
        (
            number(1.0, 800.0),
            number(0.5, 64.0),
            number(1e-4, 30.0),
            number(1.0, 1e5),
            number(1e3, 25e3),
            number(240.0, 340.0),
        ),
    )
        .prop_map(
            |((position, aim, roll_deg, sensor, orientation, focus, depth_of_field), (mm, n, t, s, k, c))| Camera {
                position,
                aim,
                roll_deg,
                sensor,
                orientation,
                focal_length_mm: mm,
                f_number: n,
                shutter_s: t,
                iso: s,
                white_balance_k: k,
                focus,
                depth_of_field,
                meter_constant: c,
            },
        )
}

fn room() -> impl Strategy<Value = Room> {
    (vector(0.1, 1e4), material(), material(), material()).prop_map(|(size_m, floor, walls, ceiling)| Room {
        size_m,
        floor,
        walls,
        ceiling,
    })
}

fn scene() -> impl Strategy<Value = Scene> {
    (0..4_usize).prop_flat_map(|objects| {
        (
            name(),
            name(),
            camera(objects),
            proptest::option::of(room()),
            proptest::collection::vec(object(), objects),
            proptest::collection::vec(light(objects), 0..4),
            any::<(bool, bool)>(),
        )
            .prop_map(|(name, description, camera, room, mut objects, mut lights, (has_meter, on_camera))| {
                // As after loading: ids in list order, names unique.
                for (i, object) in objects.iter_mut().enumerate() {
                    object.id = ObjectId(i as u32);
                    object.name.push_str(&format!(" o{i}"));
                }
                for (i, light) in lights.iter_mut().enumerate() {
                    light.id = LightId(i as u32);
                    light.name.push_str(&format!(" l{i}"));
                }
                let facing = match on_camera {
                    true => Facing::Camera,
                    false => Facing::Angles { yaw_deg: camera.roll_deg, pitch_deg: 12.5 },
                };
                let meter = has_meter.then_some(Meter { position: camera.position, facing, receptor: Receptor::Dome });
                Scene { name, description, camera, room, objects, lights, meter }
            })
    })
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(256))]

    #[test]
    fn any_scene_survives_the_round_trip(scene in scene()) {
        let text = write_scene(&scene);
        let (read, _) = parse_scene(&text).unwrap_or_else(|e| panic!("{e}\n{text}"));
        prop_assert_eq!(&read, &scene, "{}", text);
        prop_assert_eq!(write_scene(&read), text);
    }

    #[test]
    fn any_junk_is_an_error_or_a_scene(text in "\\PC{0,200}", bytes in proptest::collection::vec(any::<u8>(), 0..200)) {
        let _ = parse_scene(&text);
        let _ = parse_scene(&String::from_utf8_lossy(&bytes));
    }

    #[test]
    fn any_change_of_one_byte_is_an_error_or_a_scene(at in 0..10_000_usize, byte in 0x20..0x7f_u8) {
        let mut bytes = preset_text().as_bytes().to_vec();
        let at = at % bytes.len();
        bytes[at] = byte;
        if let Ok(text) = String::from_utf8(bytes) {
            let _ = parse_scene(&text);
        }
    }
}

#[test]
fn ids_are_written_as_names_and_read_in_list_order() {
    let (mut scene, _) = parse_scene(preset_text()).unwrap();
    scene.objects.iter_mut().for_each(|o| o.id.0 += 40);
    scene.lights[0].aim = Aim::Object { object: ObjectId(40), offset: Vec3::Y };
    scene.camera.aim = Aim::Object { object: ObjectId(40), offset: Vec3::Y };
    for light in scene.lights.iter_mut().skip(1) {
        light.aim = Aim::Point(Vec3::Y);
    }
    let (read, _) = parse_scene(&write_scene(&scene)).unwrap();
    assert_eq!(read.objects[0].id, ObjectId(0));
    assert_eq!(read.lights[0].aim, Aim::Object { object: ObjectId(0), offset: Vec3::Y });
}

#[test]
fn equal_names_get_numbers_and_aims_keep_their_object() {
    let (mut scene, _) = parse_scene(preset_text()).unwrap();
    let second = Object { id: ObjectId(90), name: scene.objects[0].name.clone(), ..scene.objects[0].clone() };
    scene.objects.push(second);
    let last = ObjectId(scene.objects.len() as u32 - 1);
    scene.lights[0].aim = Aim::Object { object: ObjectId(90), offset: Vec3::Y };
    let (read, warnings) = parse_scene(&write_scene(&scene)).unwrap();
    assert_eq!(warnings, [], "the writer has made the names unique already");
    assert_eq!(read.lights[0].aim, Aim::Object { object: last, offset: Vec3::Y });

    let old = write_scene(&scene).replace(
        &format!("name: {:?}", read.objects[last.0 as usize].name),
        &format!("name: {:?}", scene.objects[0].name),
    );
    let (read, warnings) = parse_scene(&old).unwrap();
    assert_eq!(warnings.len(), 1, "{warnings:?}");
    assert!(validate(&read).is_empty());
}

// ---------------------------------------------------------------------------------------------- hostile files

/// The message of a text that must not load.
fn refused(text: &str) -> String {
    let read = parse_scene(text).map(|_| text);
    assert!(read.is_err(), "this was read without an error:\n{text}");
    read.map_or_else(|error| error.to_string(), str::to_owned)
}

const SMALL: &str = r#"(
    format: 1,
    name: "Small",
    camera: (
        position: (0.0, 1.5, 3.0),
        aim: Object(name: "Ball"),
        focal_length_mm: 85.0,
        f_number: 8.0,
        shutter_s: 0.008,
        iso: 100.0,
        white_balance_k: 5500.0,
    ),
    objects: [
        (
            name: "Ball",
            shape: Sphere(radius_m: 0.1),
            material: Preset(Chrome),
        ),
    ],
    lights: [
        (
            name: "Key",
            role: Key,
            position: (1.0, 2.0, 1.0),
            aim: Object(name: "Ball"),
            emitter: RectPanel(width_m: 0.6, height_m: 0.9),
            power: (output: FlashWs(energy_ws: 200.0), dial_stops: -1.0),
            color: Kelvin(5500.0),
        ),
    ],
)
"#;

#[test]
fn errors_name_the_field_the_value_and_the_line() {
    assert!(parse_scene(SMALL).unwrap().1.is_empty());
    // What is changed to what, and what the message must hold.
    let cases: &[(&str, &str, &[&str])] = &[
        ("f_number: 8.0", "f_number: NaN", &["camera.f_number", "NaN", "line 8"]),
        ("f_number: 8.0", "f_number: -8.0", &["camera.f_number", "-8", "line 8"]),
        ("f_number: 8.0", "f_number: \"eight\"", &["camera.f_number", "\"eight\"", "line 8", "a number is expected"]),
        ("f_number: 8.0", "f_numbr: 8.0", &["\"f_numbr\"", "did you mean \"f_number\"?", "line 8"]),
        ("iso: 100.0", "iso: inf", &["camera.iso", "inf", "line 10"]),
        ("iso: 100.0", "iso: 1e308", &["camera.iso", "1e308", "line 10"]),
        ("iso: 100.0", "iso: 1e99999", &["camera.iso", "1e99999", "line 10"]),
        ("iso: 100.0", "iso: 100.0, iso: 200.0", &["\"iso\"", "twice", "line 10"]),
        ("        iso: 100.0,\n", "", &["\"iso\"", "missing", "camera"]),
        ("focal_length_mm: 85.0", "focal_length_mm: 0.0", &["camera.focal_length_mm", "line 7"]),
        ("position: (0.0, 1.5, 3.0)", "position: (0.0, 1e308, 3.0)", &["camera.position", "1e308", "line 5"]),
        ("position: (0.0, 1.5, 3.0)", "position: (0.0, 1.5)", &["camera.position", "line 5"]),
        ("position: (0.0, 1.5, 3.0)", "position: (0.0, 1.5, \"x\")", &["camera.position", "\"x\"", "line 5"]),
        ("radius_m: 0.1", "radius_m: -0.1", &["objects[0] \"Ball\" shape.radius_m", "-0.1", "line 16"]),
        ("Sphere(radius_m: 0.1)", "Spere(radius_m: 0.1)", &["objects[0].shape", "did you mean \"Sphere\"?", "line 16"]),
        ("Preset(Chrome)", "Preset(Chrom)", &["objects[0].material", "did you mean \"Chrome\"?", "line 17"]),
        (
            "aim: Object(name: \"Ball\"),\n            emitter",
            "aim: Object(name: \"Bal\"),\n            emitter",
            &["lights[0] \"Key\" aim.name", "no object \"Bal\"", "did you mean \"Ball\"?", "line 25"],
        ),
        (
            "aim: Object(name: \"Ball\"),\n        focal",
            "aim: Object(name: \"Woman\"),\n        focal",
            &["camera.aim.name", "no object \"Woman\"", "line 6"],
        ),
        (
            "aim: Object(name: \"Ball\"),\n            emitter",
            "aim: Point(1.0, 2.0, 1.0),\n            emitter",
            &["lights[0] \"Key\" aim", "no direction", "line 25"],
        ),
        ("energy_ws: 200.0", "energy_ws: -200.0", &["lights[0] \"Key\" power.output.energy_ws", "-200", "line 27"]),
        ("dial_stops: -1.0", "dial_stops: 1e308", &["lights[0] \"Key\" power.dial_stops", "1e308", "line 27"]),
        ("FlashWs(energy_ws: 200.0)", "Lux(200.0)", &["lights[0] \"Key\" power.output", "Lux", "line 27"]),
        ("RectPanel(width_m: 0.6, height_m: 0.9)", "Surround", &["lights[0] \"Key\" power.output", "line 27"]),
        (
            "RectPanel(width_m: 0.6, height_m: 0.9)",
            "Spot(inner_deg: 40.0, outer_deg: 400.0)",
            &["lights[0] \"Key\" emitter.outer_deg", "400", "line 26"],
        ),
        ("role: Key", "role: Boss", &["lights[0].role", "Boss", "Key, Fill", "line 23"]),
        ("format: 1", "format: 2", &["format 2", "only up to 1", "line 2"]),
        ("format: 1", "format: \"one\"", &["format", "one", "line 2"]),
        ("    format: 1,\n", "", &["format: 1"]),
    ];
    let mut unclear = Vec::new();
    for (from, to, words) in cases {
        let text = SMALL.replacen(from, to, 1);
        assert_ne!(text, SMALL, "{from}");
        let message = refused(&text);
        let missing: Vec<_> = words.iter().filter(|word| !message.contains(**word)).collect();
        if !missing.is_empty() {
            unclear.push(format!("{to:?}: no {missing:?} in: {message}"));
        }
    }
    assert!(unclear.is_empty(), "{}", unclear.join("\n"));
}

#[test]
fn empty_and_binary_files_are_refused() {
    for text in ["", " \n", "\u{feff}", "\0\0\0", "()", "[]", "1", "(format: 1)", "\"", "/*", "r#\"", "PK\u{3}\u{4}"] {
        assert!(!refused(text).is_empty());
    }
    assert!(refused("").contains("empty"));
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("a.ron");
    std::fs::write(&path, b"(format: 1, name: \"\xff\xfe\"").unwrap();
    let error = load_scene(&path).unwrap_err();
    assert!(matches!(&error, LoadError::InFile { error, .. } if matches!(**error, LoadError::NotText(_))), "{error}");
    assert!(error.to_string().ends_with("a.ron"), "the path comes last: {error}");
    assert!(matches!(load_scene(&folder.path().join("none.ron")), Err(LoadError::Read { .. })));
    assert!(load_scene(folder.path()).is_err(), "a folder is no scene");
}

#[test]
fn a_file_cut_anywhere_is_refused() {
    let whole = SMALL.trim_end();
    for end in (0..whole.len()).filter(|end| whole.is_char_boundary(*end)) {
        refused(&whole[..end]);
    }
}

#[test]
fn bracket_bombs_are_refused_at_once() {
    let started = Instant::now();
    for bracket in ["(", "[", "{", "(a:", "Some(", "/*"] {
        refused(&format!("(format: 1, name: {}", bracket.repeat(1_000_000)));
    }
    let bomb = "(".repeat(200_000_000);
    assert!(matches!(parse_scene(&bomb), Err(LoadError::TooLarge { .. })));
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("bomb.ron");
    std::fs::write(&path, bomb).unwrap();
    let error = load_scene(&path).unwrap_err().to_string();
    assert!(error.contains("200 MB") && error.ends_with("bomb.ron"), "{error}");
    std::fs::write(&path, "(".repeat(FILE_LIMIT_BYTES as usize)).unwrap();
    assert!(load_scene(&path).unwrap_err().to_string().contains("nest too deep"));
    assert!(started.elapsed() < Duration::from_secs(5), "{:?}", started.elapsed());
}

#[test]
fn ten_thousand_equal_names_and_too_many_lights_do_not_hang() {
    let light = &SMALL[SMALL.find("        (\n            name: \"Key\"").unwrap()..SMALL.rfind("    ],").unwrap()];
    let with_lights = |n: usize| SMALL.replace(light, &light.repeat(n));
    let started = Instant::now();
    assert_eq!(parse_scene(&with_lights(LIST_LIMIT)).unwrap().0.lights.len(), LIST_LIMIT);
    assert!(refused(&with_lights(LIST_LIMIT + 1)).contains("10001 are too many"));
    assert!(started.elapsed() < Duration::from_secs(10), "{:?}", started.elapsed());
}

#[test]
fn missing_and_escaping_assets() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("studio.ron");
    let with_mesh = |mesh: &str| SMALL.replace("Sphere(radius_m: 0.1)", &format!("MeshFile(path: {mesh:?})"));
    std::fs::write(&path, with_mesh("models/none.obj")).unwrap();
    let loaded = load_scene(&path).unwrap();
    assert_eq!(loaded.warnings.len(), 1, "{:?}", loaded.warnings);
    let warning = loaded.warnings[0].to_string();
    assert!(warning.starts_with("objects[0] \"Ball\" shape.path: the object is left out"), "{warning}");
    for escape in ["../x.obj", "/etc/passwd", "a/../../x.obj", "C:/x.obj", "a\\x.obj", ""] {
        std::fs::write(&path, with_mesh(escape)).unwrap();
        let error = load_scene(&path).unwrap_err().to_string();
        assert!(error.contains("objects[0] \"Ball\" shape.path") && error.contains("line 16"), "{error}");
    }
    std::fs::write(folder.path().join("a.obj"), "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n").unwrap();
    std::fs::write(&path, with_mesh("a.obj")).unwrap();
    let loaded = load_scene(&path).unwrap();
    assert!(loaded.warnings.is_empty());
    assert_eq!(loaded.assets.mesh_of(&loaded.scene.objects[0].shape).unwrap().triangles.len(), 1);
}

// ---------------------------------------------------------------------------------------------- saving

#[test]
fn saving_and_loading_gives_the_same_scene() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("studio.ron");
    for preset in presets() {
        let (scene, _) = parse_scene(preset.text).unwrap();
        save_scene(&scene, &path).unwrap();
        assert_eq!(std::fs::read_to_string(&path).unwrap(), preset.text);
        assert_eq!(load_scene(&path).unwrap().scene, scene);
    }
    assert_eq!(std::fs::read_dir(folder.path()).unwrap().count(), 1, "nothing is left beside the file");
}

#[test]
fn a_scene_that_would_not_load_is_not_saved_and_the_older_file_stays() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("studio.ron");
    let (mut scene, _) = parse_scene(SMALL).unwrap();
    save_scene(&scene, &path).unwrap();
    let before = std::fs::read(&path).unwrap();
    scene.camera.iso = f32::NAN;
    let error = save_scene(&scene, &path).unwrap_err();
    assert!(matches!(error, SaveError::Invalid(_)) && error.to_string().contains("camera.iso"), "{error}");
    assert_eq!(std::fs::read(&path).unwrap(), before);
}

#[test]
fn saving_into_a_missing_folder_says_so() {
    let folder = tempfile::tempdir().unwrap();
    let (scene, _) = parse_scene(SMALL).unwrap();
    let error = save_scene(&scene, &folder.path().join("none/studio.ron")).unwrap_err();
    assert!(matches!(error, SaveError::NoFolder(_)), "{error}");
}

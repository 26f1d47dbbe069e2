//! Malformed, truncated and huge files, and paths that lead out of the scene's folder.

use super::SMALL;
use catchlight::io::{FILE_LIMIT_BYTES, LoadError, load_scene, parse_scene};
use catchlight::scene::LIST_LIMIT;

/// Returns the error message of a text that must not load.
fn refused(text: &str) -> String {
    let read = parse_scene(text).map(|_| text);
    assert!(read.is_err(), "this was read without an error:\n{text}");
    read.map_or_else(|error| error.to_string(), str::to_owned)
}

#[test]
fn errors_name_the_field_the_value_and_the_line() {
    assert!(parse_scene(SMALL).unwrap().1.is_empty());
    // Text, its replacement, and the words of the message.
    let cases: &[(&str, &str, &[&str])] = &[
        ("f_number: 8.0", "f_number: NaN", &["camera.f_number", "NaN", "line 8"]),
        ("f_number: 8.0", "f_number: -8.0", &["camera.f_number", "-8", "line 8"]),
        ("f_number: 8.0", "f_number: \"eight\"", &["camera.f_number", "\"eight\"", "line 8", "a number is expected"]),
        ("f_number: 8.0", "f_numbr: 8.0", &["\"f_numbr\"", "did you mean \"f_number\"?", "line 8"]),
        ("iso: 100.0", "iso: 100.0, nd_stops: -1.0", &["camera.nd_stops", "-1", "line 10"]),
        ("iso: 100.0", "iso: 100.0, nd_stops: 31.0", &["camera.nd_stops", "31", "0 to 30 stops", "line 10"]),
        ("iso: 100.0", "iso: 100.0, nd_stop: 3.0", &["\"nd_stop\"", "did you mean \"nd_stops\"?", "line 10"]),
        ("iso: 100.0", "iso: 100.0, focus_breathing: 1", &["camera.focus_breathing", "line 10"]),
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
        ("objects: [", "solo: (lights: [\"Kye\"]),\n    objects: [", &["solo.lights", "no light \"Kye\"", "\"Key\"?"]),
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
fn a_figure_out_of_range_that_looks_somewhere_is_refused_and_never_built() {
    let clamshell = catchlight::io::find_preset("clamshell").unwrap().text;
    assert!(clamshell.contains("gaze:") && clamshell.contains("smile: 0.4"));
    for wrong in ["smile: 1e38", "smile: -1e38"] {
        assert!(refused(&clamshell.replace("smile: 0.4", wrong)).contains("expression"));
    }
}

#[test]
fn a_tank_out_of_bounds_is_refused_and_never_built() {
    let tank = "Tank((cells: (8, 8, 8), cell_m: 0.1, terrain: Flat(height_m: 0.1), \
                springs: [(at_m: (0.0, 0.1, 0.0), litres_per_s: 1.0)], \
                blocks: [(from: (0, 0, 0), to: (1, 1, 1), content: Metal)], \
                strokes: [(content: Water, radius_m: 0.2, path_m: [(0.0, 0.3, 0.1)])], time_s: 2.0))";
    let with = |text: &str| SMALL.replacen("Sphere(radius_m: 0.1)", text, 1);
    assert!(parse_scene(&with(tank)).unwrap().1.is_empty());
    let many = |item: &str, count: usize| format!("[{}]", vec![item; count].join(", "));
    let blocks = many("(from: (0, 0, 0), to: (1, 1, 1), content: Air)", 300);
    let strokes = many("(content: Water, radius_m: 0.2, path_m: [])", 300);
    let path = many("(0.0, 0.3, 0.1)", 5000);
    let cases: &[(&str, &str, &[&str])] = &[
        ("radius_m: 0.2", "radius_m: 1.7", &["shape.strokes[0].radius_m", "1.7", "16 cells"]),
        ("radius_m: 0.2", "radius_m: NaN", &["shape.strokes[0].radius_m", "NaN"]),
        ("(0.0, 0.3, 0.1)", "(0.0, 1e30, 0.1)", &["shape.strokes[0].path_m[0]", "y"]),
        ("[(0.0, 0.3, 0.1)]", &path, &["shape.strokes", "5000 points", "4096"]),
        ("[(content: Water, radius_m: 0.2, path_m: [(0.0, 0.3, 0.1)])]", &strokes, &["shape.strokes", "300", "256"]),
        ("(8, 8, 8)", "(0, 8, 8)", &["shape.cells", "0 cells", "1 to 256", "line 16"]),
        ("(8, 8, 8)", "(257, 8, 8)", &["shape.cells", "257"]),
        ("(8, 8, 8)", "(256, 256, 256)", &["shape.cells", "16777216", "2097152"]),
        ("(8, 8, 8)", "(70000, 8, 8)", &["cells", "70000"]),
        ("(8, 8, 8)", "(-1, 8, 8)", &["cells", "-1"]),
        ("cell_m: 0.1", "cell_m: 0.0", &["shape.cell_m", "0 m"]),
        ("cell_m: 0.1", "cell_m: NaN", &["shape.cell_m", "NaN"]),
        ("Flat(height_m: 0.1)", "Flat(height_m: inf)", &["shape.terrain.height_m", "inf"]),
        ("Flat(height_m: 0.1)", "Hills(seed: 1, low_m: 0.0, high_m: 1.0, period_m: 0.0)", &["shape.terrain.period_m"]),
        (
            "Flat(height_m: 0.1)",
            "Picture(path: \"../a.png\", low_m: 0.0, high_m: 1.0)",
            &["shape.terrain.path", "must not lead out"],
        ),
        ("time_s: 2.0", "time_s: 1e9", &["shape.time_s", "1000000000", "0 to 120 s"]),
        ("time_s: 2.0", "time_s: -1.0", &["shape.time_s", "-1"]),
        ("time_s: 2.0", "time_s: 2.0, water_m: 1e30", &["shape.water_m"]),
        ("litres_per_s: 1.0", "litres_per_s: 1e30", &["shape.springs[0].litres_per_s"]),
        ("litres_per_s: 1.0", "litres_per_s: 1.0, switches_s: [2.0, 1.0]", &["shape.springs[0].switches_s", "order"]),
        ("to: (1, 1, 1)", "to: (1, 1, 1), too: 1", &["too"]),
        ("from: (0, 0, 0)", "from: (2, 0, 0)", &["shape.blocks[0].to"]),
        ("content: Metal", "content: Lava", &["Lava", "Air, Ground"]),
        ("[(from: (0, 0, 0), to: (1, 1, 1), content: Metal)]", &blocks, &["shape.blocks", "300", "256"]),
    ];
    for (from, to, words) in cases {
        let text = with(&tank.replacen(from, to, 1));
        assert_ne!(text, with(tank), "{from}");
        let message = refused(&text);
        assert!(words.iter().all(|word| message.contains(word)), "{to}: {message}");
    }
}

#[test]
fn a_fluid_out_of_bounds_is_refused_and_never_simulated() {
    let tank = "Tank((cells: (8, 8, 8), cell_m: 0.01, terrain: Flat(height_m: 0.0), water_m: 0.02, time_s: 0.1, fluid: (\
                drops: [(at_m: (0.0, 0.05, 0.0), radius_m: 0.01)], \
                jets: [(at_m: (0.0, 0.06, 0.0), radius_m: 0.01, velocity_m_s: (0.0, -1.0, 0.0), until_s: 1.0)], \
                obstacles: [(form: Ball(radius_m: 0.01), at_m: (0.0, 0.0, 0.0))])))";
    let with = |text: &str| SMALL.replacen("Sphere(radius_m: 0.1)", text, 1);
    assert!(parse_scene(&with(tank)).unwrap().1.is_empty());
    let drops = format!("drops: [{}]", ["(at_m: (0.0, 0.05, 0.0), radius_m: 0.01)"; 9].join(", "));
    let cases: &[(&str, &str, &[&str])] = &[
        ("cells: (8, 8, 8)", "cells: (128, 128, 128)", &["shape.cells", "2097152", "1048576", "line 16"]),
        ("time_s: 0.1", "time_s: 0.1, look: Sand", &["Sand", "Smooth"]),
        ("water_m: 0.02", "blocks: [(from: (0, 0, 0), to: (99, 99, 99), content: Water)]", &["shape.cell_m", "8000"]),
        ("time_s: 0.1", "time_s: 21.0", &["shape.time_s", "0 to 20 s"]),
        ("radius_m: 0.01)], jets", "radius_m: 0.0)], jets", &["shape.fluid.drops[0].radius_m", "0 m"]),
        ("radius_m: 0.01)], jets", "radius_m: 10.0)], jets", &["shape.cell_m", "particles of water"]),
        ("radius_m: 0.01, velocity", "radius_m: 100.0, velocity", &["shape.cell_m", "particles of water"]),
        ("(0.0, -1.0, 0.0)", "(0.0, -1e9, 0.0)", &["shape.fluid.jets[0].velocity_m_s", "y -1000000000"]),
        ("until_s: 1.0", "until_s: NaN", &["shape.fluid.jets[0].until_s", "NaN"]),
        ("Ball(radius_m: 0.01)", "Ball(radius_m: inf)", &["shape.fluid.obstacles[0].form.radius_m", "inf"]),
        (
            "Ball(radius_m: 0.01)",
            "Glass(floor_m: 0.02, floor_radius_m: 0.01, rim_m: 0.01, rim_radius_m: 0.01)",
            &["shape.fluid.obstacles[0].form.rim_m", "above the floor"],
        ),
        ("Ball(radius_m: 0.01)", "Teapot(radius_m: 0.01)", &["Teapot"]),
        ("drops: [(at_m: (0.0, 0.05, 0.0), radius_m: 0.01)]", &drops, &["shape.fluid.drops", "9 drops", "8"]),
        ("jets:", "springs: [], jets:", &["springs"]),
    ];
    for (from, to, words) in cases {
        let text = with(&tank.replacen(from, to, 1));
        assert_ne!(text, with(tank), "{from}");
        let message = refused(&text);
        assert!(words.iter().all(|word| message.contains(word)), "{to}: {message}");
    }
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
fn a_truncated_file_is_refused() {
    let whole = SMALL.trim_end();
    for end in (0..whole.len()).filter(|end| whole.is_char_boundary(*end)) {
        refused(&whole[..end]);
    }
}

/// Returns the place of the mistake in a text of one line that must not load: the column.
fn refused_at(text: &str) -> (usize, String) {
    let read = parse_scene(text);
    let problems = read.as_ref().err().map_or(&[][..], LoadError::problems);
    assert!(problems.len() == 1 && problems[0].line == 1, "{problems:?}");
    (problems[0].column, problems[0].message.clone())
}

#[test]
fn deeply_nested_brackets_are_refused_at_the_first_that_is_too_deep() {
    // The scan ends at the bracket beyond the limit, however many follow, and the recursive parser never runs.
    for (bracket, depth) in [("(", 1), ("[", 1), ("{", 1), ("(a:", 1), ("Some(", 1), ("([{", 3)] {
        let text = |count: usize| format!("(format: 1, name: {}", bracket.repeat(count));
        let few = refused_at(&text(40));
        assert!(few.1.contains("nest too deep") && few.0 <= text(32 / depth + 1).len(), "{bracket}: {few:?}");
        assert_eq!(few, refused_at(&text(1_000_000)), "{bracket}");
    }
    // Comments nest without recursion.
    refused(&format!("(format: 1, name: {}", "/*".repeat(1_000_000)));
}

#[test]
fn files_above_the_limit_are_refused_unread() {
    let limit = FILE_LIMIT_BYTES as usize;
    assert!(refused(&"(".repeat(limit)).contains("nest too deep"), "a file of the largest size is parsed");
    assert!(matches!(parse_scene(&"(".repeat(limit + 1)), Err(LoadError::TooLarge { .. })));
    // A file of four terabytes without content on the disk: more than memory would hold.
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("bomb.ron");
    std::fs::File::create(&path).unwrap().set_len(4_000_000_000_000).unwrap();
    let error = load_scene(&path).unwrap_err().to_string();
    assert!(error.contains("4000000 MB") && error.ends_with("bomb.ron"), "{error}");
}

#[test]
fn ten_thousand_equal_names_are_numbered_and_one_more_light_is_refused() {
    let light = &SMALL[SMALL.find("        (\n            name: \"Key\"").unwrap()..SMALL.rfind("    ],").unwrap()];
    let with_lights = |n: usize| SMALL.replace(light, &light.repeat(n));
    let (scene, warnings) = parse_scene(&with_lights(LIST_LIMIT)).unwrap();
    assert_eq!((scene.lights.len(), warnings.len()), (LIST_LIMIT, LIST_LIMIT - 1));
    assert_eq!(scene.lights.last().map(|light| light.name.as_str()), Some("Key 10000"));
    assert!(refused(&with_lights(LIST_LIMIT + 1)).contains("10001 are too many"));
}

#[test]
fn missing_assets_are_warnings_and_escaping_paths_errors() {
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

//! Variants in scene files: what is written, what is read, and what is refused.

use super::{SMALL, preset_text};
use catchlight::io::{load_scene, parse_scene, save_scene, write_scene};
use catchlight::scene::*;

/// [`SMALL`] with variants.
fn small_with(variants: &str) -> String {
    SMALL.trim_end().trim_end_matches(')').to_owned() + variants + ")\n"
}

const VARIANTS: &str = r#"    variants: (
        others: [
            (
                name: "Dim",
                camera: (f_number: 4.0),
                lights: [(light: "Key", dial_stops: -2.0, gel: Mired(100.0))],
                added_lights: [
                    (
                        name: "Rim",
                        role: Rim,
                        aim: Object(name: "Ball"),
                        position: (0.0, 2.0, -2.0),
                        emitter: Point,
                        power: (output: Lumens(800.0)),
                        color: Kelvin(5500.0),
                    ),
                ],
                hidden: ["Ball"],
            ),
            (name: "Empty", removed_lights: ["Key"]),
        ],
    ),
"#;

#[test]
fn a_file_holds_what_differs_and_the_shown_studio_is_that_of_the_file() {
    let text = small_with(VARIANTS);
    let (scene, warnings) = parse_scene(&text).unwrap();
    assert_eq!(
        warnings,
        [Finding::warning("variants.others[1] \"Empty\"", "lights: there is no light; the picture will be black")]
    );
    let (plain, _) = parse_scene(SMALL).unwrap();
    assert_eq!(scene.without_variants(), plain, "the studio itself is as it was");
    let dim = scene.as_variant(scene.variants.named("Dim").unwrap()).unwrap();
    assert_eq!((dim.camera.f_number, dim.camera.iso), (4.0, 100.0));
    assert_eq!((dim.lights[0].power.dial_stops, dim.lights[0].color.gel), (-2.0, Gel::Mired(100.0)));
    let counts = [&scene, &dim].map(|scene| scene.lights[0].color.gel_loss_counts);
    assert_eq!(counts, [true, false], "a gel of an older file takes no light");
    assert_eq!((dim.lights.len(), dim.lights[1].name.as_str(), dim.objects[0].visible), (2, "Rim", false));
    let empty = scene.as_variant(scene.variants.named("Empty").unwrap()).unwrap();
    assert!(empty.lights.is_empty() && empty.objects[0].visible);

    let written = write_scene(&scene);
    assert_eq!(parse_scene(&written).unwrap().0, scene);
    assert_eq!(write_scene(&parse_scene(&written).unwrap().0), written);
    let key = "lights: [(light: \"Key\", dial_stops: -2.0, gel: Mired(100.0), gel_loss_counts: false)]";
    assert!(written.contains(key), "{written}");
}

#[test]
fn a_studio_without_variants_is_written_as_before() {
    let (mut scene, _) = parse_scene(preset_text()).unwrap();
    assert_eq!(write_scene(&scene), preset_text());
    let b = scene.add_variant("B".to_owned()).unwrap();
    scene.camera.f_number = 2.8;
    assert!(write_scene(&scene).contains("variants: ("));
    scene.remove_variant(b);
    assert_eq!(write_scene(&scene), preset_text());
}

#[test]
fn a_saved_file_opens_with_the_studio_and_a_kept_copy_with_the_shown_variant() {
    let (mut scene, _) = parse_scene(preset_text()).unwrap();
    let a = scene.clone();
    scene.add_variant("B".to_owned()).unwrap();
    scene.lights[0].on = false;
    scene.camera.position.x += 1.0;
    // The eyes of the subject follow the camera.
    catchlight::figures::follow_gazes(&mut scene);
    assert_eq!(parse_scene(&write_scene(&scene)).unwrap().0, scene);
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("a.ron");
    save_scene(&scene, &path).unwrap();
    let mut read = load_scene(&path).unwrap().scene;
    assert_eq!(read.without_variants(), a);
    let b = read.variants.named("B").unwrap();
    assert!(catchlight::figures::show_variant(&mut read, b));
    assert_eq!(read, scene);
}

#[test]
fn what_does_not_differ_is_dropped() {
    let same = "    variants: (others: [(name: \"B\", camera: (iso: 100.0), lights: [(light: \"Key\", on: true)])]),\n";
    let (scene, _) = parse_scene(&small_with(same)).unwrap();
    assert_eq!(scene.variants.others[0].difference, SetupDifference::default());
}

#[test]
fn one_light_of_two_variants_is_one_light() {
    let rim = r#"added_lights: [(name: "Rim", role: Rim, aim: Point(0, 1, 0), position: (0, 2, -2), emitter: Point,
        power: (output: Lumens(800)), color: Kelvin(5500))]"#;
    let text = small_with(&format!("variants: (others: [(name: \"B\", {rim}), (name: \"C\", {rim})]),"));
    let (scene, warnings) = parse_scene(&text).unwrap();
    assert_eq!(warnings, []);
    let ids: Vec<LightId> = scene.variants.stored_lights().map(|light| light.id).collect();
    assert_eq!(ids, [LightId(1); 2]);
    // A light with the name of another one is renamed.
    let (scene, warnings) = parse_scene(&text.replace("\"Rim\"", "\"Key\"")).unwrap();
    assert_eq!(warnings.len(), 2, "{warnings:?}");
    let names: Vec<&str> = scene.variants.stored_lights().map(|light| light.name.as_str()).collect();
    assert_eq!(names, ["Key 2", "Key 3"]);
    let written = write_scene(&scene);
    let (again, warnings) = parse_scene(&written).unwrap();
    assert_eq!((write_scene(&again), warnings), (written, Vec::new()));
}

#[test]
fn errors_in_variants_name_the_variant_the_field_and_the_line() {
    // Text, its replacement, and the words of the message. The variants begin in line 31.
    let cases: &[(&str, &str, &[&str])] = &[
        (
            "light: \"Key\"",
            "light: \"Kye\"",
            &["variants.others[0] \"Dim\" lights[0].light", "no light \"Kye\"", "line 36"],
        ),
        ("hidden: [\"Ball\"]", "hidden: [\"Bal\"]", &["hidden[0]", "did you mean \"Ball\"?", "line 48"]),
        ("removed_lights: [\"Key\"]", "removed_lights: [7]", &["removed_lights", "line 50"]),
        ("f_number: 4.0", "f_number: -4.0", &["variants.others[0] \"Dim\" camera.f_number", "-4", "line 35"]),
        ("dial_stops: -2.0", "dial_stops: 1e30", &["\"Dim\"", "power.dial_stops", "line 33"]),
        ("dial_stops: -2.0", "dial_stop: -2.0", &["did you mean \"dial_stops\"?", "line 36"]),
        (
            "Object(name: \"Ball\"),\n                        pos",
            "Object(name: \"X\"),\n                        pos",
            &["variants.others[0] \"Dim\" added_lights[0].aim.name", "no object \"X\"", "line 41"],
        ),
        ("name: \"Empty\"", "name: \" \"", &["variants.others[1]", "a name is needed", "line 50"]),
        ("others: [", "shown: \"Z\", others: [", &["variants.shown", "no variant \"Z\"", "line 32"]),
        ("others: [", "other: [", &["did you mean \"others\"?", "line 32"]),
    ];
    let mut unclear = Vec::new();
    for (from, to, words) in cases {
        let text = small_with(&VARIANTS.replacen(from, to, 1));
        assert_ne!(text, small_with(VARIANTS), "{from}");
        let message = parse_scene(&text).map(|_| String::new()).unwrap_or_else(|error| error.to_string());
        let missing: Vec<_> = words.iter().filter(|word| !message.contains(**word)).collect();
        if !missing.is_empty() {
            unclear.push(format!("{to:?}: no {missing:?} in: {message}"));
        }
    }
    assert!(unclear.is_empty(), "{}", unclear.join("\n"));
}

#[test]
fn equal_names_of_variants_get_numbers_and_too_many_are_refused() {
    let (scene, warnings) = parse_scene(&small_with("variants: (others: [(name: \"A\"), (name: \"A\")]),")).unwrap();
    let names: Vec<&str> = scene.variants.list().map(|(_, name)| name).collect();
    assert_eq!((names, warnings.len()), (vec!["A", "A 2", "A 3"], 2));
    let many = "(name: \"B\"),".repeat(100_000);
    let error = parse_scene(&small_with(&format!("variants: (others: [{many}]),"))).unwrap_err().to_string();
    assert!(error.contains("too many") && error.contains("25"), "{error}");
}

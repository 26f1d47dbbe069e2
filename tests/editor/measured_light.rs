//! Photometric files in the window: dropped, chosen, saved with the studio, refused.

use super::files::drop_file;
use super::panels::search;
use super::*;
use catchlight::scene::{Emitter, Output};

/// IES file of 1000 cd over half of all directions: 2000 pi lm.
const HALF: &str =
    "IESNA:LM-63-2002\n[LUMINAIRE] Half lamp\nTILT=NONE\n1 -1 1 2 1 1 2 0 0 0 1 1 10\n0 90\n0\n1000 1000\n";

#[test]
fn a_dropped_photometric_file_adds_a_light_or_goes_on_the_selected_one_and_travels_with_the_studio() {
    if !has_adapter() {
        return;
    }
    let (desktop, home) = (tempfile::tempdir().unwrap(), tempfile::tempdir().unwrap());
    let (lamp, file) = (desktop.path().join("half.ies"), home.path().join("studio.ron"));
    std::fs::write(&lamp, HALF).unwrap();
    let mut window = window_with_answers([file.clone()]);
    let before = scene(&window).lights.len();
    select(&mut window, &[]);
    drop_file(&mut window, &lamp);
    assert_eq!((scene(&window).lights.len(), errors(&window).len()), (before + 1, 0), "{:?}", errors(&window));
    let light = scene(&window).lights.last().unwrap().clone();
    assert_eq!((light.name.as_str(), light.photometric_file.as_deref()), ("Half lamp", Some("lamps/half.ies")));
    assert!(
        matches!(light.power.output, Output::Lumens(flux) if (flux / 6283.185 - 1.0).abs() < 1e-4),
        "{:?}",
        light.power
    );
    // On the selected light, in one step that can be undone
    let (key, depth) = (scene(&window).lights[0].clone(), undo_depth(&window));
    select(&mut window, &[Item::Light(key.id)]);
    drop_file(&mut window, &lamp);
    let changed = &scene(&window).lights[0];
    assert_eq!((changed.photometric_file.as_deref(), changed.emitter), (Some("lamps/half.ies"), key.emitter));
    assert_eq!((undo_depth(&window), scene(&window).lights.len()), (depth + 1, before + 1));
    // The inspector says what the file says; another modifier takes it off
    window.get_by_label_contains("6283 lm");
    press(&mut window, Modifiers::COMMAND, Key::S);
    assert_eq!(std::fs::read_to_string(home.path().join("lamps/half.ies")).unwrap(), HALF, "{:?}", errors(&window));
    drop_file(&mut window, &file);
    let document = window.state().document();
    assert!(document.assets().photometry("lamps/half.ies").is_some());
    assert_eq!(document.scene().lights[0].photometric_file.as_deref(), Some("lamps/half.ies"));
}

#[test]
fn a_bad_photometric_file_is_told_and_changes_nothing() {
    if !has_adapter() {
        return;
    }
    let folder = tempfile::tempdir().unwrap();
    let lamp = folder.path().join("bad.ies");
    std::fs::write(&lamp, HALF.replace("0 90", "90 0")).unwrap();
    let mut window = window_with_answers([]);
    let before = scene(&window).clone();
    drop_file(&mut window, &lamp);
    let [error] = errors(&window)[..] else { panic!("{:?}", errors(&window)) };
    assert!(error.contains("the vertical angles must ascend, but 0 follows 90"), "{error}");
    assert_eq!(scene(&window), &before);
}

#[test]
fn a_photometric_file_is_chosen_in_the_inspector_and_removed() {
    if !has_adapter() {
        return;
    }
    let folder = tempfile::tempdir().unwrap();
    let lamp = folder.path().join("half.ies");
    std::fs::write(&lamp, HALF).unwrap();
    let mut window = window_with_answers([lamp.clone(), lamp]);
    let id = scene(&window).lights[0].id;
    select(&mut window, &[Item::Light(id)]);
    click(&mut window, "IES, EULUMDAT\u{2026}");
    wait_until(&mut window, |app| app.document().scene().lights[0].photometric_file.is_some());
    assert_ne!(scene(&window).lights[0].emitter, Emitter::Point, "a panel keeps its size");
    click(&mut window, "Remove");
    assert_eq!(scene(&window).lights[0].photometric_file, None);
    // The shelf has such lights, too
    let before = scene(&window).lights.len();
    search(&mut window, "Search the shelf", "photometric");
    click(&mut window, "Add Measured light");
    wait_until(&mut window, |app| app.document().scene().lights.len() > before);
    assert_eq!(scene(&window).lights.last().unwrap().photometric_file.as_deref(), Some("lamps/half.ies"));
}

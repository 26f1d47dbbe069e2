//! The user's gear: counted in its window, first on the shelf, and heads with dials of their own.

use super::*;
use catchlight::editor::GearEntry;

/// A window with a settings folder, with two monolights and an octabox of the user's.
fn window_with_gear(folder: &Path) -> Option<Window> {
    let options = EditorOptions { settings_folder: Some(folder.to_owned()), ..EditorOptions::default() };
    let mut window = has_adapter().then(|| window(options))?;
    run(&mut window, Command::SetOwned(GearEntry::Head("Monolight 400 Ws".to_owned()), 2));
    run(&mut window, Command::SetOwned(GearEntry::Modifier("Octa 120".to_owned()), 1));
    Some(window)
}

#[test]
fn own_gear_comes_first_on_the_shelf_and_what_is_used_twice_is_told() {
    let folder = tempfile::tempdir().unwrap();
    let Some(mut window) = window_with_gear(folder.path()) else { return };
    let before = scene(&window).lights.len();
    let (own, listed) = (window.get_by_label("Add my Octa 120").rect(), window.get_by_label("Add Bare bulb").rect());
    assert!(own.bottom() <= listed.top(), "own gear is above the others");
    click(&mut window, "Add my Octa 120");
    click(&mut window, "Add my Octa 120");
    let heads: Vec<_> = scene(&window).lights[before..].iter().map(|light| light.head.clone().unwrap().name).collect();
    assert_eq!(heads, ["Monolight 400 Ws", "Monolight 400 Ws"]);
    run(&mut window, Command::ToggleGear);
    assert!(window.query_by_label("Octa 120: used twice, you own 1.").is_some());
    assert!(window.query_by_label_contains("Monolight 400 Ws: used").is_none());
    click(&mut window, "Add my Octa 120");
    assert!(scene(&window).lights.last().unwrap().head.is_none(), "no head is left");

    // The number is typed, kept, and read at the next start.
    window.get_by_label("Own Speedlight").click();
    window.run_steps(2);
    window.get_by_label("Own Speedlight").type_text("3");
    window.key_press(Key::Enter);
    settle(&mut window);
    press(&mut window, Modifiers::NONE, Key::Escape);
    assert!(window.query_by_label("Own Speedlight").is_none(), "Esc closes the window");
    let text = std::fs::read_to_string(folder.path().join("gear.ron")).unwrap();
    assert!(text.contains("Speedlight") && text.contains("owned: 3"), "{text}");
}

#[test]
fn a_light_on_a_head_of_the_list_has_the_dial_of_that_head() {
    let folder = tempfile::tempdir().unwrap();
    let Some(mut window) = window_with_gear(folder.path()) else { return };
    let key = scene(&window).lights[0].clone();
    select(&mut window, &[Item::Light(key.id)]);
    window.get_by_value("Any").click();
    settle(&mut window);
    click(&mut window, "Pack and head 1200 Ws");
    let light = scene(&window).lights[0].clone();
    let head = light.head.clone().unwrap();
    assert_eq!(head.name, "Pack and head 1200 Ws");
    let steps = light.power.dial_stops * 10.0;
    assert!((steps - steps.round()).abs() < 1e-3, "a setting in tenths: {}", light.power.dial_stops);
    let shown = format!("{:.1}", 10.0 + light.power.dial_stops);
    let has_text = |node: &egui_kittest::Node<'_>| node.value().is_some_and(|value| value.contains(&shown));
    assert!(window.get_all_by_label("Dial").any(|node| has_text(&node)), "the dial shows {shown}");
    click(&mut window, "A third of a stop more");
    assert!((scene(&window).lights[0].power.dial_stops - light.power.dial_stops - 0.3).abs() < 1e-4);
    assert!(window.query_by_label("Stated as").is_none(), "its power is the head's");
    run(&mut window, Command::Undo);
    run(&mut window, Command::Undo);
    assert_eq!(scene(&window).lights[0], key, "one step each");
}

#[test]
fn a_wrong_list_of_gear_is_told_and_left_alone() {
    let folder = tempfile::tempdir().unwrap();
    std::fs::write(folder.path().join("gear.ron"), "(format: 1, heads: [(nam").unwrap();
    let options = EditorOptions { settings_folder: Some(folder.path().to_owned()), ..EditorOptions::default() };
    let Some(mut window) = has_adapter().then(|| window(options)) else { return };
    run(&mut window, Command::SetOwned(GearEntry::Head("Speedlight".to_owned()), 1));
    let errors = window.state().toasts().texts(ToastKind::Error);
    assert!(errors.iter().any(|text| text.contains("Your gear is not saved")), "{errors:?}");
    assert_eq!(std::fs::read_to_string(folder.path().join("gear.ron")).unwrap(), "(format: 1, heads: [(nam");
}

//! Solo, mute, hide and lock: in the list and by key, and their reversal.

use super::*;

fn on(window: &Window) -> Vec<bool> {
    scene(window).lights.iter().map(|l| l.on).collect()
}

#[test]
fn ending_a_solo_in_the_list_restores_the_switches() {
    let Some(mut window) = preset_window() else { return };
    let names: Vec<String> = scene(&window).lights.iter().map(|l| l.name.clone()).collect();
    click(&mut window, &format!("{} on", names[1]));
    let (before, power) = (on(&window), scene(&window).lights.iter().map(|l| l.power).collect::<Vec<_>>());
    click(&mut window, &format!("{} alone", names[0]));
    assert_eq!(on(&window).iter().filter(|on| **on).count(), 1);
    click(&mut window, &format!("{} alone", names[2]));
    assert!(on(&window)[2] && !on(&window)[0], "another takes its place");
    assert!(window.query_by_label_contains("1 of 4 alone").is_some());
    click(&mut window, "End solo");
    assert_eq!(on(&window), before);
    assert_eq!(scene(&window).lights.iter().map(|l| l.power).collect::<Vec<_>>(), power);
    assert!(scene(&window).solo.is_none() && window.query_by_label("End solo").is_none());
}

#[test]
fn unmute_and_show_restore_only_what_was_muted_or_hidden() {
    let Some(mut window) = preset_window() else { return };
    let names: Vec<String> = scene(&window).lights.iter().map(|l| l.name.clone()).collect();
    click(&mut window, &format!("{} on", names[1]));
    let before = scene(&window).clone();
    press(&mut window, Modifiers::COMMAND, Key::A);
    press(&mut window, Modifiers::NONE, Key::H);
    assert!(on(&window).iter().all(|on| !on) && scene(&window).objects.iter().all(|o| !o.visible));
    assert!(scene(&window).lights[0].muted && !scene(&window).lights[1].muted, "what was off is not muted");
    press(&mut window, Modifiers::NONE, Key::H);
    assert_eq!(*scene(&window), before);
    click(&mut window, &format!("{} muted", names[0]));
    assert!(!on(&window)[0]);
    click(&mut window, &format!("{} on", names[0]));
    assert!(on(&window)[0] && !scene(&window).lights[0].muted, "the lamp's switch ends a mute");
}

#[test]
fn locked_items_are_neither_picked_nor_moved_and_stay_locked_in_the_file() {
    let Some(mut window) = preset_window() else { return };
    let figure = scene(&window).objects[0].clone();
    let at = shown_at(&window, figure.transform.position + glam::Vec3::Y);
    click_at(&mut window, at, Modifiers::NONE);
    assert_eq!(window.state().selection().last(), Some(Item::Object(figure.id)));
    press(&mut window, Modifiers::NONE, Key::K);
    let feet = shown_at(&window, figure.transform.position);
    drag(&mut window, PointerButton::Primary, feet, feet + vec2(60.0, 10.0));
    assert_eq!(scene(&window).objects[0].transform, figure.transform, "locked things have no handles");
    press(&mut window, Modifiers::NONE, Key::Escape);
    click_at(&mut window, at, Modifiers::NONE);
    assert!(!window.state().selection().contains(Item::Object(figure.id)), "a click goes past it");
    let written = catchlight::io::write_scene(scene(&window));
    assert!(written.contains("locked: true"), "{written}");
    select(&mut window, &[Item::Object(figure.id)]);
    press(&mut window, Modifiers::NONE, Key::Delete);
    assert_eq!((scene(&window).objects.len(), errors(&window).len()), (scene(&window).objects.len(), 1));
    click(&mut window, &format!("{} locked", figure.name));
    assert_eq!(scene(&window).objects[0], figure);
}

#[test]
fn a_solo_is_kept_in_the_file_and_its_end_restores_what_was_on() {
    if !has_adapter() {
        return;
    }
    let folder = tempfile::tempdir().unwrap();
    let file = folder.path().join("solo.ron");
    let mut window = window_with_answers([file.clone(), file.clone()]);
    let names: Vec<String> = scene(&window).lights.iter().map(|l| l.name.clone()).collect();
    click(&mut window, &format!("{} on", names[3]));
    click(&mut window, &format!("{} muted", names[2]));
    let before = (on(&window), scene(&window).lights[2].muted);
    let two = [0, 3].map(|i| Item::Light(scene(&window).lights[i].id));
    select(&mut window, &two);
    press(&mut window, Modifiers::NONE, Key::O);
    assert_eq!(on(&window), [true, false, false, true], "two shine alone, one of them had been off");
    press(&mut window, Modifiers::COMMAND, Key::S);
    press(&mut window, Modifiers::COMMAND, Key::O);
    assert!(undo_depth(&window) == 0 && errors(&window).is_empty(), "{:?}", errors(&window));
    assert_eq!(on(&window), [true, false, false, true]);
    press(&mut window, Modifiers::NONE, Key::O);
    assert_eq!((on(&window), scene(&window).lights[2].muted), before);
}

#[test]
fn one_key_shows_all_hidden_objects() {
    let Some(mut window) = preset_window() else { return };
    let before = scene(&window).clone();
    let things: Vec<Item> = before.objects.iter().map(|o| Item::Object(o.id)).collect();
    assert!(things.len() > 1);
    select(&mut window, &things[..1]);
    press(&mut window, Modifiers::NONE, Key::H);
    select(&mut window, &things);
    press(&mut window, Modifiers::NONE, Key::H);
    assert!(scene(&window).objects.iter().all(|o| !o.visible));
    press(&mut window, Modifiers::SHIFT, Key::H);
    assert_eq!((scene(&window), undo_depth(&window)), (&before, 3));
}

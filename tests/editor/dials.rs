//! Dials by wish: exposures are typed, the dials follow.

use super::*;

/// Opens the window of wishes and waits until the lights are metered.
fn open_wishes(window: &mut Window) {
    window.state_mut().run(Command::ToggleDials, None, &egui::Context::default());
    window.run_steps(2);
    wait_until_shown(window, "Wish for Key softbox");
}

fn wait_until_shown(window: &mut Window, label: &str) {
    for _ in 0..MOST_FRAMES {
        if window.query_by_label(label).is_some() {
            return;
        }
        window.step();
        wait_for_next_frame(window);
    }
    panic!("{label} is not shown");
}

fn wish(window: &mut Window, name: &str, text: &str) {
    let label = format!("Wish for {name}");
    let field = window.get_by_label(&label);
    field.focus();
    field.type_text(text);
    window.run_steps(3);
}

#[test]
fn typed_wishes_become_dials_in_one_step_that_can_be_undone() {
    let Some(mut window) = preset_window() else { return };
    let before = scene(&window).clone();
    open_wishes(&mut window);
    assert!(window.query_by_label_contains("Write a wish").is_some());
    wish(&mut window, "Key softbox", "f/11");
    wish(&mut window, "Fill umbrella", "-2");
    click(&mut window, "Set the dials");
    let lights = scene(&window).lights.clone();
    let change = |index: usize| lights[index].power.dial_stops - before.lights[index].power.dial_stops;
    // The key of the studio is at f/8: f/11 is a stop more.
    assert!((change(0) - 1.0).abs() < 0.15 && change(1) > 0.3, "{} {}", change(0), change(1));
    assert_eq!(lights[2..], before.lights[2..], "no wish, no change");
    window.state_mut().run(Command::Undo, None, &egui::Context::default());
    assert_eq!(scene(&window), &before, "one step");
    press(&mut window, Modifiers::NONE, Key::Escape);
    assert!(window.query_by_label("Wish for Key softbox").is_none());
}

#[test]
fn wishes_that_cannot_be_met_or_read_are_named() {
    let Some(mut window) = preset_window() else { return };
    open_wishes(&mut window);
    wish(&mut window, "Key softbox", "f/64");
    assert!(window.query_by_label_contains("Key softbox is at full power").is_some());
    wish(&mut window, "Fill umbrella", "8");
    assert!(window.query_by_label_contains("is no level").is_some());
    click(&mut window, "Clear wishes");
    assert!(window.query_by_label_contains("Write a wish").is_some());
    wish(&mut window, "Key softbox", "+1");
    assert!(window.query_by_label_contains("is the key, which others are relative to").is_some());
}

#[test]
fn the_rooms_part_in_the_light_is_listed_for_every_light() {
    let Some(mut window) = preset_window() else { return };
    window.state_mut().run(Command::ToggleRoomAudit, None, &egui::Context::default());
    window.run_steps(2);
    wait_until_shown(&mut window, "All light");
    for text in ["Walls", "Ceiling", "Floor", "On the background"] {
        assert!(window.query_by_label(text).is_some(), "{text}");
    }
    assert!(window.query_by_label_contains("A black ceiling:").is_some());
    press(&mut window, Modifiers::NONE, Key::Escape);
    assert!(window.query_by_label("All light").is_none());
}

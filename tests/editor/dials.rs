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
fn a_flash_of_no_known_head_reads_as_heads_do_and_more_than_full_power_is_told() {
    let Some(mut window) = preset_window() else { return };
    let key = Item::Light(scene(&window).lights[0].id);
    select(&mut window, &[key]);
    settle(&mut window);
    let mut turn_to = |stops: f64| {
        window.get_by_role_and_label(egui::accesskit::Role::Slider, "Dial").set_value_accesskit(stops);
        settle(&mut window);
        assert!((f64::from(scene(&window).lights[0].power.dial_stops) - stops).abs() < 1e-4);
        let is_shown = |text: &str| window.query_by_label(text).is_some();
        ["1/8 +0.2", "1/1 +0.8", "More than full power"].map(is_shown)
    };
    assert_eq!(turn_to(-2.8), [true, false, false]);
    assert_eq!(turn_to(0.8), [false, true, true]);
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

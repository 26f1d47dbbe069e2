//! Views from a side, orbit about the selection, and windows over the view.

use super::*;
use catchlight::editor::Side;
use catchlight::scene::Emitter;

#[test]
fn from_the_top_a_light_is_dragged_over_the_plan_and_keeps_its_height() {
    let Some(mut window) = preset_window() else { return };
    let light = scene(&window).lights[0].clone();
    select(&mut window, &[Item::Light(light.id)]);
    press(&mut window, Modifiers::NONE, Key::Num7);
    assert_eq!(window.state().viewport().view.side, Some(Side::Top));
    let from = shown_at(&window, light.position);
    drag(&mut window, PointerButton::Primary, from, from + vec2(80.0, 30.0));
    let moved = &scene(&window).lights[0];
    let by = moved.position - light.position;
    assert!(by.x > 0.1 && by.z > 0.02 && by.y.abs() < 1e-3, "{by}");
    let now = shown_at(&window, moved.position);
    assert!((now - from - vec2(80.0, 30.0)).length() < 3.0, "the light stays under the pointer: {now} from {from}");
    assert_eq!((undo_depth(&window), window.state().viewport().view.parallel), (1, true));
}

#[test]
fn sides_are_buttons_and_keys_and_an_orbit_leaves_them() {
    let Some(mut window) = preset_window() else { return };
    let view = |window: &Window| window.state().viewport().view;
    press(&mut window, Modifiers::NONE, Key::Num8);
    assert_eq!(view(&window).side, Some(Side::Front));
    click(&mut window, "Look from: Right side");
    assert_eq!(view(&window).side, Some(Side::Right));
    let frame = view(&window).frame(1.0);
    assert!((frame.forward() + glam::Vec3::X).length() < 1e-5);
    let middle = window.get_by_label("Viewport").rect().center();
    drag(&mut window, PointerButton::Middle, middle, middle + vec2(30.0, 10.0));
    assert_eq!((view(&window).side, view(&window).parallel), (None, false));
    press(&mut window, Modifiers::NONE, Key::Num5);
    assert!(view(&window).parallel);
    assert_eq!(undo_depth(&window), 0, "a view is no change of the studio");
}

#[test]
fn a_click_selects_from_the_top_as_it_does_from_anywhere() {
    let Some(mut window) = preset_window() else { return };
    let figure = scene(&window).objects[0].clone();
    press(&mut window, Modifiers::NONE, Key::Num8);
    let at = shown_at(&window, figure.transform.position + glam::Vec3::Y);
    click_at(&mut window, at, Modifiers::NONE);
    assert_eq!(window.state().selection().last(), Some(Item::Object(figure.id)));
}

#[test]
fn the_view_turns_about_what_is_selected() {
    let Some(mut window) = preset_window() else { return };
    let light = scene(&window).lights[0].clone();
    select(&mut window, &[Item::Light(light.id)]);
    let before = shown_at(&window, light.position);
    let middle = window.get_by_label("Viewport").rect().center();
    drag(&mut window, PointerButton::Middle, middle, middle + vec2(60.0, 20.0));
    assert!((shown_at(&window, light.position) - before).length() < 0.5);
}

#[test]
fn the_meter_can_be_moved_out_of_the_way_and_folded() {
    let Some(mut window) = preset_window() else { return };
    click(&mut window, "Light meter");
    // The bar of the window, at its upper edge.
    let title = |window: &Window| window.get_by_label("Light meter, dome").rect().center_top() + vec2(0.0, 14.0);
    let before = title(&window);
    drag(&mut window, PointerButton::Primary, before, before + vec2(150.0, 120.0));
    let moved = title(&window) - before;
    assert!((moved - vec2(150.0, 120.0)).length() < 2.0, "{moved}");
    let at = title(&window);
    for _ in 0..2 {
        click_at(&mut window, at, Modifiers::NONE);
    }
    assert!(window.query_by_label("Select the meter").is_none(), "folded");
}

#[test]
fn what_shapes_a_light_stands_over_its_power() {
    let Some(mut window) = preset_window() else { return };
    let light = scene(&window).lights[0].id;
    select(&mut window, &[Item::Light(light)]);
    let size = window.get_by_label("Width").rect();
    let dial = window.get_by_role_and_label(egui::accesskit::Role::Slider, "Dial").rect();
    assert!(size.bottom() < dial.top());
}

#[test]
fn a_length_is_typed_in_any_unit() {
    let Some(mut window) = preset_window() else { return };
    let light = scene(&window).lights[0].id;
    select(&mut window, &[Item::Light(light)]);
    window.get_by_label("Width").click();
    settle(&mut window);
    window.key_press_modifiers(Modifiers::COMMAND, Key::A);
    window.event(Event::Text("1.3 m".to_owned()));
    window.key_press(Key::Enter);
    settle(&mut window);
    let emitter = scene(&window).lights[0].emitter;
    assert!(
        matches!(emitter, Emitter::RectPanel { width_m, .. } if (width_m - 1.3).abs() < 1e-6),
        "{emitter:?} in a field of centimetres"
    );
}

#[test]
fn the_list_of_keys_names_every_key() {
    let Some(mut window) = preset_window() else { return };
    press(&mut window, Modifiers::NONE, Key::F1);
    for binding in &catchlight::editor::BINDINGS {
        assert!(window.query_all_by_label(binding.meaning).next().is_some(), "{}", binding.meaning);
    }
}

#[test]
fn snapped_things_stand_on_tenths_of_a_metre_and_turn_by_fifteen_degrees() {
    let Some(mut window) = preset_window() else { return };
    let figure = scene(&window).objects[0].clone();
    select(&mut window, &[Item::Object(figure.id)]);
    press(&mut window, Modifiers::NONE, Key::G);
    let feet = shown_at(&window, figure.transform.position);
    drag(&mut window, PointerButton::Primary, feet, feet + vec2(83.0, 31.0));
    let moved = scene(&window).objects[0].transform.position;
    let off_grid = (moved * 10.0 - (moved * 10.0).round()).abs().max_element();
    assert!(moved != figure.transform.position && off_grid < 1e-4, "{moved}");
    // The outer ring of the turning handles lies 70 points about their middle and turns in the plane of the screen.
    press(&mut window, Modifiers::NONE, Key::Num7);
    press(&mut window, Modifiers::NONE, Key::T);
    let middle = shown_at(&window, moved);
    let ring = handle_along(&mut window, (55..100).map(|r| middle + vec2(r as f32, 0.0)));
    drag(&mut window, PointerButton::Primary, ring, ring + vec2(-8.0, 41.0));
    let turned = scene(&window).objects[0].transform.rotation_deg;
    let steps = (turned.y - figure.transform.rotation_deg.y) / 15.0;
    assert!(steps != 0.0 && (steps - steps.round()).abs() < 1e-3, "{turned}");
}

#[test]
fn a_thing_grows_by_its_handles_and_comes_back_by_undo() {
    let Some(mut window) = preset_window() else { return };
    click(&mut window, "Props");
    click(&mut window, "Add Chrome ball");
    let Some(Item::Object(id)) = window.state().selection().last() else { panic!("the ball is selected") };
    let ball = scene(&window).object(id).unwrap().clone();
    let depth = undo_depth(&window);
    press(&mut window, Modifiers::NONE, Key::Num8);
    press(&mut window, Modifiers::NONE, Key::Z);
    let middle = shown_at(&window, ball.transform.position);
    let handle = handle_along(&mut window, (20..90).map(|r| middle - vec2(0.0, r as f32)));
    drag(&mut window, PointerButton::Primary, handle, handle - vec2(0.0, 40.0));
    let grown = scene(&window).object(id).unwrap().transform.scale;
    assert!(grown.y > 1.2 * ball.transform.scale.y, "{grown}");
    assert_eq!(undo_depth(&window), depth + 1);
    press(&mut window, Modifiers::COMMAND, Key::Z);
    assert_eq!(scene(&window).object(id), Some(&ball));
}

#[test]
fn a_turn_is_typed_in_degrees() {
    let Some(mut window) = preset_window() else { return };
    let figure = scene(&window).objects[0].clone();
    select(&mut window, &[Item::Object(figure.id)]);
    press(&mut window, Modifiers::NONE, Key::Num7);
    press(&mut window, Modifiers::NONE, Key::T);
    let middle = shown_at(&window, figure.transform.position);
    let ring = handle_along(&mut window, (55..100).map(|r| middle + vec2(r as f32, 0.0)));
    button(&mut window, ring, true);
    move_to(&mut window, ring + vec2(-5.0, 30.0));
    for (key, letter) in [(Key::Num3, "3"), (Key::Num0, "0")] {
        window.key_press(key);
        window.event(Event::Text(letter.to_owned()));
        window.step();
    }
    window.key_press(Key::Enter);
    window.step();
    button(&mut window, ring, false);
    settle(&mut window);
    let turn = scene(&window).objects[0].transform.rotation_deg.y - figure.transform.rotation_deg.y;
    assert!((turn.abs() - 30.0).abs() < 1e-2, "{turn} degrees");
}

/// Everything that is written in the window, without the widgets' own names.
fn painted(window: &Window) -> Vec<String> {
    let shapes = window.output().shapes.iter().map(|clipped| &clipped.shape);
    shapes
        .filter_map(
            |shape| if let egui::Shape::Text(text) = shape { Some(text.galley.text().to_owned()) } else { None },
        )
        .collect()
}

#[test]
fn the_plan_writes_the_distances_of_lights_and_camera_and_follows_a_move() {
    let Some(mut window) = preset_window() else { return };
    press(&mut window, Modifiers::NONE, Key::Num7);
    window.step();
    let written = |window: &Window| {
        let key = &scene(window).lights[0];
        format!("{:.2} m", (scene(window).aim_point(&key.aim, key.position) - key.position).length())
    };
    let before = written(&window);
    assert!(painted(&window).contains(&before), "{before} in {:?}", painted(&window));
    assert!(painted(&window).iter().any(|text| text.starts_with("Camera\n")));
    let mut key = scene(&window).lights[0].clone();
    key.position.x += 0.7;
    run(&mut window, Command::Do(Action::SetLight(Box::new(key))));
    let after = written(&window);
    assert!(after != before && painted(&window).contains(&after), "{after} in {:?}", painted(&window));
}

#[test]
fn a_light_is_mirrored_to_the_other_side_and_back() {
    let Some(mut window) = preset_window() else { return };
    let key = scene(&window).lights[0].clone();
    select(&mut window, &[Item::Light(key.id)]);
    press(&mut window, Modifiers::NONE, Key::X);
    assert!((scene(&window).lights[0].position - key.position).length() > 0.5, "it stands on the other side");
    press(&mut window, Modifiers::NONE, Key::X);
    assert!((scene(&window).lights[0].position - key.position).length() < 1e-4);
    assert_eq!((scene(&window).lights.len(), undo_depth(&window)), (4, 2));
}

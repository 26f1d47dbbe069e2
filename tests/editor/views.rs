//! Views from a side, orbits about the selection, and windows over the viewport.

use super::*;
use catchlight::editor::ViewSide;
use catchlight::scene::Emitter;
use egui_kittest::kittest::NodeT;
use glam::Vec3;
use std::f32::consts::FRAC_1_SQRT_2;

#[test]
fn from_the_top_a_light_is_dragged_over_the_plan_and_keeps_its_height() {
    let Some(mut window) = preset_window() else { return };
    let light = scene(&window).lights[0].clone();
    select(&mut window, &[Item::Light(light.id)]);
    press(&mut window, Modifiers::NONE, Key::Num7);
    assert_eq!(window.state().viewport().view.side, Some(ViewSide::Top));
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
    assert_eq!(view(&window).side, Some(ViewSide::Front));
    click(&mut window, "Look from: Right side");
    assert_eq!(view(&window).side, Some(ViewSide::Right));
    let frame = view(&window).frame(1.0);
    assert!((frame.forward() + Vec3::X).length() < 1e-5);
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
    let at = shown_at(&window, figure.transform.position + Vec3::Y);
    click_at(&mut window, at, Modifiers::NONE);
    assert_eq!(window.state().selection().last(), Some(Item::Object(figure.id)));
}

#[test]
fn an_orbit_keeps_the_selection_at_its_screen_position() {
    let Some(mut window) = preset_window_at(0.5) else { return };
    let light = scene(&window).lights[0].clone();
    select(&mut window, &[Item::Light(light.id)]);
    let before = shown_at(&window, light.position);
    let middle = window.get_by_label("Viewport").rect().center();
    drag(&mut window, PointerButton::Middle, middle, middle + vec2(60.0, 20.0));
    assert!((shown_at(&window, light.position) - before).length() < 0.5);
}

#[test]
fn the_meter_can_be_moved_out_of_the_way_and_folded() {
    let Some(mut window) = preset_window_at(1.0) else { return };
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
fn the_modifier_rows_come_before_the_power_rows() {
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
    // Ctrl+2 to Ctrl+9 are described beside Ctrl+1
    for binding in catchlight::editor::KEY_BINDINGS.iter().filter(|binding| !binding.meaning.is_empty()) {
        assert!(window.query_all_by_label(binding.meaning).next().is_some(), "{}", binding.meaning);
    }
}

#[test]
fn snapped_moves_are_multiples_of_ten_centimetres_and_rotations_of_fifteen_degrees() {
    let Some(mut window) = preset_window() else { return };
    let figure = scene(&window).objects[0].clone();
    select(&mut window, &[Item::Object(figure.id)]);
    press(&mut window, Modifiers::NONE, Key::G);
    let feet = shown_at(&window, figure.transform.position);
    drag(&mut window, PointerButton::Primary, feet, feet + vec2(83.0, 31.0));
    let moved = scene(&window).objects[0].transform.position;
    let off_grid = (moved * 10.0 - (moved * 10.0).round()).abs().max_element();
    assert!(moved != figure.transform.position && off_grid < 1e-4, "{moved}");
    // The outer ring of the turning handles lies 70 points about their middle and turns in the plane of the screen. On a
    // diagonal no other ring is met, which the view from above shows as lines.
    press(&mut window, Modifiers::NONE, Key::Num7);
    press(&mut window, Modifiers::NONE, Key::T);
    let middle = shown_at(&window, moved);
    let ring = handle_along(&mut window, (55..100).map(|r| middle + egui::Vec2::splat(r as f32 * FRAC_1_SQRT_2)));
    drag(&mut window, PointerButton::Primary, ring, ring + vec2(-8.0, 41.0));
    let turned = scene(&window).objects[0].transform.rotation_deg;
    let steps = (turned.y - figure.transform.rotation_deg.y) / 15.0;
    assert!(steps != 0.0 && (steps - steps.round()).abs() < 1e-3, "{turned}");
}

#[test]
fn a_scale_handle_enlarges_an_object_and_undo_restores_it() {
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
fn a_rotation_is_typed_in_degrees() {
    let Some(mut window) = preset_window() else { return };
    let figure = scene(&window).objects[0].clone();
    select(&mut window, &[Item::Object(figure.id)]);
    press(&mut window, Modifiers::NONE, Key::Num7);
    press(&mut window, Modifiers::NONE, Key::T);
    let middle = shown_at(&window, figure.transform.position);
    let ring = handle_along(&mut window, (55..100).map(|r| middle + egui::Vec2::splat(r as f32 * FRAC_1_SQRT_2)));
    button(&mut window, ring, true);
    move_to(&mut window, ring + vec2(-5.0, 30.0));
    type_number(&mut window, "30");
    window.key_press(Key::Enter);
    window.step();
    button(&mut window, ring, false);
    settle(&mut window);
    let turn = scene(&window).objects[0].transform.rotation_deg.y - figure.transform.rotation_deg.y;
    assert!((turn.abs() - 30.0).abs() < 1e-2, "{turn} degrees");
}

#[test]
fn a_scale_factor_is_typed_and_backspace_removes_a_digit() {
    let Some(mut window) = preset_window() else { return };
    click(&mut window, "Props");
    click(&mut window, "Add Chrome ball");
    let Some(Item::Object(id)) = window.state().selection().last() else { panic!("the ball is selected") };
    let (ball, depth) = (scene(&window).object(id).unwrap().transform, undo_depth(&window));
    press(&mut window, Modifiers::NONE, Key::Num8);
    press(&mut window, Modifiers::NONE, Key::Z);
    let middle = shown_at(&window, ball.position);
    let handle = handle_along(&mut window, (20..90).map(|r| middle - vec2(0.0, r as f32)));
    button(&mut window, handle, true);
    move_to(&mut window, handle - vec2(0.0, 25.0));
    type_number(&mut window, "2.57");
    window.key_press(Key::Backspace);
    window.step();
    // Without Enter the number holds, too, as long as the button is held.
    let scale = scene(&window).object(id).unwrap().transform.scale;
    assert!((scale / ball.scale - Vec3::new(1.0, 2.5, 1.0)).length() < 1e-4, "{scale} of {}", ball.scale);
    button(&mut window, handle, false);
    settle(&mut window);
    assert_eq!((scene(&window).object(id).unwrap().transform.scale, undo_depth(&window)), (scale, depth + 1));
}

#[test]
fn ctrl_inverts_snapping_for_one_drag() {
    let Some(mut window) = preset_window() else { return };
    let figure = scene(&window).objects[0].clone();
    select(&mut window, &[Item::Object(figure.id)]);
    for (snap, by) in [(false, vec2(83.0, 31.0)), (true, vec2(-47.0, 19.0))] {
        let feet = shown_at(&window, scene(&window).objects[0].transform.position);
        window.event(Event::ModifiersChanged(Modifiers::COMMAND));
        drag(&mut window, PointerButton::Primary, feet, feet + by);
        window.event(Event::ModifiersChanged(Modifiers::NONE));
        let moved = scene(&window).objects[0].transform.position;
        let off_grid = (moved * 10.0 - (moved * 10.0).round()).abs().max_element();
        assert_eq!(off_grid < 1e-3, !snap, "{moved}");
        press(&mut window, Modifiers::NONE, Key::G);
    }
}

#[test]
fn a_light_rotated_by_its_ring_orbits_its_target() {
    let Some(mut window) = preset_window() else { return };
    let light = scene(&window).lights[0].clone();
    let target = scene(&window).aim_point(&light.aim, light.position);
    select(&mut window, &[Item::Light(light.id)]);
    press(&mut window, Modifiers::NONE, Key::Num7);
    press(&mut window, Modifiers::NONE, Key::T);
    let middle = shown_at(&window, target);
    // Along the diagonal, where the rings that are seen from their edges do not lie.
    let ring = handle_along(&mut window, (35..75).map(|r| middle + vec2(r as f32, r as f32)));
    drag(&mut window, PointerButton::Primary, ring, ring + vec2(-30.0, 30.0));
    let now = &scene(&window).lights[0];
    let (arm, before) = (now.position - target, light.position - target);
    assert!((now.position - light.position).length() > 0.2 && (arm.length() - before.length()).abs() < 1e-3, "{arm}");
    // The outer ring turns about the line to the eye, which is not quite the vertical beside the middle of the view.
    assert!((arm.y - before.y).abs() < 0.01, "from the top it turns about the vertical: {arm} from {before}");
    assert_eq!((now.aim, undo_depth(&window)), (light.aim, 1));
}

#[test]
fn every_end_of_the_axis_widget_selects_its_side_view() {
    let Some(mut window) = preset_window() else { return };
    let free = window.state().viewport().view;
    for side in ViewSide::ALL {
        click(&mut window, &format!("Look from: {}", side.label()));
        let view = window.state().viewport().view;
        assert_eq!((view.side, view.parallel), (Some(side), true));
        assert!((view.frame(1.0).forward() + side.away()).length() < 1e-5, "{side:?}");
        // Back to a view in which no end hides another.
        let middle = window.get_by_label("Viewport").rect().center();
        drag(&mut window, PointerButton::Middle, middle, middle + vec2(47.0, 38.0));
        assert!(window.state().viewport().view.side.is_none());
    }
    assert_eq!(window.state().viewport().view.distance_m, free.distance_m);
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
    run(&mut window, Command::Apply(Action::SetLight(Box::new(key))));
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

#[test]
fn the_meter_and_its_dials_stay_over_the_rendered_picture_and_the_tools_in_their_places() {
    let Some(mut window) = preset_window() else { return };
    click(&mut window, "Light meter");
    wait_until(&mut window, |app| app.meter().reading().is_some());
    // The list of the studio has a button of that name, too
    let button = |window: &Window| {
        let buttons = window.get_all_by_role_and_label(egui::accesskit::Role::Button, "Light meter");
        buttons.map(|button| button.rect()).min_by(|a, b| a.top().total_cmp(&b.top())).unwrap()
    };
    let before = button(&window);
    render_tiny(&mut window);
    assert_eq!(window.state().central_view(), CentralView::Picture);
    assert!(window.query_by_label_contains("key:fill").is_some(), "the reading is there");
    assert_eq!(button(&window), before);
    // It follows the dials over the picture.
    let mut light = scene(&window).lights[0].clone();
    light.power.dial_stops -= 1.0;
    let read = |window: &Window| window.state().meter().reading().unwrap().as_ref().unwrap().f_number();
    let brighter = read(&window);
    run(&mut window, Command::Apply(Action::SetLight(Box::new(light))));
    assert!(read(&window) < brighter);
    assert_eq!(window.state().central_view(), CentralView::Picture);
    // Handles have nothing to hold on to there.
    let is_enabled = |window: &Window| {
        let turn = window.get_by_role_and_label(egui::accesskit::Role::Button, "Turn");
        !turn.accesskit_node().is_disabled()
    };
    assert!(!is_enabled(&window));
    press(&mut window, Modifiers::NONE, Key::Num1);
    assert!(is_enabled(&window));
}

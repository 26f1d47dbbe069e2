//! The camera's inspector: ND filter and focus.

use super::*;
use catchlight::scene::Focus;

#[test]
fn an_nd_filter_is_chosen_by_name_stepped_in_thirds_and_undone() {
    let Some(mut window) = preset_window() else { return };
    select(&mut window, &[Item::Camera]);
    click(&mut window, "ND filter by name");
    click(&mut window, "3 stops (ND8, 0.9)");
    assert_eq!(scene(&window).camera.nd_stops, 3.0);
    click(&mut window, "ND filter up");
    assert!((scene(&window).camera.nd_stops - 10.0 / 3.0).abs() < 1e-6);
    window.get_by_role_and_label(egui::accesskit::Role::SpinButton, "ND filter").set_value_accesskit(6.6);
    settle(&mut window);
    assert!((scene(&window).camera.nd_stops - 6.6).abs() < 1e-6);
    assert_eq!(undo_depth(&window), 3);
    for _ in 0..3 {
        press(&mut window, Modifiers::COMMAND, Key::Z);
    }
    assert_eq!(scene(&window).camera.nd_stops, 0.0);
}

#[test]
fn the_inspector_shows_magnification_and_bellows_factor_of_a_macro_lens() {
    let Some(mut window) = preset_window() else { return };
    let mut camera = scene(&window).camera.clone();
    (camera.focal_length_mm, camera.focus, camera.f_number) = (100.0, Focus::Distance(0.2), 8.0);
    run(&mut window, Command::Apply(Action::SetCamera(Box::new(camera))));
    select(&mut window, &[Item::Camera]);
    assert!(window.query_by_label_contains("stops: as").is_none(), "breathing is off");
    // The section is below the edge of the panel.
    window.get_by_label("Focus breathing").click_accesskit();
    settle(&mut window);
    assert!(scene(&window).camera.focus_breathing);
    assert!(window.query_by_label("1.0:1, \u{2212}2.00 stops: as f/16").is_some());
    assert!(window.query_by_label("0.400 m").is_some(), "lens and subject are each 0.2 m from the lens");
    press(&mut window, Modifiers::COMMAND, Key::Z);
    assert!(!scene(&window).camera.focus_breathing);
}

#[test]
fn a_person_is_framed_and_metered_by_buttons_and_undone() {
    let Some(mut window) = figure_window() else { return };
    let before = scene(&window).clone();
    let person = before.objects.iter().find(|object| matches!(object.shape, Shape::Figure(_))).unwrap().id;
    window.state_mut().run(Command::Select(Some(Item::Object(person))), None, &egui::Context::default());
    settle(&mut window);
    click(&mut window, "Full length");
    let full = scene(&window).camera.clone();
    assert!(full.position.distance(before.camera.position) > 0.5, "{:?}", full.position);
    click(&mut window, "Head and shoulders");
    assert!(scene(&window).camera.position.z < full.position.z);
    click(&mut window, "Aim, focus and meter");
    assert!(scene(&window).meter.is_some() && matches!(scene(&window).camera.aim, Aim::Object { .. }));
    for _ in 0..3 {
        window.state_mut().run(Command::Undo, None, &egui::Context::default());
    }
    assert_eq!(scene(&window), &before);
}

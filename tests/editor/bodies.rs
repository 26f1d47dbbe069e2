//! Bodies of lights in the window.

use super::*;
use catchlight::scene::{Bodies, BodyChoice};

fn apply(window: &mut Window, action: Action) {
    window.state_mut().run(Command::Apply(action), None, &egui::Context::default());
    settle(window);
}

#[test]
fn a_light_in_the_picture_is_told_and_hidden_from_the_camera_at_a_click() {
    let Some(mut window) = preset_window() else { return };
    let mut light = scene(&window).lights[0].clone();
    let camera = scene(&window).camera.clone();
    // Between camera and subject
    light.position = camera.position.lerp(glam::Vec3::new(0.0, 1.5, 0.0), 0.6);
    apply(&mut window, Action::SetLight(Box::new(light.clone())));
    apply(&mut window, Action::SetBodies(Bodies::On));
    assert_eq!(scene(&window).bodies, Bodies::On);
    click(&mut window, &light.name);
    assert!(window.query_by_label_contains("It stands in the picture").is_some());
    window.get_by_label("Hide from camera").scroll_to_me();
    settle(&mut window);
    click(&mut window, "Hide from camera");
    assert_eq!(scene(&window).lights[0].body, BodyChoice::InReflections);
    assert!(window.query_by_label_contains("It stands in the picture").is_none());
    for _ in 0..2 {
        press(&mut window, Modifiers::COMMAND, Key::Z);
    }
    assert_eq!((scene(&window).lights[0].body, scene(&window).bodies), (BodyChoice::AsStudio, Bodies::Off));
}

#[test]
fn the_room_has_the_bodies_of_all_lights() {
    let Some(mut window) = preset_window() else { return };
    click(&mut window, "Room");
    let shows = |window: &Window, bodies: Bodies| {
        let mut lists = window.query_all_by_role(egui::accesskit::Role::ComboBox);
        lists.any(|list| list.value().is_some_and(|value| value == bodies.label()))
    };
    assert!(shows(&window, Bodies::Off) && !shows(&window, Bodies::InReflections));
    apply(&mut window, Action::SetBodies(Bodies::InReflections));
    assert!(shows(&window, Bodies::InReflections) && !shows(&window, Bodies::Off));
}

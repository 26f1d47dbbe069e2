//! Handles, clicks, navigation, and when the live view is drawn.

use super::*;

#[test]
fn a_light_moves_by_its_handles_in_one_step() {
    if !has_adapter() {
        return;
    }
    let mut window = window_with_answers([]);
    let light = scene(&window).lights[0].clone();
    click(&mut window, &light.name);
    let view = window.get_by_label("Viewport").rect();
    let frame = window.state().viewport().view.frame(view.width() / view.height());
    let place = frame.project(light.position).unwrap();
    let middle = view.min + vec2(place.x * view.width(), place.y * view.height());
    drag(&mut window, PointerButton::Primary, middle, middle + vec2(60.0, -40.0));
    let moved = &scene(&window).lights[0];
    assert!((moved.position - light.position).length() > 0.1, "{} from {}", moved.position, light.position);
    assert_eq!((undo_depth(&window), moved.aim), (1, light.aim));
    let now = frame.project(moved.position).unwrap();
    let travelled = vec2((now.x - place.x) * view.width(), (now.y - place.y) * view.height());
    assert!((travelled - vec2(60.0, -40.0)).length() < 3.0, "the light stays under the pointer: {travelled}");
}

#[test]
fn a_figure_slides_over_the_floor_by_the_ring_at_its_feet() {
    if !has_adapter() {
        return;
    }
    let mut window = window_with_answers([]);
    let figure = scene(&window).objects[0].clone();
    click(&mut window, &figure.name);
    let view = window.get_by_label("Viewport").rect();
    let frame = window.state().viewport().view.frame(view.width() / view.height());
    let place = frame.project(figure.transform.position).unwrap();
    let feet = view.min + vec2(place.x * view.width(), place.y * view.height());
    drag(&mut window, PointerButton::Primary, feet, feet + vec2(70.0, 25.0));
    let moved = scene(&window).objects[0].transform.position;
    assert!((moved - figure.transform.position).length() > 0.1, "{moved}");
    assert_eq!((moved.y, undo_depth(&window)), (figure.transform.position.y, 1));
}

#[test]
fn a_click_selects_what_is_seen_there() {
    if !has_adapter() {
        return;
    }
    let mut window = window_with_answers([]);
    let (figure, light) = (scene(&window).objects[0].clone(), scene(&window).lights[1].clone());
    let view = window.get_by_label("Viewport").rect();
    let frame = window.state().viewport().view.frame(view.width() / view.height());
    let mut click_at = |point: glam::Vec3| {
        let place = frame.project(point).unwrap();
        let at = view.min + vec2(place.x * view.width(), place.y * view.height());
        window.event(Event::PointerMoved(at));
        for pressed in [true, false] {
            let (button, modifiers) = (PointerButton::Primary, Modifiers::NONE);
            window.event(Event::PointerButton { pos: at, button, pressed, modifiers });
        }
        settle(&mut window);
        window.state().selection().last()
    };
    assert_eq!(click_at(figure.transform.position + glam::Vec3::Y), Some(Item::Object(figure.id)));
    assert_eq!(click_at(light.position), Some(Item::Light(light.id)));
    assert_eq!(click_at(glam::Vec3::new(-2.9, 0.3, -4.0)), None, "the room is no thing to be selected by a click");
}

#[test]
fn the_mouse_orbits_pans_and_zooms_without_touching_the_scene() {
    if !has_adapter() {
        return;
    }
    let mut window = window_with_answers([]);
    let before = scene(&window).clone();
    let middle = window.get_by_label("Viewport").rect().center();
    let view = |window: &Window| window.state().viewport().view;
    let start = view(&window);
    drag(&mut window, PointerButton::Middle, middle, middle + vec2(80.0, 20.0));
    assert!(view(&window).yaw_rad != start.yaw_rad && view(&window).target == start.target);
    window.event(Event::PointerMoved(middle));
    window.event(Event::MouseWheel {
        unit: egui::MouseWheelUnit::Line,
        delta: vec2(0.0, 3.0),
        source: egui::MouseWheelSource::Wheel,
        phase: egui::TouchPhase::Move,
        modifiers: Modifiers::NONE,
    });
    settle(&mut window);
    assert!(view(&window).distance_m < start.distance_m);
    let eye = view(&window).eye();
    window.key_down(Key::W);
    window.run_steps(5);
    window.key_up(Key::W);
    settle(&mut window);
    assert!((view(&window).eye() - eye).length() > 0.05, "W flies");
    assert_eq!((scene(&window), undo_depth(&window)), (&before, 0));
}

#[test]
fn nothing_is_drawn_while_nothing_changes() {
    if !has_adapter() {
        return;
    }
    let mut window = window_with_answers([]);
    let draws = window.state().viewport().preview.draws();
    assert!(draws > 0, "{:?}", window.state().viewport().preview.failure());
    for _ in 0..10 {
        window.step();
        let delay = window.output().viewport_output[&ViewportId::ROOT].repaint_delay;
        assert!(delay > Duration::from_secs(1), "asks for a frame in {delay:?}");
    }
    assert_eq!(window.state().viewport().preview.draws(), draws);
    click(&mut window, "Add Bare bulb");
    assert!(window.state().viewport().preview.draws() > draws);
}

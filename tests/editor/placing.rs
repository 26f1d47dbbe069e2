//! Placing lights by highlight, light or shadow, and navigation through a light.

use super::*;
use glam::Vec3;

/// A window with a ball that is large enough to drag over, selected last the first light.
fn with_a_ball() -> (Window, usize) {
    let mut window = window_with_answers([]);
    click(&mut window, "Props");
    click(&mut window, "Add Chrome ball");
    let Some(Item::Object(id)) = window.state().selection().last() else { panic!("the ball is selected") };
    let mut ball = scene(&window).object(id).unwrap().clone();
    ball.transform.position = Vec3::new(0.9, 1.2, 0.8);
    ball.transform.scale = Vec3::splat(3.0);
    run(&mut window, Command::Apply(Action::SetObject(Box::new(ball))));
    let light = scene(&window).lights[0].id;
    select(&mut window, &[Item::Light(light)]);
    let index = scene(&window).objects.iter().position(|o| o.id == id).unwrap();
    (window, index)
}

#[test]
fn a_highlight_is_dragged_over_a_ball_and_the_light_follows_in_one_step() {
    if !has_adapter() {
        return;
    }
    let (mut window, ball) = with_a_ball();
    let (start, depth) = (scene(&window).lights[0].clone(), undo_depth(&window));
    let centre = scene(&window).objects[ball].transform.position;
    press(&mut window, Modifiers::NONE, Key::P);
    assert!(window.state().viewport().tool.is_some());
    let [from, to] = [Vec3::new(0.0, 0.05, 0.2), Vec3::new(-0.1, 0.12, 0.2)].map(|p| shown_at(&window, centre + p));
    drag(&mut window, PointerButton::Primary, from, to);
    let (scene, light) = (scene(&window), &scene(&window).lights[0]);
    let point = scene.aim_point(&light.aim, light.position);
    assert!((shown_at(&window, point) - to).length() < 2.0, "the light is aimed at the point under the pointer");
    let half = ((light.position - point).normalize() + (scene.camera.position - point).normalize()).normalize();
    // The mesh's smooth normals stray from the ball's by less than a degree.
    assert!(half.dot((point - centre).normalize()) > 0.999_8, "{half}");
    let distance = |l: &catchlight::scene::Light| (scene.aim_point(&l.aim, l.position) - l.position).length();
    assert!((distance(light) - distance(&start)).abs() < 1e-3, "at its distance");
    assert_eq!(undo_depth(&window), depth + 1);
    press(&mut window, Modifiers::NONE, Key::Escape);
    assert!(window.state().viewport().tool.is_none() && !window.state().selection().is_empty());
    press(&mut window, Modifiers::COMMAND, Key::Z);
    assert_eq!(super::scene(&window).lights[0], start);
}

#[test]
fn a_light_placed_on_a_point_lies_along_its_normal() {
    if !has_adapter() {
        return;
    }
    let (mut window, ball) = with_a_ball();
    let centre = scene(&window).objects[ball].transform.position;
    press(&mut window, Modifiers::NONE, Key::L);
    let at = shown_at(&window, centre + Vec3::new(0.05, 0.15, 0.1));
    drag(&mut window, PointerButton::Primary, at, at + vec2(1.0, 0.0));
    let light = &scene(&window).lights[0];
    let point = scene(&window).aim_point(&light.aim, light.position);
    let from = (light.position - point).normalize();
    assert!(from.dot((point - centre).normalize()) > 0.999_8, "{from}");
}

#[test]
fn in_the_view_through_a_light_an_orbit_keeps_its_distance_and_esc_ends_the_view() {
    let Some(mut window) = preset_window() else { return };
    let light = scene(&window).lights[0].clone();
    select(&mut window, &[Item::Light(light.id)]);
    press(&mut window, Modifiers::NONE, Key::V);
    assert_eq!(window.state().central_view(), CentralView::Light(light.id));
    let middle = window.get_by_label("Viewport").rect().center();
    drag(&mut window, PointerButton::Middle, middle, middle + vec2(70.0, 15.0));
    let now = scene(&window).lights[0].clone();
    let distance = |l: &catchlight::scene::Light| (scene(&window).aim_point(&l.aim, l.position) - l.position).length();
    assert!((now.position - light.position).length() > 0.1);
    assert!((distance(&now) - distance(&light)).abs() < 1e-4);
    assert_eq!((now.aim, undo_depth(&window)), (light.aim, 1));
    press(&mut window, Modifiers::NONE, Key::Escape);
    assert_eq!(window.state().central_view(), CentralView::Studio);
}

#[test]
fn a_light_that_is_aimed_at_its_subject_stays_on_it_while_either_moves() {
    let Some(mut window) = preset_window() else { return };
    let light = scene(&window).lights[0].clone();
    select(&mut window, &[Item::Light(light.id)]);
    let Aim::Object { object, offset } = light.aim else { panic!("the preset's key is aimed at its subject") };
    let mut moved = scene(&window).object(object).unwrap().clone();
    moved.transform.position += Vec3::new(0.5, 0.0, 0.3);
    run(&mut window, Command::Apply(Action::SetObject(Box::new(moved.clone()))));
    let target = scene(&window).aim_point(&scene(&window).lights[0].aim, Vec3::ZERO);
    assert!((target - moved.transform.world_from_object().transform_point3(offset)).length() < 1e-6);
    // The lock is a switch in the inspector: let go, it stays where it is aimed at now; locked again, it follows.
    window.get_by_label_contains("Stays on").click_accesskit();
    settle(&mut window);
    assert_eq!(scene(&window).lights[0].aim, Aim::Point(target));
    window.get_by_label_contains("Stays on").click_accesskit();
    settle(&mut window);
    assert!((scene(&window).aim_point(&scene(&window).lights[0].aim, Vec3::ZERO) - target).length() < 1e-5);
    assert!(matches!(scene(&window).lights[0].aim, Aim::Object { object: at, .. } if at == object));
}

#[test]
fn esc_cancels_the_drag_of_a_highlight_and_then_the_mode() {
    if !has_adapter() {
        return;
    }
    let (mut window, ball) = with_a_ball();
    let (start, depth) = (scene(&window).lights[0].clone(), undo_depth(&window));
    let at = shown_at(&window, scene(&window).objects[ball].transform.position);
    press(&mut window, Modifiers::NONE, Key::P);
    move_to(&mut window, at);
    button(&mut window, at, true);
    assert_ne!(scene(&window).lights[0], start);
    window.key_press(Key::Escape);
    window.step();
    move_to(&mut window, at + vec2(9.0, 0.0));
    button(&mut window, at + vec2(9.0, 0.0), false);
    settle(&mut window);
    assert_eq!((&scene(&window).lights[0], undo_depth(&window)), (&start, depth));
    assert!(window.state().viewport().tool.is_some());
    press(&mut window, Modifiers::NONE, Key::Escape);
    assert!(window.state().viewport().tool.is_none());
}

#[test]
fn the_shadow_of_what_a_light_is_aimed_at_is_dragged_over_the_paper() {
    let Some(mut window) = preset_window() else { return };
    let start = scene(&window).lights[0].clone();
    select(&mut window, &[Item::Light(start.id)]);
    let paper = scene(&window).objects.iter().find(|o| matches!(o.shape, Shape::Sweep { .. })).unwrap();
    let wall = paper.transform.world_from_object().transform_point3(Vec3::new(0.5, 1.3, 0.0));
    press(&mut window, Modifiers::SHIFT, Key::L);
    let at = shown_at(&window, wall);
    drag(&mut window, PointerButton::Primary, at + vec2(10.0, 5.0), at);
    let light = scene(&window).lights[0].clone();
    assert_eq!(light.aim, start.aim);
    let aim = scene(&window).aim_point(&light.aim, light.position);
    let (lit, before) = (aim - light.position, aim - start.position);
    assert!((light.position - start.position).length() > 0.1 && (lit.length() - before.length()).abs() < 1e-3);
    // The light, its aim and the point of the paper lie on a line: the paper's face is flat there.
    let shadow = wall - light.position;
    assert!(lit.cross(shadow).length() / shadow.length() < 0.01, "{} lights {aim} and {wall}", light.position);
}

#[test]
fn a_light_whose_subject_is_deleted_stays_aimed_at_its_place_and_undo_locks_it_again() {
    let Some(mut window) = preset_window() else { return };
    let before = scene(&window).clone();
    let light = before.lights[0].clone();
    let Aim::Object { object, .. } = light.aim else { panic!("the preset's key is aimed at its subject") };
    let target = before.aim_point(&light.aim, light.position);
    select(&mut window, &[Item::Object(object)]);
    press(&mut window, Modifiers::NONE, Key::H);
    assert_eq!(scene(&window).lights[0].aim, light.aim, "a hidden subject is still its subject");
    press(&mut window, Modifiers::NONE, Key::Delete);
    let released = scene(&window).lights[0].aim;
    assert!(matches!(released, Aim::Point(point) if (point - target).length() < 1e-6), "{released:?}");
    assert!(errors(&window).is_empty(), "{:?}", errors(&window));
    press(&mut window, Modifiers::COMMAND, Key::Z);
    press(&mut window, Modifiers::COMMAND, Key::Z);
    assert_eq!(*scene(&window), before);
}

#[test]
fn in_the_view_through_a_light_the_wheel_moves_it_nearer_and_a_pan_changes_its_aim() {
    let Some(mut window) = preset_window() else { return };
    let light = scene(&window).lights[0].clone();
    let target = |window: &Window| scene(window).aim_point(&scene(window).lights[0].aim, Vec3::ZERO);
    let begin = target(&window);
    select(&mut window, &[Item::Light(light.id)]);
    press(&mut window, Modifiers::NONE, Key::V);
    let middle = window.get_by_label("Viewport").rect().center();
    wheel_closer(&mut window, middle);
    let distance = (scene(&window).lights[0].position - begin).length();
    assert!(distance < 0.95 * (light.position - begin).length() && target(&window) == begin, "{distance}");
    assert_eq!(scene(&window).lights[0].aim, light.aim, "still locked on its subject");
    drag(&mut window, PointerButton::Secondary, middle, middle + vec2(60.0, 0.0));
    assert!((target(&window) - begin).length() > 0.05, "looking around aims it elsewhere");
    press(&mut window, Modifiers::NONE, Key::V);
    assert_eq!(window.state().central_view(), CentralView::Studio);
}

#[test]
fn a_locked_light_is_not_placed_and_a_message_says_why() {
    let Some(mut window) = preset_window() else { return };
    let light = scene(&window).lights[0].clone();
    select(&mut window, &[Item::Light(light.id)]);
    press(&mut window, Modifiers::NONE, Key::K);
    for key in [Key::P, Key::L] {
        press(&mut window, Modifiers::NONE, key);
        assert!(window.state().viewport().tool.is_none());
    }
    assert!(window.state().toasts().texts(ToastKind::Info).iter().any(|text| text.contains("locked")));
    press(&mut window, Modifiers::NONE, Key::X);
    assert_eq!((scene(&window).lights[0].position, errors(&window).len()), (light.position, 1));
}

//! Handles, clicks, navigation, and the redraws of the live view.

use super::*;

#[test]
fn a_light_moves_by_its_handles_in_one_step() {
    let Some(mut window) = preset_window() else { return };
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
fn a_figure_is_moved_over_the_floor_by_the_ring_at_its_feet() {
    let Some(mut window) = preset_window() else { return };
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
fn a_click_selects_the_visible_item() {
    let Some(mut window) = figure_window() else { return };
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
fn a_click_selects_the_nearer_of_two_objects_at_any_screen_scale() {
    let Some(mut window) = preset_window_at(1.0) else { return };
    click(&mut window, "Props");
    let add = |window: &mut Window, at: glam::Vec3| {
        click(window, "Add Chrome ball");
        let Some(Item::Object(id)) = window.state().selection().last() else { panic!("the ball is selected") };
        let mut ball = scene(window).object(id).unwrap().clone();
        ball.transform.position = at;
        run(window, Command::Apply(Action::SetObject(Box::new(ball))));
        Item::Object(id)
    };
    let eye = window.state().viewport().view.eye();
    let far_at = glam::Vec3::new(1.3, 0.7, 0.6);
    let far = add(&mut window, far_at);
    let near = add(&mut window, far_at.lerp(eye, 0.3));
    for scale in [1.0, 2.0, 0.75] {
        window.set_pixels_per_point(scale);
        for (shown, expected) in [(true, near), (false, far)] {
            let Item::Object(id) = near else { unreachable!() };
            let mut ball = scene(&window).object(id).unwrap().clone();
            ball.visible = shown;
            run(&mut window, Command::Apply(Action::SetObject(Box::new(ball))));
            // Handles would take the click.
            select(&mut window, &[]);
            let at = shown_at(&window, far_at);
            click_at(&mut window, at, Modifiers::NONE);
            assert_eq!(window.state().selection().last(), Some(expected), "at {scale} pixels a point");
        }
    }
}

#[test]
fn navigation_does_not_change_the_scene() {
    let Some(mut window) = preset_window() else { return };
    let before = scene(&window).clone();
    let middle = window.get_by_label("Viewport").rect().center();
    let view = |window: &Window| window.state().viewport().view;
    let start = view(&window);
    drag(&mut window, PointerButton::Middle, middle, middle + vec2(80.0, 20.0));
    assert!(view(&window).yaw_rad != start.yaw_rad && view(&window).target == start.target);
    wheel_closer(&mut window, middle);
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
    let Some(mut window) = preset_window() else { return };
    // The last change of the picture is its bounced light, which is traced in the background.
    click(&mut window, "Lit");
    click(&mut window, "Bounced light");
    press(&mut window, Modifiers::NONE, Key::Escape);
    wait_until(&mut window, |app| !app.viewport().preview.is_tracing_bounced_light());
    settle(&mut window);
    assert!(window.state().viewport().preview.has_bounced_light());
    let draws = window.state().viewport().preview.draws();
    assert!(draws > 0, "{:?}", window.state().viewport().preview.failure());
    // A job that ends late may ask for a frame
    let (mut quiet, mut frames) = (0, 0);
    while quiet < 10 {
        window.step();
        let delay = window.output().viewport_output[&ViewportId::ROOT].repaint_delay;
        quiet = if delay > Duration::from_secs(1) { quiet + 1 } else { 0 };
        frames += 1;
        assert!(frames < 40, "asks for a frame in {delay:?}");
    }
    assert_eq!(window.state().viewport().preview.draws(), draws);
    click(&mut window, "Add Bare bulb");
    assert!(window.state().viewport().preview.draws() > draws);
}

/// A small window whose live view is traced: a picture of few pixels.
fn traced_window() -> Window {
    let mut window = window_at(0.5, plain_options());
    window.set_size(vec2(900.0, 600.0));
    settle(&mut window);
    press(&mut window, Modifiers::NONE, Key::Num2);
    wait_until(&mut window, |app| app.viewport().traced_view.has_picture());
    window
}

#[test]
fn picking_handles_and_navigation_work_in_the_traced_view() {
    if !has_adapter() {
        return;
    }
    let mut window = traced_window();
    assert_eq!(window.state().viewport().traced_view.mode, LiveMode::True);
    let (figure, light) = (scene(&window).objects[0].clone(), scene(&window).lights[0].clone());
    let view = window.get_by_label("Viewport").rect();
    let frame = window.state().viewport().view.frame(view.width() / view.height());
    let place = |point: glam::Vec3| {
        let place = frame.project(point).unwrap();
        view.min + vec2(place.x * view.width(), place.y * view.height())
    };
    // Picking, handles and navigation are where they were.
    let at = place(figure.transform.position + glam::Vec3::Y);
    for pressed in [true, false] {
        window.event(Event::PointerMoved(at));
        window.event(Event::PointerButton {
            pos: at,
            button: PointerButton::Primary,
            pressed,
            modifiers: Modifiers::NONE,
        });
    }
    settle(&mut window);
    assert_eq!(window.state().selection().last(), Some(Item::Object(figure.id)));
    click(&mut window, &light.name);
    let middle = place(light.position);
    drag(&mut window, PointerButton::Primary, middle, middle + vec2(40.0, -30.0));
    assert!((scene(&window).lights[0].position - light.position).length() > 0.05);
    let before = window.state().viewport().view.yaw_rad;
    drag(&mut window, PointerButton::Middle, view.center(), view.center() + vec2(30.0, 0.0));
    assert!(window.state().viewport().view.yaw_rad != before);
    wait_until(&mut window, |app| app.viewport().traced_view.has_picture());
    // Another studio, and back to the estimate: nothing is traced any more.
    click(&mut window, "Quick");
    wait_until(&mut window, |app| app.viewport().traced_view.is_stopped());
    let rays = window.state().viewport().traced_view.rays();
    window.run_steps(6);
    assert!(window.state().viewport().traced_view.is_stopped());
    let now = window.state().viewport().traced_view.rays();
    assert!(rays > 0 && rays == now, "it goes on behind the estimate");
}

#[test]
fn dimming_a_light_traces_no_ray_and_a_settled_view_requests_no_frame() {
    if !has_adapter() {
        return;
    }
    let mut window = traced_window();
    // A view of few pixels settles soon: the window is as small as it gets, and the studio dark but for one bulb.
    window.set_size(vec2(640.0, 190.0));
    settle(&mut window);
    wait_until(&mut window, |app| app.viewport().traced_view.is_settled());
    settle(&mut window);
    let rays = window.state().viewport().traced_view.rays();
    let mut light = scene(&window).lights[0].clone();
    light.power.dial_stops -= 1.0;
    let context = egui::Context::default();
    window.state_mut().run(Command::Apply(Action::SetLight(Box::new(light))), None, &context);
    window.step();
    wait_until(&mut window, |app| app.viewport().traced_view.is_settled());
    settle(&mut window);
    assert_eq!(window.state().viewport().traced_view.rays(), rays, "dimming is developed, not traced");
    window.step();
    let delay = window.output().viewport_output[&ViewportId::ROOT].repaint_delay;
    assert!(delay > Duration::from_secs(1), "asks for a frame in {delay:?}");
    let mut light = scene(&window).lights[0].clone();
    light.position.x += 0.2;
    window.state_mut().run(Command::Apply(Action::SetLight(Box::new(light))), None, &context);
    window.step();
    wait_until(&mut window, |app| app.viewport().traced_view.rays() > rays);
}

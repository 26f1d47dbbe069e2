//! Windows that lose their GPU device, and windows without one.

use super::*;
use eframe::wgpu;
use egui_kittest::wgpu::WgpuTestRenderer;

/// A renderer for a window, and the device that it draws on.
fn renderer() -> (WgpuTestRenderer, wgpu::Device) {
    let state = create_render_state(gpu_setup(), RendererOptions::PREDICTABLE);
    let device = state.device.clone();
    (WgpuTestRenderer::from_render_state(state), device)
}

fn window_on(renderer: WgpuTestRenderer, app: impl FnOnce(&eframe::CreationContext<'_>) -> App) -> Window {
    let builder = Harness::builder().with_size(vec2(1440.0, 900.0)).with_step_dt(1.0 / 30.0).with_max_steps(60);
    let builder = builder.with_pixels_per_point(FEW_PIXELS);
    let mut window = builder.renderer(renderer).build_eframe(|creation| app(creation));
    settle(&mut window);
    window
}

fn destroy(device: &wgpu::Device) {
    device.destroy();
    let _ = device.poll(wgpu::PollType::wait_indefinitely());
}

/// Destroys the device and runs a frame, which must draw nothing and request another window.
fn lose(window: &mut Window, device: &wgpu::Device) {
    destroy(device);
    for _ in 0..2 {
        window.step();
        assert!(window.state().has_lost_window());
        assert!(window.output().shapes.is_empty(), "egui's painter ends the program on shapes without a device");
    }
    let commands = &window.output().viewport_output[&ViewportId::ROOT].commands;
    assert!(commands.contains(&ViewportCommand::Close), "{commands:?}");
}

#[test]
fn a_device_loss_keeps_the_studio_and_its_history() {
    if !has_adapter() {
        return;
    }
    let (first, device) = renderer();
    let mut window = window_on(first, |creation| App::new(creation, plain_options()));
    let begin = scene(&window).clone();
    click(&mut window, "Add Octa 120");
    press(&mut window, Modifiers::COMMAND, Key::D);
    render_tiny(&mut window);
    press(&mut window, Modifiers::NONE, Key::Num1);
    let (before, selection) = (scene(&window).clone(), window.state().selection().last());
    assert!(selection.is_some() && undo_depth(&window) == 2);
    let draws = window.state().viewport().preview.draws();
    lose(&mut window, &device);

    let mut app = window.into_state();
    let (second, device) = renderer();
    let mut window = window_on(second, |creation| {
        app.move_to(creation);
        app
    });
    let preview = &window.state().viewport().preview;
    assert!(preview.draws() > draws && preview.failure().is_none(), "{:?}", preview.failure());
    assert_eq!(*scene(&window), before);
    assert_eq!(window.state().selection().last(), selection);
    assert!(window.state().rendering().texture().is_some(), "the rendered picture came along");
    assert_eq!(window.state().toasts().texts(ToastKind::Warning).len(), 1, "the user is told");
    assert!(window.render().is_ok_and(|picture| picture.pixels().any(|p| p.0[0] > 200)), "letters and picture show");
    press(&mut window, Modifiers::COMMAND, Key::Z);
    press(&mut window, Modifiers::COMMAND, Key::Z);
    assert_eq!(*scene(&window), begin);

    // A second loss at once switches to the CPU preview until the user retries.
    lose(&mut window, &device);
    let mut app = window.into_state();
    let (third, _device) = renderer();
    let mut window = window_on(third, |creation| {
        app.move_to(creation);
        app
    });
    assert!(window.state().viewport().preview.failure().is_some_and(|why| why.contains("twice")));
    click(&mut window, "Try again");
    let preview = &window.state().viewport().preview;
    assert!(preview.failure().is_none() && !preview.is_starting());
}

#[test]
fn a_device_loss_during_a_frame_ends_that_frame() {
    if !has_adapter() {
        return;
    }
    let (first, device) = renderer();
    let mut window = window_on(first, |creation| App::new(creation, plain_options()));
    let _ = device.poll(wgpu::PollType::wait_indefinitely());
    device.destroy();
    // The loss shows when the preview draws its next picture, in the frame that draws the window.
    window.key_press(Key::Num8);
    for _ in 0..5 {
        window.step();
        if window.state().has_lost_window() {
            assert!(window.output().shapes.is_empty());
            return;
        }
    }
    panic!("the loss was not noticed");
}

#[test]
fn a_device_loss_of_a_minimised_window_is_detected() {
    if !has_adapter() {
        return;
    }
    let (first, device) = renderer();
    let mut window = window_on(first, |creation| App::new(creation, plain_options()));
    click(&mut window, "Add Octa 120");
    destroy(&device);
    let commands = sizes::while_minimised(&mut window, Vec::new());
    assert!(commands.contains(&ViewportCommand::Close) && window.state().has_lost_window(), "{commands:?}");
    let commands = sizes::while_minimised(&mut window, vec![ViewportEvent::Close]);
    assert!(!commands.contains(&ViewportCommand::CancelClose), "unsaved work is no reason to stay: it moves on");
}

/// A window whose renderer has no device at all.
fn window_without_device() -> Window {
    let builder = Harness::builder().with_size(vec2(1200.0, 800.0)).with_max_steps(60);
    let mut window = builder.build_eframe(|creation| App::new(creation, plain_options()));
    settle(&mut window);
    window
}

#[test]
fn without_a_device_the_cpu_preview_supports_all_tools() {
    let mut window = window_without_device();
    assert!(window.state().viewport().preview.failure().is_some());
    assert!(window.query_by_label("Drawn by the CPU, without shadows").is_some());
    let draws = window.state().viewport().preview.draws();
    assert!(draws > 0);
    window.run_steps(5);
    assert_eq!(window.state().viewport().preview.draws(), draws, "nothing is drawn while nothing changes");
    // A click on the figure, on a light's outline, and beside everything.
    let (figure, light) = (scene(&window).objects[0].clone(), scene(&window).lights[0].clone());
    let at = shown_at(&window, figure.transform.position + glam::Vec3::Y);
    click_at(&mut window, at, Modifiers::NONE);
    assert_eq!(window.state().selection().last(), Some(Item::Object(figure.id)));
    let corner = scene(&window).light_frame(&light).transform_point3(corner_of(&light.emitter));
    let at = shown_at(&window, corner);
    click_at(&mut window, at, Modifiers::NONE);
    assert_eq!(window.state().selection().last(), Some(Item::Light(light.id)), "at {at}");
    let at = shown_at(&window, glam::Vec3::new(-2.0, 0.0, 1.0));
    assert!(at.distance(shown_at(&window, light.position)) > 150.0, "the floor beside the handles of the light");
    click_at(&mut window, at, Modifiers::NONE);
    assert_eq!(window.state().selection().last(), None);
    // Handles, the tracer's view over it, a render.
    select(&mut window, &[Item::Light(light.id)]);
    let from = shown_at(&window, light.position);
    drag(&mut window, PointerButton::Primary, from, from + vec2(50.0, -20.0));
    assert!((scene(&window).lights[0].position - light.position).length() > 0.05);
    press(&mut window, Modifiers::NONE, Key::Num2);
    wait_until(&mut window, |app| app.viewport().traced_view.has_picture());
    render_tiny(&mut window);
}

/// A point of the edge of a panel, in its own space.
fn corner_of(emitter: &catchlight::scene::Emitter) -> glam::Vec3 {
    use catchlight::scene::Emitter;
    match *emitter {
        Emitter::RectPanel { width_m, height_m } => 0.5 * glam::Vec3::new(width_m, height_m, 0.0),
        Emitter::RoundPanel { diameter_m } => 0.5 * diameter_m * glam::Vec3::X,
        ref other => panic!("the key of the first preset is a panel, not {other:?}"),
    }
}

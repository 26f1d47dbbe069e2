//! Windows of many sizes: resized, minimised, moved between screens.

use super::*;
use egui_kittest::kittest::NodeT;

/// Widths and heights in points. A minimised window has none on some desktops.
const SIZES: [(f32, f32); 14] = [
    (900.0, 600.0),
    (0.0, 0.0),
    (1.0, 1.0),
    (1440.0, 0.0),
    (0.0, 900.0),
    (2.0, 700.0),
    (640.0, 3.0),
    (333.0, 777.0),
    (2600.0, 1500.0),
    (1.0, 1.0),
    (801.0, 601.0),
    (320.0, 240.0),
    (1023.5, 600.3),
    (900.0, 600.0),
];

/// Goes through the sizes without waiting for anything, turning the view all the while; at the end all is as it was.
fn resize_through_all(window: &mut Window) {
    for (i, (width, height)) in (0_i16..).zip(SIZES.into_iter().chain(SIZES.into_iter().rev())) {
        window.set_size(vec2(width, height));
        window.set_pixels_per_point([1.0, 2.0, 0.75][i as usize % 3]);
        window.step();
        window.event(Event::PointerMoved(Pos2::new(0.4 * width, 0.4 * height)));
        let key = [Key::Num7, Key::Num8, Key::Num5][i as usize % 3];
        window.key_press(key);
        window.step();
    }
    window.set_pixels_per_point(1.0);
    window.set_size(vec2(900.0, 600.0));
    settle(window);
}

#[test]
fn resizing_through_many_sizes_keeps_the_gpu_preview_working() {
    let Some(mut window) = preset_window() else { return };
    let before = scene(&window).clone();
    resize_through_all(&mut window);
    let draws = window.state().viewport().preview.draws();
    press(&mut window, Modifiers::NONE, Key::Num8);
    let preview = &window.state().viewport().preview;
    assert!(preview.draws() > draws && preview.failure().is_none(), "{:?}", preview.failure());
    assert_eq!((scene(&window), errors(&window).len()), (&before, 0));
    assert!(window.render().is_ok());
}

#[test]
fn resizing_through_many_sizes_keeps_the_traced_view_working() {
    let Some(mut window) = preset_window() else { return };
    press(&mut window, Modifiers::NONE, Key::Num2);
    resize_through_all(&mut window);
    let rays = window.state().viewport().traced_view.rays();
    wait_until(&mut window, |app| {
        let live = &app.viewport().traced_view;
        live.has_picture() && live.rays() > rays
    });
    assert!(!window.state().viewport().traced_view.has_failed() && errors(&window).is_empty());
}

#[test]
fn resizing_through_many_sizes_works_on_the_cpu_and_during_a_render() {
    let builder = Harness::builder().with_size(vec2(900.0, 600.0)).with_max_steps(60);
    let mut window = builder.build_eframe(|creation| App::new(creation, EditorOptions::default()));
    settle(&mut window);
    let settings = &mut window.state_mut().rendering_mut().settings;
    (settings.size, settings.quality, settings.samples) = (PictureSize::Custom(96, 64), Quality::Custom, 16);
    window.key_press(Key::R);
    window.step();
    press(&mut window, Modifiers::NONE, Key::Num1);
    resize_through_all(&mut window);
    assert!(window.state().rendering().developed().is_some() && errors(&window).is_empty());
    // The large picture in a window of no size.
    press(&mut window, Modifiers::NONE, Key::Num3);
    for (width, height) in SIZES {
        window.set_size(vec2(width, height));
        window.step();
    }
}

/// Runs one update of a minimised window: no frame is drawn, the app's logic runs.
pub fn while_minimised(window: &mut Window, events: Vec<ViewportEvent>) -> Vec<ViewportCommand> {
    let mut input = window.input_mut().clone();
    let info = input.viewports.entry(ViewportId::ROOT).or_default();
    (info.minimized, info.events) = (Some(true), events);
    let ctx = window.ctx.clone();
    let output = ctx.run_logic(&input, |ctx| {
        eframe::App::logic(window.state_mut(), ctx, &mut eframe::Frame::_new_kittest());
    });
    output.viewport_commands.get(&ViewportId::ROOT).cloned().unwrap_or_default()
}

#[test]
fn a_minimised_window_is_restored_to_ask_before_unsaved_work_is_lost() {
    let Some(mut window) = preset_window() else { return };
    assert!(!while_minimised(&mut window, vec![ViewportEvent::Close]).contains(&ViewportCommand::CancelClose));
    click(&mut window, "Add Octa 120");
    let commands = while_minimised(&mut window, vec![ViewportEvent::Close]);
    assert!(commands.contains(&ViewportCommand::CancelClose), "{commands:?}");
    assert!(commands.contains(&ViewportCommand::Minimized(false)), "{commands:?}");
    settle(&mut window);
    click(&mut window, "Cancel");
    assert!(while_minimised(&mut window, Vec::new()).is_empty(), "it stays in the dock while nothing is asked");
}

#[test]
fn a_minimised_window_traces_nothing_until_it_is_restored() {
    let Some(mut window) = preset_window() else { return };
    press(&mut window, Modifiers::NONE, Key::Num2);
    let rays = |window: &Window| window.state().viewport().traced_view.rays();
    let goes_on = |window: &mut Window, from: u64| wait_until(window, |app| app.viewport().traced_view.rays() > from);
    goes_on(&mut window, 0);
    assert!(!window.state().viewport().traced_view.is_settled(), "there is work left");
    // The step of tracing under way ends first.
    let mut frames = 0;
    while !window.state().viewport().traced_view.is_stopped() {
        frames += 1;
        assert!(frames < MOST_FRAMES, "the view of a minimised window is still traced");
        while_minimised(&mut window, Vec::new());
        wait_for_next_frame(&window);
    }
    let last = rays(&window);
    for _ in 0..10 {
        while_minimised(&mut window, Vec::new());
        assert!(window.state().viewport().traced_view.is_stopped() && rays(&window) == last);
    }
    goes_on(&mut window, last);
}

/// Widths of the panels beside the view, points: what is left of it and what is right.
fn side_widths(window: &Window) -> [f32; 2] {
    let view = window.get_by_label("Viewport").rect();
    [view.left(), window.ctx.content_rect().right() - view.right()]
}

#[test]
fn the_narrowest_window_has_one_row_of_tools_and_a_wider_one_restores_the_panels() {
    let Some(mut window) = preset_window() else { return };
    // Dragged by its edge, the left panel keeps that width, too.
    let edge = Pos2::new(side_widths(&window)[0] - 2.0, 700.0);
    drag(&mut window, PointerButton::Primary, edge, edge + vec2(40.0, 0.0));
    let before = side_widths(&window);
    assert!(before[0] > 300.0, "{before:?}");
    resize_through_all(&mut window);
    let row = |window: &Window| window.get_by_label("Quick").rect().center().y;
    assert!((row(&window) - window.get_by_label("Tools").rect().center().y).abs() < 1.0);
    let narrow = side_widths(&window);
    assert!(narrow[0] < 240.0 && narrow[1] < 320.0, "{narrow:?}");
    window.set_size(vec2(1440.0, 900.0));
    settle(&mut window);
    let after = side_widths(&window);
    assert!((after[0] - before[0]).abs() < 1.0 && (after[1] - before[1]).abs() < 1.0, "{after:?}, not {before:?}");
}

/// Returns the fields and buttons right of the view that reach over the edge of the panel, and the panel's width.
fn cut_at_the_edge(window: &Window) -> (Vec<String>, f32) {
    use egui::accesskit::Role;
    let roles = [
        Role::Button,
        Role::CheckBox,
        Role::ComboBox,
        Role::RadioButton,
        Role::Slider,
        Role::SpinButton,
        Role::TextInput,
    ];
    let edge = window.ctx.content_rect().right() - 8.0;
    let view = window.get_by_label("Viewport").rect();
    let fields = window.query_all_by(|node| roles.contains(&node.role()));
    let cut = fields.filter(|node| node.rect().left() > view.right() && node.rect().right() > edge);
    let name = |node: egui_kittest::Node<'_>| format!("{:?} {:?}", node.accesskit_node().label(), node.rect());
    (cut.map(name).collect(), window.ctx.content_rect().right() - view.right())
}

#[test]
fn the_narrowest_inspector_shows_all_of_its_buttons_and_keeps_its_width() {
    let Some(mut window) = preset_window() else { return };
    window.set_size(vec2(900.0, 2600.0));
    let (mut all_cut, mut widths) = (Vec::new(), Vec::new());
    for index in [0, 9] {
        run(&mut window, Command::NewFromPreset(index));
        run(&mut window, Command::CameraFromView);
        click(&mut window, "Tools");
        window.get_by_label("Light meter").click();
        settle(&mut window);
        press(&mut window, Modifiers::NONE, Key::Escape);
        let items: Vec<Item> = {
            let scene = scene(&window);
            let objects = scene.objects.iter().map(|o| Item::Object(o.id));
            let lights = scene.lights.iter().map(|l| Item::Light(l.id));
            objects.chain(lights).chain([Item::Camera, Item::Room, Item::Meter]).collect()
        };
        let all = items[..2].to_vec();
        for selected in items.iter().map(|item| vec![*item]).chain([all]) {
            select(&mut window, &selected);
            let (cut, width) = cut_at_the_edge(&window);
            all_cut.extend(cut.iter().map(|name| format!("{index} {selected:?}: {name}")));
            widths.push(width);
        }
    }
    assert!(all_cut.is_empty(), "{all_cut:#?}");
    assert!(widths.iter().all(|width| (width - widths[0]).abs() < 0.5), "the panel widens: {widths:?}");
}

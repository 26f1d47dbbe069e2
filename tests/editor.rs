//! The real window, driven as a user would: egui_kittest with a wgpu device, so that the live preview runs, too.
#![cfg(feature = "gui")]
#![allow(clippy::unwrap_used, clippy::panic, reason = "a test that cannot go on says so by panicking")]

use catchlight::editor::{
    Action, Answer, App, Centre, Command, FileDialogs, Item, Options, PictureSize, Quality, Tone,
};
use catchlight::preview::Gpu;
use catchlight::scene::{Aim, Scene, Shape};
use eframe::egui::{
    self, Event, Key, Modifiers, PointerButton, Pos2, ViewportCommand, ViewportEvent, ViewportId, vec2,
};
use egui_kittest::Harness;
use egui_kittest::kittest::Queryable;
use std::collections::VecDeque;
use std::path::{Path, PathBuf};
use std::time::{Duration, Instant};

type Window = Harness<'static, App>;

/// Longest wait for a background task: machines that test are slow and shared.
const PATIENCE: Duration = Duration::from_secs(120);

/// Whether there is a graphics adapter. Without one the test says so and passes, unless `CATCHLIGHT_REQUIRE_GPU` is set.
fn has_adapter() -> bool {
    match Gpu::headless() {
        Ok(_) => true,
        Err(error) if std::env::var_os("CATCHLIGHT_REQUIRE_GPU").is_some() => panic!("{error}"),
        Err(error) => {
            eprintln!("SKIPPED, no graphics adapter: {error}");
            false
        }
    }
}

fn window(options: Options) -> Window {
    let builder = Harness::builder().with_size(vec2(1440.0, 900.0)).with_step_dt(1.0 / 30.0).with_max_steps(60);
    let mut window = builder.wgpu().build_eframe(move |creation| App::new(creation, options));
    settle(&mut window);
    window
}

fn window_with_answers(paths: impl IntoIterator<Item = PathBuf>) -> Window {
    window(Options { dialogs: FileDialogs::scripted(paths), ..Options::default() })
}

/// Runs frames until nothing is on its way and nothing asks for another frame.
fn settle(window: &mut Window) {
    let began = Instant::now();
    while window.try_run().is_err() || window.state().is_busy() {
        assert!(began.elapsed() < PATIENCE, "still busy after {PATIENCE:?}");
        std::thread::sleep(Duration::from_millis(5));
    }
}

fn click(window: &mut Window, label: &str) {
    window.get_by_label(label).click();
    settle(window);
}

fn press(window: &mut Window, modifiers: Modifiers, key: Key) {
    window.key_press_modifiers(modifiers, key);
    settle(window);
}

/// Presses at a point, moves in steps, lets go.
fn drag(window: &mut Window, button: PointerButton, from: Pos2, to: Pos2) {
    window.event(Event::PointerMoved(from));
    window.step();
    window.event(Event::PointerButton { pos: from, button, pressed: true, modifiers: Modifiers::NONE });
    window.step();
    for i in 1..=10 {
        window.event(Event::PointerMoved(from + (to - from) * (i as f32 / 10.0)));
        window.step();
    }
    window.event(Event::PointerButton { pos: to, button, pressed: false, modifiers: Modifiers::NONE });
    settle(window);
}

fn scene(window: &Window) -> &Scene {
    window.state().document().scene()
}

fn undo_depth(window: &Window) -> usize {
    window.state().document().history().depth()
}

fn errors(window: &Window) -> Vec<&str> {
    window.state().toasts().texts(Tone::Error)
}

/// Renders a picture of a few pixels.
fn render_tiny(window: &mut Window) {
    let rendering = window.state_mut().rendering_mut();
    rendering.settings.size = PictureSize::Custom(48, 32);
    rendering.settings.samples = 2;
    rendering.settings.quality = Quality::Custom;
    settle(window);
    click(window, "Render the picture");
    let rendering = window.state().rendering();
    assert!(rendering.developed().is_some(), "{:?} {:?}", rendering.job().map(|job| job.phase()), errors(window));
}

fn close_requested(window: &mut Window) -> bool {
    let root = window.input_mut().viewports.get_mut(&ViewportId::ROOT).unwrap();
    root.events.push(ViewportEvent::Close);
    window.step();
    let commands = &window.output().viewport_output[&ViewportId::ROOT].commands;
    let stays = commands.contains(&ViewportCommand::CancelClose);
    settle(window);
    !stays
}

#[test]
fn a_studio_from_the_shelf_to_a_picture_on_disk_and_back() {
    if !has_adapter() {
        return;
    }
    let folder = tempfile::tempdir().unwrap();
    let (picture, file) = (folder.path().join("portrait.png"), folder.path().join("my studio.ron"));
    let mut window = window_with_answers([picture.clone(), file.clone(), file.clone()]);
    assert!(!scene(&window).lights.is_empty(), "the first preset is open");
    let lights = scene(&window).lights.len();

    click(&mut window, "Add Octa 120");
    assert_eq!(scene(&window).lights.len(), lights + 1);
    let Some(Item::Light(id)) = window.state().selection() else { panic!("the new light is selected") };
    window.get_by_label("Position x").set_value_accesskit(-1.5);
    settle(&mut window);
    assert_eq!(scene(&window).light(id).unwrap().position.x, -1.5);

    render_tiny(&mut window);
    assert_eq!(window.state().centre(), Centre::Picture);
    press(&mut window, Modifiers::COMMAND, Key::E);
    let written = image::open(&picture).unwrap();
    assert_eq!((written.width(), written.height()), (48, 32));

    assert!(window.state().title().contains('*'));
    press(&mut window, Modifiers::COMMAND, Key::S);
    assert!(file.exists() && !window.state().title().contains('*'), "{:?}", errors(&window));
    let saved = scene(&window).clone();
    press(&mut window, Modifiers::COMMAND, Key::N);
    click(&mut window, "Rembrandt");
    click(&mut window, "Open this studio");
    assert_ne!(*scene(&window), saved);
    press(&mut window, Modifiers::COMMAND, Key::O);
    assert_eq!(catchlight::io::write_scene(scene(&window)), catchlight::io::write_scene(&saved));
    assert!(errors(&window).is_empty(), "{:?}", errors(&window));
}

#[test]
fn everything_can_be_undone_and_done_again() {
    if !has_adapter() {
        return;
    }
    let mut window = window_with_answers([]);
    let begin = scene(&window).clone();
    click(&mut window, "Add Strip 30 x 120");
    click(&mut window, "Props");
    click(&mut window, "Add Chrome ball");
    press(&mut window, Modifiers::COMMAND, Key::D);
    let name = window.state().selection().unwrap().name(scene(&window));
    click(&mut window, &format!("{name} visible"));
    press(&mut window, Modifiers::NONE, Key::Delete);
    assert_eq!(undo_depth(&window), 5);
    let end = scene(&window).clone();
    for _ in 0..5 {
        press(&mut window, Modifiers::COMMAND, Key::Z);
    }
    assert_eq!(*scene(&window), begin);
    assert!(!window.state().document().is_dirty());
    for _ in 0..3 {
        press(&mut window, Modifiers::COMMAND | Modifiers::SHIFT, Key::Z);
    }
    press(&mut window, Modifiers::COMMAND, Key::Y);
    press(&mut window, Modifiers::COMMAND, Key::Y);
    assert_eq!(*scene(&window), end);
}

#[test]
fn a_slider_drag_is_one_undo_step_and_the_next_one_another() {
    if !has_adapter() {
        return;
    }
    let mut window = window_with_answers([]);
    let name = scene(&window).lights[0].name.clone();
    click(&mut window, &name);
    let before = scene(&window).lights[0].power.dial_stops;
    for step in 1..=2 {
        let slider = window.get_by_role_and_label(egui::accesskit::Role::Slider, "Dial").rect();
        drag(&mut window, PointerButton::Primary, slider.left_center() + vec2(40.0, 0.0), slider.center());
        let slider = window.get_by_role_and_label(egui::accesskit::Role::Slider, "Dial").rect();
        drag(
            &mut window,
            PointerButton::Primary,
            slider.center(),
            slider.left_center() + vec2(30.0 * step as f32, 0.0),
        );
        assert_eq!(undo_depth(&window), 2 * step);
    }
    for _ in 0..4 {
        press(&mut window, Modifiers::COMMAND, Key::Z);
    }
    assert_eq!(scene(&window).lights[0].power.dial_stops, before);
}

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
        window.state().selection()
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

#[test]
fn light_changes_develop_the_picture_anew_without_tracing() {
    if !has_adapter() {
        return;
    }
    let mut window = window_with_answers([]);
    render_tiny(&mut window);
    let brightness = |window: &Window| -> f32 {
        let picture = &window.state().rendering().developed().unwrap().picture;
        picture.rgb.iter().flatten().sum()
    };
    let rays = |window: &Window| window.state().rendering().job().unwrap().progress();
    let (bright, traced) = (brightness(&window), rays(&window));
    let scene_now = scene(&window).clone();
    assert!(!window.state().rendering().is_out_of_date(&scene_now));
    for light in scene_now.lights.iter().map(|l| l.name.clone()) {
        click(&mut window, &format!("{light} on"));
    }
    let dark = scene(&window).clone();
    assert!(brightness(&window) < 0.02 * bright, "{} of {bright}", brightness(&window));
    assert!(!window.state().rendering().is_out_of_date(&dark), "switches need no render");
    assert_eq!(rays(&window), traced);
    let mut camera = dark.camera.clone();
    camera.position.x += 0.5;
    window.state_mut().run(Command::Do(Action::SetCamera(Box::new(camera))), None, &egui::Context::default());
    settle(&mut window);
    let moved = scene(&window).clone();
    assert!(window.state().rendering().is_out_of_date(&moved), "a moved camera needs one");
}

#[test]
fn a_render_can_be_cancelled_and_keeps_what_it_has() {
    if !has_adapter() {
        return;
    }
    let mut window = window_with_answers([]);
    let rendering = window.state_mut().rendering_mut();
    rendering.settings.size = PictureSize::Custom(160, 120);
    rendering.settings.samples = 60_000;
    rendering.settings.quality = Quality::Custom;
    settle(&mut window);
    window.get_by_label("Render the picture").click();
    let began = Instant::now();
    while window.state().rendering().developed().is_none() {
        assert!(began.elapsed() < PATIENCE);
        window.step();
        std::thread::sleep(Duration::from_millis(5));
    }
    // The small picture has just come into the panel: a frame for the layout to settle.
    window.run_steps(2);
    window.get_by_label("Cancel").click();
    settle(&mut window);
    assert!(!window.state().rendering().is_running());
    assert!(window.state().rendering().developed().is_some_and(|d| d.spp > 0 && d.spp < 60_000));
}

#[test]
fn unsaved_changes_are_asked_about_before_they_are_lost() {
    if !has_adapter() {
        return;
    }
    let folder = tempfile::tempdir().unwrap();
    let file = folder.path().join("kept.ron");
    let mut window = window_with_answers([file.clone()]);
    assert!(close_requested(&mut window), "nothing to lose, so it closes");
    click(&mut window, "Add Octa 120");
    assert!(!close_requested(&mut window));
    click(&mut window, "Cancel");
    let changed = scene(&window).clone();

    press(&mut window, Modifiers::COMMAND, Key::N);
    click(&mut window, "Split");
    click(&mut window, "Open this studio");
    assert_eq!(*scene(&window), changed, "it asks first");
    click(&mut window, "Save");
    assert!(file.exists());
    assert_ne!(*scene(&window), changed, "and then goes on");

    click(&mut window, "Add Octa 120");
    assert!(!close_requested(&mut window));
    window.get_by_label("Don't save").click();
    window.run_steps(3);
    settle(&mut window);
    assert!(close_requested(&mut window), "told to lose the changes, it closes");
}

/// A file on the desktop.
#[derive(Debug)]
struct Dropped(PathBuf);

impl egui::DroppedFile for Dropped {
    fn path(&self) -> &Path {
        &self.0
    }

    fn bytes(&self) -> Result<Vec<u8>, String> {
        std::fs::read(&self.0).map_err(|error| error.to_string())
    }
}

fn drop_file(window: &mut Window, path: &Path) {
    window.input_mut().dropped_files.push(std::sync::Arc::new(Dropped(path.to_owned())));
    settle(window);
}

const PYRAMID: &str = "o Pyramid\nv 0 0 0\nv 1 0 0\nv 0 0 1\nv 0 1 0\nf 1 2 3\nf 1 4 2\nf 2 4 3\nf 3 4 1\n";

#[test]
fn files_can_be_dropped_and_models_travel_with_the_studio() {
    if !has_adapter() {
        return;
    }
    let (desktop, home) = (tempfile::tempdir().unwrap(), tempfile::tempdir().unwrap());
    let model = desktop.path().join("pyramid.obj");
    std::fs::write(&model, PYRAMID).unwrap();
    let file = home.path().join("studio.ron");
    let mut window = window_with_answers([file.clone()]);
    drop_file(&mut window, &model);
    let object = scene(&window).objects.last().unwrap().clone();
    assert_eq!(object.name, "pyramid");
    assert!(matches!(&object.shape, Shape::MeshFile { path } if path == "models/pyramid.obj"), "{:?}", object.shape);
    press(&mut window, Modifiers::COMMAND, Key::S);
    assert!(home.path().join("models/pyramid.obj").exists(), "{:?}", errors(&window));

    drop_file(&mut window, &desktop.path().join("notes.txt"));
    assert_eq!(errors(&window).len(), 1);
    let other = desktop.path().join("other.ron");
    std::fs::write(&other, catchlight::io::presets()[3].text).unwrap();
    drop_file(&mut window, &other);
    assert_eq!(window.state().document().path(), Some(other.as_path()));
    drop_file(&mut window, &file);
    let reopened = window.state().document();
    assert!(reopened.assets().meshes.contains_key("models/pyramid.obj"));
}

#[test]
fn a_broken_file_is_told_and_leaves_the_open_studio_as_it_was() {
    if !has_adapter() {
        return;
    }
    let folder = tempfile::tempdir().unwrap();
    let mut window = window_with_answers([]);
    let before = scene(&window).clone();
    let whole = catchlight::io::presets()[0].text;
    let broken = [&whole[..whole.len() / 2], "", "(format: 99)", "[[[[", &whole.replace("f_number", "f_numbr")];
    for (i, text) in broken.into_iter().enumerate() {
        let file = folder.path().join(format!("broken {i}.ron"));
        std::fs::write(&file, text).unwrap();
        drop_file(&mut window, &file);
        let told = errors(&window);
        assert!(told.last().is_some_and(|t| t.contains(&format!("broken {i}.ron"))), "{told:?}");
    }
    drop_file(&mut window, &folder.path().join("gone.ron"));
    let bad_model = folder.path().join("bad.obj");
    std::fs::write(&bad_model, "f 1 2 9\n").unwrap();
    drop_file(&mut window, &bad_model);
    assert_eq!((scene(&window), undo_depth(&window)), (&before, 0));
    let shown = errors(&window).len();
    window.get_all_by_label("Dismiss").next().unwrap().click();
    settle(&mut window);
    assert_eq!(errors(&window).len(), shown - 1);
}

#[test]
fn keys_are_letters_while_a_name_is_typed() {
    if !has_adapter() {
        return;
    }
    let mut window = window_with_answers([]);
    let name = scene(&window).lights[0].name.clone();
    let light = window.get_by_label(&name);
    light.click();
    light.click();
    settle(&mut window);
    let field = window.get_by_label("New name");
    assert!(field.is_focused());
    window.key_press_modifiers(Modifiers::COMMAND, Key::A);
    for (key, letter) in [(Key::R, "r"), (Key::F, "f"), (Key::Num1, "1"), (Key::W, "w")] {
        window.event(Event::Key { key, physical_key: None, pressed: true, repeat: false, modifiers: Modifiers::NONE });
        window.event(Event::Text(letter.to_owned()));
        window.event(Event::Key { key, physical_key: None, pressed: false, repeat: false, modifiers: Modifiers::NONE });
    }
    settle(&mut window);
    assert!(window.state().rendering().job().is_none() && window.state().centre() == Centre::Studio);
    press(&mut window, Modifiers::NONE, Key::Enter);
    assert_eq!(scene(&window).lights[0].name, "rf1w");
    press(&mut window, Modifiers::NONE, Key::Num1);
    assert_eq!(window.state().centre(), Centre::Camera);
}

#[test]
fn a_name_that_is_taken_is_refused_in_plain_words() {
    if !has_adapter() {
        return;
    }
    let mut window = window_with_answers([]);
    let (first, second) = (scene(&window).lights[0].clone(), scene(&window).lights[1].name.clone());
    let rename = Command::Do(Action::Rename(Item::Light(first.id), second));
    window.state_mut().run(rename, None, &egui::Context::default());
    settle(&mut window);
    assert_eq!(scene(&window).lights[0].name, first.name);
    assert_eq!(errors(&window).len(), 1);
}

#[test]
fn a_desktop_without_dialogs_gets_a_field_for_the_path() {
    if !has_adapter() {
        return;
    }
    let folder = tempfile::tempdir().unwrap();
    let file = folder.path().join("typed.ron");
    let answers = VecDeque::from([Answer::Unavailable, Answer::Cancelled]);
    let mut window = window(Options { dialogs: FileDialogs::Scripted(answers), ..Options::default() });
    press(&mut window, Modifiers::COMMAND, Key::S);
    let field = window.get_by_label("Path");
    field.set_text_value_accesskit(&file.to_string_lossy());
    settle(&mut window);
    click(&mut window, "Save here");
    assert!(file.exists(), "{:?}", errors(&window));
}

#[test]
fn a_figure_from_the_list_comes_with_its_mesh_and_is_aimed_at() {
    if !has_adapter() {
        return;
    }
    let mut window = window_with_answers([]);
    click(&mut window, "Figures");
    click(&mut window, "Add Child, standing");
    let Some(Item::Object(id)) = window.state().selection() else { panic!("the figure is selected") };
    let shape = scene(&window).object(id).unwrap().shape.clone();
    let mesh = window.state().document().assets().mesh_of(&shape);
    assert!(mesh.is_some_and(|mesh| mesh.triangles.len() > 1000), "{:?}", window.state().toasts());
    window.get_all_by_label("Lights").next().unwrap().click();
    settle(&mut window);
    click(&mut window, "Add Beauty dish 55");
    let light = scene(&window).lights.last().unwrap();
    assert!(matches!(light.aim, Aim::Object { object, .. } if object == id));
}

#[test]
fn every_preset_opens_and_every_panel_draws() {
    if !has_adapter() {
        return;
    }
    let mut window = window_with_answers([]);
    for index in 0..catchlight::io::presets().len() {
        window.state_mut().run(Command::NewFromPreset(index), None, &egui::Context::default());
        settle(&mut window);
        let items: Vec<Item> = {
            let scene = scene(&window);
            let objects = scene.objects.iter().map(|o| Item::Object(o.id));
            let lights = scene.lights.iter().map(|l| Item::Light(l.id));
            objects.chain(lights).chain([Item::Camera, Item::Room]).collect()
        };
        for item in items {
            let select = Command::Select(Some(item));
            window.state_mut().run(select, None, &egui::Context::default());
            settle(&mut window);
        }
        let changed = window.state().document().history().undo_label().map(str::to_owned);
        assert_eq!(changed, None, "drawing the inspector changes nothing");
        assert!(errors(&window).is_empty(), "{:?}", errors(&window));
    }
}

#[test]
fn a_window_without_a_device_says_so_and_still_works() {
    let builder = Harness::builder().with_size(vec2(1200.0, 800.0)).with_max_steps(60);
    let mut window = builder.build_eframe(|creation| App::new(creation, Options::default()));
    settle(&mut window);
    assert!(window.state().viewport().preview.failure().is_some());
    click(&mut window, "Add Octa 120");
    render_tiny(&mut window);
}

#[test]
fn a_typed_title_is_one_step_and_survives_a_click_elsewhere() {
    if !has_adapter() {
        return;
    }
    let mut window = window_with_answers([]);
    let light = scene(&window).lights[0].name.clone();
    window.get_by_role_and_label(egui::accesskit::Role::TextInput, "Title").click();
    settle(&mut window);
    window.key_press_modifiers(Modifiers::COMMAND, Key::A);
    for letter in ["D", "u", "s", "k"] {
        window.event(Event::Text(letter.to_owned()));
    }
    settle(&mut window);
    click(&mut window, &light);
    assert_eq!(scene(&window).name, "Dusk");
    assert_eq!(undo_depth(&window), 1);
}

#[test]
fn the_light_meter_reads_in_the_background_follows_the_dial_and_can_be_undone() {
    if !has_adapter() {
        return;
    }
    let mut window = window_with_answers([]);
    let reading = |window: &Window| window.state().meter().reading().unwrap().as_ref().unwrap().clone();
    assert!(window.state().meter().reading().is_none());
    click(&mut window, "Light meter");
    assert_eq!(window.state().selection(), Some(Item::Meter));
    let before = reading(&window);
    let key = before.key().unwrap().clone();
    assert_eq!((before.lights.len(), key.name.as_str()), (scene(&window).lights.len(), "Key softbox"));
    for label in ["Light meter, dome", "No light reaches the meter."] {
        let shown = window.query_by_label(label).is_some();
        assert_eq!(shown, label == "Light meter, dome", "{label}");
    }
    assert!(window.query_by_label_contains("key:fill").is_some());
    assert!(window.query_by_label_contains("Flash 100 %").is_some());
    // A stop less on the key is a stop less at the meter.
    let mut light = scene(&window).lights[0].clone();
    light.power.dial_stops -= 1.0;
    window.state_mut().run(Command::Do(Action::SetLight(Box::new(light))), None, &egui::Context::default());
    settle(&mut window);
    let after = reading(&window);
    let stops = (after.lux_s(&after.lights[0]) / before.lux_s(&before.lights[0])).log2();
    // Both readings are good to 0.15 %.
    assert!((stops + 1.0).abs() < 0.01, "{stops}");
    press(&mut window, Modifiers::COMMAND, Key::Z);
    press(&mut window, Modifiers::COMMAND, Key::Z);
    assert_eq!((scene(&window).meter, undo_depth(&window)), (None, 0));
    assert!(window.query_by_label_contains("key:fill").is_none(), "no meter, no read-out");
}

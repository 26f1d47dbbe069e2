//! The real window, driven as a user would: egui_kittest with a wgpu device, so that the live preview runs, too.
#![cfg(feature = "gui")]
#![allow(clippy::unwrap_used, clippy::panic, reason = "a test that cannot go on says so by panicking")]
#![allow(clippy::print_stderr, reason = "a skipped test is reported")]

use adapter::headless_gpu;
use catchlight::editor::{
    Action, App, CentralView, Command, CompareMode, Comparison, DialogAnswer, EditorOptions, Fader, FileDialogs, Item,
    LiveMode, PictureSize, Preferences, Quality, RendererPool, StudioSource, ToastKind, ViewOptions,
};
use catchlight::scene::{Aim, ColorSource, Figure, HairStyle, Scene, Shape};
use catchlight::sheet::LessonSeries;
use eframe::egui::{
    self, Event, Key, Modifiers, PointerButton, Pos2, ViewportCommand, ViewportEvent, ViewportId, vec2,
};
use eframe::egui_wgpu::{RenderState, RendererOptions, WgpuSetup, WgpuSetupExisting};
use egui_kittest::Harness;
use egui_kittest::kittest::Queryable;
use egui_kittest::wgpu::{create_render_state, default_wgpu_setup};
use std::collections::VecDeque;
use std::path::{Path, PathBuf};
use std::sync::{Arc, Condvar, LazyLock, Mutex, OnceLock};
use std::time::Duration;

#[path = "../studio/adapter.rs"]
mod adapter;
mod bodies;
mod camera;
mod device;
mod dials;
mod files;
mod gear;
mod help;
mod measured_light;
mod panels;
mod placing;
mod preferences;
mod recovery;
mod rendering;
mod selection;
mod sizes;
mod switches;
mod variants;
mod view_options;
mod viewport;
mod views;
mod water;

type Window = Harness<'static, App>;

/// Most frames of a wait for background work: far more than a slow, shared machine needs.
const MOST_FRAMES: u32 = 20_000;
/// Longest time between two frames of a wait, should a job end without a repaint request.
const LONGEST_PAUSE: Duration = Duration::from_millis(100);

/// The repaint requests of a window: background jobs request a repaint when they have a result.
#[derive(Clone, Debug, Default)]
struct RepaintRequests(Arc<(Mutex<bool>, Condvar)>);

impl RepaintRequests {
    /// Returns the requests of a window, and listens to them from the first call on.
    fn of(ctx: &egui::Context) -> Self {
        let id = egui::Id::unique("repaint requests");
        if let Some(known) = ctx.data(|data| data.get_temp(id)) {
            return known;
        }
        let requests = RepaintRequests::default();
        let raised = requests.clone();
        ctx.set_request_repaint_callback(move |info| {
            // A repaint that is due later is awaited by `LONGEST_PAUSE`.
            if info.delay.is_zero() {
                *raised.0.0.lock().unwrap() = true;
                raised.0.1.notify_one();
            }
        });
        ctx.data_mut(|data| data.insert_temp(id, requests.clone()));
        requests
    }

    /// Waits for a repaint request, or until the frame that egui has scheduled.
    fn wait(&self, scheduled: Duration) {
        let (raised, changed) = &*self.0;
        let guard = raised.lock().unwrap();
        let (mut guard, _) =
            changed.wait_timeout_while(guard, scheduled.min(LONGEST_PAUSE), |raised| !*raised).unwrap();
        *guard = false;
    }
}

/// Waits until a background job or a scheduled repaint asks for the next frame.
fn wait_for_next_frame(window: &Window) {
    let output = window.output().viewport_output.get(&ViewportId::ROOT);
    RepaintRequests::of(&window.ctx).wait(output.map_or(LONGEST_PAUSE, |output| output.repaint_delay));
}

/// Runs frames until a condition holds.
fn wait_until(window: &mut Window, condition: impl Fn(&App) -> bool) {
    for _ in 0..MOST_FRAMES {
        if condition(window.state()) {
            return;
        }
        window.step();
        if !condition(window.state()) {
            wait_for_next_frame(window);
        }
    }
    panic!("not reached in {MOST_FRAMES} frames: {}", window.state().viewport().traced_view.status());
}

/// Returns true if there is a GPU adapter. Without one the test prints that and passes, unless `CATCHLIGHT_REQUIRE_GPU`
/// is set.
fn has_adapter() -> bool {
    static FOUND: LazyLock<bool> = LazyLock::new(|| headless_gpu().is_some());
    *FOUND
}

/// Pixels per point of a window unless a test is about pixels: the GPU is emulated, and its time grows with them.
const FEW_PIXELS: f32 = 0.25;

fn window(options: EditorOptions) -> Window {
    window_at(FEW_PIXELS, options)
}

/// Returns the first shipped studio with another shape for its figure.
fn preset_with(shape: impl Fn(&Figure) -> Shape) -> Scene {
    let mut scene = catchlight::io::presets()[0].scene().unwrap();
    for object in &mut scene.objects {
        if let Shape::Figure(figure) = &object.shape {
            object.shape = shape(figure);
        }
    }
    scene
}

/// Returns the first shipped studio with a post in the figure's place, half of it below the floor, so that it stands
/// where the figure does: the triangles and strands of a figure take most of the time of a window on an emulated GPU.
fn plain_preset() -> StudioSource {
    let post = |figure: &Figure| Shape::Cylinder { radius_m: 0.09, height_m: 2.0 * figure.body.height_m };
    static SCENE: OnceLock<Scene> = OnceLock::new();
    StudioSource::Memory(Box::new(SCENE.get_or_init(|| preset_with(post)).clone()))
}

/// Returns the first shipped studio with a bald figure: strands take a third of the time of a window with a figure.
fn bald_preset() -> StudioSource {
    let bald = |figure: &Figure| Shape::Figure(Box::new(Figure { hair: HairStyle::Bald, ..*figure }));
    static SCENE: OnceLock<Scene> = OnceLock::new();
    StudioSource::Memory(Box::new(SCENE.get_or_init(|| preset_with(bald)).clone()))
}

/// A window with the bald figure of the first preset; none without an adapter.
fn figure_window() -> Option<Window> {
    let options = EditorOptions { initial: Some(bald_preset()), ..EditorOptions::default() };
    has_adapter().then(|| window(EditorOptions { dialogs: FileDialogs::scripted([]), ..options }))
}

/// Returns the view options of a window in tests that are not about them: one sample a pixel, direct light, coarse
/// shadows.
fn plain_view() -> ViewOptions {
    ViewOptions { smooth_edges: false, bounced_light: false, shadow_resolution: 128, ..ViewOptions::default() }
}

/// Returns options that open [`plain_preset`].
fn plain_options() -> EditorOptions {
    EditorOptions { initial: Some(plain_preset()), view_options: plain_view(), ..EditorOptions::default() }
}

/// A window on the studio of the options, or else on [`plain_preset`], with a [`plain_view`].
fn window_at(pixels_per_point: f32, options: EditorOptions) -> Window {
    let initial = options.initial.clone().or_else(|| Some(plain_preset()));
    let renderer_pool = shared_gpu().renderer_pool.clone();
    let options = EditorOptions { initial, view_options: plain_view(), renderer_pool, ..options };
    let builder = Harness::builder().with_size(vec2(1440.0, 900.0)).with_step_dt(1.0 / 30.0).with_max_steps(60);
    let builder = builder.with_pixels_per_point(pixels_per_point);
    let setup = WgpuSetup::Existing(shared_gpu().setup.clone());
    let mut window = builder.wgpu_setup(setup).build_eframe(move |creation| App::new(creation, options));
    settle(&mut window);
    window
}

/// The device of all windows but those that lose theirs, and the pool of renderers on it.
struct SharedGpu {
    setup: WgpuSetupExisting,
    renderer_pool: RendererPool,
}

/// Returns the setup of devices in tests. It has no OpenGL: a window lists all adapters of its instance, and EGL contexts
/// that are dropped on several threads at the same time are in each other's way.
fn gpu_setup() -> WgpuSetup {
    let mut setup = default_wgpu_setup();
    if let WgpuSetup::CreateNew(new) = &mut setup {
        new.instance_descriptor.backends.remove(eframe::wgpu::Backends::GL);
    }
    setup
}

/// Returns the device that tests share: compiling the pipelines takes as long as a short test.
fn shared_gpu() -> &'static SharedGpu {
    static SHARED: LazyLock<SharedGpu> = LazyLock::new(|| {
        let setup = gpu_setup();
        // Nothing is presented: egui takes any instance
        let instance = pollster::block_on(setup.new_instance());
        let state = create_render_state(setup, RendererOptions::PREDICTABLE);
        let RenderState { adapter, device, queue, .. } = state;
        let setup = WgpuSetupExisting { instance, adapter, device, queue };
        SharedGpu { setup, renderer_pool: RendererPool::default() }
    });
    &SHARED
}

fn window_with_answers(paths: impl IntoIterator<Item = PathBuf>) -> Window {
    window(EditorOptions { dialogs: FileDialogs::scripted(paths), ..EditorOptions::default() })
}

/// A window with the first preset at some pixels a point, for clicks that must be exact and pictures that are compared;
/// none without an adapter.
fn preset_window_at(pixels_per_point: f32) -> Option<Window> {
    let options = EditorOptions { dialogs: FileDialogs::scripted([]), ..EditorOptions::default() };
    has_adapter().then(|| window_at(pixels_per_point, options))
}

/// A window with the first preset; none without an adapter.
fn preset_window() -> Option<Window> {
    has_adapter().then(|| window_with_answers([]))
}

/// Runs frames until all background work is done and no frame is requested.
fn settle(window: &mut Window) {
    RepaintRequests::of(&window.ctx);
    let mut frames = 0;
    while window.try_run().is_err() || window.state().is_busy() {
        frames += 1;
        assert!(frames < MOST_FRAMES, "still busy after {frames} frames");
        wait_for_next_frame(window);
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

/// Presses or releases the left button.
fn button(window: &mut Window, pos: Pos2, pressed: bool) {
    let (button, modifiers) = (PointerButton::Primary, Modifiers::NONE);
    window.event(Event::PointerButton { pos, button, pressed, modifiers });
    window.step();
}

/// Moves the pointer.
fn move_to(window: &mut Window, at: Pos2) {
    window.event(Event::PointerMoved(at));
    window.step();
}

/// Turns the wheel by three clicks, away from the user.
fn wheel_closer(window: &mut Window, at: Pos2) {
    move_to(window, at);
    window.event(Event::MouseWheel {
        unit: egui::MouseWheelUnit::Line,
        delta: vec2(0.0, 3.0),
        source: egui::MouseWheelSource::Wheel,
        phase: egui::TouchPhase::Move,
        modifiers: Modifiers::NONE,
    });
    settle(window);
}

/// Returns the first position of a path at which the pointer is on a handle.
fn handle_along(window: &mut Window, mut way: impl Iterator<Item = Pos2>) -> Pos2 {
    way.find(|at| {
        move_to(window, *at);
        window.state().viewport().is_over_handle()
    })
    .unwrap()
}

/// Types a number during a drag, as key and text events.
fn type_number(window: &mut Window, number: &str) {
    for letter in number.chars() {
        let key = if letter == '.' { Key::Period } else { Key::from_name(&letter.to_string()).unwrap() };
        window.key_press(key);
        window.event(Event::Text(letter.to_string()));
        window.step();
    }
}

/// Presses at a point, moves in steps and releases.
fn drag(window: &mut Window, button: PointerButton, from: Pos2, to: Pos2) {
    move_to(window, from);
    window.event(Event::PointerButton { pos: from, button, pressed: true, modifiers: Modifiers::NONE });
    window.step();
    for i in 1..=10 {
        move_to(window, from + (to - from) * (i as f32 / 10.0));
    }
    window.event(Event::PointerButton { pos: to, button, pressed: false, modifiers: Modifiers::NONE });
    settle(window);
}

/// Presses and releases at a point.
fn click_at(window: &mut Window, at: Pos2, modifiers: Modifiers) {
    move_to(window, at);
    window.event(Event::ModifiersChanged(modifiers));
    window.step();
    for pressed in [true, false] {
        window.event(Event::PointerButton { pos: at, button: PointerButton::Primary, pressed, modifiers });
        window.step();
    }
    window.event(Event::ModifiersChanged(Modifiers::NONE));
    settle(window);
}

/// Returns the screen position of a world-space point.
fn shown_at(window: &Window, point: glam::Vec3) -> Pos2 {
    let view = window.get_by_label("Viewport").rect();
    let frame = window.state().viewport().view.frame(view.width() / view.height());
    let place = frame.project(point).unwrap();
    view.min + vec2(place.x * view.width(), place.y * view.height())
}

/// Executes a command.
fn run(window: &mut Window, command: Command) {
    window.state_mut().run(command, None, &egui::Context::default());
    settle(window);
}

fn select(window: &mut Window, items: &[Item]) {
    run(window, Command::Select(None));
    run(window, Command::SelectAlso(items.to_vec()));
}

fn scene(window: &Window) -> &Scene {
    window.state().document().scene()
}

fn undo_depth(window: &Window) -> usize {
    window.state().document().history().depth()
}

fn errors(window: &Window) -> Vec<&str> {
    window.state().toasts().texts(ToastKind::Error)
}

/// Copies what is selected, and returns the text on the clipboard.
fn copied_text(window: &mut Window) -> String {
    window.event(Event::Copy);
    window.step();
    let text = window.output().platform_output.commands.iter().find_map(|command| match command {
        egui::OutputCommand::CopyText(text) => Some(text.clone()),
        _ => None,
    });
    settle(window);
    text.unwrap_or_else(|| panic!("nothing is on the clipboard"))
}

/// Renders a picture of a few pixels.
fn render_tiny(window: &mut Window) {
    let rendering = window.state_mut().rendering_mut();
    rendering.settings.size = PictureSize::Custom(48, 32);
    rendering.settings.samples = 2;
    (rendering.settings.quality, rendering.settings.denoise) = (Quality::Custom, false);
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
fn a_preset_is_edited_rendered_exported_saved_and_reopened() {
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
    let Some(Item::Light(id)) = window.state().selection().last() else { panic!("the new light is selected") };
    window.get_by_label("Position x").set_value_accesskit(-1.5);
    settle(&mut window);
    assert_eq!(scene(&window).light(id).unwrap().position.x, -1.5);

    render_tiny(&mut window);
    assert_eq!(window.state().central_view(), CentralView::Picture);
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
    let Some(mut window) = preset_window() else { return };
    let begin = scene(&window).clone();
    click(&mut window, "Add Strip 30 x 120");
    click(&mut window, "Props");
    click(&mut window, "Add Chrome ball");
    press(&mut window, Modifiers::COMMAND, Key::D);
    let name = window.state().selection().last().unwrap().name(scene(&window));
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

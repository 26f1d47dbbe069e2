//! The native window. The app outlives it: after a device loss the window is reopened.

use crate::editor::document::files::StudioSource;
use crate::editor::window::app::{App, EditorOptions};
use crate::editor::window::event_guard;
use crate::editor::window::run_time_libraries::{self, MissingLibraries};
use crate::io;
use crate::preview::Gpu;
use eframe::UserEvent;
use eframe::egui::{Context, Ui, ViewportBuilder, ViewportInfo, Visuals};
use std::cell::RefCell;
use std::io::Write;
use std::panic::resume_unwind;
use std::path::PathBuf;
use std::rc::Rc;
use std::time::{Duration, Instant};
use winit::error::EventLoopError;
use winit::event_loop::EventLoop;

/// The reason why no window could be opened.
#[derive(Debug, thiserror::Error)]
pub enum EditorError {
    /// There is no display to open a window on.
    #[error("there is no display to open a window on: {0}")]
    NoDisplay(String),
    /// Libraries of the window system are missing.
    #[error("the window needs {}; on Debian: apt-get install {}", .0.files.join(", "), .0.packages.join(" "))]
    MissingLibraries(MissingLibraries),
    /// There is a display, but nothing that can draw on it.
    #[error("no GPU adapter can draw the window (on Debian: apt-get install mesa-vulkan-drivers libvulkan1): {0}")]
    NoGraphics(String),
    /// Any other error.
    #[error("the window could not be opened: {0}")]
    Window(String),
}

/// Opens the window and returns when it is closed. `initial` is the studio to open; none opens a shipped one.
///
/// # Errors
/// When there is no display, no GPU adapter, or the window cannot be opened.
pub fn run(initial: Option<PathBuf>) -> Result<(), EditorError> {
    let started = Instant::now();
    check_display()?;
    let options = EditorOptions {
        initial: initial.map(StudioSource::named),
        settings_folder: io::settings_folder(),
        recovery_folder: io::state_folder().map(|folder| folder.join("recovery")),
        offers_tour: true,
        started,
        ..EditorOptions::default()
    };
    run_windows(options)
}

/// Checks on Linux for a Wayland or X11 display and the libraries that its window needs: winit's error is less helpful,
/// and it panics without some of the libraries.
fn check_display() -> Result<(), EditorError> {
    if !cfg!(all(unix, not(target_os = "macos"))) {
        return Ok(());
    }
    let set = |name| std::env::var_os(name).is_some_and(|value| !value.is_empty());
    // As winit does, take Wayland where both are there
    let on_wayland = set("WAYLAND_DISPLAY") || set("WAYLAND_SOCKET");
    if !on_wayland && !set("DISPLAY") {
        return Err(EditorError::NoDisplay("neither DISPLAY nor WAYLAND_DISPLAY is set".to_owned()));
    }
    run_time_libraries::missing(on_wayland).map_or(Ok(()), |missing| Err(EditorError::MissingLibraries(missing)))
}

/// Shortest lifetime after which a lost window is reopened with the same renderer.
const SHORT_LIFE: Duration = Duration::from_secs(3);

/// A window of a shared app.
#[derive(Debug)]
struct AppWindow(Rc<RefCell<App>>);

impl eframe::App for AppWindow {
    fn clear_color(&self, visuals: &Visuals) -> [f32; 4] {
        self.0.borrow().clear_color(visuals)
    }

    fn logic(&mut self, ctx: &Context, frame: &mut eframe::Frame) {
        self.0.borrow_mut().logic(ctx, frame);
    }

    fn ui(&mut self, ui: &mut Ui, frame: &mut eframe::Frame) {
        self.0.borrow_mut().ui(ui, frame);
    }
}

/// The state that outlives a window.
#[derive(Default)]
struct AppHost {
    app: Option<Rc<RefCell<App>>>,
    /// The options of the first window.
    options: Option<EditorOptions>,
    ctx: Option<Context>,
    /// Number of windows opened.
    opened: u32,
}

impl Drop for AppHost {
    /// Saves unsaved changes to a file if the window panics.
    fn drop(&mut self) {
        if std::thread::panicking()
            && let Some(rescued) = self.rescue()
        {
            // Unlike `eprintln`, this does not panic where stderr is closed.
            let _ = writeln!(std::io::stderr(), "{}", rescue_message(&rescued));
        }
    }
}

impl AppHost {
    /// Saves unsaved changes, if any; returns the file or the error.
    fn rescue(&self) -> Option<Result<PathBuf, String>> {
        self.app.as_ref()?.try_borrow().ok()?.rescue()
    }

    /// Forgets what is kept for the case of a crash.
    fn end_recovery(&self) {
        if let Some(app) = &self.app {
            app.borrow().end_recovery();
        }
    }

    /// Returns true if the last window was lost. Drops its device before another window is created: OpenGL cannot
    /// release it while a window draws with OpenGL.
    fn is_lost(&self) -> bool {
        self.app.as_ref().is_some_and(|app| app.borrow_mut().drop_lost_device())
    }
}

/// Opens windows until the user closes one.
fn run_windows(options: EditorOptions) -> Result<(), EditorError> {
    let mut events = EventLoop::with_user_event().build().map_err(no_display)?;
    let host: Rc<RefCell<AppHost>> = Rc::default();
    host.borrow_mut().options = Some(options);
    let mut renderer = eframe::Renderer::Wgpu;
    let mut no_adapter = None;
    loop {
        let began = Instant::now();
        let opened = host.borrow().opened;
        let ended = open(&host, &mut events, renderer);
        if host.borrow().opened == opened {
            // The log has the reason.
            if renderer == eframe::Renderer::Glow {
                return Err(no_graphics(no_adapter, host.borrow().rescue()));
            }
            no_adapter = Gpu::headless().err().map(|error| error.to_string());
            log::warn!("no GPU adapter draws the window: OpenGL draws it, and the CPU the view");
            renderer = eframe::Renderer::Glow;
        } else if host.borrow().is_lost() {
            // Lost at once: the same renderer would fail again.
            if began.elapsed() < SHORT_LIFE {
                renderer = eframe::Renderer::Glow;
            }
        } else {
            match ended {
                Ok(Ok(())) => {
                    host.borrow().end_recovery();
                    return Ok(());
                }
                Ok(Err(panic)) => resume_unwind(panic),
                Err(error) => return Err(broken(&error.to_string(), host.borrow().rescue())),
            }
        }
    }
}

fn open(
    host: &Rc<RefCell<AppHost>>,
    events: &mut EventLoop<UserEvent>,
    renderer: eframe::Renderer,
) -> Result<Result<(), event_guard::Panic>, EventLoopError> {
    let last = host.borrow().ctx.clone();
    let viewport = ViewportBuilder::default()
        .with_title("Catchlight")
        .with_app_id("catchlight")
        .with_inner_size([1440.0, 900.0])
        .with_min_inner_size([900.0, 600.0])
        .with_drag_and_drop(true);
    let viewport = match &last {
        Some(ctx) => as_it_was(viewport, &ctx.input(|i| i.viewport().clone())),
        None => viewport,
    };
    // The window has no fine gradients: dithering would only cost time.
    let native = eframe::NativeOptions { viewport, renderer, dithering: false, ..Default::default() };
    let host = host.clone();
    let create: eframe::AppCreator<'_> = Box::new(move |creation| {
        let mut host = host.borrow_mut();
        let app = match host.app.clone() {
            Some(app) => {
                app.borrow_mut().move_to(creation);
                app
            }
            None => Rc::new(RefCell::new(App::new(creation, host.options.take().unwrap_or_default()))),
        };
        if let Some(last) = host.ctx.replace(creation.egui_ctx.clone()) {
            inherit(&last, &creation.egui_ctx);
        }
        host.app = Some(app.clone());
        host.opened += 1;
        Ok(Box::new(AppWindow(app)))
    });
    let window = eframe::create_native("Catchlight", native, create, events);
    event_guard::run(events, window)
}

/// Copies egui's memory to the new window and redirects repaint requests of the last one.
fn inherit(last: &Context, ctx: &Context) {
    let memory = last.memory(Clone::clone);
    ctx.memory_mut(|new| *new = memory);
    let ctx = ctx.clone();
    last.set_request_repaint_callback(move |_| ctx.request_repaint());
}

/// Copies position and size of the last window.
fn as_it_was(mut builder: ViewportBuilder, last: &ViewportInfo) -> ViewportBuilder {
    if let Some(rect) = last.inner_rect {
        builder = builder.with_inner_size(rect.size());
    }
    if let Some(rect) = last.outer_rect {
        builder = builder.with_position(rect.min);
    }
    builder.with_maximized(last.maximized == Some(true)).with_fullscreen(last.fullscreen == Some(true))
}

/// Returns the message on the rescued changes.
fn rescue_message(rescued: &Result<PathBuf, String>) -> String {
    match rescued {
        Ok(path) => format!("the studio was saved as {}", path.display()),
        Err(why) => format!("the studio's changes are lost, they could not be saved: {why}"),
    }
}

fn no_display(error: EventLoopError) -> EditorError {
    // The reason comes last, after source locations.
    let text = error.to_string();
    EditorError::NoDisplay(text.rsplit(": ").next().unwrap_or(&text).to_owned())
}

/// Returns the error without graphics; `no_adapter` is the error of wgpu, if any.
fn no_graphics(no_adapter: Option<String>, rescued: Option<Result<PathBuf, String>>) -> EditorError {
    let why = no_adapter.unwrap_or_else(|| "neither Vulkan nor OpenGL can".to_owned());
    EditorError::NoGraphics(with_rescued(&why, rescued))
}

fn broken(why: &str, rescued: Option<Result<PathBuf, String>>) -> EditorError {
    EditorError::Window(with_rescued(why, rescued))
}

fn with_rescued(why: &str, rescued: Option<Result<PathBuf, String>>) -> String {
    rescued.map_or_else(|| why.to_owned(), |rescued| format!("{why}; {}", rescue_message(&rescued)))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::editor::{Action, Command};
    use eframe::egui::Id;
    use std::panic::{AssertUnwindSafe, catch_unwind};
    use std::sync::Arc;
    use std::sync::atomic::{AtomicBool, Ordering};

    /// Returns an app with a studio from this file and an unsaved change.
    fn changed_app(file: &std::path::Path) -> App {
        std::fs::write(file, io::presets()[0].text).unwrap();
        let ctx = Context::default();
        let (wake, woken) = std::sync::mpsc::channel();
        ctx.set_request_repaint_callback(move |_| {
            let _ = wake.send(());
        });
        let creation = eframe::CreationContext::_new_kittest(ctx.clone());
        let mut app = App::new(
            &creation,
            EditorOptions { initial: Some(StudioSource::File(file.to_owned())), ..EditorOptions::default() },
        );
        let started = Instant::now();
        while app.document().path().is_none() {
            assert!(started.elapsed() < Duration::from_secs(60), "the studio is not read");
            // egui tells of one request for a repaint until a pass begins: that of another job may hide the studio's
            let _ = woken.recv_timeout(Duration::from_millis(50));
            app.take_in(&ctx, &mut Vec::new());
        }
        let notes = Action::SetNotes { name: "Changed".to_owned(), description: String::new() };
        app.run(Command::Apply(notes), None, &ctx);
        app
    }

    #[test]
    fn a_panicking_window_saves_unsaved_changes() {
        let folder = tempfile::tempdir().unwrap();
        let app = Rc::new(RefCell::new(changed_app(&folder.path().join("a.ron"))));
        let mut host = AppHost::default();
        host.app = Some(app.clone());
        let ended = catch_unwind(AssertUnwindSafe(move || {
            let _host = host;
            // A window borrows the app while it draws.
            let _drawing = app.borrow_mut();
            resume_unwind(Box::new("a panic without its message"));
        }));
        assert!(ended.is_err());
        let rescued = io::load_scene(&folder.path().join("a (rescued 1).ron")).unwrap();
        assert_eq!(rescued.scene.name, "Changed");
    }

    #[test]
    fn the_error_of_a_lost_window_names_the_rescued_file_or_the_loss() {
        let words = |rescued| broken("no device is left", rescued).to_string();
        let saved = words(Some(Ok("home/a (rescued 1).ron".into())));
        assert!(saved.contains("saved as home/a (rescued 1).ron") && saved.contains("no device is left"), "{saved}");
        assert!(words(Some(Err("the disk is full".to_owned()))).contains("could not be saved: the disk is full"));
        assert!(!words(None).contains("saved"));
    }

    #[test]
    fn a_reopened_window_inherits_memory_and_repaint_requests() {
        let (last, ctx) = (Context::default(), Context::default());
        last.memory_mut(|memory| memory.data.insert_temp(Id::unique("width"), 321.0_f32));
        inherit(&last, &ctx);
        assert_eq!(ctx.memory(|memory| memory.data.get_temp(Id::unique("width"))), Some(321.0_f32));
        let woken = Arc::new(AtomicBool::new(false));
        let raised = woken.clone();
        ctx.set_request_repaint_callback(move |_| raised.store(true, Ordering::Relaxed));
        last.request_repaint();
        assert!(woken.load(Ordering::Relaxed));
    }
}

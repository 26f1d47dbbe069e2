//! The window that shows the app. The app outlives it: when its graphics device is lost, the window is opened anew.

use super::EditorError;
use super::app::{App, Options};
use eframe::egui::{Context, Ui, ViewportBuilder, ViewportInfo};
use std::cell::RefCell;
use std::path::PathBuf;
use std::rc::Rc;
use std::time::{Duration, Instant};

/// A window that lasted less was lost to something that a new one alone does not mend.
const SHORT_LIFE: Duration = Duration::from_secs(3);

/// A window onto an app that others hold, too.
#[derive(Debug)]
struct Window(Rc<RefCell<App>>);

impl eframe::App for Window {
    fn ui(&mut self, ui: &mut Ui, frame: &mut eframe::Frame) {
        self.0.borrow_mut().ui(ui, frame);
    }
}

/// What outlives a window.
#[derive(Default)]
struct Outlives {
    app: Option<Rc<RefCell<App>>>,
    ctx: Option<Context>,
}

impl Drop for Outlives {
    /// A window that ends by a panic leaves the work in a file.
    fn drop(&mut self) {
        if std::thread::panicking()
            && let Some(path) = self.rescue()
        {
            eprintln!("the studio was saved as {}", path.display());
        }
    }
}

impl Outlives {
    /// Saves unsaved work beside the studio's own file; none if there is none, or no place for it.
    fn rescue(&self) -> Option<PathBuf> {
        self.app.as_ref()?.try_borrow().ok()?.rescue()
    }

    fn is_lost(&self) -> bool {
        self.app.as_ref().is_some_and(|app| app.borrow().has_lost_window())
    }
}

/// Opens windows until one is closed by the user.
pub(super) fn run(options: Options) -> Result<(), EditorError> {
    let outlives: Rc<RefCell<Outlives>> = Rc::default();
    let mut options = Some(options);
    let mut renderer = eframe::Renderer::Wgpu;
    let mut no_adapter = None;
    loop {
        let opened = Instant::now();
        let ended = open(&outlives, &mut options, renderer);
        match ended {
            Ok(()) if !outlives.borrow().is_lost() => return Ok(()),
            Ok(()) if opened.elapsed() > SHORT_LIFE => {}
            Ok(()) => renderer = eframe::Renderer::Glow,
            Err(eframe::Error::Wgpu(error)) => {
                log::warn!("{error}; the window is drawn by OpenGL and the view by the processor");
                no_adapter = Some(error.to_string());
                renderer = eframe::Renderer::Glow;
            }
            Err(error) => {
                let kept = outlives.borrow().rescue();
                return Err(explained(error, no_adapter, kept));
            }
        }
    }
}

fn open(
    outlives: &Rc<RefCell<Outlives>>,
    options: &mut Option<Options>,
    renderer: eframe::Renderer,
) -> Result<(), eframe::Error> {
    let ctx = outlives.borrow().ctx.clone();
    let viewport = ViewportBuilder::default()
        .with_title("Catchlight")
        .with_app_id("catchlight")
        .with_inner_size([1440.0, 900.0])
        .with_min_inner_size([900.0, 600.0])
        .with_drag_and_drop(true);
    let viewport = match &ctx {
        Some(ctx) => as_it_was(viewport, &ctx.input(|i| i.viewport().clone())),
        None => viewport,
    };
    let native = eframe::NativeOptions { viewport, renderer, ..Default::default() };
    let outlives = outlives.clone();
    let create: eframe::AppCreator<'_> = Box::new(move |creation| {
        let mut outlives = outlives.borrow_mut();
        let app = match outlives.app.take() {
            Some(app) => {
                app.borrow_mut().move_to(creation);
                app
            }
            None => Rc::new(RefCell::new(App::new(creation, options.take().unwrap_or_default()))),
        };
        (outlives.app, outlives.ctx) = (Some(app.clone()), Some(creation.egui_ctx.clone()));
        Ok(Box::new(Window(app)))
    });
    // The same context, so that threads at work wake the new window, and panels are as wide as they were.
    eframe::run_native_ext("Catchlight", native, ctx, create)
}

/// Where and as large as the last window was.
fn as_it_was(mut builder: ViewportBuilder, last: &ViewportInfo) -> ViewportBuilder {
    if let Some(rect) = last.inner_rect {
        builder = builder.with_inner_size(rect.size());
    }
    if let Some(rect) = last.outer_rect {
        builder = builder.with_position(rect.min);
    }
    builder.with_maximized(last.maximized == Some(true)).with_fullscreen(last.fullscreen == Some(true))
}

/// `no_adapter` is why wgpu could not draw the window, `kept` the file that has the studio now.
fn explained(error: eframe::Error, no_adapter: Option<String>, kept: Option<PathBuf>) -> EditorError {
    let kept = kept.map(|path| format!("; the studio was saved as {}", path.display())).unwrap_or_default();
    match (error, no_adapter) {
        (eframe::Error::WinitEventLoop(error), _) => {
            // The reason comes last, after places in source files.
            let text = error.to_string();
            EditorError::NoDisplay(text.rsplit(": ").next().unwrap_or(&text).to_owned())
        }
        (error, Some(no_adapter)) => EditorError::NoGraphics(format!("{no_adapter}; without one: {error}{kept}")),
        (error, None) => EditorError::Window(format!("{error}{kept}")),
    }
}

//! The window: arrange the studio, see it live, render, save.
//!
//! Panels and viewport draw from the [`Document`] and push [`Command`]s; [`App::run`] carries them out. Every change of
//! the scene is an [`Action`] inside a command, so menus, shortcuts, handles, undo and tests all take the same way.
//! Files, renders and file dialogs work in threads of their own; their results are taken in at the start of a frame.

mod action;
mod app;
mod arrange;
mod axis_cross;
mod bounds;
mod canvas;
mod catalog;
mod command;
mod commands;
mod dialogs;
mod document;
mod event_guard;
mod files;
mod floor_handle;
mod forecast;
mod frame_log;
mod gizmo;
mod held;
mod history;
mod item;
mod keys;
mod light_view;
mod live_job;
mod live_view;
mod look_menu;
mod meter_job;
mod navigation;
mod overlay;
mod panels;
mod picking;
mod picture_view;
mod placement;
mod plan;
mod preview_host;
mod processor_view;
mod readout;
mod recent;
mod relight;
mod render_job;
mod rendering;
mod rescue;
mod selection;
mod session;
mod side_panel;
mod studio_view;
mod surface;
mod swing;
mod swing_drag;
mod switches;
mod theme;
mod thumbnails;
mod toasts;
mod typed;
mod units;
mod viewport;
mod widgets;
mod window;

pub use action::{Action, ActionError};
pub use app::{App, Options};
pub use command::{Centre, Command, Handle};
pub use dialogs::{Answer, FileDialogs, Purpose};
pub use document::Document;
pub use forecast::{Estimate, Forecast, Forecaster};
pub use item::Item;
pub use keys::{BINDINGS, Binding};
pub use live_view::{LiveMode, LiveView};
pub use rendering::{PictureSize, Quality, RenderSettings, Rendering};
pub use selection::Selection;
pub use studio_view::{Side, StudioView};
pub use swing::Swing;
pub use thumbnails::{Thumbnail, Thumbnails};
pub use toasts::{Toasts, Tone};
pub use viewport::Viewport;

use std::path::PathBuf;
use std::time::Instant;

/// Why there is no window.
#[derive(Debug, thiserror::Error)]
pub enum EditorError {
    /// There is no display to open a window on.
    #[error("there is no display to open a window on: {0}")]
    NoDisplay(String),
    /// There is a display, but nothing that can draw on it.
    #[error("no graphics adapter can draw the window (on Debian: apt-get install mesa-vulkan-drivers libvulkan1): {0}")]
    NoGraphics(String),
    /// Anything else that keeps the window from opening.
    #[error("the window could not be opened: {0}")]
    Window(String),
}

/// Opens the window and returns when it is closed. `initial` is the studio to open; none opens a shipped one.
///
/// # Errors
/// When there is no display, no graphics adapter, or the window cannot be opened.
pub fn run(initial: Option<PathBuf>) -> Result<(), EditorError> {
    let started = Instant::now();
    check_display()?;
    let options = Options { initial, settings_folder: recent::settings_folder(), started, ..Options::default() };
    window::run(options)
}

/// On Linux a window needs a Wayland or X11 display; asking winit without one gives a less helpful message.
fn check_display() -> Result<(), EditorError> {
    let set = |name| std::env::var_os(name).is_some_and(|value| !value.is_empty());
    let is_linux = cfg!(all(unix, not(target_os = "macos")));
    if is_linux && !set("DISPLAY") && !set("WAYLAND_DISPLAY") && !set("WAYLAND_SOCKET") {
        return Err(EditorError::NoDisplay("neither DISPLAY nor WAYLAND_DISPLAY is set".to_owned()));
    }
    Ok(())
}

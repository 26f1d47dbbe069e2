//! The window: arrange the studio, see it live, render, save.
//!
//! Panels and viewport draw from the [`Document`] and push [`Command`]s; [`App::run`] carries them out. Every change of
//! the scene is an [`Action`] inside a command, so menus, shortcuts, handles, undo and tests all take the same way.
//! Files, renders and file dialogs work in threads of their own; their results are taken in at the start of a frame.

mod commands;
mod document;
mod panels;
mod picture;
mod ui;
mod viewport;
mod window;

pub use commands::choices::{Centre, Handle, LiveMode, Side, Swing};
pub use commands::command::Command;
pub use commands::file_purpose::Purpose;
pub use commands::shortcuts::{BINDINGS, Binding};
pub use document::action::Action;
pub use document::action_error::ActionError;
pub use document::item::Item;
pub use document::selection::Selection;
pub use document::studio_document::Document;
pub use panels::thumbnails::{Thumbnail, Thumbnails};
pub use picture::rendering::{PictureSize, Quality, RenderSettings, Rendering};
pub use ui::toasts::{Toasts, Tone};
pub use viewport::live::traced_view::LiveView;
pub use viewport::studio_view::StudioView;
pub use viewport::viewport_area::Viewport;
pub use window::app::{App, Options};
pub use window::dialogs::{Answer, FileDialogs};

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
    let options =
        Options { initial, settings_folder: window::recent::settings_folder(), started, ..Options::default() };
    window::native_window::run(options)
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

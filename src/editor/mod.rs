//! The editor: an egui window to arrange the studio, see it live, render and save.
//!
//! Panels and viewport draw from the [`Document`] and push [`Command`]s; [`App::run`] executes them after the frame.
//! Every change of the scene is an [`Action`] inside a command, so menus, shortcuts, handles, undo and tests share one
//! path. Files, renders and file dialogs run in background threads; the window takes their results at the start of a
//! frame.
//!
//! # Rooms
//! An import never runs against an arrow, and no two files import each other:
//! ```text
//! document ── commands ──┬── viewport ──┬── panels ── window
//!                  ui ───┴── picture ───┘
//! ```
//! - `document`: the open studio, its history and selection, the actions, the catalog, placement of new items, changes of
//!   lights that are tried over the picture.
//! - `ui`: theme, widgets, units, messages, scopes; nothing about studios.
//! - `commands`: the commands, their keys, and the menu entries of an item.
//! - `viewport`: navigation and the live view; `live` makes the images, `overlays` paints over them, `tools` holds the
//!   transform handles, the selection by click or box, and the placing of lights.
//! - `picture`: render settings, the finished picture and its view, with mixer and comparison.
//! - `panels`: menu bar, catalog, item list, inspector, render panel, light meter, prompts.
//! - `window`: [`App`], execution of commands, files, dialogs, recovery, the native window.
//!
//! # Where to add
//! - A panel: a `*_ui` function in a new file of `panels`, its state in `window::app_state::PanelState`, its call in
//!   `App::panels_ui`. A section of the inspector: a file in `panels::inspector` and an arm of `inspector_ui`.
//! - A command: a variant in `commands::command`, an arm in `window::run_command` (files: `window::run_file_command`),
//!   its key in `commands::shortcuts::KEY_BINDINGS`, its entry in `panels::menu` or `commands::item_menu`.
//! - An action: a variant in `document::action` with its label and effect; undo follows by itself.
//! - A transform handle: a variant of `HandlePart` with its shape in `viewport::tools::handle_part`, its drag in
//!   `handle_drag` there, its effect in `transform_selection`. Another tool: a file in `viewport::tools` that
//!   `viewport::viewport_area` calls.
//! - A catalog entry: a line in `document::catalog`.

mod commands;
mod document;
mod panels;
mod picture;
mod ui;
mod viewport;
mod window;

pub use commands::choices::{CentralView, CompareMode, Comparison, HandleMode, LiveMode, PlaceLightBy, ViewSide};
pub use commands::command::Command;
pub use commands::file_purpose::FilePurpose;
pub use commands::preferences::Preferences;
pub use commands::shortcuts::{KEY_BINDINGS, KeyBinding};
pub use document::action::Action;
pub use document::action_error::ActionError;
pub use document::arrange::MirrorPlane;
pub use document::files::StudioSource;
pub use document::gear_shelf::GearEntry;
pub use document::item::Item;
pub use document::light_mix::Fader;
pub use document::selection::Selection;
pub use document::studio_document::Document;
pub use panels::thumbnails::{Thumbnail, Thumbnails};
pub use picture::render_settings::{PictureSize, Quality, RenderSettings};
pub use picture::rendering::Rendering;
pub use picture::variant_pictures::VariantPictures;
pub use ui::scopes::ScopeCharts;
pub use ui::spot_readout::{SpotLux, SpotReading};
pub use ui::toasts::{ToastKind, Toasts};
pub use viewport::live::preview_host::{RendererPool, ViewOptions};
pub use viewport::live::traced_view::TracedView;
pub use viewport::studio_view::StudioView;
pub use viewport::viewport_area::Viewport;
pub use window::app::{App, EditorOptions};
pub use window::dialogs::{DialogAnswer, FileDialogs};
pub use window::native_window::{EditorError, run};

//! The window: application state, execution of commands, files and dialogs, recovery, the native window.

pub mod app;
mod app_access;
pub mod app_state;
pub mod background_tasks;
pub mod dialogs;
pub mod event_guard;
pub mod file_changes;
pub mod frame_log;
pub mod kept_preferences;
pub mod native_window;
pub mod recent;
pub mod recovery;
pub mod rescue;
pub mod run_assets;
mod run_command;
pub mod run_environment;
mod run_export;
pub mod run_file_command;
mod run_import;
mod run_measured_light;
pub mod run_preferences;
pub mod run_recovery;
pub mod run_setup;
mod run_tank;
pub mod run_time_libraries;
pub mod session;

//! The folders of the program: its settings, and its state.

use directories::ProjectDirs;
use std::path::PathBuf;

fn program_folders() -> Option<ProjectDirs> {
    ProjectDirs::from("", "", "catchlight")
}

/// Returns the user's folder for settings: preferences, recent studios, own gear. On Linux
/// `$XDG_CONFIG_HOME/catchlight`, by default `~/.config/catchlight`.
pub fn settings_folder() -> Option<PathBuf> {
    program_folders().map(|folders| folders.config_dir().to_owned())
}

/// Returns the user's folder for what the program keeps by itself: pictures that could not be written where they were
/// wanted, and unsaved studios. On Linux `$XDG_STATE_HOME/catchlight`, by default `~/.local/state/catchlight`.
pub fn state_folder() -> Option<PathBuf> {
    program_folders().map(|folders| folders.state_dir().unwrap_or_else(|| folders.data_local_dir()).to_owned())
}

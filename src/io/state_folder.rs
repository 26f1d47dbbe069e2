//! The folder of the program's state.

use std::path::PathBuf;

/// Returns the user's folder for what the program keeps by itself: pictures that could not be written where they were
/// wanted, and unsaved studios. On Linux `$XDG_STATE_HOME/catchlight`, by default `~/.local/state/catchlight`.
pub fn state_folder() -> Option<PathBuf> {
    let folders = directories::ProjectDirs::from("", "", "catchlight")?;
    Some(folders.state_dir().unwrap_or_else(|| folders.data_local_dir()).to_owned())
}

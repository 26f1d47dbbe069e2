//! File dialogs: the desktop's dialog in a thread, or scripted answers in tests.

use crate::editor::commands::file_purpose::FilePurpose;
use std::collections::VecDeque;
use std::path::{Path, PathBuf};
use std::sync::mpsc::{Receiver, channel};
use std::time::{Duration, Instant};

/// The answer of a file dialog.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum DialogAnswer {
    /// A file.
    Chosen(PathBuf),
    /// The dialog was cancelled.
    Cancelled,
    /// The desktop has no file dialog; the editor prompts for a path.
    Unavailable,
}

/// The provider of file dialogs.
#[derive(Debug)]
pub enum FileDialogs {
    /// The desktop's dialogs.
    Desktop,
    /// A list of answers, for tests; cancelled after the last one.
    Scripted(VecDeque<DialogAnswer>),
}

impl FileDialogs {
    /// Returns dialogs that answer with these paths, in turn.
    pub fn scripted(paths: impl IntoIterator<Item = PathBuf>) -> Self {
        FileDialogs::Scripted(paths.into_iter().map(DialogAnswer::Chosen).collect())
    }

    /// Opens a dialog without blocking: the answer arrives in the channel, then `wake` is called.
    pub fn ask(
        &mut self,
        purpose: FilePurpose,
        folder: Option<&Path>,
        file_name: &str,
        wake: impl FnOnce() + Send + 'static,
    ) -> Receiver<DialogAnswer> {
        let (sender, receiver) = channel();
        match self {
            FileDialogs::Scripted(answers) => {
                let _ = sender.send(answers.pop_front().unwrap_or(DialogAnswer::Cancelled));
                wake();
            }
            FileDialogs::Desktop => {
                let dialog = desktop_dialog(purpose, folder, file_name);
                std::thread::spawn(move || {
                    let _ = sender.send(ask_desktop(purpose, dialog));
                    wake();
                });
            }
        }
        receiver
    }
}

fn desktop_dialog(purpose: FilePurpose, folder: Option<&Path>, file_name: &str) -> rfd::FileDialog {
    let (name, endings) = purpose.filter();
    let mut dialog = rfd::FileDialog::new().set_title(purpose.title()).add_filter(name, endings);
    if let Some(folder) = folder {
        dialog = dialog.set_directory(folder);
    }
    if purpose.is_save() { dialog.set_file_name(file_name) } else { dialog }
}

/// Shortest time in which a user closes a dialog; a faster answer means that no dialog was shown.
const FASTEST_USER: Duration = Duration::from_millis(500);
/// The program that shows a dialog where no service of the desktop does.
const DIALOG_PROGRAM: &str = "zenity";

/// Returns true if this system can show a dialog: on Linux it needs the session's message bus or a program. Without them an
/// attempt fails, on a busy machine later than a user would cancel.
fn can_show_dialogs() -> bool {
    let path = |variable: &str| std::env::var_os(variable).filter(|value| !value.is_empty());
    let has_bus = path("DBUS_SESSION_BUS_ADDRESS").is_some()
        || path("XDG_RUNTIME_DIR").is_some_and(|folder| Path::new(&folder).join("bus").exists());
    let has_program = || {
        path("PATH").is_some_and(|path| std::env::split_paths(&path).any(|folder| folder.join(DIALOG_PROGRAM).exists()))
    };
    !cfg!(target_os = "linux") || has_bus || has_program()
}

fn ask_desktop(purpose: FilePurpose, dialog: rfd::FileDialog) -> DialogAnswer {
    if !can_show_dialogs() {
        return DialogAnswer::Unavailable;
    }
    let asked = Instant::now();
    let path = if purpose.is_save() { dialog.save_file() } else { dialog.pick_file() };
    match path {
        Some(path) => DialogAnswer::Chosen(path),
        None if asked.elapsed() < FASTEST_USER => DialogAnswer::Unavailable,
        None => DialogAnswer::Cancelled,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn scripted_answers_are_given_in_turn_then_cancelled() {
        let mut dialogs = FileDialogs::scripted([PathBuf::from("a.ron")]);
        let first = dialogs.ask(FilePurpose::OpenScene, None, "", || ()).recv().unwrap();
        let second = dialogs.ask(FilePurpose::OpenScene, None, "", || ()).recv().unwrap();
        assert_eq!((first, second), (DialogAnswer::Chosen("a.ron".into()), DialogAnswer::Cancelled));
    }

    #[test]
    fn a_saved_file_gets_its_extension() {
        assert_eq!(FilePurpose::SaveScene.with_extension_added("studio".into()), PathBuf::from("studio.ron"));
        assert_eq!(FilePurpose::ExportPicture.with_extension_added("a.jpg".into()), PathBuf::from("a.jpg"));
    }
}

//! Asking for a file name: the desktop's dialog in a thread of its own, or a list of answers in tests.

use crate::io;
use std::collections::VecDeque;
use std::path::{Path, PathBuf};
use std::sync::mpsc::{Receiver, channel};
use std::time::{Duration, Instant};

/// What a file name is wanted for.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Purpose {
    /// A scene to open.
    OpenScene,
    /// Where to save the scene.
    SaveScene,
    /// A model to bring in.
    ImportModel,
    /// A texture for a material.
    OpenTexture,
    /// Where to write the finished picture.
    ExportPicture,
}

impl Purpose {
    /// Title of the dialog.
    pub fn title(self) -> String {
        match self {
            Purpose::OpenScene => "Open studio".to_owned(),
            Purpose::SaveScene => "Save studio".to_owned(),
            Purpose::ImportModel => format!("Import {} model", io::model_format_names()),
            Purpose::OpenTexture => "Choose texture".to_owned(),
            Purpose::ExportPicture => "Export picture".to_owned(),
        }
    }

    /// Whether the file is one that is going to be written.
    pub fn is_save(self) -> bool {
        matches!(self, Purpose::SaveScene | Purpose::ExportPicture)
    }

    /// Name and endings of the files.
    pub fn filter(self) -> (String, &'static [&'static str]) {
        match self {
            Purpose::OpenScene | Purpose::SaveScene => ("Catchlight studio".to_owned(), &["ron"]),
            Purpose::ImportModel => (format!("{} model", io::model_format_names()), io::model_extensions()),
            Purpose::OpenTexture => ("Picture".to_owned(), io::TEXTURE_EXTENSIONS),
            Purpose::ExportPicture => ("Picture".to_owned(), &["png", "jpg", "exr"]),
        }
    }

    /// The path with the ending the files have, where the user typed none.
    pub fn with_ending(self, path: PathBuf) -> PathBuf {
        if self.is_save() && path.extension().is_none() { path.with_extension(self.filter().1[0]) } else { path }
    }
}

/// The user's answer.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Answer {
    /// This file.
    Chosen(PathBuf),
    /// Nothing: the dialog was closed.
    Cancelled,
    /// The desktop has no dialog to show; the window asks for a path itself.
    Unavailable,
}

/// Who is asked for file names.
#[derive(Debug)]
pub enum FileDialogs {
    /// The desktop.
    Desktop,
    /// A list of answers, for tests; cancelled when it is used up.
    Scripted(VecDeque<Answer>),
}

impl FileDialogs {
    /// Answers with these paths, in turn.
    pub fn scripted(paths: impl IntoIterator<Item = PathBuf>) -> Self {
        FileDialogs::Scripted(paths.into_iter().map(Answer::Chosen).collect())
    }

    /// Asks without waiting: the answer comes through the channel, and `wake` is called when it is there.
    pub fn ask(
        &mut self,
        purpose: Purpose,
        folder: Option<&Path>,
        file_name: &str,
        wake: impl FnOnce() + Send + 'static,
    ) -> Receiver<Answer> {
        let (sender, receiver) = channel();
        match self {
            FileDialogs::Scripted(answers) => {
                let _ = sender.send(answers.pop_front().unwrap_or(Answer::Cancelled));
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

fn desktop_dialog(purpose: Purpose, folder: Option<&Path>, file_name: &str) -> rfd::FileDialog {
    let (name, endings) = purpose.filter();
    let mut dialog = rfd::FileDialog::new().set_title(purpose.title()).add_filter(name, endings);
    if let Some(folder) = folder {
        dialog = dialog.set_directory(folder);
    }
    if purpose.is_save() { dialog.set_file_name(file_name) } else { dialog }
}

/// Nobody closes a dialog faster than this: an answer that comes sooner means that there was no dialog.
const FASTEST_USER: Duration = Duration::from_millis(250);

fn ask_desktop(purpose: Purpose, dialog: rfd::FileDialog) -> Answer {
    let asked = Instant::now();
    let path = if purpose.is_save() { dialog.save_file() } else { dialog.pick_file() };
    match path {
        Some(path) => Answer::Chosen(path),
        None if asked.elapsed() < FASTEST_USER => Answer::Unavailable,
        None => Answer::Cancelled,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn scripted_answers_come_in_turn_and_then_end() {
        let mut dialogs = FileDialogs::scripted([PathBuf::from("a.ron")]);
        let first = dialogs.ask(Purpose::OpenScene, None, "", || ()).recv().unwrap();
        let second = dialogs.ask(Purpose::OpenScene, None, "", || ()).recv().unwrap();
        assert_eq!((first, second), (Answer::Chosen("a.ron".into()), Answer::Cancelled));
    }

    #[test]
    fn a_saved_file_gets_its_ending() {
        assert_eq!(Purpose::SaveScene.with_ending("studio".into()), PathBuf::from("studio.ron"));
        assert_eq!(Purpose::ExportPicture.with_ending("a.jpg".into()), PathBuf::from("a.jpg"));
    }
}

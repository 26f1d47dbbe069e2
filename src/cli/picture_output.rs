//! The picture that a command writes: kept elsewhere if its file can't be written after the work.

use super::failure::Failure;
use crate::io::{self, PictureFile};
use anyhow::anyhow;
use std::path::{Path, PathBuf};

/// A picture that is on the disk.
#[derive(Debug)]
pub struct WrittenPicture {
    /// The file that holds it.
    pub path: PathBuf,
    /// The message, if that is not the file that was asked for.
    elsewhere: Option<String>,
}

impl WrittenPicture {
    /// Fails if the picture is not in the file that was asked for, with a message that says where it is.
    pub fn finish(self) -> Result<(), Failure> {
        self.elsewhere.map_or(Ok(()), |message| Err(Failure::Machine(anyhow!(message))))
    }
}

/// Writes a picture. If its file can't be written, the picture is kept under a new name beside it, else in the state
/// folder, else in the folder of temporary files.
pub fn write(picture: &PictureFile<'_>) -> Result<WrittenPicture, Failure> {
    let error = match picture.write() {
        Ok(()) => return Ok(WrittenPicture { path: picture.path().to_owned(), elsewhere: None }),
        Err(error) => error,
    };
    let beside = picture.path().parent().filter(|folder| folder.as_os_str().is_empty() || folder.is_dir());
    let beside = beside.map(|folder| if folder.as_os_str().is_empty() { Path::new(".") } else { folder }.to_owned());
    let folders: Vec<PathBuf> = beside.into_iter().chain(io::state_folder()).chain([std::env::temp_dir()]).collect();
    match picture.keep(&folders) {
        Some(path) => {
            let elsewhere = Some(format!("{error}; the picture is kept as {}", path.display()));
            Ok(WrittenPicture { path, elsewhere })
        }
        None => Err(Failure::Machine(anyhow!("{error}; no other folder takes the picture, either: it is lost"))),
    }
}

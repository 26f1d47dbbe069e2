//! A picture for its file: written there, or kept elsewhere if that fails.

use super::channel_samples::ExrImage;
use crate::io::atomic::{self, WriteSeek};
use crate::io::error::SaveError;
use exr::prelude::WritableImage;
use std::io::{self, BufWriter};
use std::path::{Path, PathBuf};

/// Most names tried in a folder.
const MAX_NAMES: u32 = 1000;
/// Most characters of a file's stem in the name of a kept picture.
const STEM_LENGTH: usize = 100;

/// A picture in the format of its file.
#[derive(Debug)]
pub struct PictureFile<'a> {
    path: PathBuf,
    content: Content<'a>,
}

/// The content of a picture's file.
#[derive(Debug)]
pub(super) enum Content<'a> {
    Bytes(Vec<u8>),
    /// Encoded block by block as it is written.
    Exr(Box<ExrImage<'a>>),
}

impl Content<'_> {
    fn write_to(&self, out: &mut dyn WriteSeek) -> io::Result<()> {
        match self {
            Content::Bytes(bytes) => out.write_all(bytes),
            Content::Exr(image) => image.write().to_buffered(BufWriter::new(out)).map_err(|error| match error {
                exr::error::Error::Io(error) => error,
                error => io::Error::other(error.to_string()),
            }),
        }
    }
}

impl<'a> PictureFile<'a> {
    pub(super) fn new(path: &Path, content: Content<'a>) -> Self {
        PictureFile { path: path.to_owned(), content }
    }

    /// Returns the file that the picture is for.
    pub fn path(&self) -> &Path {
        &self.path
    }

    /// Returns the bytes of the file.
    #[cfg(test)]
    pub fn bytes(&self) -> Vec<u8> {
        let mut bytes = io::Cursor::new(Vec::new());
        self.content.write_to(&mut bytes).unwrap();
        bytes.into_inner()
    }

    /// Writes the picture to its file. An older file is replaced atomically; a pipe or a device takes the bytes.
    ///
    /// # Errors
    /// If the folder is missing or the file can't be written.
    pub fn write(&self) -> Result<(), SaveError> {
        atomic::send(&self.path, |out| self.content.write_to(out))
    }

    /// Writes the picture under a new name to the first of `folders` that takes it, for a picture whose file can't be
    /// written. Folders that do not exist are made. Returns the new file; none if no folder takes it.
    pub fn keep(&self, folders: &[PathBuf]) -> Option<PathBuf> {
        folders.iter().find_map(|folder| {
            std::fs::create_dir_all(folder).ok()?;
            let path = self.new_name_in(folder)?;
            atomic::send(&path, |out| self.content.write_to(out)).ok().map(|()| path)
        })
    }

    fn new_name_in(&self, folder: &Path) -> Option<PathBuf> {
        let part = |part: Option<&std::ffi::OsStr>| part.map_or_else(String::new, |p| p.to_string_lossy().into_owned());
        let stem: String = part(self.path.file_stem()).chars().take(STEM_LENGTH).collect();
        let ending = part(self.path.extension());
        (1..=MAX_NAMES).map(|n| folder.join(format!("{stem} (kept {n}).{ending}"))).find(|path| !path.exists())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_picture_is_kept_in_the_first_folder_that_takes_it_under_a_new_name() {
        let folder = tempfile::tempdir().unwrap();
        let file = folder.path().join("a file");
        std::fs::write(&file, "").unwrap();
        let kept_in = folder.path().join("state/catchlight");
        let picture = PictureFile::new(Path::new("portrait.png"), Content::Bytes(b"pixels".to_vec()));
        for n in 1..=2 {
            let kept = picture.keep(&[file.clone(), kept_in.clone()]).unwrap();
            assert_eq!(kept, kept_in.join(format!("portrait (kept {n}).png")));
            assert_eq!(std::fs::read(kept).unwrap(), b"pixels");
        }
        assert_eq!(picture.keep(&[file]), None);
    }
}

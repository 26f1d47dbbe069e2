//! The purposes a file name is asked for.

use crate::io;
use std::path::PathBuf;

/// What a file name is wanted for.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum FilePurpose {
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

impl FilePurpose {
    /// Title of the dialog.
    pub fn title(self) -> String {
        match self {
            FilePurpose::OpenScene => "Open studio".to_owned(),
            FilePurpose::SaveScene => "Save studio".to_owned(),
            FilePurpose::ImportModel => format!("Import {} model", io::model_format_names()),
            FilePurpose::OpenTexture => "Choose texture".to_owned(),
            FilePurpose::ExportPicture => "Export picture".to_owned(),
        }
    }

    /// Whether the file is one that is going to be written.
    pub fn is_save(self) -> bool {
        matches!(self, FilePurpose::SaveScene | FilePurpose::ExportPicture)
    }

    /// Name and endings of the files.
    pub fn filter(self) -> (String, &'static [&'static str]) {
        match self {
            FilePurpose::OpenScene | FilePurpose::SaveScene => ("Catchlight studio".to_owned(), &["ron"]),
            FilePurpose::ImportModel => (format!("{} model", io::model_format_names()), io::model_extensions()),
            FilePurpose::OpenTexture => ("Picture".to_owned(), io::TEXTURE_EXTENSIONS),
            FilePurpose::ExportPicture => ("Picture".to_owned(), &["png", "jpg", "exr"]),
        }
    }

    /// The path with the ending the files have, where the user typed none.
    pub fn with_ending(self, path: PathBuf) -> PathBuf {
        if self.is_save() && path.extension().is_none() { path.with_extension(self.filter().1[0]) } else { path }
    }
}

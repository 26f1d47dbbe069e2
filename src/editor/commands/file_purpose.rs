//! The purposes of file dialogs: titles, filters and extensions.

use crate::io;
use crate::scene::LightId;
use crate::sheet::{LESSON_EXTENSIONS, LessonSeries, SHEET_EXTENSIONS, Units};
use std::path::PathBuf;

/// The purpose of a file dialog.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum FilePurpose {
    /// A scene to open, or a rendered picture with its scene.
    OpenScene,
    /// The file to save the scene to.
    SaveScene,
    /// A model to import.
    ImportModel,
    /// A photometric file for this light; for a new one, none.
    OpenMeasuredLight(Option<LightId>),
    /// An environment map for this surround; for a new one, none.
    OpenEnvironment(Option<LightId>),
    /// A texture for a material.
    OpenTexture,
    /// The file to write the rendered picture to.
    ExportPicture,
    /// The file to write the set-up sheet to, with lengths in these units.
    ExportSheet(Units),
    /// The file to write a lesson sheet to; the light that changes, none for the key.
    ExportLesson(LessonSeries, Option<LightId>),
}

impl FilePurpose {
    /// Returns the title of the dialog.
    pub fn title(self) -> String {
        match self {
            FilePurpose::OpenScene => "Open studio".to_owned(),
            FilePurpose::SaveScene => "Save studio".to_owned(),
            FilePurpose::ImportModel => format!("Import {} model", io::model_format_names()),
            FilePurpose::OpenMeasuredLight(_) => "Choose photometric file".to_owned(),
            FilePurpose::OpenEnvironment(_) => "Choose environment map".to_owned(),
            FilePurpose::OpenTexture => "Choose texture".to_owned(),
            FilePurpose::ExportPicture => "Export picture".to_owned(),
            FilePurpose::ExportSheet(_) => "Export set-up sheet".to_owned(),
            FilePurpose::ExportLesson(..) => "Export lesson sheet".to_owned(),
        }
    }

    /// Returns true if the file is written rather than read.
    pub fn is_save(self) -> bool {
        match self {
            FilePurpose::SaveScene
            | FilePurpose::ExportPicture
            | FilePurpose::ExportSheet(_)
            | FilePurpose::ExportLesson(..) => true,
            FilePurpose::OpenScene
            | FilePurpose::ImportModel
            | FilePurpose::OpenMeasuredLight(_)
            | FilePurpose::OpenEnvironment(_)
            | FilePurpose::OpenTexture => false,
        }
    }

    /// Returns what follows the studio's name in a suggested file name: a lesson sheet is not to replace the picture.
    pub fn name_suffix(self) -> String {
        match self {
            FilePurpose::ExportLesson(series, _) => format!(", {}", series.label().to_lowercase()),
            _ => String::new(),
        }
    }

    /// Returns name and extensions of the file type.
    pub fn filter(self) -> (String, &'static [&'static str]) {
        match self {
            FilePurpose::OpenScene => ("Catchlight studio, or rendered picture".to_owned(), &["ron", "exr"]),
            FilePurpose::SaveScene => ("Catchlight studio".to_owned(), &["ron"]),
            FilePurpose::ImportModel => (format!("{} model", io::model_format_names()), io::model_extensions()),
            FilePurpose::OpenMeasuredLight(_) => ("IES, EULUMDAT".to_owned(), io::PHOTOMETRIC_EXTENSIONS),
            FilePurpose::OpenEnvironment(_) => ("Panorama".to_owned(), io::ENVIRONMENT_EXTENSIONS),
            FilePurpose::OpenTexture => ("Picture".to_owned(), io::TEXTURE_EXTENSIONS),
            FilePurpose::ExportPicture => ("Picture".to_owned(), &["png", "jpg", "tif", "exr"]),
            FilePurpose::ExportSheet(_) => ("Set-up sheet".to_owned(), SHEET_EXTENSIONS),
            FilePurpose::ExportLesson(..) => ("Lesson sheet".to_owned(), LESSON_EXTENSIONS),
        }
    }

    /// Returns the path with the default extension added to a file to write that has none of its kind: "Portrait 1.2" has
    /// none.
    pub fn with_extension_added(self, mut path: PathBuf) -> PathBuf {
        const LONGEST: usize = 4;
        let is_extension = |own: &str| match self {
            FilePurpose::SaveScene => own.eq_ignore_ascii_case("ron"),
            // One of another kind is refused when it is written
            _ => own.len() <= LONGEST && own.chars().all(|c| c.is_ascii_alphabetic()),
        };
        if self.is_save() && !path.extension().is_some_and(|own| is_extension(&own.to_string_lossy())) {
            path.as_mut_os_string().push(format!(".{}", self.filter().1[0]));
        }
        path
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_with_dots_keep_them_and_get_an_extension() {
        let named = |purpose: FilePurpose, name: &str| purpose.with_extension_added(PathBuf::from(name));
        for (name, saved) in [("Portrait 1.2", "Portrait 1.2.ron"), ("a.RON", "a.RON"), ("by J.Doe", "by J.Doe.ron")] {
            assert_eq!(named(FilePurpose::SaveScene, name), PathBuf::from(saved));
        }
        for (name, written) in [("Portrait 1.2", "Portrait 1.2.png"), ("a.jpeg", "a.jpeg"), ("a.bmp", "a.bmp")] {
            assert_eq!(named(FilePurpose::ExportPicture, name), PathBuf::from(written));
        }
        assert_eq!(named(FilePurpose::OpenScene, "a"), PathBuf::from("a"));
    }
}

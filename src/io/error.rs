//! The errors of reading and writing files. Messages come first, paths last.

use crate::scene::Finding;
use std::fmt;
use std::io::ErrorKind;
use std::path::PathBuf;

/// Returns the reason of a failed file operation in words, without the system's error number and without the names of
/// temporary files.
pub fn reason(error: &std::io::Error) -> String {
    let text = error.to_string();
    // An error of the system, to which `tempfile` adds the path of its file; others have words of their own.
    let Some((system, _)) = text.split_once(" (os error") else { return text };
    let words = match error.kind() {
        ErrorKind::NotFound => "there is no such file",
        ErrorKind::PermissionDenied => "no permission",
        ErrorKind::StorageFull => "the disk is full",
        ErrorKind::QuotaExceeded => "the disk quota is used up",
        ErrorKind::ReadOnlyFilesystem => "the disk is read-only",
        ErrorKind::InvalidFilename => "the name is too long, or not one that the disk allows",
        ErrorKind::IsADirectory => "it is a folder",
        ErrorKind::NotADirectory => "a part of its path is a file, not a folder",
        ErrorKind::BrokenPipe => "the program that reads it has ended",
        _ => system,
    };
    words.to_owned()
}

/// Cuts the middle out of a message that quotes a text of a file whose length nothing bounds.
pub(super) fn cut(message: String) -> String {
    const ENDS: [usize; 2] = [120, 80];
    let length = message.chars().count();
    if length <= ENDS[0] + ENDS[1] {
        return message;
    }
    let head: String = message.chars().take(ENDS[0]).collect();
    let tail: String = message.chars().skip(length - ENDS[1]).collect();
    format!("{head} ... {tail}")
}

/// One mistake in the text of a scene file.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Problem {
    /// The field, such as `lights[2] "Key" power.dial_stops`; empty if the text is not RON.
    pub field: String,
    /// The mistake in words, with the value.
    pub message: String,
    /// Line, from 1.
    pub line: usize,
    /// Column in characters, from 1.
    pub column: usize,
    /// The text at the position, cut to a few words.
    pub text: String,
}

impl fmt::Display for Problem {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        if !self.field.is_empty() {
            write!(f, "{}: ", self.field)?;
        }
        write!(f, "{} (line {}, column {}", self.message, self.line, self.column)?;
        if !self.text.is_empty() {
            write!(f, ": `{}`", self.text)?;
        }
        f.write_str(")")
    }
}

/// The reason why a scene could not be loaded. The open scene is unchanged.
#[derive(Debug, thiserror::Error)]
pub enum LoadError {
    /// The file could not be read.
    #[error("can't read the studio: {}: {}", reason(error), path.display())]
    Read {
        /// The reason.
        error: std::io::Error,
        /// The file.
        path: PathBuf,
    },
    /// The file is larger than [`FILE_LIMIT_BYTES`](super::FILE_LIMIT_BYTES).
    #[error("a studio's file has at most {} MB, this has {} MB", limit_bytes / 1_000_000, bytes / 1_000_000)]
    TooLarge {
        /// Its size.
        bytes: u64,
        /// The most that is read.
        limit_bytes: u64,
    },
    /// The file is not UTF-8 text.
    #[error("this is no Catchlight studio: byte {0} is not text")]
    NotText(usize),
    /// The text is no usable scene: at least one problem, in file order.
    #[error("{}", list(.0))]
    Content(Vec<Problem>),
    /// A problem with a named file.
    #[error("{error}: {}", path.display())]
    InFile {
        /// What is wrong.
        error: Box<LoadError>,
        /// The file.
        path: PathBuf,
    },
}

impl LoadError {
    /// Returns the problems of the text; empty for other errors.
    pub fn problems(&self) -> &[Problem] {
        match self {
            LoadError::Content(problems) => problems,
            LoadError::InFile { error, .. } => error.problems(),
            _ => &[],
        }
    }
}

/// Lists the first problems in full, and the number of the others.
fn list(problems: &[Problem]) -> String {
    const SHOWN: usize = 3;
    let mut text = problems.iter().take(SHOWN).map(Problem::to_string).collect::<Vec<_>>().join("; ");
    if problems.len() > SHOWN {
        text.push_str(&format!("; and {} more", problems.len() - SHOWN));
    }
    text
}

/// The reason why a file could not be written. An older file is unchanged.
#[derive(Debug, thiserror::Error)]
pub enum SaveError {
    /// The scene has an error, and would not load again.
    #[error("the studio can't be saved before this is mended: {0}")]
    Invalid(Finding),
    /// The folder to write into does not exist.
    #[error("there is no such folder: {}", .0.display())]
    NoFolder(PathBuf),
    /// The path names a folder, or nothing.
    #[error("this is a folder, or no file name: {}", .0.display())]
    NoFileName(PathBuf),
    /// The path is that of a device, a socket, or a pipe where no pipe can be used.
    #[error("this is a device or a pipe, not a file: {}", .0.display())]
    NotRegular(PathBuf),
    /// The extension of a file's name belongs to no format that is written.
    #[error("{known}, not in {ending:?}: {}", path.display())]
    UnknownEnding {
        /// The extensions that are known: `a picture's name ends in .png`.
        known: &'static str,
        /// The extension, in lower case.
        ending: String,
        /// The file.
        path: PathBuf,
    },
    /// A picture without pixels, or whose layers differ in size.
    #[error("{0}")]
    BadPicture(String),
    /// The encoder failed.
    #[error("can't encode the picture: {message}: {}", path.display())]
    Encode {
        /// The reason.
        message: String,
        /// The file.
        path: PathBuf,
    },
    /// The file can't be written: a full disk, a read-only folder.
    #[error("can't write: {}: {}", reason(error), path.display())]
    Write {
        /// The reason.
        error: std::io::Error,
        /// The file.
        path: PathBuf,
    },
}

/// The reason why a model or a texture could not be loaded or copied.
#[derive(Debug, thiserror::Error)]
pub enum AssetError {
    /// The file could not be read.
    #[error("can't read it: {}: {}", reason(error), path.display())]
    Read {
        /// The reason.
        error: std::io::Error,
        /// The file.
        path: PathBuf,
    },
    /// The path leads out of the scene's folder, or is not a relative path.
    #[error("{reason}: {path:?}")]
    BadPath {
        /// What is wrong with the path.
        reason: &'static str,
        /// The path as the scene names it.
        path: String,
    },
    /// The scene has no file yet, so there is no folder for relative paths.
    #[error("save the studio first: its files are looked for beside it: {path:?}")]
    NoFolder {
        /// The path as the scene names it.
        path: String,
    },
    /// A file could not be copied beside the scene.
    #[error("can't copy it beside the studio: {}: {}", reason(error), path.display())]
    Copy {
        /// The reason.
        error: std::io::Error,
        /// The file.
        path: PathBuf,
    },
    /// A copy would overwrite another file, which is left as it is.
    #[error("another file of this name is there and was left as it is; save to another folder: {}", path.display())]
    NameTaken {
        /// The file that is there.
        path: PathBuf,
    },
    /// The file or the model is larger than the limit of its kind.
    #[error("{what} is too large: {amount}, at most {limit}: {}", path.display())]
    TooLarge {
        /// The quantity in words: the file's bytes, the model's triangles.
        what: &'static str,
        /// The quantity of the file.
        amount: u64,
        /// The limit.
        limit: u64,
        /// The file.
        path: PathBuf,
    },
    /// The extension belongs to no format that is read.
    #[error("Catchlight reads models of the type {known}, not {extension:?}: {}", path.display())]
    UnknownModelFormat {
        /// The extensions that are read, with dots.
        known: String,
        /// The file's extension, in lower case.
        extension: String,
        /// The file.
        path: PathBuf,
    },
    /// The model file has a mistake.
    #[error("not a usable {format} model: {message}: {}", path.display())]
    BadModel {
        /// Name of the format.
        format: &'static str,
        /// The mistake, with its line where known.
        message: String,
        /// The file.
        path: PathBuf,
    },
    /// The import was cancelled by its user.
    #[error("the import was cancelled")]
    Cancelled,
    /// A texture refers to an image inside a model whose format has none.
    #[error("{format} files hold no images, so there is no image {image}: {}", path.display())]
    NoEmbeddedImage {
        /// Name of the format.
        format: &'static str,
        /// Index of the image.
        image: u32,
        /// The model file.
        path: PathBuf,
    },
    /// The extension belongs to no photometric format.
    #[error("Catchlight reads photometric files of the type .ies (IES LM-63) and .ldt (EULUMDAT): {}", path.display())]
    UnknownPhotometricFormat {
        /// The file.
        path: PathBuf,
    },
    /// The photometric file has a mistake.
    #[error("not a usable {format} file: {message}: {}", path.display())]
    BadPhotometry {
        /// Name of the format.
        format: &'static str,
        /// The mistake, with its line where known.
        message: String,
        /// The file.
        path: PathBuf,
    },
    /// The environment map could not be decoded.
    #[error("not a usable HDR or EXR picture: {message}: {}", path.display())]
    BadEnvironment {
        /// The decoder's message.
        message: String,
        /// The file.
        path: PathBuf,
    },
    /// The texture could not be decoded.
    #[error("not a usable PNG or JPEG: {message}: {}", path.display())]
    BadTexture {
        /// The decoder's message.
        message: String,
        /// The file.
        path: PathBuf,
    },
}

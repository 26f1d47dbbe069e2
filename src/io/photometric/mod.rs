//! Reads photometric files: the luminous intensity of a luminaire by direction, in one common form.
//!
//! - `lm63`: IES LM-63 of 1986, 1991, 1995, 2002 and 2019 (ANSI/IES LM-63-19)
//! - `eulumdat`: EULUMDAT (Stockmar 1990, "EULUMDAT, ein Leuchtendatenformat")
//! - `symmetry`: unfolds the planes of a file to the whole circle
//! - `goniometer`: converts type A and B photometry to type C
//!
//! The table's axis -Z is the nadir of type C photometry, and the direction (0, 0) of types A and B. The plane of
//! horizontal angle 0 (C0) is the light's right, +X; the angle grows towards its upper side, +Y.

mod eulumdat;
mod goniometer;
mod lm63;
mod numbers;
mod symmetry;
mod write;

use super::error::{AssetError, cut};
use super::read::read_limited;
use crate::scene::IntensityTable;
use std::path::Path;

/// Extensions of photometric files, without the dot.
pub const PHOTOMETRIC_EXTENSIONS: &[&str] = &["ies", "ldt"];

/// Largest file, bytes: some hundred thousand intensities.
const FILE_LIMIT_BYTES: u64 = 4 << 20;

/// A photometric file.
#[derive(Debug)]
pub struct PhotometricFile {
    /// The distribution, with the flux of the luminaire.
    pub table: IntensityTable,
    /// What is odd about the file, a sentence each.
    pub warnings: Vec<String>,
}

/// The formats.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Format {
    Lm63,
    Eulumdat,
}

impl Format {
    /// Returns the format of a file by its extension, in upper or lower case.
    fn of(path: &Path) -> Option<Format> {
        let extension = path.extension().map(|extension| extension.to_string_lossy().to_lowercase());
        match extension.as_deref() {
            Some("ies") => Some(Format::Lm63),
            Some("ldt") => Some(Format::Eulumdat),
            _ => None,
        }
    }

    fn name(self) -> &'static str {
        match self {
            Format::Lm63 => "IES",
            Format::Eulumdat => "EULUMDAT",
        }
    }

    fn parse(self, bytes: &[u8]) -> Result<PhotometricFile, String> {
        match self {
            Format::Lm63 => lm63::parse(bytes),
            Format::Eulumdat => eulumdat::parse(bytes),
        }
    }
}

/// Returns true if a file has the extension of a photometric file, in upper or lower case.
pub fn is_photometric_file(path: &Path) -> bool {
    Format::of(path).is_some()
}

/// Reads a photometric file.
///
/// # Errors
/// If the extension is not one of [`PHOTOMETRIC_EXTENSIONS`], or if the file can't be read, is too large or has a
/// mistake; the message names the line and the quantity.
pub fn read_photometric_file(path: &Path) -> Result<PhotometricFile, AssetError> {
    let Some(format) = Format::of(path) else {
        return Err(AssetError::UnknownPhotometricFormat { path: path.to_owned() });
    };
    let bytes = read_limited(path, FILE_LIMIT_BYTES)?;
    format.parse(&bytes).map_err(|message| AssetError::BadPhotometry {
        format: format.name(),
        message: cut(message),
        path: path.to_owned(),
    })
}

/// Returns the text of a table as an IES file, for one whose own file no longer exists.
pub(super) fn encode(table: &IntensityTable) -> String {
    write::lm63(table)
}

#[cfg(test)]
mod tests;

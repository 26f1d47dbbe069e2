//! The model formats that Catchlight reads. A new format is one entry in [`MODEL_FORMATS`] and one module.
//!
//! File dialogs, dropped files, mesh files of a scene and error messages all use this list.

use super::error::AssetError;
use super::model::{ImportedModel, ModelLimits};
use super::{gltf_model, obj};
use std::path::Path;
use std::sync::LazyLock;

/// A format of model files.
#[derive(Debug)]
pub struct ModelFormat {
    /// Name in dialogs and messages.
    pub name: &'static str,
    /// Extensions of file names, lower case, without the dot.
    pub extensions: &'static [&'static str],
    /// Limits that the importer holds.
    pub limits: ModelLimits,
    import: fn(&Path, &ModelLimits) -> Result<ImportedModel, AssetError>,
    /// Returns the files with data of a model, by their paths from its folder; `None` for formats of one file.
    companions: Option<fn(&Path, &ModelLimits) -> Vec<String>>,
    /// Returns the bytes of the PNG or JPEG file with this index inside a model file; `None` for formats without.
    embedded_image: Option<EmbeddedImageReader>,
}

/// Reads the image with an index from a model file, within the format's limits.
type EmbeddedImageReader = fn(&Path, u32, &ModelLimits) -> Result<Vec<u8>, AssetError>;

/// Every model format, in the order of dialogs.
pub const MODEL_FORMATS: &[ModelFormat] = &[
    ModelFormat {
        name: "glTF",
        extensions: &["glb", "gltf"],
        limits: ModelLimits { file_bytes: 1 << 30, triangles: 20_000_000 },
        import: gltf_model::import,
        companions: Some(gltf_model::companions),
        embedded_image: Some(gltf_model::embedded_image),
    },
    ModelFormat {
        name: "OBJ",
        extensions: &["obj"],
        limits: ModelLimits { file_bytes: 1 << 30, triangles: 20_000_000 },
        import: obj::import,
        companions: None,
        embedded_image: None,
    },
];

impl ModelFormat {
    /// Returns the format of a file by its extension, in upper or lower case; `None` for other files.
    pub fn of(path: &Path) -> Option<&'static ModelFormat> {
        let extension = extension_of(path);
        MODEL_FORMATS.iter().find(|format| format.extensions.contains(&extension.as_str()))
    }
}

/// Imports a model: one mesh in metres whose parts are the file's groups, with normals, and the materials of the parts.
///
/// # Errors
/// If the extension belongs to no format, or if the file can't be read, exceeds the format's limits or has a mistake;
/// the message names the line where the format has lines.
pub fn import_model(path: &Path) -> Result<ImportedModel, AssetError> {
    let format = format_of(path)?;
    (format.import)(path, &format.limits)
}

/// Returns the files with data of a model, by their paths from its folder: they go where the model goes.
pub(super) fn companions(path: &Path) -> Vec<String> {
    let Some(format) = ModelFormat::of(path) else { return Vec::new() };
    format.companions.map_or_else(Vec::new, |companions| companions(path, &format.limits))
}

/// Returns the bytes of an image inside a model file, a PNG or JPEG file by itself.
///
/// # Errors
/// As [`import_model`], and if the format embeds no images.
pub(super) fn embedded_image(path: &Path, image: u32) -> Result<Vec<u8>, AssetError> {
    let format = format_of(path)?;
    match format.embedded_image {
        Some(read) => read(path, image, &format.limits),
        None => Err(AssetError::NoEmbeddedImage { format: format.name, image, path: path.to_owned() }),
    }
}

/// Returns the extensions of all model formats, without dots.
pub fn model_extensions() -> &'static [&'static str] {
    static EXTENSIONS: LazyLock<Vec<&'static str>> =
        LazyLock::new(|| MODEL_FORMATS.iter().flat_map(|format| format.extensions).copied().collect());
    &EXTENSIONS
}

/// Returns the names of all model formats for dialogs and menus: `OBJ`.
pub fn model_format_names() -> String {
    MODEL_FORMATS.iter().map(|format| format.name).collect::<Vec<_>>().join(", ")
}

/// Returns the extensions of all model formats for messages: `.obj`.
pub fn model_extension_list() -> String {
    model_extensions().iter().map(|extension| format!(".{extension}")).collect::<Vec<_>>().join(", ")
}

fn format_of(path: &Path) -> Result<&'static ModelFormat, AssetError> {
    ModelFormat::of(path).ok_or_else(|| AssetError::UnknownModelFormat {
        known: model_extension_list(),
        extension: extension_of(path),
        path: path.to_owned(),
    })
}

fn extension_of(path: &Path) -> String {
    path.extension().map(|extension| extension.to_string_lossy().to_lowercase()).unwrap_or_default()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_importer_is_chosen_by_extension_in_any_case() {
        for extension in model_extensions() {
            let upper = format!("chair.{}", extension.to_uppercase());
            assert!(ModelFormat::of(Path::new(&upper)).is_some_and(|format| format.extensions.contains(extension)));
        }
        assert_eq!(model_extensions().len(), MODEL_FORMATS.iter().map(|format| format.extensions.len()).sum::<usize>());
        assert!(ModelFormat::of(Path::new("obj")).is_none());
    }

    #[test]
    fn a_file_of_another_format_is_refused_with_the_formats_that_are_read() {
        for (name, words) in [("chair.fbx", "not \"fbx\""), ("chair", "not \"\"")] {
            let error = import_model(Path::new(name)).unwrap_err().to_string();
            let expected = format!("Catchlight reads models of the type {}, {words}: {name}", model_extension_list());
            assert_eq!(error, expected);
        }
    }

    #[test]
    fn a_format_without_embedded_images_says_so() {
        let error = embedded_image(Path::new("chair.obj"), 3).unwrap_err().to_string();
        assert_eq!(error, "OBJ files hold no images, so there is no image 3: chair.obj");
    }
}

//! The model formats that Catchlight reads. A new format is one entry in [`MODEL_FORMATS`] and one module.
//!
//! File dialogs, dropped files, mesh files of a scene and error messages all use this list.

use super::environment::ENVIRONMENT_EXTENSIONS;
use super::error::AssetError;
use super::load_progress::LoadProgress;
use super::model::{ImageReader, ImportedModel, ModelLimits};
use super::photometric::PHOTOMETRIC_EXTENSIONS;
use super::{gltf_model, obj, ply, stl};
use std::collections::HashMap;
use std::path::{Path, PathBuf};
use std::sync::{Arc, LazyLock, Mutex, MutexGuard, PoisonError};

/// A format of model files.
#[derive(Debug)]
pub struct ModelFormat {
    /// Name in dialogs and messages.
    pub name: &'static str,
    /// Extensions of file names, lower case, without the dot.
    pub extensions: &'static [&'static str],
    /// True if the format says that its lengths are metres.
    pub states_metres: bool,
    /// Limits that the importer holds.
    pub limits: ModelLimits,
    import: fn(&Path, &ModelLimits, &LoadProgress) -> Result<ImportedModel, AssetError>,
    /// Returns the files with data of a model, by their paths from its folder; `None` for formats of one file.
    companions: Option<fn(&Path, &ModelLimits) -> Vec<String>>,
    /// Opens a model file for the images inside it; `None` for formats without.
    images: Option<OpenImages>,
}

/// Opens a model file for the images inside it.
type OpenImages = fn(&Path, &ModelLimits) -> Result<ImageReader, AssetError>;

/// Every model format, in the order of dialogs.
pub const MODEL_FORMATS: &[ModelFormat] = &[
    ModelFormat {
        name: "glTF",
        extensions: &["glb", "gltf"],
        states_metres: true,
        limits: ModelLimits { file_bytes: 1 << 30, triangles: 20_000_000 },
        import: gltf_model::import,
        companions: Some(gltf_model::companions),
        images: Some(gltf_model::images),
    },
    ModelFormat {
        name: "OBJ",
        extensions: &["obj"],
        states_metres: false,
        limits: ModelLimits { file_bytes: 1 << 30, triangles: 20_000_000 },
        import: obj::import,
        companions: None,
        images: None,
    },
    ModelFormat {
        name: "PLY",
        extensions: &["ply"],
        states_metres: false,
        limits: ModelLimits { file_bytes: 1 << 30, triangles: 20_000_000 },
        import: ply::import,
        companions: None,
        images: None,
    },
    ModelFormat {
        name: "STL",
        extensions: &["stl"],
        states_metres: false,
        limits: ModelLimits { file_bytes: 1 << 30, triangles: 20_000_000 },
        import: stl::import,
        companions: None,
        images: None,
    },
];

impl ModelFormat {
    /// Returns the format of a file by its extension, in upper or lower case; `None` for other files.
    pub fn of(path: &Path) -> Option<&'static ModelFormat> {
        let extension = extension_of(path);
        MODEL_FORMATS.iter().find(|format| format.extensions.contains(&extension.as_str()))
    }
}

/// Imports a model: one mesh whose parts are the file's groups, with normals, and the materials of the parts.
///
/// # Errors
/// If the extension belongs to no format, or if the file can't be read, exceeds the format's limits or has a mistake;
/// the message names the line where the format has lines.
pub fn import_model(path: &Path) -> Result<ImportedModel, AssetError> {
    import_model_with(path, &LoadProgress::default())
}

/// As [`import_model`], with a progress that is shown and can be cancelled.
///
/// # Errors
/// As [`import_model`], and if it is cancelled.
pub fn import_model_with(path: &Path, progress: &LoadProgress) -> Result<ImportedModel, AssetError> {
    let format = format_of(path)?;
    let model = (format.import)(path, &format.limits, progress)?;
    progress.reach(1.0)?;
    Ok(model)
}

/// Returns the files with data of a model, by their paths from its folder: they go where the model goes.
pub(super) fn companions(path: &Path) -> Vec<String> {
    let Some(format) = ModelFormat::of(path) else { return Vec::new() };
    format.companions.map_or_else(Vec::new, |companions| companions(path, &format.limits))
}

/// The images inside of model files. Each file is read and parsed once, for the first of its images.
#[derive(Default)]
pub(super) struct EmbeddedImages {
    files: Mutex<HashMap<PathBuf, OpenModel>>,
}

/// A model file that is open for its images, or will be.
type OpenModel = Arc<Mutex<Option<Arc<ImageReader>>>>;

impl EmbeddedImages {
    /// Returns the bytes of an image inside a model file, a PNG or JPEG file by itself.
    ///
    /// # Errors
    /// As [`import_model`], if the format embeds no images, and if there is no such image.
    pub fn image(&self, path: &Path, image: u32) -> Result<Vec<u8>, AssetError> {
        let format = format_of(path)?;
        let Some(open) = format.images else {
            return Err(AssetError::NoEmbeddedImage { format: format.name, image, path: path.to_owned() });
        };
        let file = locked(&self.files).entry(path.to_owned()).or_default().clone();
        let reader = {
            // Others that want an image of this file wait here
            let mut file = locked(&file);
            match &*file {
                Some(reader) => reader.clone(),
                None => file.insert(Arc::new(open(path, &format.limits)?)).clone(),
            }
        };
        reader(image)
    }
}

/// Locks a mutex. What it guards is whole even if another thread has panicked.
fn locked<T>(mutex: &Mutex<T>) -> MutexGuard<'_, T> {
    mutex.lock().unwrap_or_else(PoisonError::into_inner)
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
    extension_list(model_extensions())
}

/// Returns the files that come into an open studio, with their extensions, for messages: `a model (.obj), a photometric
/// file (.ies) or a panorama (.hdr)`.
pub fn importable_files_text() -> String {
    let [models, lights, panoramas] =
        [model_extensions(), PHOTOMETRIC_EXTENSIONS, ENVIRONMENT_EXTENSIONS].map(extension_list);
    format!("a model ({models}), a photometric file ({lights}) or a panorama ({panoramas})")
}

fn extension_list(extensions: &[&str]) -> String {
    extensions.iter().map(|extension| format!(".{extension}")).collect::<Vec<_>>().join(", ")
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
    fn files_that_come_into_a_studio_are_listed_with_every_extension_that_is_read() {
        let text = importable_files_text();
        for extension in model_extensions().iter().chain(PHOTOMETRIC_EXTENSIONS).chain(ENVIRONMENT_EXTENSIONS) {
            assert!(text.contains(&format!(".{extension}")), "{extension}: {text}");
        }
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
        let error = EmbeddedImages::default().image(Path::new("chair.obj"), 3).unwrap_err().to_string();
        assert_eq!(error, "OBJ files hold no images, so there is no image 3: chair.obj");
    }
}

//! Files: scenes as versioned RON, models as OBJ, textures, shipped studios, finished pictures.
//!
//! A file is checked once, here at the border: what comes out of [`load_scene`] can go to every renderer, and what
//! does not pass leaves as an error that names the field, the value and the line. Odd but usable things become
//! warnings beside the scene. A save writes a new file beside the old one and renames it.

mod asset_files;
mod assets;
mod atomic;
mod error;
mod figures;
mod importers;
mod layout;
mod locate;
mod model;
mod obj;
mod picture;
mod presets;
mod read;
mod ron_v1;
mod scene_file;
mod texture;

pub use asset_files::{AssetCopy, AssetFiles};
pub use assets::{load_assets, load_assets_from, missing_assets};
pub use error::{AssetError, LoadError, Problem, SaveError};
pub use importers::{
    MODEL_FORMATS, ModelFormat, import_model, model_extension_list, model_extensions, model_format_names,
};
pub use model::{ImportedModel, ModelLimits};
pub use picture::{PictureFormat, PictureInfo, export_layers, export_picture, export_shown, read_exr};
pub use presets::{Preset, find_preset, presets};
pub use scene_file::{FILE_LIMIT_BYTES, FORMAT, Loaded, load_scene, parse_scene, save_scene, write_scene};
pub use texture::TEXTURE_EXTENSIONS;

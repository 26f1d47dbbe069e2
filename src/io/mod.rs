//! Reads and writes files: scenes as versioned RON, models, textures, studio presets, finished pictures.
//!
//! Files are checked here and nowhere else. A scene from [`load_scene`] is valid for every renderer; an invalid file is
//! an error that names the field, the value and the line; odd but usable values are warnings beside the scene. A save
//! writes a new file beside the older one and renames it.
//!
//! To add a model format, write a module beside `obj` and list it in [`MODEL_FORMATS`]. To add a kind of asset, add a
//! variant to [`AssetRef`](crate::scene::AssetRef) and follow the compiler to its loader in `assets`.

// A number of a file or an argument that does not fit is an error and never wraps.
#![deny(clippy::cast_possible_truncation, clippy::cast_possible_wrap, clippy::cast_sign_loss)]

mod asset_files;
mod assets;
mod atomic;
mod checkpoint;
mod contained_file;
mod environment;
mod error;
mod figures;
mod file_stamp;
mod gear_file;
mod gltf_model;
mod importers;
mod jpeg_end;
mod kept_picture;
mod layout;
mod load_progress;
mod locate;
mod model;
mod model_set_up;
mod model_size;
mod model_studio;
mod obj;
mod parse_errors;
mod photometric;
mod picture;
mod plain_file;
mod ply;
mod presets;
mod program_folders;
mod read;
mod recovery;
mod ron_v1;
mod scene_file;
mod stl;
mod tanks;
mod texture;
mod texture_memory;
mod unique_names;

pub use asset_files::{AssetCopy, AssetFiles, AssetSource};
pub use assets::{load_assets, load_assets_from, missing_assets};
pub use checkpoint::{RenderId, read_checkpoint, write_checkpoint};
pub use environment::{ENVIRONMENT_EXTENSIONS, EnvironmentFile, read_environment};
pub use error::{AssetError, LoadError, Problem, SaveError, reason};
pub use file_stamp::FileStamp;
pub use gear_file::{GearError, bundled_gear, own_gear_path, read_gear, save_gear};
pub use importers::{
    MODEL_FORMATS, ModelFormat, import_model, import_model_with, importable_files_text, model_extension_list,
    model_extensions, model_format_names,
};
pub use kept_picture::KeptPicture;
pub use load_progress::LoadProgress;
pub use model::{ImportedModel, ModelLimits, ModelSetUp};
pub use model_set_up::expose_for_lamps;
pub use model_size::{MODEL_UNITS, fit_model, is_model_size_doubtful, model_unit_m, scale_model};
pub use model_studio::{ModelStudio, studio_of};
pub use photometric::{PHOTOMETRIC_EXTENSIONS, PhotometricFile, is_photometric_file, read_photometric_file};
pub use picture::{
    CaptureInfo, LayeredPicture, PictureFile, PictureFormat, PictureInfo, PicturePart, RenderedPicture,
    check_picture_file, encode_jpeg, encode_part, encode_png, export_picture, export_shown, is_panorama, picture_file,
    read_exr, read_part, read_rendered,
};
pub use plain_file::{check_file, write_file};
pub use presets::{Preset, PresetGroup, find_preset, presets};
pub use program_folders::{settings_folder, state_folder};
pub use recovery::{RecoveryFolder, RecoveryInfo};
pub use scene_file::{
    FILE_LIMIT_BYTES, FORMAT, Loaded, load_scene, load_scene_with, parse_scene, save_scene, write_scene,
};
pub use texture::{TEXTURE_EXTENSIONS, is_texture_file};

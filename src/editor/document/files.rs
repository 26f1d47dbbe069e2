//! Reads and writes studios, models, assets and pictures, with errors as messages to the user.

use crate::denoise::{Quality, denoise_layers};
use crate::editor::document::asset_stamps::AssetStamps;
use crate::editor::document::studio_document::Document;
use crate::io::{
    self, AssetFiles, FileStamp, KeptPicture, LayeredPicture, LoadProgress, ModelFormat, ModelSetUp, PictureFormat,
    PictureInfo, PresetGroup, RecoveryFolder, RecoveryInfo,
};
use crate::jobs::sentence;
use crate::photo::{LazyPicture, Picture};
use crate::raytrace::Film;
use crate::scene::{Aim, Assets, Bodies, Camera, Material, Mesh, Room, Scene};
use glam::Vec3;
use std::collections::BTreeMap;
use std::path::{Path, PathBuf};
use std::sync::Arc;

/// Name and description of a shipped studio.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct PresetInfo {
    /// What it is for.
    pub group: PresetGroup,
    /// Name.
    pub name: String,
    /// One line on its use.
    pub description: String,
}

/// Returns the shipped studios, in list order.
pub fn presets() -> Vec<PresetInfo> {
    let info = |p: &io::Preset| PresetInfo { group: p.group, name: p.name.clone(), description: p.description.clone() };
    io::presets().iter().map(info).collect()
}

/// Returns a room without lights and figures, with a camera at the height of a face. The bodies of its lights are there
/// but for the camera, which may stand among them.
pub fn empty_studio() -> Scene {
    let camera =
        Camera { position: Vec3::new(0.0, 1.55, 3.2), aim: Aim::Point(Vec3::new(0.0, 1.5, 0.0)), ..Camera::default() };
    let bodies = Bodies::InReflections;
    Scene { name: "New studio".to_owned(), room: Some(Room::default()), camera, bodies, ..Scene::default() }
}

/// A studio loaded from a file or from the shipped ones.
#[derive(Clone, Debug)]
pub struct OpenedStudio {
    /// The studio.
    pub scene: Scene,
    /// Meshes and textures.
    pub assets: Assets,
    /// Warnings of loading.
    pub warnings: Vec<String>,
    /// File; none for a shipped studio.
    pub path: Option<PathBuf>,
    /// State of the file when it was read; for a recovered studio, when it was read or written last.
    pub stamp: Option<FileStamp>,
    /// The rendered picture that it was read from.
    pub picture: Option<KeptPicture>,
}

/// A studio that was kept when its window ended.
#[derive(Debug)]
pub struct RecoveredStudio {
    /// The studio.
    pub opened: OpenedStudio,
    /// Its rendered picture if it has one, or the reason why that could not be read.
    pub picture: Result<Option<KeptPicture>, String>,
}

/// An imported model.
#[derive(Clone, Debug)]
pub struct ImportedModel {
    /// File.
    pub file: PathBuf,
    /// Triangles.
    pub mesh: Arc<Mesh>,
    /// Materials by part.
    pub part_materials: Vec<(String, Material)>,
    /// Lamps and camera of the file, in the model's space.
    pub set_up: ModelSetUp,
    /// True if the file says that its lengths are metres.
    pub states_metres: bool,
    /// Warnings of the importer.
    pub warnings: Vec<String>,
}

/// The source of a studio.
#[derive(Clone, Debug, PartialEq)]
pub enum StudioSource {
    /// A file.
    File(PathBuf),
    /// A shipped studio, by its index in the list.
    Preset(usize),
    /// A studio that no file holds.
    Memory(Box<Scene>),
}

impl StudioSource {
    /// Returns the name of the file or the studio.
    pub fn name(&self) -> String {
        match self {
            StudioSource::File(path) => path.file_name().unwrap_or_default().to_string_lossy().into_owned(),
            StudioSource::Preset(index) => io::presets().get(*index).map(|p| p.name.clone()).unwrap_or_default(),
            StudioSource::Memory(scene) => scene.name.clone(),
        }
    }

    /// Returns the file if it exists, else the shipped studio of that name.
    pub fn named(path: PathBuf) -> Self {
        let shipped = path.to_str().filter(|_| !path.exists()).and_then(io::find_preset);
        let place = shipped.and_then(|preset| io::presets().iter().position(|p| p.file_name == preset.file_name));
        place.map_or(StudioSource::File(path), StudioSource::Preset)
    }
}

/// Returns true for the name of a rendered picture that holds its studio.
fn is_rendered_picture(path: &Path) -> bool {
    PictureFormat::of(path).is_ok_and(|format| format == PictureFormat::Exr)
}

/// Reads a rendered picture, with its studio and the assets of that beside it. The studio has no file: saving it asks for
/// one.
fn open_rendered(path: &Path, progress: &LoadProgress) -> Result<Box<OpenedStudio>, String> {
    let rendered = io::read_rendered(path).map_err(|why| format!("{}: {why}", path.display()))?;
    let scene = Scene::clone(&rendered.picture.scene);
    let mut assets = Assets::default();
    let missing = io::load_assets_from(&scene, AssetFiles::in_folder(path.parent()), progress, &mut assets);
    let missing = missing.iter().map(ToString::to_string);
    let warnings = rendered.findings.iter().map(ToString::to_string).chain(missing).collect();
    Ok(Box::new(OpenedStudio { scene, assets, warnings, path: None, stamp: None, picture: Some(rendered.picture) }))
}

/// Reads a studio with its assets, or a rendered picture with its studio. Assets are left out if it is cancelled.
pub fn open(source: &StudioSource, progress: &LoadProgress) -> Result<Box<OpenedStudio>, String> {
    if let StudioSource::File(path) = source
        && is_rendered_picture(path)
    {
        return open_rendered(path, progress);
    }
    // Taken first: a change while the file is read counts as a change.
    let stamp = match source {
        StudioSource::File(path) => FileStamp::of(path).ok(),
        StudioSource::Preset(_) | StudioSource::Memory(_) => None,
    };
    let loaded = match source {
        StudioSource::File(path) => io::load_scene_with(path, progress).map_err(|e| sentence(&e))?,
        StudioSource::Preset(index) => {
            let preset = io::presets().get(*index).ok_or("There is no such studio on the shelf.")?;
            preset.load().map_err(|e| sentence(&e))?
        }
        StudioSource::Memory(scene) => {
            let (assets, warnings) = load_assets(scene, None, &Assets::default(), &BTreeMap::new());
            let (scene, picture) = (Scene::clone(scene), None);
            return Ok(Box::new(OpenedStudio { scene, assets, warnings, path: None, stamp, picture }));
        }
    };
    let path = match source {
        StudioSource::File(path) => Some(path.clone()),
        StudioSource::Preset(_) | StudioSource::Memory(_) => None,
    };
    let warnings = loaded.warnings.iter().map(ToString::to_string).collect();
    let (scene, assets) = (loaded.scene, loaded.assets);
    Ok(Box::new(OpenedStudio { scene, assets, warnings, path, stamp, picture: None }))
}

/// Reads an unsaved studio with its assets and its rendered picture.
pub fn recover(folder: &RecoveryFolder, info: &RecoveryInfo) -> Result<Box<RecoveredStudio>, String> {
    let scene = folder.read().map_err(|e| sentence(&e))?;
    let RecoveryInfo { path, stamp, imported, .. } = info.clone();
    let (assets, warnings) = load_assets(&scene, path.as_deref().and_then(Path::parent), &Assets::default(), &imported);
    let picture = folder.read_picture(&assets);
    let opened = OpenedStudio { scene, assets, warnings, path, stamp, picture: None };
    Ok(Box::new(RecoveredStudio { opened, picture }))
}

/// Reads a model.
pub fn import(file: PathBuf, progress: &LoadProgress) -> Result<Box<ImportedModel>, String> {
    let model = io::import_model_with(&file, progress).map_err(|e| sentence(&e))?;
    let io::ImportedModel { mesh, part_materials, set_up, warnings } = model;
    let states_metres = ModelFormat::of(&file).is_some_and(|format| format.states_metres);
    let mesh = Arc::new(mesh);
    Ok(Box::new(ImportedModel { file, mesh, part_materials, set_up, states_metres, warnings }))
}

/// Reads the assets that a scene refers to and that are not loaded yet, and returns those. `imported` maps paths in the
/// scene to imported files outside the scene's folder.
pub fn load_assets(
    scene: &Scene,
    folder: Option<&Path>,
    known: &Assets,
    imported: &BTreeMap<String, PathBuf>,
) -> (Assets, Vec<String>) {
    let mut assets = known.clone();
    let files = AssetFiles { folder, imported };
    let warnings = io::load_assets_from(scene, files, &LoadProgress::default(), &mut assets);
    (assets.without(known), warnings.iter().map(ToString::to_string).collect())
}

/// Assets whose files another program has changed, read again.
#[derive(Debug, Default)]
pub struct RereadAssets {
    /// The assets that were read: those of changed files, and those that were missing and are there now.
    pub assets: Assets,
    /// The paths of their files in the studio.
    pub files: Vec<String>,
    /// The states of all files. A changed one that could not be read keeps its former state, and is tried again.
    pub stamps: AssetStamps,
    /// Warnings of loading.
    pub warnings: Vec<String>,
}

/// Reads the assets of a scene again whose files have changed since their stamps. `known` are the loaded ones.
pub fn reread_changed(scene: &Scene, files: AssetFiles<'_>, known: &Assets, stamps: AssetStamps) -> RereadAssets {
    let found = files.found(scene);
    let changed: BTreeMap<&str, &PathBuf> =
        found.iter().filter(|(_, file)| stamps.is_outdated(file)).map(|(path, file)| (&**path, file)).collect();
    if changed.is_empty() {
        return RereadAssets { stamps, ..RereadAssets::default() };
    }
    // Taken first: a change while a file is read counts as a change
    let mut now = stamps.clone();
    changed.values().for_each(|file| now.renew(file));
    let mut unchanged = known.clone();
    let is_changed = |path: Option<&str>| path.is_some_and(|path| changed.contains_key(path));
    known.iter().filter(|(key, _)| is_changed(key.path())).for_each(|(key, _)| unchanged.remove(key));
    let (assets, warnings) = load_assets(scene, files.folder, &unchanged, files.imported);
    let (read, unread): (Vec<_>, Vec<_>) = changed.iter().partition(|(path, _)| assets.contains_file(path));
    unread.into_iter().for_each(|(_, file)| now.restore(file, &stamps));
    let files = read.into_iter().map(|(path, _)| (*path).to_owned()).collect();
    RereadAssets { assets, files, stamps: now, warnings }
}

/// Writes the studio and copies its assets beside it. Returns the asset files that are gone, by the studio's paths.
pub fn save(document: &Document, path: &Path) -> Result<Vec<String>, String> {
    let folder = path.parent().unwrap_or(Path::new(""));
    let (copies, gone) = document.asset_files().copies_into(folder, document.scene(), document.assets());
    for copy in copies {
        copy.make().map_err(|e| sentence(&e))?;
    }
    io::save_scene(document.scene(), path).map_err(|e| sentence(&e))?;
    Ok(gone)
}

/// A rendered picture that is to be written.
#[derive(Debug)]
pub struct PictureExport {
    /// The picture.
    pub picture: Arc<Picture>,
    /// The picture before the denoiser, and the network; none if it is not denoised.
    pub denoised_from: Option<(Arc<Picture>, Quality)>,
    /// The film of the picture, if it is still there.
    pub film: Option<Arc<Film>>,
    /// The studio, with the lights as in the picture.
    pub scene: Scene,
    /// The settings of the render.
    pub info: PictureInfo,
}

/// Writes a picture in the format of its extension. An EXR file also gets a part for each light, the AOVs, and the picture
/// and the lights before the denoiser.
pub fn export(path: &Path, export: &PictureExport) -> Result<(), String> {
    let PictureExport { picture, denoised_from, film, scene, info } = export;
    let is_exr = PictureFormat::of(path).is_ok_and(|format| format == PictureFormat::Exr);
    let film =
        film.as_deref().filter(|film| is_exr && (film.width(), film.height()) == (picture.width, picture.height));
    let aovs = film.and_then(Film::aovs);
    let mut traced = film.map(|film| film.lazy_layers(scene)).unwrap_or_default();
    let mut shown = Vec::new();
    if let Some((noisy, quality)) = denoised_from {
        shown = film.and_then(|film| denoised_layers(film, scene, noisy, *quality)).unwrap_or_default();
        traced.truncate(shown.len());
    }
    let file = match denoised_from {
        Some((noisy, quality)) => {
            let info = PictureInfo { denoiser: Some(quality.label()), ..info.clone() };
            let noisy = LayeredPicture { picture: noisy, layers: &traced };
            let shown = LayeredPicture { picture, layers: &shown };
            io::picture_file(path, shown, Some(noisy), aovs.as_ref(), &info)
        }
        None => io::picture_file(path, LayeredPicture { picture, layers: &traced }, None, aovs.as_ref(), info),
    };
    file.and_then(|file| file.write()).map_err(|e| sentence(&e))
}

/// Denoises the layers of a film. None for a film without albedo and normals.
fn denoised_layers(
    film: &Film,
    scene: &Scene,
    noisy: &Picture,
    quality: Quality,
) -> Option<Vec<(String, LazyPicture<'static>)>> {
    let (names, layers): (Vec<String>, Vec<Picture>) = film.develop_layers(scene).into_iter().unzip();
    let denoised = denoise_layers(noisy, &layers, &film.aovs()?, quality, &|| false).ok()?;
    Some(names.into_iter().zip(denoised.layers.into_iter().map(LazyPicture::from)).collect())
}

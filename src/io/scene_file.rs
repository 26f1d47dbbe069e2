//! Reads and writes scene files. Reading checks size and nesting first, then the syntax, then the values.

use super::asset_files::AssetFiles;
use super::error::{LoadError, Problem, SaveError};
use super::load_progress::LoadProgress;
use super::parse_errors::{explain, explain_name, problem_at, problem_of, shorten};
use super::unique_names::make_names_unique;
use super::{assets, atomic, layout, locate, ron_v1};
use crate::figures;
use crate::scene::{Assets, Finding, Scene, Severity, VARIANT_LIMIT, placement, validate};
use std::io::Read;
use std::path::Path;

/// The newest format of scene files, in which all are written.
pub const FORMAT: u32 = 1;

/// Largest scene file, bytes: ten thousand lights and as many objects.
pub const FILE_LIMIT_BYTES: u64 = 32_000_000;

/// Most problems reported of one file: locating each scans the text.
const PROBLEM_LIMIT: usize = 20;

/// A loaded scene with its assets, ready for every renderer.
#[derive(Clone, Debug)]
pub struct Loaded {
    /// The studio.
    pub scene: Scene,
    /// Its meshes and textures, as far as they could be loaded.
    pub assets: Assets,
    /// Odd values, missing assets and repaired names.
    pub warnings: Vec<Finding>,
}

/// Loads a scene and the assets it refers to, which lie in the scene's folder.
///
/// # Errors
/// If the file can't be read, is larger than [`FILE_LIMIT_BYTES`] or is no usable scene. A missing model or texture is
/// a warning.
pub fn load_scene(path: &Path) -> Result<Loaded, LoadError> {
    load_scene_with(path, &LoadProgress::default())
}

/// As [`load_scene`], with a progress that is shown. If that is cancelled, assets are left out.
///
/// # Errors
/// As [`load_scene`].
pub fn load_scene_with(path: &Path, progress: &LoadProgress) -> Result<Loaded, LoadError> {
    let in_file = |error| LoadError::InFile { error: Box::new(error), path: path.to_owned() };
    let text = read_text(path).map_err(|error| match error {
        LoadError::Read { .. } => error,
        other => in_file(other),
    })?;
    let (scene, warnings) = parse_scene(&text).map_err(in_file)?;
    Ok(complete(scene, warnings, path.parent(), progress))
}

/// Loads the assets of a parsed scene, and adds the warnings about them and about placement.
pub(super) fn complete(
    scene: Scene,
    mut warnings: Vec<Finding>,
    folder: Option<&Path>,
    progress: &LoadProgress,
) -> Loaded {
    let mut assets = Assets::default();
    warnings.extend(assets::load_assets_from(&scene, AssetFiles::in_folder(folder), progress, &mut assets));
    warnings.extend(placement(&scene, &assets));
    Loaded { scene, assets, warnings }
}

/// Returns the text of a scene file of at most [`FILE_LIMIT_BYTES`].
pub(super) fn read_text(path: &Path) -> Result<String, LoadError> {
    let read_error = |error| LoadError::Read { error, path: path.to_owned() };
    let file = std::fs::File::open(path).map_err(read_error)?;
    let bytes = file.metadata().map_err(read_error)?.len();
    if bytes > FILE_LIMIT_BYTES {
        return Err(LoadError::TooLarge { bytes, limit_bytes: FILE_LIMIT_BYTES });
    }
    let mut content = Vec::with_capacity(usize::try_from(bytes).unwrap_or_default());
    // The size of a pipe or a growing file is not known beforehand.
    file.take(FILE_LIMIT_BYTES + 1).read_to_end(&mut content).map_err(read_error)?;
    String::from_utf8(content).map_err(|error| LoadError::NotText(error.utf8_error().valid_up_to()))
}

/// Parses the text of a scene file. Returns the scene and the warnings that need no other files.
///
/// # Errors
/// If the text is no scene, or a scene with errors. Every problem names field, value and line.
pub fn parse_scene(text: &str) -> Result<(Scene, Vec<Finding>), LoadError> {
    if text.len() as u64 > FILE_LIMIT_BYTES {
        return Err(LoadError::TooLarge { bytes: text.len() as u64, limit_bytes: FILE_LIMIT_BYTES });
    }
    let text = text.strip_prefix('\u{feff}').unwrap_or(text);
    let one = |problem| LoadError::Content(vec![problem]);
    let outline = locate::check_nesting(text).map_err(|locate::TooDeep(at)| {
        one(problem_at(text, String::new(), "brackets nest too deep for a studio".to_owned(), at..at + 1))
    })?;
    check_format(text).map_err(one)?;
    let options = ron::Options::default().with_default_extension(ron::extensions::Extensions::IMPLICIT_SOME);
    let file = options.from_str::<ron_v1::SceneV1>(text).map_err(|error| one(explain(text, &error)))?;
    let (mut scene, shown) = ron_v1::scene_from_v1(file).map_err(|unknown| one(explain_name(text, &unknown)))?;

    let mut warnings = make_names_unique(&mut scene);
    if scene.variants.others.len() <= VARIANT_LIMIT {
        scene.drop_equal_parts_of_variants();
    }
    // Only valid figures have eyes to turn.
    if validate(&scene).iter().all(|finding| finding.severity != Severity::Error) {
        scene.show_variant(shown.unwrap_or_default());
        figures::follow_gazes(&mut scene);
    }
    let (errors, odd): (Vec<_>, Vec<_>) = validate(&scene).into_iter().partition(|f| f.severity == Severity::Error);
    if !errors.is_empty() {
        return Err(LoadError::Content(
            errors.iter().take(PROBLEM_LIMIT).map(|error| problem_of(text, error)).collect(),
        ));
    }
    warnings.extend(odd);
    if outline.has_comments {
        warnings.push(Finding::warning("", "the file has comments; saving does not keep them"));
    }
    Ok((scene, warnings))
}

/// Returns the text of a scene file. Parsing it gives the same scene, with ids in list order and, if another variant than
/// the studio itself is shown, without the solo of that variant.
pub fn write_scene(scene: &Scene) -> String {
    let shown = scene.variants.shown();
    let mut unique = scene.as_variant(scene.variants.studio_id).unwrap_or_else(|| scene.clone());
    make_names_unique(&mut unique);
    let options = ron::Options::default().with_default_extension(ron::extensions::Extensions::IMPLICIT_SOME);
    // Serializing plain structs, strings and numbers to a string can't fail.
    let compact = options.to_string(&ron_v1::v1_from_scene(&unique, shown)).unwrap_or_default();
    layout::lay_out(&compact)
}

/// Saves a scene: writes a file beside the older one, flushes it to the disk, then renames it over the older one. The
/// file opens with the studio itself, whatever variant is shown.
///
/// # Errors
/// If the scene has errors and so would not load again, or if it can't be written. The older file is then unchanged.
pub fn save_scene(scene: &Scene, path: &Path) -> Result<(), SaveError> {
    if let Some(error) = validate(scene).into_iter().find(|f| f.severity == Severity::Error && !f.is_name_clash()) {
        return Err(SaveError::Invalid(error));
    }
    let of_studio = figures::as_variant(scene, scene.variants.studio_id);
    atomic::write(path, write_scene(of_studio.as_ref().unwrap_or(scene)).as_bytes())
}

/// Checks the format number before the rest of the text is parsed.
fn check_format(text: &str) -> Result<(), Problem> {
    let Some(range) = locate::exact_value_at(text, "format") else {
        let message =
            if text.trim().is_empty() { "the file is empty" } else { "a studio's file begins with `(format: 1,`" };
        return Err(problem_at(text, "format".to_owned(), message.to_owned(), 0..0));
    };
    let message = match text[range.clone()].parse::<u32>() {
        Ok(FORMAT) => return Ok(()),
        Ok(0) | Err(_) => {
            format!("{:?} is no format; this version reads format {FORMAT}", shorten(&text[range.clone()]))
        }
        Ok(newer) => format!("the file has format {newer}, but this version of the program reads only up to {FORMAT}"),
    };
    Err(problem_at(text, "format".to_owned(), message, range))
}

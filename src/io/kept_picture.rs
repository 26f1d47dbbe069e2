//! A rendered picture in the folder of an unsaved studio: the film with all its samples, and the studio as it was
//! rendered.
//!
//! The file `picture.ron` names the film's file. A new film gets another name than the last one, so that the pair on the
//! disk always belongs together.

use super::checkpoint::{RenderId, read_checkpoint, write_checkpoint};
use super::error::{SaveError, reason};
use super::scene_file::{parse_scene, read_text, write_scene};
use super::{Problem, atomic};
use crate::raytrace::{self, Film, GeometryCache, Layer, Purpose, Settings};
use crate::scene::{Assets, Scene};
use serde::{Deserialize, Serialize};
use std::path::{Path, PathBuf};
use std::sync::Arc;

const PICTURE: &str = "picture.ron";
const FILMS: [&str; 2] = ["picture-1.film", "picture-2.film"];
/// Beginning of the picture's file, before its header in JSON on the same line.
const HEADER: &str = "// Rendered picture, kept by Catchlight: ";

/// A rendered picture, finished or not.
#[derive(Clone, Debug)]
pub struct KeptPicture {
    /// Its samples.
    pub film: Arc<Film>,
    /// The studio as it was rendered.
    pub scene: Arc<Scene>,
    /// Size, method and number of samples.
    pub settings: Settings,
    /// It has all samples.
    pub is_complete: bool,
}

#[derive(Debug, Serialize, Deserialize)]
struct Header {
    film: String,
    /// Names of the film's layers.
    layers: Vec<String>,
    settings: Settings,
    is_complete: bool,
}

/// Returns the file that says which picture a folder holds.
pub(super) fn file_in(folder: &Path) -> PathBuf {
    folder.join(PICTURE)
}

/// Writes a picture in place of the last one.
///
/// # Errors
/// If a file can't be written; the last picture is kept.
pub(super) fn write(folder: &Path, picture: &KeptPicture) -> Result<(), SaveError> {
    let last = read_header(folder).map(|(header, _)| header.film);
    let film = FILMS.into_iter().find(|name| last.as_deref() != Some(name)).unwrap_or(FILMS[0]);
    let header = Header {
        film: film.to_owned(),
        layers: names(picture.film.layers()),
        settings: picture.settings.clone(),
        is_complete: picture.is_complete,
    };
    let path = file_in(folder);
    let text =
        serde_json::to_string(&header).map_err(|error| SaveError::Write { error: error.into(), path: path.clone() })?;
    write_checkpoint(&folder.join(film), render_id(&picture.scene, &text), &picture.film)?;
    atomic::write(&path, format!("{HEADER}{text}\n{}", write_scene(&picture.scene)).as_bytes())?;
    if let Some(last) = last {
        // It is of no use any more; a later write replaces it.
        let _ = std::fs::remove_file(folder.join(last));
    }
    Ok(())
}

/// Reads a picture. None if the folder holds none.
///
/// # Errors
/// If the picture is damaged or of another version of the program, or if its studio can't be prepared with `assets`.
pub(super) fn read(folder: &Path, assets: &Assets) -> Result<Option<KeptPicture>, String> {
    let path = file_in(folder);
    if !path.exists() {
        return Ok(None);
    }
    let (header, text) = read_header(folder).ok_or("its header is damaged")?;
    let scene = parse_scene(&read_text(&path).map_err(|error| error.to_string())?)
        .map_err(|error| error.problems().first().map_or(error.to_string(), Problem::to_string))?
        .0;
    let film = FILMS.into_iter().find(|name| *name == header.film).ok_or("its header is damaged")?;
    let bytes = read_checkpoint(&folder.join(film), render_id(&scene, &text))?.ok_or("its samples are missing")?;
    // The film has the layers of the prepared studio, or of one whose lights share layers
    let cache = GeometryCache::default();
    let prepared = raytrace::prepare_kept(&scene, assets, &cache).map_err(|error| error.to_string())?;
    let prepared = match names(prepared.layers()) == header.layers {
        true => prepared,
        false => {
            let purpose = Purpose { shares_layers: true, ..Purpose::default() };
            raytrace::prepare_for(&scene, assets, purpose, &cache).map_err(|error| error.to_string())?
        }
    };
    let Header { settings, is_complete, .. } = header;
    let film = raytrace::empty_film(&prepared, &settings).with_stored(&mut &bytes[..]);
    let film = Arc::new(film.map_err(|error| reason(&error))?);
    Ok(Some(KeptPicture { film, scene: Arc::new(scene), settings, is_complete }))
}

/// Removes the picture, if there is one.
pub(super) fn remove(folder: &Path) {
    for name in [PICTURE].into_iter().chain(FILMS) {
        // Without it there is nothing to remove.
        let _ = std::fs::remove_file(folder.join(name));
    }
}

/// Returns the header of a folder's picture, and its text.
fn read_header(folder: &Path) -> Option<(Header, String)> {
    let text = std::fs::read_to_string(file_in(folder)).ok()?;
    let text = text.lines().next()?.strip_prefix(HEADER)?;
    Some((serde_json::from_str(text).ok()?, text.to_owned()))
}

fn names(layers: &[Layer]) -> Vec<String> {
    layers.iter().map(|layer| layer.name.clone()).collect()
}

fn render_id(scene: &Scene, header: &str) -> RenderId {
    // Films are read with any assets: they hold light, not surfaces.
    RenderId::new(scene, &Assets::default(), header)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::io::presets;
    use crate::raytrace::{RenderControl, prepare_for, render};
    use std::ops::ControlFlow;

    fn picture(spp: u32, shared: bool) -> (KeptPicture, Assets) {
        let loaded = presets().iter().find(|preset| preset.file_name.starts_with("product")).unwrap().load().unwrap();
        let purpose = Purpose { shares_layers: shared, ..Purpose::default() };
        let prepared = prepare_for(&loaded.scene, &loaded.assets, purpose, &GeometryCache::default());
        let settings = Settings { width: 40, height: 30, spp, aovs: true, ..Settings::default() };
        let film = render(&prepared.unwrap(), &settings, &RenderControl::new(), &mut |_| ControlFlow::Continue(()));
        let (film, scene) = (Arc::new(film), Arc::new(loaded.scene));
        (KeptPicture { film, scene, settings, is_complete: spp > 1 }, loaded.assets)
    }

    #[test]
    fn a_kept_picture_has_all_samples_and_lights_and_the_last_one_is_kept() {
        let folder = tempfile::tempdir().unwrap();
        let folder = folder.path();
        for (spp, shared) in [(1, false), (3, false), (2, true)] {
            let (picture, assets) = picture(spp, shared);
            write(folder, &picture).unwrap();
            assert_eq!(std::fs::read_dir(folder).unwrap().count(), 2, "of the last picture nothing is left");
            let read = read(folder, &assets).unwrap().unwrap();
            assert_eq!((&read.scene, &read.settings, read.is_complete), (&picture.scene, &picture.settings, spp > 1));
            assert_eq!(read.film.layers(), picture.film.layers());
            let mut dimmed = Scene::clone(&picture.scene);
            dimmed.lights[0].power.dial_stops -= 1.0;
            assert_eq!(read.film.develop_layers(&dimmed), picture.film.develop_layers(&dimmed));
            assert_eq!((read.film.aovs(), read.film.spp()), (picture.film.aovs(), spp));
        }
        remove(folder);
        assert_eq!(std::fs::read_dir(folder).unwrap().count(), 0);
        assert!(read(folder, &Assets::default()).unwrap().is_none());
    }

    #[test]
    fn a_damaged_kept_picture_is_an_error() {
        let folder = tempfile::tempdir().unwrap();
        let (picture, assets) = picture(1, false);
        write(folder.path(), &picture).unwrap();
        let header = file_in(folder.path());
        let text = std::fs::read_to_string(&header).unwrap();
        let error = |text: &str| {
            std::fs::write(&header, text).unwrap();
            read(folder.path(), &assets).unwrap_err()
        };
        assert!(error(&text.replacen("\"width\":40", "\"width\":41", 1)).contains("of another studio"));
        assert!(error(&text.replacen("picture-1", "../../picture-1", 1)).contains("header is damaged"));
        assert!(error("nothing").contains("header is damaged"));
        assert!(error(text.lines().next().unwrap()).contains("line 1"), "the studio is missing");
        std::fs::write(&header, &text).unwrap();
        std::fs::remove_file(folder.path().join(FILMS[0])).unwrap();
        assert_eq!(read(folder.path(), &assets).unwrap_err(), "its samples are missing");
    }
}

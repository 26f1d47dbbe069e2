//! The converged picture that all others are compared with, cached in the chart's folder.

use crate::cli::terminal;
use crate::io::{self, Loaded, PictureInfo};
use crate::jobs::render_all_passes;
use crate::photo::Picture;
use crate::raytrace::{RenderControl, RenderScene, Settings};
use crate::scene::{Asset, AssetRef};
use std::collections::BTreeMap;
use std::hash::{DefaultHasher, Hash, Hasher};
use std::path::{Path, PathBuf};

/// Returns the reference of a studio: from the folder if this version has rendered the same studio before, or rendered
/// and written there. A folder that cannot be written causes a warning.
pub fn load_or_render(folder: &Path, loaded: &Loaded, scene: &RenderScene, settings: &Settings) -> Picture {
    let (spp, size) = (settings.spp, (settings.width, settings.height));
    let path = path(folder, loaded, settings);
    if let Ok(picture) = io::read_exr(&path)
        && (picture.width, picture.height) == size
    {
        terminal::progress(format_args!(
            "{}: reference of {spp} samples a pixel, from {}",
            loaded.scene.name,
            path.display()
        ));
        return picture;
    }
    terminal::progress(format_args!("{}: reference of {spp} samples a pixel ...", loaded.scene.name));
    let film = render_all_passes(scene, settings, &RenderControl::new());
    let picture = film.develop(&loaded.scene);
    let info = PictureInfo::new(&loaded.scene, "path", spp, u64::from(settings.seed));
    if let Err(error) = io::export_picture(&path, &picture, &info) {
        log::warn!("the reference is not kept: {error}");
    }
    picture
}

/// Returns the file of a reference, named by a hash of the studio, its files, the settings and the version.
fn path(folder: &Path, loaded: &Loaded, settings: &Settings) -> PathBuf {
    let mut hasher = DefaultHasher::new();
    env!("CARGO_PKG_VERSION").hash(&mut hasher);
    io::write_scene(&loaded.scene).hash(&mut hasher);
    (settings.width, settings.height, settings.spp, settings.seed).hash(&mut hasher);
    for object in &loaded.scene.objects {
        if let Some(mesh) = loaded.assets.mesh_of(&object.shape) {
            mesh.hash_content(&mut hasher);
        }
    }
    let textures = loaded.assets.iter().filter_map(|(key, asset)| match (key, asset) {
        (AssetRef::Texture(texture), Asset::Texture(image)) => Some((texture.to_string(), &image.rgb)),
        _ => None,
    });
    let tables = loaded.assets.iter().filter_map(|(key, asset)| match asset {
        Asset::Photometry(table) => Some((key.path(), table)),
        _ => None,
    });
    let by_path: BTreeMap<_, _> = tables.collect();
    by_path.into_values().for_each(|table| table.hash_content(&mut hasher));
    let maps = loaded.assets.iter().filter_map(|(key, asset)| match asset {
        Asset::Environment(map) => Some((key.path(), map)),
        _ => None,
    });
    let by_path: BTreeMap<_, _> = maps.collect();
    by_path.into_values().for_each(|map| map.hash_content(&mut hasher));
    let by_text: BTreeMap<_, _> = textures.collect();
    by_text.into_iter().for_each(|texture| texture.hash(&mut hasher));
    folder.join(format!("reference-{:016x}.exr", hasher.finish()))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::raytrace::{self, Method};

    #[test]
    fn a_reference_is_reused_for_the_same_studio_only() {
        let folder = tempfile::tempdir().unwrap();
        let mut loaded = io::find_preset("three_point").unwrap().load().unwrap();
        let settings = Settings { width: 6, height: 4, spp: 1, method: Method::Path, ..Settings::default() };
        let files = || std::fs::read_dir(folder.path()).unwrap().count();
        let made = |loaded: &Loaded| {
            let scene = raytrace::prepare(&loaded.scene, &loaded.assets).unwrap();
            load_or_render(folder.path(), loaded, &scene, &settings)
        };
        let first = made(&loaded);
        assert_eq!((made(&loaded), files()), (first.clone(), 1), "taken from the file");
        // The picture in the file is used as it is.
        let dark = Picture::new(6, 4);
        io::export_picture(
            &path(folder.path(), &loaded, &settings),
            &dark,
            &PictureInfo::new(&loaded.scene, "path", 1, 0),
        )
        .unwrap();
        assert_eq!(made(&loaded), dark);
        loaded.scene.lights[0].power.dial_stops -= 1.0;
        assert_ne!(made(&loaded), first);
        assert_eq!(files(), 2);
    }
}

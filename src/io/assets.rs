//! The files that a scene names, and its mannequins, into memory. What can't be loaded is left out with a warning.

use super::error::AssetError;
use super::{importers, mannequins, texture};
use crate::scene::{AssetRef, Assets, Finding, Mannequin, Mesh, Scene, Texture, path_complaint};
use rayon::prelude::*;
use std::path::{Path, PathBuf};
use std::sync::Arc;

/// One thing to load, with the place in the scene that asks for it first.
#[derive(Debug)]
enum Wanted {
    Mesh(String),
    Mannequin(Mannequin),
    Texture(String),
}

#[derive(Debug)]
enum Asset {
    Mesh(String, Arc<Mesh>),
    Mannequin(Mannequin, Arc<Mesh>),
    Texture(String, Arc<Texture>),
}

/// Loads what `scene` needs and `assets` does not have yet, on all cores. Paths are looked up in `folder`, the scene
/// file's own; a scene that was never saved has none. Returns a warning for each thing that is left out.
pub fn load_assets(scene: &Scene, folder: Option<&Path>, assets: &mut Assets) -> Vec<Finding> {
    let results: Vec<Result<Asset, Finding>> = wanted(scene, assets)
        .into_par_iter()
        .map(|(wanted, place)| load(&wanted, folder).map_err(|error| complaint(&wanted, place, &error)))
        .collect();
    let mut warnings = Vec::new();
    for result in results {
        match result {
            Ok(Asset::Mesh(path, mesh)) => drop(assets.meshes.insert(path, mesh)),
            Ok(Asset::Mannequin(mannequin, mesh)) => drop(assets.mannequins.insert(mannequin, mesh)),
            Ok(Asset::Texture(path, texture)) => drop(assets.textures.insert(path, texture)),
            Err(warning) => warnings.push(warning),
        }
    }
    warnings
}

fn complaint(wanted: &Wanted, place: String, error: &AssetError) -> Finding {
    let without = match wanted {
        Wanted::Mesh(_) | Wanted::Mannequin(_) => "the object is left out",
        Wanted::Texture(_) => "the surface is shown without its texture",
    };
    Finding::warning(place, format!("{without}: {error}"))
}

/// Everything that is missing, each once.
fn wanted(scene: &Scene, assets: &Assets) -> Vec<(Wanted, String)> {
    let mut listed = std::collections::HashSet::new();
    let missing = scene.assets().filter(|(_, asset)| !assets.contains(asset) && listed.insert(asset.clone()));
    let wanted = |asset| match asset {
        AssetRef::Mesh(path) => Wanted::Mesh(path.into_owned()),
        AssetRef::Figure(figure) => Wanted::Mannequin(figure),
        AssetRef::Texture(path) => Wanted::Texture(path.into_owned()),
    };
    missing.map(|(field, asset)| (wanted(asset), scene.place_of(field))).collect()
}

fn load(wanted: &Wanted, folder: Option<&Path>) -> Result<Asset, AssetError> {
    Ok(match wanted {
        Wanted::Mesh(path) => {
            let mesh = importers::import_model(&resolve(path, folder)?)?.mesh;
            Asset::Mesh(path.clone(), Arc::new(mesh))
        }
        Wanted::Mannequin(mannequin) => Asset::Mannequin(*mannequin, mannequins::mesh(*mannequin)?),
        Wanted::Texture(path) => Asset::Texture(path.clone(), Arc::new(texture::load(&resolve(path, folder)?)?)),
    })
}

/// The file that a scene's path means. It must lie in the scene's folder, also after links are followed.
fn resolve(path: &str, folder: Option<&Path>) -> Result<PathBuf, AssetError> {
    let bad_path = |reason| AssetError::BadPath { reason, path: path.to_owned() };
    if let Some(reason) = path_complaint(path) {
        return Err(bad_path(reason));
    }
    let folder = folder.ok_or_else(|| AssetError::NoFolder { path: path.to_owned() })?;
    let folder = if folder.as_os_str().is_empty() { Path::new(".") } else { folder };
    let read_error = |source| AssetError::Read { source, path: folder.join(path) };
    let root = folder.canonicalize().map_err(read_error)?;
    let file = root.join(path).canonicalize().map_err(read_error)?;
    if file.starts_with(&root) { Ok(file) } else { Err(bad_path("a link leads out of the scene's folder")) }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn paths_stay_in_the_folder() {
        let folder = tempfile::tempdir().unwrap();
        let inside = folder.path().join("inside");
        std::fs::create_dir(&inside).unwrap();
        std::fs::write(inside.join("a.obj"), "").unwrap();
        std::fs::write(folder.path().join("secret.obj"), "").unwrap();
        assert!(resolve("a.obj", Some(&inside)).is_ok());
        for path in ["../secret.obj", "/etc/passwd", "c:/x", "x\\y", "a/../../secret.obj", ""] {
            assert!(matches!(resolve(path, Some(&inside)), Err(AssetError::BadPath { .. })), "{path}");
        }
        assert!(matches!(resolve("a.obj", None), Err(AssetError::NoFolder { .. })));
        #[cfg(unix)]
        {
            std::os::unix::fs::symlink(folder.path().join("secret.obj"), inside.join("link.obj")).unwrap();
            assert!(matches!(resolve("link.obj", Some(&inside)), Err(AssetError::BadPath { .. })));
        }
    }
}

//! Loads the assets that a scene refers to. One that can't be loaded is left out with a warning.

use super::asset_files::AssetFiles;
use super::environment::{EnvironmentFile, read_environment};
use super::error::AssetError;
use super::importers::EmbeddedImages;
use super::load_progress::LoadProgress;
use super::photometric::{PhotometricFile, read_photometric_file};
use super::texture_memory::TextureMemory;
use super::{figures, importers, tanks, texture};
use crate::figures::builtin_texture;
use crate::scene::{Asset, AssetField, AssetKey, AssetRef, Assets, Finding, Scene, TextureRef};
use rayon::prelude::*;
use std::collections::HashSet;
use std::path::Path;
use std::sync::Arc;

/// Loads the assets that `scene` refers to and `assets` does not hold yet, on all cores. Paths are relative to
/// `folder`, the scene file's own; `None` for a scene without a file. Returns a warning for each asset that is left
/// out.
pub fn load_assets(scene: &Scene, folder: Option<&Path>, assets: &mut Assets) -> Vec<Finding> {
    load_assets_from(scene, AssetFiles::in_folder(folder), &LoadProgress::default(), assets)
}

/// As [`load_assets`], for a scene with imported files that lie elsewhere, and with a progress that is shown. If that is
/// cancelled, what is not loaded yet is left out.
pub fn load_assets_from(
    scene: &Scene,
    files: AssetFiles<'_>,
    progress: &LoadProgress,
    assets: &mut Assets,
) -> Vec<Finding> {
    let missing = missing_assets(scene, assets);
    let memory = TextureMemory::new(assets);
    let images = EmbeddedImages::default();
    let load = |(_, key): &(AssetField, AssetKey)| {
        let progress = progress.part(missing.len());
        progress.reach(0.0)?;
        let loaded = load(key, files, (&memory, &images), &progress)?;
        progress.reach(1.0)?;
        Ok(loaded)
    };
    let loaded: Vec<Result<LoadedAsset, AssetError>> = if memory.may_overflow(&missing, files) {
        // One after the other, so that the same textures are left out each time.
        missing.iter().map(load).collect()
    } else {
        missing.par_iter().map(load).collect()
    };
    let mut warnings = Vec::new();
    for ((field, key), result) in missing.into_iter().zip(loaded) {
        match result {
            Ok(loaded) => {
                assets.insert(key, loaded.asset);
                let place = scene.place_of(field);
                warnings.extend(loaded.warnings.into_iter().map(|message| Finding::warning(place.clone(), message)));
            }
            Err(error) => {
                let message = format!("{}: {error}", consequence(&key));
                warnings.push(Finding::warning(scene.place_of(field), message));
            }
        }
    }
    warnings
}

/// Returns the assets that a scene refers to and `assets` does not hold, each once, with the first field that refers to
/// it.
pub fn missing_assets(scene: &Scene, assets: &Assets) -> Vec<(AssetField, AssetKey)> {
    let mut listed = HashSet::new();
    let missing = scene.assets().filter(|(_, asset)| !assets.contains(asset) && listed.insert(asset.clone()));
    missing.map(|(field, asset)| (field, asset.into_owned())).collect()
}

/// An asset and the warnings of its loader.
struct LoadedAsset {
    asset: Asset,
    warnings: Vec<String>,
}

/// Loads an asset with the loader of its kind.
fn load(
    key: &AssetKey,
    files: AssetFiles<'_>,
    (memory, images): (&TextureMemory, &EmbeddedImages),
    progress: &LoadProgress,
) -> Result<LoadedAsset, AssetError> {
    match key {
        AssetRef::Mesh(path) => {
            let model = importers::import_model_with(&files.find(path)?, progress)?;
            let warnings = model.warnings.into_iter().map(|warning| format!("{path}: {warning}")).collect();
            Ok(LoadedAsset { asset: Asset::Mesh(Arc::new(model.mesh)), warnings })
        }
        AssetRef::Figure(figure) => {
            Ok(LoadedAsset { asset: Asset::Figure(figures::meshes(figure)), warnings: Vec::new() })
        }
        AssetRef::Tank(tank) => {
            let heights = tank.height_picture().map(|path| texture::load(&files.find(path)?)).transpose()?;
            let warning = heights.as_ref().and_then(|heights| heights.warning);
            let warning = warning.zip(tank.height_picture()).map(|(warning, path)| format!("{path}: {warning}"));
            let mesh = tanks::mesh(tank, heights.map(|heights| heights.texture).as_ref());
            Ok(LoadedAsset { asset: Asset::Tank(mesh), warnings: warning.into_iter().collect() })
        }
        AssetRef::Texture(reference) => {
            let (file, decoded) = match &**reference {
                TextureRef::Builtin(texture) => {
                    let asset = Asset::Texture(builtin_texture(*texture));
                    return Ok(LoadedAsset { asset, warnings: Vec::new() });
                }
                TextureRef::File(path) => {
                    let file = files.find(path)?;
                    (file.clone(), texture::load(&file)?)
                }
                TextureRef::Embedded { model, image } => {
                    let file = files.find(model)?;
                    let decoded = texture::decode(&images.image(&file, *image)?, &file)?;
                    (file, decoded)
                }
            };
            let warnings = decoded.warning.map(|warning| format!("{reference}: {warning}"));
            let asset = Asset::Texture(memory.share(decoded.texture, &file)?);
            Ok(LoadedAsset { asset, warnings: warnings.into_iter().collect() })
        }
        AssetRef::Photometry(path) => {
            let PhotometricFile { table, warnings } = read_photometric_file(&files.find(path)?)?;
            let warnings = warnings.into_iter().map(|warning| format!("{path}: {warning}")).collect();
            Ok(LoadedAsset { asset: Asset::Photometry(Arc::new(table)), warnings })
        }
        AssetRef::Environment(path) => {
            let EnvironmentFile { map, warnings } = read_environment(&files.find(path)?)?;
            let warnings = warnings.into_iter().map(|warning| format!("{path}: {warning}")).collect();
            Ok(LoadedAsset { asset: Asset::Environment(Arc::new(map)), warnings })
        }
    }
}

/// Returns the first words of the warning for an asset that could not be loaded.
fn consequence(key: &AssetKey) -> &'static str {
    match key {
        AssetRef::Mesh(_) | AssetRef::Figure(_) | AssetRef::Tank(_) => "the object is left out",
        AssetRef::Texture(_) => "the surface is shown without its texture",
        AssetRef::Environment(_) => "the surround is even",
        AssetRef::Photometry(_) => "the light shines as its emitter does, without its measured distribution",
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scene::{BuiltinTexture, Material, MaterialTextures, Room};

    #[test]
    fn builtin_textures_need_no_folder() {
        for texture in BuiltinTexture::ALL {
            let mut assets = Assets::default();
            let reference = TextureRef::parse(texture.name());
            let warnings = load_assets(&room_with(reference.clone()), None, &mut assets);
            assert!(warnings.is_empty() && assets.texture(&reference).is_some(), "{warnings:?}");
        }
    }

    fn room_with(texture: TextureRef) -> Scene {
        let floor = Material { textures: MaterialTextures::with_base_color(texture), ..Material::default() };
        Scene { room: Some(Room { floor: floor.clone(), walls: floor, ..Room::default() }), ..Scene::default() }
    }

    #[test]
    fn a_missing_file_is_one_warning_that_names_the_first_field() {
        let folder = tempfile::tempdir().unwrap();
        let mut assets = Assets::default();
        let warnings = load_assets(&room_with(TextureRef::file("wood.png")), Some(folder.path()), &mut assets);
        let [warning] = &warnings[..] else { panic!("{warnings:?}") };
        assert_eq!(warning.place, "room.floor.base_color_texture");
        assert!(warning.message.starts_with("the surface is shown without its texture: can't read it"), "{warning}");
        assert_eq!(assets.iter().count(), 0);
    }

    #[test]
    fn a_missing_environment_map_is_a_warning_and_the_surround_is_even() {
        use crate::scene::{Emitter, Light, Output};
        let folder = tempfile::tempdir().unwrap();
        let light = Light::new(Emitter::Surround, Output::Lux(100.0));
        let light = Light { environment_map: Some("sky.hdr".to_owned()), ..light };
        let scene = Scene { lights: vec![light], ..Scene::default() };
        let mut assets = Assets::default();
        let warnings = load_assets(&scene, Some(folder.path()), &mut assets);
        let [warning] = &warnings[..] else { panic!("{warnings:?}") };
        assert_eq!(warning.place, "lights[0] \"Light\" environment_map");
        assert!(warning.message.starts_with("the surround is even: can't read it"), "{warning}");
        assert!(assets.environment(&scene.lights[0]).is_none());
    }

    #[test]
    fn a_photo_that_is_cut_off_and_the_warnings_of_an_importer_are_warnings_of_the_studio() {
        let folder = tempfile::tempdir().unwrap();
        let mut jpeg = Vec::new();
        let pixels =
            image::RgbImage::from_fn(64, 64, |x, y| image::Rgb((x * y + 7 * y).to_le_bytes()[..3].try_into().unwrap()));
        image::codecs::jpeg::JpegEncoder::new(&mut jpeg).encode_image(&pixels).unwrap();
        std::fs::write(folder.path().join("wall.jpg"), &jpeg[..jpeg.len() * 3 / 4]).unwrap();
        std::fs::write(folder.path().join("cup.obj"), "mtllib cup.mtl\nv 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n").unwrap();
        let mut scene = room_with(TextureRef::file("wall.jpg"));
        scene
            .objects
            .push(crate::scene::Object::new("Cup", crate::scene::Shape::MeshFile { path: "cup.obj".to_owned() }));
        let mut assets = Assets::default();
        let warnings: Vec<String> =
            load_assets(&scene, Some(folder.path()), &mut assets).iter().map(ToString::to_string).collect();
        let [wall, cup] = &warnings[..] else { panic!("{warnings:?}") };
        assert!(wall.starts_with("room.floor.base_color_texture: wall.jpg: the file is cut off"), "{wall}");
        assert!(cup.starts_with("objects[0] \"Cup\" shape.path: cup.obj: the materials \"cup.mtl\""), "{cup}");
        assert_eq!(assets.iter().count(), 2, "both are used");
    }

    #[test]
    fn a_texture_from_bytes_inside_a_model_needs_no_file() {
        let embedded = TextureRef::Embedded { model: "chair.glb".to_owned(), image: 2 };
        let scene = room_with(embedded.clone());
        let mut assets = Assets::default();
        assert_eq!(missing_assets(&scene, &assets).len(), 1);
        let mut png = std::io::Cursor::new(Vec::new());
        let pixels = image::RgbImage::from_pixel(3, 2, image::Rgb([9, 8, 7]));
        pixels.write_to(&mut png, image::ImageFormat::Png).unwrap();
        let image = texture::decode(png.get_ref(), Path::new("chair.glb")).unwrap();
        assets.insert_texture(embedded.clone(), Arc::new(image.texture));
        assert!(missing_assets(&scene, &assets).is_empty());
        assert_eq!(load_assets(&scene, None, &mut assets), []);
        assert_eq!(assets.texture(&embedded).unwrap().rgb, [[9, 8, 7]; 6]);
    }

    #[test]
    fn an_embedded_texture_of_a_format_without_images_is_a_warning() {
        let folder = tempfile::tempdir().unwrap();
        std::fs::write(folder.path().join("chair.obj"), "").unwrap();
        let scene = room_with(TextureRef::Embedded { model: "chair.obj".to_owned(), image: 0 });
        let warnings = load_assets(&scene, Some(folder.path()), &mut Assets::default());
        assert!(warnings[0].message.contains("OBJ files hold no images"), "{warnings:?}");
    }
}

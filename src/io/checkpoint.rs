//! Checkpoints of long renders: the film after a pass, from which a later run goes on to the same bits.

use super::atomic;
use super::error::{SaveError, reason};
use crate::raytrace::Film;
use crate::scene::{Asset, Assets, Scene};
use std::fmt;
use std::hash::{DefaultHasher, Hash, Hasher};
use std::io::{self, BufWriter, Write};
use std::path::Path;

/// First bytes of a checkpoint, with the version of the film's fields.
const MAGIC: &[u8; 16] = b"Catchlight film3";
/// Version of the sampling, incremented when the same seed gives other samples.
const SAMPLING_VERSION: u32 = 3;
/// Bytes before the film: magic and render. Bytes after it: the hash of all before.
const HEAD: usize = MAGIC.len() + 8;
const TAIL: usize = 8;

/// The render that a checkpoint or a part belongs to: a hash of the studio, its assets, the settings and the program's
/// version.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct RenderId(u64);

impl RenderId {
    /// Returns the identity of a render. `settings` is any text that differs between different renders of a studio.
    pub fn new(scene: &Scene, assets: &Assets, settings: &str) -> Self {
        let mut hasher = DefaultHasher::new();
        (env!("CARGO_PKG_VERSION"), SAMPLING_VERSION).hash(&mut hasher);
        settings.hash(&mut hasher);
        super::write_scene(&scene.without_variants()).hash(&mut hasher);
        // The scene names figures by their parameters, and files by their paths alone.
        let mut files: Vec<(&str, u64)> =
            assets.iter().filter_map(|(key, asset)| Some((key.path()?, content_hash(asset)))).collect();
        files.sort_unstable();
        files.hash(&mut hasher);
        RenderId(hasher.finish())
    }
}

impl RenderId {
    /// Returns the identity that [`RenderId`] prints as this text.
    pub(super) fn parse(text: &str) -> Option<Self> {
        u64::from_str_radix(text, 16).ok().map(RenderId)
    }
}

impl fmt::Display for RenderId {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{:016x}", self.0)
    }
}

fn content_hash(asset: &Asset) -> u64 {
    let mut hasher = DefaultHasher::new();
    match asset {
        // A tank may be made of a picture
        Asset::Mesh(mesh) | Asset::Tank(mesh) => mesh.hash_content(&mut hasher),
        Asset::Texture(image) => (image.width, image.height, &image.rgb, &image.alpha).hash(&mut hasher),
        Asset::Photometry(table) => table.hash_content(&mut hasher),
        Asset::Environment(map) => map.hash_content(&mut hasher),
        // The scene holds all that it is made of
        Asset::Figure(_) => {}
    }
    hasher.finish()
}

/// Writes a checkpoint. An older one is replaced atomically.
///
/// # Errors
/// If the file can't be written.
pub fn write_checkpoint(path: &Path, render: RenderId, film: &Film) -> Result<(), SaveError> {
    atomic::write_with(path, |file| {
        let mut out = HashingWriter { out: BufWriter::new(file), hasher: DefaultHasher::new() };
        out.write_all(MAGIC)?;
        out.write_all(&render.0.to_le_bytes())?;
        film.store(&mut out)?;
        let hash = out.hasher.finish();
        out.out.write_all(&hash.to_le_bytes())?;
        out.out.flush()
    })
}

/// Reads a checkpoint of a render: the bytes of its film. None if there is no such file.
///
/// # Errors
/// If the file can't be read, is damaged, or belongs to another render.
pub fn read_checkpoint(path: &Path, render: RenderId) -> Result<Option<Vec<u8>>, String> {
    let mut bytes = match std::fs::read(path) {
        Ok(bytes) => bytes,
        Err(error) if error.kind() == io::ErrorKind::NotFound => return Ok(None),
        Err(error) => return Err(reason(&error)),
    };
    let whole = bytes.len().checked_sub(TAIL).filter(|whole| *whole >= HEAD && bytes.starts_with(MAGIC));
    let whole = whole.ok_or("it is no checkpoint")?;
    let mut hasher = DefaultHasher::new();
    hasher.write(&bytes[..whole]);
    if hasher.finish().to_le_bytes() != bytes[whole..] {
        return Err("it is damaged".to_owned());
    }
    if bytes[MAGIC.len()..HEAD] != render.0.to_le_bytes() {
        return Err("it is of another studio, of other settings or of another version".to_owned());
    }
    bytes.truncate(whole);
    bytes.drain(..HEAD);
    Ok(Some(bytes))
}

/// Hashes what it writes.
struct HashingWriter<W> {
    out: W,
    hasher: DefaultHasher,
}

impl<W: Write> Write for HashingWriter<W> {
    fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
        let written = self.out.write(bytes)?;
        self.hasher.write(&bytes[..written]);
        Ok(written)
    }

    fn flush(&mut self) -> io::Result<()> {
        self.out.flush()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::io::presets;
    use crate::raytrace::{RenderControl, Settings, empty_film, prepare, render, resume};
    use crate::scene::{Texture, TextureRef};
    use std::ops::ControlFlow;
    use std::sync::Arc;

    #[test]
    fn a_render_from_any_checkpoint_ends_in_the_same_bits_as_one_run() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("x.exr.checkpoint");
        // Photons, and tiles that stop at their noise.
        let still_life =
            presets().iter().find(|p| p.file_name.starts_with("product_still_life")).unwrap().load().unwrap();
        let prepared = prepare(&still_life.scene, &still_life.assets).unwrap();
        let mut settings = Settings { width: 72, height: 40, spp: 8, aovs: true, ..Settings::default() };
        let pilot = render(&prepared, &settings, &RenderControl::new(), &mut |_| ControlFlow::Continue(()));
        (settings.spp, settings.noise_stops) = (30, Some(pilot.noise_stops()));
        let id = RenderId::new(&still_life.scene, &still_life.assets, "30 spp");
        let mut after_passes = Vec::new();
        let whole = render(&prepared, &settings, &RenderControl::new(), &mut |film| {
            after_passes.push(film.clone());
            ControlFlow::Continue(())
        });
        assert!(whole.mean_spp() > f64::from(whole.spp()), "some tiles have stopped early");
        for film in &after_passes {
            write_checkpoint(&path, id, film).unwrap();
            let bytes = read_checkpoint(&path, id).unwrap().unwrap();
            let film = empty_film(&prepared, &settings).with_stored(&mut &bytes[..]).unwrap();
            let resumed = resume(&prepared, &settings, film, &RenderControl::new(), &mut |_| ControlFlow::Continue(()));
            assert_eq!(resumed.develop_layers(&still_life.scene), whole.develop_layers(&still_life.scene));
            assert_eq!(resumed.aovs(), whole.aovs());
            assert_eq!((resumed.mean_spp(), resumed.tile_noise_stops()), (whole.mean_spp(), whole.tile_noise_stops()));
        }
    }

    #[test]
    fn a_checkpoint_of_another_render_or_a_damaged_one_is_refused() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("x.exr.checkpoint");
        let loaded = presets()[0].load().unwrap();
        let prepared = prepare(&loaded.scene, &loaded.assets).unwrap();
        let settings = Settings { width: 40, height: 8, ..Settings::default() };
        let id = |scene: &Scene, settings: &str| RenderId::new(scene, &loaded.assets, settings);
        let render = id(&loaded.scene, "a");
        assert_eq!(read_checkpoint(&path, render), Ok(None));
        write_checkpoint(&path, render, &empty_film(&prepared, &settings)).unwrap();
        let bytes = read_checkpoint(&path, render).unwrap().unwrap();
        let narrower = Settings { width: 39, ..settings.clone() };
        assert!(empty_film(&prepared, &narrower).with_stored(&mut &bytes[..]).is_err());
        let mut brighter = loaded.scene.clone();
        brighter.lights[0].position.x += 0.1;
        let with_mask = |alpha: Vec<u8>| {
            let mut assets = loaded.assets.clone();
            let image = Texture { alpha, ..Texture::opaque(2, 1, vec![[90; 3]; 2]) };
            assets.insert_texture(TextureRef::file("leaf.png"), Arc::new(image));
            RenderId::new(&loaded.scene, &assets, "a")
        };
        assert_ne!(with_mask(vec![255, 0]), with_mask(vec![0, 255]), "another cut-out mask of the same colours");
        for other in [id(&loaded.scene, "b"), id(&brighter, "a")] {
            assert!(read_checkpoint(&path, other).unwrap_err().contains("of another studio"));
        }
        let mut file = std::fs::read(&path).unwrap();
        file[HEAD + 9] ^= 1;
        std::fs::write(&path, &file).unwrap();
        assert_eq!(read_checkpoint(&path, render), Err("it is damaged".to_owned()));
        std::fs::write(&path, &file[..HEAD + 3]).unwrap();
        assert_eq!(read_checkpoint(&path, render), Err("it is no checkpoint".to_owned()));
    }
}

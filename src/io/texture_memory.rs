//! The textures of a studio in memory: equal ones are shared, and their sum is bounded.

use super::asset_files::AssetFiles;
use super::error::AssetError;
use super::texture;
use crate::scene::{Asset, AssetField, AssetKey, AssetRef, Assets, Texture, TextureRef};
use std::path::Path;
use std::sync::{Arc, Mutex, PoisonError};

/// Most memory of all textures of a studio, bytes: five of the largest.
const LIMIT_BYTES: u64 = 4 << 30;

/// The textures that are in memory.
#[derive(Debug)]
pub(super) struct TextureMemory {
    textures: Mutex<Vec<Arc<Texture>>>,
    limit_bytes: u64,
}

impl TextureMemory {
    /// Returns the memory with the loaded textures.
    pub fn new(assets: &Assets) -> Self {
        let texture = |asset: &Asset| match asset {
            Asset::Texture(texture) => Some(texture.clone()),
            Asset::Mesh(_) | Asset::Figure(_) | Asset::Photometry(_) | Asset::Tank(_) | Asset::Environment(_) => None,
        };
        let mut textures: Vec<Arc<Texture>> = Vec::new();
        for texture in assets.iter().filter_map(|(_, asset)| texture(asset)) {
            if !textures.iter().any(|held| Arc::ptr_eq(held, &texture)) {
                textures.push(texture);
            }
        }
        TextureMemory { textures: Mutex::new(textures), limit_bytes: LIMIT_BYTES }
    }

    /// Returns true if the textures of `missing` may exceed the limit, as far as their files' headers tell.
    pub fn may_overflow(&self, missing: &[(AssetField, AssetKey)], files: AssetFiles<'_>) -> bool {
        let size = |key: &AssetKey| match key {
            AssetRef::Texture(reference) => match &**reference {
                TextureRef::File(path) => {
                    let (width, height) = texture::size(&files.find(path).ok()?)?;
                    Some(bytes(width, height))
                }
                TextureRef::Embedded { .. } | TextureRef::Builtin(_) => None,
            },
            _ => None,
        };
        let held: u64 = self.lock().iter().map(|texture| bytes(texture.width, texture.height)).sum();
        let sizes = missing.iter().filter_map(|(_, key)| size(key));
        sizes.fold(held, u64::saturating_add) > self.limit_bytes
    }

    /// Returns the texture that is held already and has the same pixels, or takes this one. `path` is its file, for
    /// errors.
    ///
    /// # Errors
    /// If all textures together exceed the limit.
    pub fn share(&self, texture: Texture, path: &Path) -> Result<Arc<Texture>, AssetError> {
        let mut textures = self.lock();
        if let Some(equal) = textures.iter().find(|held| ***held == texture) {
            return Ok(equal.clone());
        }
        let held: u64 = textures.iter().map(|texture| bytes(texture.width, texture.height)).sum();
        let amount = held + bytes(texture.width, texture.height);
        if amount > self.limit_bytes {
            let (what, path) = ("the memory of all the studio's textures, bytes,", path.to_owned());
            return Err(AssetError::TooLarge { what, amount, limit: self.limit_bytes, path });
        }
        let texture = Arc::new(texture);
        textures.push(texture.clone());
        Ok(texture)
    }

    /// Locks the list, which a panic leaves valid.
    fn lock(&self) -> std::sync::MutexGuard<'_, Vec<Arc<Texture>>> {
        self.textures.lock().unwrap_or_else(PoisonError::into_inner)
    }
}

/// Returns the memory of a texture of a width and height.
fn bytes(width: u32, height: u32) -> u64 {
    (u64::from(width) * u64::from(height)).saturating_mul(3)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn texture(width: u32, red: u8) -> Texture {
        Texture::opaque(width, 10, vec![[red, 0, 0]; width as usize * 10])
    }

    #[test]
    fn textures_with_the_same_pixels_are_one_and_all_of_them_have_a_limit() {
        let mut assets = Assets::default();
        let loaded = Arc::new(texture(20, 1));
        for name in ["wood.png", "copy of wood.png"] {
            assets.insert_texture(TextureRef::file(name), loaded.clone());
        }
        let memory = TextureMemory { limit_bytes: 3 * 10 * 50, ..TextureMemory::new(&assets) };
        let share = |width, red| memory.share(texture(width, red), Path::new("floor.png"));
        assert!(Arc::ptr_eq(&share(20, 1).unwrap(), &loaded), "it is in memory already");
        let other = share(20, 2).unwrap();
        assert!(!Arc::ptr_eq(&other, &loaded));
        assert!((0..8).all(|_| Arc::ptr_eq(&share(20, 2).unwrap(), &other)), "eight copies take the memory of one");
        // 20 + 20 columns are held: eleven more are too many, ten are not.
        let error = share(11, 3).unwrap_err().to_string();
        assert_eq!(
            error,
            "the memory of all the studio's textures, bytes, is too large: 1530, at most 1500: floor.png"
        );
        share(10, 3).unwrap();
        assert!(share(1, 4).is_err());
        assert!(share(20, 2).is_ok(), "what is held needs no more");
    }
}

//! Materials from the MTL files of an OBJ model.

use crate::io::error::cut;
use crate::io::read::read_limited;
use crate::scene::{Material, MaterialTextures, TextureRef, path_complaint};
use std::collections::{HashMap, HashSet};
use std::path::{Path, PathBuf};

/// Largest MTL file, bytes.
const FILE_LIMIT_BYTES: u64 = 16_000_000;

/// The materials that a model refers to, from the MTL files in its folder.
#[derive(Debug, Default)]
pub(super) struct MaterialLibrary {
    /// Folder of the model; `None` for models without MTL files.
    folder: Option<PathBuf>,
    loaded: HashSet<String>,
    materials: Vec<tobj::Material>,
    by_name: HashMap<String, usize>,
    warnings: Vec<String>,
}

impl MaterialLibrary {
    /// Returns an empty library for a model's folder.
    pub fn beside(model: &Path) -> Self {
        MaterialLibrary {
            folder: Some(model.parent().unwrap_or(Path::new("")).to_owned()),
            ..MaterialLibrary::default()
        }
    }

    /// Returns a sentence for each file that could not be read.
    pub fn into_warnings(self) -> Vec<String> {
        self.warnings
    }

    /// Returns the index of the material with this name, the last one loaded.
    pub fn find(&self, name: &str) -> Option<usize> {
        self.by_name.get(name).copied()
    }

    /// Returns a material by its index.
    pub fn get(&self, index: Option<usize>) -> Option<&tobj::Material> {
        self.materials.get(index?)
    }

    /// Adds the materials of an MTL file, once. A file that can't be read is a warning.
    pub fn load(&mut self, name: &str) {
        let Some(folder) = self.folder.as_ref().filter(|_| !self.loaded.contains(name)) else { return };
        let parse = |text: String| tobj::load_mtl_buf(&mut text.as_bytes()).map_err(|error| error.to_string());
        match read(folder, name).and_then(parse) {
            Ok((materials, by_name)) => {
                let before = self.materials.len();
                self.materials.extend(materials);
                self.by_name.extend(by_name.into_iter().map(|(name, index)| (name, before + index)));
            }
            Err(reason) => self.warnings.push(cut(format!("the materials {name:?} are left out: {reason}"))),
        }
        self.loaded.insert(name.to_owned());
    }
}

fn read(folder: &Path, name: &str) -> Result<String, String> {
    if let Some(reason) = path_complaint(name) {
        return Err(reason.to_owned());
    }
    let bytes = read_limited(&folder.join(name), FILE_LIMIT_BYTES).map_err(|error| error.to_string())?;
    Ok(usable_lines(&String::from_utf8_lossy(&bytes)))
}

/// Drops the lines that make `tobj` fail: it reads three numbers for every colour without a check.
fn usable_lines(text: &str) -> String {
    let is_usable = |line: &&str| {
        let mut words = line.split_whitespace();
        !matches!(words.next(), Some("Ka" | "Kd" | "Ks" | "Ke"))
            || words.take(3).filter(|w| w.parse::<f32>().is_ok()).count() == 3
    };
    text.lines().filter(is_usable).fold(String::with_capacity(text.len()), |all, line| all + line + "\n")
}

/// Converts an MTL material: base colour and texture from the diffuse ones, roughness from the Phong exponent,
/// transmission from the dissolve.
pub(super) fn convert(mtl: &tobj::Material) -> Material {
    let plain = Material::default();
    // A reflectance of 1 would absorb nothing.
    let color = mtl.diffuse.map_or(plain.base_color, |kd| kd.map(|c| if c > 0.0 { c.min(0.95) } else { 0.0 }));
    let number = |value: Option<f32>| value.filter(|v| v.is_finite());
    Material {
        base_color: color,
        textures: MaterialTextures {
            base_color: mtl.diffuse_texture.as_deref().and_then(texture_path),
            ..MaterialTextures::default()
        },
        // alpha^2 = 2 / (Ns + 2) (Walter et al. 2007, section 5.2), and alpha is the square of the roughness.
        roughness: number(mtl.shininess).map_or(plain.roughness, |ns| (2.0 / (ns.max(0.0) + 2.0)).powf(0.25)),
        ior: number(mtl.optical_density).filter(|n| *n > 1.0).map_or(plain.ior, |n| n.min(4.0)),
        transmission: number(mtl.dissolve).map_or(0.0, |d| 1.0 - d.clamp(0.0, 1.0)),
        ..plain
    }
}

/// Parses the path of `map_Kd`, which may follow options such as `-s 1 1 1`. `None` if it leads out of the folder.
fn texture_path(value: &str) -> Option<TextureRef> {
    let value = value.trim();
    let path = if value.starts_with('-') { value.split_whitespace().next_back()? } else { value };
    let path = path.replace('\\', "/");
    path_complaint(&path).is_none().then_some(TextureRef::File(path))
}

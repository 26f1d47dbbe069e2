//! Surfaces from the MTL file of an OBJ model.

use crate::io::read::read_limited;
use crate::scene::{Material, MaterialTextures, TextureRef, path_complaint};
use std::collections::{HashMap, HashSet};
use std::path::{Path, PathBuf};

/// Largest MTL file, bytes.
const FILE_LIMIT_BYTES: u64 = 16_000_000;

/// The materials that a model names, from the libraries in its folder.
#[derive(Debug, Default)]
pub(super) struct Library {
    /// None where there are no libraries at all.
    folder: Option<PathBuf>,
    loaded: HashSet<String>,
    materials: Vec<tobj::Material>,
    by_name: HashMap<String, usize>,
    warnings: Vec<String>,
}

impl Library {
    pub fn beside(model: &Path) -> Self {
        Library { folder: Some(model.parent().unwrap_or(Path::new("")).to_owned()), ..Library::default() }
    }

    pub fn into_warnings(self) -> Vec<String> {
        self.warnings
    }

    /// Number of the material that now has this name.
    pub fn find(&self, name: &str) -> Option<usize> {
        self.by_name.get(name).copied()
    }

    /// A material that was found.
    pub fn get(&self, number: Option<usize>) -> Option<&tobj::Material> {
        self.materials.get(number?)
    }

    /// Adds the materials of a file; none, and a warning, where it can't be read.
    pub fn load(&mut self, name: &str) {
        let Some(folder) = self.folder.as_ref().filter(|_| !self.loaded.contains(name)) else { return };
        let parse = |text: String| tobj::load_mtl_buf(&mut text.as_bytes()).map_err(|error| error.to_string());
        match read(folder, name).and_then(parse) {
            Ok((materials, by_name)) => {
                let before = self.materials.len();
                self.materials.extend(materials);
                self.by_name.extend(by_name.into_iter().map(|(name, number)| (name, before + number)));
            }
            Err(reason) => self.warnings.push(format!("the materials {name:?} are left out: {reason}")),
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

/// The lines that the parser can take: it expects three numbers for every colour without looking.
fn usable_lines(text: &str) -> String {
    let is_usable = |line: &&str| {
        let mut words = line.split_whitespace();
        !matches!(words.next(), Some("Ka" | "Kd" | "Ks" | "Ke"))
            || words.take(3).filter(|w| w.parse::<f32>().is_ok()).count() == 3
    };
    text.lines().filter(is_usable).fold(String::with_capacity(text.len()), |all, line| all + line + "\n")
}

/// Our surface for one of MTL's: diffuse colour and texture, gloss from the Phong exponent, glass from the dissolve.
pub(super) fn surface(mtl: &tobj::Material) -> Material {
    let plain = Material::default();
    // A white of 1 would give back all light.
    let color = mtl.diffuse.map_or(plain.base_color, |kd| kd.map(|c| if c > 0.0 { c.min(0.95) } else { 0.0 }));
    let number = |value: Option<f32>| value.filter(|v| v.is_finite());
    Material {
        base_color: color,
        textures: MaterialTextures { base_color: mtl.diffuse_texture.as_deref().and_then(texture_path) },
        // alpha^2 = 2 / (Ns + 2) (Walter et al. 2007), and alpha is the square of our roughness.
        roughness: number(mtl.shininess).map_or(plain.roughness, |ns| (2.0 / (ns.max(0.0) + 2.0)).powf(0.25)),
        ior: number(mtl.optical_density).filter(|n| *n > 1.0).map_or(plain.ior, |n| n.min(4.0)),
        transmission: number(mtl.dissolve).map_or(0.0, |d| 1.0 - d.clamp(0.0, 1.0)),
        ..plain
    }
}

/// The path of `map_Kd`, which may follow options such as `-s 1 1 1`; none where it would lead out of the folder.
fn texture_path(value: &str) -> Option<TextureRef> {
    let value = value.trim();
    let path = if value.starts_with('-') { value.split_whitespace().next_back()? } else { value };
    let path = path.replace('\\', "/");
    path_complaint(&path).is_none().then_some(TextureRef::File(path))
}

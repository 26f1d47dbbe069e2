//! Surfaces from the MTL file of an OBJ model.

use super::read_limited;
use crate::scene::{Material, path_complaint};
use std::cell::RefCell;
use std::path::{Path, PathBuf};

/// Largest MTL file, bytes.
const FILE_LIMIT_BYTES: u64 = 16_000_000;

/// Loads the material libraries that a model names. They lie in its folder.
pub(super) struct Library {
    folder: PathBuf,
    warnings: RefCell<Vec<String>>,
}

impl Library {
    pub fn beside(model: &Path) -> Self {
        Library { folder: model.parent().unwrap_or(Path::new("")).to_owned(), warnings: RefCell::default() }
    }

    pub fn into_warnings(self) -> Vec<String> {
        self.warnings.into_inner()
    }

    /// The materials of a library; none, and a warning, where it can't be read.
    pub fn load(&self, name: &Path) -> tobj::MTLLoadResult {
        let text = self.read(&name.to_string_lossy());
        let parse = |text: String| tobj::load_mtl_buf(&mut text.as_bytes()).map_err(|error| error.to_string());
        text.and_then(parse).or_else(|reason| {
            self.warnings.borrow_mut().push(format!("the materials {name:?} are left out: {reason}"));
            Ok(Default::default())
        })
    }

    fn read(&self, name: &str) -> Result<String, String> {
        if let Some(reason) = path_complaint(name) {
            return Err(reason.to_owned());
        }
        let bytes = read_limited(&self.folder.join(name), FILE_LIMIT_BYTES).map_err(|error| error.to_string())?;
        Ok(usable_lines(&String::from_utf8_lossy(&bytes)))
    }
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
        base_color_texture: mtl.diffuse_texture.as_deref().and_then(texture_path),
        // alpha^2 = 2 / (Ns + 2) (Walter et al. 2007), and alpha is the square of our roughness.
        roughness: number(mtl.shininess).map_or(plain.roughness, |ns| (2.0 / (ns.max(0.0) + 2.0)).powf(0.25)),
        ior: number(mtl.optical_density).filter(|n| *n > 1.0).map_or(plain.ior, |n| n.min(4.0)),
        transmission: number(mtl.dissolve).map_or(0.0, |d| 1.0 - d.clamp(0.0, 1.0)),
        ..plain
    }
}

/// The path of `map_Kd`, which may follow options such as `-s 1 1 1`; none where it would lead out of the folder.
fn texture_path(value: &str) -> Option<String> {
    let value = value.trim();
    let path = if value.starts_with('-') { value.split_whitespace().next_back()? } else { value };
    let path = path.replace('\\', "/");
    path_complaint(&path).is_none().then_some(path)
}

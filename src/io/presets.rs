//! The studio presets, embedded in the program.

use super::error::LoadError;
use super::scene_file::{self, Loaded};
use std::sync::LazyLock;

/// A studio preset.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Preset {
    /// Name of its file in `studio_presets`.
    pub file_name: &'static str,
    /// Title, as in the file.
    pub name: String,
    /// Purpose of the set-up in one line, as in the file.
    pub description: String,
    /// Content of the file.
    pub text: &'static str,
}

impl Preset {
    /// Loads the studio with its assets.
    ///
    /// # Errors
    /// As [`parse_scene`](super::parse_scene). A test loads every preset.
    pub fn load(&self) -> Result<Loaded, LoadError> {
        let (scene, warnings) = scene_file::parse_scene(self.text)?;
        Ok(scene_file::complete(scene, warnings, None))
    }
}

macro_rules! embedded {
    ($($file:literal),+ $(,)?) => {
        &[$(($file, include_str!(concat!("../../studio_presets/", $file)))),+]
    };
}

/// File names and contents, in menu order: portraits from the plain to the special, then groups, then products.
const FILES: &[(&str, &str)] = embedded![
    "three_point.ron",
    "rembrandt.ron",
    "butterfly.ron",
    "loop.ron",
    "split.ron",
    "clamshell.ron",
    "rim_low_key.ron",
    "high_key.ron",
    "gel_portrait.ron",
    "window_light.ron",
    "group.ron",
    "interview.ron",
    "product_still_life.ron",
];

/// Returns all presets, in menu order.
pub fn presets() -> &'static [Preset] {
    static PRESETS: LazyLock<Vec<Preset>> =
        LazyLock::new(|| FILES.iter().map(|&(file, text)| preset(file, text)).collect());
    &PRESETS
}

/// Returns the preset with this file name, with or without its extension, or with this title, in any case of letters.
pub fn find_preset(name: &str) -> Option<&'static Preset> {
    let wanted = name.trim().to_lowercase();
    let stem = wanted.strip_suffix(".ron").unwrap_or(&wanted);
    presets().iter().find(|p| p.file_name.trim_end_matches(".ron") == stem || p.name.to_lowercase() == wanted)
}

fn preset(file_name: &'static str, text: &'static str) -> Preset {
    let (name, description) = scene_file::parse_scene(text)
        .map_or_else(|error| (file_name.to_owned(), error.to_string()), |(scene, _)| (scene.name, scene.description));
    Preset { file_name, name, description, text }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn presets_are_found_by_file_and_by_title() {
        for preset in presets() {
            for name in [preset.file_name, &preset.file_name[..preset.file_name.len() - 4], &preset.name.to_uppercase()]
            {
                assert_eq!(find_preset(name), Some(preset));
            }
        }
        assert_eq!(find_preset("none"), None);
    }
}

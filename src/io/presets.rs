//! The studio presets, embedded in the program.

use super::error::LoadError;
use super::load_progress::LoadProgress;
use super::scene_file::{self, Loaded};
use super::texture;
use crate::scene::{Scene, Texture};
use std::path::Path;
use std::sync::LazyLock;

/// A studio preset.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Preset {
    /// Name of its file in `studio_presets`.
    pub file_name: &'static str,
    /// What it is for.
    pub group: PresetGroup,
    /// Title, as in the file.
    pub name: String,
    /// Purpose of the set-up in one line, as in the file.
    pub description: String,
    /// Content of the file.
    pub text: &'static str,
    /// What its camera sees, rendered: the content of a JPEG file.
    jpeg: &'static [u8],
}

impl Preset {
    /// Returns the studio without loading its assets: no figure is built, no water is run.
    ///
    /// # Errors
    /// As [`parse_scene`](super::parse_scene).
    pub fn scene(&self) -> Result<Scene, LoadError> {
        scene_file::parse_scene(self.text).map(|(scene, _)| scene)
    }

    /// Loads the studio with its assets.
    ///
    /// # Errors
    /// As [`parse_scene`](super::parse_scene). A test loads every preset.
    pub fn load(&self) -> Result<Loaded, LoadError> {
        let (scene, warnings) = scene_file::parse_scene(self.text)?;
        Ok(scene_file::complete(scene, warnings, None, &LoadProgress::default()))
    }

    /// Returns what its camera sees, rendered, with a longer side of 224 pixels; none if the program is damaged.
    /// `studio_presets/pictures/make.sh` makes it.
    pub fn picture(&self) -> Option<Texture> {
        texture::decode(self.jpeg, Path::new(self.file_name)).ok().map(|decoded| decoded.texture)
    }
}

/// What a preset is for.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum PresetGroup {
    /// One person, by flash.
    Portrait,
    /// Several people.
    Groups,
    /// Things.
    Product,
    /// Light that shines all the time, for film and video and from windows.
    Continuous,
}

impl PresetGroup {
    /// All groups, in menu order.
    pub const ALL: [PresetGroup; 4] =
        [PresetGroup::Portrait, PresetGroup::Groups, PresetGroup::Product, PresetGroup::Continuous];

    /// Returns the heading.
    pub fn label(self) -> &'static str {
        match self {
            PresetGroup::Portrait => "Portrait",
            PresetGroup::Groups => "Groups",
            PresetGroup::Product => "Product",
            PresetGroup::Continuous => "Continuous light",
        }
    }
}

macro_rules! embedded {
    ($($group:ident $stem:literal),+ $(,)?) => {
        &[$(Embedded {
            group: PresetGroup::$group,
            file_name: concat!($stem, ".ron"),
            text: include_str!(concat!("../../studio_presets/", $stem, ".ron")),
            jpeg: include_bytes!(concat!("../../studio_presets/pictures/", $stem, ".jpg")),
        }),+]
    };
}

/// The files of a preset.
struct Embedded {
    group: PresetGroup,
    file_name: &'static str,
    text: &'static str,
    jpeg: &'static [u8],
}

/// The files of all presets: portraits from the plain to the special, then groups, then products.
const FILES: &[Embedded] = embedded![
    Portrait "three_point",
    Portrait "rembrandt",
    Portrait "butterfly",
    Portrait "loop",
    Portrait "split",
    Portrait "clamshell",
    Portrait "rim_low_key",
    Portrait "high_key",
    Portrait "gel_portrait",
    Continuous "window_light",
    Groups "group",
    Continuous "interview",
    Product "product_still_life",
    Product "tank_landscape",
    Product "bottle_splash",
    Product "pouring_drink",
];

/// Returns all presets, in menu order.
pub fn presets() -> &'static [Preset] {
    static PRESETS: LazyLock<Vec<Preset>> = LazyLock::new(|| FILES.iter().map(preset).collect());
    &PRESETS
}

/// Returns the preset with this file name, with or without its extension, or with this title, in any case of letters.
pub fn find_preset(name: &str) -> Option<&'static Preset> {
    let wanted = name.trim().to_lowercase();
    let stem = wanted.strip_suffix(".ron").unwrap_or(&wanted);
    presets().iter().find(|p| p.file_name.trim_end_matches(".ron") == stem || p.name.to_lowercase() == wanted)
}

fn preset(embedded: &Embedded) -> Preset {
    let Embedded { group, file_name, text, jpeg } = *embedded;
    let (name, description) = scene_file::parse_scene(text)
        .map_or_else(|error| (file_name.to_owned(), error.to_string()), |(scene, _)| (scene.name, scene.description));
    Preset { file_name, group, name, description, text, jpeg }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn portraits_have_a_flash_and_studios_of_continuous_light_have_none() {
        for preset in presets() {
            let scene = preset.scene().unwrap();
            let flashes = scene.lights.iter().any(|light| light.power.output.is_flash());
            match preset.group {
                PresetGroup::Portrait | PresetGroup::Groups => assert!(flashes, "{}", preset.name),
                PresetGroup::Continuous => assert!(!flashes, "{}", preset.name),
                // A splash needs a flash, a still life does not
                PresetGroup::Product => {}
            }
        }
    }

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

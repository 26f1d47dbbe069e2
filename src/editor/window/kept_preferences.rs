//! The preferences, stored in the user's settings folder as JSON.

use crate::editor::commands::preferences::{METER_CONSTANTS, Preferences, SCALES};
use crate::sheet::Units;
use eframe::egui::ThemePreference;
use serde_json::{Map, Value, json};
use std::path::PathBuf;

const FILE_NAME: &str = "preferences.json";

/// The preferences with their file. Without a folder they are kept in memory only.
#[derive(Clone, Debug, Default)]
pub struct KeptPreferences {
    folder: Option<PathBuf>,
    preferences: Preferences,
}

impl KeptPreferences {
    /// Reads the preferences from a settings folder. What is missing or broken there is as it is by default.
    pub fn load(folder: Option<PathBuf>) -> Self {
        let text = folder.as_ref().and_then(|folder| std::fs::read_to_string(folder.join(FILE_NAME)).ok());
        let fields: Map<String, Value> = text.and_then(|text| serde_json::from_str(&text).ok()).unwrap_or_default();
        KeptPreferences { folder, preferences: from_json(&fields) }
    }

    /// Returns the preferences.
    pub fn get(&self) -> &Preferences {
        &self.preferences
    }

    /// Returns true without a file, and writes one. Without a folder, no start is the first.
    pub fn is_first_start(&self) -> bool {
        let file = self.folder.as_ref().map(|folder| folder.join(FILE_NAME));
        let is_first = file.is_some_and(|file| !file.exists());
        if is_first {
            self.write();
        }
        is_first
    }

    /// Changes the preferences and writes the file.
    pub fn set(&mut self, preferences: Preferences) {
        if preferences == self.preferences {
            return;
        }
        self.preferences = preferences;
        self.write();
    }

    fn write(&self) {
        let Some(folder) = &self.folder else { return };
        let text = format!("{:#}\n", to_json(&self.preferences));
        let written = std::fs::create_dir_all(folder).and_then(|()| std::fs::write(folder.join(FILE_NAME), text));
        if let Err(error) = written {
            // They hold in this window.
            log::warn!("the preferences could not be written: {error}");
        }
    }
}

const THEMES: [(ThemePreference, &str); 3] =
    [(ThemePreference::Dark, "dark"), (ThemePreference::Light, "light"), (ThemePreference::System, "system")];
const UNITS: [(Units, &str); 2] = [(Units::Metres, "metres"), (Units::Feet, "feet")];

fn to_json(preferences: &Preferences) -> Value {
    let Preferences { scale, theme, units, meter_constant } = *preferences;
    json!({
        "scale": rounded(scale),
        "theme": word(&THEMES, theme),
        "units": word(&UNITS, units),
        "meter_constant": rounded(meter_constant),
    })
}

/// Returns the number with the digits that a person would write, as f64 prints them.
fn rounded(number: f32) -> f64 {
    (f64::from(number) * 1e3).round() / 1e3
}

fn word<T: PartialEq>(words: &[(T, &'static str)], value: T) -> Option<&'static str> {
    words.iter().find(|(each, _)| *each == value).map(|(_, word)| *word)
}

fn from_json(fields: &Map<String, Value>) -> Preferences {
    let default = Preferences::default();
    let number = |name: &str, (low, high): (f32, f32), default: f32| {
        let found = fields.get(name).and_then(Value::as_f64).map(|number| number as f32);
        found.filter(|number| (low..=high).contains(number)).unwrap_or(default)
    };
    Preferences {
        scale: number("scale", SCALES, default.scale),
        theme: named(fields, "theme", &THEMES).unwrap_or(default.theme),
        units: named(fields, "units", &UNITS).unwrap_or(default.units),
        meter_constant: number("meter_constant", METER_CONSTANTS, default.meter_constant),
    }
}

fn named<T: Copy>(fields: &Map<String, Value>, name: &str, words: &[(T, &str)]) -> Option<T> {
    let found = fields.get(name)?.as_str()?;
    words.iter().find(|(_, word)| *word == found).map(|(value, _)| *value)
}

#[cfg(test)]
mod tests {
    use super::*;

    const CHANGED: Preferences =
        Preferences { scale: 1.25, theme: ThemePreference::Light, units: Units::Feet, meter_constant: 330.0 };

    #[test]
    fn preferences_survive_a_restart() {
        let folder = tempfile::tempdir().unwrap();
        let inside = folder.path().join("new");
        KeptPreferences::load(Some(inside.clone())).set(CHANGED);
        assert_eq!(*KeptPreferences::load(Some(inside)).get(), CHANGED);
    }

    #[test]
    fn what_is_broken_in_the_file_is_as_by_default_and_the_rest_is_kept() {
        let folder = tempfile::tempdir().unwrap();
        let read = |text: &str| {
            std::fs::write(folder.path().join(FILE_NAME), text).unwrap();
            *KeptPreferences::load(Some(folder.path().to_owned())).get()
        };
        for broken in ["", "{", "[1]", "null", r#"{"scale": 1e9, "theme": 3, "units": "ells", "meter_constant": "C"}"#]
        {
            assert_eq!(read(broken), Preferences::default(), "{broken}");
        }
        let older = read(r#"{"units": "feet", "of a later version": {"a": []}}"#);
        assert_eq!(older, Preferences { units: Units::Feet, ..Preferences::default() });
    }
}

//! Lists of gear: the bundled one, and the user's file.

use super::error::{SaveError, reason};
use super::parse_errors::explain;
use super::{atomic, layout, locate, ron_v1};
use crate::gear::{GearList, MOST_OWNED, ModifierModel};
use crate::scene::{Emitter, Light, Modifier, NamedModifier, Output, Scene, Severity, validate};
use std::io::Read;
use std::path::{Path, PathBuf};
use std::sync::LazyLock;

/// Largest file, bytes.
const LIMIT_BYTES: u64 = 1_000_000;
/// Most entries of a kind.
const MOST_ENTRIES: usize = 1000;
/// Longest text of an entry, characters.
const MOST_CHARACTERS: usize = 400;

/// The reason why a list of gear could not be read.
#[derive(Debug, thiserror::Error)]
pub enum GearError {
    /// The file could not be read.
    #[error("can't read the list of gear: {}: {}", reason(error), path.display())]
    Read {
        /// The reason.
        error: std::io::Error,
        /// The file.
        path: PathBuf,
    },
    /// The file is no list of gear.
    #[error("{message}: {}", path.display())]
    Content {
        /// What is wrong, and where.
        message: String,
        /// The file.
        path: PathBuf,
    },
}

/// Returns the bundled list: heads with their sources, all modifiers of the program, stands and booms.
pub fn bundled_gear() -> &'static GearList {
    static BUNDLED: LazyLock<GearList> = LazyLock::new(|| {
        let modifiers = NamedModifier::ALL.iter().map(ModifierModel::from).collect();
        let named = GearList { modifiers, ..GearList::default() };
        // A test parses it
        parse_gear(include_str!("../../assets/gear/gear.ron")).map(|gear| named.with(&gear)).unwrap_or(named)
    });
    &BUNDLED
}

/// Returns the path of the user's list of gear in the settings folder.
pub fn own_gear_path(settings_folder: &Path) -> PathBuf {
    settings_folder.join("gear.ron")
}

/// Reads a user's list of gear; an empty one if there is no such file.
///
/// # Errors
/// If the file can't be read, is larger than 1 MB or is no list of gear.
pub fn read_gear(path: &Path) -> Result<GearList, GearError> {
    let read_error = |error| GearError::Read { error, path: path.to_owned() };
    let file = match std::fs::File::open(path) {
        Err(error) if error.kind() == std::io::ErrorKind::NotFound => return Ok(GearList::default()),
        opened => opened.map_err(read_error)?,
    };
    let mut text = String::new();
    file.take(LIMIT_BYTES + 1).read_to_string(&mut text).map_err(read_error)?;
    let content = |message| GearError::Content { message, path: path.to_owned() };
    if text.len() as u64 > LIMIT_BYTES {
        return Err(content("a list of gear has at most 1 MB".to_owned()));
    }
    parse_gear(&text).map_err(content)
}

/// Saves a user's list of gear; the older file stays until the new one is complete.
///
/// # Errors
/// If the file or its folder can't be written.
pub fn save_gear(gear: &GearList, path: &Path) -> Result<(), SaveError> {
    if let Some(folder) = path.parent() {
        // A folder that can't be made is the error of the write below
        let _ = std::fs::create_dir_all(folder);
    }
    atomic::write(path, write_gear(gear).as_bytes())
}

/// Returns the text of a list of gear.
fn write_gear(gear: &GearList) -> String {
    let options = ron::Options::default().with_default_extension(ron::extensions::Extensions::IMPLICIT_SOME);
    // Serializing plain structs, strings and numbers to a string can't fail.
    layout::lay_out(&options.to_string(&ron_v1::v1_from_gear(gear)).unwrap_or_default())
}

/// Parses the text of a list of gear.
fn parse_gear(text: &str) -> Result<GearList, String> {
    let text = text.strip_prefix('\u{feff}').unwrap_or(text);
    locate::check_nesting(text).map_err(|_| "brackets nest too deep for a list of gear".to_owned())?;
    let format = locate::exact_value_at(text, "format").and_then(|range| text[range].parse::<u32>().ok());
    match format {
        Some(1) => {}
        Some(other) => return Err(format!("the list of gear has format {other}; this version reads format 1")),
        None => return Err("a list of gear begins with `(format: 1,`".to_owned()),
    }
    let options = ron::Options::default().with_default_extension(ron::extensions::Extensions::IMPLICIT_SOME);
    let file = options.from_str::<ron_v1::GearV1>(text).map_err(|error| explain(text, &error).to_string())?;
    let gear = ron_v1::gear_from_v1(file).map_err(|name| {
        format!("modifier {name:?}: it is none of the program's modifiers, so it needs an `emitter`")
    })?;
    check_gear(&gear)?;
    Ok(gear)
}

/// Checks a list as the lights of a studio are checked.
fn check_gear(gear: &GearList) -> Result<(), String> {
    let heads = gear.heads.iter().map(|model| (&model.head.name, &model.source, model.owned, model.weight_kg));
    let modifiers = gear.modifiers.iter().map(|model| (&model.name, &model.source, model.owned, model.weight_kg));
    let supports = gear.supports.iter().map(|each| (&each.name, &each.source, each.owned, Some(each.load_kg)));
    if [gear.heads.len(), gear.modifiers.len(), gear.supports.len()].into_iter().any(|count| count > MOST_ENTRIES) {
        return Err(format!("a list of gear has at most {MOST_ENTRIES} entries of a kind"));
    }
    let mut names = std::collections::HashSet::new();
    for (kind, (name, source, owned, kg)) in (heads.map(|each| ("head", each)))
        .chain(modifiers.map(|each| ("modifier", each)))
        .chain(supports.map(|each| ("support", each)))
    {
        let wrong = |message: &str| Err(format!("{kind} {name:?}: {message}"));
        if name.is_empty() || name.chars().count() > MOST_CHARACTERS || source.chars().count() > MOST_CHARACTERS {
            return wrong("a name has 1 to 400 characters, and so has a source");
        }
        if source.is_empty() {
            return wrong("its source is empty: name it, or write \"typical\"");
        }
        if owned > MOST_OWNED {
            return wrong(&format!("more than {MOST_OWNED} pieces"));
        }
        if kg.is_some_and(|kg| !(0.0..=1000.0).contains(&kg)) {
            return wrong("a weight or load is 0 to 1000 kg");
        }
        if !names.insert((kind, name)) {
            return wrong("it is listed twice");
        }
    }
    for model in &gear.heads {
        let mut light = Light::new(model.front.unwrap_or(Emitter::Point), model.output);
        (light.name, light.head) = (model.head.name.clone(), Some(model.head.clone()));
        light.color.source = crate::scene::ColorSource::Kelvin(model.kelvin);
        check_light("head", light)?;
    }
    for model in &gear.modifiers {
        let mut light = Light::new(model.emitter, Output::Lumens(1.0));
        (light.name, light.modifier) = (model.name.clone(), Modifier::clone(&model.modifier));
        check_light("modifier", light)?;
    }
    let odd = gear.supports.iter().find(|support| !(0.1..=20.0).contains(&support.reach_m));
    odd.map_or(Ok(()), |support| Err(format!("support {:?}: a stand reaches 0.1 to 20 m", support.name)))
}

/// Checks a light of a head or a modifier.
fn check_light(kind: &str, light: Light) -> Result<(), String> {
    let name = light.name.clone();
    if light.emitter.is_infinite() {
        return Err(format!("{kind} {name:?}: sun and surround are no gear"));
    }
    let scene = Scene { lights: vec![light], ..Scene::default() };
    match validate(&scene).into_iter().find(|finding| finding.severity == Severity::Error) {
        Some(finding) => {
            let field = finding.place.rsplit(' ').next().unwrap_or_default();
            Err(format!("{kind} {name:?}: {field}: {}", finding.message))
        }
        None => Ok(()),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_bundled_list_is_read_and_every_head_names_its_source() {
        let parsed = parse_gear(include_str!("../../assets/gear/gear.ron")).unwrap();
        assert_eq!(bundled_gear().modifiers.len(), NamedModifier::ALL.len());
        assert!(bundled_gear().heads.len() > 10 && bundled_gear().supports.len() > 4);
        assert!(parsed.heads.iter().all(|model| model.source.contains("typical") || model.source.contains(':')));
        assert!(!parsed.has_own());
        let octa = bundled_gear().modifiers.iter().find(|model| model.name == "Octa 120").unwrap();
        assert_eq!(octa.weight_kg, Some(1.5));
        let readme = include_str!("../../assets/gear/README.md");
        for model in parsed.heads.iter().filter(|model| !model.source.starts_with("typical")) {
            let sources = ["blogspot", "techforum", "photography-on-the", "1854", "manual", "physicallybased"];
            let named: Vec<_> = sources.iter().filter(|source| model.source.contains(**source)).collect();
            assert!(!named.is_empty() && named.iter().all(|source| readme.contains(**source)), "{}", model.source);
        }
    }

    #[test]
    fn a_list_is_read_as_it_was_written() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("settings/gear.ron");
        assert_eq!(read_gear(&path).unwrap(), GearList::default(), "no file is an empty list");
        let mut gear = bundled_gear().clone();
        gear.heads[0].owned = 3;
        gear.modifiers[2].name = "Mine".to_owned();
        save_gear(&gear, &path).unwrap();
        assert_eq!(read_gear(&path).unwrap(), gear);
    }

    #[test]
    fn a_wrong_list_says_what_is_wrong() {
        let head =
            "(name: \"A\", output: Lumens(100.0), dial: (scale: PerCent, lowest_stops: -6.0, steps_per_stop: 1))";
        let list = |content: &str| format!("(format: 1, {content})");
        assert!(parse_gear(&list(&format!("heads: [{head}]"))).is_ok());
        for (text, expected) in [
            ("".to_owned(), "begins with"),
            ("(format: 7)".to_owned(), "format 7"),
            (list(&format!("heads: [{head}, {head}]")), "head \"A\": it is listed twice"),
            (list(&format!("heads: [{}]", head.replace("-6.0", "6.0"))), "head \"A\": head.dial.lowest_stops"),
            (list(&format!("heads: [{}]", head.replace("Lumens(100.0)", "Lux(1.0)"))), "head \"A\": power.output"),
            (list(&format!("heads: [{}]", head.replace("Lumens(100.0)", "Lumens(1e999)"))), "head \"A\": power.output"),
            (list(&format!("heads: [{}]", head.replace("steps_per_stop", "steps_per_stp"))), "did you mean"),
            (list("modifiers: [(name: \"Lantern\")]"), "modifier \"Lantern\": it is none of"),
            (list("modifiers: [(name: \"Octa 90\", source: \"\")]"), "its source is empty"),
            (list("modifiers: [(name: \"Octa 90\", owned: 5000)]"), "more than 999"),
            (list("modifiers: [(name: \"Sky\", emitter: Surround)]"), "sun and surround"),
            (list("supports: [(name: \"S\", kind: Stand, reach_m: -1.0, load_kg: 2.0)]"), "reaches 0.1 to 20 m"),
            (list("supports: [(name: \"S\", kind: Stand, reach_m: 1.0, load_kg: NaN)]"), "0 to 1000 kg"),
            ("(format: 1, heads: [[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[".to_owned(), "nest too deep"),
        ] {
            let error = parse_gear(&text).unwrap_err();
            assert!(error.contains(expected), "{text}: {error}");
        }
    }
}

//! Scenes from and to files: size and nesting checked first, then the text, then what the numbers mean.

use super::error::{LoadError, Problem, SaveError};
use super::ron_v1::{self, UnknownName};
use super::{assets, atomic, layout, locate};
use crate::scene::{Assets, Finding, Scene, Severity, placement, validate};
use std::collections::{HashMap, HashSet};
use std::io::Read;
use std::path::Path;

/// The newest format of scene files, and the one we write.
pub const FORMAT: u32 = 1;

/// The largest scene file that is read, bytes: room for ten thousand lights and as many objects.
pub const FILE_LIMIT_BYTES: u64 = 32_000_000;

/// Problems of one file that are reported; finding the line of each is a walk over the text.
const PROBLEMS: usize = 20;

/// A scene with everything it needs, ready for every renderer.
#[derive(Clone, Debug)]
pub struct Loaded {
    /// The studio.
    pub scene: Scene,
    /// Its meshes and textures.
    pub assets: Assets,
    /// What is odd, missing or was mended.
    pub warnings: Vec<Finding>,
}

/// Loads a scene and the files it names, which are looked for in the scene's folder.
///
/// # Errors
/// When the file can't be read or what it says can't be used; a missing model or texture is a warning.
pub fn load_scene(path: &Path) -> Result<Loaded, LoadError> {
    let in_file = |error| LoadError::InFile { error: Box::new(error), path: path.to_owned() };
    let text = read_text(path).map_err(|error| match error {
        LoadError::Read { .. } => error,
        other => in_file(other),
    })?;
    let (scene, warnings) = parse_scene(&text).map_err(in_file)?;
    Ok(complete(scene, warnings, path.parent()))
}

/// Loads the assets of a scene that was just read and adds the warnings that need them.
pub(super) fn complete(scene: Scene, mut warnings: Vec<Finding>, folder: Option<&Path>) -> Loaded {
    let mut assets = Assets::default();
    warnings.extend(assets::load_assets(&scene, folder, &mut assets));
    warnings.extend(placement(&scene, &assets));
    Loaded { scene, assets, warnings }
}

fn read_text(path: &Path) -> Result<String, LoadError> {
    let read_error = |source| LoadError::Read { source, path: path.to_owned() };
    let file = std::fs::File::open(path).map_err(read_error)?;
    let bytes = file.metadata().map_err(read_error)?.len();
    if bytes > FILE_LIMIT_BYTES {
        return Err(LoadError::TooLarge { bytes, limit_bytes: FILE_LIMIT_BYTES });
    }
    let mut content = Vec::with_capacity(bytes as usize);
    // A pipe or a growing file says nothing true about its size.
    file.take(FILE_LIMIT_BYTES + 1).read_to_end(&mut content).map_err(read_error)?;
    String::from_utf8(content).map_err(|error| LoadError::NotText(error.utf8_error().valid_up_to()))
}

/// Reads the text of a scene file. Beside the scene come warnings that need no other files.
///
/// # Errors
/// When the text is no scene, or a scene that no renderer could take. Every problem names field, value and line.
pub fn parse_scene(text: &str) -> Result<(Scene, Vec<Finding>), LoadError> {
    if text.len() as u64 > FILE_LIMIT_BYTES {
        return Err(LoadError::TooLarge { bytes: text.len() as u64, limit_bytes: FILE_LIMIT_BYTES });
    }
    let text = text.strip_prefix('\u{feff}').unwrap_or(text);
    let one = |problem| LoadError::Content(vec![problem]);
    let outline = locate::check_nesting(text).map_err(|locate::TooDeep(at)| {
        one(problem_at(text, String::new(), "brackets nest too deep for a scene".to_owned(), at..at + 1))
    })?;
    check_format(text).map_err(one)?;
    let options = ron::Options::default().with_default_extension(ron::extensions::Extensions::IMPLICIT_SOME);
    let file = options.from_str::<ron_v1::SceneV1>(text).map_err(|error| one(explain(text, &error)))?;
    let mut scene = ron_v1::scene_from_v1(file).map_err(|unknown| one(explain_name(text, &unknown)))?;

    let mut warnings = mend_names(&mut scene);
    let (errors, odd): (Vec<_>, Vec<_>) = validate(&scene).into_iter().partition(|f| f.severity == Severity::Error);
    if !errors.is_empty() {
        return Err(LoadError::Content(errors.iter().take(PROBLEMS).map(|error| problem_of(text, error)).collect()));
    }
    warnings.extend(odd);
    if outline.has_comments {
        warnings.push(Finding::warning("", "the file has comments; saving does not keep them"));
    }
    Ok((scene, warnings))
}

/// The text of a scene file. Reading it gives the same scene, with ids in list order.
pub fn write_scene(scene: &Scene) -> String {
    let mut unique = scene.clone();
    mend_names(&mut unique);
    let options = ron::Options::default().with_default_extension(ron::extensions::Extensions::IMPLICIT_SOME);
    // Serializing plain structs, strings and numbers into a string has no way to fail.
    let compact = options.to_string(&ron_v1::v1_from_scene(&unique)).unwrap_or_default();
    layout::lay_out(&compact)
}

/// Saves a scene: written beside the older file, flushed to the disk, then renamed over it.
///
/// # Errors
/// When the scene would not load again, or the disk refuses. The older file then is as it was.
pub fn save_scene(scene: &Scene, path: &Path) -> Result<(), SaveError> {
    if let Some(error) = validate(scene).into_iter().find(|f| f.severity == Severity::Error && !f.is_name_clash()) {
        return Err(SaveError::Invalid(error));
    }
    atomic::write(path, write_scene(scene).as_bytes())
}

/// Gives the later of two equal names a number. Aims hold ids, so they keep their object.
fn mend_names(scene: &mut Scene) -> Vec<Finding> {
    let mut warnings = Vec::new();
    let taken = scene.objects.iter().map(|o| &o.name).chain(scene.lights.iter().map(|l| &l.name)).cloned().collect();
    let mut names = Names { taken, seen: HashSet::new(), numbers: HashMap::new() };
    let objects = scene.objects.iter_mut().map(|o| &mut o.name).enumerate().map(|(i, name)| ("objects", i, name));
    let lights = scene.lights.iter_mut().map(|l| &mut l.name).enumerate().map(|(i, name)| ("lights", i, name));
    for (list, i, name) in objects.chain(lights) {
        if names.seen.insert(name.clone()) {
            continue;
        }
        let new = names.fresh(name);
        let message = format!("another thing bears this name, too; this one is now {new:?}");
        warnings.push(Finding::warning(format!("{list}[{i}] {name:?} name"), message));
        *name = new;
    }
    warnings
}

/// Names in use. Unlike `Scene::unique_name` it stays quick for ten thousand equal names.
struct Names {
    taken: HashSet<String>,
    seen: HashSet<String>,
    /// The last number that a stem was given.
    numbers: HashMap<String, u32>,
}

impl Names {
    fn fresh(&mut self, name: &str) -> String {
        let stem = name.trim_end_matches(|c: char| c.is_ascii_digit()).trim_end();
        let stem = if stem.is_empty() { name } else { stem };
        let number = self.numbers.entry(stem.to_owned()).or_insert(1);
        loop {
            *number += 1;
            let candidate = format!("{stem} {number}");
            if self.taken.insert(candidate.clone()) {
                self.seen.insert(candidate.clone());
                return candidate;
            }
        }
    }
}

fn check_format(text: &str) -> Result<(), Problem> {
    let Some(range) = locate::exact_value_at(text, "format") else {
        let message =
            if text.trim().is_empty() { "the file is empty" } else { "a scene file begins with `(format: 1,`" };
        return Err(problem_at(text, "format".to_owned(), message.to_owned(), 0..0));
    };
    let message = match text[range.clone()].parse::<u32>() {
        Ok(FORMAT) => return Ok(()),
        Ok(0) | Err(_) => {
            format!("{:?} is no format; this version reads format {FORMAT}", shorten(&text[range.clone()]))
        }
        Ok(newer) => format!("the file has format {newer}, but this version of the program reads only up to {FORMAT}"),
    };
    Err(problem_at(text, "format".to_owned(), message, range))
}

/// The problem behind a finding about the scene that `text` says.
fn problem_of(text: &str, finding: &Finding) -> Problem {
    let range = locate::value_at(text, &path_of(&finding.place));
    problem_at(text, finding.place.clone(), finding.message.clone(), range)
}

/// `lights[2] "Key" power.dial_stops` without the name: `lights[2].power.dial_stops`.
fn path_of(place: &str) -> String {
    match (place.find(" \""), place.rfind("\" ")) {
        // A quote behind the last `" ` means that this is inside the name: the place is the thing as a whole.
        (Some(head), Some(tail)) if tail > head && !place[tail + 2..].contains('"') => {
            format!("{}.{}", &place[..head], &place[tail + 2..])
        }
        (Some(head), _) => place[..head].to_owned(),
        _ => place.to_owned(),
    }
}

/// What the RON parser's error means, in words about the field it is in.
fn explain(text: &str, error: &ron::error::SpannedError) -> Problem {
    use ron::Error as E;
    // The parser's cursor stands before the value, often with some space between.
    let start = locate::offset_of(text, error.span.start.line, error.span.start.col);
    let at = start + leading_space(&text[start..]);
    let (field, value) = locate::entry_at(text, at);
    let message = match &error.code {
        E::NoSuchStructField { expected, found, .. } => {
            format!("there is no field {found:?} here; {}", nearest(found, expected.iter().copied()))
        }
        E::NoSuchEnumVariant { expected, found, .. } => {
            format!("{found:?} is not known here; {}", nearest(found, expected.iter().copied()))
        }
        E::MissingStructField { field, .. } => format!("the field {field:?} is missing"),
        E::DuplicateStructField { field, .. } => format!("the field {field:?} is given twice"),
        E::Eof => "the file ends in the middle".to_owned(),
        E::ExpectedFloat | E::ExpectedInteger => "a number is expected".to_owned(),
        E::ExpectedBoolean => "true or false is expected".to_owned(),
        E::ExpectedString => "a text in quotes is expected".to_owned(),
        other => lower_first(&other.to_string()),
    };
    let quoted = match &error.code {
        E::NoSuchStructField { found, .. } => found,
        _ => &text[value],
    };
    Problem { text: shorten(quoted), ..problem_at(text, field, message, at..at) }
}

fn explain_name(text: &str, unknown: &UnknownName) -> Problem {
    let UnknownName { kind, place, name, known } = unknown;
    let message = format!("there is no {kind} {name:?}; {}", nearest(name, known.iter().map(String::as_str)));
    problem_at(text, place.clone(), message, locate::value_at(text, &path_of(place)))
}

fn problem_at(text: &str, field: String, message: String, range: std::ops::Range<usize>) -> Problem {
    let (line, column) = locate::line_and_column(text, range.start);
    Problem { field, message, line, column, text: shorten(text.get(range).unwrap_or_default()) }
}

fn leading_space(text: &str) -> usize {
    text.len() - text.trim_start().len()
}

/// The first words of a value, on one line.
fn shorten(value: &str) -> String {
    const LENGTH: usize = 40;
    let mut words = value.split_whitespace().flat_map(|word| word.chars().chain([' ']));
    let mut short: String = words.by_ref().take(LENGTH).collect();
    let is_cut = words.next().is_some();
    short.truncate(short.trim_end().len());
    if is_cut {
        short.push_str(" ...");
    }
    short
}

fn lower_first(text: &str) -> String {
    let mut chars = text.chars();
    chars.next().map_or_else(String::new, |first| first.to_lowercase().chain(chars).collect())
}

/// `did you mean "x"?` for the known word with the fewest edits away, or the list of all.
fn nearest<'a>(found: &str, known: impl Iterator<Item = &'a str> + Clone) -> String {
    let best = known.clone().map(|word| (edit_distance(found, word), word)).min();
    match best {
        Some((distance, word)) if distance <= 2.max(word.chars().count() / 2) => format!("did you mean {word:?}?"),
        Some(_) => format!("known are {}", known.take(20).collect::<Vec<_>>().join(", ")),
        None => "there is none at all".to_owned(),
    }
}

/// Levenshtein distance without regard to case, of words cut to 64 characters.
fn edit_distance(a: &str, b: &str) -> usize {
    let [a, b] = [a, b].map(|word| word.to_lowercase().chars().take(64).collect::<Vec<char>>());
    let mut row: Vec<usize> = (0..=b.len()).collect();
    for (i, ca) in a.iter().enumerate() {
        let mut diagonal = std::mem::replace(&mut row[0], i + 1);
        for (j, cb) in b.iter().enumerate() {
            let substituted = diagonal + usize::from(ca != cb);
            diagonal = row[j + 1];
            row[j + 1] = substituted.min(row[j] + 1).min(row[j + 1] + 1);
        }
    }
    row[b.len()]
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn edit_distances() {
        for (a, b, expected) in [("", "abc", 3), ("f_numbr", "f_number", 1), ("Chrom", "chrome", 1), ("ab", "ba", 2)] {
            assert_eq!(edit_distance(a, b), expected);
        }
        assert_eq!(nearest("isoo", ["iso", "aim"].into_iter()), "did you mean \"iso\"?");
        assert_eq!(nearest("zzzzzzz", ["iso", "aim"].into_iter()), "known are iso, aim");
    }

    #[test]
    fn places_become_paths() {
        assert_eq!(path_of(r#"lights[2] "Key" power.dial_stops"#), "lights[2].power.dial_stops");
        assert_eq!(path_of(r#"objects[0] "a \"b\" c""#), "objects[0]");
        assert_eq!(path_of("camera.f_number"), "camera.f_number");
    }
}

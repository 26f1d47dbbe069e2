//! Words the errors of a scene file: field, value, line, and the nearest known word for a misspelt one.

use super::error::{Problem, cut};
use super::locate;
use super::ron_v1::UnknownName;
use crate::scene::Finding;

/// Locates a finding about the scene in the text of its file.
pub(super) fn problem_of(text: &str, finding: &Finding) -> Problem {
    let range = locate::value_at(text, &path_of(&finding.place));
    problem_at(text, finding.place.clone(), finding.message.clone(), range)
}

/// Removes the name from a place: `lights[2] "Key" power.dial_stops` becomes `lights[2].power.dial_stops`.
fn path_of(place: &str) -> String {
    match (place.find(" \""), place.rfind("\" ")) {
        // With a quote after the last `" `, that is part of the name, and the place has no field.
        (Some(head), Some(tail)) if tail > head && !place[tail + 2..].contains('"') => {
            format!("{}.{}", &place[..head], &place[tail + 2..])
        }
        (Some(head), _) => place[..head].to_owned(),
        _ => place.to_owned(),
    }
}

/// Words an error of the RON parser in terms of the field it is in.
pub(super) fn explain(text: &str, error: &ron::error::SpannedError) -> Problem {
    use ron::Error as E;
    // The parser reports a position before the value, often with space between.
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

/// Words a reference to an unknown name.
pub(super) fn explain_name(text: &str, unknown: &UnknownName) -> Problem {
    let UnknownName { kind, place, name, known } = unknown;
    let message = format!("there is no {kind} {name:?}; {}", nearest(name, known.iter().map(String::as_str)));
    problem_at(text, place.clone(), message, locate::value_at(text, &path_of(place)))
}

/// Returns a problem at a range of bytes.
pub(super) fn problem_at(text: &str, field: String, message: String, range: std::ops::Range<usize>) -> Problem {
    let (line, column) = locate::line_and_column(text, range.start);
    Problem {
        field: cut(field),
        message: cut(message),
        line,
        column,
        text: shorten(text.get(range).unwrap_or_default()),
    }
}

fn leading_space(text: &str) -> usize {
    text.len() - text.trim_start().len()
}

/// Cuts a value to its first words, on one line.
pub(super) fn shorten(value: &str) -> String {
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

/// Suggests the known word at the smallest edit distance, or lists all known words if none is near.
fn nearest<'a>(found: &str, known: impl Iterator<Item = &'a str> + Clone) -> String {
    let best = known.clone().map(|word| (edit_distance(found, word), word)).min();
    match best {
        Some((distance, word)) if distance <= 2.max(word.chars().count() / 2) => format!("did you mean {word:?}?"),
        Some(_) => format!("known are {}", known.take(20).collect::<Vec<_>>().join(", ")),
        None => "there is none at all".to_owned(),
    }
}

/// Returns the Levenshtein distance of two words in lower case, cut to 64 characters.
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
    fn places_are_converted_to_paths() {
        assert_eq!(path_of(r#"lights[2] "Key" power.dial_stops"#), "lights[2].power.dial_stops");
        assert_eq!(path_of(r#"objects[0] "a \"b\" c""#), "objects[0]");
        assert_eq!(path_of("camera.f_number"), "camera.f_number");
    }
}

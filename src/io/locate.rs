//! Where in a scene file a field stands. A walk over the text's brackets, without building anything: it serves to
//! bound the nesting before the parser runs, and to give errors their field and their line.

use std::ops::Range;

/// Deepest nesting of brackets that a scene file can need is 6; more than this is no scene.
pub(super) const NESTING_LIMIT: usize = 32;

/// One step of a path: `lights`, `[2]`, `power`.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Step<'a> {
    Name(&'a str),
    Index(usize),
}

/// An open bracket, or the file itself.
#[derive(Debug, Default)]
struct Frame<'a> {
    /// Name of the entry being read, once its colon was seen.
    key: Option<&'a str>,
    /// Number of the entry being read.
    index: usize,
    /// Where the entry's value (or what may turn out to be its name) starts.
    value_start: Option<usize>,
}

impl<'a> Frame<'a> {
    fn step(&self) -> Step<'a> {
        self.key.map_or(Step::Index(self.index), Step::Name)
    }
}

/// What the walk says when brackets nest deeper than [`NESTING_LIMIT`]: the byte of the bracket.
#[derive(Debug, PartialEq, Eq)]
pub(super) struct TooDeep(pub usize);

/// What the nesting check has seen besides.
#[derive(Debug, PartialEq, Eq)]
pub(super) struct Outline {
    /// Whether there are comments, which a save would drop.
    pub has_comments: bool,
}

/// Checks the nesting of brackets. Linear in the text, needs no memory to speak of.
pub(super) fn check_nesting(text: &str) -> Result<Outline, TooDeep> {
    let mut has_comments = false;
    let mut depth = 0_usize;
    for token in Tokens::new(text) {
        match token.kind {
            Kind::Open => {
                depth += 1;
                if depth > NESTING_LIMIT {
                    return Err(TooDeep(token.range.start));
                }
            }
            Kind::Close => depth = depth.saturating_sub(1),
            Kind::Comment => has_comments = true,
            _ => {}
        }
    }
    Ok(Outline { has_comments })
}

/// Bytes of the value at `path` (as in `lights[2].power.dial_stops`), or of the nearest thing around it.
pub(super) fn value_at(text: &str, path: &str) -> Range<usize> {
    nearest_value(text, path).1
}

/// Bytes of the value at exactly `path`.
pub(super) fn exact_value_at(text: &str, path: &str) -> Option<Range<usize>> {
    let (steps, range) = nearest_value(text, path);
    (steps == parse_path(path).len()).then_some(range)
}

/// The value whose path is the longest beginning of `path`, with the number of its steps.
fn nearest_value(text: &str, path: &str) -> (usize, Range<usize>) {
    let wanted = parse_path(path);
    let mut best = (0, 0..text.len());
    walk(text, |frames, value| {
        let steps = &frames[1..];
        if steps.len() > best.0
            && steps.len() <= wanted.len()
            && steps.iter().zip(&wanted).all(|(have, want)| have.step() == *want)
        {
            best = (steps.len(), value);
        }
        best.0 < wanted.len()
    });
    best
}

/// Path and value bytes of the innermost entry that holds the byte `offset`.
pub(super) fn entry_at(text: &str, offset: usize) -> (String, Range<usize>) {
    let mut found = None;
    let unfinished = walk(text, |frames, value| {
        if value.contains(&offset) && found.is_none() {
            found = Some((path_of(frames), value));
        }
        found.is_none()
    });
    found.unwrap_or_else(|| (unfinished, offset.min(text.len())..text.len()))
}

/// Line and column of a byte, both from 1, columns in characters.
pub(super) fn line_and_column(text: &str, offset: usize) -> (usize, usize) {
    let before = &text[..text.floor_char_boundary(offset.min(text.len()))];
    let line_start = before.rfind('\n').map_or(0, |newline| newline + 1);
    (1 + before.matches('\n').count(), 1 + before[line_start..].chars().count())
}

/// The byte at a line and column.
pub(super) fn offset_of(text: &str, line: usize, column: usize) -> usize {
    let line_start = text.match_indices('\n').nth(line.wrapping_sub(2)).map_or(0, |(at, _)| at + 1);
    let line_start = if line <= 1 { 0 } else { line_start };
    let into = text[line_start..].char_indices().nth(column.saturating_sub(1)).map_or(text.len() - line_start, |c| c.0);
    line_start + into
}

fn parse_path(path: &str) -> Vec<Step<'_>> {
    path.split(['.', '['])
        .filter(|part| !part.is_empty())
        .map(|part| match part.strip_suffix(']').and_then(|index| index.parse().ok()) {
            Some(index) => Step::Index(index),
            None => Step::Name(part),
        })
        .collect()
}

fn path_of(frames: &[Frame<'_>]) -> String {
    let mut path = String::new();
    for frame in frames.iter().skip(1) {
        match frame.step() {
            Step::Name(name) => {
                if !path.is_empty() {
                    path.push('.');
                }
                path.push_str(name);
            }
            Step::Index(index) => path.push_str(&format!("[{index}]")),
        }
    }
    path
}

/// Calls `visit` with the open brackets and the bytes of each finished value, inner ones first, until it says stop,
/// the text ends or makes no sense. Returns the path of the entry it ended in.
fn walk<'a>(text: &'a str, mut visit: impl FnMut(&[Frame<'a>], Range<usize>) -> bool) -> String {
    let mut frames: Vec<Frame<'a>> = vec![Frame::default()];
    let mut last_end = 0;
    for token in Tokens::new(text) {
        let Some(top) = frames.last_mut() else { break };
        match token.kind {
            Kind::Comment => continue,
            Kind::Word | Kind::Text => top.value_start = top.value_start.or(Some(token.range.start)),
            Kind::Colon => {
                top.key = top.value_start.take().map(|start| text[start..last_end].trim_matches('"'));
            }
            Kind::Open => {
                top.value_start = top.value_start.or(Some(token.range.start));
                if frames.len() > NESTING_LIMIT {
                    break;
                }
                frames.push(Frame::default());
            }
            Kind::Comma | Kind::Close => {
                if let Some(start) = top.value_start
                    && !visit(&frames, start..last_end)
                {
                    break;
                }
                if token.kind == Kind::Close {
                    if frames.len() == 1 {
                        break;
                    }
                    frames.pop();
                } else if let Some(top) = frames.last_mut() {
                    *top = Frame { index: top.index + 1, ..Frame::default() };
                }
            }
        }
        last_end = token.range.end;
    }
    if let [root] = &frames[..]
        && let Some(start) = root.value_start
    {
        visit(&frames, start..last_end);
    }
    path_of(&frames)
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Kind {
    Open,
    Close,
    Comma,
    Colon,
    Word,
    Text,
    Comment,
}

#[derive(Debug)]
struct Token {
    kind: Kind,
    range: Range<usize>,
}

/// Splits RON into brackets, separators, strings, comments and words (names, numbers and whatever else).
struct Tokens<'a> {
    text: &'a str,
    at: usize,
}

impl<'a> Tokens<'a> {
    fn new(text: &'a str) -> Self {
        Tokens { text, at: 0 }
    }

    /// Length of the token of this kind at the start of `rest`, at least 1.
    fn measure(rest: &[u8]) -> (Kind, usize) {
        match rest[0] {
            b'(' | b'[' | b'{' => (Kind::Open, 1),
            b')' | b']' | b'}' => (Kind::Close, 1),
            b',' => (Kind::Comma, 1),
            b':' => (Kind::Colon, 1),
            b'"' => (Kind::Text, string_len(rest)),
            b'\'' if rest.len() > 2 && rest[2] == b'\'' => (Kind::Text, 3),
            b'/' if rest.starts_with(b"//") => (Kind::Comment, find(rest, b"\n", 2)),
            b'/' if rest.starts_with(b"/*") => (Kind::Comment, block_comment_len(rest)),
            b'r' if raw_string_hashes(rest).is_some() => {
                let hashes = raw_string_hashes(rest).unwrap_or(0);
                let end: Vec<u8> = std::iter::once(b'"').chain(std::iter::repeat_n(b'#', hashes)).collect();
                (Kind::Text, find(rest, &end, hashes + 2))
            }
            _ => {
                let stops = |b: &u8| b.is_ascii_whitespace() || b"()[]{},:\"/".contains(b);
                (Kind::Word, rest.iter().skip(1).position(stops).map_or(rest.len(), |n| n + 1))
            }
        }
    }
}

impl Iterator for Tokens<'_> {
    type Item = Token;

    fn next(&mut self) -> Option<Token> {
        let bytes = self.text.as_bytes();
        self.at += bytes[self.at..].iter().take_while(|b| b.is_ascii_whitespace()).count();
        let rest = &bytes[self.at..];
        if rest.is_empty() {
            return None;
        }
        let start = self.at;
        let (kind, length) = Self::measure(rest);
        self.at += length;
        Some(Token { kind, range: start..self.at })
    }
}

/// Bytes up to and with the first `needle` at or after `from`; all of them where there is none.
fn find(rest: &[u8], needle: &[u8], from: usize) -> usize {
    let tail = rest.get(from..).unwrap_or_default();
    tail.windows(needle.len()).position(|w| w == needle).map_or(rest.len(), |at| from + at + needle.len())
}

fn string_len(rest: &[u8]) -> usize {
    let mut at = 1;
    while at < rest.len() {
        match rest[at] {
            b'\\' => at += 2,
            b'"' => return at + 1,
            _ => at += 1,
        }
    }
    rest.len()
}

fn block_comment_len(rest: &[u8]) -> usize {
    let (mut at, mut depth) = (2, 1_usize);
    while at < rest.len() && depth > 0 {
        if rest[at..].starts_with(b"*/") {
            depth -= 1;
            at += 2;
        } else if rest[at..].starts_with(b"/*") {
            depth += 1;
            at += 2;
        } else {
            at += 1;
        }
    }
    at.min(rest.len())
}

/// Number of `#` of a raw string that starts here.
fn raw_string_hashes(rest: &[u8]) -> Option<usize> {
    let hashes = rest[1..].iter().take_while(|b| **b == b'#').count();
    (rest.get(1 + hashes) == Some(&b'"')).then_some(hashes)
}

#[cfg(test)]
mod tests {
    use super::*;

    const TEXT: &str = r#"(
    format: 1, // a comment with ( and "
    name: "odd \" name: (x",
    lights: [
        (name: "a", power: (dial: 1.0)),
        (name: r"b", emitter: Spot(inner_deg: 30.0, outer_deg: 400.0), at: (1.0, 2.0, 3.0)),
    ],
)"#;

    fn found(path: &str) -> &'static str {
        &TEXT[value_at(TEXT, path)]
    }

    #[test]
    fn paths_lead_to_values() {
        assert_eq!(found("format"), "1");
        assert_eq!(found("name"), r#""odd \" name: (x""#);
        assert_eq!(found("lights[0].power.dial"), "1.0");
        assert_eq!(found("lights[1].emitter.outer_deg"), "400.0");
        assert_eq!(found("lights[1].at"), "(1.0, 2.0, 3.0)");
        assert_eq!(found("lights[1].at[2]"), "3.0");
    }

    #[test]
    fn missing_fields_lead_to_what_is_around_them() {
        assert_eq!(found("lights[0].emitter.outer_deg"), r#"(name: "a", power: (dial: 1.0))"#);
        assert!(found("camera").starts_with("(\n    format"));
    }

    #[test]
    fn bytes_lead_to_paths() {
        let at = TEXT.find("400.0").unwrap();
        assert_eq!(entry_at(TEXT, at), ("lights[1].emitter.outer_deg".to_owned(), at..at + 5));
        assert_eq!(line_and_column(TEXT, at), (6, 64));
        assert_eq!(offset_of(TEXT, 6, 64), at);
        // A file that was cut off still knows where it was.
        assert_eq!(entry_at(&TEXT[..at + 2], at + 1).0, "lights[1].emitter.outer_deg");
    }

    #[test]
    fn nesting_is_bounded_and_comments_are_seen() {
        assert_eq!(check_nesting(TEXT), Ok(Outline { has_comments: true }));
        let bomb = "(".repeat(1_000_000);
        assert_eq!(check_nesting(&bomb), Err(TooDeep(NESTING_LIMIT)));
    }

    #[test]
    fn any_cut_of_the_text_is_survived() {
        for end in 0..TEXT.len() {
            let cut = &TEXT[..end];
            let _ = (check_nesting(cut), value_at(cut, "lights[1].at[2]"), entry_at(cut, end / 2), entry_at(cut, end));
        }
    }
}

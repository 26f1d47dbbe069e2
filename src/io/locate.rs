//! Locates fields in the text of a scene file, by scanning its brackets without building a tree. Bounds the nesting
//! before the parser runs, and gives errors their field and line.

use std::ops::Range;

/// Deepest nesting of brackets that is read. Scene files need 6.
pub(super) const NESTING_LIMIT: usize = 32;

/// A segment of a path: `lights`, `[2]`, `power`.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum PathSegment<'a> {
    Name(&'a str),
    Index(usize),
}

/// An open bracket, or the whole file, during the scan.
#[derive(Debug, Default)]
struct OpenBracket<'a> {
    /// Name of the current entry, once its colon is scanned.
    key: Option<&'a str>,
    /// Index of the current entry.
    index: usize,
    /// First byte of the current entry's value, or of its name before the colon.
    value_start: Option<usize>,
}

impl<'a> OpenBracket<'a> {
    fn segment(&self) -> PathSegment<'a> {
        self.key.map_or(PathSegment::Index(self.index), PathSegment::Name)
    }
}

/// Brackets nest deeper than [`NESTING_LIMIT`]; holds the byte of the first bracket that does.
#[derive(Debug, PartialEq, Eq)]
pub(super) struct TooDeep(pub usize);

/// Properties of the text that the nesting check finds.
#[derive(Debug, PartialEq, Eq)]
pub(super) struct NestingInfo {
    /// The text has comments, which a save would drop.
    pub has_comments: bool,
}

/// Checks the nesting of brackets, in linear time and constant memory.
pub(super) fn check_nesting(text: &str) -> Result<NestingInfo, TooDeep> {
    let mut has_comments = false;
    let mut depth = 0_usize;
    for token in Lexer::new(text) {
        match token.kind {
            TokenKind::Open => {
                depth += 1;
                if depth > NESTING_LIMIT {
                    return Err(TooDeep(token.range.start));
                }
            }
            TokenKind::Close => depth = depth.saturating_sub(1),
            TokenKind::Comment => has_comments = true,
            _ => {}
        }
    }
    Ok(NestingInfo { has_comments })
}

/// Returns the bytes of the value at `path`, such as `lights[2].power.dial_stops`, or of the innermost value around it.
pub(super) fn value_at(text: &str, path: &str) -> Range<usize> {
    nearest_value(text, path).1
}

/// Returns the bytes of the value at exactly `path`.
pub(super) fn exact_value_at(text: &str, path: &str) -> Option<Range<usize>> {
    let (segments, range) = nearest_value(text, path);
    (segments == parse_path(path).len()).then_some(range)
}

/// Returns the value whose path is the longest prefix of `path`, after the number of segments of that prefix.
fn nearest_value(text: &str, path: &str) -> (usize, Range<usize>) {
    let target = parse_path(path);
    let mut best = (0, 0..text.len());
    walk(text, |open, value| {
        let segments = &open[1..];
        if segments.len() > best.0
            && segments.len() <= target.len()
            && segments.iter().zip(&target).all(|(segment, expected)| segment.segment() == *expected)
        {
            best = (segments.len(), value);
        }
        best.0 < target.len()
    });
    best
}

/// Returns path and value bytes of the innermost entry that contains the byte `offset`.
pub(super) fn entry_at(text: &str, offset: usize) -> (String, Range<usize>) {
    let mut found = None;
    let unfinished = walk(text, |open, value| {
        if value.contains(&offset) && found.is_none() {
            found = Some((path_of(open), value));
        }
        found.is_none()
    });
    found.unwrap_or_else(|| (unfinished, offset.min(text.len())..text.len()))
}

/// Returns line and column of a byte, both from 1, columns in characters.
pub(super) fn line_and_column(text: &str, offset: usize) -> (usize, usize) {
    let before = &text[..text.floor_char_boundary(offset.min(text.len()))];
    let line_start = before.rfind('\n').map_or(0, |newline| newline + 1);
    (1 + before.matches('\n').count(), 1 + before[line_start..].chars().count())
}

/// Returns the byte at a line and column, both from 1.
pub(super) fn offset_of(text: &str, line: usize, column: usize) -> usize {
    let line_start = text.match_indices('\n').nth(line.wrapping_sub(2)).map_or(0, |(at, _)| at + 1);
    let line_start = if line <= 1 { 0 } else { line_start };
    let into = text[line_start..].char_indices().nth(column.saturating_sub(1)).map_or(text.len() - line_start, |c| c.0);
    line_start + into
}

fn parse_path(path: &str) -> Vec<PathSegment<'_>> {
    path.split(['.', '['])
        .filter(|part| !part.is_empty())
        .map(|part| match part.strip_suffix(']').and_then(|index| index.parse().ok()) {
            Some(index) => PathSegment::Index(index),
            None => PathSegment::Name(part),
        })
        .collect()
}

fn path_of(open: &[OpenBracket<'_>]) -> String {
    let mut path = String::new();
    for bracket in open.iter().skip(1) {
        match bracket.segment() {
            PathSegment::Name(name) => {
                if !path.is_empty() {
                    path.push('.');
                }
                path.push_str(name);
            }
            PathSegment::Index(index) => path.push_str(&format!("[{index}]")),
        }
    }
    path
}

/// Calls `visit` with the open brackets and the bytes of each complete value, inner values first, until it returns
/// false, the text ends or its brackets do not match. Returns the path of the entry where the scan ended.
fn walk<'a>(text: &'a str, mut visit: impl FnMut(&[OpenBracket<'a>], Range<usize>) -> bool) -> String {
    let mut open: Vec<OpenBracket<'a>> = vec![OpenBracket::default()];
    let mut last_end = 0;
    for token in Lexer::new(text) {
        let Some(top) = open.last_mut() else { break };
        match token.kind {
            TokenKind::Comment => continue,
            TokenKind::Word | TokenKind::Text => top.value_start = top.value_start.or(Some(token.range.start)),
            TokenKind::Colon => {
                top.key = top.value_start.take().map(|start| text[start..last_end].trim_matches('"'));
            }
            TokenKind::Open => {
                top.value_start = top.value_start.or(Some(token.range.start));
                if open.len() > NESTING_LIMIT {
                    break;
                }
                open.push(OpenBracket::default());
            }
            TokenKind::Comma | TokenKind::Close => {
                if let Some(start) = top.value_start
                    && !visit(&open, start..last_end)
                {
                    break;
                }
                if token.kind == TokenKind::Close {
                    if open.len() == 1 {
                        break;
                    }
                    open.pop();
                } else if let Some(top) = open.last_mut() {
                    *top = OpenBracket { index: top.index + 1, ..OpenBracket::default() };
                }
            }
        }
        last_end = token.range.end;
    }
    if let [root] = &open[..]
        && let Some(start) = root.value_start
    {
        visit(&open, start..last_end);
    }
    path_of(&open)
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum TokenKind {
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
    kind: TokenKind,
    range: Range<usize>,
}

/// Splits RON into brackets, separators, strings, comments and words (names, numbers and all else).
struct Lexer<'a> {
    text: &'a str,
    at: usize,
}

impl<'a> Lexer<'a> {
    fn new(text: &'a str) -> Self {
        Lexer { text, at: 0 }
    }

    /// Returns kind and length, at least 1, of the token at the start of `rest`.
    fn measure(rest: &[u8]) -> (TokenKind, usize) {
        match rest[0] {
            b'(' | b'[' | b'{' => (TokenKind::Open, 1),
            b')' | b']' | b'}' => (TokenKind::Close, 1),
            b',' => (TokenKind::Comma, 1),
            b':' => (TokenKind::Colon, 1),
            b'"' => (TokenKind::Text, string_len(rest)),
            b'\'' if rest.len() > 2 && rest[2] == b'\'' => (TokenKind::Text, 3),
            b'/' if rest.starts_with(b"//") => (TokenKind::Comment, find(rest, b"\n", 2)),
            b'/' if rest.starts_with(b"/*") => (TokenKind::Comment, block_comment_len(rest)),
            b'r' if raw_string_hashes(rest).is_some() => {
                let hashes = raw_string_hashes(rest).unwrap_or(0);
                let end: Vec<u8> = std::iter::once(b'"').chain(std::iter::repeat_n(b'#', hashes)).collect();
                (TokenKind::Text, find(rest, &end, hashes + 2))
            }
            _ => {
                let stops = |b: &u8| b.is_ascii_whitespace() || b"()[]{},:\"/".contains(b);
                (TokenKind::Word, rest.iter().skip(1).position(stops).map_or(rest.len(), |n| n + 1))
            }
        }
    }
}

impl Iterator for Lexer<'_> {
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
    fn a_missing_field_is_located_at_the_value_around_it() {
        assert_eq!(found("lights[0].emitter.outer_deg"), r#"(name: "a", power: (dial: 1.0))"#);
        assert!(found("camera").starts_with("(\n    format"));
    }

    #[test]
    fn bytes_are_converted_to_paths_and_lines() {
        let at = TEXT.find("400.0").unwrap();
        assert_eq!(entry_at(TEXT, at), ("lights[1].emitter.outer_deg".to_owned(), at..at + 5));
        assert_eq!(line_and_column(TEXT, at), (6, 64));
        assert_eq!(offset_of(TEXT, 6, 64), at);
        // In a truncated file, too.
        assert_eq!(entry_at(&TEXT[..at + 2], at + 1).0, "lights[1].emitter.outer_deg");
    }

    #[test]
    fn nesting_is_bounded_and_comments_are_found() {
        assert_eq!(check_nesting(TEXT), Ok(NestingInfo { has_comments: true }));
        let bomb = "(".repeat(1_000_000);
        assert_eq!(check_nesting(&bomb), Err(TooDeep(NESTING_LIMIT)));
    }

    #[test]
    fn every_truncated_text_is_scanned_without_panic() {
        for end in 0..TEXT.len() {
            let cut = &TEXT[..end];
            let _ = (check_nesting(cut), value_at(cut, "lights[1].at[2]"), entry_at(cut, end / 2), entry_at(cut, end));
        }
    }
}

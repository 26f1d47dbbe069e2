//! Parses the lines of an OBJ file, one chunk of the file at a time.

use super::mesh_index::to_index;
use glam::{Vec2, Vec3};

/// Index of a texture coordinate or a normal that a face corner does not have.
pub(super) const NO_INDEX: u32 = u32::MAX;

/// Indices of a face corner's position, texture coordinate and normal, from 0 in the whole file.
pub(super) type CornerIndices = [u32; 3];

/// Names of the three elements in messages.
const ELEMENT_NAMES: [&str; 3] = ["vertex", "texture coordinate", "normal"];

/// A line that applies to all faces after it.
#[derive(Debug)]
pub(super) enum Directive {
    /// Begins a group or an object; the name may be empty.
    Group(String),
    /// Selects a material by its name in the libraries.
    Material(String),
    /// Names a file of materials.
    Library(String),
}

/// The faces of a chunk as triangles, and the directives among them.
#[derive(Debug, Default)]
pub(super) struct Faces {
    pub triangles: Vec<[CornerIndices; 3]>,
    /// Each with the number of triangles before it.
    pub directives: Vec<(usize, Directive)>,
}

/// A mistake in a line.
#[derive(Debug)]
pub(super) struct LineError {
    /// Number of the line in its chunk, from 1.
    pub line: usize,
    pub message: String,
}

/// Splits text into lines, without their ends.
pub(super) fn lines(bytes: &[u8]) -> impl Iterator<Item = &[u8]> {
    let mut rest = bytes;
    std::iter::from_fn(move || {
        let end = memchr::memchr(b'\n', rest).unwrap_or(rest.len());
        let line = (!rest.is_empty()).then_some(&rest[..end]);
        rest = rest.get(end + 1..).unwrap_or_default();
        line
    })
}

/// Numbers of positions, texture coordinates and normals.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(super) struct ElementCounts(pub [u32; 3]);

impl ElementCounts {
    /// Counts the elements that lines define. Face indices may be forward or relative to the face, so the counts must
    /// be known before faces are parsed.
    pub fn of(bytes: &[u8]) -> Self {
        let mut counts = [0; 3];
        for line in lines(bytes) {
            let kind = match *line.trim_ascii_start() {
                [b'v', after, ..] if after.is_ascii_whitespace() => 0,
                [b'v', b't', after, ..] if after.is_ascii_whitespace() => 1,
                [b'v', b'n', after, ..] if after.is_ascii_whitespace() => 2,
                _ => continue,
            };
            counts[kind] += 1;
        }
        ElementCounts(counts)
    }

    pub fn plus(self, more: &ElementCounts) -> Self {
        ElementCounts(std::array::from_fn(|kind| self.0[kind] + more.0[kind]))
    }
}

/// The parsed content of a chunk.
#[derive(Debug, Default)]
pub(super) struct ParsedChunk {
    pub positions: Vec<Vec3>,
    pub uvs: Vec<Vec2>,
    pub normals: Vec<Vec3>,
    pub faces: Faces,
}

impl ParsedChunk {
    /// Parses lines that follow `before` elements in a file with `total` elements.
    pub fn parse(bytes: &[u8], before: ElementCounts, total: ElementCounts) -> Result<Self, LineError> {
        let mut chunk = ParsedChunk::default();
        for (index, line) in lines(bytes).enumerate() {
            chunk
                .parse_line(line.trim_ascii(), &before, &total)
                .map_err(|message| LineError { line: index + 1, message })?;
        }
        Ok(chunk)
    }

    fn parse_line(&mut self, line: &[u8], before: &ElementCounts, total: &ElementCounts) -> Result<(), String> {
        let keyword_end = line.iter().position(u8::is_ascii_whitespace).unwrap_or(line.len());
        let (keyword, rest) = line.split_at(keyword_end);
        let text = || String::from_utf8_lossy(rest.trim_ascii()).into_owned();
        let directive = match keyword {
            b"v" => return position(rest).map(|position| self.positions.push(position)),
            b"vt" => return numbers(rest, "texture coordinate").map(|uv| self.uvs.push(Vec2::from_array(uv))),
            b"vn" => return numbers(rest, "normal").map(|normal| self.normals.push(Vec3::from_array(normal))),
            b"f" => {
                let here = before.plus(&self.counts());
                return self.parse_face(rest, &here, total);
            }
            // Objects are groups.
            b"o" | b"g" => Directive::Group(text()),
            b"mtllib" => Directive::Library(text()),
            b"usemtl" if rest.is_empty() => return Err("it names no material".to_owned()),
            b"usemtl" => Directive::Material(text()),
            // Lines, curves, comments and smoothing groups are skipped.
            _ => return Ok(()),
        };
        self.faces.directives.push((self.faces.triangles.len(), directive));
        Ok(())
    }

    fn counts(&self) -> ElementCounts {
        ElementCounts([self.positions.len(), self.uvs.len(), self.normals.len()].map(to_index))
    }

    /// Triangulates a polygon as a fan. Points and lines have no triangles.
    fn parse_face(&mut self, rest: &[u8], here: &ElementCounts, total: &ElementCounts) -> Result<(), String> {
        let mut corners = words(rest).map(|word| corner(word, here, total));
        let first = corners.next().ok_or("the polygon has no corners")??;
        let Some(mut last) = corners.next().transpose()? else { return Ok(()) };
        for corner in corners {
            let corner = corner?;
            self.faces.triangles.push([first, last, corner]);
            last = corner;
        }
        Ok(())
    }
}

fn words(text: &[u8]) -> impl Iterator<Item = &[u8]> {
    text.split(u8::is_ascii_whitespace).filter(|word| !word.is_empty())
}

/// Parses an integer of at most 18 digits, more than the largest file can need.
fn integer(word: &[u8]) -> Option<i64> {
    let (sign, digits) = match word {
        [b'-', digits @ ..] => (-1, digits),
        [b'+', digits @ ..] => (1, digits),
        digits => (1, digits),
    };
    let usable = (1..=18).contains(&digits.len()) && digits.iter().all(u8::is_ascii_digit);
    usable.then(|| sign * digits.iter().fold(0, |number, digit| 10 * number + i64::from(digit - b'0')))
}

fn number(word: &[u8]) -> Option<f32> {
    std::str::from_utf8(word).ok()?.parse().ok()
}

/// Parses the first N numbers of a line; more may follow.
fn numbers<const N: usize>(rest: &[u8], what: &str) -> Result<[f32; N], String> {
    let mut read = [0.0; N];
    let mut words = words(rest);
    for slot in &mut read {
        let word = words.next().ok_or_else(|| format!("the {what} has fewer than {N} numbers"))?;
        *slot = number(word).ok_or_else(|| format!("the {what}'s {:?} is no number", String::from_utf8_lossy(word)))?;
    }
    Ok(read)
}

/// Parses three coordinates, optionally followed by a homogeneous fourth or by a colour, which is skipped.
fn position(rest: &[u8]) -> Result<Vec3, String> {
    let position = Vec3::from_array(numbers(rest, "position")?);
    let mut more = words(rest).skip(3);
    match (more.next(), more.count()) {
        (None, _) | (Some(_), 2) => Ok(position),
        (Some(w), 0) => match number(w) {
            Some(w) if w != 0.0 => Ok(position / w),
            _ => Err("the position's fourth number must be one, and not 0".to_owned()),
        },
        _ => Err("the position has neither 3, 4 nor 6 numbers".to_owned()),
    }
}

/// Parses a face corner, `v`, `v/vt`, `v//vn` or `v/vt/vn`. Negative indices count back from `here`.
fn corner(word: &[u8], here: &ElementCounts, total: &ElementCounts) -> Result<CornerIndices, String> {
    let wrong = |why: &str| format!("the face's corner {:?} {why}", String::from_utf8_lossy(word));
    if word.starts_with(b"/") {
        return Err(wrong("names no vertex"));
    }
    let mut corner = [NO_INDEX; 3];
    // Reported only if the rest of the corner is well formed.
    let mut missing = None;
    for (kind, text) in word.split(|&byte| byte == b'/').enumerate().filter(|(_, text)| !text.is_empty()) {
        let slot = corner.get_mut(kind).ok_or_else(|| wrong("has too many parts"))?;
        let index = integer(text).ok_or_else(|| wrong("is no index"))?;
        let (here, total) = (i64::from(here.0[kind]), total.0[kind]);
        if index == 0 {
            return Err(wrong("is 0, but indices begin at 1"));
        }
        let zero_based = if index > 0 { index - 1 } else { here + index };
        if zero_based < 0 {
            return Err(wrong("points to before the first"));
        }
        match u32::try_from(zero_based) {
            Ok(zero_based) if zero_based < total => *slot = zero_based,
            _ => missing = Some(format!("the face names {} {index}, but there are {total}", ELEMENT_NAMES[kind])),
        }
    }
    missing.map_or(Ok(corner), Err)
}

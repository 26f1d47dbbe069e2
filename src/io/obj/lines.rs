//! The lines of an OBJ file, one piece of it at a time.

use glam::{Vec2, Vec3};

/// Where a corner has no texture coordinate or no normal.
pub(super) const ABSENT: u32 = u32::MAX;

/// What a corner of a face names: position, texture coordinate and normal, counted from 0 in the whole file.
pub(super) type Corner = [u32; 3];

/// What the numbers of a corner count.
const KINDS: [&str; 3] = ["vertex", "texture coordinate", "normal"];

/// A line that concerns all faces after it.
#[derive(Debug)]
pub(super) enum Mark {
    /// A group or an object begins; the name may be empty.
    Group(String),
    /// A material of one of the libraries.
    Material(String),
    /// A file of materials.
    Library(String),
}

/// The faces of a piece as triangles, and the marks among them.
#[derive(Debug, Default)]
pub(super) struct Faces {
    pub triangles: Vec<[Corner; 3]>,
    /// Each with the number of triangles before it.
    pub marks: Vec<(usize, Mark)>,
}

/// What a line should say, and its number in the piece, from 1.
#[derive(Debug)]
pub(super) struct Mistake {
    pub line: usize,
    pub message: String,
}

/// A run of lines.
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
pub(super) struct Counts(pub [u32; 3]);

impl Counts {
    /// What some lines bring. Faces may name what comes later, or count back from where they stand, so this must be
    /// known before they are read.
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
        Counts(counts)
    }

    pub fn plus(self, more: &Counts) -> Self {
        Counts(std::array::from_fn(|kind| self.0[kind] + more.0[kind]))
    }
}

/// What a run of lines says.
#[derive(Debug, Default)]
pub(super) struct Piece {
    pub positions: Vec<Vec3>,
    pub uvs: Vec<Vec2>,
    pub normals: Vec<Vec3>,
    pub faces: Faces,
}

impl Piece {
    /// Reads lines that follow on what `before` counts, of a file that has `total`.
    pub fn read(bytes: &[u8], before: Counts, total: Counts) -> Result<Self, Mistake> {
        let mut piece = Piece::default();
        for (index, line) in lines(bytes).enumerate() {
            piece
                .read_line(line.trim_ascii(), &before, &total)
                .map_err(|message| Mistake { line: index + 1, message })?;
        }
        Ok(piece)
    }

    fn read_line(&mut self, line: &[u8], before: &Counts, total: &Counts) -> Result<(), String> {
        let keyword_end = line.iter().position(u8::is_ascii_whitespace).unwrap_or(line.len());
        let (keyword, rest) = line.split_at(keyword_end);
        let text = || String::from_utf8_lossy(rest.trim_ascii()).into_owned();
        let mark = match keyword {
            b"v" => return position(rest).map(|position| self.positions.push(position)),
            b"vt" => return numbers(rest, "texture coordinate").map(|uv| self.uvs.push(Vec2::from_array(uv))),
            b"vn" => return numbers(rest, "normal").map(|normal| self.normals.push(Vec3::from_array(normal))),
            b"f" => {
                let here = before.plus(&self.counts());
                return self.read_face(rest, &here, total);
            }
            // Objects and groups are the same to us.
            b"o" | b"g" => Mark::Group(text()),
            b"mtllib" => Mark::Library(text()),
            b"usemtl" if rest.is_empty() => return Err("it names no material".to_owned()),
            b"usemtl" => Mark::Material(text()),
            // Lines, curves, comments, smoothing.
            _ => return Ok(()),
        };
        self.faces.marks.push((self.faces.triangles.len(), mark));
        Ok(())
    }

    fn counts(&self) -> Counts {
        Counts([self.positions.len() as u32, self.uvs.len() as u32, self.normals.len() as u32])
    }

    /// A polygon as a fan of triangles. Points and lines have none.
    fn read_face(&mut self, rest: &[u8], here: &Counts, total: &Counts) -> Result<(), String> {
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

/// A whole number of at most 18 digits, more than the largest file could count.
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

/// The first numbers of a line; more may follow.
fn numbers<const N: usize>(rest: &[u8], what: &str) -> Result<[f32; N], String> {
    let mut read = [0.0; N];
    let mut words = words(rest);
    for slot in &mut read {
        let word = words.next().ok_or_else(|| format!("the {what} has fewer than {N} numbers"))?;
        *slot = number(word).ok_or_else(|| format!("the {what}'s {:?} is no number", String::from_utf8_lossy(word)))?;
    }
    Ok(read)
}

/// Three numbers, and perhaps a fourth to divide them by, or a colour, which is not used.
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

fn corner(word: &[u8], here: &Counts, total: &Counts) -> Result<Corner, String> {
    let wrong = |why: &str| format!("the face's corner {:?} {why}", String::from_utf8_lossy(word));
    if word.starts_with(b"/") {
        return Err(wrong("names no vertex"));
    }
    let mut corner = [ABSENT; 3];
    // Told last: a corner that makes no sense names nothing.
    let mut missing = None;
    for (kind, text) in word.split(|&byte| byte == b'/').enumerate().filter(|(_, text)| !text.is_empty()) {
        let slot = corner.get_mut(kind).ok_or_else(|| wrong("has too many parts"))?;
        let index = integer(text).ok_or_else(|| wrong("is no index"))?;
        let (here, total) = (i64::from(here.0[kind]), i64::from(total.0[kind]));
        if index == 0 {
            return Err(wrong("is 0, but indices begin at 1"));
        }
        let place = if index > 0 { index - 1 } else { here + index };
        if place < 0 {
            return Err(wrong("points to before the first"));
        }
        if place >= total {
            missing = Some(format!("the face names {} {index}, but there are {total}", KINDS[kind]));
        }
        *slot = place as u32;
    }
    missing.map_or(Ok(corner), Err)
}

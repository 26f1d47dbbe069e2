//! The rows of numbers after the header of a PLY file.

use super::header::{Element, Encoding, Property, Scalar};
use crate::io::load_progress::{LoadProgress, PARSING};

/// Rows after which the progress is noted.
const ROWS_PER_LOOK: usize = 1 << 16;

/// What is left of a file.
#[derive(Debug)]
pub struct Body<'a> {
    encoding: Encoding,
    rest: &'a [u8],
    length: usize,
    rows: usize,
    progress: &'a LoadProgress,
}

impl<'a> Body<'a> {
    /// Returns the rows of a file after its header.
    pub fn new(encoding: Encoding, rest: &'a [u8], progress: &'a LoadProgress) -> Self {
        Body { encoding, rest, length: rest.len(), rows: 0, progress }
    }

    /// Returns the number of rows of an element that the rest of the file can hold at most.
    pub fn most_rows(&self, element: &Element) -> usize {
        let smallest = |property: &Property| match self.encoding {
            Encoding::Text => 2,
            Encoding::LittleEndian | Encoding::BigEndian => property.length.unwrap_or(property.value).size(),
        };
        self.rest.len() / element.properties.iter().map(smallest).sum::<usize>().max(1)
    }

    /// Reads a row and passes each value with the index of its property, in single precision.
    ///
    /// # Errors
    /// If the file ends before, or has no number there.
    pub fn row(&mut self, element: &Element, mut take: impl FnMut(usize, f32)) -> Result<(), String> {
        #[allow(clippy::cast_possible_truncation, reason = "coordinates are single precision")]
        self.row_exact(element, |property, value| take(property, value as f32))
    }

    /// As [`Body::row`], with values that hold every index.
    pub fn row_exact(&mut self, element: &Element, mut take: impl FnMut(usize, f64)) -> Result<(), String> {
        if element.properties.is_empty() {
            return Err(format!("the element {:?} has no properties", element.name));
        }
        self.rows += 1;
        if self.rows.is_multiple_of(ROWS_PER_LOOK) {
            let done = self.length - self.rest.len();
            self.progress.reach_between(PARSING, done, self.length).map_err(|error| error.to_string())?;
        }
        for (index, property) in element.properties.iter().enumerate() {
            let Some(length) = property.length else {
                take(index, self.number(property.value)?);
                continue;
            };
            let length = self.number(length)?;
            if !(0.0..=f64::from(u32::MAX)).contains(&length) {
                return Err(format!("a list has the length {length}"));
            }
            // Each value takes a byte of the file at least, which ends a list that is too long
            let mut left = length;
            while left >= 1.0 {
                take(index, self.number(property.value)?);
                left -= 1.0;
            }
        }
        Ok(())
    }

    /// Reads a number.
    fn number(&mut self, kind: Scalar) -> Result<f64, String> {
        let is_big = match self.encoding {
            Encoding::Text => return self.word(),
            Encoding::LittleEndian => false,
            Encoding::BigEndian => true,
        };
        let (bytes, rest) = self.rest.split_at_checked(kind.size()).ok_or("it is cut off")?;
        self.rest = rest;
        let mut ordered = [0; 8];
        ordered[..bytes.len()].copy_from_slice(bytes);
        if is_big {
            ordered[..bytes.len()].reverse();
        }
        let [a, b, c, d, ..] = ordered;
        Ok(match kind {
            Scalar::I8 => f64::from(i8::from_le_bytes([a])),
            Scalar::U8 => f64::from(a),
            Scalar::I16 => f64::from(i16::from_le_bytes([a, b])),
            Scalar::U16 => f64::from(u16::from_le_bytes([a, b])),
            Scalar::I32 => f64::from(i32::from_le_bytes([a, b, c, d])),
            Scalar::U32 => f64::from(u32::from_le_bytes([a, b, c, d])),
            Scalar::F32 => f64::from(f32::from_le_bytes([a, b, c, d])),
            Scalar::F64 => f64::from_le_bytes(ordered),
        })
    }

    /// Reads a number of a text.
    fn word(&mut self) -> Result<f64, String> {
        let start = self.rest.trim_ascii_start();
        let end = start.iter().position(u8::is_ascii_whitespace).unwrap_or(start.len());
        let (word, rest) = start.split_at(end);
        self.rest = rest;
        if word.is_empty() {
            return Err("it is cut off".to_owned());
        }
        let number = std::str::from_utf8(word).ok().and_then(|word| word.parse().ok());
        number.ok_or_else(|| format!("{:?} is no number", String::from_utf8_lossy(word)))
    }
}

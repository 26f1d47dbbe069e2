//! Parses an OBJ file on all cores: chunks of whole lines in parallel, joined in file order.

use super::lines::{ElementCounts, Faces, LineError, ParsedChunk, lines};
use crate::io::error::AssetError;
use crate::io::load_progress::{LoadProgress, PARSING};
use glam::{Vec2, Vec3};
use rayon::prelude::*;
use std::sync::atomic::{AtomicUsize, Ordering};

/// Bytes of a chunk: parsing it takes much longer than joining it.
const CHUNK_BYTES: usize = 1 << 20;

/// Largest file, bytes. Elements take two bytes or more, and a corner of a polygon, two bytes, at most three corners of
/// triangles: their numbers and indices fit 32 bits.
pub(super) const FILE_LIMIT_BYTES: usize = 1 << 31;

/// The parsed content of a file.
#[derive(Debug, Default)]
pub(super) struct Elements {
    pub positions: Vec<Vec3>,
    pub uvs: Vec<Vec2>,
    pub normals: Vec<Vec3>,
    /// By chunk, in file order. Every index is in range.
    pub faces: Vec<Faces>,
}

/// The reason why a file can't be used.
#[derive(Debug)]
pub(super) enum ReadError {
    /// More bytes than [`FILE_LIMIT_BYTES`].
    TooLarge(usize),
    /// A mistake in a line, with the line's number.
    BadLine(String),
    /// More triangles than the limit; at least this number.
    TooManyTriangles(usize),
    /// The import was cancelled.
    Cancelled(AssetError),
}

/// Parses a whole file. Of several mistakes the first in the file is reported.
pub(super) fn parse(bytes: &[u8], triangle_limit: usize, progress: &LoadProgress) -> Result<Elements, ReadError> {
    if bytes.len() > FILE_LIMIT_BYTES {
        return Err(ReadError::TooLarge(bytes.len()));
    }
    let chunks = split(bytes, CHUNK_BYTES);
    let counts: Vec<ElementCounts> = chunks.par_iter().map(|chunk| ElementCounts::of(chunk)).collect();
    let mut total = ElementCounts::default();
    let mut starts = Vec::with_capacity(chunks.len());
    for count in &counts {
        starts.push(total);
        total = total.plus(count);
    }
    let (triangles, parsed) = (AtomicUsize::new(0), AtomicUsize::new(0));
    let parse_chunk = |(bytes, before): (&&[u8], ElementCounts)| {
        // A file over the limit is refused, whatever the rest of it says.
        if triangles.load(Ordering::Relaxed) > triangle_limit || progress.is_cancelled() {
            return Ok(ParsedChunk::default());
        }
        let chunk = ParsedChunk::parse(bytes, before, total)?;
        triangles.fetch_add(chunk.faces.triangles.len(), Ordering::Relaxed);
        // Whether it is cancelled counts after all chunks
        let _ = progress.reach_between(PARSING, parsed.fetch_add(1, Ordering::Relaxed), chunks.len());
        Ok(chunk)
    };
    let results: Vec<Result<ParsedChunk, LineError>> = chunks.par_iter().zip(starts).map(parse_chunk).collect();
    progress.reach(PARSING[1]).map_err(ReadError::Cancelled)?;
    let triangles = triangles.into_inner();
    if triangles > triangle_limit {
        return Err(ReadError::TooManyTriangles(triangles));
    }
    let mut elements = Elements::with_capacity(&total);
    for (index, chunk) in results.into_iter().enumerate() {
        let chunk = chunk.map_err(|error| {
            let line = error.line + chunks[..index].iter().map(|chunk| lines(chunk).count()).sum::<usize>();
            ReadError::BadLine(format!("line {line}: {}", error.message))
        })?;
        elements.positions.extend(chunk.positions);
        elements.uvs.extend(chunk.uvs);
        elements.normals.extend(chunk.normals);
        elements.faces.push(chunk.faces);
    }
    Ok(elements)
}

impl Elements {
    fn with_capacity(total: &ElementCounts) -> Self {
        let [positions, uvs, normals] = total.0.map(|count| count as usize);
        Elements {
            positions: Vec::with_capacity(positions),
            uvs: Vec::with_capacity(uvs),
            normals: Vec::with_capacity(normals),
            faces: Vec::new(),
        }
    }
}

/// Splits text into chunks of `size` bytes, each extended to the end of its last line.
fn split(bytes: &[u8], size: usize) -> Vec<&[u8]> {
    let (mut chunks, mut rest) = (Vec::new(), bytes);
    while !rest.is_empty() {
        let least = size.min(rest.len());
        let end = memchr::memchr(b'\n', &rest[least..]).map_or(rest.len(), |at| least + at + 1);
        let (chunk, behind) = rest.split_at(end);
        chunks.push(chunk);
        rest = behind;
    }
    chunks
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn chunks_are_whole_lines_and_cover_the_file() {
        let text = b"v 1 2 3\nv 4 5 6\n\n\nf 1 2 3\nlast";
        for size in 1..40 {
            let chunks = split(text, size);
            assert_eq!(chunks.concat(), text, "{size}");
            assert!(chunks[..chunks.len() - 1].iter().all(|chunk| chunk.ends_with(b"\n") && chunk.len() > size));
        }
    }
}

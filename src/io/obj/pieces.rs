//! Reads an OBJ file on all cores: it is cut at line ends, and its pieces are read side by side and joined.

use super::lines::{Counts, Faces, Mistake, Piece, lines};
use glam::{Vec2, Vec3};
use rayon::prelude::*;
use std::sync::atomic::{AtomicUsize, Ordering};

/// Bytes of a piece: to read it takes much longer than to join it.
const PIECE_BYTES: usize = 1 << 20;

/// All that a file says.
#[derive(Debug, Default)]
pub(super) struct Elements {
    pub positions: Vec<Vec3>,
    pub uvs: Vec<Vec2>,
    pub normals: Vec<Vec3>,
    /// In the order of the file. Every index is within its list.
    pub faces: Vec<Faces>,
}

/// Why a file can't be used.
#[derive(Debug)]
pub(super) enum Fault {
    /// A mistake, with its line.
    Mistake(String),
    /// At least so many triangles, more than the limit.
    TooManyTriangles(usize),
}

/// Reads a whole file. Of several mistakes the first in the file is told.
pub(super) fn read(bytes: &[u8], triangle_limit: usize) -> Result<Elements, Fault> {
    let pieces = cut(bytes, PIECE_BYTES);
    let counts: Vec<Counts> = pieces.par_iter().map(|piece| Counts::of(piece)).collect();
    let mut total = Counts::default();
    let mut starts = Vec::with_capacity(pieces.len());
    for count in &counts {
        starts.push(total);
        total = total.plus(count);
    }
    let made = AtomicUsize::new(0);
    let read_piece = |(bytes, before): (&&[u8], Counts)| {
        // Over the limit the file is refused, whatever else it says.
        if made.load(Ordering::Relaxed) > triangle_limit {
            return Ok(Piece::default());
        }
        let piece = Piece::read(bytes, before, total)?;
        made.fetch_add(piece.faces.triangles.len(), Ordering::Relaxed);
        Ok(piece)
    };
    let read: Vec<Result<Piece, Mistake>> = pieces.par_iter().zip(starts).map(read_piece).collect();
    let made = made.into_inner();
    if made > triangle_limit {
        return Err(Fault::TooManyTriangles(made));
    }
    let mut elements = Elements::with_room(&total);
    for (index, piece) in read.into_iter().enumerate() {
        let piece = piece.map_err(|mistake| {
            let line = mistake.line + pieces[..index].iter().map(|piece| lines(piece).count()).sum::<usize>();
            Fault::Mistake(format!("line {line}: {}", mistake.message))
        })?;
        elements.positions.extend(piece.positions);
        elements.uvs.extend(piece.uvs);
        elements.normals.extend(piece.normals);
        elements.faces.push(piece.faces);
    }
    Ok(elements)
}

impl Elements {
    fn with_room(total: &Counts) -> Self {
        let [positions, uvs, normals] = total.0.map(|count| count as usize);
        Elements {
            positions: Vec::with_capacity(positions),
            uvs: Vec::with_capacity(uvs),
            normals: Vec::with_capacity(normals),
            faces: Vec::new(),
        }
    }
}

/// Runs of whole lines, of `size` bytes and what is left of the last line.
fn cut(bytes: &[u8], size: usize) -> Vec<&[u8]> {
    let (mut pieces, mut rest) = (Vec::new(), bytes);
    while !rest.is_empty() {
        let least = size.min(rest.len());
        let end = memchr::memchr(b'\n', &rest[least..]).map_or(rest.len(), |at| least + at + 1);
        let (piece, behind) = rest.split_at(end);
        pieces.push(piece);
        rest = behind;
    }
    pieces
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn pieces_are_whole_lines_and_all_of_the_file() {
        let text = b"v 1 2 3\nv 4 5 6\n\n\nf 1 2 3\nlast";
        for size in 1..40 {
            let pieces = cut(text, size);
            assert_eq!(pieces.concat(), text, "{size}");
            assert!(pieces[..pieces.len() - 1].iter().all(|piece| piece.ends_with(b"\n") && piece.len() > size));
        }
    }
}

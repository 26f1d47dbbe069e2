//! The file format of the body data: little-endian tables, deflated (zlib) in pieces that are inflated in parallel.
//!
//! A file is a magic number, the size of the tables, the packed size of each piece, and the pieces.
//!
//! Positions and offsets are integers of 0.01 mm and 0.1 mm, the resolution of the source. Offsets of a symmetric target
//! are stored for one side. Each table of numbers is stored as differences, low bytes before high bytes, which deflate
//! to half the size.

use super::body_data::{BodyData, Bone, Mask, QuadGroup, Target};
use flate2::Compression;
use flate2::read::ZlibDecoder;
use flate2::write::ZlibEncoder;
use glam::{Vec2, Vec3};
use rayon::prelude::*;
use std::collections::{BTreeMap, HashMap};
use std::io::{Read, Write};
use std::sync::LazyLock;

const MAGIC: &[u8; 8] = b"CLBODY02";
/// Upper bound of the size of the tables, bytes: those of the shipped file have a quarter of it.
const MAX_SIZE: usize = 64 << 20;
/// Size of the part of the tables in a piece, bytes; the last piece has less.
const PIECE: usize = 1 << 20;
/// Length of a unit of the base mesh's positions, metres.
const POSITION_UNIT: f32 = 1e-5;
/// Length of a unit of the targets' offsets, metres.
const OFFSET_UNIT: f32 = 1e-4;
/// A unit of texture coordinates.
const UV_UNIT: f32 = 1e-5;
/// Bytes of a number of a column.
const BYTES_OF_A_NUMBER: usize = 4;

/// A file of body data that can't be read.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
pub enum BodyDataError {
    /// Another format, or another version of it.
    #[error("not a figure file of this version")]
    Format,
    /// The compressed stream is damaged.
    #[error("the compressed data are damaged")]
    Stream,
    /// The file ends too early.
    #[error("the file ends before its data do")]
    End,
    /// A table refers to an entry that does not exist.
    #[error("{0} refers to an entry that does not exist")]
    Reference(&'static str),
}

impl BodyData {
    /// Returns the body data that the program ships.
    pub fn shipped() -> &'static BodyData {
        static SHIPPED: LazyLock<BodyData> = LazyLock::new(|| {
            let bytes = include_bytes!("../../assets/figures/body.bin");
            BodyData::decode(bytes).unwrap_or_else(|error| {
                // A test decodes the file, so that a damaged one is never shipped.
                log::error!("the shipped figures can't be read: {error}");
                BodyData::default()
            })
        });
        &SHIPPED
    }

    /// Decodes a file.
    ///
    /// # Errors
    /// If it is damaged or of another format; every index is checked.
    pub fn decode(bytes: &[u8]) -> Result<BodyData, BodyDataError> {
        let data = Decoder { rest: &inflate(bytes)? }.body()?;
        data.check()?;
        Ok(data)
    }

    /// Checks that every index refers to an entry and that parents precede their children.
    fn check(&self) -> Result<(), BodyDataError> {
        let count = self.positions.len();
        let is_vertex = |v: u16| usize::from(v) < count;
        let error = |condition: bool, table| if condition { Ok(()) } else { Err(BodyDataError::Reference(table)) };
        error(self.mirror.len() == count && self.mirror.iter().all(|&v| is_vertex(v)), "the mirror table")?;
        error(self.groups.iter().flat_map(|g| &g.quads).flatten().all(|&v| is_vertex(v)), "a quad")?;
        let is_uv = |uv: &u16| usize::from(*uv) < self.uvs.len();
        error(self.groups.iter().flat_map(|g| &g.uvs).flatten().all(is_uv), "a corner")?;
        error(self.targets.values().flat_map(|t| &t.offsets).all(|(v, _)| is_vertex(*v)), "a target")?;
        let bones = self.bones.len();
        let is_bone = |(index, bone): (usize, &Bone)| {
            bone.parent.is_none_or(|p| usize::from(p) < index) && is_vertex(bone.head) && is_vertex(bone.tail)
        };
        error(self.bones.iter().enumerate().all(is_bone), "a bone")?;
        let is_weight = |(bone, weight): &(u8, u8)| *weight == 0 || usize::from(*bone) < bones;
        error(self.weights.len() == count && self.weights.iter().flatten().all(is_weight), "a weight")
    }
}

impl BodyData {
    /// Encodes the data as a file. Equal data make equal files.
    pub fn encode(&self) -> Vec<u8> {
        let mut out = Encoder(Vec::new());
        out.count(self.positions.len());
        for axis in 0..3 {
            out.column(self.positions.iter().map(|p| (p[axis] / POSITION_UNIT).round() as i32));
        }
        out.column(self.mirror.iter().map(|&v| v.into()));
        out.count(self.uvs.len());
        for axis in 0..2 {
            out.column(self.uvs.iter().map(|uv| (uv[axis] / UV_UNIT).round() as i32));
        }
        // Groups of quads
        out.count(self.groups.len());
        for group in &self.groups {
            out.text(&group.name);
            out.count(group.quads.len());
            out.column(group.quads.iter().flatten().map(|&v| v.into()));
            out.column(group.uvs.iter().flatten().map(|&uv| uv.into()));
        }
        // Targets, by name
        let targets: BTreeMap<_, _> = self.targets.iter().collect();
        out.count(targets.len());
        for (name, target) in targets {
            out.text(name);
            self.encode_target(target, &mut out);
        }
        // Bones and weights
        out.count(self.bones.len());
        for bone in &self.bones {
            out.text(&bone.name);
            out.column([bone.parent.map_or(-1, i32::from), bone.head.into(), bone.tail.into()].into_iter());
        }
        for slot in 0..4 {
            out.column(self.weights.iter().map(|w| w[slot].0.into()));
            out.column(self.weights.iter().map(|w| w[slot].1.into()));
        }
        // Masks, by name
        let masks: BTreeMap<_, _> = self.masks.iter().collect();
        out.count(masks.len());
        for (name, mask) in masks {
            out.text(name);
            out.count(mask.size);
            out.0.extend(&mask.values);
        }
        out.deflate()
    }

    fn encode_target(&self, target: &Target, out: &mut Encoder) {
        let units = |offset: Vec3| offset.to_array().map(|x| (x / OFFSET_UNIT).round() as i32);
        let all: Vec<(u16, [i32; 3])> = target.offsets.iter().map(|&(v, o)| (v, units(o))).collect();
        let one_side: Vec<_> = all.iter().copied().filter(|(v, _)| *v <= self.mirror[usize::from(*v)]).collect();
        let is_symmetric = mirrored(one_side.clone(), &self.mirror) == all;
        let stored = if is_symmetric { &one_side } else { &all };
        out.count(usize::from(is_symmetric));
        out.count(stored.len());
        out.column(stored.iter().map(|(v, _)| (*v).into()));
        for axis in 0..3 {
            out.column(stored.iter().map(|(_, o)| o[axis]));
        }
    }
}

/// Returns the offsets of one side together with those of the other, by vertex.
fn mirrored(one_side: Vec<(u16, [i32; 3])>, mirror: &[u16]) -> Vec<(u16, [i32; 3])> {
    let other_side = |&(vertex, [x, y, z]): &(u16, [i32; 3])| {
        let other = mirror.get(usize::from(vertex)).copied().filter(|other| *other != vertex);
        other.map(|other| (other, [-x, y, z]))
    };
    let others: Vec<_> = one_side.iter().filter_map(other_side).collect();
    let mut both = one_side;
    both.extend(others);
    // The one side is in order, and the other one in long runs: this sort merges them
    both.sort_by_key(|(vertex, _)| *vertex);
    both
}

/// The tables of a file while it is written.
struct Encoder(Vec<u8>);

impl Encoder {
    fn count(&mut self, count: usize) {
        self.0.extend((count as u32).to_le_bytes());
    }

    fn text(&mut self, text: &str) {
        self.count(text.len());
        self.0.extend(text.as_bytes());
    }

    /// Appends a column of integers: their differences, byte plane by byte plane.
    fn column(&mut self, values: impl Iterator<Item = i32>) {
        let mut last = 0;
        let differences: Vec<[u8; 4]> = values
            .map(|value| {
                let difference: i32 = value.wrapping_sub(last);
                last = value;
                // Zigzag: small numbers of either sign have high bytes of 0.
                ((difference << 1) ^ (difference >> 31)).to_le_bytes()
            })
            .collect();
        for plane in 0..4 {
            self.0.extend(differences.iter().map(|bytes| bytes[plane]));
        }
    }

    /// Returns the file of the tables.
    fn deflate(self) -> Vec<u8> {
        let packed = |part: &[u8]| {
            let mut encoder = ZlibEncoder::new(Vec::new(), Compression::best());
            // Writing to memory does not fail.
            let written = encoder.write_all(part).and_then(|()| encoder.finish());
            debug_assert!(written.is_ok());
            written.unwrap_or_default()
        };
        let pieces: Vec<Vec<u8>> = self.0.par_chunks(PIECE).map(packed).collect();
        let mut file = Encoder(MAGIC.to_vec());
        file.count(self.0.len());
        pieces.iter().for_each(|piece| file.count(piece.len()));
        file.0.extend(pieces.concat());
        file.0
    }
}

/// Returns the tables of a file.
fn inflate(file: &[u8]) -> Result<Vec<u8>, BodyDataError> {
    let mut header = Decoder { rest: file.strip_prefix(MAGIC).ok_or(BodyDataError::Format)? };
    let size = header.count()?;
    if size > MAX_SIZE {
        return Err(BodyDataError::Stream);
    }
    let sizes = (0..size.div_ceil(PIECE)).map(|_| header.count()).collect::<Result<Vec<_>, _>>()?;
    let pieces = sizes.into_iter().map(|size| header.take(size)).collect::<Result<Vec<_>, _>>()?;
    let mut tables = vec![0; size];
    tables.par_chunks_mut(PIECE).zip(pieces).try_for_each(|(part, piece)| {
        let mut decoder = ZlibDecoder::new(piece);
        // The checksum is compared where the piece ends
        let rest = decoder.read_exact(part).and_then(|()| decoder.read(&mut [0]));
        if matches!(rest, Ok(0)) { Ok(()) } else { Err(BodyDataError::Stream) }
    })?;
    Ok(tables)
}

/// The columns of a target in a file.
struct StoredTarget<'a> {
    /// Whether only the offsets of one side are stored.
    is_symmetric: bool,
    count: usize,
    columns: Decoder<'a>,
}

impl StoredTarget<'_> {
    /// Returns the target with the offsets of both sides, metres.
    fn whole(mut self, mirror: &[u16]) -> Result<Target, BodyDataError> {
        let vertices = self.columns.indices(self.count)?;
        let [x, y, z] = self.columns.columns(self.count)?;
        let stored = (0..self.count).map(|i| (vertices[i], [x[i], y[i], z[i]])).collect();
        let all = if self.is_symmetric { mirrored(stored, mirror) } else { stored };
        Ok(Target { offsets: all.into_iter().map(|(v, o)| (v, metres(o, OFFSET_UNIT))).collect() })
    }
}

/// The tables of a file while they are read: those that are still to be read.
#[derive(Clone, Copy)]
struct Decoder<'a> {
    rest: &'a [u8],
}

impl<'a> Decoder<'a> {
    /// Reads all tables. Indices are not checked.
    fn body(mut self) -> Result<BodyData, BodyDataError> {
        let count = self.count()?;
        let [x, y, z] = self.columns(count)?;
        let positions = (0..count).map(|i| metres([x[i], y[i], z[i]], POSITION_UNIT)).collect();
        let mirror = self.indices(count)?;
        let uv_count = self.count()?;
        let [u, v] = self.columns(uv_count)?;
        let uvs = u.into_iter().zip(v).map(|(u, v)| Vec2::new(u as f32, v as f32) * UV_UNIT).collect();
        let mut groups = Vec::new();
        for _ in 0..self.count()? {
            let name = self.text()?;
            let count = self.count()?;
            groups.push(QuadGroup { name, quads: self.corners(count)?, uvs: self.corners(count)? });
        }
        let mut targets = Vec::new();
        for _ in 0..self.count()? {
            targets.push((self.text()?, self.target()?));
        }
        let whole = |(name, target): (String, StoredTarget)| Ok((name, target.whole(&mirror)?));
        let targets = targets.into_par_iter().map(whole).collect::<Result<_, _>>()?;
        let mut bones = Vec::new();
        for _ in 0..self.count()? {
            let name = self.text()?;
            let fields = self.column(3)?;
            bones.push(Bone {
                name,
                parent: (fields[0] >= 0).then_some(fields[0] as u8),
                head: fields[1] as u16,
                tail: fields[2] as u16,
            });
        }
        let mut weights = vec![[(0, 0); 4]; count];
        for slot in 0..4 {
            let (bones, shares) = (self.column(count)?, self.column(count)?);
            for (of_vertex, (bone, share)) in weights.iter_mut().zip(bones.into_iter().zip(shares)) {
                of_vertex[slot] = (bone as u8, share as u8);
            }
        }
        let mut masks = HashMap::new();
        for _ in 0..self.count()? {
            let name = self.text()?;
            let size = self.count()?;
            let values = self.take(size.checked_mul(size).ok_or(BodyDataError::End)?)?.to_vec();
            masks.insert(name, Mask { size, values });
        }
        Ok(BodyData { positions, uvs, mirror, groups, targets, bones, weights, masks })
    }

    /// Finds the columns of a target, without reading them.
    fn target(&mut self) -> Result<StoredTarget<'a>, BodyDataError> {
        let is_symmetric = self.count()? == 1;
        let count = self.count()?;
        let columns = self.take(count.checked_mul(4 * BYTES_OF_A_NUMBER).ok_or(BodyDataError::End)?)?;
        Ok(StoredTarget { is_symmetric, count, columns: Decoder { rest: columns } })
    }

    fn take(&mut self, count: usize) -> Result<&'a [u8], BodyDataError> {
        self.rest.split_off(..count).ok_or(BodyDataError::End)
    }

    fn count(&mut self) -> Result<usize, BodyDataError> {
        let bytes = self.take(4)?.try_into().map_err(|_| BodyDataError::End)?;
        Ok(u32::from_le_bytes(bytes) as usize)
    }

    fn text(&mut self) -> Result<String, BodyDataError> {
        let length = self.count()?;
        Ok(String::from_utf8_lossy(self.take(length)?).into_owned())
    }

    fn column(&mut self, count: usize) -> Result<Vec<i32>, BodyDataError> {
        let planes = self.take(count.checked_mul(BYTES_OF_A_NUMBER).ok_or(BodyDataError::End)?)?;
        let mut value = 0_i32;
        let decode = |i: usize| {
            let zigzag = u32::from_le_bytes([0, 1, 2, 3].map(|plane| planes[plane * count + i]));
            let difference = (zigzag >> 1) as i32 ^ -((zigzag & 1) as i32);
            value = value.wrapping_add(difference);
            value
        };
        Ok((0..count).map(decode).collect())
    }

    fn columns<const N: usize>(&mut self, count: usize) -> Result<[Vec<i32>; N], BodyDataError> {
        let mut columns = [const { Vec::new() }; N];
        for column in &mut columns {
            *column = self.column(count)?;
        }
        Ok(columns)
    }

    fn corners(&mut self, quads: usize) -> Result<Vec<[u16; 4]>, BodyDataError> {
        let corners = self.indices(quads.checked_mul(4).ok_or(BodyDataError::End)?)?;
        Ok(corners.chunks_exact(4).map(|c| [c[0], c[1], c[2], c[3]]).collect())
    }

    fn indices(&mut self, count: usize) -> Result<Vec<u16>, BodyDataError> {
        Ok(self.column(count)?.into_iter().map(|v| v as u16).collect())
    }
}

fn metres(units: [i32; 3], unit: f32) -> Vec3 {
    Vec3::from(units.map(|x| x as f32 * unit))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_shipped_file_holds_a_whole_body() {
        let data = BodyData::decode(include_bytes!("../../assets/figures/body.bin")).unwrap();
        assert_eq!(data.quads("body").len(), 13_378);
        assert!(data.targets.len() > 150 && data.bones.len() > 50);
        // Weights of every vertex sum to one.
        for (vertex, weights) in data.weights.iter().enumerate() {
            assert_eq!(weights.iter().map(|(_, w)| u32::from(*w)).sum::<u32>(), 255, "vertex {vertex}");
        }
        // Mirrored vertices lie on the other side.
        for (vertex, &other) in data.mirror.iter().enumerate() {
            let (here, there) = (data.positions[vertex], data.positions[usize::from(other)]);
            assert!((here * Vec3::new(-1.0, 1.0, 1.0)).distance(there) < 0.002, "vertex {vertex}");
        }
    }

    #[test]
    fn a_damaged_figure_file_is_refused() {
        let good = include_bytes!("../../assets/figures/body.bin");
        assert_eq!(BodyData::decode(b"solid"), Err(BodyDataError::Format));
        assert_eq!(BodyData::decode(&good[..good.len() / 2]), Err(BodyDataError::End));
        // A byte in the middle of a piece, in its checksum, and in the size of the tables
        for at in [good.len() / 2, good.len() - 1, MAGIC.len() + 3] {
            let mut damaged = good.to_vec();
            damaged[at] ^= 0x40;
            assert_eq!(BodyData::decode(&damaged), Err(BodyDataError::Stream), "byte {at}");
        }
        let mut data = BodyData::decode(good).unwrap();
        data.groups[0].quads[7][2] = u16::MAX;
        assert_eq!(BodyData::decode(&data.encode()), Err(BodyDataError::Reference("a quad")));
        data.groups.clear();
        data.bones[3].parent = Some(9);
        assert_eq!(BodyData::decode(&data.encode()), Err(BodyDataError::Reference("a bone")));
    }

    #[test]
    fn encoding_and_decoding_keeps_every_bit() {
        let good = include_bytes!("../../assets/figures/body.bin");
        let data = BodyData::decode(good).unwrap();
        assert_eq!(BodyData::decode(&data.encode()).unwrap(), data);
        assert_eq!(data.encode(), good, "the same data make the same file");
    }
}

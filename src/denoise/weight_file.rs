//! Weights of the network, in the TZA format of Intel Open Image Denoise (version 2): a header, the values, and a table
//! of named tensors at the end.
//!
//! All numbers are little-endian. Header: `0x41D7` (16 bits), major and minor version (8 bits each), offset of the table
//! (64 bits). Table: number of tensors (32 bits); of each the length of its name (16 bits), the name, the number of
//! dimensions (8 bits), the dimensions (32 bits each), a letter a dimension for the layout (`oihw`: output, input, height,
//! width; `x`: one dimension), a letter for the type (`h`: half precision), offset of the values (64 bits).

use std::collections::HashMap;
use thiserror::Error;

const MAGIC: u16 = 0x41D7;
const MAJOR_VERSION: u8 = 2;

/// A fault of a file of weights.
#[derive(Clone, Debug, PartialEq, Eq, Error)]
pub enum WeightError {
    /// It is no TZA file of a known version.
    #[error("the denoiser's weights are no TZA file of version {MAJOR_VERSION}")]
    Format,
    /// It ends early, or its table points beyond its end.
    #[error("the denoiser's weights are truncated")]
    Truncated,
    /// A tensor is stored in another way than those of the network.
    #[error("the denoiser's weights `{0}` have an unknown layout")]
    Layout(String),
    /// A value is infinite or no number.
    #[error("the denoiser's weights `{0}` are not finite")]
    NotFinite(String),
    /// A tensor that the network needs is not there.
    #[error("the denoiser's weights `{0}` are missing")]
    Missing(String),
    /// A tensor has other dimensions than the network.
    #[error("the denoiser's weights `{0}` have the shape {1:?}")]
    Shape(String, Vec<usize>),
}

/// A tensor of weights.
#[derive(Clone, Debug, PartialEq)]
pub struct Weights {
    /// Dimensions, the slowest first.
    pub shape: Vec<usize>,
    /// The values.
    pub values: Vec<f32>,
}

/// The tensors of a file, by name.
#[derive(Debug)]
pub struct WeightFile {
    tensors: HashMap<String, Weights>,
}

/// The part of a file that is still to be read.
struct Cursor<'a>(&'a [u8]);

impl<'a> Cursor<'a> {
    fn bytes(&mut self, count: usize) -> Result<&'a [u8], WeightError> {
        let (taken, rest) = self.0.split_at_checked(count).ok_or(WeightError::Truncated)?;
        self.0 = rest;
        Ok(taken)
    }

    fn number<const N: usize>(&mut self) -> Result<usize, WeightError> {
        let mut wide = [0; 8];
        wide[..N].copy_from_slice(self.bytes(N)?);
        usize::try_from(u64::from_le_bytes(wide)).map_err(|_| WeightError::Truncated)
    }

    fn text(&mut self, length: usize) -> Result<String, WeightError> {
        String::from_utf8(self.bytes(length)?.to_vec()).map_err(|_| WeightError::Format)
    }
}

impl WeightFile {
    /// Reads a file.
    ///
    /// # Errors
    /// If it is damaged.
    pub fn parse(file: &[u8]) -> Result<Self, WeightError> {
        let mut header = Cursor(file);
        if header.number::<2>()? != usize::from(MAGIC) || header.number::<1>()? != usize::from(MAJOR_VERSION) {
            return Err(WeightError::Format);
        }
        let _minor_version = header.number::<1>()?;
        let mut table = Cursor(file.get(header.number::<8>()?..).ok_or(WeightError::Truncated)?);
        let count = table.number::<4>()?;
        let tensors = (0..count).map(|_| read_tensor(file, &mut table)).collect::<Result<_, _>>()?;
        Ok(WeightFile { tensors })
    }

    /// Returns a tensor of a number of dimensions.
    ///
    /// # Errors
    /// If it is missing or has another number of dimensions.
    pub fn tensor<const DIMENSIONS: usize>(&self, name: &str) -> Result<([usize; DIMENSIONS], &[f32]), WeightError> {
        let tensor = self.tensors.get(name).ok_or_else(|| WeightError::Missing(name.to_owned()))?;
        let shape = tensor.shape.as_slice().try_into();
        let shape = shape.map_err(|_| WeightError::Shape(name.to_owned(), tensor.shape.clone()))?;
        Ok((shape, &tensor.values))
    }
}

/// Reads the next entry of the table, and the values that it points to.
fn read_tensor(file: &[u8], table: &mut Cursor<'_>) -> Result<(String, Weights), WeightError> {
    let length = table.number::<2>()?;
    let name = table.text(length)?;
    let dimensions = table.number::<1>()?;
    let shape = (0..dimensions).map(|_| table.number::<4>()).collect::<Result<Vec<_>, _>>()?;
    let layout = table.text(dimensions)?;
    let kind = table.text(1)?;
    if !matches!(layout.as_str(), "oihw" | "x") || kind != "h" {
        return Err(WeightError::Layout(name));
    }
    let count = shape.iter().try_fold(1_usize, |product, side| product.checked_mul(*side));
    let bytes = count.and_then(|count| count.checked_mul(2)).ok_or(WeightError::Truncated)?;
    let start = file.get(table.number::<8>()?..).ok_or(WeightError::Truncated)?;
    let halves = Cursor(start).bytes(bytes)?.as_chunks::<2>().0;
    let values: Vec<f32> = halves.iter().map(|half| f32_from_half(u16::from_le_bytes(*half))).collect();
    if values.iter().any(|value| !value.is_finite()) {
        return Err(WeightError::NotFinite(name));
    }
    Ok((name, Weights { shape, values }))
}

/// Converts a number of half precision (IEEE 754 binary16), which f32 represents without rounding.
fn f32_from_half(bits: u16) -> f32 {
    const MANTISSA_BITS: u32 = 10;
    let sign = if bits >> 15 == 0 { 1.0 } else { -1.0 };
    let exponent = i32::from(bits >> MANTISSA_BITS & 0x1F);
    let mantissa = f32::from(bits & 0x3FF);
    let unit = f32::powi(2.0, -24);
    match exponent {
        0 => sign * mantissa * unit,
        0x1F if mantissa == 0.0 => sign * f32::INFINITY,
        0x1F => f32::NAN,
        _ => sign * (1024.0 + mantissa) * unit * f32::powi(2.0, exponent - 1),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_of_half_precision_are_converted_without_rounding() {
        // IEEE 754-2019, table 3.5: 1, -2, the largest, the smallest normal and subnormal number.
        let known = [(0x3C00, 1.0), (0xC000, -2.0), (0x7BFF, 65504.0), (0x0400, 6.103_515_6e-5), (1, 5.960_464_5e-8)];
        known.iter().for_each(|(bits, value)| assert_eq!(f32_from_half(*bits), *value));
        assert_eq!(f32_from_half(0x8000).to_bits(), (-0.0_f32).to_bits());
        assert_eq!(f32_from_half(0x3555), 0.333_251_95, "the nearest to 1/3");
        assert!(f32_from_half(0x7C00).is_infinite() && f32_from_half(0x7E00).is_nan());
    }

    /// Returns a file with one tensor `a` of two values.
    fn small_file(values: [u16; 2]) -> Vec<u8> {
        let mut file = vec![0xD7, 0x41, 2, 0];
        file.extend(16_u64.to_le_bytes());
        file.extend(values.iter().flat_map(|half| half.to_le_bytes()));
        file.extend(1_u32.to_le_bytes());
        file.extend([1, 0, b'a', 1, 2, 0, 0, 0, b'x', b'h']);
        file.extend(12_u64.to_le_bytes());
        file
    }

    #[test]
    fn tensors_are_found_by_name() {
        let file = WeightFile::parse(&small_file([0x3C00, 0xC000])).unwrap();
        assert_eq!(file.tensor::<1>("a"), Ok(([2], [1.0, -2.0].as_slice())));
        assert_eq!(file.tensor::<1>("b"), Err(WeightError::Missing("b".to_owned())));
        assert_eq!(file.tensor::<4>("a"), Err(WeightError::Shape("a".to_owned(), vec![2])));
    }

    #[test]
    fn damaged_weights_are_refused() {
        let good = small_file([0x3C00, 0xC000]);
        (0..good.len()).for_each(|length| {
            assert_eq!(WeightFile::parse(&good[..length]).err(), Some(WeightError::Truncated), "{length} bytes");
        });
        let changed = |at: usize, byte: u8| {
            let mut bad = good.clone();
            bad[at] = byte;
            WeightFile::parse(&bad).err()
        };
        assert_eq!(changed(0, 0), Some(WeightError::Format));
        assert_eq!(changed(2, 1), Some(WeightError::Format));
        assert_eq!(changed(10, 0xFF), Some(WeightError::Truncated), "offset of the table");
        assert_eq!(changed(27, 0xFF), Some(WeightError::Truncated), "dimension");
        assert_eq!(changed(29, b'f'), Some(WeightError::Layout("a".to_owned())));
        assert_eq!(WeightFile::parse(&small_file([0x7C00, 0])).err(), Some(WeightError::NotFinite("a".to_owned())));
    }
}

//! The bytes of a film between two passes, for checkpoints: every bit of its state, little-endian.

use glam::Vec3;
use std::io::{self, ErrorKind, Read, Write};

/// A value with a form in bytes.
pub trait Stored: Sized {
    /// Writes the value.
    ///
    /// # Errors
    /// Those of `out`.
    fn store(&self, out: &mut dyn Write) -> io::Result<()>;

    /// Reads a value.
    ///
    /// # Errors
    /// If `from` ends or holds no such value.
    fn load(from: &mut dyn Read) -> io::Result<Self>;
}

/// Returns the error of bytes that are no film.
pub fn invalid() -> io::Error {
    io::Error::new(ErrorKind::InvalidData, "it holds no film of this render")
}

/// Stores numbers by their bytes.
macro_rules! stored_numbers {
    ($($number:ty),*) => {$(
        impl Stored for $number {
            fn store(&self, out: &mut dyn Write) -> io::Result<()> {
                out.write_all(&self.to_le_bytes())
            }

            fn load(from: &mut dyn Read) -> io::Result<Self> {
                let mut bytes = [0; size_of::<$number>()];
                from.read_exact(&mut bytes)?;
                Ok(<$number>::from_le_bytes(bytes))
            }
        }
    )*};
}

stored_numbers!(u32, u64, f32, f64);

impl Stored for Vec3 {
    fn store(&self, out: &mut dyn Write) -> io::Result<()> {
        self.to_array().iter().try_for_each(|component| component.store(out))
    }

    fn load(from: &mut dyn Read) -> io::Result<Self> {
        Ok(Vec3::new(f32::load(from)?, f32::load(from)?, f32::load(from)?))
    }
}

impl<T: Stored> Stored for Option<T> {
    fn store(&self, out: &mut dyn Write) -> io::Result<()> {
        u32::from(self.is_some()).store(out)?;
        self.as_ref().map_or(Ok(()), |value| value.store(out))
    }

    fn load(from: &mut dyn Read) -> io::Result<Self> {
        Ok(if u32::load(from)? == 1 { Some(T::load(from)?) } else { None })
    }
}

impl<T: Stored> Stored for Vec<T> {
    fn store(&self, out: &mut dyn Write) -> io::Result<()> {
        (self.len() as u64).store(out)?;
        self.iter().try_for_each(|value| value.store(out))
    }

    /// Takes no more memory than the values that there are, whatever the length says.
    fn load(from: &mut dyn Read) -> io::Result<Self> {
        (0..u64::load(from)?).map(|_| T::load(from)).collect()
    }
}

impl<T: Stored> Stored for [T; 2] {
    fn store(&self, out: &mut dyn Write) -> io::Result<()> {
        self.iter().try_for_each(|value| value.store(out))
    }

    fn load(from: &mut dyn Read) -> io::Result<Self> {
        Ok([T::load(from)?, T::load(from)?])
    }
}

/// Stores a struct field by field.
macro_rules! stored_fields {
    ($name:ty { $($field:ident),* $(,)? }) => {
        impl $crate::raytrace::film::stored::Stored for $name {
            fn store(&self, out: &mut dyn std::io::Write) -> std::io::Result<()> {
                $($crate::raytrace::film::stored::Stored::store(&self.$field, out)?;)*
                Ok(())
            }

            fn load(from: &mut dyn std::io::Read) -> std::io::Result<Self> {
                Ok(Self { $($field: $crate::raytrace::film::stored::Stored::load(from)?),* })
            }
        }
    };
}

pub(super) use stored_fields;

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn values_keep_every_bit_and_a_short_file_is_an_error() {
        let value = vec![Some([f64::MIN_POSITIVE, -0.0]), None, Some([f64::INFINITY, 0.1])];
        let mut bytes = Vec::new();
        value.store(&mut bytes).unwrap();
        let read = Vec::<Option<[f64; 2]>>::load(&mut &bytes[..]).unwrap();
        assert_eq!(format!("{read:?}"), format!("{value:?}"));
        for length in 0..bytes.len() {
            assert!(Vec::<Option<[f64; 2]>>::load(&mut &bytes[..length]).is_err());
        }
        let endless = u64::MAX.to_le_bytes();
        assert!(Vec::<Vec3>::load(&mut &endless[..]).is_err());
    }
}

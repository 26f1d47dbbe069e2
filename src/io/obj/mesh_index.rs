//! Indices of a mesh's elements.

/// Returns an index or a number of elements as a mesh stores it. `chunks::FILE_LIMIT_BYTES` holds all of them within
/// 32 bits.
#[expect(clippy::cast_possible_truncation, reason = "chunks::parse refuses larger files")]
pub(super) fn to_index(count: usize) -> u32 {
    debug_assert!(u32::try_from(count).is_ok());
    count as u32
}

//! Intervals laid end to end, for choices in proportion to their lengths.

/// Returns the interval that contains `position` if intervals of these lengths are laid end to end: its index, its
/// length, and the position in it. Returns the last interval that is not empty if rounding puts the position beyond the
/// end.
#[inline]
pub fn find_interval(lengths: &[f32], mut position: f32) -> Option<(usize, f32, f32)> {
    let mut found = None;
    for (index, &length) in lengths.iter().enumerate().filter(|(_, length)| **length > 0.0) {
        found = Some((index, length, position.min(length)));
        if position < length {
            break;
        }
        position -= length;
    }
    found
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn positions_find_their_interval_and_never_an_empty_one() {
        let lengths = [0.0, 1.0, 0.0, 3.0, 0.0];
        assert_eq!(find_interval(&lengths, 0.5), Some((1, 1.0, 0.5)));
        assert_eq!(find_interval(&lengths, 1.0), Some((3, 3.0, 0.0)));
        assert_eq!(find_interval(&lengths, 4.001), Some((3, 3.0, 3.0)));
        assert_eq!(find_interval(&[0.0; 3], 0.0), None);
    }
}

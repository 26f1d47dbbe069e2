//! The waveform of a picture: how bright it is from left to right.

use super::picture::Picture;
use crate::color::ToneTable;

/// Numbers of pixels by place across the picture and by display value, of red, green and blue.
#[derive(Clone, Debug, PartialEq)]
pub struct Waveform {
    columns: usize,
    /// Rows of levels, the highest first.
    counts: Vec<[u32; 3]>,
}

impl Waveform {
    /// Levels from black to white: two display codes each.
    pub const LEVELS: usize = 128;
    /// Most columns.
    const MOST_COLUMNS: usize = 256;

    /// Counts the pixels of a picture.
    pub fn of(picture: &Picture) -> Self {
        let (tone, width) = (ToneTable::new(), picture.width as usize);
        let columns = width.min(Self::MOST_COLUMNS);
        let mut counts = vec![[0; 3]; columns * Self::LEVELS];
        for row in picture.rgb.chunks_exact(width.max(1)) {
            for (x, rgb) in row.iter().enumerate() {
                for (channel, code) in tone.display_srgb8(*rgb).into_iter().enumerate() {
                    let from_top = Self::LEVELS - 1 - usize::from(code) * Self::LEVELS / 256;
                    counts[from_top * columns + x * columns / width][channel] += 1;
                }
            }
        }
        Waveform { columns, counts }
    }

    /// Returns columns and levels.
    pub fn size(&self) -> [usize; 2] {
        [self.columns, Self::LEVELS]
    }

    /// Returns an image of [`Waveform::size`], rows from white to black: the more pixels of a column have a level, the
    /// brighter. Where the three channels agree it is grey.
    pub fn to_srgb8(&self) -> Vec<[u8; 3]> {
        let mut sums = vec![0_u32; self.columns];
        for row in self.counts.chunks_exact(self.columns.max(1)) {
            sums.iter_mut().zip(row).for_each(|(sum, counts)| *sum += counts[0]);
        }
        // Share of a column's pixels at one level from which it is shown at full brightness
        const FULL: f32 = 1.0 / 12.0;
        let code = |count: u32, sum: u32| {
            let share = count as f32 / sum.max(1) as f32;
            ((share / FULL).min(1.0).sqrt() * 235.0) as u8
        };
        let counts = self.counts.iter().enumerate();
        counts.map(|(at, counts)| counts.map(|count| code(count, sums[at % self.columns]))).collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::color::display_srgb8;

    #[test]
    fn a_pixel_counts_in_its_column_at_its_level() {
        // Black on the left, middle grey in the middle, red on the right
        let columns = [[0.0; 3], [0.18; 3], [9.0, 0.0, 0.0]];
        let rgb = (0..3 * 4).map(|at| columns[at % 3]).collect();
        let waveform = Waveform::of(&Picture { width: 3, height: 4, rgb });
        assert_eq!(waveform.size(), [3, Waveform::LEVELS]);
        let at = |column: usize, code: u8| waveform.counts[(Waveform::LEVELS - 1 - usize::from(code) / 2) * 3 + column];
        assert_eq!(at(0, 0), [4; 3]);
        assert_eq!(at(1, display_srgb8([0.18; 3])[0]), [4; 3]);
        assert_eq!((at(2, 255), at(2, 0)), ([4, 0, 0], [0, 4, 4]));
        let sum = |channel: usize| waveform.counts.iter().map(|counts| counts[channel]).sum::<u32>();
        assert_eq!([sum(0), sum(1), sum(2)], [12; 3]);
        // The image is lit there and nowhere else
        let image = waveform.to_srgb8();
        assert_eq!(image.len(), 3 * Waveform::LEVELS);
        assert_eq!(image[2], [235, 0, 0], "the red column's top is red");
        assert_eq!(image.iter().filter(|rgb| **rgb != [0; 3]).count(), 4);
    }

    #[test]
    fn wide_pictures_share_columns_and_empty_ones_have_none() {
        let wide = Waveform::of(&Picture::new(1000, 2));
        assert_eq!(wide.size()[0], 256);
        assert_eq!(wide.counts.iter().map(|counts| counts[1]).sum::<u32>(), 2000);
        let empty = Waveform::of(&Picture::default());
        assert!(empty.size()[0] == 0 && empty.to_srgb8().is_empty());
    }
}

//! A picture's way through the network: mirrored beyond its borders, in one run, or in tiles where memory would be
//! short.
//!
//! A run takes some 250 bytes a pixel. Tiles overlap by as much as the network sees around a pixel, so that their pixels
//! are those of one run, bit for bit.

use super::feature_map::{Block, FeatureMap, LEFT};
use super::network::{ALIGNMENT, Cancelled, INPUT_CHANNELS, Network, PERIOD};
use super::transfer;
use crate::photo::{AovPicture, Picture};
use rayon::prelude::*;
use std::ops::Range;

/// Largest number of pixels of a run: half a gigabyte.
pub const MAX_PIXELS: usize = 1 << 21;
/// Pixels that influence a pixel on each side: 80 by the sizes of filters and pools, rounded up to the network's period.
const OVERLAP: usize = 96;

/// The output pixels of a tile along one axis, and the input that they need.
#[derive(Clone, Debug, PartialEq, Eq)]
struct Span {
    output: Range<usize>,
    input: Range<usize>,
}

/// Divides an axis of `length` pixels into a number of spans, aligned to the network's period.
fn spans(length: usize, count: usize) -> Vec<Span> {
    let size = length.div_ceil(count.max(1)).next_multiple_of(PERIOD).max(PERIOD);
    let span = |start: usize| {
        let output = start..(start + size).min(length);
        let input = output.start.saturating_sub(OVERLAP)..(output.end + OVERLAP).min(length);
        Span { output, input }
    };
    (0..length).step_by(size).map(span).collect()
}

/// Returns the fewest columns and rows of tiles that have at most `max_pixels` each, or tiles of the smallest size.
fn tile_counts(width: usize, height: usize, max_pixels: usize) -> (usize, usize) {
    let longest = |length: usize, count: usize| {
        spans(length, count).iter().map(|span| span.input.len()).max().unwrap_or(0).next_multiple_of(ALIGNMENT)
    };
    let (mut columns, mut rows) = (1, 1);
    loop {
        let (tile_width, tile_height) = (longest(width, columns), longest(height, rows));
        let smallest = 3 * OVERLAP;
        if tile_width * tile_height <= max_pixels || tile_width.max(tile_height) <= smallest {
            return (columns, rows);
        }
        *(if tile_width > tile_height { &mut columns } else { &mut rows }) += 1;
    }
}

/// A picture and its AOVs, continued beyond each border by their mirror image.
#[derive(Clone, Copy, Debug)]
pub struct MirroredPicture<'a> {
    picture: &'a Picture,
    aovs: &'a AovPicture,
    /// Pixels beyond each border.
    margin: usize,
}

/// Denoises a picture in tiles of at most about `max_pixels`. The margin is not in the result.
pub fn denoise(
    network: &Network,
    mirrored: MirroredPicture<'_>,
    max_pixels: usize,
    is_cancelled: &(dyn Fn() -> bool + Sync),
) -> Result<Picture, Cancelled> {
    let MirroredPicture { picture, margin, .. } = mirrored;
    let (width, height) = (picture.width as usize, picture.height as usize);
    let scale = transfer::input_scale(picture);
    let mut denoised = Picture::new(picture.width, picture.height);
    let (columns, rows) = tile_counts(width + 2 * margin, height + 2 * margin, max_pixels);
    // What a tile shows of the picture itself
    let visible = |span: &Span, length: usize| span.output.start.max(margin)..span.output.end.min(margin + length);
    for y in spans(height + 2 * margin, rows) {
        for x in spans(width + 2 * margin, columns) {
            let (visible_columns, visible_rows) = (visible(&x, width), visible(&y, height));
            if visible_columns.is_empty() || visible_rows.is_empty() {
                continue;
            }
            let input = mirrored.network_input(scale, &x.input, &y.input);
            let output = network.run(&input, is_cancelled)?;
            let tile_width = input.shape.width;
            drop(input);
            let (left, top) = (visible_columns.start - x.input.start, visible_rows.start - y.input.start);
            let of_picture = |range: Range<usize>| range.start - margin..range.end - margin;
            let (columns, rows) = (of_picture(visible_columns), of_picture(visible_rows));
            let target = &mut denoised.rgb[rows.start * width..rows.end * width];
            target.par_chunks_mut(width).enumerate().for_each(|(row, target)| {
                let source = &output[(top + row) * tile_width + left..];
                for (pixel, encoded) in target[columns.clone()].iter_mut().zip(source) {
                    *pixel = encoded.map(|value| transfer::decode(value) / scale);
                }
            });
        }
    }
    if is_cancelled() { Err(Cancelled) } else { Ok(denoised) }
}

impl<'a> MirroredPicture<'a> {
    /// Returns a picture with a margin of so many pixels; none if it is empty or the sizes differ.
    pub fn new(picture: &'a Picture, aovs: &'a AovPicture, margin: usize) -> Option<Self> {
        let pixels = picture.width as usize * picture.height as usize;
        let is_whole = [picture.rgb.len(), aovs.seen_albedo.len(), aovs.seen_normal.len()] == [pixels; 3];
        (pixels > 0 && is_whole).then_some(MirroredPicture { picture, aovs, margin })
    }

    /// Returns the input of the network for some pixels, which count from the start of the margin: encoded colour,
    /// albedo, normal from 0 to 1. It is zero where the aligned size is larger.
    fn network_input(&self, scale: f32, columns: &Range<usize>, rows: &Range<usize>) -> FeatureMap {
        let MirroredPicture { picture, aovs, .. } = *self;
        let aligned = |range: &Range<usize>| range.len().next_multiple_of(ALIGNMENT);
        let mut input = FeatureMap::new(aligned(columns), aligned(rows), INPUT_CHANNELS);
        let shape = input.shape;
        let (width, height) = (picture.width as usize, picture.height as usize);
        input.data_mut().par_chunks_mut(shape.len()).zip(rows.clone()).for_each(|(row, y)| {
            let first = self.pixel_at(y, height) * width;
            for (features, x) in row[LEFT..].iter_mut().zip(columns.clone()) {
                let index = first + self.pixel_at(x, width);
                let color = picture.rgb[index].map(|value| transfer::encode(value * scale));
                let albedo = aovs.seen_albedo[index].map(|value| clamped(value, 0.0));
                let normal = aovs.seen_normal[index].map(|value| clamped(value, -1.0) * 0.5 + 0.5);
                *features = Block::ZERO;
                for (channels, values) in features.0.chunks_exact_mut(3).zip([color, albedo, normal]) {
                    channels.copy_from_slice(&values);
                }
            }
        });
        input
    }

    /// Returns the index of the pixel, of `length` along an axis, that the mirrored picture has at a position, which
    /// counts from the start of the margin.
    fn pixel_at(&self, position: usize, length: usize) -> usize {
        // Mirrored in both borders, the picture repeats itself after twice its length
        let period = 2 * length;
        let offset = (position + period - self.margin % period) % period;
        offset.min(period - 1 - offset)
    }
}

/// Clamps a value to `min` to 1; zero for what is no number.
fn clamped(value: f32, min: f32) -> f32 {
    if value.is_nan() { 0.0 } else { value.clamp(min, 1.0) }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn spans_cover_an_axis_once_and_overlap() {
        for (length, count) in [(1, 1), (16, 1), (720, 3), (1000, 4), (5000, 7)] {
            let spans = spans(length, count);
            let covered: Vec<usize> = spans.iter().flat_map(|span| span.output.clone()).collect();
            assert_eq!(covered, (0..length).collect::<Vec<_>>());
            for span in spans {
                assert_eq!(span.input.start % PERIOD, 0, "pools of a tile are those of the picture");
                assert_eq!(span.input.start, span.output.start.saturating_sub(OVERLAP));
                assert_eq!(span.input.end, (span.output.end + OVERLAP).min(length));
            }
        }
    }

    #[test]
    fn a_margin_mirrors_the_picture_however_small_it_is() {
        let at = |length: u32, margin: usize| {
            let (picture, aovs) = (Picture::new(length, 1), AovPicture::new(length, 1));
            let mirrored = MirroredPicture::new(&picture, &aovs, margin).unwrap();
            (0..length as usize + 2 * margin).map(|x| mirrored.pixel_at(x, length as usize)).collect::<Vec<_>>()
        };
        assert_eq!(at(3, 0), [0, 1, 2]);
        assert_eq!(at(4, 2), [1, 0, 0, 1, 2, 3, 3, 2]);
        assert_eq!(at(2, 5), [0, 0, 1, 1, 0, 0, 1, 1, 0, 0, 1, 1]);
        assert_eq!(at(1, 3), [0; 7]);
    }

    #[test]
    fn tiles_stay_below_their_number_of_pixels() {
        assert_eq!(tile_counts(1280, 720, MAX_PIXELS), (1, 1));
        let (columns, rows) = tile_counts(8000, 6000, MAX_PIXELS);
        let largest = |length, count| spans(length, count).iter().map(|span| span.input.len()).max().unwrap();
        assert!(largest(8000, columns) * largest(6000, rows) <= MAX_PIXELS);
        assert!(columns * rows <= 40, "{columns} x {rows}");
        // The smallest tiles end the division
        assert!(tile_counts(4000, 4000, 1).0 <= 42);
    }
}

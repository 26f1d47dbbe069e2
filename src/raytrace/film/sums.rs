//! Sums of samples of a tile, one for each layer and pixel.

use super::stored::Stored;
use glam::Vec3;
use std::io::{self, Read, Write};
use std::ops::{AddAssign, Range};

/// Sums of one tile; layer by layer, pixels in rows. The value is `Vec3` where all pixels have the same number of
/// samples, and `Vec4` with its weight as w where each pixel counts its own.
#[derive(Clone, Debug)]
pub struct LayerSums<V> {
    pixels: usize,
    sums: Vec<V>,
}

impl<V: Copy + Default + AddAssign> LayerSums<V> {
    /// Zero in every layer of every pixel.
    pub fn new(pixels: usize, layers: usize) -> Self {
        LayerSums { pixels, sums: vec![V::default(); pixels * layers] }
    }

    /// Number of pixels.
    pub fn pixels(&self) -> usize {
        self.pixels
    }

    /// Adds to a layer of a pixel.
    #[inline]
    pub fn add(&mut self, layer: usize, pixel: usize, value: V) {
        self.sums[layer * self.pixels + pixel] += value;
    }

    /// Replaces the sum of a layer of a pixel.
    pub fn set(&mut self, layer: usize, pixel: usize, value: V) {
        self.sums[layer * self.pixels + pixel] = value;
    }

    /// The sum of a layer of a pixel.
    #[inline]
    pub fn at(&self, layer: usize, pixel: usize) -> V {
        self.sums[layer * self.pixels + pixel]
    }

    /// The layers in order, each with all its pixels.
    pub fn layers(&self) -> impl ExactSizeIterator<Item = &[V]> {
        self.sums.chunks_exact(self.pixels)
    }

    /// Returns a copy of some pixels.
    pub fn range(&self, pixels: Range<usize>) -> Self {
        let sums = self.layers().flat_map(|layer| &layer[pixels.clone()]).copied().collect();
        LayerSums { pixels: pixels.len(), sums }
    }

    /// Replaces the pixels from `first` on by those of a copy.
    pub fn set_range(&mut self, first: usize, range: &Self) {
        for (layer, values) in self.sums.chunks_exact_mut(self.pixels).zip(range.layers()) {
            layer[first..first + values.len()].copy_from_slice(values);
        }
    }

    /// Sets everything to zero.
    pub fn clear(&mut self) {
        self.sums.fill(V::default());
    }

    /// Reorders the layers: `from` names the former layer of each new one, none for an empty one.
    pub fn remap(&mut self, from: &[Option<usize>]) {
        let pixels = self.pixels;
        let stays = |(layer, from): (usize, &Option<usize>)| from.is_none_or(|old| old == layer);
        if from.len() * pixels == self.sums.len() && from.iter().enumerate().all(stays) {
            for (sums, _) in self.sums.chunks_exact_mut(pixels).zip(from).filter(|(_, from)| from.is_none()) {
                sums.fill(V::default());
            }
            return;
        }
        let layer = |from: &Option<usize>| match from {
            Some(old) => self.sums[old * pixels..(old + 1) * pixels].to_vec(),
            None => vec![V::default(); pixels],
        };
        self.sums = from.iter().flat_map(layer).collect();
    }
}

impl Stored for LayerSums<Vec3> {
    fn store(&self, out: &mut dyn Write) -> io::Result<()> {
        (self.pixels as u64).store(out)?;
        self.sums.store(out)
    }

    fn load(from: &mut dyn Read) -> io::Result<Self> {
        Ok(LayerSums { pixels: u64::load(from)? as usize, sums: Vec::load(from)? })
    }
}

impl LayerSums<Vec3> {
    /// Returns true if both have the same numbers of pixels and layers.
    pub fn has_shape_of(&self, other: &Self) -> bool {
        (self.pixels, self.sums.len()) == (other.pixels, other.sums.len())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn layers_move_with_their_sums() {
        let mut sums = LayerSums::new(2, 3);
        (0..3).for_each(|layer| (0..2).for_each(|pixel| sums.add(layer, pixel, (10 * layer + pixel) as f32)));
        sums.remap(&[Some(0), None, Some(2)]);
        assert_eq!(sums.layers().collect::<Vec<_>>(), [[0.0, 1.0], [0.0, 0.0], [20.0, 21.0]]);
        sums.remap(&[Some(2), None]);
        assert_eq!(sums.layers().collect::<Vec<_>>(), [[20.0, 21.0], [0.0, 0.0]]);
        assert_eq!((sums.at(0, 1), sums.pixels()), (21.0, 2));
    }

    #[test]
    fn a_range_of_pixels_is_copied_out_and_back() {
        let mut sums = LayerSums::new(4, 2);
        (0..2).for_each(|layer| (0..4).for_each(|pixel| sums.add(layer, pixel, (10 * layer + pixel) as f32)));
        let mut middle = sums.range(1..3);
        assert_eq!(middle.layers().collect::<Vec<_>>(), [[1.0, 2.0], [11.0, 12.0]]);
        middle.add(1, 0, 0.5);
        sums.set_range(1, &middle);
        assert_eq!(sums.layers().collect::<Vec<_>>(), [[0.0, 1.0, 2.0, 3.0], [10.0, 11.5, 12.0, 13.0]]);
    }
}

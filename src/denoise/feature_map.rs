//! Feature maps: the values between two convolutions, in blocks of 16 channels.

/// Channels of a block.
pub const BLOCK: usize = 16;

/// 16 channels of a pixel, or 16 weights: a cache line, and a register of AVX-512.
#[derive(Clone, Copy, Debug, PartialEq)]
#[repr(C, align(64))]
pub struct Block(pub [f32; BLOCK]);

impl Block {
    /// Zero in every channel.
    pub const ZERO: Block = Block([0.0; BLOCK]);

    /// Returns the larger value of each channel.
    #[inline(always)]
    pub fn max(self, other: Block) -> Block {
        Block(std::array::from_fn(|i| if self.0[i] > other.0[i] { self.0[i] } else { other.0[i] }))
    }
}

/// Zero pixels left of a row: the border of a 3x3 filter.
pub const LEFT: usize = 1;
/// Zero pixels right of a row: the border, and what a tile of pixels reads beyond its end.
const RIGHT: usize = 32;

/// The size of a row: `width` pixels of `blocks` blocks.
///
/// A row is stored block by block. In each, the pixels lie between [`LEFT`] zero pixels and some on the right.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct RowShape {
    /// Pixels.
    pub width: usize,
    /// Blocks of channels.
    pub blocks: usize,
}

impl RowShape {
    /// Returns the shape of a row with a number of channels.
    pub fn new(width: usize, channels: usize) -> Self {
        RowShape { width, blocks: channels.div_ceil(BLOCK) }
    }

    /// Distance between two blocks of a pixel.
    pub fn stride(self) -> usize {
        LEFT + self.width + RIGHT
    }

    /// Number of [`Block`]s of a row.
    pub fn len(self) -> usize {
        self.blocks * self.stride()
    }

    /// Returns a row of zeros.
    pub fn zeros(self) -> Vec<Block> {
        vec![Block::ZERO; self.len()]
    }

    /// Returns the pixels of a block with those left and right of them: index 0 is the pixel at x = -1.
    pub fn padded(self, row: &[Block], block: usize) -> &[Block] {
        &row[block * self.stride()..(block + 1) * self.stride()]
    }

    /// Returns the pixels of a block.
    pub fn pixels(self, row: &[Block], block: usize) -> &[Block] {
        &self.padded(row, block)[LEFT..LEFT + self.width]
    }

    /// Returns the pixels of a block.
    pub fn pixels_mut(self, row: &mut [Block], block: usize) -> &mut [Block] {
        let start = block * self.stride() + LEFT;
        &mut row[start..start + self.width]
    }
}

/// Rows of features, from the top.
#[derive(Debug)]
pub struct FeatureMap {
    /// Number of rows.
    pub height: usize,
    /// Shape of each row.
    pub shape: RowShape,
    data: Vec<Block>,
}

impl FeatureMap {
    /// Creates a map of zeros.
    pub fn new(width: usize, height: usize, channels: usize) -> Self {
        let shape = RowShape::new(width, channels);
        FeatureMap { height, shape, data: vec![Block::ZERO; shape.len() * height] }
    }

    /// Returns a row; none above and below the map.
    pub fn row(&self, y: isize) -> Option<&[Block]> {
        let y = usize::try_from(y).ok().filter(|y| *y < self.height)?;
        Some(&self.data[y * self.shape.len()..(y + 1) * self.shape.len()])
    }

    /// Returns all rows, each of [`RowShape::len`] blocks.
    pub fn data_mut(&mut self) -> &mut [Block] {
        &mut self.data
    }
}

/// The last rows that a convolution has made, for the next one.
#[derive(Debug)]
pub struct RowRing {
    rows: Vec<(Option<isize>, Vec<Block>)>,
}

impl RowRing {
    /// Creates a ring that holds `count` rows.
    pub fn new(shape: RowShape, count: usize) -> Self {
        RowRing { rows: (0..count).map(|_| (None, shape.zeros())).collect() }
    }

    fn slot(&self, y: isize) -> usize {
        y.rem_euclid(self.rows.len() as isize).unsigned_abs()
    }

    /// Returns the buffer for row `y`, which replaces the oldest. Its border is zero.
    pub fn next(&mut self, y: isize) -> &mut [Block] {
        let slot = self.slot(y);
        self.rows[slot].0 = Some(y);
        &mut self.rows[slot].1
    }

    /// Returns row `y`; none if it has not been made.
    pub fn row(&self, y: isize) -> Option<&[Block]> {
        let (held, row) = &self.rows[self.slot(y)];
        (*held == Some(y)).then_some(row)
    }
}

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

    /// Returns rows of zeros.
    pub fn zeros(self, rows: usize) -> Vec<Block> {
        vec![Block::ZERO; rows * self.len()]
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

/// Two rows of output; the second is not wanted below a map of odd height.
#[derive(Debug)]
pub struct Output<'a> {
    /// The rows.
    pub rows: [Option<&'a mut [Block]>; 2],
    /// Their shape.
    pub shape: RowShape,
}

impl<'a> Output<'a> {
    /// Returns the output to the next one or two rows of a map.
    pub fn of(rows: &'a mut [Block], shape: RowShape) -> Self {
        let (first, second) = rows.split_at_mut(shape.len());
        Output { rows: [Some(first), Some(second).filter(|row| !row.is_empty())], shape }
    }
}

/// The last rows that a convolution has made, for the next one: three pairs.
#[derive(Debug)]
pub struct RowRing {
    shape: RowShape,
    /// The upper row of each pair, if it has been made.
    made: [Option<isize>; RowRing::PAIRS],
    rows: Vec<Block>,
}

impl RowRing {
    const PAIRS: usize = 3;

    /// Creates a ring without rows.
    pub fn new(shape: RowShape) -> Self {
        RowRing { shape, made: [None; RowRing::PAIRS], rows: shape.zeros(2 * RowRing::PAIRS) }
    }

    /// Returns the index of the pair with row `y`, and its upper row.
    fn pair(y: isize) -> (usize, isize) {
        let pair = y.div_euclid(2);
        (pair.rem_euclid(RowRing::PAIRS as isize).unsigned_abs(), 2 * pair)
    }

    /// Returns the buffer for rows `y` and `y + 1`, with `y` even, which replace the oldest. Their borders are zero.
    pub fn next(&mut self, y: isize) -> Output<'_> {
        let (pair, upper) = RowRing::pair(y);
        self.made[pair] = Some(upper);
        let len = 2 * self.shape.len();
        Output::of(&mut self.rows[pair * len..(pair + 1) * len], self.shape)
    }

    /// Returns row `y`; none if it has not been made.
    pub fn row(&self, y: isize) -> Option<&[Block]> {
        let (pair, upper) = RowRing::pair(y);
        let start = (2 * pair + usize::from(y != upper)) * self.shape.len();
        (self.made[pair] == Some(upper)).then(|| &self.rows[start..start + self.shape.len()])
    }
}

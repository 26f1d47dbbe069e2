//! The cells of a tank: how much ground and water is in each.

/// Units of volume in a cell.
pub const FULL: u16 = 60_000;
/// The ground of a cell of metal: it is full.
const METAL: u16 = u16::MAX;

/// A block of cells. The cells of a column, from the bottom up, are adjacent in memory; then follow the columns along X,
/// then those along Z.
#[derive(Clone, Debug, PartialEq)]
pub struct Grid {
    size: [usize; 3],
    ground: Vec<u16>,
    /// Units of water in each cell.
    pub(super) water: Vec<u16>,
}

impl Grid {
    /// Returns a block of air of so many cells along X, Y and Z.
    pub fn new(size: [usize; 3]) -> Self {
        let count = size.iter().product();
        Grid { size, ground: vec![0; count], water: vec![0; count] }
    }

    /// Returns the number of cells along X, Y and Z.
    pub fn size(&self) -> [usize; 3] {
        self.size
    }

    /// Returns the number of columns.
    pub fn columns(&self) -> usize {
        self.size[0] * self.size[2]
    }

    /// Returns the index of a cell.
    pub fn index(&self, [x, y, z]: [usize; 3]) -> usize {
        (z * self.size[0] + x) * self.size[1] + y
    }

    /// Returns the units of a cell that ground or metal fill.
    #[inline]
    pub fn ground(&self, cell: usize) -> u16 {
        self.ground[cell].min(FULL)
    }

    /// Returns true for a cell of metal.
    pub fn is_metal(&self, cell: usize) -> bool {
        self.ground[cell] == METAL
    }

    /// Returns the units of water in a cell.
    #[inline]
    pub fn water(&self, cell: usize) -> u16 {
        self.water[cell]
    }

    /// Returns the units of ground and water in a cell.
    #[inline]
    pub fn level(&self, cell: usize) -> u16 {
        self.ground(cell) + self.water[cell]
    }

    /// Sets the ground of a cell, in units; it holds no water any more.
    pub fn set_ground(&mut self, cell: usize, units: u16) {
        (self.ground[cell], self.water[cell]) = (units.min(FULL), 0);
    }

    /// Makes a cell metal.
    pub fn set_metal(&mut self, cell: usize) {
        (self.ground[cell], self.water[cell]) = (METAL, 0);
    }

    /// Fills a cell with water up to a level of so many units, where the ground does not.
    pub fn set_level(&mut self, cell: usize, units: u16) {
        self.water[cell] = units.min(FULL).saturating_sub(self.ground(cell));
    }

    /// Adds at most `units` of water to a cell; returns what it has taken.
    pub fn add_water(&mut self, cell: usize, units: u64) -> u64 {
        let taken = units.min(u64::from(FULL - self.level(cell)));
        self.water[cell] += taken as u16;
        taken
    }

    /// Returns the memory of the cells, bytes.
    pub fn bytes(&self) -> usize {
        size_of_val(&self.ground[..]) + size_of_val(&self.water[..])
    }

    /// Returns the water in all cells, in units.
    pub fn volume(&self) -> u64 {
        self.water.iter().map(|&units| u64::from(units)).sum()
    }
}

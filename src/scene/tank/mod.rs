//! The water tank: a block of cells of air, water, ground and metal, as the recipe from which room `water` makes it.

mod brush;
mod fluid;
mod spring;

pub use brush::BrushStroke;
pub use fluid::{Drop, FLUID_FRAMES_PER_S, Fluid, Jet, Obstacle, ObstacleForm};
pub use spring::Spring;

use super::{Material, MaterialPreset};
use glam::Vec3;
use std::cmp::Ordering;
use std::hash::{Hash, Hasher};

/// Steps of the simulation in a second of the studio's time.
pub const TANK_STEPS_PER_S: f32 = 60.0;

/// A block of cells. Its origin is the centre of its underside.
#[derive(Clone, Debug)]
pub struct Tank {
    /// Number of cells along X, Y and Z.
    pub cells: [u16; 3],
    /// Edge of a cell, metres.
    pub cell_m: f32,
    /// The ground.
    pub terrain: Terrain,
    /// Boxes of cells that replace the ground and the still water, in order.
    pub blocks: Vec<Block>,
    /// Strokes of the brush, after the blocks, in order.
    pub strokes: Vec<BrushStroke>,
    /// Height of the still water at the start, metres above the underside; 0 for none.
    pub water_m: f32,
    /// The springs.
    pub springs: Vec<Spring>,
    /// Time since the start, seconds: the state that is shown.
    pub time_s: f32,
    /// How its surfaces are drawn.
    pub look: TankLook,
    /// Its water as a fluid, which moves by the laws of motion; none for water that flows from cell to cell.
    pub fluid: Option<Box<Fluid>>,
}

/// The ground of a tank. Heights are metres above the underside.
#[derive(Clone, Debug, PartialEq)]
pub enum Terrain {
    /// A level ground.
    Flat {
        /// Its height; 0 for a tank without ground.
        height_m: f32,
    },
    /// A round basin, symmetric about both middle planes.
    Basin {
        /// Height of its lowest point, in the middle.
        floor_m: f32,
        /// Height of its rim and all around it.
        rim_m: f32,
    },
    /// Hills and valleys from noise.
    Hills {
        /// Seed of the noise.
        seed: u32,
        /// Height of the lowest valley.
        low_m: f32,
        /// Height of the highest hill.
        high_m: f32,
        /// Distance from hill to hill.
        period_m: f32,
    },
    /// The brightness of a picture, of which the upper edge lies at the back.
    Picture {
        /// An image file; relative to the scene file, `/` between folders.
        path: String,
        /// Height of black.
        low_m: f32,
        /// Height of white.
        high_m: f32,
    },
}

/// A box of cells of one content, corners included.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Block {
    /// Lowest cell.
    pub from: [u16; 3],
    /// Highest cell.
    pub to: [u16; 3],
    /// The content.
    pub content: CellContent,
}

/// The content of a cell.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum CellContent {
    /// Air: holes in the ground, caves.
    Air,
    /// Matte ground.
    Ground,
    /// Metal.
    Metal,
    /// Water that is there at the start.
    Water,
}

/// How the surfaces of a tank are drawn.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Default)]
pub enum TankLook {
    /// As the smooth surfaces that run through the cells.
    #[default]
    Smooth,
    /// As the faces of cubes.
    Cubes,
}

impl Tank {
    /// Largest number of cells along an axis.
    pub const MAX_SIDE: u16 = 256;
    /// Largest number of cells: 128 x 128 x 128. The simulation takes six bytes a cell.
    pub const MAX_CELLS: usize = 1 << 21;
    /// Largest number of steps times columns of cells: a minute for 128 x 128 columns.
    pub const MAX_COLUMN_STEPS: u64 = 1 << 26;
    /// Largest number of springs.
    pub const MAX_SPRINGS: usize = 16;
    /// Largest number of blocks.
    pub const MAX_BLOCKS: usize = 256;
    /// Names of the parts of its mesh, in order.
    pub const PARTS: [&'static str; 3] = ["ground", "metal", "water"];

    /// Returns the material of the water of a new tank: clear, with the absorption of pure water at 610, 550 and 450 nm
    /// (Pope and Fry 1997, "Absorption spectrum (380-700 nm) of pure water", table 3: 0.2644, 0.0565 and 0.00922 per m).
    pub fn water_material() -> Material {
        Material { absorption_per_m: [0.2644, 0.0565, 0.00922], ..MaterialPreset::Water.material() }
    }

    /// Returns the edge lengths, metres.
    pub fn size_m(&self) -> Vec3 {
        Vec3::from(self.cells.map(f32::from)) * self.cell_m
    }

    /// Returns the lowest corner, metres, in object space.
    pub fn low_m(&self) -> Vec3 {
        self.size_m() * Vec3::new(-0.5, 0.0, -0.5)
    }

    /// Returns the number of cells.
    pub fn cell_count(&self) -> usize {
        self.cells.iter().map(|&side| usize::from(side)).product()
    }

    /// Returns the number of steps that lead to the time shown.
    pub fn steps(&self) -> u32 {
        (self.time_s * self.steps_per_s()).round() as u32
    }

    /// Returns the steps in a second: a fluid is shown at its frames.
    pub fn steps_per_s(&self) -> f32 {
        if self.fluid.is_some() { FLUID_FRAMES_PER_S } else { TANK_STEPS_PER_S }
    }

    /// Returns the longest time that may be shown, seconds.
    pub fn longest_s(&self) -> f32 {
        if self.fluid.is_some() {
            let frames = Fluid::MAX_CELL_FRAMES / self.cell_count().max(1) as u64;
            return frames.min(Fluid::MAX_FRAMES) as f32 / FLUID_FRAMES_PER_S;
        }
        let columns = u64::from(self.cells[0]) * u64::from(self.cells[2]);
        (Self::MAX_COLUMN_STEPS / columns.max(1)).min(120 * 60) as f32 / TANK_STEPS_PER_S
    }

    /// Returns the path of the picture that its ground is made of, if it is.
    pub fn height_picture(&self) -> Option<&str> {
        match &self.terrain {
            Terrain::Picture { path, .. } => Some(path),
            Terrain::Flat { .. } | Terrain::Basin { .. } | Terrain::Hills { .. } => None,
        }
    }

    /// Returns the same tank at the start: equal for all times of one recipe.
    pub fn at_start(&self) -> Tank {
        Tank { time_s: 0.0, ..self.clone() }
    }

    /// Returns every value that the mesh depends on, as bits: the key of caches.
    fn key(&self) -> Vec<u32> {
        let Tank { cells, cell_m, terrain, blocks, strokes, water_m, springs, time_s, look, fluid } = self;
        let bits = |value: f32| (value + 0.0).to_bits();
        let mut key = cells.map(u32::from).to_vec();
        key.extend([bits(*cell_m), bits(*water_m), bits(*time_s), *look as u32, blocks.len() as u32]);
        key.extend(match terrain {
            Terrain::Flat { height_m } => [0, bits(*height_m), 0, 0, 0],
            Terrain::Basin { floor_m, rim_m } => [1, bits(*floor_m), bits(*rim_m), 0, 0],
            Terrain::Hills { seed, low_m, high_m, period_m } => {
                [2, *seed, bits(*low_m), bits(*high_m), bits(*period_m)]
            }
            Terrain::Picture { path, low_m, high_m } => [3, path.len() as u32, bits(*low_m), bits(*high_m), 0],
        });
        key.extend(self.height_picture().unwrap_or_default().bytes().map(u32::from));
        for Block { from, to, content } in blocks {
            key.extend(from.iter().chain(to).map(|&cell| u32::from(cell)));
            key.push(*content as u32);
        }
        key.push(strokes.len() as u32);
        key.extend(strokes.iter().flat_map(BrushStroke::key));
        for Spring { at_m, litres_per_s, switches_s } in springs {
            key.extend(at_m.to_array().map(bits));
            key.extend([bits(*litres_per_s), switches_s.len() as u32]);
            key.extend(switches_s.iter().map(|&time| bits(time)));
        }
        if let Some(fluid) = fluid {
            key.push(u32::MAX);
            key.extend(fluid.key());
        }
        key
    }
}

impl Default for Tank {
    /// A landscape of 64 x 32 x 64 cells with a lake.
    fn default() -> Self {
        Tank {
            cells: [64, 32, 64],
            cell_m: 0.01,
            terrain: Terrain::Hills { seed: 5, low_m: 0.03, high_m: 0.28, period_m: 0.4 },
            blocks: Vec::new(),
            strokes: Vec::new(),
            water_m: 0.11,
            springs: Vec::new(),
            time_s: 0.0,
            look: TankLook::Smooth,
            fluid: None,
        }
    }
}

impl PartialEq for Tank {
    fn eq(&self, other: &Self) -> bool {
        self.key() == other.key()
    }
}

impl Eq for Tank {}

impl Hash for Tank {
    fn hash<H: Hasher>(&self, state: &mut H) {
        self.key().hash(state);
    }
}

impl PartialOrd for Tank {
    fn partial_cmp(&self, other: &Self) -> Option<Ordering> {
        Some(self.cmp(other))
    }
}

impl Ord for Tank {
    fn cmp(&self, other: &Self) -> Ordering {
        self.key().cmp(&other.key())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_field_is_part_of_the_key() {
        let block = Block { from: [1, 2, 3], to: [4, 5, 6], content: CellContent::Water };
        let spring = Spring { at_m: Vec3::Y, litres_per_s: 0.2, switches_s: vec![0.0, 1.0] };
        let fluid = Fluid {
            drops: vec![Drop { at_m: Vec3::Y, radius_m: 0.01, velocity_m_s: Vec3::ZERO }],
            jets: vec![Jet { at_m: Vec3::Y, radius_m: 0.01, velocity_m_s: Vec3::NEG_Y, until_s: 1.0 }],
            obstacles: vec![Obstacle {
                form: ObstacleForm::Ball { radius_m: 0.1 },
                at_m: Vec3::ZERO,
                falls_m_s: 0.0,
                stands_s: 0.0,
            }],
            seed: 1,
        };
        let fluid = Some(Box::new(fluid));
        let stroke = BrushStroke { content: CellContent::Air, radius_m: 0.02, path_m: vec![Vec3::Y] };
        let tank = Tank { blocks: vec![block], strokes: vec![stroke], springs: vec![spring], fluid, ..Tank::default() };
        let changes: [fn(&mut Tank); 33] = [
            |t| t.cells[1] = 8,
            |t| t.cell_m = 0.02,
            |t| t.terrain = Terrain::Flat { height_m: 0.1 },
            |t| t.terrain = Terrain::Basin { floor_m: 0.1, rim_m: 0.2 },
            |t| t.terrain = Terrain::Hills { seed: 6, low_m: 0.03, high_m: 0.28, period_m: 0.4 },
            |t| t.terrain = Terrain::Picture { path: "a.png".to_owned(), low_m: 0.1, high_m: 0.2 },
            |t| t.terrain = Terrain::Picture { path: "b.png".to_owned(), low_m: 0.1, high_m: 0.2 },
            |t| t.blocks.clear(),
            |t| t.strokes.clear(),
            |t| t.strokes[0].radius_m = 0.03,
            |t| t.strokes[0].path_m[0].z = 0.01,
            |t| t.strokes[0].content = CellContent::Metal,
            |t| t.blocks[0].from[0] = 0,
            |t| t.blocks[0].to[2] = 9,
            |t| t.blocks[0].content = CellContent::Air,
            |t| t.water_m = 0.05,
            |t| t.springs.clear(),
            |t| t.springs[0].at_m.x = 0.1,
            |t| t.springs[0].litres_per_s = 0.3,
            |t| t.springs[0].switches_s = vec![0.0],
            |t| t.time_s = 1.0,
            |t| t.look = TankLook::Cubes,
            |t| t.fluid = None,
            |t| t.fluid.as_mut().unwrap().seed = 2,
            |t| t.fluid.as_mut().unwrap().drops.clear(),
            |t| t.fluid.as_mut().unwrap().drops[0].radius_m = 0.02,
            |t| t.fluid.as_mut().unwrap().drops[0].velocity_m_s.y = -1.0,
            |t| t.fluid.as_mut().unwrap().jets[0].radius_m = 0.02,
            |t| t.fluid.as_mut().unwrap().jets[0].until_s = 2.0,
            |t| t.fluid.as_mut().unwrap().obstacles[0].form = ObstacleForm::Cylinder { radius_m: 0.1, height_m: 0.0 },
            |t| t.fluid.as_mut().unwrap().obstacles[0].at_m.z = 0.1,
            |t| t.fluid.as_mut().unwrap().obstacles[0].falls_m_s = 1.0,
            |t| t.fluid.as_mut().unwrap().obstacles[0].stands_s = 1.0,
        ];
        let mut keys = std::collections::BTreeSet::from([tank.clone()]);
        for change in changes {
            let mut other = tank.clone();
            change(&mut other);
            assert!(keys.insert(other), "two tanks of one key");
        }
    }

    #[test]
    fn the_longest_time_keeps_the_work_within_its_bound() {
        for cells in [[1, 1, 1], [64, 32, 64], [128, 128, 128], [256, 32, 256]] {
            let tank = Tank { cells, ..Tank::default() };
            let tank = Tank { time_s: tank.longest_s(), ..tank };
            let work = u64::from(tank.steps()) * u64::from(cells[0]) * u64::from(cells[2]);
            assert!(work <= Tank::MAX_COLUMN_STEPS && tank.time_s <= 120.0, "{cells:?}");
        }
    }
}

//! The recipe of a fluid: water that moves by the laws of motion, for splashes and pours.

use super::Tank;
use glam::Vec3;

/// Frames of a fluid in a second of the studio's time: a state is shown at a whole number of them.
pub const FLUID_FRAMES_PER_S: f32 = 240.0;

/// Water that is simulated as a fluid, beside the still water and the blocks of water of its tank.
#[derive(Clone, Debug, PartialEq, Default)]
pub struct Fluid {
    /// Balls of water.
    pub drops: Vec<Drop>,
    /// Round jets.
    pub jets: Vec<Jet>,
    /// Things that stand in the water or fall into it.
    pub obstacles: Vec<Obstacle>,
    /// Chooses the irregularities of the water.
    pub seed: u32,
}

/// A ball of water at the start.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Drop {
    /// Its middle in the tank's space, metres.
    pub at_m: Vec3,
    /// Its radius, metres.
    pub radius_m: f32,
    /// Its velocity, metres per second.
    pub velocity_m_s: Vec3,
}

/// A round jet of water.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Jet {
    /// The middle of its nozzle in the tank's space, metres.
    pub at_m: Vec3,
    /// Its radius, metres.
    pub radius_m: f32,
    /// Its velocity at the nozzle, metres per second.
    pub velocity_m_s: Vec3,
    /// The time at which it ends, seconds.
    pub until_s: f32,
}

/// A solid thing.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Obstacle {
    /// Its form.
    pub form: ObstacleForm,
    /// The middle of its underside where it stands, in the tank's space, metres.
    pub at_m: Vec3,
    /// The speed at which it falls until it stands there, metres per second.
    pub falls_m_s: f32,
    /// The time at which it stands there, seconds.
    pub stands_s: f32,
}

/// The form of a solid thing.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum ObstacleForm {
    /// A ball.
    Ball {
        /// Its radius.
        radius_m: f32,
    },
    /// A box along the axes of the tank.
    Box {
        /// Edge lengths.
        size_m: Vec3,
    },
    /// An upright cylinder.
    Cylinder {
        /// Its radius.
        radius_m: f32,
        /// Its height.
        height_m: f32,
    },
    /// An upright glass: a hollow that becomes wider upwards. Its wall and floor are as thick as keeps the water in.
    Glass {
        /// Height of the floor of the hollow above the underside.
        floor_m: f32,
        /// Radius of the hollow at its floor.
        floor_radius_m: f32,
        /// Height of the rim above the underside.
        rim_m: f32,
        /// Radius of the hollow at the rim.
        rim_radius_m: f32,
        /// Height of the drink above the floor at the start; 0 for an empty glass.
        drink_m: f32,
    },
}

impl Fluid {
    /// Largest number of drops, of jets and of obstacles.
    pub const MAX_THINGS: usize = 8;
    /// Largest number of cells: 128 x 64 x 128. The solver takes about 100 bytes a cell while it
    /// runs, the surface 240: 300 MB at most.
    pub const MAX_CELLS: usize = 1 << 20;
    /// Largest number of particles; a jet ends when there are as many. Each takes 60 bytes, and as many while they are
    /// sorted.
    pub const MAX_PARTICLES: usize = 1 << 20;
    /// Particles in a full cell.
    pub const PARTICLES_PER_CELL: usize = 8;
    /// Largest number of frames: 20 seconds.
    pub const MAX_FRAMES: u64 = 20 * 240;
    /// Largest number of frames times cells: a second for 64 x 64 x 64.
    pub const MAX_CELL_FRAMES: u64 = 1 << 26;

    /// Returns about how many particles a tank has, at most, when its jets have ended.
    pub fn particle_bound(&self, tank: &Tank) -> f64 {
        let cell_m3 = f64::from(tank.cell_m).powi(3).max(f64::MIN_POSITIVE);
        let columns = f64::from(tank.cells[0]) * f64::from(tank.cells[2]);
        let layers = f64::from(tank.water_m / tank.cell_m).ceil().min(tank.cells[1].into());
        let side = |low: u16, high: u16| f64::from(high.saturating_sub(low)) + 1.0;
        let water = |block: &&super::Block| block.content == super::CellContent::Water;
        let blocks: f64 = tank
            .blocks
            .iter()
            .filter(water)
            .map(|block| (0..3).map(|axis| side(block.from[axis], block.to[axis])).product::<f64>())
            .sum();
        let ball = |drop: &Drop| 4.19 * f64::from(drop.radius_m).powi(3) / cell_m3;
        let column = |jet: &Jet| {
            let length_m = f64::from(jet.velocity_m_s.length()) * f64::from(jet.until_s.min(tank.time_s));
            3.15 * f64::from(jet.radius_m).powi(2) * length_m / cell_m3
        };
        let drink = |obstacle: &Obstacle| match obstacle.form {
            ObstacleForm::Glass { floor_radius_m, rim_radius_m, drink_m, .. } => {
                3.15 * f64::from(floor_radius_m.max(rim_radius_m)).powi(2) * f64::from(drink_m) / cell_m3
            }
            ObstacleForm::Ball { .. } | ObstacleForm::Box { .. } | ObstacleForm::Cylinder { .. } => 0.0,
        };
        let poured = self.drops.iter().map(ball).chain(self.jets.iter().map(column));
        let poured: f64 = poured.chain(self.obstacles.iter().map(drink)).sum();
        (columns * layers + blocks + poured) * Self::PARTICLES_PER_CELL as f64
    }

    /// Returns every value as bits, for the key of caches.
    pub(super) fn key(&self) -> Vec<u32> {
        let Fluid { drops, jets, obstacles, seed } = self;
        let mut key = vec![drops.len() as u32, jets.len() as u32, obstacles.len() as u32, *seed];
        let mut push = |values: &[f32]| key.extend(values.iter().map(|value| (value + 0.0).to_bits()));
        for Drop { at_m, radius_m, velocity_m_s } in drops {
            push(&at_m.to_array());
            push(&velocity_m_s.to_array());
            push(&[*radius_m]);
        }
        for Jet { at_m, radius_m, velocity_m_s, until_s } in jets {
            push(&at_m.to_array());
            push(&velocity_m_s.to_array());
            push(&[*radius_m, *until_s]);
        }
        for Obstacle { form, at_m, falls_m_s, stands_s } in obstacles {
            push(&at_m.to_array());
            push(&[*falls_m_s, *stands_s]);
            push(&match *form {
                ObstacleForm::Ball { radius_m } => [0.0, radius_m, 0.0, 0.0, 0.0, 0.0],
                ObstacleForm::Box { size_m } => [1.0, size_m.x, size_m.y, size_m.z, 0.0, 0.0],
                ObstacleForm::Cylinder { radius_m, height_m } => [2.0, radius_m, height_m, 0.0, 0.0, 0.0],
                ObstacleForm::Glass { floor_m, floor_radius_m, rim_m, rim_radius_m, drink_m } => {
                    [3.0, floor_m, floor_radius_m, rim_m, rim_radius_m, drink_m]
                }
            });
        }
        key
    }
}

impl Obstacle {
    /// Returns where the middle of its underside is at a time, metres.
    pub fn at_time_m(&self, time_s: f32) -> Vec3 {
        self.at_m + Vec3::Y * self.falls_m_s * (self.stands_s - time_s).max(0.0)
    }
}

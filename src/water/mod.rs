//! Water in a tank: its cells, the cellular automaton that moves them, and the mesh that renderers draw.
//!
//! [`crate::scene::Tank`] is the recipe. [`Simulation`] runs from its start to its time, the same for any number of
//! threads; [`mesh`] makes the surfaces of the ground, the metal and the water.
//!
//! | file | contents |
//! |---|---|
//! | `grid` | the units of ground and water in each cell |
//! | `terrain` | the start of a tank: noise, basin, blocks, still water |
//! | `simulation` | the cellular automaton |
//! | `surface` | surface nets, the fields that they follow, and the faces of cubes |

mod grid;
mod simulation;
mod surface;
mod terrain;

pub use grid::{FULL, Grid};
pub use simulation::Simulation;
pub use surface::{mesh, surface_of};

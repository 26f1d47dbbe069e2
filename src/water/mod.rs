//! Water in a tank: its cells, the cellular automaton that moves them, and the mesh that renderers draw.
//!
//! [`crate::scene::Tank`] is the recipe. [`Simulation`] runs from its start to its time, the same for any number of
//! threads; [`mesh`] makes the surfaces of the ground, the metal and the water. [`FluidSimulation`] and [`fluid_mesh`] do
//! so for tanks with a [`crate::scene::Fluid`].
//!
//! | file | contents |
//! |---|---|
//! | `grid` | the units of ground and water in each cell |
//! | `terrain` | the start of a tank: noise, basin, blocks, still water |
//! | `simulation` | the cellular automaton |
//! | `fluid` | water that moves by the laws of motion |
//! | `blur` | smoothing of values on a grid |
//! | `surface` | surface nets, the fields that they follow, and the faces of cubes |

mod blur;
mod fluid;
mod grid;
mod simulation;
mod surface;
mod terrain;

pub use fluid::{FluidSimulation, Particle};
pub use grid::{FULL, Grid};
pub use simulation::Simulation;
pub use surface::{fluid_mesh, mesh, surface_of};

//! The light meter: illuminance of a receptor, light by light, direct and bounced.
//!
//! Direct light is estimated by light sampling: stratified points on each emitter with shadow rays; a delta light needs
//! one. Bounced light is found by the path tracer, started in directions that the receptor weights. Both are sampled in
//! sixteen independently scrambled replicates (randomized quasi-Monte Carlo), whose scatter is the reported standard
//! error; rounds of samples follow until it is small or the ray budget is spent. Direct light passes panes and flat bodies
//! of glass (`straight_path`). Light by way of mirrors and other glass counts as bounced; photons find it, too.

mod direct;
mod meter;
mod photons;
mod point;
mod receptor;
mod replicate;
mod rounds;
mod sampling;
mod studio;

pub use direct::{MeteredSource, SurfacePoint};
pub use meter::{LightMeter, MeterResult};
pub use point::{MeterEffort, MeterPoint};
pub use sampling::DirectLight;

//! The ray tracer: `prepare` a scene, `render` it wave by wave onto a [`Film`], develop the film.
//!
//! No clock, no entropy, no globals. A rendered value is a function of scene, pixel, sample, dimension and seed: the
//! same bits for any number of threads.

mod aggregate;
mod blas;
mod bsdf;
mod bvh;
mod caustics;
mod emission;
mod film;
mod geometry;
mod geometry_cache;
mod integrator;
mod intersectors;
mod lens;
mod lights;
mod live;
mod medium_stack;
mod plan;
mod prepare;
mod probe;
mod receiver;
mod sampler;
mod schedule;
mod simd;
mod texture;
mod triangle;
mod visibility;
mod whitted;

pub use film::{Film, Layer, MAX_LIGHT_LAYERS};
pub use geometry_cache::GeometryCache;
pub use intersectors::{IntersectionMethod, Intersector};
pub use live::{LiveCamera, LivePicture, Smoother};
pub use plan::{RenderPlan, Shortcut};
pub use prepare::{PrepareError, RenderScene, prepare, prepare_kept};
pub use probe::{Effort, Place, Probe, Probed};
pub use schedule::{Control, Method, Settings, primary_objects, render};

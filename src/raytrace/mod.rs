//! The ray tracer: `prepare` a scene, `render` it wave by wave onto a [`Film`], develop the film.
//!
//! No clock, no entropy, no globals. A rendered value is a function of scene, pixel, sample, dimension and seed: the
//! same bits for any number of threads.

mod aggregate;
mod blas;
mod bsdf;
mod bvh;
mod caustics;
mod control;
mod emitters;
mod film;
mod geometry;
mod geometry_cache;
mod intersectors;
mod lens;
mod light_meter;
mod lights;
mod live;
mod medium_stack;
mod path_tracer;
mod plan;
mod prepare;
mod ray_caster;
mod render;
mod retrace;
mod sampler;
mod settings;
mod simd;
mod sink;
mod texture;
mod whitted;

pub use control::RenderControl;
pub use film::{Film, Layer, MAX_LIGHT_LAYERS, NonFiniteReport};
pub use geometry_cache::GeometryCache;
pub use intersectors::{IntersectionMethod, Intersector};
pub use light_meter::{LightMeter, MeterEffort, MeterPoint, MeterResult};
pub use live::{LiveCamera, LivePicture, Smoother};
pub use plan::{RenderPlan, Shortcut};
pub use prepare::{PrepareError, RenderScene, prepare, prepare_kept};
pub use render::{primary_objects, render};
pub use retrace::is_up_to_date;
pub use sampler::SampleId;
pub use settings::{Method, Settings};

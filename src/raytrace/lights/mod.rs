//! Lights as the ray tracer samples and intersects them, and the structures over many lights.
//!
//! - [`TracedLight`]: one light; samples a direction towards it, or intersects a ray with its emitter
//! - `rect`, `disc`, `sphere`, `sun`: the shapes of emitters with their sampling densities
//! - [`LightSampler`]: chooses one light by its importance at a shading point, with a `LightBvh` over `LightBounds`
//! - [`LightLanes`]: a few lights, all sampled at once
//! - [`EmitterBvh`]: finds the emitters that a ray hits
//!
//! Values are photometric and white (luminance of an RGB of luminance 1). The light's colour is applied to its film
//! layer.
//!
//! A new emitter shape needs a variant of [`photo::EmitterShape`](crate::photo::emitter::EmitterShape), a variant of
//! `LightSource` with its arms in the exhaustive matches of `traced_light.rs` (construction, centre, sampling, pdf,
//! intersection, bounds), and an arm in `light_bounds.rs`. A new intensity distribution needs no arm if `photo`
//! evaluates it as the transmission of a beam.

mod disc;
mod emitter_bvh;
mod flat;
mod light_bounds;
mod light_bvh;
mod light_lanes;
mod light_sampler;
mod rect;
mod sphere;
mod sun;
mod traced_light;

pub use emitter_bvh::EmitterBvh;
pub use light_lanes::{LightLanes, LightSampleLanes};
pub use light_sampler::{LightImportances, LightSampler};
pub use traced_light::{EmitterHit, LightSample, TracedLight};

#[cfg(test)]
mod tests;

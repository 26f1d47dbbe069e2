//! Shadow maps and screen-space shadow masks: view fitting, the cached layers of the map array, and filtering.

pub mod culling;
pub mod focus;
pub mod layers;
pub mod maps;
pub mod mask;
pub mod parts;
pub mod pipelines;
pub mod plan;
pub mod shadow_passes;
pub mod slots;
pub mod views;

//! Arithmetic of exposure, light meter and set-ups: what a photographer's own tools compute.

pub mod beam;
pub mod exposure;
pub mod meter;
mod picture;
pub mod thirds;

pub use picture::Picture;

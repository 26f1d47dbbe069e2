//! Arithmetic of exposure, light meter and set-ups: what a photographer's own tools compute.

mod aov;
pub mod beam;
pub mod emitter;
pub mod exposure;
pub mod light;
pub mod meter;
mod picture;
pub mod thirds;

pub use aov::AovPicture;
pub use light::{PhotometricLight, Strength};
pub use picture::Picture;

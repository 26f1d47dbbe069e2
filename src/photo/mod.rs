//! Photometry: lights in physical units, exposure, the light meter, portrait lighting patterns, and the scales of a
//! camera's dials.

mod aov;
pub mod beam;
pub mod emitter;
pub mod exposure;
pub mod irradiance_grid;
mod lazy_picture;
pub mod light;
mod light_color;
pub mod meter;
pub mod nd_filter;
mod picture;
pub mod portrait_pattern;
pub mod thirds;

pub use aov::AovPicture;
pub use lazy_picture::LazyPicture;
pub use light::{PhotometricLight, Strength};
pub use light_color::light_rgb;
pub use picture::Picture;

//! Photometry: lights in physical units, exposure, the light meter, portrait lighting patterns, scopes for
//! pictures, the scales of a camera's dials, and numbers as text.

mod aov;
pub mod beam;
mod dial_text;
pub mod emitter;
mod environment_light;
pub mod exposure;
mod false_color;
pub mod irradiance_grid;
mod lazy_picture;
pub mod light;
mod light_bearing;
mod light_color;
mod measured_beam;
pub mod meter;
pub mod nd_filter;
mod picture;
mod picture_difference;
pub mod portrait_pattern;
mod scopes;
pub mod text;
pub mod thirds;
mod waveform;

pub use aov::AovPicture;
pub use dial_text::{dial_from_text, dial_text, flash_time_text, light_dial_text};
pub use environment_light::{EnvironmentLight, EnvironmentSun};
pub use false_color::{FALSE_STOPS, false_color};
pub use lazy_picture::LazyPicture;
pub use light::{PhotometricLight, Strength};
pub use light_bearing::LightBearing;
pub use light_color::light_rgb;
pub use measured_beam::MeasuredBeam;
pub use picture::Picture;
pub use picture_difference::{DIFFERENCE_STOPS, PictureDifference, difference_color, stops_above};
pub use scopes::{Histogram, MIDDLE_GREY, PictureDisplay, Spot, clipping_stops};
pub use waveform::Waveform;

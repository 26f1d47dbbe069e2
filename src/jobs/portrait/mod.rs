//! The pattern check: which portrait lighting pattern falls on the faces of figures.
//!
//! ```text
//! figure + light meter -> face_scan: cells of skin -> key_light: the light that rules them -> FaceMap
//!   -> photo::portrait_pattern::find_pattern -> FaceLighting: pattern, short or broad, angles of the key
//! ```
//!
//! And which lights are reflected in their eyes.

mod catchlights;
mod check;
mod face_lighting;
mod face_scan;
mod job;
mod key_light;

pub use catchlights::Catchlight;
pub use check::{Face, check_patterns, faces_in_view};
pub use face_lighting::{FaceLighting, KeyPlace, Modelling};
pub use job::PatternJob;

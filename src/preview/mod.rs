//! The live preview on wgpu: deferred shading with the scene's real lights, shadow maps, picking.
//!
//! Scene -> `DrawList` and `LightTable` (plain structs, one record a surface and a light) -> shadow maps (cached)
//! -> geometry pass into a G-buffer -> lighting pass -> glass and overlay over the lit picture.
//!
//! Lights reach the shaders in picture units, so that what a shader sums is the scene-linear pixel. What it leaves out
//! of the tracer's picture: bounced light (estimated), true reflection and refraction, exact soft shadows.

mod channel;
mod error;
mod frame_resources;
mod frame_times;
mod geometry;
mod gpu;
mod input;
mod lighting;
mod lights;
pub mod offscreen;
mod overlay;
mod renderer;
mod scene_buffers;
mod shaders;
mod shadows;
mod targets;

pub use channel::{Channel, FALSE_STOPS, Gloss, false_color};
pub use error::PreviewError;
pub use frame_times::FrameTimes;
pub use gpu::device::{Gpu, LossFlag};
pub use input::{Options, Overlay, Pick, PreviewInput};
pub use overlay::gizmo::{Gizmos, GpuLine, GpuTint};
pub use overlay::pick::{ObjectMask, PickHit, REACH_PX};
pub use renderer::PreviewRenderer;

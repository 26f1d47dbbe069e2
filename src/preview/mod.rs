//! The live preview on wgpu: deferred shading with the scene's lights, soft shadow maps and picking.
//!
//! A frame, as `renderer/` encodes it. Passes in brackets are skipped while their inputs have not changed:
//!
//! ```text
//! Scene, CameraFrame, Options
//!   |  renderer/frame_plan.rs: DrawList (geometry/), LightTable and light tiles (lights/), ShadowPlan (shadows/)
//!   |  uploads: meshes, textures, draw records, frame constants, surfaces, lights, tiles, shadow slots
//!   v
//! [shadow map pass]     one per stale view and side  -> shadow map array (Depth32Float)
//! [geometry pass]       opaque items, culled clusters, strands as ribbons
//!                                               -> G-buffer (Rgba32Uint), ids (Rg32Uint), depth (Depth32Float)
//! [shadow mask + blur]  four lights per mask         -> mask array (Rg32Uint), from G-buffer, ids, shadow maps
//! lighting pass         full-screen, lights per tile -> picture; in a draft -> coarse lighting (Rgba32Uint)
//!   diffusion pass      with skin: spreads diffuse light under soft surfaces -> picture; drafts leave it out
//!   resolve pass        drafts: joint bilateral upsampling of the coarse lighting -> picture
//! glass pass            forward, blended             -> picture, ids, depth
//! channel pass          instead of lighting, for views of the G-buffer -> picture
//! still passes          the average of several samples of a still view, each through other points of the pixels
//! overlay pass          outline, tints, lines; depth from ids -> picture (Rgba8Unorm, or Rgba16Float without overlay)
//! ```
//!
//! Light reaches the shaders in picture units (exposure, shutter and white balance folded in), so that a shader's sum
//! is the scene-linear pixel. Unlike the path tracer, the preview filters soft shadows, has no true reflection and
//! refraction, and interpolates bounced light on a grid ([`PreviewInput::bounced_light`]); without a grid it estimates
//! it.
//!
//! Where to extend it:
//! - A pass: a pipeline constructor in the `pipelines.rs` of its room, a WGSL file joined in `shaders/mod.rs`, a `draw`
//!   function that takes `FrameResources`, one step in `PreviewRenderer::encode`.
//! - A light shape: the conversion in `lights/light_table.rs`, its irradiance in `shaders/light.wgsl`, a loop in
//!   `shaders/lighting.wgsl`, its view in `shadows/views.rs`, its emitter mesh in `geometry/draw_list.rs`.
//! - A channel: a variant of `Channel` and a branch in `shaders/channel.wgsl`.
//!
//! Rooms import in this order: gpu, lights, geometry, shadows, lighting, overlay, renderer.

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
mod still_picture;
mod targets;

pub use channel::{Channel, Gloss};
pub use error::PreviewError;
pub use frame_times::FrameTimes;
pub use gpu::device::{Gpu, LossFlag, is_cpu_rasteriser};
pub use input::{Options, Overlay, Pick, PreviewInput, is_dark};
pub use overlay::gizmo::{Gizmos, GpuLine, GpuTint};
pub use overlay::pick::{ObjectMask, PickHit, REACH_PX};
pub use renderer::PreviewRenderer;

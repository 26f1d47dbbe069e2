//! Catchlight plans the light of a photo studio: arrange it, see it live, render the picture that the camera would
//! take.
//!
//! A [`scene::Scene`] is what the user edits and what a file stores. Imports go one way, from right to left; rooms in
//! braces do not import each other, except that `cli` opens the window of `editor`:
//!
//! ```text
//! { math, color }  <-  scene  <-  photo  <-  { gear, denoise, figures, water, raytrace, raster, preview }  <-  io
//!                                         <-  { jobs, truth }  <-  setup  <-  sheet  <-  { editor, cli }  <-  main
//! ```
//!
//! | room | contents |
//! |---|---|
//! | `math`, `color` | frames, warps, error bounds; Kelvin, white balance, tone curve, sRGB |
//! | `scene` | the studio as plain data with the meshes of shapes and gear, its validation, and the class of every change of it |
//! | `photo` | photometric lights, exposure, meter arithmetic, portrait patterns, scales in thirds of a stop, pictures |
//! | `gear` | the list of heads, modifiers and stands, and what a studio needs of it |
//! | `figures` | people by parameters: body, pose, clothes, hair, and their meshes |
//! | `water` | water in a tank: cells, the automaton that moves them, the fluid solver, the surfaces of water and ground |
//! | `raytrace` | the ray tracer: BVH, BSDFs, light sampling, path tracer, photon map, film, light meter, live view |
//! | `denoise` | the denoiser: a neural network and its weights |
//! | `raster` | the z-buffer renderer on the CPU |
//! | `preview` | the live preview on wgpu |
//! | `io` | RON studios, models, textures, pictures, shipped studios |
//! | `jobs` | background work: renders, live view, meter, forecasts, thumbnails; shared by window and command line |
//! | `truth` | closed forms beside what meter and renders give for them |
//! | `setup` | the light meter's view of a set-up: each light where it acts, dials for wanted exposures |
//! | `sheet` | the set-up sheet: a studio on one page, as PDF, SVG or HTML; lesson sheets of pictures side by side |
//! | `editor`, `cli` | the window; the command line |
//!
//! `ARCHITECTURE.md` draws the data flow and names the files to touch for an extension. `tests/structure/` holds the
//! direction of imports, and that only `editor` and `preview` use wgpu and only `editor` uses egui.
//!
//! Invariants:
//! 1. `scene` does no I/O. `raytrace` has no clock, no entropy, no globals, and cannot fail once `prepare` succeeded.
//! 2. A rendered value is a function of (scene, pixel, sample, dimension, seed): same bits for any number of threads.
//! 3. Nothing that a file can say makes the program panic, hang or eat memory without bound. Loading is checked once,
//!    at the border; a bad file names the field, the value and the line, and leaves the open scene as it was.
//! 4. A save never destroys the older file: write beside it, fsync, rename.
//! 5. The editor changes the scene only through `Action`s: menus, shortcuts, gizmos, undo and tests all use them. Which
//!    variant it shows is no change.
//! 6. The UI thread never traces and never waits for a trace.
//! 7. Every non-finite value meets one gate before the film: counted, reported with its pixel and sample, shown black.

pub mod cli;
pub mod color;
pub mod denoise;
pub mod figures;
pub mod gear;
pub mod io;
pub mod jobs;
pub mod math;
pub mod photo;
pub mod raster;
pub mod raytrace;
pub mod scene;
pub mod setup;
pub mod sheet;
pub mod truth;
pub mod water;

#[cfg(feature = "gui")]
pub mod editor;
#[cfg(feature = "gui")]
pub mod preview;

/// Hypothesis tests, shared by unit tests and integration tests.
#[cfg(test)]
#[path = "../tests/studio/statistics.rs"]
#[allow(dead_code, reason = "integration tests use the rest")]
mod statistics;

/// Strands for tests of renderers.
#[cfg(test)]
#[path = "../tests/studio/strands.rs"]
mod test_strands;

//! Catchlight plans the light of a photo studio: arrange it, see it live, render the picture the camera would take.
//!
//! Data flows one way, and so do imports:
//!
//! ```text
//! math, color  <-  scene  <-  photo  <-  { io, figures, raytrace, raster, preview }  <-  jobs  <-  { editor, cli }  <-  main
//! ```
//!
//! A [`scene::Scene`] is what the user edits and what a file holds. `raytrace::prepare` turns it into flat tables,
//! `raytrace::render` fills a film wave by wave, `Film::develop` makes a [`photo::Picture`] of it, which a window shows
//! or [`io::export_picture`] writes. `preview` draws the same scene on the graphics card while the user works.
//!
//! `jobs` renders, meters and traces the live view in the background, for the window and the command line alike.
//!
//! `truth` sets readings of the meter and of renders beside closed forms: the README's table, and the tests' measure.
//!
//! Invariants:
//! 1. `scene` does no I/O. `raytrace` has no clock, no entropy, no globals, and cannot fail once `prepare` succeeded.
//! 2. A rendered value is a function of (scene, pixel, sample, dimension, seed): same bits for any number of threads.
//! 3. Nothing that a file can say makes the program panic, hang or eat memory without bound. Loading is checked once, at
//!    the border; a bad file names the field, the value and the line, and leaves the open scene as it was.
//! 4. A save never destroys the older file: write beside it, fsync, rename.
//! 5. The editor changes the scene only through `Action`s: menus, shortcuts, gizmos, undo and tests all use them.
//! 6. The UI thread never traces and never waits for a trace.
//! 7. Every non-finite value meets one gate before the film: counted, reported with its pixel and sample, shown black.

pub mod cli;
pub mod color;
pub mod figures;
pub mod io;
pub mod jobs;
pub mod math;
pub mod photo;
pub mod raster;
pub mod raytrace;
pub mod scene;
pub mod truth;

#[cfg(feature = "gui")]
pub mod editor;
#[cfg(feature = "gui")]
pub mod preview;

/// Hypothesis tests, shared by unit tests and integration tests.
#[cfg(test)]
#[path = "../tests/studio/statistics.rs"]
#[allow(dead_code, reason = "integration tests use the rest")]
mod statistics;

//! Rendered pictures, meter readings and the software rasterizer against closed forms, against each other and at the
//! limits of what a file can say.
#![allow(clippy::unwrap_used, clippy::panic, reason = "a test that cannot go on says so by panicking")]
#![allow(clippy::print_stderr, reason = "a skipped test is reported")]

#[cfg(feature = "gui")]
#[path = "../studio/adapter.rs"]
mod adapter;
mod analytic;
mod analytic_camera;
mod analytic_glass;
mod analytic_light;
mod analytic_transmission;
mod bodies;
mod environment;
mod formulas;
mod layers;
mod measured_light;
mod meter;
mod modifiers;
mod motion_blur;
mod noise;
#[path = "../studio/people.rs"]
mod people;
mod presets;
mod raster;
mod stability;
#[path = "../studio/mod.rs"]
mod studio;
mod studio_presets;
mod subsurface;
mod truth;
mod water;
mod whitted;
